"""
How much damping does my contact ratio need?
============================================

Two levels of stiffness drive the tongue 2 w3/2, except at one contact ratio: where the times in double and in
single contact are each half a period of the mode at that stiffness, which returns every motion unchanged.
"""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from scipy.linalg import eigh

import floquet
import lumped
from floquet.gear.axes import vary


def compute() -> xr.Dataset:
    """Mesh damping ratio that closes the tongue of the 28/28 pair without friction and relief."""
    pair = lumped.load_gear_pair("nasa_28_28").with_(
        mesh__contact="prescribed", mesh__relief="ignored", friction__law="none"
    )
    body = lumped.bodies(pair)
    bearings = pair.bearings
    v = np.array([1.0, 1.0, -1.0])
    mass = np.diag([body.effective_mass, body.mass_pinion, body.mass_gear])
    supports = np.diag([0.0, bearings.pinion.loa_stiffness, bearings.gear.loa_stiffness])
    tooth = float(lumped.mesh_stiffness(pair)["pair_stiffness"].max())
    single, double = (np.sqrt(eigh(k * np.outer(v, v) + supports, mass)[0][-1]) for k in (tooth, 2 * tooth))
    quiet = 1.0 + single / (single + double)
    ratios = np.array([1.3, 1.36, quiet, 1.5, 1.6, 1.66])
    critical = [_critical(vary(pair, {"contact_ratio": ratio}).pair) for ratio in ratios]
    result = xr.Dataset({"critical_damping": ("contact_ratio", critical)}, coords={"contact_ratio": ratios})
    return result.assign_attrs(quiet_contact_ratio=quiet)


def _critical(pair: lumped.GearPair) -> float:
    tongues = floquet.stability_margins(pair, (13000.0, 20000.0)).tongues
    return max((tongue.critical_damping for tongue in tongues if tongue.label == "2w3/2"), default=0.0)


def draw(result: xr.Dataset) -> Figure:
    """Critical damping, with the contact ratio that needs none."""
    figure = Figure(figsize=(7, 4), layout="constrained")
    axes = figure.add_subplot()
    axes.plot(result["contact_ratio"], 100 * result["critical_damping"], "o-")
    axes.axvline(result.attrs["quiet_contact_ratio"], color="0.5", linestyle="--", label="half period each")
    axes.set(xlabel="contact ratio [-]", ylabel="critical mesh damping ratio [%]")
    axes.legend()
    return figure


if __name__ == "__main__":
    draw(compute()).savefig("critical_damping.png", dpi=150)
