"""
At which speed does the oil film separate the flanks?
=====================================================

At which speed does the contact of the 28/28 pair leave mixed lubrication? Near
2500 rpm at 22.6 N m, where the film parameter passes 4 and law V changes from II to III.
"""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

import lumped
from lumped.path_of_contact import contact_path


def compute() -> xr.Dataset:
    """Film parameter over the path of contact and pinion speed at 22.6 N m."""
    pair = lumped.load_gear_pair("nasa_28_28").with_(operating__pinion_torque=22.6)
    g = lumped.geometry(pair)
    xi = np.linspace(g.L_XA, g.L_XD, 201)
    speeds = np.linspace(500.0, 6000.0, 56)
    film = [contact_path(pair.with_(operating__pinion_speed=float(n))).film_parameter(xi) for n in speeds]
    result = xr.Dataset({"film_parameter": (("speed", "xi"), np.array(film))})
    return result.assign_coords(speed=speeds, xi=xi)


def draw(result: xr.Dataset) -> Figure:
    """Mean film parameter over speed with the regime thresholds of law V."""
    figure = Figure(figsize=(7, 4), layout="constrained")
    axes = figure.add_subplot()
    axes.plot(result["speed"], result["film_parameter"].mean("xi"), label="mean over the path of contact")
    axes.fill_between(
        result["speed"], result["film_parameter"].min("xi"), result["film_parameter"].max("xi"), alpha=0.2
    )
    for threshold, above in ((1.0, "mixed: II"), (4.0, "film: III"), (10.0, "thick film: III")):
        axes.axhline(threshold, color="0.5", linewidth=0.8)
        axes.annotate(above, (500.0, threshold), (0, 2), textcoords="offset points", color="0.4")
    axes.set(xlabel="pinion speed [rpm]", ylabel="film parameter [-]")
    axes.legend()
    return figure


if __name__ == "__main__":
    draw(compute()).savefig("film_regimes.png", dpi=150)
