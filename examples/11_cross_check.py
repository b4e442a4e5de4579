"""
Up to which torque is the linear model right?
=============================================

Only the multibody model has finite deflections. They move the contact points, an effect proportional to force
times deflection, so the difference of both models grows with the square of the torque.
"""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

import lumped
import multibody


def compute() -> xr.Dataset:
    """Largest difference of the motions of the smooth 28/28 pair without relief, at falling torques."""
    smooth = {"model": "parabolic", "ramp_length": 2.0}
    pair = lumped.load_gear_pair("nasa_28_28").with_(
        mesh__contact="prescribed",
        mesh__relief="ignored",
        mesh__stiffness=smooth,
        friction__law="coulomb",
        friction__coefficient=0.05,
    )
    torques = 56.5 / 4.0 ** np.arange(4)
    names = ("dte", "x_p", "y_p")
    sizes: dict[str, list[float]] = {name: [] for name in names}
    for torque in torques:
        loaded = pair.with_(operating__pinion_torque=float(torque))
        exact = multibody.steady_state(loaded, samples_per_cycle=128, effects={"contact_loss": False})
        linear = lumped.steady_state(loaded, samples_per_cycle=128)
        for name in names:
            sizes[name].append(float(np.abs(exact[name] - linear[name]).max()))
    result = xr.Dataset({n: ("torque", v) for n, v in sizes.items()}, coords={"torque": ("torque", torques)})
    slopes = {n: float(np.polyfit(np.log(torques), np.log(v), 1)[0]) for n, v in sizes.items()}
    return result.assign_attrs(slopes)


def draw(result: xr.Dataset) -> Figure:
    """Differences over torque, both logarithmic."""
    figure = Figure(figsize=(7, 4), layout="constrained")
    axes = figure.add_subplot()
    labels = {
        "dte": "transmission error",
        "x_p": "pinion, line of action",
        "y_p": "pinion, off line of action",
    }
    for (name, label), style in zip(labels.items(), ("o-", "s--", "^:"), strict=True):
        slope = result.attrs[name]
        axes.loglog(result["torque"], result[name] * 1e9, style, label=f"{label} (slope {slope:.2f})")
    axes.set(xlabel="pinion torque [N m]", ylabel="multibody - lumped, largest [nm]")
    axes.legend()
    return figure


if __name__ == "__main__":
    draw(compute()).savefig("cross_check.png", dpi=150)
