"""Does a chart that refines itself find what the whole grid has, with few nodes?"""

import numpy as np
import pytest

from floquet.engine.refinement import TOLERANCE, NodeValues, refine, search_leaves
from tests.floquet.engine.plain_refinement import plainly_refined


def tongues(x, y, centres, widths):
    """Growth rate with instability wedges that open from y = 0, as tongues of damped parametric resonance."""
    growth = -20.0 * y - 0.02 * np.sin(3.0 * x)
    for centre, width in zip(centres, widths, strict=True):
        inside = np.maximum(width**2 - (x - centre) ** 2, 0.0)
        growth = growth + 3.0 * np.sqrt(inside)
    return growth


def chart(shape, centres, widths):
    """Spectral radius and verdict of every node of a chart with these tongues; cycles a unit of time, x."""
    x = np.linspace(1.0, 9.0, shape[0])
    y = np.linspace(0.0, 0.1, shape[1])
    radius = np.exp(tongues(x[:, None], y[None, :], centres, widths) / x[:, None])
    return x, radius, np.where(radius > 1.0, -1, 1)


def refined(shape, x, radius, verdict):
    evaluated: list[int] = []

    def ask(nodes):
        evaluated.extend(nodes.tolist())
        return NodeValues(radius.ravel()[nodes], verdict.ravel()[nodes], np.zeros(nodes.size))

    return refine(shape, x, ask), evaluated


def test_what_is_evaluated_grows_as_the_edges_do_and_no_tongue_is_lost():
    """Nodes near edges grow with N, those of the grid with N^2 (docs/theory/floquet.md); one tongue thin."""
    evaluated = []
    for n in (401, 801, 1601):
        shape = (n, n // 4)
        x, radius, verdict = chart(shape, [2.0, 4.5, 7.0], [0.3, 0.02, 0.4])
        got, _ = refined(shape, x, radius, verdict)
        assert (got.verdict == verdict).all()
        evaluated.append(got.known.sum())
    coarse, middle, fine = evaluated
    assert fine / middle < 2.6
    assert middle / coarse < 2.6
    assert fine < 0.03 * 1601 * 400


def test_interpolated_radii_are_within_the_tolerance_where_the_growth_is_smooth():
    shape = (801, 61)
    x, radius, verdict = chart(shape, [], [])
    got, evaluated = refined(shape, x, radius, verdict)
    assert len(evaluated) == len(set(evaluated)) == got.known.sum() < got.known.size
    assert np.abs(got.radius - radius).max() <= TOLERANCE
    assert (got.misfit[~got.known] >= TOLERANCE).all()


def test_a_node_asked_for_one_box_is_read_by_its_neighbours():
    """Waves in every direction: leaves are judged again by all nodes known in them."""
    rng = np.random.default_rng(3)
    x, y = np.ogrid[0.0:1.0:257j, 0.0:1.0:65j]
    for _ in range(12):
        waves = [
            rng.normal() * np.cos(2.0 * np.pi * (f * x + h * y) + rng.uniform(0.0, 6.0))
            for f, h in rng.uniform(0.0, 3.0, (4, 2))
        ]
        radius = np.exp(0.04 * sum(waves) - 0.05)
        got, _ = refined(radius.shape, np.ones(257), radius, np.where(radius > 1.0, -1, 1))
        assert (np.abs(got.radius - radius) <= TOLERANCE * np.maximum(radius, 1.0)).all()


X, Y = np.ogrid[0.0:65.0, 0.0:65.0]
BUMP = np.exp(-(((X - 16.0) / 3.0) ** 2) - ((Y - 32.0) / 12.0) ** 2)
WIDE = np.exp(-(((X - 20.0) / 24.0) ** 2) - ((Y - 40.0) / 9.0) ** 2)


@pytest.mark.parametrize("radius", [
    # Unstable, next to 1 at one end: the stable place lies between the nodes of the first box.
    1.0 + 1e-4 + 8e-5 * X - 3e-3 * BUMP,
    # Stable by a thousandth: the unstable place raises its nodes by less than the tolerance.
    1.0 - 1e-3 + 1.8e-3 * WIDE,
])  # fmt: skip
def test_a_radius_next_to_one_is_looked_at_more_closely(radius):
    verdict = np.where(radius > 1.0, -1, 1)
    assert abs(verdict.sum()) < verdict.size
    got, _ = refined(radius.shape, np.ones(65), radius, verdict)
    assert (got.verdict == verdict).all()


def test_a_plateau_at_one_is_one_leaf_and_keeps_its_verdict():
    """Undamped bearings have multipliers of modulus one: nothing there is decided, and nothing is cut."""
    radius = np.ones((257, 33))
    verdict = np.zeros((257, 33), dtype=int)
    got, evaluated = refined(radius.shape, np.linspace(1.0, 2.0, 257), radius, verdict)
    assert (got.verdict == 0).all()
    assert len(evaluated) < 257 + 9 * 8


@pytest.mark.parametrize("shape", [(2, 2), (2, 90), (90, 2), (3, 3), (65, 5)])
def test_small_charts(shape):
    x, radius, verdict = chart(shape, [4.0], [1.5])
    got, _ = refined(shape, x, radius, verdict)
    assert (got.verdict == verdict).all()
    assert np.isfinite(got.radius).all()


def waves_of(rng, x, y):
    """Sum of four waves over the unit square, of size about 1."""
    return sum(
        0.5 * rng.normal() * np.cos(2.0 * np.pi * (f * x + h * y) + rng.uniform(0.0, 6.0))
        for f, h in rng.uniform(0.0, 4.0, (4, 2))
    )


@pytest.mark.parametrize("seed", range(6))
def test_the_compiled_search_has_the_boxes_of_the_plain_one(seed):
    """All nodes, verdicts, radii and misfits, on waves with edges, plateaus, cusps and small gaps."""
    rng = np.random.default_rng(seed)
    shape = tuple(rng.integers(40, 170, 2))
    x, y = np.ogrid[0.0 : 1.0 : shape[0] * 1j, 0.0 : 1.0 : shape[1] * 1j]
    cycles = np.sort(rng.uniform(0.5, 4.0, shape[0]))
    radius = np.exp(0.04 * waves_of(rng, x, y) - 0.01 - 0.03 * np.abs(waves_of(rng, x, y)))
    radius = np.where(np.abs(radius - 1.0) < 0.002 * (seed % 3), 1.0, radius)
    verdict = np.sign(1.0 - radius).astype(np.int8)
    gap = np.abs(waves_of(rng, x, y)) + 1e-3 if seed % 2 else np.zeros(shape)

    def ask(nodes):
        assert (np.diff(nodes) > 0).all()
        return NodeValues(radius.ravel()[nodes], verdict.ravel()[nodes], gap.ravel()[nodes])

    rows = (0, shape[1] // 2, -1) if seed % 4 else (0,)
    got = refine(shape, cycles, ask, rows=rows)
    expected = plainly_refined(cycles, radius, verdict, gap, TOLERANCE, rows)
    assert 0.01 < expected.known.mean() < 0.99
    assert (got.known == expected.known).all()
    assert (got.verdict == expected.verdict).all()
    np.testing.assert_allclose(got.radius, expected.radius, rtol=1e-13)  # products of sums round otherwise
    np.testing.assert_allclose(got.misfit, expected.misfit, rtol=0.0, atol=1e-13)


def test_a_search_has_lists_of_evaluated_nodes_not_the_chart():
    """A chart of 2.6e8 nodes, 2 GB as one array of radii, with one tongue."""
    shape = 16_000, 16_000
    evaluated = 0

    def ask(nodes):
        nonlocal evaluated
        evaluated += nodes.size
        i, j = np.divmod(nodes, shape[1])
        radius = np.exp(tongues(1.0 + 8.0 * i / shape[0], 0.1 * j / shape[1], [4.5], [0.3]))
        return NodeValues(radius, np.where(radius > 1.0, -1, 1), np.zeros(nodes.size))

    leaves = search_leaves(shape, np.ones(shape[0]), ask)
    area = leaves.tree.last - leaves.tree.first
    area = area * (leaves.tree.high - leaves.tree.low)
    assert evaluated == leaves.places.size < 8e-4 * shape[0] * shape[1]
    assert area[leaves.boxes].sum() == (shape[0] - 1) * (shape[1] - 1)
