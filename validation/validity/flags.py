"""Is the linear time-varying model valid for a motion? One flag for each assumption: a number and words.

Sources: docs/theory/validity.md.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from lumped import GearPair, Geometry
from lumped.arguments import of_type
from lumped.display.result import DisplayedResult
from lumped.errors import refuse
from lumped.friction.registry import law_of
from lumped.model.results import LOAD_NOISE, farthest_reversal
from lumped.path_of_contact import contact_path, law_range_violations
from lumped.quasi_static.contacts import contact_of
from lumped.ranges import RangeViolation
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.typing import FloatArray
from validation.files.formatting import read_table

if TYPE_CHECKING:
    from floquet.gear.multipliers import GearPairMultipliers

#: Distance from the pitch point within which sliding may reverse, over the base pitch: warning, violation.
REVERSAL_LIMITS = (0.02, 0.05)
#: Relative drift of the mean speed over a run: warning, violation. Drift per run, not per cycle.
DRIFT_LIMITS = (1e-3, 1e-2)
#: Estimated relative error of the periodic motion: warning, violation.
ERROR_LIMITS = (1e-6, 1e-4)

#: Values of `validity_state`: the worst of contact and sliding.
STATES = ("valid", "warning", "violated", "no periodic motion")

State = Literal["ok", "warning", "violated"]

#: Key of a flag -> name, unit, meaning and action.
_ABOUT = read_table("validation.validity", "flags.toml")


@dataclass(frozen=True, repr=False)
class Flag(DisplayedResult):
    """One assumption of the model, checked.

    Attributes
    ----------
    key : stable name for programs
    name : plain name
    state : "ok", "warning" or "violated"
    value : number that decides the state; None: there is no number
    unit : unit of the value, "1" for a ratio
    detail : sentence on place and size
    meaning : purpose of the assumption
    action : what the user can do; empty: nothing
    """

    key: str
    name: str
    state: State
    value: float | None
    unit: str
    detail: str
    meaning: str
    action: str


def flag(key: str, state: State, value: float | None, detail: str) -> Flag:
    """Return the flag with this key of ``flags.toml``."""
    words = _ABOUT[key] | ({"action": ""} if state == "ok" else {})
    return Flag(key=key, state=state, value=value, detail=detail, **words)


def validity_flags(
    pair: AnyPair, motion: xr.Dataset, multipliers: GearPairMultipliers | None = None
) -> tuple[Flag, ...]:
    """Check the assumptions of the LTV model on a motion.

    Parameters
    ----------
    pair : the gear pair
    motion : dataset of ``lumped.steady_state``, or of a ``simulate``, over whole mesh cycles
    multipliers : Floquet multipliers of the pair on the same supports, where they are known
    """
    pair = load_gear_pair(pair)
    of_type("motion", motion, xr.Dataset, "a dataset, as steady_state returns it")
    g = pair.geometry
    flags = [
        contact_loss(pair, g, motion),
        sliding_reversal(g, motion),
        contact_ratio(g),
        law_ranges(pair),
        stiffness_ranges(pair),
        film_regime(pair),
        torque_balance(pair, motion),
    ]
    if float(motion["time"][-1] - motion["time"][0]) > 1.5 * g.mesh_period:
        flags.append(speed_drift(g, motion))
    if "error_estimate" in motion.attrs:
        flags.append(solution_error(motion))
    if multipliers is not None:
        from floquet.gear.multipliers import GearPairMultipliers

        what = "what gear_pair_multipliers returns"
        checked = of_type("multipliers", multipliers, GearPairMultipliers, what)
        supports = checked.variation.supports
        if supports != (wanted := motion.attrs.get("supports", supports)):
            action = f'Give those of gear_pair_multipliers(pair, supports="{wanted}").'
            raise refuse("multipliers", f"on {supports}", f"on {wanted}, as the motion", action)
        flags.append(stability(checked))
    return tuple(flags)


def _state(value: float, limits: tuple[float, float]) -> State:
    return "ok" if value <= limits[0] else "warning" if value <= limits[1] else "violated"


def _zone(g: Geometry, position: float) -> str:
    """Position on the path of contact in words: distance from A, and the zone."""
    marks = (("A", g.L_XA), ("B", g.L_XB), ("P", g.L_XP), ("C", g.L_XC), ("D", g.L_XD))
    ordered = sorted(marks, key=lambda mark: mark[1])
    around = (
        f"between {a} and {b}"
        for (a, low), (b, high) in itertools.pairwise(ordered)
        if low <= position <= high
    )
    zone = next(around, "beyond the ends")
    return f"{1e3 * (position - g.L_XA):.3f} mm after A, {zone}"


def contact_loss(pair: GearPair, g: Geometry, motion: xr.Dataset) -> Flag:
    """Check N_i >= 0 in contact: the linear model lets teeth pull that would separate.

    With loaded contact single pairs begin and end their contact gradually: then all pairs together must
    press.
    """
    form = contact_of(pair)
    load, contact = form.pressing(motion["normal_load"].to_numpy(), motion["contact"].to_numpy() > 0)
    load = np.where(contact, load, np.inf)
    lowest = float(load.min())
    static = pair.operating.pinion_torque / g.base_radius_pinion
    separated = load < -LOAD_NOISE * static
    where = np.unravel_index(int(np.argmin(load)), load.shape)
    place = _zone(g, float(motion["position"].to_numpy()[where]))
    share = separated.sum() / max(int(contact.sum()), 1)
    state: State = "violated" if separated.any() else "ok"
    detail = f"lowest load of {form.pressed} {lowest:.4g} N ({lowest / static:.3g} of the static load)"
    detail += f" {place}"
    if separated.any():
        detail += f"; below zero over {100 * share:.3g} % of the time in contact"
    return flag("contact_loss", state, lowest, detail)


def sliding_reversal(g: Geometry, motion: xr.Dataset) -> Flag:
    """Check that sliding has the sign s_i of the nominal motion, except next to the pitch point."""
    position = motion["position"].to_numpy()
    loaded = (motion["contact"].to_numpy() > 0) & (motion["normal_load"].to_numpy() > 0)
    sliding = motion["sliding_velocity"].to_numpy()
    reversed_ = loaded & (sliding * np.sign(position - g.L_XP) < 0.0)
    farthest = farthest_reversal(position - g.L_XP, sliding, loaded)
    state = _state(farthest / g.base_pitch, REVERSAL_LIMITS)
    if reversed_.any():
        share = reversed_.sum() / max(int(loaded.sum()), 1)
        detail = (
            f"sliding is reversed up to {1e3 * farthest:.2g} mm from the pitch point "
            f"({100 * farthest / g.base_pitch:.2g} % of a base pitch), over {100 * share:.2g} % of the time "
            f"in contact"
        )
    else:
        detail = "the actual sliding velocity, vibration included, keeps its nominal sign at every sample"
    return flag("sliding_reversal", state, farthest, detail)


def validity_state(lowest_load: FloatArray, reversal: FloatArray) -> NDArray[np.int64]:
    """Return the index into ``STATES`` over speed: the worse of contact and sliding.

    ``lowest_load``: over the static load, NaN without a periodic motion; ``reversal``: over the base pitch.
    """
    state = np.zeros(lowest_load.shape, dtype=np.int64)
    state[reversal > REVERSAL_LIMITS[0]] = 1
    state[(reversal > REVERSAL_LIMITS[1]) | (lowest_load < -LOAD_NOISE)] = 2
    state[np.isnan(lowest_load)] = 3
    return state


def contact_ratio(g: Geometry) -> Flag:
    """Check that the contact ratio is in the range of the formulas, with some margin above 1."""
    sigma = g.contact_ratio
    state: State = "ok" if 1.1 <= sigma <= 3.0 else "warning"
    detail = "; ".join([f"{sigma:.4f}: up to {g.pairs} tooth pairs share the load", *g.notes])
    return flag("contact_ratio", state, sigma, detail)


def law_ranges(pair: GearPair) -> Flag:
    """Check that the friction law is inside the range of its fit."""
    return _ranges("friction_law_range", law_range_violations(pair), pair.friction.law)


def stiffness_ranges(pair: GearPair) -> Flag:
    """Check that the stiffness model is inside the ranges of its fits."""
    return _ranges("stiffness_range", pair.mesh.stiffness.violations(pair), pair.mesh.stiffness.model)


def _ranges(key: str, violations: tuple[RangeViolation, ...], name: str) -> Flag:
    state: State = "warning" if violations else "ok"
    detail = "; ".join(map(str, violations)) or f"{name}: no stated limit is exceeded"
    return flag(key, state, float(len(violations)), detail)


def film_regime(pair: GearPair) -> Flag:
    """Check that the film parameter suits the friction law."""
    path = contact_path(pair)
    parameter = path.film_parameter(np.linspace(path.L_XA, path.L_XD, 201))
    low = float(parameter.min())
    high = float(parameter.max())
    boundary = pair.friction.thresholds[0]
    fluid_law = law_of(pair.friction).fluid_film
    state: State = "warning" if fluid_law and low < boundary else "ok"
    return flag(
        "film_parameter",
        state,
        low,
        f"film parameter {low:.3g} to {high:.3g} along the path of contact, boundary lubrication "
        f"below {boundary:g}",
    )


def torque_balance(pair: GearPair, motion: xr.Dataset) -> Flag:
    """Check that the torques keep the mean speed: otherwise there is no periodic motion."""
    needed = float(motion.attrs["pinion_torque"])
    operating_torque = pair.operating.pinion_torque
    excess = abs(needed - operating_torque) / operating_torque
    state = _state(excess, (1e-9, 0.05))
    brake = float(motion.attrs["brake_torque"])
    if state == "ok":
        detail = f"a brake torque of {brake:.6g} N m holds the mean speed"
    else:
        detail = (
            f"with the given brake torque of {brake:.6g} N m the drive must give {needed:.6g} N m, "
            f"not {operating_torque:.6g} N m"
        )
    return flag("torque_balance", state, excess, detail)


def speed_drift(g: Geometry, motion: xr.Dataset) -> Flag:
    """Check that the mean speed does not drift over the run."""
    time = motion["time"].to_numpy()
    rate = motion["theta_p_dot"].to_numpy()
    last = time >= time[-1] - g.mesh_period
    first = time <= time[0] + g.mesh_period
    drift = abs(float(rate[last].mean() - rate[first].mean())) / g.omega_pinion
    state = _state(drift, DRIFT_LIMITS)
    return flag(
        "speed_drift",
        state,
        drift,
        f"the mean pinion speed of the last mesh cycle differs from that of the first by {drift:.2e} "
        "of the nominal speed",
    )


def solution_error(motion: xr.Dataset) -> Flag:
    """Check that the periodic motion is accurate."""
    error = float(motion.attrs["error_estimate"])
    state = _state(error, ERROR_LIMITS)
    return flag(
        "solution_error",
        state,
        error,
        f"estimated relative error of the transmission error {error:.1e}; mismatch after one cycle "
        f"{float(motion.attrs['closure']):.1e}",
    )


def stability(multipliers: GearPairMultipliers) -> Flag:
    """Check that disturbances of the periodic motion die out: all multipliers are inside the unit circle."""
    radius = multipliers.spectral_radius
    error = multipliers.error
    states: dict[str, State] = {
        "stable": "ok",
        "neutral": "warning",  # bounded, but no disturbance dies out
        "undecided": "warning",
        "unstable": "violated",
    }
    state = states[multipliers.verdict]
    return flag(
        "stability",
        state,
        radius,
        f"{multipliers.verdict_words}: largest multiplier {radius:.6f}, error at most {error:.1e}. The rigid "
        "rotation of both gears is excluded",
    )
