"""Where a spectral radius exceeds one along a line: intervals, their ends by bisection, their peaks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from lumped.typing import FloatArray

Radius = Callable[[FloatArray], FloatArray]
"""Spectral radius at increasing parameter values, (k,) -> (k,)."""


@dataclass(frozen=True)
class UnstableInterval:
    """An interval of the parameter in which the spectral radius exceeds one.

    Attributes
    ----------
    lower, upper : its ends; equal to the end of the range where ``open_below`` or ``open_above``
    peak, peak_radius : where the spectral radius is largest, and its value
    open_below, open_above : whether the interval runs on beyond the range that was searched
    """

    lower: float
    upper: float
    peak: float
    peak_radius: float
    open_below: bool
    open_above: bool


def seeded_nodes(lines: FloatArray, low: float, high: float, coarse: int, width: float = 0.03) -> FloatArray:
    """Nodes for a search in [low, high]: evenly spaced ones, and a graded cluster at every predicted line.

    A tongue of relative width 1e-5 slips through any affordable even grid; it sits close to its line, so
    offsets that grow in proportion from 1e-6 to ``width`` on both sides of the line meet it.
    """
    offsets = np.geomspace(1e-6, width, 25)
    offsets = np.concatenate([-offsets[::-1], [0.0], offsets])
    clusters = (lines[:, None] * (1.0 + offsets)).ravel()
    nodes = np.concatenate([np.linspace(low, high, coarse), clusters])
    return np.unique(nodes[(nodes >= low) & (nodes <= high)])


def unstable_intervals(
    radius: Radius, nodes: FloatArray, *, xtol: float = 1e-9, threshold: float = 1e-9
) -> list[UnstableInterval]:
    """Find the intervals of instability that the nodes meet, with their ends to ``xtol``.

    Every local maximum of the sampled radius that comes near one is first refined, since a narrow peak
    between two nodes may still exceed one.

    Parameters
    ----------
    radius : the spectral radius
    nodes : (k,) increasing
    xtol : relative accuracy of the ends
    threshold : a radius counts as unstable above 1 + threshold, so that rounding makes no intervals
    """
    nodes, values = _refine_maxima(radius, nodes, radius(nodes))
    unstable = values > 1.0 + threshold
    if not unstable.any():
        return []
    change = np.flatnonzero(unstable[1:] != unstable[:-1])
    ends = _bisect(radius, nodes[change], nodes[change + 1], unstable[change], threshold, xtol)
    result = []
    starts = np.flatnonzero(unstable & ~np.concatenate([[False], unstable[:-1]]))
    stops = np.flatnonzero(unstable & ~np.concatenate([unstable[1:], [False]]))
    for first, last in zip(starts, stops, strict=True):
        peak = first + int(np.argmax(values[first : last + 1]))
        lower = nodes[0] if first == 0 else ends[np.searchsorted(change, first - 1)]
        upper = nodes[-1] if last == nodes.size - 1 else ends[np.searchsorted(change, last)]
        result.append(
            UnstableInterval(
                lower=float(lower),
                upper=float(upper),
                peak=float(nodes[peak]),
                peak_radius=float(values[peak]),
                open_below=bool(first == 0),
                open_above=bool(last == nodes.size - 1),
            )
        )
    return result


def _refine_maxima(
    radius: Radius, nodes: FloatArray, values: FloatArray, rounds: int = 6
) -> tuple[FloatArray, FloatArray]:
    """Add nodes around local maxima, five on either side per round, so that peaks are met near their top."""
    for _ in range(rounds):
        inner = (values[1:-1] >= values[:-2]) & (values[1:-1] >= values[2:])
        top = np.flatnonzero(inner) + 1
        # A smooth maximum well below one hides nothing: its neighbours differ by less than what is missing.
        drop = np.maximum(values[top] - values[top - 1], values[top] - values[top + 1])
        top = top[(values[top] + 4.0 * drop > 1.0) & (drop > 1e-12)]
        if top.size == 0:
            break
        fraction = np.arange(1, 6) / 6.0
        left = nodes[top - 1][:, None] + (nodes[top] - nodes[top - 1])[:, None] * fraction
        right = nodes[top][:, None] + (nodes[top + 1] - nodes[top])[:, None] * fraction
        new = np.setdiff1d(np.concatenate([left.ravel(), right.ravel()]), nodes)
        if new.size == 0:
            break
        merged = np.concatenate([nodes, new])
        order = np.argsort(merged)
        nodes, values = merged[order], np.concatenate([values, radius(new)])[order]
    return nodes, values


def _bisect(
    radius: Radius,
    left: FloatArray,
    right: FloatArray,
    left_unstable: npt.NDArray[np.bool_],
    threshold: float,
    xtol: float,
) -> FloatArray:
    """Bisect all brackets at once; left and right differ in stability."""
    left, right = left.copy(), right.copy()
    while left.size and ((right - left) > xtol * np.abs(right)).any():
        middle = 0.5 * (left + right)
        unique, inverse = np.unique(middle, return_inverse=True)
        same = (radius(unique)[inverse] > 1.0 + threshold) == left_unstable
        left, right = np.where(same, middle, left), np.where(same, right, middle)
    return np.asarray(0.5 * (left + right))
