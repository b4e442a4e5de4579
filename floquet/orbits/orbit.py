"""Periodic motions by Newton's method on the map over n cycles.

Sources: docs/theory/orbits.md, "Periodic motions".
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from floquet.orbits.kernel import CLOSED
from floquet.orbits.system import ContactSystem, Run
from lumped.errors import NumericalError
from lumped.typing import ComplexArray, FloatArray

#: Residual of a motion that counts as periodic, over the largest displacement or phase rate.
CLOSED_TO = 1e-11
#: Rounding of the accumulated row over what the parameter alone gathers: at low speeds, where the cycle is
#: long, that is far more than a state, and no number for the parameter closes the row better.
_BALANCED_TO = 16.0 * float(np.finfo(np.float64).eps)
_MOST_ITERATIONS = 15
_LOWER_ORDER = 14
_MOST_EVENTS = 1024
_CYCLE_STARTS = np.zeros(1)


@dataclass(frozen=True, eq=False)
class Orbit:
    """A periodic motion of a system with unilateral contacts.

    Attributes
    ----------
    system : the system at this period
    period : T of one cycle [s]
    n : number of cycles after which it repeats
    parameter : the free parameter, as found
    run : one pass of it, with derivatives, its events, and the state at the start of each cycle
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
        """(2m,) over n cycles, largest first."""
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

        The same pass with series of lower order says how far the matrix may be off, and the condition of its
        eigenvectors by how much the multipliers move (Bauer and Fike).
        """
        low = self.system.run(
            self.start, self.period, self.n, self.parameter, derivatives=True, order=_LOWER_ORDER
        )
        size = self.system.size
        scale = state_scale(self.start)
        to_norm = scale / scale[:, None]
        M = self.monodromy * to_norm
        off = np.linalg.norm(low.derivative[:size, :size] * to_norm - M, 2)
        rounding = 1e-15 * np.linalg.norm(M, 2) * self.n
        return float(np.linalg.cond(np.linalg.eig(M)[1]) * (off + rounding))

    @property
    def closes(self) -> bool:
        """Whether it is periodic to rounding: the state by its largest displacement and rate, and the row."""
        run = self.run
        scale = np.maximum(state_scale(run.start), state_scale(run.end))
        gathered = np.abs(self.parameter * run.derivative[self.system.size :, -1])
        off = np.abs(run.accumulated) / np.maximum(CLOSED_TO * scale[-1], _BALANCED_TO * gathered)
        return bool((np.abs(run.end - run.start) < CLOSED_TO * scale).all() and (off < 1.0).all())

    @property
    def signature(self) -> tuple[tuple[int, int], ...]:
        """The order of contact events, (contact, new state)."""
        return tuple((int(i), int(new)) for _, i, new in self.run.events)

    @property
    def contact_lost(self) -> bool:
        """Whether a contact changes its state in the motion."""
        return bool(self.run.events.shape[0])

    @property
    def strikes(self) -> bool:
        """Whether a contact closes after a gap, with its damper's load at once."""
        return any(new == CLOSED for _, new in self.signature)

    def shifted(self) -> list[FloatArray]:
        """States (2m,) at the start of each of its n cycles: all belong to the same motion."""
        return list(self.run.states)


def state_scale(start: FloatArray) -> FloatArray:
    """(2m,) sizes of displacements and of phase rates: for norms that mean something."""
    m = start.size // 2
    length = max(float(np.abs(start[:m]).max()), 1e-300)
    rate = max(float(np.abs(start[m:]).max()), length)
    return np.repeat([length, rate], m)


def one_pass(
    system: ContactSystem, start: FloatArray, period: float, n: int, parameter: float
) -> tuple[FloatArray, FloatArray, Run]:
    """Mismatch (2m + r,) of n cycles and of the accumulated rows, its derivatives, and the run.

    The derivatives (2m + r, 2m + 2) are by the start, T and the parameter.
    """
    run = system.run(
        start, period, n, parameter, derivatives=True, logged=_MOST_EVENTS, samples=_CYCLE_STARTS
    )
    J = run.derivative.copy()
    J[: system.size, : system.size] -= np.eye(system.size)
    return np.concatenate([run.end - run.start, run.accumulated]), J, run


def find_orbit(
    system: ContactSystem, start: FloatArray, period: float, n: int = 1, parameter: float = 0.0
) -> Orbit:
    """Periodic motion of n cycles by Newton's method at a fixed period T [s].

    It starts from displacements and phase rates (2m,), and from ``parameter`` where the system has an
    accumulated row. Raises NumericalError where no motion is found.
    """
    x = np.array(start, dtype=float)
    size = system.size
    unknowns = [*range(size), *([size + 1] if system.balanced else [])]
    for _ in range(_MOST_ITERATIONS):
        r, J, run = one_pass(system, x, period, n, parameter)
        orbit = Orbit(system, period, n, parameter, run)
        if orbit.closes:
            return orbit
        rows = np.linalg.norm(J[:, unknowns], axis=1)
        if not (np.isfinite(rows).all() and rows.all()):
            break
        try:
            step = np.linalg.solve(J[:, unknowns] / rows[:, None], -r / rows)
        except np.linalg.LinAlgError:
            break
        x = x + step[:size]
        parameter += float(step[size]) if system.balanced else 0.0
    raise NumericalError(
        f"no motion of {n} cycles was found from this start. Start from a settled run, or nearer to it."
    )


def same_motion(one: Orbit, other: Orbit, tolerance: float = 1e-6) -> bool:
    """Whether two orbits at one period are the same motion, started in any of its cycles.

    A motion of n cycles that repeats after a divisor of n is the same as that of the divisor.
    """
    scale = state_scale(one.start) * tolerance
    return any(bool((np.abs(start - one.start) <= scale).all()) for start in other.shifted())


def primitive(orbit: Orbit) -> Orbit:
    """The orbit with the least number of cycles after which it repeats."""
    for n in range(1, orbit.n // 2 + 1):
        if orbit.n % n == 0:
            scale = state_scale(orbit.start) * 1e-7
            if bool((np.abs(orbit.run.states[n] - orbit.start) <= scale).all()):
                return find_orbit(orbit.system, orbit.start, orbit.period, n, orbit.parameter)
    return orbit
