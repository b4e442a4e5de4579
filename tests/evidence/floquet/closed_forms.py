"""Closed forms, invariants and orders of convergence that the Floquet engine must show.

Combination resonances against first-order theory: Hsu's system and the gear chains of Lin and Parker.

Sources: docs/verification/floquet.md; Oberkampf and Roy, Verification and Validation in Scientific Computing,
2010, for the method.
"""

from collections.abc import Callable, Iterator
from itertools import pairwise

import numpy as np
from scipy.linalg import expm
from scipy.optimize import minimize_scalar
from scipy.special import mathieu_a, mathieu_b

from floquet import PROPAGATORS, Monodromy, PeriodicSystem, monodromy
from floquet.engine.propagators.one_step import Propagator
from floquet.engine.propagators.registry import propagator
from lumped.typing import FloatArray
from tests.evidence.check import Check, order
from tests.evidence.floquet.extended import stress_test
from tests.evidence.floquet.reference_systems import (
    GearChain,
    HsuSystem,
    mathieu,
    meissner,
    meissner_trace,
    tongue_ends,
)


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
    computed = monodromy(PeriodicSystem(lambda t: A, 2.0), rtol, method=method).matrix
    return float(np.linalg.norm(computed - exact) / np.linalg.norm(exact))


def check_closed_forms() -> Iterator[Check]:
    """Meissner, Mathieu, constant coefficients, damping. Asked for to 1e-11 of matrices smaller than 10."""
    worst = max(meissner_error(*case) for case in ((1.3, 0.4), (4.0, 3.0), (2.2, 0.05)))
    yield Check("Meissner's equation", "trace in closed form (1918); absolute", worst, 1e-9)
    # Characteristic values are good to 1e-13, times the slope of the trace.
    worst = max(mathieu_error(m, 1.0) for m in (1, 2, 3))
    exact = "trace ±2 on the characteristic curves a_m, b_m, q = 1 (DLMF 28.2); absolute"
    yield Check("Mathieu's equation", exact, worst, 1e-9)
    yield Check("constant coefficients", "the matrix exponential", constant_error(5), 1e-10)
    cases = ((1.0, 0.3, 0.05), (2.5, 1.7, 0.3), (0.2, 0.9, 0.02))
    worst = max(damped_mathieu_error(*case) for case in cases)
    exact = "tr M is exp(-cπ) times that of a - c² without damping; absolute"
    yield Check("Mathieu's equation with damping", exact, worst, 1e-9)


def propagate_fixed(system: PeriodicSystem, method: Propagator, substeps: int) -> FloatArray:
    """Monodromy matrix with so many equal steps in each smooth segment, without error control."""
    product = np.eye(system.dimension)
    for a, b in pairwise(system.edges):
        h = (b - a) / substeps
        s = method.nodes.size
        start = (a + h * np.arange(substeps))[:, None]
        times = system.inside(start + h * method.nodes, start, start + h).ravel()
        A = system.evaluate(times).reshape(substeps, s, system.dimension, system.dimension)
        for step in method.step_matrices(A, np.full(substeps, h)):
            product = step @ product
    return product


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
    similar = 0.0
    shifted = 0.0
    liouville = 0.0
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
    yield Check("symplecticity, 3 coarse steps", "MᵀJM = J, over |M|²", symplectic, 1e-12)
    yield Check("badly scaled coordinates, PAP⁻¹", "the same multipliers", similar, 1e-8)
    yield Check("another start of the period", "the same multipliers", shifted, 1e-9)
    yield Check("Liouville's formula", "sum of log det = integral of tr A", liouville, 1e-10)


def check_orders() -> Iterator[Check]:
    """Observed orders of all propagators on Mathieu's equation, a = 3, q = 2: equal steps, halved once."""
    system = mathieu(3.0, 2.0)
    exact = propagate_fixed(system, propagator("gauss"), 64)
    for name, known in PROPAGATORS.items():
        steps = max(8, 1024 // known.order**2)  # the error is asymptotic there and well above rounding
        coarse, fine = (
            float(np.linalg.norm(propagate_fixed(system, known, n) - exact)) for n in (steps, 2 * steps)
        )
        # 0.3: the next term of the error series at coarse steps.
        yield order(f"propagator {name}", np.log2(coarse / fine), known.order, 0.3)


#: Gear pairs of the stress test and its seed.
COUNT = 100
SEED = 1


def check_random_gears() -> Iterator[Check]:
    """Compiled route on random gear pairs: worst error, its ratio to its bound, and the median bound."""
    error, bound, excess = stress_test(COUNT, SEED)
    name = f"{COUNT} random gear pairs"
    yield Check(f"{name}: error", "multipliers in extended precision", float(error.max()), 1e-11)
    yield Check(f"{name}: error over bound", "within the reported bound", float(excess.max()), 1.0)
    yield Check(f"{name}: median bound", "small, so that it says something", float(np.median(bound)), 1e-9)


_OMEGA = np.array([1.0, 2.3])
_SYMMETRIC = np.array([[0.3, 0.8], [0.5, 0.4]])
_SKEW = np.array([[0.3, 0.8], [-0.5, 0.4]])


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
    still = np.zeros(2)
    damped = np.array([4e-3, 1.6e-2])
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
    yield Check("Hsu, the other combination", "no growth: theory has no tongue there", worst, 1e-5)


def _chain(contact_ratio: float) -> GearChain:
    """Idler chain of three gears."""
    return GearChain(
        mass=np.array([1.0, 1.6, 1.2]), ground=np.diag([0.4, 0.0, 0.15]),
        meshes=np.array([[1.0, -1.0, 0.0], [0.0, 1.0, -1.0]]), stiffness=np.array([2.0, 3.0]),
        contact_ratio=np.full(2, contact_ratio), phase=np.array([0.0, 0.3]),
    )  # fmt: skip


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
            middle = 0.5 * (omega[1] + omega[2])
            one = _chain(sigma)

            def fall(x: float, one: GearChain = one, epsilon: float = epsilon) -> float:
                return -monodromy(one.at(x, epsilon), 1e-11).spectral_radius

            def fall_by_pieces(x: float, one: GearChain = one, epsilon: float = epsilon) -> float:
                system = one.at(x, epsilon)
                lengths = np.diff(system.edges)
                flow = np.eye(system.dimension)
                for A, length in zip(
                    system.evaluate(system.edges[:-1] + 0.5 * lengths), lengths, strict=True
                ):
                    flow = expm(length * A) @ flow
                return -float(np.abs(np.linalg.eigvals(flow)).max())

            # Exponentials of the pieces of constant stiffness find the place; the engine tells the growth.
            near = min(middle * (1.0 + np.linspace(-0.005, 0.005, 81)), key=fall_by_pieces)
            ends = near - 1.25e-4 * middle, near + 1.25e-4 * middle
            growth.append(-minimize_scalar(fall, bounds=ends, options={"xatol": 1e-6}).fun - 1.0)
        name = f"gear chain, growth in (w2+w3)/2, contact ratio {sigma}"
        yield order(name, np.log2(growth[0] / growth[1]), expected, 0.2)
