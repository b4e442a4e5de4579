"""The motions that a cross-check compares, over whole mesh cycles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

import lumped
import multibody
from floquet.gear.orbit import GearOrbit
from lumped import GearPair
from lumped.errors import NumericalError
from lumped.typing import FloatArray, Progress
from multibody.contact.machine import friction_velocity, machine
from validation.cross_check import metrics
from validation.cross_check.agreement import Fidelity
from validation.cross_check.tolerances import GROUPS, LINEAR

#: Tolerances of the integrations: far below the limits they are used to check, where a motion has an ordinary
#: size: the smallest limit over the deflection, as a share of that of the transmission error.
_RTOL: Mapping[str, float] = {"lumped": 1e-10, "linear": 1e-9, "exact": 1e-8}
_ORDINARY = 0.2
#: Most by which the first two are tightened for a smaller motion. The exact model need not be: its limits are
#: shares of the shift of the contact.
_TIGHTER = 0.001
#: Cycles over which the lumped integrator carries the periodic motion, until a stable one repeats.
_CARRIED_CYCLES = (2, 6)
#: A cycle repeats the one before to this share of peak to peak, a hundredth of the limits of the comparison.
_REPEATED = 1e-8
#: Share of the default velocity over which friction changes its sign, where sliding does not stick: there a
#: sharper change costs little. The default leaves twice the tolerance in y at the Kahraman-Blankenship pair.
_SHARPER = 0.01
#: Velocity for a motion that the integrator cannot follow with a sharper one [m/s].
BLUNT = 0.01
#: Effects where teeth part.
PARTED: Mapping[Fidelity, Mapping[str, bool] | Sequence[str]] = {
    "linear": ["contact_loss"],
    "exact": {"clearance": True},
}


def integration_tolerances(values: Mapping[str, FloatArray]) -> dict[str, float]:
    """Relative tolerances of "lumped", "linear" and "exact" for a motion of this size.

    An integrator errs in proportion to the deflection. The limits at fidelity "linear" are shares of the peak
    to peak, which above the resonances is a thousandth of the deflection and less, and smallest off the line
    of action. So the tolerance follows the smallest limit.

    Parameters
    ----------
    values : quantity -> lumped history over a mesh cycle
    """
    deflection = abs(float(np.mean(values["dte"])))
    limits = [
        LINEAR[GROUPS[name]].limit * float(np.ptp(values[name]))
        for name in ("dte", "x_p", "x_g", "y_p", "y_g")
        if not metrics.is_constant(values[name])
    ]
    share = min(limits, default=np.inf) / (LINEAR["dte"].limit * max(deflection, np.finfo(float).tiny))
    tighter = float(np.clip(share / _ORDINARY, _TIGHTER, 1.0))
    return {name: value if name == "exact" else value * tighter for name, value in _RTOL.items()}


def periodic_motion(
    pair: GearPair,
    fidelity: Fidelity,
    *,
    samples: int,
    rtol: float,
    passes: bool,
    orbit: GearOrbit | None = None,
) -> xr.Dataset:
    """Motion of the multibody model over one mesh cycle.

    Where it cannot go on with sharp changes of the sign of friction they are blunter.

    Parameters
    ----------
    pair : the gear pair
    fidelity, rtol : as ``multibody.steady_state``
    samples : output times
    passes : whether the teeth pass zero sliding without being held (``FiniteMotion.settled``)
    orbit : lumped motion of teeth that part; then flanks touch where they meet, and so also with relief

    Raises
    ------
    NumericalError : no periodic motion is found near the lumped one
    """
    sharp = _SHARPER * friction_velocity(machine(pair))[0] if passes else None

    def motion(velocity: float | None) -> xr.Dataset:
        return multibody.steady_state(
            pair,
            fidelity=fidelity,
            samples_per_cycle=samples,
            initial=None if orbit is None else orbit.states[0],
            effects=None if orbit is None else PARTED[fidelity],
            rtol=rtol,
            friction_velocity=velocity,
        )

    try:
        return motion(sharp)
    except NumericalError:
        return motion(BLUNT)


def near_periodic(
    pair: GearPair, fidelity: Fidelity, samples: int, rtol: float, passes: bool, orbit: GearOrbit | None
) -> xr.Dataset | None:
    """The same; None where there is none near the lumped one."""
    try:
        return periodic_motion(pair, fidelity, samples=samples, rtol=rtol, passes=passes, orbit=orbit)
    except NumericalError:
        return None


def lumped_motion(
    pair: GearPair, cycles: int, samples: int, rtol: float, stable: bool, progress: Progress | None
) -> xr.Dataset:
    """The lumped motion from the periodic solution on, over whole cycles.

    A stable one repeats its last simulated cycle, if that repeats the one before: where mu(xi) is steep the
    periodic solution itself may be off by some 1e-6, which the motion then forgets.
    """
    options = {"samples_per_cycle": samples, "initial": "periodic", "rtol": rtol}
    for carried in [n for n in _CARRIED_CYCLES if stable and n < cycles] + [cycles]:
        run = lumped.simulate(pair, carried, **options, progress=progress)  # type: ignore[arg-type]
        if carried == cycles:
            return run
        if _repeats(run, samples):
            break
    number = np.arange(cycles * samples + 1)
    first = (carried - 1) * samples
    last = first + (number - first) % samples
    period = float(run["time"][-1]) / carried
    time = period * (number // samples) + run["time"].to_numpy()[number % samples]
    repeated = run.isel(time=np.where(number < carried * samples, number, last))
    repeated = repeated.assign_coords(time=("time", time, run["time"].attrs))
    repeated.attrs |= {"cycles": cycles}
    return repeated


def _repeats(run: xr.Dataset, samples: int) -> bool:
    """Whether the last cycle is the one before, in every translation and the transmission error."""
    least = 1e-6 * float(np.ptp(run["dte"].to_numpy()))  # what moves less is rounding
    for name in ("dte", "x_p", "x_g", "y_p", "y_g"):
        before, last = run[name].to_numpy()[-2 * samples - 1 : -1].reshape(2, samples)
        if np.abs(last - before).max() > _REPEATED * max(float(np.ptp(last)), least):
            return False
    return True


def repeated(cycle: xr.Dataset, cycles: int) -> xr.Dataset:
    """A motion of one mesh cycle, its end left out, over several cycles, the last end included."""
    samples, period = cycle.sizes["time"], float(cycle["time"][1]) * cycle.sizes["time"]
    number = np.arange(cycles * samples + 1)
    time = period * (number // samples) + cycle["time"].to_numpy()[number % samples]
    repeated = cycle.isel(time=number % samples).assign_coords(time=("time", time, cycle["time"].attrs))
    repeated.attrs |= {"cycles": cycles}
    return repeated
