"""Closing a period: Newton's method for the start state to which a motion returns after n cycles.

The speed is fixed here. `floquet.orbits.branch` closes a period in a plane across a branch, and
`floquet.orbits.folds` closes a period at a fold. Both use the residual of this file.

Sources: docs/theory/orbits.md, "Periodic motions".
"""

from __future__ import annotations

import numpy as np

from floquet.orbits.orbit import Orbit, state_scale
from floquet.orbits.system import ContactSystem, Run
from lumped.errors import NumericalError
from lumped.typing import FloatArray

_MOST_ITERATIONS = 15
_MOST_EVENTS = 1024
_CYCLE_STARTS = np.zeros(1)


def closing_residual(
    system: ContactSystem, start: FloatArray, period: float, n: int, parameter: float
) -> tuple[FloatArray, FloatArray, Run]:
    """Mismatch (2m + r,) of n cycles and of the accumulated rows, derivatives of the mismatch, and the run.

    The derivatives (2m + r, 2m + 2) are by the start, T and the parameter.
    """
    run = system.run(
        start, period, n, parameter, derivatives=True, logged=_MOST_EVENTS, samples=_CYCLE_STARTS
    )
    J = run.derivative.copy()
    J[: system.size, : system.size] -= np.eye(system.size)
    return np.concatenate([run.end - run.start, run.accumulated]), J, run


def close_orbit(
    system: ContactSystem, start: FloatArray, period: float, n: int = 1, parameter: float = 0.0
) -> Orbit:
    """Periodic motion of n cycles by Newton's method at a fixed period T [s].

    Newton's method starts from displacements and phase rates (2m,), and from ``parameter`` where the system
    has an accumulated row. Raises NumericalError where no motion is found.
    """
    x = np.array(start, dtype=float)
    size = system.size
    unknowns = [*range(size), *([size + 1] if system.balanced else [])]
    for _ in range(_MOST_ITERATIONS):
        r, J, run = closing_residual(system, x, period, n, parameter)
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


def primitive(orbit: Orbit) -> Orbit:
    """The same motion as an orbit over the least number of cycles after which the motion repeats."""
    for n in range(1, orbit.n // 2 + 1):
        if orbit.n % n == 0:
            scale = state_scale(orbit.start) * 1e-7
            if bool((np.abs(orbit.run.states[n] - orbit.start) <= scale).all()):
                return close_orbit(orbit.system, orbit.start, orbit.period, n, orbit.parameter)
    return orbit
