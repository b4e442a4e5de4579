"""Element laws of a tooth pair as finite motions make them act, still functions of the nominal position."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lumped.path_function import PathFunction, shifted
from lumped.typing import FloatArray

#: Places on the path closer than this are one [m].
_SAME = 1e-11
#: Arguments at which tanh is broken into lines: what they leave out is below a thousandth of its size.
_TANH = np.arctanh(np.linspace(-0.999, 0.999, 81))
#: Lines that stand for one piece of a friction law.
_PARTS = 8
#: A change across a break by more than this share of the largest value is a jump.
_JUMP = 1e-4


def moved(law: PathFunction, place: FloatArray, stands_at: FloatArray) -> PathFunction:
    """The law where the contact stands away from its nominal position.

    Parameters
    ----------
    law : k(xi) or c(xi)
    place : (k,) nominal positions, over the whole path [m]
    stands_at : (k,) actual positions there; beyond the path the law keeps its value at the end [m]

    Returns
    -------
    PathFunction, linear between the places and the crossings of breaks of the law
    """
    lines = Lines.between(law.interval, law.breaks[1:-1], place, stands_at)
    return lines.through(law(np.clip(np.interp(lines.inner, place, stands_at), *law.interval)))


def at_sliding(
    law: PathFunction,
    interval: tuple[float, float],
    pitch_point: float,
    place: FloatArray,
    slides_as: FloatArray,
    width: float,
    ratio: FloatArray,
) -> PathFunction:
    """Friction coefficient at the actual contact, with the sign that the law has where it slides as fast.

    Parameters
    ----------
    law : mu(xi) at nominal rotation, where xi tells the sliding velocity: it vanishes at the pitch point;
        beyond its ends it keeps its value there
    interval : places between which a pair is followed [m]
    pitch_point : L_XP [m]
    place : (k,) nominal positions, over the whole path [m]
    slides_as : (k,) where the nominal motion slides as fast as the teeth do there [m]
    width : distance from the pitch point over which the sign changes, as tanh [m]; at once if it is less than
        the places lie apart
    ratio : (k,) coefficient at the actual contact over that of the nominal motion where it slides as fast

    Returns
    -------
    PathFunction, linear between the places and the crossings of breaks of the law
    """
    width = width if width > np.diff(place).max() else 0.0

    pieces = law.breaks.size - 1
    parts = np.interp(np.arange(pieces * _PARTS + 1) / _PARTS, np.arange(pieces + 1), law.breaks)
    marks = np.union1d(parts, pitch_point + width * _TANH)
    lines = Lines.between(interval, marks, place, slides_as)
    equivalent = np.interp(lines.inner, place, slides_as)
    mu = law(np.clip(equivalent, *law.interval)) * np.interp(lines.inner, place, ratio)
    return lines.through(mu * np.tanh(np.abs(equivalent - pitch_point) / width) if width > 0.0 else mu)


def shortened(law: PathFunction, first: float, last: float) -> PathFunction:
    """The law where the pair carries load only from ``first`` to ``last`` [m]; zero on the rest of its path.

    Parameters
    ----------
    law : k(xi) or c(xi)
    first, last : places on the law's path, first < last
    """
    low, high = law.interval
    first, last = max(first, low), min(last, high)
    inner = np.flatnonzero((law.breaks > first + _SAME) & (law.breaks < last - _SAME))
    edges = np.concatenate([[first], law.breaks[inner], [last]])
    columns = np.column_stack([_from(law, first), law.coefficients[:, inner]])
    zero = np.zeros((columns.shape[0], 1))
    if first > low:
        edges, columns = np.append(low, edges), np.hstack([zero, columns])
    if last < high:
        edges, columns = np.append(edges, high), np.hstack([columns, zero])
    switches = [s for s in law.switches if first < s < last]
    switches += [place for place in (first, last) if low < place < high]
    return PathFunction(edges, columns, np.array(switches))


def reversed_within(law: PathFunction, first: float, last: float) -> PathFunction:
    """The law with the other sign from ``first`` to ``last`` [m], first < last; clipped to the law's path."""
    low, high = law.interval
    ends = np.clip([first, last], low, high)
    edges = np.union1d(law.breaks, ends)
    edges = edges[np.diff(edges, prepend=-np.inf) > _SAME]
    edges[-1] = high
    columns = np.column_stack([_from(law, edge) for edge in edges[:-1]])
    middles = 0.5 * (edges[:-1] + edges[1:])
    sign = np.where((middles > ends[0]) & (middles < ends[1]), -1.0, 1.0)
    switches = np.union1d(law.switches, ends[(ends > low) & (ends < high)])
    return PathFunction(edges, sign * columns, switches)


@dataclass(frozen=True, eq=False)
class Lines:
    """Pieces in which straight lines stand for laws along the path, each through two inner places.

    So a jump at a node stays outside.

    Attributes
    ----------
    nodes : (n + 1,) ends of the pieces [m]
    inner : (2, n) the two places in each [m]
    """

    nodes: FloatArray
    inner: FloatArray

    @classmethod
    def between(
        cls, interval: tuple[float, float], marks: FloatArray, place: FloatArray, image: FloatArray
    ) -> Lines:
        """Lines broken at the places (k,) and where their image (k,) meets a mark, on an interval [m]."""
        low, high = interval
        marks = np.sort(marks)
        first = np.searchsorted(marks, np.minimum(image[:-1], image[1:]), side="right")
        count = np.maximum(np.searchsorted(marks, np.maximum(image[:-1], image[1:])) - first, 0)
        piece = np.repeat(np.arange(count.size), count)
        met = marks[np.arange(piece.size) + np.repeat(first - np.cumsum(count) + count, count)]
        share = (image[piece] - met) / (image[piece] - image[piece + 1])
        nodes = np.concatenate([place, place[piece] + share * np.diff(place)[piece], [low, high]])
        nodes = np.unique(nodes[(nodes >= low) & (nodes <= high)])
        nodes = nodes[np.diff(nodes, prepend=-np.inf) > _SAME]
        nodes[-1] = high
        return cls(nodes, nodes[:-1] + np.multiply.outer([0.25, 0.75], np.diff(nodes)))

    def through(self, values: FloatArray) -> PathFunction:
        """The law with these values (2, n) at the inner places."""
        near, far = values
        width = np.diff(self.nodes)
        slope = (far - near) / (0.5 * width)
        start = near - 0.25 * width * slope
        jump = np.abs(start[1:] - (start + slope * width)[:-1]) > _JUMP * np.abs(near).max()
        return PathFunction(self.nodes, np.stack([slope, start]), self.nodes[1:-1][jump])

    def bent_through(self, values: FloatArray, middle: FloatArray) -> PathFunction:
        """Parabolas through these values and those halfway (n,): their slope is right at the nodes."""
        near, far = values
        width = np.diff(self.nodes)
        slope, bend = 2.0 * (far - near) / width, 8.0 * (near - 2.0 * middle + far) / width**2
        start = middle - 0.5 * width * slope + 0.25 * width**2 * bend
        return PathFunction(self.nodes, np.stack([bend, slope - width * bend, start]), np.empty(0))


def _from(law: PathFunction, place: float) -> FloatArray:
    """Coefficients in powers of (xi - place), highest first, of the piece that holds ``place``."""
    piece = int(np.clip(np.searchsorted(law.breaks, place + _SAME) - 1, 0, law.breaks.size - 2))
    return shifted(law.coefficients[:, piece], place - law.breaks[piece])
