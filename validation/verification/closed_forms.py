"""Closed forms, invariants and orders of convergence that the Floquet engine must show.

Each is stated once, as a function that returns the error; the report, the verification page and the tests
use it.

Sources: docs/verification/floquet.md; Oberkampf and Roy, Verification and Validation in Scientific Computing,
2010, for the method.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from scipy.linalg import expm
from scipy.special import mathieu_a, mathieu_b

from floquet import (
    PROPAGATORS,
    Monodromy,
    PeriodicSystem,
    monodromy,
    periodic_motion,
)
from floquet.engine.propagation import propagate_fixed
from floquet.engine.propagators.registry import propagator
from floquet.engine.reference_systems import mathieu, meissner, meissner_trace
from floquet.gear.reference import stress_test
from lumped.typing import FloatArray
from validation.verification.checks import Check, OrderCheck, check, error_check


def meissner_error(delta: float, epsilon: float, rtol: float = 1e-11, method: str = "gauss") -> float:
    """|trace of M - closed form| of Meissner's equation, see `meissner_trace`."""
    M = monodromy(meissner(delta, epsilon), rtol, method=method).matrix
    return abs(float(np.trace(M)) - meissner_trace(delta, epsilon))


def mathieu_error(m: int, q: float, rtol: float = 1e-11) -> float:
    """|tr M -+ 2| of Mathieu's equation on its characteristic curves a_m(q) and b_m(q), the larger.

    There a solution of period pi (m even) or 2 pi (m odd) exists: tr M = +2 or -2 at T = pi (DLMF 28.2).
    """
    curves = (mathieu_a, mathieu_b) if m else (mathieu_a,)
    traces = [np.trace(monodromy(mathieu(float(a(m, q)), q), rtol).matrix) for a in curves]
    return max(abs(float(trace) - 2.0 * (-1.0) ** m) for trace in traces)


def damped_mathieu_error(a: float, q: float, c: float, rtol: float = 1e-11) -> float:
    """|tr M - exp(-c pi) tr M(a - c^2, undamped)|: x = exp(-c t) y takes the damping out of the equation."""
    damped, undamped = (monodromy(mathieu(*given), rtol).matrix for given in ((a, q, c), (a - c * c, q)))
    return abs(float(np.trace(damped) - np.exp(-c * np.pi) * np.trace(undamped)))


def constant_error(n: int, rtol: float = 1e-11, method: str = "gauss") -> float:
    """|M - exp(A T)|/|exp(A T)| of n states with random constant coefficients."""
    A = np.random.default_rng(7).normal(size=(n, n)) - 0.5 * np.eye(n)
    exact = expm(2.0 * A)
    found = monodromy(PeriodicSystem(lambda t: A, 2.0), rtol, method=method).matrix
    return float(np.linalg.norm(found - exact) / np.linalg.norm(exact))


def closed_forms() -> tuple[Check, ...]:
    """Errors against the closed forms of Meissner, of Mathieu, and of constant coefficients."""
    return (
        check("meissner", max(meissner_error(*case) for case in ((1.3, 0.4), (4.0, 3.0), (2.2, 0.05)))),
        check("mathieu", max(mathieu_error(m, 1.0) for m in (1, 2, 3))),
        check("constant", constant_error(5)),
    )


def check_closed_forms() -> Iterator[Check]:
    """The closed forms of the report, and damping."""
    yield from closed_forms()
    cases = ((1.0, 0.3, 0.05), (2.5, 1.7, 0.3), (0.2, 0.9, 0.02))
    worst = max(damped_mathieu_error(*case) for case in cases)
    exact = "tr M is exp(-cπ) times that of a - c² without damping; absolute"
    yield error_check("Mathieu's equation with damping", exact, worst, 1e-9)


def harmonic_motion_error(rtol: float = 1e-11, unit: float = 1.0) -> float:
    """Error of the periodic motion of x' = A x + c cos Wt over its largest state.

    Its closed form is Re((iW - A)^-1 c exp(iWt)); ``unit`` scales c.
    """
    rng = np.random.default_rng(4)
    A, c, T = rng.normal(size=(4, 4)), rng.normal(size=4) / unit, 1.7
    W, times = 2.0 * np.pi / T, T * np.array([0.0, 0.21, 0.5, 0.999, 1.0])
    exact = (np.linalg.solve(1j * W * np.eye(4) - A, c) * np.exp(1j * W * times)[:, None]).real
    motion = periodic_motion(PeriodicSystem(lambda t: A, T, b=lambda t: c * np.cos(W * t)), times, rtol)
    return float(np.abs(motion.states - exact).max() / np.abs(exact).max())


def check_forced_motion() -> Iterator[Check]:
    """Periodic motion of the general engine."""
    yield error_check("forced motion of constant coefficients", "closed form", harmonic_motion_error(), 1e-9)


def _smooth(coefficients: FloatArray, jump: float = 0.0) -> PeriodicSystem:
    """C0 + C1 cos + C2 sin of one period, C2 added after the time of the jump where there is one."""

    def A(t: FloatArray) -> FloatArray:
        w = 2.0 * np.pi * t[:, None, None]
        last = (t[:, None, None] > jump) if jump else np.sin(2.0 * w)
        return np.asarray(coefficients[0] + np.cos(w) * coefficients[1] + last * coefficients[2])

    return PeriodicSystem(A, 1.0, (jump,) if jump else (), vectorized=True)


def symplectic_defect(method: str, seed: int = 0) -> float:
    """|M^T J M - J|/|M|^2 of x' = J H(t) x, H random with a jump at 0.4, from 3 coarse steps a segment."""
    J = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.eye(2), np.zeros((2, 2))]])
    C = np.random.default_rng(seed).normal(size=(3, 4, 4))
    M = propagate_fixed(_smooth(J @ (C + C.transpose(0, 2, 1)), 0.4), propagator(method), 3)
    return float(np.abs(M.T @ J @ M - J).max() / np.linalg.norm(M) ** 2)


def check_invariants() -> Iterator[Check]:
    """Symplecticity, similarity, start of the period, Liouville; five random systems each."""
    similar, shifted, liouville = 0.0, 0.0, 0.0
    for seed in range(5):
        system = _smooth(np.random.default_rng(seed).normal(size=(3, 4, 4)))
        rng = np.random.default_rng(100 + seed)
        P = np.diag(10.0 ** np.array([-4, 3, 0, 6])) @ (np.eye(4) + 0.3 * rng.normal(size=(4, 4)))
        inverse = np.linalg.inv(P)
        own = monodromy(system, 1e-11)

        def change(A: Callable[[FloatArray], FloatArray], own: Monodromy = own) -> float:
            found = monodromy(PeriodicSystem(A, 1.0, vectorized=True), 1e-11).multipliers
            gap = np.abs(own.multipliers[:, None] - found[None, :]).min(axis=1).max()
            return float(gap) / own.spectral_radius

        liouville = max(liouville, own.liouville_residual)
        similar = max(similar, change(lambda t, P=P, s=system, i=inverse: P @ s.evaluate(t) @ i))  # type: ignore[misc]
        shifted = max(shifted, change(lambda t, s=system: s.evaluate(np.mod(t + 0.37, 1.0))))  # type: ignore[misc]
    symplectic = max(symplectic_defect("gauss", seed) for seed in range(5))
    yield error_check("symplecticity, 3 coarse steps", "MᵀJM = J, over |M|²", symplectic, 1e-12)
    yield error_check("badly scaled coordinates, PAP⁻¹", "the same multipliers", similar, 1e-8)
    yield error_check("another start of the period", "the same multipliers", shifted, 1e-9)
    yield error_check("Liouville's formula", "sum of log det = integral of tr A", liouville, 1e-10)


def order_checks() -> tuple[OrderCheck, ...]:
    """Observed orders of all propagators on Mathieu's equation, a = 3, q = 2: equal steps, halved once."""
    system = mathieu(3.0, 2.0)
    exact = propagate_fixed(system, propagator("gauss"), 64)

    def row(name: str, order: int, steps: int) -> OrderCheck:
        found = [propagate_fixed(system, propagator(name), count) for count in (steps, 2 * steps)]
        coarse, fine = (float(np.linalg.norm(M - exact) / np.linalg.norm(exact)) for M in found)
        return OrderCheck(name, order, float(np.log2(coarse / fine)), steps, fine)

    return tuple(row(name, known.order, known.coarse_steps) for name, known in PROPAGATORS.items())


#: Gear pairs of the stress test and its seed; more of them by ``python benchmarks/bench_floquet.py``.
COUNT, SEED = 100, 1


def check_random_gears() -> Iterator[Check]:
    """Compiled route on random gear pairs: worst error, its ratio to its bound, and the median bound."""
    found = stress_test(COUNT, SEED)
    routes = {"fine": ("single points", 1e-11, 1e-9), "joined": ("dense charts", 1e-9, 1e-8)}
    for route, (use, limit, tight) in routes.items():
        one, name = found.sel(route=route), f"{COUNT} random gear pairs, {use}"
        error, excess, bound = (float(x) for x in (one.error.max(), one.excess.max(), one.bound.median()))
        yield error_check(f"{name}: error", "multipliers of the reference", error, limit)
        yield error_check(f"{name}: error over bound", "within the reported bound", excess, 1.0)
        yield error_check(f"{name}: median bound", "small, so that the bound says something", bound, tight)
