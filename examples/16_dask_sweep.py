"""
How do I run a sweep on a cluster?
==================================

The same study runs in one process, on all cores or on a cluster, and gives the same file. Here the cluster is
this machine; elsewhere, give the address of its scheduler: ``open_cluster("tcp://head:8786")``.
"""

import tempfile
from pathlib import Path

import xarray as xr
from matplotlib.figure import Figure

from validation.studies import load_study, open_cluster, read_results, run_sweep

STUDY = {
    "name": "efficiency",
    "gear_pair": "nasa_28_28",
    "analysis": "lumped",
    "outputs": ["mesh_efficiency", "dte_peak_to_peak"],
    "axes": [
        {"field": "operating.pinion_torque", "low": 20, "high": 100, "count": 5},
        {"field": "friction.law", "values": ["benedict_kelley", "xu_kahraman"]},
    ],
}


def compute() -> xr.Dataset:
    """Mesh efficiency over torque with two friction laws, computed by two workers of a local cluster."""
    with tempfile.TemporaryDirectory() as folder, open_cluster("local:2") as cluster:
        run_sweep(load_study(STUDY), Path(folder, "out"), executor=cluster)
        return read_results(Path(folder, "out")).load()


def draw(result: xr.Dataset) -> Figure:
    """Loss over torque, one line a law."""
    figure = Figure(figsize=(7, 4), layout="constrained")
    axes = figure.add_subplot()
    for law, style in zip(result["friction_law"].values, ("o-", "s--"), strict=True):
        loss = 100 * (1 - result["mesh_efficiency"].sel(friction_law=law))
        axes.plot(result["operating_pinion_torque"], loss, style, label=str(law).replace("_", " "))
    axes.set(xlabel="pinion torque [N m]", ylabel="mesh loss [%]")
    axes.legend()
    return figure


if __name__ == "__main__":
    draw(compute()).savefig("dask_sweep.png", dpi=150)
