"""A periodic motion: multipliers, test whether the motion closes, and comparison of two motions.

`floquet.orbits.closing` finds periodic motions.

Sources: docs/theory/orbits.md, "Periodic motions".
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from floquet.orbits.records import CLOSED
from floquet.orbits.system import ContactSystem, Run
from lumped.typing import ComplexArray, FloatArray

#: Residual of a motion that counts as periodic, over the largest displacement or phase rate.
CLOSED_TO = 1e-11
#: Rounding of the accumulated row over the part that the parameter alone accumulates. At low speeds, where
#: the cycle is long, this part is far larger than a state, and no value of the parameter closes the row
#: better.
_BALANCED_TO = 16.0 * float(np.finfo(np.float64).eps)
_LOWER_ORDER = 14


@dataclass(frozen=True, eq=False)
class Orbit:
    """A periodic motion of a system with unilateral contacts.

    Attributes
    ----------
    system : the system at this period
    period : T of one cycle [s]
    n : number of cycles after which the motion repeats
    parameter : the free parameter, the solution of Newton's method
    run : one pass of the motion, with derivatives, events, and the state at the start of each cycle
    """

    system: ContactSystem
    period: float
    n: int
    parameter: float
    run: Run

    @property
    def start(self) -> FloatArray:
        """(2m,) displacements and phase rates at phase 0."""
        return self.run.start

    @cached_property
    def monodromy(self) -> FloatArray:
        """(2m, 2m) derivative of the state after n cycles by the state, the parameter held."""
        size = self.system.size
        return self.run.derivative[:size, :size]

    @cached_property
    def multipliers(self) -> ComplexArray:
        """(2m,) Floquet multipliers over n cycles, largest first."""
        values = np.linalg.eigvals(self.monodromy)
        return np.asarray(values[np.argsort(-np.abs(values), kind="stable")], dtype=complex)

    @property
    def spectral_radius(self) -> float:
        """Largest modulus of the multipliers over n cycles."""
        return float(np.abs(self.multipliers[0]))

    @property
    def stable(self) -> bool:
        """Whether every multiplier lies in the unit circle."""
        return self.spectral_radius < 1.0

    @cached_property
    def error(self) -> float:
        """Estimate of the error of the multipliers.

        A second pass with series of lower order gives the error of the monodromy matrix. The condition of the
        eigenvectors turns this error into the error of the multipliers (Bauer and Fike).
        """
        low = self.system.run(
            self.start, self.period, self.n, self.parameter, derivatives=True, order=_LOWER_ORDER
        )
        size = self.system.size
        scale = state_scale(self.start)
        to_norm = scale / scale[:, None]
        M = self.monodromy * to_norm
        truncation = np.linalg.norm(low.derivative[:size, :size] * to_norm - M, 2)
        rounding = 1e-15 * np.linalg.norm(M, 2) * self.n
        return float(np.linalg.cond(np.linalg.eig(M)[1]) * (truncation + rounding))

    @property
    def closes(self) -> bool:
        """Whether the motion is periodic to rounding, in the state and in the accumulated row.

        The scales of the state are the largest displacement and the largest phase rate.
        """
        run = self.run
        scale = np.maximum(state_scale(run.start), state_scale(run.end))
        gathered = np.abs(self.parameter * run.derivative[self.system.size :, -1])
        imbalance = np.abs(run.accumulated) / np.maximum(CLOSED_TO * scale[-1], _BALANCED_TO * gathered)
        return bool((np.abs(run.end - run.start) < CLOSED_TO * scale).all() and (imbalance < 1.0).all())

    @property
    def signature(self) -> tuple[tuple[int, int], ...]:
        """The order of contact events, (contact, new state)."""
        events = self.run.events
        return tuple(zip(events["contact"].tolist(), events["state"].tolist(), strict=True))

    @property
    def contact_lost(self) -> bool:
        """Whether a contact changes its state in the motion."""
        return bool(self.run.events.size)

    @property
    def strikes(self) -> bool:
        """Whether a contact closes after a gap, where the damper's load begins at once."""
        return any(new == CLOSED for _, new in self.signature)

    def shifted(self) -> list[FloatArray]:
        """States (2m,) at the start of each of the n cycles: any of the states starts the same motion."""
        return list(self.run.states)


def state_scale(start: FloatArray) -> FloatArray:
    """(2m,) largest displacement and largest phase rate of a state, which scale a norm of states."""
    m = start.size // 2
    length = max(float(np.abs(start[:m]).max()), 1e-300)
    rate = max(float(np.abs(start[m:]).max()), length)
    return np.repeat([length, rate], m)


def same_motion(one: Orbit, other: Orbit, tolerance: float = 1e-6) -> bool:
    """Whether two orbits at one period are one motion. The orbits may start in different cycles.

    A motion of n cycles may also repeat after a divisor of n: an orbit over the divisor is the same motion.
    """
    scale = state_scale(one.start) * tolerance
    return any(bool((np.abs(start - one.start) <= scale).all()) for start in other.shifted())
