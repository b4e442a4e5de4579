"""Is what is proven between the nodes of a chart true everywhere, and is much proven?"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

from floquet import RankOneSystem, fast_multipliers
from floquet.gear.axes import GearVariation
from floquet.gear.multipliers import feedback_system, fitted_block
from floquet.rank_one import boxes
from floquet.rank_one.batch import fast_monodromies
from floquet.rank_one.boxes import FlowPolynomial, bounded_entries, decided, proven_cells, slow_period
from floquet.rank_one.kernel_input import packed
from floquet.rank_one.system import Gains
from lumped import load_gear_pair
from tests.evidence.floquet.reference_systems import mathieu_many, mathieu_system, meissner_trace

DEPTH = 0.5


def no_factors(T):
    return np.empty((T.size, 0))


def meissner():
    """z'' + 2 zeta z' + (1 +- depth) z = 0: z = exp(-zeta t) y, and y obeys Meissner's equation."""
    w, wd = np.array([[[1.0 + DEPTH]], [[1.0 - DEPTH]]]), np.full((2, 1, 1), 2.0)
    system = RankOneSystem(
        np.zeros((1, 1)), np.zeros((1, 1)), np.ones(1), np.array([0.0, 0.5, 1.0]),
        Gains(w, wd, np.zeros((2, 2))), 1.0, np.ones(1),
    )  # fmt: skip

    def radius(T, zeta):
        half = 0.5 * np.abs([meissner_trace(1.0 - z**2, DEPTH, t) for t, z in zip(T, zeta, strict=True)])
        return np.exp(-zeta * T) * (half + np.sqrt(np.maximum(half**2 - 1.0, 0.0))).clip(min=1.0)

    return system, radius


def mathieu():
    """z'' + 2 zeta z' + (1 - 0.8 depth cos) z = 0, likewise."""

    def radius(T, zeta):
        values, _ = mathieu_many((1.0 - zeta**2) * (T / np.pi) ** 2, 0.4 * DEPTH * (T / np.pi) ** 2)
        return np.exp(-zeta * T) * np.abs(values).max(axis=1)

    return mathieu_system(0.4 * DEPTH, 2.0), radius


def inside(rng, edges, count):
    """Places in each interval, (count, cells); near its ends as often as elsewhere."""
    share = rng.beta(0.5, 0.5, (count, edges.size - 1))
    return edges[:-1] + share * np.diff(edges)


@pytest.mark.parametrize("case", [meissner, mathieu])
def test_proven_cells_are_those_of_the_closed_form(case) -> None:
    system, radius = case()
    T, zeta = np.linspace(1.5, 20.0, 201), np.linspace(0.002, 0.12, 61)
    verdict = proven_cells(system, T, zeta, no_factors)
    # 95 % and 98 % measured: edges pass through the others, or they lie at next to no damping.
    assert np.mean(verdict != 0) > 0.94
    assert min((verdict > 0).sum(), (verdict < 0).sum()) > 200
    rng = np.random.default_rng(1)
    for t, z in zip(inside(rng, T, 3), inside(rng, zeta, 3), strict=True):
        found = radius(np.repeat(t, z.size), np.tile(z, t.size)).reshape(verdict.shape)
        assert ((found < 1.0) == (verdict > 0))[verdict != 0].all()


def test_slow_variation_is_stable_from_the_period_of_the_closed_form() -> None:
    """Each period the ratio of the frequencies of both halves is gained at most, which the worst T does."""
    system, radius = meissner()
    gain = 0.5 * np.log((1.0 + DEPTH) / (1.0 - DEPTH))
    for zeta in (0.005, 0.02):
        T = slow_period(system, np.full(2, zeta), np.empty((2, 0)))
        assert abs(T * zeta / gain - 1.0) < 2e-3
        after = T * np.linspace(1.0, 1.2, 2000)
        assert radius(after, np.full(after.size, zeta)).max() < 1.0
    assert slow_period(system, np.array([0.005, 0.02]), np.empty((2, 0))) >= gain / 0.005
    # A gain that is 1 in the middle of every cell only looks constant.
    w = 1.5 * np.polynomial.polynomial.polyfromroots([-0.75, -0.25, 0.25, 0.75])
    w[0] += 1.0
    hidden = RankOneSystem(
        np.zeros((1, 1)), np.zeros((1, 1)), np.ones(1), np.array([0.0, 1.0]),
        Gains(w[None, None], np.full((1, 1, 1), 2.0), np.zeros((1, 2))), 1.0, np.ones(1),
    )  # fmt: skip
    T = np.linspace(2.0, 20.0, 400)
    unstable = T[np.abs(fast_multipliers(hidden, T, 0.005).multipliers).max(axis=1) > 1.0]
    assert unstable.max() < slow_period(hidden, np.full(2, 0.005), np.empty((2, 0)))


def test_bounds_of_the_polynomial_hold_where_it_is_bad() -> None:
    """Over far too wide a patch; of a constant system closely. The growth is that of flows within a cycle."""
    system, _ = meissner()
    one = np.ones((1, 1, 1))
    constant = replace(system, phases=np.array([0.0, 1.0]), gains=Gains(one, 0.0 * one, np.zeros((1, 2))))
    damping, u = np.array([0.0, 1.0]), np.linspace(0.0, 1.0, 101)
    for given, width, z, loose in ((system, 1e-3, u, np.inf), (constant, 24.0, 0.0 * u, 3e3)):
        patch = FlowPolynomial.of(given, packed(given), 60.0 + width * damping, damping * z[-1], no_factors)
        M = fast_monodromies(given, 60.0 + width * u, z).matrices
        x, y = (np.polynomial.chebyshev.chebvander(2.0 * v - 1.0, n - 1) for v, n in ((u, 24), (z, 16)))
        model = np.einsum("ka,abij,kb->kij", x, patch.coefficients, y)
        error = np.linalg.norm(M - model, 2, axis=(1, 2)).max()
        assert 1e-6 < error < patch.error < loose * error
    narrow = FlowPolynomial.of(system, packed(system), np.array([6.0, 6.001]), damping[[0, 0]], no_factors)
    turns = [
        expm(np.array([[0.0, 1.0], [-k, 0.0]]) * s)
        for k in (1.0 + DEPTH, 1.0 - DEPTH)
        for s in np.linspace(0.0, 3.0, 31)
    ]
    largest = max(np.linalg.norm(a @ b, 2) for a in turns[:31] for b in turns[31:])
    assert largest < narrow.growth < 1.8 * largest


@pytest.mark.parametrize("terms", [(8, 4), (3, 1)])
def test_bounds_hold_everywhere_in_boxes(terms, monkeypatch) -> None:
    """Of the polynomial, of the moduli of its entries, and none of them is loose; its error counts."""
    variation = GearVariation(load_gear_pair("nasa_art_25_31"))
    block = fitted_block(feedback_system(variation), 1.0, 1e-11, [0.0])

    def factors(T):
        return (T[:, None] / block.period) ** 0.1

    periods, damping = block.period * np.array([0.35, 0.55]), np.array([0.01, 0.03])
    patch = FlowPolynomial.of(block, packed(block), periods, damping, factors)
    rng = np.random.default_rng(2)
    ends = np.sort(rng.uniform(-1.0, 1.0, (2, 2, 60)), axis=1)
    ends[:, 1, :50] = ends[:, 0, :50] + 0.1 * np.diff(ends, axis=1)[:, 0, :50]
    ends[:, :, 50:] = np.array([-1.0, 1.0])[:, None]  # the whole patch, where the series is cut off
    monkeypatch.setattr(boxes, "_TERMS", terms)
    assert decided(patch, *ends)[0].any()
    assert not decided(replace(patch, error=1.0), *ends)[0].any()
    V, low, high, f, _, _ = bounded_entries(replace(patch, error=0.0), *ends)
    places = (
        ends[:, 0, :, None]
        + np.diff(ends, axis=1)[:, 0, :, None]
        * np.array([[0.0, 0.0, 1.0, 1.0, 0.5], [0.0, 1.0, 0.0, 1.0, 0.5]])[:, None]
    )
    T, z = (v.mean() + 0.5 * np.diff(v) * x.ravel() for v, x in zip((periods, damping), places, strict=True))
    M = fast_monodromies(block, T, z, factors(T)).matrices
    x, y = (
        np.polynomial.chebyshev.chebvander(v.ravel(), n - 1) for v, n in zip(places, (24, 16), strict=True)
    )
    model = np.einsum("ka,abij,kb->kij", x, patch.coefficients, y)
    assert np.linalg.norm(M - model, 2, axis=(1, 2)).max() <= patch.error < 1e-2
    moduli = np.abs(np.linalg.inv(V)[:, None] @ model.reshape(60, 5, 6, 6) @ V[:, None])
    own = np.einsum("kpii->kpi", moduli).copy()
    assert (own <= high[:, None]).all()
    assert (own >= low[:, None]).all()
    moduli[..., range(6), range(6)] = 0.0
    assert (moduli <= f[:, None]).all()
    if terms == (3, 1):  # then most is only bounded
        return
    assert (high - low)[:50].sum() < 1.5 * np.ptp(own, axis=1)[:50].sum()
    assert f[:50].sum() < 1.2 * moduli.max(axis=1)[:50].sum()
