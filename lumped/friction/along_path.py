"""mu_i(xi) of a gear pair: the friction laws over the path of contact, as numbers the equations use."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr
from scipy.interpolate import PPoly

from lumped import film
from lumped.errors import ParameterError
from lumped.friction.base import ContactPath, FrictionSettings
from lumped.friction.benedict_kelley import LAW as BENEDICT_KELLEY
from lumped.friction.benedict_kelley import friction_number
from lumped.friction.graded_fit import graded_fit
from lumped.friction.registry import LAWS, law_named
from lumped.path_function import PathFunction
from lumped.roughness import composite_roughness, mean_roughness
from lumped.validity import FloatArray, RangeViolation, range_violations, warn_violations
from lumped.viscosity import dynamic_viscosity

if TYPE_CHECKING:
    from lumped.gear_geometry import Geometry
    from lumped.parameters import GearPair

#: Absolute error of mu in the piecewise polynomials.
FIT_TOLERANCE = 1e-10

_CHECKED_POSITIONS = 201
_LAWS_WITH_AVERAGE = ("coulomb", "smoothed_coulomb", "composite")


def contact_path(pair: GearPair, geometry: Geometry | None = None) -> ContactPath:
    """Collect the nominal contact of a pair: kinematics at nominal speed, full static load w_n, film data.

    S is the mean of both Ra; R_comp is their root sum of squares unless ``friction.composite_roughness`` is
    given. The full static load w_n = T_p/(Z r_bp) is used at every position, as in the paper, also where two
    pairs share it.

    Parameters
    ----------
    pair : the gear pair
    geometry : its geometry, if it is at hand
    """
    g = _geometry(pair) if geometry is None else geometry
    pinion, gear, lubricant, friction = pair.pinion, pair.gear, pair.lubricant, pair.friction
    composite = friction.composite_roughness
    if composite is None:
        composite = float(composite_roughness(pinion.roughness, gear.roughness))
    return ContactPath(
        L_XA=g.L_XA,
        L_XP=g.L_XP,
        L_XD=g.L_XD,
        L_XY=g.L_XY,
        omega_pinion=g.omega_pinion,
        omega_gear=g.omega_gear,
        unit_load=pair.operating.pinion_torque / (g.face_width * g.base_radius_pinion),
        effective_modulus=float(
            film.effective_modulus(
                pinion.youngs_modulus, pinion.poisson_ratio, gear.youngs_modulus, gear.poisson_ratio
            )
        ),
        viscosity=dynamic_viscosity(lubricant),
        pressure_viscosity_k=lubricant.pressure_viscosity_k,
        pressure_viscosity_s=lubricant.pressure_viscosity_s,
        roughness=float(mean_roughness(pinion.roughness, gear.roughness)),
        composite_roughness=composite,
        film_length=friction.film_length,
    )


def friction_settings(pair: GearPair) -> FrictionSettings:
    """Collect the parameters of the friction laws."""
    given = pair.friction
    return FrictionSettings(given.coefficient, given.sharpness, given.maximum, given.thresholds)


def friction_path_function(
    pair: GearPair, geometry: Geometry | None = None, law: str | None = None
) -> PathFunction:
    """Signed friction coefficient mu_i(xi) of one tooth pair at nominal speed and load.

    Parameters
    ----------
    pair : the gear pair
    geometry : its geometry, if it is at hand
    law : name of a friction law; default ``pair.friction.law``

    Returns
    -------
    mu(xi) on [L_XA, L_XD], within 1e-10 of the law wherever it is smooth; negative in approach, positive in
    recess. Its switches are the pitch point where the law changes sign there, the ends of the stretches where
    law II meets a bound, and the changes of regime of law V.

    Raises
    ------
    ParameterError : an unknown law, or roughness of 1.13 um and above with law II

    Warns
    -----
    LawRangeWarning : the contact leaves a validity range of the law, see ``law_range_violations``
    """
    path, settings, name = contact_path(pair, geometry), friction_settings(pair), law or pair.friction.law
    function = _fit(path, settings, name)
    warn_violations(_violations(path, settings, name))
    return function


def mean_coefficient(function: PathFunction, low: float | None = None, high: float | None = None) -> float:
    """Mean of |mu| over the path of contact.

    Parameters
    ----------
    function : signed mu(xi), changing sign at its breaks only
    low, high : first and last position [m]; default the whole path
    """
    breaks = function.breaks
    middles = 0.5 * (breaks[:-1] + breaks[1:])
    signs = np.where(function(middles) < 0.0, -1.0, 1.0)
    magnitude = PPoly(function.coefficients * signs, breaks)
    a = breaks[0] if low is None else low
    b = breaks[-1] if high is None else high
    return float(magnitude.integrate(a, b)) / float(b - a)


def mean_benedict_kelley(path: ContactPath, settings: FrictionSettings) -> float:
    """Mean of |mu| of law II over A..D: the paper's mu_avg for laws I and IV."""
    return mean_coefficient(_fit(path, settings, BENEDICT_KELLEY.name))


def law_range_violations(
    pair: GearPair, law: str | None = None, geometry: Geometry | None = None
) -> tuple[RangeViolation, ...]:
    """List where a pair leaves the validity ranges of a friction law.

    A law made of others (V) is checked against each of them where that one is in force.

    Parameters
    ----------
    pair : the gear pair
    law : name of a friction law; default ``pair.friction.law``
    geometry : its geometry, if it is at hand
    """
    return _violations(contact_path(pair, geometry), friction_settings(pair), law or pair.friction.law)


def friction_profile(
    pair: GearPair,
    laws: Sequence[str] | None = None,
    points: int = 401,
    geometry: Geometry | None = None,
) -> xr.Dataset:
    """Compare the friction laws over the path of contact, with the contact conditions they see.

    Parameters
    ----------
    pair : the gear pair
    laws : names of the laws; default all five
    points : number of equally spaced positions; the switches of every law are added to them
    geometry : its geometry, if it is at hand

    Returns
    -------
    Dataset over ``xi`` [m] with mu (law, xi), mean_mu (law), film_thickness, film_parameter, regime,
    hertz_pressure, half_width, sliding_velocity, entraining_velocity, slide_to_roll. Attributes:
    ``range_warnings``, one text per left validity range; ``left_out``, laws that this pair does not allow
    and why.
    """
    path, settings = contact_path(pair, geometry), friction_settings(pair)
    functions: dict[str, PathFunction] = {}
    left_out: list[str] = []
    names = [name for name in LAWS if name != "none"] if laws is None else list(laws)
    for name in names:
        try:
            functions[name] = _fit(path, settings, name)
        except ParameterError as error:
            if laws is not None:
                raise
            left_out.append(f"{LAWS[name].title}: {error}")
    grid = np.linspace(path.L_XA, path.L_XD, points)
    # Just below the end: a path function is right-continuous and zero beyond it.
    grid[-1] = np.nextafter(path.L_XD, 0.0)
    xi = np.unique(np.concatenate([grid, *(f.switches for f in functions.values())]))
    parameter = path.film_parameter(xi)
    warnings = [
        str(violation) for name in functions for violation in law_range_violations(pair, name, geometry)
    ]
    return xr.Dataset(
        {
            "mu": (
                ("law", "xi"),
                np.array([f(xi) for f in functions.values()]).reshape(len(functions), xi.size),
                _attrs("1", "friction coefficient, negative in approach"),
            ),
            "mean_mu": (
                "law",
                np.array([mean_coefficient(f) for f in functions.values()]),
                _attrs("1", "mean of |mu| over the path of contact"),
            ),
            "film_thickness": ("xi", path.film_thickness(xi), _attrs("m", "central film thickness")),
            "film_parameter": ("xi", parameter, _attrs("1", "film parameter Lambda")),
            "regime": (
                "xi",
                film.regime(parameter, settings.thresholds),
                {
                    **_attrs("1", "lubrication regime"),
                    "flag_values": [0, 1, 2, 3],
                    "flag_meanings": ", ".join(film.REGIMES),
                },
            ),
            "hertz_pressure": ("xi", path.hertz_pressure(xi), _attrs("Pa", "largest Hertzian pressure")),
            "half_width": ("xi", path.half_width(xi), _attrs("m", "Hertzian half width")),
            "sliding_velocity": ("xi", path.sliding_velocity(xi), _attrs("m/s", "sliding velocity")),
            "entraining_velocity": (
                "xi",
                path.entraining_velocity(xi),
                _attrs("m/s", "sum of the rolling velocities"),
            ),
            "slide_to_roll": ("xi", path.slide_to_roll(xi), _attrs("1", "slide-to-roll ratio")),
        },
        coords={
            "xi": ("xi", xi, _attrs("m", "distance of the contact point from X")),
            "law": ("law", list(functions), {"long_name": "friction law"}),
            "law_title": ("law", [LAWS[name].title for name in functions]),
        },
        attrs={"range_warnings": warnings, "left_out": left_out},
    )


@lru_cache(maxsize=256)
def _fit(path: ContactPath, settings: FrictionSettings, name: str) -> PathFunction:
    # Cached: charts over damping, stiffness or bearings ask for the same immutable function at every node.
    law = law_named(name)
    switches = sorted({xi for xi in law.switches(path, settings) if path.L_XA < xi < path.L_XD})
    # The pitch point is a break of every law: also where mu is smooth there, it varies fastest around it.
    breaks = sorted({path.L_XA, path.L_XP, path.L_XD, *switches})
    known = settings
    if name in _LAWS_WITH_AVERAGE:  # worked out once, not in every evaluation of the law
        known = replace(settings, coefficient=settings.average(path))
    return graded_fit(
        lambda xi: law.signed(xi, path, known), path.L_XP, breaks, switches, tolerance=FIT_TOLERANCE
    )


@lru_cache(maxsize=256)
def _violations(path: ContactPath, settings: FrictionSettings, name: str) -> tuple[RangeViolation, ...]:
    law = law_named(name)
    xi = np.linspace(path.L_XA, path.L_XD, _CHECKED_POSITIONS + 2)[1:-1]
    if law.parts is None:
        return range_violations(law.title, law.ranges, _arguments(path, xi))
    found: list[RangeViolation] = []
    for part, inside in law.parts(xi, path, settings):
        if inside.any():
            title = f"{law.title} ({part.title})"
            found += range_violations(title, part.ranges, _arguments(path, xi[inside]))
    return tuple(found)


def _arguments(path: ContactPath, xi: FloatArray) -> dict[str, FloatArray]:
    """Arguments of the laws along the path, by name, in the laws' published units."""
    velocities = path.sliding_velocity(xi), path.entraining_velocity(xi)
    return {
        "unit_load": np.array(path.unit_load * 1e-3),
        "viscosity": np.array(path.viscosity * 1e3),
        "sliding_velocity": velocities[0],
        "entraining_velocity": velocities[1],
        "slide_to_roll": path.slide_to_roll(xi),
        "roughness": np.array(path.roughness * 1e6),
        "pressure": path.hertz_pressure(xi) * 1e-9,
        "radius": path.radius(xi),
        "friction_number": friction_number(path.unit_load * 1e-3, path.viscosity * 1e3, *velocities),
    }


def _attrs(units: str, long_name: str) -> dict[str, str]:
    return {"units": units, "long_name": long_name}


def _geometry(pair: GearPair) -> Geometry:
    from lumped.gear_geometry import geometry

    return geometry(pair)
