"""The motion to which a long run settles: a periodic motion, beats or chaos.

Sources: docs/theory/orbits.md, "Motions that do not repeat"; Lyapunov exponent by re-normalised tangent
vectors: Benettin, Galgani, Giorgilli and Strelcyn, Meccanica 15 (1980) 9.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from floquet.orbits.closing import close_orbit, primitive
from floquet.orbits.deadline import ENDLESS, Deadline
from floquet.orbits.orbit import Orbit, state_scale
from floquet.orbits.system import ContactSystem, Run
from lumped.display.result import DisplayedResult
from lumped.errors import NumericalError
from lumped.typing import FloatArray

Settled = Literal["periodic", "beats", "chaos", "grows"]

_RECURS = 1e-6
_NEAR = 0.3
#: A run that has not settled settles again for twice as many cycles, at most so many times.
_TURNS = 4
#: Number of blocks of cycles over which an exponent is measured. The first block is not counted.
BLOCKS = 8
#: Cycles over which a run is compared with itself, over ``most_cycles``: locked beats repeat after many
#: cycles.
_LOOKED = 8
#: Largest exponent per cycle that counts as zero. The measured exponent of a quasi-periodic motion falls as
#: the inverse of the number of cycles.
_ZERO_EXPONENT = 5e-3
#: Cycles between two checks of a deadline.
_PART = 32


@dataclass(frozen=True, eq=False, repr=False)
class LongRun(DisplayedResult):
    """The motion to which a run has settled.

    Attributes
    ----------
    kind : "periodic", "beats" (quasi-periodic), "chaos", or "grows" beyond the amplitude of interest
    orbit : the periodic motion; None: the motion is not periodic
    exponent, uncertainty : largest Lyapunov exponent per cycle and standard error of the exponent; NaN for a
        periodic motion, because the multipliers say more
    run : the last cycles, with means, extremes and the state at the end; None: the motion grows
    parameter : the free parameter; for a periodic motion the solution of Newton's method
    """

    kind: Settled
    orbit: Orbit | None
    exponent: float
    uncertainty: float
    run: Run | None
    parameter: float

    @property
    def rms(self) -> float:
        """Root mean square of the output about the mean; NaN where the motion grows."""
        return float("nan") if self.run is None else self.run.rms

    @property
    def largest_load(self) -> float:
        """Largest load of all contacts; NaN where the motion grows."""
        return float("nan") if self.run is None else self.run.largest_load


def long_run(
    system: ContactSystem,
    start: FloatArray,
    period: float,
    parameter: float = 0.0,
    *,
    settle: int = 400,
    observe: int = 800,
    most_cycles: int = 8,
    amplitude: float = np.inf,
    deadline: Deadline = ENDLESS,
) -> LongRun:
    """Let a motion settle, and say whether the motion is periodic, beats, chaos, or grows.

    First the run is compared with itself after 1 to 8 n cycles. Then Newton's method looks for a stable
    motion of 1 to n cycles near the run, because settling is slow near a bifurcation. Then the Lyapunov
    exponent of the run is measured. A negative exponent says that the run approaches a motion that repeats:
    the run continues.

    Parameters
    ----------
    settle : cycles before the first comparison
    observe : cycles over which exponents and means are taken
    most_cycles : largest n
    amplitude : largest motion of the output from its mean; a motion beyond "grows"
    deadline : OutOfTimeError: the deadline has passed before the motion is known
    """
    state = start
    for turn in range(_TURNS + 1):
        try:
            settled = _run(system, state, period, settle << turn, parameter, deadline)
            seen = system.run(settled.end, period, _LOOKED * most_cycles, parameter, samples=np.zeros(1))
        except NumericalError:
            return grown(parameter)
        if max(seen.most - seen.mean, seen.mean - seen.least) > amplitude:
            return grown(parameter)
        orbit = _periodic(system, seen, period, parameter, most_cycles, deadline)
        if orbit is not None:
            return LongRun("periodic", orbit, float("nan"), float("nan"), orbit.run, orbit.parameter)
        state = seen.end
        if turn < _TURNS - 1:
            continue
        exponent, uncertainty = lyapunov_exponent(system, state, period, parameter, observe, deadline)
        zero = max(3.0 * uncertainty, _ZERO_EXPONENT)
        if exponent > -zero:  # else the run approaches a motion that repeats, and reaches it in the next turn
            break
    last = _run(system, state, period, observe, parameter, deadline)
    return LongRun("chaos" if exponent > zero else "beats", None, exponent, uncertainty, last, parameter)


def _run(
    system: ContactSystem, start: FloatArray, period: float, cycles: int, parameter: float, deadline: Deadline
) -> Run:
    """`ContactSystem.run`, split into parts where there is a deadline."""
    if not deadline.limited or cycles <= _PART:
        return system.run(start, period, cycles, parameter)
    done = 0
    result = None
    while done < cycles:
        deadline.check()
        count = min(_PART, cycles - done)
        part = system.run(start if result is None else result.end, period, count, parameter)
        result = part if result is None else _joined(result, done, part, count)
        done += count
    assert result is not None
    return result


def _joined(one: Run, cycles: int, other: Run, more: int) -> Run:
    """One run from a run of some cycles and the run of the next cycles."""
    share = more / (cycles + more)
    return replace(
        other,
        start=one.start,
        accumulated=one.accumulated + other.accumulated,
        mean=one.mean + share * (other.mean - one.mean),
        mean_square=one.mean_square + share * (other.mean_square - one.mean_square),
        least=min(one.least, other.least),
        most=max(one.most, other.most),
        largest_load=max(one.largest_load, other.largest_load),
        least_load=min(one.least_load, other.least_load),
    )


def _periodic(
    system: ContactSystem, seen: Run, period: float, parameter: float, most_cycles: int, deadline: Deadline
) -> Orbit | None:
    """The stable periodic motion to which a run has settled or comes near. None: no such motion was found."""
    scale = state_scale(seen.end)
    recurs = [
        n for n in range(1, len(seen.states)) if (np.abs(seen.states[-n] - seen.end) <= _RECURS * scale).all()
    ]
    for n in recurs[:1] or range(1, most_cycles + 1):
        deadline.check()
        try:
            orbit = primitive(close_orbit(system, seen.end, period, n, parameter))
        except NumericalError:
            continue
        if orbit.stable and (recurs or _near(orbit, seen)):
            return orbit
    return None


def _near(orbit: Orbit, seen: Run) -> bool:
    """Whether a run may be settling to a periodic motion: both have nearly equal extremes."""
    near = _NEAR * (seen.most - seen.least)
    return abs(orbit.run.least - seen.least) < near and abs(orbit.run.most - seen.most) < near


def grown(parameter: float) -> LongRun:
    """The result of a run that grows."""
    return LongRun("grows", None, float("nan"), float("nan"), None, parameter)


def lyapunov_exponent(
    system: ContactSystem,
    start: FloatArray,
    period: float,
    parameter: float = 0.0,
    cycles: int = 800,
    deadline: Deadline = ENDLESS,
) -> tuple[float, float]:
    """Largest Lyapunov exponent per cycle, from a state on the motion, and standard error by blocks.

    In the first eighth of the cycles the tangent vector turns to the direction of largest growth. This eighth
    is not counted.
    """
    scale = state_scale(start)
    vector = 1.0 / (1.0 + 0.6180339887 * np.arange(start.size))
    growth = np.empty(cycles)
    x = start
    for j in range(cycles):
        deadline.check()
        run = system.run(x, period, 1, parameter, derivatives=True)
        vector = (run.derivative[: start.size, : start.size] @ (vector * scale)) / scale
        length = float(np.linalg.norm(vector))
        growth[j] = np.log(length)
        vector = vector / length
        x = run.end
    counted = growth[cycles // BLOCKS :]
    blocks = np.array([block.mean() for block in np.array_split(counted, BLOCKS - 1)])
    return float(counted.mean()), float(blocks.std(ddof=1) / np.sqrt(blocks.size))
