"""Are M, C and K of any kind made into the system that they are, with bounds that hold?"""

import numpy as np
import pytest

from floquet import (
    FourierSeries,
    PeriodicMatrix,
    PeriodicSystem,
    PiecewisePolynomial,
    from_second_order,
    monodromy,
    scan,
)
from lumped.errors import ParameterError
from tests.evidence.floquet.reference_systems import meissner_trace

PERIOD = 3.0
UNITS = np.diag(10.0 ** np.arange(4))  # coordinates in other units: micrometres beside metres


def matrices(seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """M, C, C_1, K and K_1 of a system with gyroscopic and circulatory parts."""
    rng = np.random.default_rng(seed)
    L, S, gyroscopic, damping_wave, stiffness_wave = rng.normal(size=(5, 4, 4))
    M = np.tril(L) @ np.tril(L).T + np.eye(4)
    C = 0.3 * np.eye(4) + 0.1 * gyroscopic
    C1 = 0.05 * damping_wave
    K1 = stiffness_wave
    return tuple(UNITS @ B @ UNITS for B in (M, C, C1, 20.0 * np.eye(4) + S + S.T, K1))


def test_meissners_trace_is_exact_within_a_proven_bound():
    jump = PiecewisePolynomial([0.0, 0.5 * PERIOD, PERIOD], [[0.4], [-0.4]])
    result = monodromy(from_second_order(2.0, 0.0, PeriodicMatrix(2.6, (jump, 2.0)), PERIOD))
    assert result.certificate == "proven"
    exact = meissner_trace(1.3, 0.4, PERIOD)
    assert abs(np.trace(result.matrix) - exact) <= 2.0 * result.matrix_error < 1e-11


def test_matrices_in_all_forms_give_the_same_multipliers():
    M, C, C1, K, K1 = matrices(1)
    wave = FourierSeries(PERIOD, 0.0, [1.0])
    jump = PiecewisePolynomial([0.0, 1.0, PERIOD], [[0.0], [1.0]])
    C_of = PeriodicMatrix(C, (jump, C1))
    K_of = PeriodicMatrix(K, (wave, K1))

    def C_at(t: float) -> np.ndarray:
        return C + (t > 1.0) * C1

    def K_at(t: float) -> np.ndarray:
        return K + np.cos(2.0 * np.pi * t / PERIOD) * K1

    def plain(t: float) -> np.ndarray:
        return np.block([[np.zeros((4, 4)), np.eye(4)], [-np.linalg.solve(M, np.hstack([K_at(t), C_at(t)]))]])

    of_formulas = monodromy(from_second_order(M, C_of, K_of, PERIOD))
    others = [
        from_second_order(M, C_at, K_at, PERIOD, [1.0]),
        from_second_order(M, C_of, K_at, PERIOD),
        PeriodicSystem(plain, PERIOD, [1.0]),
    ]
    assert of_formulas.certificate == "proven"
    assert of_formulas.spectral_radius > 1e-3
    for other in map(monodromy, others):
        assert other.certificate == "estimate"
        assert (
            abs(other.spectral_radius - of_formulas.spectral_radius) <= other.error + of_formulas.error < 1e-8
        )


def test_free_vibrations_keep_their_norm():
    # A clamped rod of 12 elements, in whose own coordinates free vibrations seem to grow by its stiffness.
    n = 12
    K = 1e8 * (2.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1))
    result = monodromy(from_second_order(np.diag(np.geomspace(1.0, 100.0, n)), np.zeros((n, n)), K, 1e-3))
    balanced = result.matrix / result.scaling[:, None] * result.scaling
    assert np.linalg.norm(balanced, 2) < 2.0  # powers of two in the place of frequencies
    assert np.abs(np.abs(result.multipliers) - 1.0).max() <= result.multiplier_errors.max() < 1e-10


@pytest.mark.parametrize(("M", "C", "K", "breaks", "field", "word"), [
    (np.diag([1.0, 0.0]), np.eye(2), np.eye(2), (), "M", "singular"),
    (np.ones((2, 3)), np.eye(2), np.eye(2), (), "M", "square"),
    (np.eye(2), np.eye(3), np.eye(2), (), "C", "square matrix (2, 2)"),
    (np.eye(2), np.eye(2), PeriodicMatrix(np.eye(3)), (), "K", "that of M"),
    (np.eye(2), lambda t: np.eye(3), np.eye(2), (), "C(t)", "(3, 3)"),
    (1.0, 0.0, PeriodicMatrix(1.0, (FourierSeries(2.0, 0.0, [1.0]), 1.0)), (), "K, term 1", "repeats"),
    (1.0, 0.0, 1.0, (4.0,), "breakpoints", "0 to 3"),
    (1.0, 0.0, [["1"]], (), "K", "numbers"),
])  # fmt: skip
def test_unusable_matrices_are_refused_by_name(M, C, K, breaks, field, word):
    with pytest.raises(ParameterError) as refused:
        from_second_order(M, C, K, PERIOD, breaks)
    assert refused.value.problems[0].field == field
    assert word in str(refused.value)


def test_a_chart_of_any_family_has_its_labels_and_three_verdicts():
    def family(point: dict[str, float]) -> PeriodicSystem:
        wave = FourierSeries(np.pi, 0.0, [-2.0 * point["q"]])
        return from_second_order(1.0, point["c"], PeriodicMatrix(1.0, (wave, 1.0)), np.pi)

    axes = {"q": [0.0, 0.3], "c": [0.0, 0.1]}
    chart = scan(family, axes, labels={"c": ("1/s", "damping")})
    # a = 1 is the principal resonance: unstable for any q, on the unit circle for none, unless damped.
    assert chart["verdict"].values.tolist() == [[0, 1], [-1, -1]]
    assert chart.attrs["certificate"] == "proven"
    assert chart["c"].attrs == {"units": "1/s", "long_name": "damping"}
    with pytest.raises(ParameterError, match="labels"):
        scan(family, axes, labels={"k": ("1", "stiffness")})
    with pytest.raises(ParameterError, match="4 multipliers at n = 2"):
        scan(lambda case: from_second_order(*[np.eye(int(case["n"]))] * 3, 1.0), {"n": [1, 2]})


def test_a_high_harmonic_is_proven_where_its_own_steps_are_short():
    # A mesh seen over a turn of its gear: far above 2 omega = 20, nothing grows, |mu| = exp(-c T/2).
    wave = FourierSeries(0.3, 0.0, [0.0] * 59 + [1.0])
    result = monodromy(from_second_order(1.0, 0.1, PeriodicMatrix(100.0, (wave, 20.0)), 0.3))
    assert result.spectral_radius == pytest.approx(np.exp(-0.015), abs=result.error + 1e-15)
    assert result.error < 1e-11


def test_bounds_hold_with_a_poor_inverse_of_M_whose_errors_pass_from_row_to_row(monkeypatch):
    """An inverse W = (I - G) M^-1 leaves the error (I - G)^-1 R of X, with the residual R = W (K - M X).

    Each of the three corrections multiplies the error by G, so it is G^3 M^-1 K. K is chosen so that R is the
    unit matrix: G then brings the residual of row 0 into row 1, where no residual shows it.
    """
    M = np.array([[1.0, 0.5], [0.0, 1.0]])  # not symmetric: the coordinates stay
    G = np.array([[0.2, 0.0], [0.2, 0.2]])
    inverse = (np.eye(2) - G) @ np.array([[1.0, -0.5], [0.0, 1.0]])
    lacking = np.linalg.solve(np.eye(2) - G, np.eye(2))
    K = M @ np.linalg.solve(np.linalg.matrix_power(G, 3), lacking)
    monkeypatch.setattr("floquet.engine.second_order.np.linalg.inv", lambda P: inverse)
    A = from_second_order(M, np.zeros((2, 2)), K, PERIOD).A
    exact = -np.array([[1.0, -0.5], [0.0, 1.0]]) @ K
    error = np.abs(A.matrices[0, 2:, :2] - exact)
    np.testing.assert_allclose(error, lacking, rtol=1e-9)
    assert (error <= A.errors[0, 2:, :2]).all()
    # |G|^k sums to g/(1 - g) with the norm g = 0.4, of the largest entry of the column, which is 1.
    np.testing.assert_allclose(A.errors[0, 2:, :2], np.eye(2) + 0.4 / 0.6, rtol=1e-6)
