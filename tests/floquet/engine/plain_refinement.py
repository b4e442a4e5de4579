"""Refinement of a chart by the steps of docs/theory/floquet.md, box after box, with the chart as arrays.

The reference of `floquet.engine.refinement`, which has the same steps as compiled code on lists.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

#: The numbers that the theory page states.
WIDTH, EXCESS, PER_DECAY, ALIKE = 64, 8.0, 1.5, 2.0


class Plain(NamedTuple):
    """Results (N, M) of a chart, as `floquet.engine.refinement.Refined`."""

    radius: np.ndarray
    verdict: np.ndarray
    known: np.ndarray
    misfit: np.ndarray


def plainly_refined(cycles, radius, verdict, gap, tolerance, rows=(0,)) -> Plain:
    """Refine a chart of which radius, verdict and gap (N, M) are known at all nodes but used where asked."""
    n, m = radius.shape
    known = np.zeros((n, m), dtype=bool)
    for row in rows:
        known[:, row] = True
    growth = cycles[:, None] * np.log(radius)
    new = [(a, min(a + WIDTH, n - 1), 0, m - 1) for a in range(0, n - 1, WIDTH)]
    leaves: dict[tuple[int, int, int, int], int] = {}
    while new:
        for a, b, c, d in new:
            known[np.ix_([a, (a + b) // 2, b], [c, (c + d) // 2, d])] = True
        again = [box for box, count in leaves.items() if known[inside(box)].sum() != count]
        chosen, new = [*new, *again], []
        for box in chosen:
            leaves.pop(box, None)
            along, up = ways(box, known, growth, cycles, radius, verdict, gap, tolerance)
            new += parts(box, along, up) if along or up else []
            if not (along or up):
                leaves[box] = known[inside(box)].sum()
    result = Plain(np.where(known, radius, 0.0), verdict * known, known, np.zeros((n, m)))
    for box in leaves:
        a, b, c, d = box
        largest = max(tolerance, errors(box, known, growth, cycles, radius)[2].max())
        for part in parts(box, b - a > 1, d - c > 1):
            i, j = nodes(part, ~known)
            result.radius[i, j] = np.exp(bilinear(part, growth, i, j) / cycles[i])
            result.verdict[i, j] = verdict[a, c]
            result.misfit[i, j] = largest
    return result


def inside(box):
    return slice(box[0], box[1] + 1), slice(box[2], box[3] + 1)


def nodes(box, chosen):
    i, j = np.nonzero(chosen[inside(box)])
    return i + box[0], j + box[2]


def bilinear(box, g, i, j):
    a, b, c, d = box
    s, t = (i - a) / max(b - a, 1), (j - c) / max(d - c, 1)
    return (g[a, c] * (1.0 - s) + g[b, c] * s) * (1.0 - t) + (g[a, d] * (1.0 - s) + g[b, d] * s) * t


def errors(box, known, growth, cycles, radius):
    i, j = nodes(box, known)
    return i, j, np.abs(np.exp(bilinear(box, growth, i, j) / cycles[i]) - radius[i, j])


def parts(box, along, up):
    a, b, c, d = box
    columns = [(a, (a + b) // 2), ((a + b) // 2, b)] if along else [(a, b)]
    rows = [(c, (c + d) // 2), ((c + d) // 2, d)] if up else [(c, d)]
    return [(*column, *row) for column in columns for row in rows]


def ways(box, known, growth, cycles, radius, verdict, gap, tolerance):
    """Whether a box is cut along its first and along its second axis."""
    a, b, c, d = box
    i, j, error = errors(box, known, growth, cycles, radius)
    v, r, apart = verdict[i, j], radius[i, j], gap[i, j]
    if (b - a <= 1 and d - c <= 1) or not i.size:
        return False, False
    if (v != v[0]).any():
        along, up = (
            any(np.unique(v[edge]).size > 1 for edge in edges)
            for edges in ((j == c, j == d), (i == a, i == b))
        )
        along, up = (along, up) if along or up else (True, True)
    else:
        allowed = tolerance * np.maximum(r, 1.0)
        if v[0] != 0:
            allowed = np.minimum(allowed, 0.5 * np.abs(r - 1.0))
        across, upward = error[(j == c) | (j == d)].max(), error[(i == a) | (i == b)].max()
        if (error <= allowed).all():
            if v[0] >= 0 and np.ptp(apart) > PER_DECAY * apart.min():
                nine = gap[np.ix_([a, (a + b) // 2, b], [c, (c + d) // 2, d])]
                across, upward = (np.abs(np.diff(nine, axis=axis)).max() for axis in (0, 1))
            elif v[0] > 0 or v[0] == 0 or (r - 1.0).max() <= EXCESS * (r - 1.0).min():
                return False, False
        along, up = across * ALIKE >= upward, upward * ALIKE >= across
    return b - a > 1 and (along or d - c <= 1), d - c > 1 and (up or b - a <= 1)
