"""
How do the friction laws differ?
================================

Which coefficient does each law give the same pair, and what happens at the pitch point? Law I jumps there,
law II rises to its upper limit, law III vanishes, and law IV changes its sign over a short length. Law V
equals law II at this thin film. Choose the law that suits your film.
"""

from itertools import cycle

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

import lumped
from lumped.friction import FRICTIONAL
from lumped.path_of_contact import friction_path_function


def compute() -> xr.Dataset:
    """Signed coefficient of all laws for the 28/28 pair at 22.6 N m, 1000 rpm."""
    pair = lumped.load_gear_pair("nasa_28_28").with_(
        operating__pinion_torque=22.6, operating__pinion_speed=1000
    )
    g = lumped.geometry(pair)
    xi = np.linspace(g.L_XA, g.L_XD, 801)
    mu = {law: ("xi", friction_path_function(pair, law)(xi)) for law in FRICTIONAL}
    return xr.Dataset(mu, coords={"xi": ("xi", xi)}, attrs={"pitch_point": g.L_XP})


def draw(result: xr.Dataset) -> Figure:
    """Coefficient against distance from the pitch point."""
    figure = Figure(figsize=(7, 4), layout="constrained")
    axes = figure.add_subplot()
    distance = (result["xi"] - result.attrs["pitch_point"]) * 1e3
    for style, (law, values) in zip(cycle(("-", "--", ":")), result.data_vars.items(), strict=False):
        axes.plot(distance, values, style, label=str(law).replace("_", " "))
    axes.set(xlabel="distance from the pitch point [mm]", ylabel="friction coefficient, signed [-]")
    axes.legend()
    return figure


if __name__ == "__main__":
    draw(compute()).savefig("friction_laws.png", dpi=150)
