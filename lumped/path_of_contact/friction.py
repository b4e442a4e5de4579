"""mu_i(xi) of a gear pair: the friction laws over the path of contact, one by one and side by side.

Sources: each law names its own; the sign convention is that of docs/theory/equations.md, "Normal load and
friction".
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from lumped.arguments import whole_number
from lumped.errors import ParameterError, refuse
from lumped.friction.average_coefficient import average_coefficient, longer_path, without_factor
from lumped.friction.base import ContactPath, FrictionLaw, FrictionSettings, fit_signed, mean_coefficient
from lumped.friction.benedict_kelley import LAW as BENEDICT_KELLEY
from lumped.friction.benedict_kelley import friction_number
from lumped.friction.misfit import fit_misfit
from lumped.friction.registry import law_of, laws_with_friction
from lumped.labelling import labelled_dataset, provenance
from lumped.lubrication import film
from lumped.path_function import PathFunction
from lumped.ranges import RangeViolation, range_violations, warn_violations, warnings_are_heard
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray

if TYPE_CHECKING:
    import xarray as xr


def contact_path(pair: GearPair) -> ContactPath:
    """Return the nominal contact of a pair: kinematics at nominal speed, full static load w_n, film data.

    S is the mean of both Ra; R_comp is their root sum of squares unless ``friction.composite_roughness`` is
    given. The full static load w_n = T_p/(Z r_bp) is used at every position, as in the paper, also where two
    pairs share it.
    """
    return pair.nominal_contact


def friction_path_function(
    pair: GearPair, law: str | None = None, interval: tuple[float, float] | None = None, *, warn: bool = True
) -> PathFunction:
    """Signed friction coefficient mu_i(xi) of one tooth pair at nominal speed and load.

    Parameters
    ----------
    pair : the gear pair
    law : name of a friction law; default ``pair.friction.law``
    interval : first and last position [m]; default A and D
    warn : whether to warn, which takes half as long as the fit; it takes no time where warnings are ignored

    Returns
    -------
    mu(xi) on the interval, within 1e-10 of the law wherever it is smooth; negative in approach, positive in
    recess. Its switches are the pitch point where the law changes sign there, the ends of the stretches where
    law II meets a bound, and the changes of regime of law V.

    Raises
    ------
    ParameterError : an unknown law, roughness of 1.13 um and above with law II, or a mu above 1

    Warns
    -----
    LawRangeWarning : the contact leaves a validity range of the law, see ``law_range_violations``
    """
    path, record = _contact(pair, law, interval)
    function = fit_law(path, pair.friction, record.name)
    if warn and warnings_are_heard():
        warn_violations(violations_of(path, pair.friction, record.name))
    return function


def _contact(
    pair: GearPair, law: str | None, interval: tuple[float, float] | None
) -> tuple[ContactPath, FrictionLaw]:
    """Contact and law of `friction_path_function`."""
    record = law_of(pair.friction, law)
    path = contact_path(pair)
    if interval is None or interval == (path.L_XA, path.L_XD):
        return path, record
    return longer_path(path, interval, record, pair.friction), record


def friction_misfit(pair: GearPair, interval: tuple[float, float] | None = None) -> FloatArray:
    """Bound on the error of `friction_path_function` on each of its pieces (m,), see `fit_misfit`.

    Where mu_avg is the mean of law II, the bound includes the error of this mean times the law's
    ``change_by_average``.
    """
    path, law = _contact(pair, None, interval)
    settings: FrictionSettings = pair.friction
    bounds = fit_misfit(fit_law(path, settings, law.name), law, path, settings)
    if settings.coefficient is None and law.reads_average(path, settings):
        nominal = without_factor(contact_path(pair))
        law_two = fit_signed(BENEDICT_KELLEY, nominal, settings)
        of_pieces = fit_misfit(law_two, BENEDICT_KELLEY, nominal, settings)
        of_mean = float(of_pieces @ np.diff(law_two.breaks)) / (nominal.L_XD - nominal.L_XA)
        # mu_avg is proportional to the mean of law II: the error of the mean gives the error of mu_avg.
        of_average = average_coefficient(replace(nominal, law_two_mean=of_mean), settings)
        bounds = bounds + law.change_by_average(path) * of_average
    return bounds


def coefficient_for(pair: GearPair, mean: float) -> float:
    """Return the ``friction.coefficient`` with which |mu| of law I is this mean [-].

    The factors of a file (`lumped.schema.friction.FACTORS`) act on a given coefficient too.
    """
    return mean / contact_path(pair).friction_factor


def law_range_violations(pair: GearPair, law: str | None = None) -> tuple[RangeViolation, ...]:
    """List the validity ranges of a friction law that a pair leaves.

    Law V is made of other laws. Each of these laws is checked where it is in force.

    Parameters
    ----------
    pair : the gear pair
    law : name of a friction law; default ``pair.friction.law``
    """
    return violations_of(contact_path(pair), pair.friction, law_of(pair.friction, law).name)


@lru_cache(maxsize=256)
def fit_law(path: ContactPath, settings: FrictionSettings, name: str) -> PathFunction:
    """Fit mu(xi) of one law. The fit is cached: charts over damping or stiffness need it at every node."""
    law = law_of(settings, name)
    _must_be_friction(path, settings, law)
    return fit_signed(law, path, settings)


@lru_cache(maxsize=256)
def _largest_mu(law: FrictionLaw, path: ContactPath, settings: FrictionSettings) -> float:
    """Largest mu of a law at the sampled positions of a path [-]."""
    with np.errstate(over="ignore", invalid="ignore"):
        return float(np.abs(law.signed(path.sampled_positions, path, settings)).max())


def _must_be_friction(path: ContactPath, settings: FrictionSettings, law: FrictionLaw) -> None:
    """Refuse a law with mu above 1, as law III has in thin oil under high pressure."""
    scaled = law.over_speed(path, settings)
    at_fit_speed, factor = (path, 1.0) if scaled is None else scaled
    largest = factor * _largest_mu(law, at_fit_speed, settings)
    if not largest <= 1.0:
        reasons = "; ".join(map(str, violations_of(path, settings, law.name))) or "no range of it was left"
        raise refuse(
            "friction.law",
            f"{law.name} with mu up to {largest:.3g}",
            "a law with mu <= 1 on the path of contact",
            f"Take another law or operating point ({reasons}).",
        )


@lru_cache(maxsize=256)
def violations_of(path: ContactPath, settings: FrictionSettings, name: str) -> tuple[RangeViolation, ...]:
    """Validity ranges that a contact leaves under a law."""
    law = law_of(settings, name)
    xi = path.sampled_positions
    single_part = [(law, np.full(xi.shape, True))]
    violations: list[RangeViolation] = []
    for part, inside in single_part if law.parts is None else law.parts(xi, path, settings):
        if inside.any():
            title = law.title if part is law else f"{law.title} ({part.title})"
            violations += _ranges_left(title, part, path, settings, xi[inside])
    return tuple(violations)


def _ranges_left(
    title: str, law: FrictionLaw, path: ContactPath, settings: FrictionSettings, xi: FloatArray
) -> tuple[RangeViolation, ...]:
    """Validity ranges that positions xi (n,) leave, with the friction coefficient of the law there."""
    try:
        with np.errstate(over="ignore", invalid="ignore"):
            mu = np.abs(law.signed(xi, path, settings))
    except ParameterError:  # law II refuses rough flanks
        mu = np.full_like(xi, np.nan)
    values = _arguments(path, xi) | {"mean_coefficient": np.array(mu.mean())}
    return range_violations(title, law.ranges, values, mu)


def _arguments(path: ContactPath, xi: FloatArray) -> dict[str, FloatArray]:
    """Arguments of the laws along the path, by name, in the laws' published units."""
    velocities = path.sliding_velocity(xi), path.entraining_velocity(xi)
    return {
        "pinion_speed": np.array(path.omega_pinion * 30.0 / math.pi),
        "unit_load": np.array(path.unit_load * 1e-3),
        "viscosity": np.array(path.viscosity * 1e3),
        "sliding_velocity": velocities[0],
        "entraining_velocity": velocities[1],
        "mean_rolling_velocity": 0.5 * velocities[1],
        "pitch_line_velocity": np.array(path.pitch_line_velocity),
        "slide_to_roll": path.slide_to_roll(xi),
        "roughness": np.array(path.roughness * 1e6),
        "pressure": path.hertz_pressure(xi) * 1e-9,
        "radius": path.radius(xi),
        "friction_number": friction_number(path.unit_load * 1e-3, path.viscosity * 1e3, *velocities),
    }


def film_note(low: float, high: float) -> str:
    """Text on the formula of the film thickness.

    ``low`` and ``high`` are the least and the largest ratio of Hamrock and Dowson's thickness to this
    thickness.
    """
    return (
        "central, Dowson and Toyoda (1978); "
        f"the formula of Hamrock and Dowson (1977) gives {low:.2f} to {high:.2f} times as much"
    )


def friction_profile(pair: AnyPair, points: int = 401) -> xr.Dataset:
    """Compare all laws with friction over the path of contact, beside the conditions of the contact.

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
    path = contact_path(pair)
    settings = pair.friction
    functions: dict[str, PathFunction] = {}
    left_out: list[str] = []
    laws = laws_with_friction(settings)
    for name, law in laws.items():
        try:
            functions[name] = fit_law(path, settings, name)
        except ParameterError as error:
            left_out.append(f"{law.title}: {error}")
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
        provenance(pair) | {"range_warnings": warnings, "left_out": left_out},
    )
    other = path.film_thickness(xi, "hamrock_dowson") / result["film_thickness"].to_numpy()
    result["film_thickness"].attrs["note"] = film_note(float(other.min()), float(other.max()))
    result["regime"].attrs |= {"flag_values": [0, 1, 2, 3], "flag_meanings": ", ".join(film.REGIMES)}
    return result.assign_coords(law_title=("law", [laws[name].title for name in functions]))
