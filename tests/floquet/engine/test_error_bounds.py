"""Is the true error never above the reported bound, in easy and in awkward cases?"""

import itertools

import numpy as np
import pytest
from scipy.linalg import expm

from floquet import PROPAGATORS, PeriodicSystem, monodromy
from floquet.engine.multipliers import (
    Spectrum,
    least_separation,
    multipliers_with_bounds,
    radii_with_bounds,
    verdicts,
)
from floquet.engine.propagators.one_step import GaussLegendre, Propagator
from tests.evidence.floquet.closed_forms import propagate_fixed
from tests.evidence.floquet.reference_systems import mathieu


def accurate_expm(A: np.ndarray) -> np.ndarray:
    """exp(A) by Taylor, scaling and squaring in extended precision.

    scipy.linalg.expm loses up to 1e-12 of the norm when |A| is about 7: more than the errors measured
    against it here.
    """
    X = A.astype(np.longdouble) / 2**10
    total = term = np.eye(len(A), dtype=np.longdouble)
    for k in range(1, 25):
        term = term @ X / k
        total = total + term
    for _ in range(10):
        total = total @ total
    return total.astype(float)


def triangle(t: np.ndarray, period: float) -> tuple[np.ndarray, np.ndarray]:
    """Triangle wave g from 0 up to 1 at T/2 and back, with its slope, which jumps at 0 and T/2."""
    phase = np.mod(t / period, 1.0)
    up = phase < 0.5
    return np.where(up, 2 * phase, 2 - 2 * phase), np.where(up, 2 / period, -2 / period)


def lyapunov_system(
    B: np.ndarray, S: np.ndarray, period: float, shape: str = "sine"
) -> tuple[PeriodicSystem, np.ndarray]:
    """A system that the change of variables x = (I + g(t) N) y turns into y' = B y, and Phi(T, 0).

    N = a b^T with a, b the first two columns of S made orthogonal: N^2 = 0, (I + g N)^-1 = I - g N. With g
    periodic and g(0) = 0:  A(t) = g'(t) N + (I + g N) B (I - g N)  and  Phi(T, 0) = exp(B T).
    """
    a = S[:, 0]
    b = S[:, 1] - S[:, 0] * (S[:, 0] @ S[:, 1]) / (S[:, 0] @ S[:, 0])
    N = np.outer(a, b)

    def A(t: np.ndarray) -> np.ndarray:
        if shape == "sine":
            w = 2 * np.pi / period
            g = np.sin(w * t)
            slope = w * np.cos(w * t)
        else:
            g, slope = triangle(t, period)
        gN = g[:, None, None] * N
        # (g' N) (I + g N)^-1 = g' N because N^2 = 0.
        return slope[:, None, None] * N + (np.eye(len(B)) + gN) @ B @ (np.eye(len(B)) - gN)

    breaks = () if shape == "sine" else (period / 2,)
    return PeriodicSystem(A, period, breaks, vectorized=True), accurate_expm(B * period)


def distances(computed: np.ndarray, exact: np.ndarray) -> np.ndarray:
    """For each computed multiplier the distance to the nearest exact one."""
    return np.abs(computed[:, None] - exact[None, :]).min(axis=1)


@pytest.mark.parametrize("shape", ["sine", "triangle"])
@pytest.mark.parametrize(
    ("method", "rtol"),
    [("gauss", 1e-4), ("gauss", 1e-7), ("gauss", 1e-10), ("gauss4", 1e-5), ("dop853", 1e-8)],
)
def test_bounds_hold_on_random_systems(method: str, rtol: float, shape: str) -> None:
    rng = np.random.default_rng(101)
    for _ in range(10):
        n = int(rng.integers(2, 7))
        B, S = rng.normal(size=(2, n, n))
        period = float(rng.uniform(0.5, 3.0))
        system, exact = lyapunov_system(B, 0.4 * S, period, shape)
        result = monodromy(system, rtol=rtol, method=method)
        d = result.scaling
        scaled_error = (result.matrix - exact) * d[None, :] / d[:, None]
        assert np.linalg.norm(scaled_error, 2) <= result.matrix_error
        assert result.matrix_error <= rtol * np.linalg.norm(result.matrix * d[None, :] / d[:, None], 2)
        true = np.exp(np.linalg.eigvals(B) * period)
        assert (distances(result.multipliers, true) <= result.multiplier_errors).all()
        assert abs(result.spectral_radius - np.abs(true).max()) <= result.error


def test_defective_multiplier_gets_a_root_law_bound() -> None:
    # A double multiplier with one eigenvector moves like the square root of a perturbation, so an honest
    # bound is of order sqrt(matrix_error), and a bound of order matrix_error would be a lie.
    B = np.array([[-0.1, 5.0, 0.3], [0.0, -0.1, 0.2], [0.0, 0.0, -2.0]])
    S = np.random.default_rng(1).normal(size=(3, 3))
    system, exact = lyapunov_system(B, 0.2 * S, 1.0)
    result = monodromy(system, rtol=1e-12)
    assert np.linalg.norm((result.matrix - exact) * result.scaling / result.scaling[:, None]) < 1e-10
    assert abs(result.spectral_radius - np.exp(-0.1)) <= result.error
    assert 0.1 * np.sqrt(result.matrix_error) < result.error < 1e-4  # 100 sqrt(1e-12)
    *_, simple = result.multiplier_errors
    assert simple < 1e-9  # the simple multiplier exp(-2) keeps its own accuracy
    assert result.verdict == "stable"


@pytest.mark.parametrize(("damping", "expected"), [(1e-7, "stable"), (0.0, "undecided"), (-1e-7, "unstable")])
def test_verdict_near_the_boundary(damping: float, expected: str) -> None:
    # Undamped |multiplier| = 1 exactly; no finite computation can say which side it is on.
    result = monodromy(PeriodicSystem(lambda t: [[0.0, 1.0], [-1.0, -damping]], 2.0), rtol=1e-11)
    assert result.verdict == expected
    assert result.error < 1e-9


def test_transient_growth_inside_the_period_is_accounted_for() -> None:
    # Growth by exp(20) in the first half, decay by exp(-21) in the second: local errors of the first half are
    # amplified 5e8-fold before they decay, and rotate between. The result must still be as accurate as asked.
    def A(t: float) -> np.ndarray:
        return np.array([[40.0, 3.0], [-3.0, 40.0]]) if t < 0.5 else np.array([[-42.0, 1.0], [-1.0, -42.0]])

    result = monodromy(PeriodicSystem(A, 1.0, (0.5,)), rtol=1e-9)
    exact = expm(0.5 * A(0.75)) @ expm(0.5 * A(0.25))
    assert np.linalg.norm(result.matrix - exact, 2) <= 1e-9 * np.linalg.norm(exact, 2)


@pytest.mark.parametrize("share", [0.01, 0.5, 0.99])
def test_the_bound_of_a_multiplier_holds_for_the_worst_error_of_the_matrix(share: float) -> None:
    # M has the multipliers 0 and 1 with projectors of norm p. E = delta y x' with the left and right vectors
    # of 0 moves it by p delta and, as tr(M + E) = 1 + delta / p and det(M + E) = p delta, by a positive rest.
    a = 2.0
    p = np.sqrt(1.0 + a**2)
    delta = share * 0.25 / p  # 4 p delta < 1, the distance of the two: beyond it they share one bound
    values, bounds = multipliers_with_bounds(np.array([[0.0, a], [0.0, 1.0]]), delta)
    E = delta / p * np.array([[1.0, 0.0], [-a, 0.0]])
    assert np.linalg.norm(E, 2) == pytest.approx(delta, rel=1e-14)
    trace = 1.0 + delta / p
    exact_error = 2.0 * p * delta / (trace + np.sqrt(trace**2 - 4.0 * p * delta))
    assert exact_error > p * delta
    assert values[1] == 0.0
    assert (
        exact_error <= bounds[1] <= 2.0 * p * delta
    )  # nor is it more than 2 (p delta)^2 / (1 / 2) above p delta


def test_rounding_of_the_eigenvalues_themselves_is_in_the_bound() -> None:
    # Unimodular changes of variables: integer matrices, exact in floating point, with multipliers 1 to 5.
    rng = np.random.default_rng(3)
    for _ in range(20):
        U, L = (np.eye(5) + np.triu(rng.integers(-2, 3, (5, 5)), 1) for _ in range(2))
        S = U @ L.T
        M = S @ np.diag([1.0, 2.0, 3.0, 4.0, 5.0]) @ np.rint(np.linalg.inv(S))
        values, bounds = multipliers_with_bounds(M, 0.0)
        assert (np.abs(values - [5.0, 4.0, 3.0, 2.0, 1.0]) <= bounds).all()


def test_the_separation_of_a_cluster_is_never_overestimated() -> None:
    # LAPACK's estimate of 1/|inv(T22 - T11)| is too large for the first matrix.
    rng = np.random.default_rng(5)
    random = [np.triu(rng.normal(size=(3, 3))) for _ in range(20)]
    for T in [np.array([[0.0, 0.0, 0.0], [0.0, 1.0, -100.0], [0.0, 0.0, 100.0]]), *random]:
        true = np.linalg.svd(T[1:, 1:] - T[0, 0] * np.eye(2), compute_uv=False)[-1]
        separation, _ = least_separation(T[:1, :1].astype(complex), T[1:, 1:].astype(complex))
        assert 0.3 * true < separation <= true * (1.0 + 1e-12)  # rounding of the reference


def test_multipliers_too_small_to_be_told_apart_share_a_bound() -> None:
    """1/(difference) squared is beyond floating point: no warning, and no bound below the error of M."""
    values, bounds = multipliers_with_bounds(np.array([[3e-170, 1e-171], [0.0, 1e-170]]), 1e-12)
    assert (np.abs(values) < 1e-160).all()
    assert ((bounds >= 1e-12) & (bounds < 1e-5)).all()


def test_a_radius_whose_interval_ends_at_1_is_undecided() -> None:
    ends = [(0.75, 0.25), (1.25, 0.25), (1.0, 0.0)]
    inside = [(0.5, 0.25), (1.5, 0.25)]
    each = [Spectrum(np.array([radius + 0j]), np.array([error]), 1.0) for radius, error in ends + inside]
    assert [one.verdict for one in each] == ["undecided"] * 3 + ["stable", "unstable"]
    assert verdicts(*np.array(ends + inside).T).tolist() == [0, 0, 0, 1, -1]


@pytest.mark.parametrize("size", [2, 3])
def test_a_defective_multiplier_alone_has_elsners_bound(size: int) -> None:
    # Of a Jordan block with g beside the diagonal |B - mean| = g and the projector is 1.
    g = 4.0
    delta = 1e-8
    _, bounds = multipliers_with_bounds(0.5 * np.eye(size) + g * np.eye(size, k=1), delta)
    # Rounding adds some hundred eps |M| to delta, 2e-5 of it.
    assert bounds == pytest.approx((2.0 * g + delta) ** (1 - 1 / size) * delta ** (1 / size), rel=2e-5)
    assert (g ** (size - 1) * delta) ** (1 / size) <= bounds[0]  # what delta in the corner does


def test_the_order_of_equal_moduli_is_fixed() -> None:
    values, _ = multipliers_with_bounds(
        np.array([[-0.5, 0, 0, 0], [0, 0, 0.5, 0], [0, -0.5, 0, 0], [0, 0, 0, 0.5]]), 0.0
    )
    np.testing.assert_allclose(values, [0.5j, 0.5, -0.5, -0.5j], atol=1e-15)


def test_the_radius_may_be_that_of_another_multiplier_within_its_bound() -> None:
    values = np.array([1.0, -0.875])
    bounds = np.array([0.0625, 0.25])
    one = Spectrum(values, bounds, 1.0)
    assert (one.spectral_radius, one.error) == (1.0, 0.125)
    radii, errors = radii_with_bounds(np.array([values, [0.25, 0.5]]), np.array([bounds, bounds]))
    assert (radii.tolist(), errors.tolist()) == ([1.0, 0.5], [0.125, 0.25])


def test_liouville_residual_sees_a_wrong_propagation() -> None:
    # A method of low order at a loose tolerance: its determinant is wrong by about what it was allowed.
    assert monodromy(mathieu(3.0, 2.0, 0.1), rtol=1e-4, method="rk4").liouville_residual > 1e-9


def error(method: Propagator, system: PeriodicSystem, exact: np.ndarray, steps: int) -> float:
    return float(np.linalg.norm(propagate_fixed(system, method, steps) - exact))


def observed_order(method: Propagator, system: PeriodicSystem, exact: np.ndarray) -> float:
    """Order from the last two numbers of steps, each twice the one before, whose error is above rounding."""
    errors = [error(method, system, exact, 1)]
    while errors[-1] > 1e-10 * np.linalg.norm(exact) and len(errors) < 9:
        errors.append(error(method, system, exact, 2 ** len(errors)))
    return float(np.log2(errors[-2] / errors[-1]))


@pytest.mark.parametrize("method", [*PROPAGATORS.values(), *map(GaussLegendre, (1, 5))])
def test_order_survives_declared_switches(method) -> None:
    B, S = np.random.default_rng(13).normal(size=(2, 3, 3))
    system, exact = lyapunov_system(0.5 * B, 0.6 * S, 7.0, "triangle")
    # 0.3: the next term of the error series.
    assert observed_order(method, system, exact) == pytest.approx(method.order, abs=0.3)


@pytest.mark.parametrize("method", PROPAGATORS.values(), ids=PROPAGATORS)
def test_a_step_is_exact_on_all_products_of_powers_up_to_its_order(method) -> None:
    """A has t^e_1, t^e_2, ... above its diagonal, so the corner of Phi(1, 0) is an integral of integrals.

    It is of order sum(e) + m in the step: the order conditions of linear equations, one by one.
    """
    for m in (1, 2, 3, 4):
        for e in itertools.product(range(4), repeat=m):
            if sum(e) + m > min(method.order, 8):
                continue
            A = np.stack([np.diag(t ** np.array(e, dtype=float), 1) for t in method.nodes])
            exact = 1.0
            power = 0
            for one in reversed(e):
                power += one + 1
                exact /= power
            corner = method.step_matrices(A[None], np.ones(1))[0, 0, -1]
            assert corner == pytest.approx(exact, rel=1e-12), e
