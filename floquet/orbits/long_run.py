"""What a motion settles to: a periodic motion, beats or chaos.

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
from lumped.errors import NumericalError
from lumped.typing import FloatArray

Settled = Literal["periodic", "beats", "chaos", "grows"]

_RECURS = 1e-6
_NEAR = 0.3
#: A run that has not settled goes on for twice as long, so many times in all.
_TURNS = 4
#: Blocks of cycles of an exponent; the first is not counted.
BLOCKS = 8
#: A run is looked at for so many times the cycles of the motions looked for: locked beats repeat after many.
_LOOKED = 8
#: Largest exponent per cycle that counts as zero; quasi-periodic motions come to it as the inverse of the
#: length.
_ZERO_EXPONENT = 5e-3
#: Cycles between two looks at a deadline.
_PART = 32


@dataclass(frozen=True, eq=False)
class LongRun:
    """The motion to which a run has settled.

    Attributes
    ----------
    kind : "periodic", "beats" (quasi-periodic), "chaos", or "grows" beyond the amplitude of interest
    orbit : the periodic motion, where it is one
    exponent, uncertainty : largest Lyapunov exponent per cycle and its standard error; NaN for a periodic
        motion, whose multipliers say more
    run : the last cycles, with means, extremes and the state at the end; None where it grows
    parameter : the free parameter, found with the periodic motion where it is one
    """

    kind: Settled
    orbit: Orbit | None
    exponent: float
    uncertainty: float
    run: Run | None
    parameter: float

    @property
    def rms(self) -> float:
        """Of the output less its mean; NaN where the motion grows."""
        return float("nan") if self.run is None else self.run.rms

    @property
    def largest_load(self) -> float:
        """Of all contacts; NaN where the motion grows."""
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
    """Let a motion settle, and find out whether it is periodic, beats, chaos, or grows.

    First it is compared with itself after 1 to 8 n cycles, then Newton's method looks for a stable motion of
    1 to n cycles near it, since near a bifurcation settling takes long; what is left has its Lyapunov
    exponent measured. Where that is negative the run is on its way to a motion that repeats, and goes on.

    Parameters
    ----------
    settle : cycles before it is looked at for the first time
    observe : cycles over which exponents and means are taken
    most_cycles : largest n
    amplitude : largest motion of the output from its mean that is looked at
    deadline : OutOfTimeError where it passes before that is known
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
        if exponent > -zero:  # else it has left for a motion that repeats, and will have reached it next time
            break
    last = _run(system, state, period, observe, parameter, deadline)
    return LongRun("chaos" if exponent > zero else "beats", None, exponent, uncertainty, last, parameter)


def _run(
    system: ContactSystem, start: FloatArray, period: float, cycles: int, parameter: float, deadline: Deadline
) -> Run:
    """`ContactSystem.run`, in parts where there is a deadline."""
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
    """A run of some cycles and the next ones, as one."""
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
    """The stable periodic motion that a run has come to or comes near to."""
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
    """Largest Lyapunov exponent per cycle and its standard error by blocks, from a state on the motion.

    The first eighth of the cycles turns the vector into its direction and is not counted.
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
