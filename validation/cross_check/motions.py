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
from lumped.model.results import LOAD_NOISE
from lumped.typing import FloatArray
from validation.cross_check.agreement import COMPANION, Fidelity, is_constant
from validation.cross_check.verdict import SAME_EQUATIONS

#: Tolerances of the integrations: far below the limits they are used to check, where a motion has an ordinary
#: size: the smallest limit over the deflection, as a share of that of the transmission error.
_RTOL: Mapping[str, float] = {"linear": 1e-9, "exact": 1e-8}
_ORDINARY = 0.2
#: Most by which the first is tightened for a smaller motion.
_TIGHTER = 0.001
#: Velocity over which friction changes its sign where the integrator cannot follow the model's own one [m/s].
_BLUNT = 0.01
#: Change of the peak to peak by momentary loads, at most, that is still the same motion.
_NEAR = 0.25
#: Effects of the multibody model where contact is lost.
CONTACT_LOSS: Mapping[Fidelity, Mapping[str, bool] | Sequence[str]] = {
    "linear": ["contact_loss"],
    "exact": {"clearance": True},
}
_PULL = "The lumped motion that was compared needs teeth that pull, which real teeth cannot:"
_ADVICE = "More torque or damping, or another speed, keeps the teeth in contact."


def unilateral_orbit(pair: GearPair) -> tuple[GearOrbit | None, str]:
    """The stable motion of one mesh cycle with loss of contact that the multibody model is compared with.

    None where the teeth of the linear motion push all the time, or where no such motion is found: neither
    near the linear motion, nor where a run settles that starts there. Then the second value says why a motion
    is compared in which teeth pull; else it is empty.
    """
    motion = lumped.steady_state(pair, supports="springs", samples_per_cycle=512)
    least = -LOAD_NOISE * pair.operating.pinion_torque / pair.geometry.base_radius_pinion
    if float(motion["normal_load"].min()) >= least:
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
    """The motion with unilateral contact, tangents and dampers those of the static load, that a run comes to.

    It is the one that Newton's method finds from the linear motion, if that is stable; else the one to which
    a run settles. A NumericalError says that the motion does not repeat, or does not stay bounded.
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
    """The lumped motion by momentary load over one mesh cycle, on springs; None where none is near the other.

    ``linear`` has the tangents and dampers of the static load.
    """
    with suppress(NumericalError):
        found = lumped.steady_state(pair, contact="unilateral", supports="springs", samples_per_cycle=samples)
        swings = float(np.ptp(found["dte"].to_numpy())), float(np.ptp(linear["dte"].to_numpy()))
        if found.attrs["period_cycles"] == 1 and abs(swings[0] - swings[1]) <= _NEAR * swings[1]:
            return found
    return None


def integration_tolerances(values: Mapping[str, FloatArray]) -> dict[str, float]:
    """Relative tolerances of "linear" and "exact" for histories (quantity -> one mesh cycle).

    An integrator errs in proportion to the deflection. The limits at fidelity "linear" are shares of the peak
    to peak, which above the resonances is a thousandth of the deflection and less, and smallest off the line
    of action. So the tolerance follows the smallest limit.
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
    """Motion of the multibody model over one mesh cycle; None where there is none near the lumped one.

    ``orbit`` is the lumped motion with contact loss, if there is one; then flanks touch where they meet, also
    with relief. Where the model cannot go on with its own change of the sign of friction a blunter one is
    tried.
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
    """A motion of one mesh cycle, its end left out, over several cycles, the last end included."""
    samples = cycle.sizes["time"]
    period = float(cycle["time"][1]) * cycle.sizes["time"]
    number = np.arange(cycles * samples + 1)
    time = period * (number // samples) + cycle["time"].to_numpy()[number % samples]
    repeated = cycle.isel(time=number % samples).assign_coords(time=("time", time, cycle["time"].attrs))
    repeated.attrs |= {"cycles": cycles}
    return repeated
