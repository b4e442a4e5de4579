"""The friction laws side by side over the path of contact, for tables and figures.

Sources: each law names its own (Abbas Al-Zubaidi 2008, eqs. 10 to 21).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lumped.arguments import whole_number
from lumped.errors import ParameterError
from lumped.friction.base import mean_coefficient
from lumped.friction.registry import FRICTIONAL, LAWS
from lumped.labelling import labelled_dataset
from lumped.lubrication import film
from lumped.path_function import PathFunction
from lumped.path_of_contact.friction import contact_path, fit_law, violations_of
from lumped.schema.files import AnyPair, load_gear_pair

if TYPE_CHECKING:
    import xarray as xr


def friction_profile(pair: AnyPair, points: int = 401) -> xr.Dataset:
    """Compare all laws with friction over the path of contact, with the contact conditions they see.

    Parameters
    ----------
    pair : the gear pair
    points : number of equally spaced positions; the switches of every law are added to them

    Returns
    -------
    Dataset over ``xi`` [m] with mu (law, xi), mean_mu (law), film_thickness, film_parameter, regime,
    hertz_pressure, half_width, sliding_velocity, entraining_velocity, slide_to_roll. Attributes:
    ``range_warnings``, one text per left validity range; ``left_out``, laws that this pair does not allow
    and why.
    """
    pair = load_gear_pair(pair)
    path, settings = contact_path(pair), pair.friction
    functions: dict[str, PathFunction] = {}
    left_out: list[str] = []
    for name in FRICTIONAL:
        try:
            functions[name] = fit_law(path, settings, name)
        except ParameterError as error:
            left_out.append(f"{LAWS[name].title}: {error}")
    grid = np.linspace(path.L_XA, path.L_XD, whole_number("points", points, 2, 1_000_000))
    # Just below the end: a path function is right-continuous and zero beyond it.
    grid[-1] = np.nextafter(path.L_XD, 0.0)
    xi = np.unique(np.concatenate([grid, *(f.switches for f in functions.values())]))
    parameter = path.film_parameter(xi)
    warnings = [str(violation) for name in functions for violation in violations_of(path, settings, name)]
    result = labelled_dataset(
        {
            "mu": (
                ("law", "xi"),
                np.array([f(xi) for f in functions.values()]).reshape(len(functions), xi.size),
                "1",
                "friction coefficient, negative in approach",
            ),
            "mean_mu": (
                "law",
                np.array([mean_coefficient(f) for f in functions.values()]),
                "1",
                "mean of |mu| over the path of contact",
            ),
            "film_thickness": ("xi", path.film_thickness(xi), "m", "central film thickness"),
            "film_parameter": ("xi", parameter, "1", "film parameter Lambda"),
            "regime": ("xi", film.regime(parameter, settings.thresholds), "1", "lubrication regime"),
            "hertz_pressure": ("xi", path.hertz_pressure(xi), "Pa", "largest Hertzian pressure"),
            "half_width": ("xi", path.half_width(xi), "m", "Hertzian half width"),
            "sliding_velocity": ("xi", path.sliding_velocity(xi), "m/s", "sliding velocity"),
            "entraining_velocity": (
                "xi",
                path.entraining_velocity(xi),
                "m/s",
                "sum of the rolling velocities",
            ),
            "slide_to_roll": ("xi", path.slide_to_roll(xi), "1", "slide-to-roll ratio"),
        },
        {
            "xi": (xi, "m", "distance of the contact point from X"),
            "law": (list(functions), "1", "friction law"),
        },
        {"range_warnings": warnings, "left_out": left_out},
    )
    result["regime"].attrs |= {"flag_values": [0, 1, 2, 3], "flag_meanings": ", ".join(film.REGIMES)}
    return result.assign_coords(law_title=("law", [LAWS[name].title for name in functions]))
