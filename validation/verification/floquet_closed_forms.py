"""Verification of the Floquet engine against exact results.

``python -m validation.verification.floquet_closed_forms`` prints the numbers.

Every check computes one number, the worst error found or an observed order, and states its bounds.
docs/verification/floquet.md explains them; `validation.reporting.floquet_page` puts the numbers into it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from scipy.linalg import expm
from scipy.special import mathieu_a, mathieu_b

from floquet import PROPAGATORS, PeriodicSystem, monodromy
from floquet.engine.propagation import propagate_fixed
from floquet.engine.propagators import propagator
from floquet.engine.reference_systems import (
    GearChain,
    HsuSystem,
    mathieu,
    meissner,
    meissner_trace,
    tongue_ends,
)
from lumped.typing import FloatArray
from validation.verification.coulomb_zones import check_coulomb_gear_pair
from validation.verification.floquet_check import Check, error, order
from validation.verification.random_gears import check_random_gears

_OMEGA = np.array([1.0, 2.3])
_SYMMETRIC = np.array([[0.3, 0.8], [0.5, 0.4]])
_SKEW = np.array([[0.3, 0.8], [-0.5, 0.4]])


def check_meissner() -> Iterator[Check]:
    """Trace of the monodromy matrix, over a grid of both parameters."""
    worst = 0.0
    for delta in np.linspace(0.5, 5.0, 7):
        for part in (0.05, 0.5, 0.9):
            M = monodromy(meissner(delta, part * delta), 1e-11).matrix
            worst = max(worst, abs(np.trace(M) - meissner_trace(delta, part * delta)))
    yield error("Meissner", worst, 1e-9, "worst |tr M - closed form|")


def check_mathieu() -> Iterator[Check]:
    """Characteristic values of the undamped equation, and the damped equation as a shifted undamped one."""
    worst = 0.0
    for q in (0.1, 1.0, 5.0):
        for m in range(5):
            for a in (mathieu_a(m, q), *([mathieu_b(m, q)] if m else [])):
                M = monodromy(mathieu(float(a), q), 1e-10).matrix
                worst = max(worst, abs(np.trace(M) - 2.0 * (-1.0) ** m))
    yield error("Mathieu, undamped", worst, 1e-9, "worst |tr M -+ 2| on a_m and b_m, m = 0..4")
    worst = 0.0
    for delta, q, c in ((1.0, 0.3, 0.05), (2.5, 1.7, 0.3), (0.2, 0.9, 0.02)):
        damped = monodromy(mathieu(delta, q, c), 1e-11).matrix
        undamped = monodromy(mathieu(delta - c * c, q), 1e-11).matrix
        worst = max(worst, abs(np.trace(damped) - np.exp(-c * np.pi) * np.trace(undamped)))
    yield error("Mathieu, damped", worst, 1e-9, "worst |tr M - exp(-c pi) tr M(a - c^2, undamped)|")


def _hsu_orders(system: HsuSystem, i: int, j: int, sign: int) -> tuple[float, float]:
    """Orders in epsilon of the errors of centre and width of a tongue; damping goes with epsilon."""
    errors = []
    for epsilon in (0.1, 0.05):
        one = HsuSystem(system.omega, system.coupling, system.damping * epsilon)
        predicted = one.boundaries(i, j, sign, epsilon)
        assert predicted is not None  # the cases below all have tongues
        lower, upper = np.subtract(tongue_ends(one, predicted, epsilon), predicted)
        errors.append((abs(lower + upper), abs(upper - lower)))
    centre, width = np.log2(np.array(errors[0]) / np.array(errors[1]))
    return float(centre), float(width)


def check_hsu() -> Iterator[Check]:
    """Ends of sum and difference tongues against first-order theory, and where there is none."""
    still, damped = np.zeros(2), np.array([4e-3, 1.6e-2])
    cases = (
        ("sum, symmetric", _SYMMETRIC, still, 0, 1, 1),
        ("difference, skew", _SKEW, still, 0, 1, -1),
        ("sum, unequal damping", _SYMMETRIC, damped, 0, 1, 1),
        ("difference, unequal damping", _SKEW, damped, 0, 1, -1),
        ("twice one mode", _SYMMETRIC, still, 0, 0, 1),
    )
    for name, coupling, damping, i, j, sign in cases:
        centre, width = _hsu_orders(HsuSystem(_OMEGA, coupling, damping), i, j, sign)
        yield order(f"Hsu, {name}: centre", centre, 2.0, 0.1)
        yield order(f"Hsu, {name}: width", width, 3.0, 0.3)
    worst = 0.0
    for coupling, sign in ((_SYMMETRIC, -1), (_SKEW, 1)):
        system = HsuSystem(_OMEGA, coupling - np.diag(np.diag(coupling)), still)
        centre = _OMEGA[1] + sign * _OMEGA[0]
        for excitation in centre + np.linspace(-0.06, 0.06, 25):
            worst = max(worst, monodromy(system.at(excitation, 0.1), 1e-11).spectral_radius - 1.0)
    yield error("Hsu, the other combination", worst, 1e-5, "largest growth where theory has no tongue")


def _chain(contact_ratio: float) -> GearChain:
    """Idler chain of three gears."""
    return GearChain(
        mass=np.array([1.0, 1.6, 1.2]),
        ground=np.diag([0.4, 0.0, 0.15]),
        meshes=np.array([[1.0, -1.0, 0.0], [0.0, 1.0, -1.0]]),
        stiffness=np.array([2.0, 3.0]),
        contact_ratio=np.full(2, contact_ratio),
        phase=np.array([0.0, 0.3]),
    )


def check_gear_chain() -> Iterator[Check]:
    """Tongues of two meshes with rectangular waves, and the contact ratio that removes one."""
    system = _chain(1.4)
    for i, j, harmonic in ((2, 2, 1), (1, 2, 1), (1, 2, 2), (0, 2, 1)):
        errors = []
        for epsilon in (0.08, 0.04):
            predicted = system.boundaries(i, j, harmonic, epsilon)
            computed = tongue_ends(system, predicted, epsilon)
            errors.append(np.abs(np.subtract(computed, predicted)).max())
        name = f"gear chain, (w{i + 1}+w{j + 1})/{harmonic}: ends"
        yield order(name, np.log2(errors[0] / errors[1]), 2.0, 0.25)
    omega, _ = system.modes()
    for sigma, expected in ((1.4, 1.0), (1.5, 2.0)):
        growth = []
        for epsilon in (0.04, 0.02):
            excitations = 0.5 * (omega[1] + omega[2]) * (1.0 + np.linspace(-0.005, 0.005, 161))
            radius = [monodromy(_chain(sigma).at(x, epsilon), 1e-11).spectral_radius for x in excitations]
            growth.append(max(radius) - 1.0)
        name = f"gear chain, growth in (w2+w3)/2, contact ratio {sigma}"
        yield order(name, np.log2(growth[0] / growth[1]), expected, 0.2)


def check_constant_coefficients() -> Iterator[Check]:
    """Limit of constant coefficients: the matrix exponential."""
    rng = np.random.default_rng(7)
    worst = 0.0
    for n in (2, 5, 8):
        A = rng.normal(size=(n, n)) - 0.5 * np.eye(n)
        M = monodromy(PeriodicSystem(lambda t, A=A: A, 2.0), 1e-11).matrix
        worst = max(worst, float(np.linalg.norm(M - expm(2.0 * A)) / np.linalg.norm(M)))
    yield error("constant coefficients", worst, 1e-10, "worst |M - exp(A T)|/|M|")


def _smooth(coefficients: FloatArray, jump: float = 0.0) -> PeriodicSystem:
    """C0 + C1 cos + C2 sin of one period, C2 added after the time of the jump where there is one."""

    def A(t: FloatArray) -> FloatArray:
        w = 2.0 * np.pi * t[:, None, None]
        last = (t[:, None, None] > jump) if jump else np.sin(2.0 * w)
        return np.asarray(coefficients[0] + np.cos(w) * coefficients[1] + last * coefficients[2])

    return PeriodicSystem(A, 1.0, (jump,) if jump else (), vectorized=True)


def check_invariants() -> Iterator[Check]:
    """Symplecticity, similarity, start of the period, Liouville."""
    J = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.eye(2), np.zeros((2, 2))]])
    worst = {"symplectic": 0.0, "similar": 0.0, "shifted": 0.0, "liouville": 0.0}
    for seed in range(5):
        C = np.random.default_rng(seed).normal(size=(3, 4, 4))
        H = C + C.transpose(0, 2, 1)
        M = propagate_fixed(_smooth(J @ H, 0.4), propagator("gauss"), 3)
        defect = float(np.abs(M.T @ J @ M - J).max() / np.linalg.norm(M) ** 2)
        worst["symplectic"] = max(worst["symplectic"], defect)
        system = _smooth(C)
        rng = np.random.default_rng(100 + seed)
        P = np.diag(10.0 ** np.array([-4, 3, 0, 6])) @ (np.eye(4) + 0.3 * rng.normal(size=(4, 4)))
        inverse = np.linalg.inv(P)
        turned = PeriodicSystem(
            lambda t, P=P, s=system, i=inverse: P @ s.evaluate(t) @ i, 1.0, vectorized=True
        )
        shifted = PeriodicSystem(lambda t, s=system: s.evaluate(np.mod(t + 0.37, 1.0)), 1.0, vectorized=True)
        own = monodromy(system, 1e-11)
        worst["liouville"] = max(worst["liouville"], own.liouville_residual)
        for name, other in (("similar", turned), ("shifted", shifted)):
            found = monodromy(other, 1e-11).multipliers
            gap = float(np.abs(own.multipliers[:, None] - found[None, :]).min(axis=1).max())
            worst[name] = max(worst[name], gap / own.spectral_radius)
    yield error("symplecticity", worst["symplectic"], 1e-12, "worst |M^T J M - J|/|M|^2, 3 coarse steps")
    yield error(
        "similarity", worst["similar"], 1e-8, "worst change of a multiplier under badly scaled P A P^-1"
    )
    yield error("start of the period", worst["shifted"], 1e-9, "worst change of a multiplier, t0 moved")
    yield error("Liouville", worst["liouville"], 1e-10, "worst |sum log det - integral of tr A|")


def check_orders() -> Iterator[Check]:
    """Order of every propagator on a system with a known flow: x = (I + g(t) N) y, y' = B y, N^2 = 0."""
    steps = {"gauss": 2, "gauss8": 8, "gauss6": 8, "gauss4": 16, "magnus6": 8, "magnus4": 16, "expm": 32}
    steps |= {"rk4": 64, "dop853": 8}
    B, S = np.random.default_rng(11).normal(size=(2, 3, 3)) * np.array([0.5, 0.45])[:, None, None]
    a, b = S[:, 0], S[:, 1] - S[:, 0] * (S[:, 0] @ S[:, 1]) / (S[:, 0] @ S[:, 0])
    N, period = np.outer(a, b), 4.0

    def A(t: FloatArray) -> FloatArray:
        w = 2.0 * np.pi / period
        g, slope = np.sin(w * t)[:, None, None], (w * np.cos(w * t))[:, None, None]
        return np.asarray(slope * N + (np.eye(3) + g * N) @ B @ (np.eye(3) - g * N))

    system, exact = PeriodicSystem(A, period, vectorized=True), expm(B * period)
    for name in sorted(PROPAGATORS):
        method = propagator(name)
        n = steps[name]
        errors = [np.linalg.norm(propagate_fixed(system, method, k * n) - exact) for k in (1, 2)]
        yield order(f"order of {name}", np.log2(errors[0] / errors[1]), method.order, 0.3)


CHECKS: tuple[Callable[[], Iterator[Check]], ...] = (
    check_meissner,
    check_mathieu,
    check_hsu,
    check_gear_chain,
    check_constant_coefficients,
    check_invariants,
    check_orders,
    check_coulomb_gear_pair,
    check_random_gears,
)
"""All checks, each a function that yields its numbers."""


def main() -> int:
    """Print every number with its bounds; return 1 when one is outside, else 0."""
    from rich.console import Console
    from rich.table import Table

    table = Table(title="Verification of the Floquet engine", title_justify="left")
    for column in ("check", "number", "must be", "meaning", ""):
        table.add_column(column)
    failed = 0
    for function in CHECKS:
        for check in function():
            table.add_row(
                check.name, f"{check.value:.3g}", check.wanted, check.meaning, "" if check.passed else "FAILS"
            )
            failed += not check.passed
    Console(width=150).print(table)
    return int(failed > 0)


if __name__ == "__main__":
    raise SystemExit(main())
