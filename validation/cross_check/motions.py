"""The motions that a cross-check compares, over whole mesh cycles.

Sources: docs/theory/validity.md, "Beyond contact loss".
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress

import numpy as np
import xarray as xr

import floquet
import lumped
import multibody
from floquet.gear.motions import GearOrbit
from lumped import GearPair
from lumped.errors import NumericalError
from lumped.model.results import a_pair_pulls
from lumped.typing import FloatArray
from validation.cross_check.agreement import COMPANION, Fidelity, is_constant
from validation.cross_check.verdict import SAME_EQUATIONS

#: Tolerances of the integrations for motions of ordinary size: far below the limits of the checks. The size
#: is the smallest limit over the deflection, as a share of the limit of the transmission error.
_RTOL: Mapping[str, float] = {"linear": 1e-9, "exact": 1e-8}
_ORDINARY = 0.2
#: Smallest factor of the tolerance at "linear" for a smaller motion.
_TIGHTER = 0.001
#: Velocity over which friction changes its sign where the integrator fails with the model's choice [m/s].
_BLUNT = 0.01
#: Largest change of the peak to peak by momentary loads at which the motion is still the same.
_NEAR = 0.25
#: Effects of the multibody model where contact is lost.
CONTACT_LOSS: Mapping[Fidelity, Mapping[str, bool] | Sequence[str]] = {
    "linear": ["contact_loss"],
    "exact": {"clearance": True},
}
_PULL = "The lumped motion that was compared needs teeth that pull, which real teeth cannot:"
_ADVICE = "More torque or damping, or another speed, keeps the teeth in contact."


def unilateral_orbit(pair: GearPair) -> tuple[GearOrbit | None, str]:
    """The stable motion of one mesh cycle with loss of contact with which the multibody model is compared.

    None: the teeth of the linear motion push all the time, or no stable motion of one mesh cycle is found.
    The search starts near the linear motion; then a run from the linear motion settles. Where no motion is
    found, the second value says why a motion in which teeth pull is compared. Else the second value is empty.
    """
    motion = lumped.steady_state(pair, supports="springs", samples_per_cycle=512)
    if not a_pair_pulls(pair, motion):
        return None, ""
    try:
        orbit = settled_orbit(pair)
    except NumericalError:
        return None, f"{_PULL} no periodic motion with contact loss was found. {_ADVICE}"
    if not orbit.stable or orbit.n > 1:
        return None, f"{_PULL} with contact loss no motion of one mesh cycle is stable. {_ADVICE}"
    if orbit.reaches_back_side:
        backlash = f"{pair.geometry.normal_backlash * 1e6:.3g} um"
        return None, (
            f"{_PULL} with contact loss the backs of the teeth strike, beyond the normal backlash of "
            f"{backlash}. State the real mesh.backlash if that is too little. {_ADVICE}"
        )
    return orbit, ""


def settled_orbit(pair: GearPair) -> GearOrbit:
    """The motion with unilateral contact to which a run settles.

    Tangents and dampers belong to the static load. Newton's method starts from the linear motion. If the
    result is not stable, a run is computed until the run settles.

    Raises NumericalError : the motion does not repeat, or does not stay bounded
    """
    with suppress(NumericalError):
        orbit = floquet.periodic_orbit(pair)
        if orbit.stable:
            return orbit
    settled = floquet.long_run(pair)
    if settled.orbit is None:
        raise NumericalError(
            f"The motion with unilateral contact does not repeat: {settled.kind}. Read its branches over "
            "speed: spurcheck response."
        )
    return GearOrbit(pair, settled.orbit)


def momentary_motion(pair: GearPair, linear: xr.Dataset, samples: int) -> xr.Dataset | None:
    """The lumped motion by momentary load over one mesh cycle, on springs; None: no motion near ``linear``.

    linear : the lumped motion with tangents and dampers of the static load
    """
    with suppress(NumericalError):
        motion = lumped.steady_state(
            pair, contact="unilateral", supports="springs", samples_per_cycle=samples
        )
        swing = float(np.ptp(motion["dte"].to_numpy()))
        linear_swing = float(np.ptp(linear["dte"].to_numpy()))
        if motion.attrs["period_cycles"] == 1 and abs(swing - linear_swing) <= _NEAR * linear_swing:
            return motion
    return None


def integration_tolerances(values: Mapping[str, FloatArray]) -> dict[str, float]:
    """Relative tolerances of "linear" and "exact" for histories (quantity -> one mesh cycle).

    The error of an integrator is proportional to the deflection. The limits at fidelity "linear" are shares
    of the peak to peak. Above the resonances the peak to peak is a thousandth of the deflection and less, and
    it is smallest across the line of action. So the tolerance follows the smallest limit.
    """
    deflection = abs(float(np.mean(values["dte"])))
    limits = [
        SAME_EQUATIONS[name] * float(np.ptp(values[name]))
        for name in ("dte", "x_p", "x_g", "y_p", "y_g")
        if not is_constant(values[name], values[COMPANION[name]] if name in COMPANION else 0.0)
    ]
    share = min(limits, default=np.inf) / (SAME_EQUATIONS["dte"] * max(deflection, np.finfo(float).tiny))
    tighter = float(np.clip(share / _ORDINARY, _TIGHTER, 1.0))
    return {name: value if name == "exact" else value * tighter for name, value in _RTOL.items()}


def periodic_motion(
    pair: GearPair, fidelity: Fidelity, samples: int, rtol: float, orbit: GearOrbit | None
) -> xr.Dataset | None:
    """Motion of the multibody model over one mesh cycle. None: no motion near the lumped motion.

    The integrator may fail where friction changes its sign. Then the search is repeated with a change of sign
    over a larger velocity.

    orbit : the lumped motion with contact loss, if there is one; then flanks touch where they meet, also with
        relief
    """
    for velocity in (None, _BLUNT):
        try:
            return multibody.steady_state(
                pair,
                fidelity=fidelity,
                samples_per_cycle=samples,
                initial=None if orbit is None else orbit.states[0],
                effects=None if orbit is None else CONTACT_LOSS[fidelity],
                rtol=rtol,
                friction_velocity=velocity,
                supports="springs",
            )
        except NumericalError:
            continue
    return None


def repeated(cycle: xr.Dataset, cycles: int) -> xr.Dataset:
    """Repeat a motion of one mesh cycle over several cycles. The end of the last cycle is added."""
    samples = cycle.sizes["time"]
    period = float(cycle["time"][1]) * cycle.sizes["time"]
    number = np.arange(cycles * samples + 1)
    time = period * (number // samples) + cycle["time"].to_numpy()[number % samples]
    repeated = cycle.isel(time=number % samples).assign_coords(time=("time", time, cycle["time"].attrs))
    repeated.attrs |= {"cycles": cycles}
    return repeated
