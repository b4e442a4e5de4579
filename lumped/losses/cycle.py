"""Where the tooth pairs are over one mesh cycle: nodes of an exact quadrature, or evenly spaced samples."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lumped.gear_geometry.geometry import Geometry
from lumped.path_function import PathFunction
from lumped.typing import FloatArray

#: Exact to degree 15: a fitted mu of degree 8 times a sliding velocity of degree 1, and a load share.
_NODES = 8
_SAME = 1e-13  # of a base pitch: edges closer than this are one


@dataclass(frozen=True, eq=False)
class CyclePositions:
    """Positions of all tooth pairs at instants of one mesh cycle.

    Attributes
    ----------
    phase : (k,) way of the pair that entered last beyond A, 0 to one base pitch [m]
    weight : (k,) quadrature weights, sum 1
    position : (pairs, k) xi_i, pair 0 is ahead [m]
    contact : (pairs, k) whether L_XA <= xi_i <= L_XD
    """

    phase: FloatArray
    weight: FloatArray
    position: FloatArray
    contact: NDArray[np.bool_]

    def mean(self, values: FloatArray) -> float:
        """Mean over the cycle of values (k,)."""
        return float(self.weight @ values)


def quadrature(g: Geometry, functions: Iterable[PathFunction]) -> CyclePositions:
    """Gauss-Legendre nodes on every stretch of the cycle between two breaks of the functions, P, A and D.

    Parameters
    ----------
    g : geometry of the pair
    functions : path functions that the integrand is made of; on each stretch they are single polynomials
    """
    marks = np.concatenate([np.array([g.L_XA, g.L_XP, g.L_XD]), *(f.breaks for f in functions)])
    folded = np.sort(np.mod(marks - g.L_XA, g.base_pitch))
    edges = np.concatenate([[0.0], folded, [g.base_pitch]])
    edges = edges[np.append(True, np.diff(edges) > _SAME * g.base_pitch)]
    edges[-1] = g.base_pitch
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    half = 0.5 * np.diff(edges)
    phase = (edges[:-1] + half)[:, None] + half[:, None] * nodes
    weight = np.asarray(half[:, None] * weights / g.base_pitch, dtype=np.float64)
    return _at(g, phase.ravel(), weight.ravel())


def samples(g: Geometry, count: int) -> CyclePositions:
    """Evenly spaced instants of the cycle, from the entry at A, the end left out."""
    phase = np.asarray(np.arange(count) * (g.base_pitch / count), dtype=np.float64)
    return _at(g, phase, np.full(count, 1.0 / count))


def _at(g: Geometry, phase: FloatArray, weight: FloatArray) -> CyclePositions:
    position = g.L_XA + np.arange(g.pairs - 1, -1, -1)[:, None] * g.base_pitch + phase
    return CyclePositions(phase, weight, position, position < g.L_XD)
