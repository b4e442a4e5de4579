"""Does a chart that refines itself find what the whole grid has, with few nodes?"""

import numpy as np
import pytest

from floquet.engine.refinement import TOLERANCE, refine


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
    asked: list[int] = []

    def ask(flat):
        asked.extend(flat.tolist())
        return radius.ravel()[flat], verdict.ravel()[flat], np.zeros(flat.size)

    return refine(shape, x, ask), asked


def test_what_is_evaluated_grows_as_the_edges_do():
    """Nodes near edges grow with N, those of the grid with N^2 (docs/theory/floquet.md)."""
    asked = []
    for n in (401, 801, 1601):
        shape = (n, n // 4)
        x, radius, verdict = chart(shape, [2.0, 4.5, 7.0], [0.3, 0.2, 0.4])
        asked.append(refined(shape, x, radius, verdict)[0].known.sum())
    assert asked[2] / asked[1] < 2.6
    assert asked[1] / asked[0] < 2.6
    assert asked[2] < 0.03 * 1601 * 400


def test_interpolated_radii_are_within_the_tolerance_where_the_growth_is_smooth():
    shape = (801, 61)
    x, radius, verdict = chart(shape, [], [])
    got, asked = refined(shape, x, radius, verdict)
    assert len(asked) == len(set(asked)) == got.known.sum() < got.known.size
    assert np.abs(got.radius - radius).max() <= TOLERANCE
    assert (got.misfit[~got.known] >= TOLERANCE).all()


def test_a_plateau_at_one_is_one_leaf_and_keeps_its_verdict():
    """Undamped bearings have multipliers of modulus one: nothing there is decided, and nothing is cut."""
    shape = (257, 33)
    radius, verdict = np.ones(shape), np.zeros(shape, dtype=int)
    got, asked = refined(shape, np.linspace(1.0, 2.0, 257), radius, verdict)
    assert (got.verdict == 0).all()
    assert len(asked) < 257 + 9 * 8


@pytest.mark.parametrize("shape", [(2, 2), (2, 90), (90, 2), (3, 3), (65, 5)])
def test_small_charts(shape):
    x, radius, verdict = chart(shape, [4.0], [1.5])
    got, _ = refined(shape, x, radius, verdict)
    assert (got.verdict == verdict).all()
    assert np.isfinite(got.radius).all()
