"""Monodromy matrices and multipliers in ball arithmetic: every number an interval that holds the exact one.

Written without any code of the package under test: Taylor steps whose remainder is enclosed, a product by
pairs, eigenvalues by Arb (F. Johansson, IEEE Transactions on Computers 66 (2017) 1281-1292).
"""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from flint import acb_mat, arb, arb_mat, arb_poly, ctx
from scipy.optimize import linear_sum_assignment

BITS = 256
_MORE_BITS = 1024
_TERMS = 80  # of a series with BITS
_RHO = (1.2, 1.5, 2.0, 3.0, 4.5, 7.0, 12.0, 25.0, 60.0, 200.0)
_ANGLE = 1.5

Coefficients = Callable[[arb, arb, int], list[arb]]
"""(start, length, count) -> Taylor coefficients of an entry over start + length s, 0 <= s <= 1."""


class Piece(NamedTuple):
    """A stretch of time on which every entry of A is analytic."""

    start: arb  # [s]
    length: arb
    entries: Sequence[tuple[int, int, Coefficients]]
    bound: Callable[[arb, arb], tuple[arb, float]] | None = None  # (start, length) -> (B, R)


def polynomial(poly: arb_poly) -> Coefficients:
    """An entry that is a polynomial of the time itself."""

    def coefficients(start: arb, length: arb, count: int) -> list[arb]:
        shifted = poly(arb_poly([start, length]))
        if shifted.degree() >= count:
            raise ValueError("the degree is too high")
        return [shifted[k] for k in range(min(count, shifted.degree() + 1))]

    return coefficients


def exact_multipliers(pieces: Callable[[], Sequence[Piece]], n: int) -> list[tuple[complex, float]]:
    """Centre and radius of a disk about each multiplier, with more bits where these do not part them."""
    for bits in (BITS, _MORE_BITS):
        ctx.prec = bits
        try:
            return multipliers(monodromy(pieces(), n, bits))
        except ValueError:
            if bits == _MORE_BITS:
                raise
    raise AssertionError


def monodromy(pieces: Sequence[Piece], n: int, bits: int = BITS) -> arb_mat:
    """Enclosure of Phi(T, 0); the remainder of a step is about 2^-(bits/2)."""
    flows = [flow for piece in pieces for flow in _flows(piece, n, bits)]
    while len(flows) > 1:
        flows = [flows[i + 1] * flows[i] if i + 1 < len(flows) else flows[i] for i in range(0, len(flows), 2)]
    return flows[0]


def _flows(piece: Piece, n: int, bits: int) -> list[arb_mat]:
    terms = _TERMS * bits // BITS
    size = _size(piece, n, piece.start, piece.length, terms)
    parts = max(1, math.ceil(size / _ANGLE))
    length = piece.length / parts
    return [_flow(piece, n, piece.start + i * length, length, terms, bits) for i in range(parts)]


def _size(piece: Piece, n: int, start: arb, length: arb, terms: int) -> float:
    """Rough size of length |A|: any will do."""
    A = np.zeros((n, n))
    for i, j, entry in piece.entries:
        A[i, j] += sum(abs(float(c.mid())) for c in entry(start, length, terms))
    return float(length.mid()) * float(np.linalg.norm(A, 2))


def _flow(piece: Piece, n: int, start: arb, length: arb, terms: int, bits: int) -> arb_mat:
    A: list[arb_mat] = []
    for i, j, entry in piece.entries:
        for k, c in enumerate(entry(start, length, terms)):
            while len(A) <= k:
                A.append(arb_mat(n, n))
            A[k][i, j] += c * length
    norms = [
        sum((abs(A_k[i, j]).upper() ** 2 for i in range(n) for j in range(n)), arb(0)).sqrt() for A_k in A
    ]
    rough = [float(a.upper()) for a in norms]
    beyond, radius = piece.bound(start, length) if piece.bound else (arb(0), math.inf)
    best = math.inf
    rho = 2.0
    for R in _RHO:
        if 0.9 * radius > R:
            g = sum(a * R ** (k + 1) / (k + 1) for k, a in enumerate(rough))
            needed = (g - math.log(R - 1.0) + (0.5 * bits + 2.0) * math.log(2.0)) / math.log(R)
            best, rho = min((best, rho), (needed, R))
    count = min(max(1, math.ceil(best)), terms - 2)
    x = [arb_mat([[arb(i == j) for j in range(n)] for i in range(n)])]
    for k in range(count):
        total = A[0] * x[k]
        for j in range(1, min(k, len(A) - 1) + 1):
            total = total + A[j] * x[k - j]
        x.append(total * (arb(1) / (k + 1)))
    total = x[-1]
    for term in x[-2::-1]:
        total = total + term
    R = arb(rho)
    g = sum((a * R ** (k + 1) / (k + 1) for k, a in enumerate(norms)), arb(0))
    if radius < math.inf:  # coefficients beyond those at hand: |A_j| <= n B radius^-j
        g += n * beyond * length * R * (R / radius) ** len(A) / (1 - R / radius)
    tail = (g.exp() * R ** (-count) / (R - 1)).upper()
    ball = arb(0, tail)
    return arb_mat([[total[i, j] + ball for j in range(n)] for i in range(n)])


def multipliers(M: arb_mat) -> list[tuple[complex, float]]:
    """Midpoint and radius of a disk about each eigenvalue."""
    eigenvalues = acb_mat(M).eig(multiple=True)
    disks = []
    for value in eigenvalues:
        middle = complex(value.mid())
        disks.append((middle, float((value - type(value)(middle)).abs_upper())))
    return disks


def worst_ratio(
    values: np.ndarray, bounds: np.ndarray, exact: Sequence[tuple[complex, float]]
) -> tuple[float, float]:
    """Largest error over its bound, computed and exact multipliers being matched best; largest error."""
    centre = np.array([e[0] for e in exact])
    radius = np.array([e[1] for e in exact])
    # What the disks of the reference leave open counts for the package, and so do the last digits of complex.
    error = np.maximum(np.abs(values[:, None] - centre) - radius - 4e-16 * np.abs(centre), 0.0)
    ratio = error / np.maximum(bounds[:, None], 1e-300)
    for level in np.unique(ratio):
        rows, columns = linear_sum_assignment(ratio > level)
        if (ratio[rows, columns] <= level).all():
            return float(level), float(error[rows, columns].max())
    return math.inf, math.inf
