"""Does the monodromy matrix equal the closed forms of Floquet theory?"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.special import mathieu_a, mathieu_b

from floquet import PROPAGATORS, PeriodicSystem, monodromy


def meissner(delta: float, epsilon: float, period: float) -> PeriodicSystem:
    """x'' + (delta + epsilon sgn) x = 0, + in the first half of the period and - in the second."""

    def A(t: float) -> list[list[float]]:
        # At the switches themselves the callable answers nonsense on purpose: nothing may be evaluated there.
        if t in (0.0, period / 2, period):
            return [[np.nan, np.nan], [np.nan, np.nan]]
        stiffness = delta + epsilon if t < period / 2 else delta - epsilon
        return [[0.0, 1.0], [-stiffness, 0.0]]

    return PeriodicSystem(A, period, breakpoints=(period / 2,))


@pytest.mark.parametrize("method", ["gauss", "gauss8", "magnus6", "magnus4", "expm", "dop853"])
@pytest.mark.parametrize(("delta", "epsilon"), [(1.3, 0.4), (4.0, 3.0), (2.2, 0.05)])
def test_meissner_trace(method: str, delta: float, epsilon: float) -> None:
    # tr M of two harmonic motions w1, w2 of duration T/2 each:
    #   2 cos cos - (w1/w2 + w2/w1) sin sin  (Meissner 1918; multiply the two rotation matrices).
    period = 2 * np.pi
    w1, w2 = np.sqrt(delta + epsilon), np.sqrt(delta - epsilon)
    p1, p2 = w1 * period / 2, w2 * period / 2
    trace = 2 * np.cos(p1) * np.cos(p2) - (w1 / w2 + w2 / w1) * np.sin(p1) * np.sin(p2)
    result = monodromy(meissner(delta, epsilon, period), rtol=1e-11, method=method)
    # 1e-9: required accuracy; rtol 1e-11 with |M| < 10 leaves it a factor ten of room.
    assert abs(np.trace(result.matrix) - trace) < 1e-9
    assert result.verdict == {True: "unstable", False: "undecided"}[abs(trace) > 2]


@pytest.mark.parametrize("q", [0.1, 1.0, 5.0])
@pytest.mark.parametrize("order", [0, 1, 2, 3, 4])
def test_mathieu_boundaries(mathieu, q: float, order: int) -> None:
    # On a_m and b_m a solution of period pi (m even) or 2 pi (m odd) exists, so tr M = +2 or -2 at T = pi
    # (DLMF 28.2); det M = 1 makes the two multipliers equal there.
    for boundary in [mathieu_a, mathieu_b] if order else [mathieu_a]:
        a = float(boundary(order, q))
        result = monodromy(mathieu(a, q), rtol=1e-10)
        # 1e-9: scipy's characteristic values are good to about 1e-13, times d(tr)/da < 100 here.
        assert abs(np.trace(result.matrix) - 2 * (-1) ** order) < 1e-9


@pytest.mark.parametrize(("a", "q", "c"), [(1.0, 0.3, 0.05), (2.5, 1.7, 0.3), (0.2, 0.9, 0.02)])
def test_damped_mathieu_is_shifted_undamped(mathieu, a: float, q: float, c: float) -> None:
    # x = exp(-c t) y turns the damped equation into the undamped one with a - c^2.
    damped = monodromy(mathieu(a, q, c), rtol=1e-12)
    undamped = monodromy(mathieu(a - c**2, q), rtol=1e-12)
    shift = np.exp(-c * np.pi)
    # 1e-10: two runs at rtol 1e-12, multipliers below 10 and well apart.
    assert np.allclose(np.abs(damped.multipliers), shift * np.abs(undamped.multipliers), rtol=1e-10, atol=0)
    assert abs(np.trace(damped.matrix) - shift * np.trace(undamped.matrix)) < 1e-10


@pytest.mark.parametrize("method", sorted(PROPAGATORS))
def test_constant_coefficients(method: str) -> None:
    rng = np.random.default_rng(7)
    A0 = rng.normal(size=(5, 5)) - 0.5 * np.eye(5)
    rtol = 1e-8 if method in ("rk4", "gauss4") else 1e-11  # order 4 would need very many steps for 1e-11
    result = monodromy(PeriodicSystem(lambda t: A0, 2.0), rtol=rtol, method=method)
    exact = expm(2.0 * A0)
    assert np.linalg.norm(result.matrix - exact) < 10 * rtol * np.linalg.norm(exact)  # 10: balanced norm
    # The exponents are the eigenvalues of A while |Im| < pi/T; seed 7 keeps them there.
    eigenvalues = np.linalg.eigvals(A0)
    assert np.abs(eigenvalues.imag).max() < np.pi / 2
    gap = np.abs(result.exponents[:, None] - eigenvalues[None, :]).min(axis=1)
    assert gap.max() < 1e3 * rtol  # conditioning of the smallest multiplier


def test_piecewise_constant_product() -> None:
    # Three different constant matrices: M = exp(A3 h3) exp(A2 h2) exp(A1 h1), the last factor acting first.
    rng = np.random.default_rng(3)
    matrices = rng.normal(size=(3, 4, 4))
    edges = np.array([0.0, 0.3, 0.75, 1.0])

    def A(t: np.ndarray) -> np.ndarray:
        return matrices[np.searchsorted(edges, t) - 1]

    result = monodromy(PeriodicSystem(A, 1.0, edges[1:3], vectorized=True), rtol=1e-12)
    exact = np.eye(4)
    for matrix, h in zip(matrices, np.diff(edges), strict=True):
        exact = expm(matrix * h) @ exact
    assert np.linalg.norm(result.matrix - exact) < 1e-10 * np.linalg.norm(exact)  # rtol with room for scaling
