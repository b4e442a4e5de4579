"""Are gains of high degree inside the bounds of the polynomials of degree 8 that stand for them?

Gains are Chebyshev series on each segment, so that what is dropped is known, compared with 77 digits.
"""

from dataclasses import dataclass

import numpy as np
import pytest

pytest.importorskip("flint", reason="needs python-flint (extra: test)")

from flint import arb, arb_poly, ctx

from floquet.rank_one.piecewise import fit_pieces, series_rounding, to_series
from tests.floquet.engine.judge.enclosures import least

METRIC = np.array([4.0, 0.25])


@dataclass
class Series:
    """Gains of two components: (G, segments, degree + 1, 2) coefficients of T_k over each segment."""

    edges: np.ndarray
    series: np.ndarray
    errors: float = 0.0
    fixed: float = 0.0

    @property
    def count(self) -> int:
        return self.series.shape[2]

    def __call__(self, centre, half, segment, nodes):
        low, high = self.edges[segment], self.edges[segment + 1]
        place = (2.0 * (centre[:, None] + half[:, None] * nodes) - (low + high)[:, None]) / (high - low)[
            :, None
        ]
        T = np.polynomial.chebyshev.chebvander(place, self.count - 1)
        values = np.einsum("ksj,gkjm->gksm", T, self.series[:, segment])
        size = np.full((len(self.series), centre.size), 1.0)
        return values, self.errors * size, self.fixed * size


def ratios(gains: Series, rtol: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Phases; largest error in the metric, and bound on it, of every piece and gain (P, G)."""
    phases, polynomials, bounds, edge_indices = fit_pieces(gains, gains.edges, METRIC, rtol=rtol)
    assert (phases[edge_indices] == gains.edges).all()
    ctx.prec = 256
    errors = np.zeros_like(bounds)
    for g, rows in enumerate(polynomials):
        for p, row in enumerate(rows):
            j = int(np.searchsorted(edge_indices, p, side="right")) - 1
            low, high = arb(gains.edges[j]), arb(gains.edges[j + 1])
            first, last = arb(phases[p]), arb(phases[p + 1])
            fits = [arb_poly([arb(c) for c in component]) for component in row]
            for u in map(arb, np.cos(np.pi * np.arange(19) / 18)):
                place = (first + last + (last - first) * u - low - high) / (high - low)
                values = [place.chebyshev_t(k) for k in range(gains.count)]
                errors_on_piece = [
                    sum((arb(c) * T for c, T in zip(gains.series[g, j, :, m], values, strict=True)), arb(0))
                    - fits[m](u)
                    for m in range(2)
                ]
                norm = (errors_on_piece[0] ** 2 * METRIC[0] + errors_on_piece[1] ** 2 * METRIC[1]).sqrt()
                errors[p, g] = max(errors[p, g], least(norm))
    return phases, errors, bounds


@pytest.mark.parametrize("signs", [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0)])
def test_what_is_dropped_is_the_bound_where_all_of_it_is_largest(signs) -> None:
    """T_9 and T_10 attain the sum of their moduli at one or both ends. Other declared errors are added."""
    series = np.zeros((2, 1, 11, 2))
    series[:, 0, 0] = [1.0, -2.0]
    series[:, 0, 8] = [-0.1, 0.3]
    series[0, 0, 9:] = 1e-3 * np.outer(signs, [0.7, -0.4])
    series[1, 0, 10] = [0.0, 1e-3]
    for errors, fixed in ((0.0, 0.0), (1e-4, 0.0), (0.0, 1e-4)):
        _, error, bound = ratios(Series(np.array([0.0, 1.0]), series, errors, fixed), 1e-2)
        assert bound.shape == (1, 2)
        dropped_bound = bound - errors - fixed
        assert (error <= dropped_bound).all()
        assert (dropped_bound < error * (1.0 + 1e-8)).all()


def test_powers_within_the_tolerance_are_dropped_and_counted() -> None:
    """3 % of the tolerance may go: T_3 to T_5 together, not T_2, with what is beyond degree 8."""
    series = np.zeros((1, 1, 10, 2))
    series[0, 0, :3] = [1.0, 0.5]
    series[0, 0, 3:6] = [1e-5, 2e-5]
    series[0, 0, 9] = [3e-4, 0.0]
    gains = Series(np.array([0.0, 1.0]), series)
    _, polynomials, _, _ = fit_pieces(gains, gains.edges, METRIC, rtol=1e-2)
    assert polynomials[0].shape == (1, 2, 3)
    _, error, bound = ratios(gains, 1e-2)
    # All are largest at u = 1, but their moduli are those of two vectors that are not parallel.
    assert error <= bound < 1.1 * error


def test_signed_gains_on_segments_of_one_ulp_and_at_their_ends_are_inside() -> None:
    """Degree 20, halved within segments. The middle of the segment of one ulp rounds to its end."""
    rng = np.random.default_rng(3)
    edges = np.array([0.0, 0.3, np.nextafter(0.3, 1.0), 0.55, 1.0])
    series = rng.normal(size=(2, 4, 21, 2)) * 0.6 ** np.arange(21)[:, None] * (-1.0) ** np.arange(21)[:, None]
    series[:, 1] *= np.append([1.0], np.zeros(20))[:, None]  # no more than a constant fits into an ulp
    for rtol in (1e-3, 1e-11):
        phases, error, bound = ratios(Series(edges, series), rtol)
        assert phases.size > edges.size
        assert (np.diff(phases) > 0.0).all()
        assert (error <= bound).all()
        # All of the tolerance is used, which is relative to the largest value and grows on short pieces.
        assert error.max() > 0.1 * rtol


def test_values_at_nodes_give_their_series_to_the_rounding_that_is_said() -> None:
    """Of values of either sign and modulus 1, whose series in exact arithmetic is compared."""
    rng = np.random.default_rng(4)
    ctx.prec = 256
    for count in (2, 9, 25):
        nodes, matrix = to_series(count)
        values = rng.choice([-1.0, 1.0], count)
        series = matrix @ values
        largest_error = 0.0
        for k in range(count):
            exact = sum(
                (arb(v) * (arb(k) * arb(2 * j + 1) / (2 * count)).cos_pi() for j, v in enumerate(values)),
                arb(0),
            )
            largest_error += least(exact * (1 if k == 0 else 2) / count - arb(series[k]))
        assert 0.0 < largest_error <= series_rounding(count)
        assert np.abs(nodes - np.cos(np.pi * (np.arange(count) + 0.5) / count)).max() < 4e-16
