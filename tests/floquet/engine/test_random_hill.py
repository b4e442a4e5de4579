"""No false proof of neutral motion: random Hill systems and edges of tongues with 77 digits."""

import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("flint", reason="needs python-flint (extra: test)")
sys.path.insert(0, str(Path(__file__).parent / "judge"))

from balls import Piece, exact_multipliers
from flint import arb
from formulas import _analytic, _bounded, _cos

from floquet import FourierSeries, PeriodicMatrix, from_second_order, monodromy


def exact(K: np.ndarray, K1: np.ndarray, C: np.ndarray, period: float) -> list[tuple[complex, float]]:
    """Multipliers of x'' + C x' + (K + K1 cos(2 pi t/period)) x = 0 and radii of disks that hold them."""
    m = len(K)

    def entry(i: int, j: int):
        def value(t):
            if i < m:
                return t * 0 + arb(float(j == i + m))
            if j >= m:
                return t * 0 - arb(float(C[i - m, j - m]))
            return (t * 0 + arb(float(K[i - m, j])) + _cos(t, 1, period) * arb(float(K1[i - m, j]))) * -1

        return value

    entries = {(i, j): entry(i, j) for i in range(2 * m) for j in range(2 * m)}
    bound = _bounded(list(entries.values()), 4.0)
    parts = 24
    length = arb(period) / parts
    series = [(i, j, _analytic(one)) for (i, j), one in entries.items()]
    pieces = [Piece(k * length, length, series, bound) for k in range(parts)]
    return exact_multipliers(lambda: pieces, 2 * m)


def worst(truth: list[tuple[complex, float]]) -> float:
    """Largest distance of a modulus from 1."""
    return max(abs(abs(complex(value)) - 1.0) for value, _ in truth)


@pytest.mark.parametrize("seed", range(24))
def test_what_is_proven_is_true(seed: int) -> None:
    """Symmetric systems of 2 to 6 states, one of three damped or driven by one unit of 1e-6."""
    rng = np.random.default_rng([47, seed])
    m = 1 + seed % 3
    root = rng.normal(size=(m, m))
    K = root @ root.T + 0.3 * np.eye(m)
    K1 = rng.normal(size=(m, m))
    K, K1 = 0.5 * (K + K.T), rng.uniform(0.05, 0.8) * (K1 + K1.T)
    C = np.zeros((m, m))
    if seed % 4 == 3:
        C[0, 0] = rng.choice([1e-6, -1e-6])
    period = float(rng.uniform(0.8, 3.0))
    stiffness = PeriodicMatrix(K, (FourierSeries(period, 0.0, [1.0]), K1))
    result = monodromy(from_second_order(np.eye(m), C, stiffness, period))
    truth = exact(K, K1, C, period)
    radius = max(abs(complex(value)) for value, _ in truth)
    if result.verdict == "neutral":
        assert not C.any()
        assert worst(truth) < 1e-15  # what a complex number of two floats leaves of 77 digits
    elif result.verdict == "unstable":
        assert radius > 1.0
    elif result.verdict == "stable":
        assert radius < 1.0
    # Without damping nothing but an edge within 1e-6 is undecided: multipliers that nearly meet.
    if not C.any() and result.verdict == "undecided":
        values = np.array([complex(value) for value, _ in truth])
        apart = np.abs(values[:, None] - values) + np.eye(2 * m)
        assert apart.min() < 1e-3


@pytest.mark.parametrize("offset", [1e-5, 1e-8, 1e-10, 1e-12])
def test_the_edge_of_a_combination_tongue_is_never_called_neutral_on_the_wrong_side(offset: float) -> None:
    """Bisected edge of the sum tongue of two modes: unstable inside by 77 digits, and no proof of neutral."""
    K, K1 = np.diag([1.0, 3.0]), 0.3 * np.array([[0.0, 1.0], [1.0, 0.0]])
    centre = 1.0 + np.sqrt(3.0)

    def at(frequency: float):
        period = 2.0 * np.pi / frequency
        stiffness = PeriodicMatrix(K, (FourierSeries(period, 0.0, [1.0]), K1))
        return monodromy(from_second_order(np.eye(2), np.zeros((2, 2)), stiffness, period), 1e-12), period

    low, high = centre, centre + 0.5
    for _ in range(60):
        middle = 0.5 * (low + high)
        if np.abs(np.linalg.eigvals(at(middle)[0].matrix)).max() > 1.0 + 1e-7:
            low = middle
        else:
            high = middle
    inside, period = at(low - offset)
    radius = max(abs(complex(value)) for value, _ in exact(K, K1, np.zeros((2, 2)), period))
    assert radius > 1.0 + 1e-9
    assert inside.verdict in ("unstable", "undecided")
    outside, period = at(low + 100.0 * offset)
    if outside.verdict == "neutral":
        assert worst(exact(K, K1, np.zeros((2, 2)), period)) < 1e-15
    assert outside.verdict != "unstable" or offset < 1e-9
