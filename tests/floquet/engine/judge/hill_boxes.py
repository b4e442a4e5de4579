"""Proven verdicts against published rigorous boxes around the stability boundaries of Hill's equation.

    python tests/floquet/engine/judge/hill_boxes.py mathieu_eps1.txt --eps 1 [--lines 40] [--points 400]

The data are not part of this repository: fetch ``enclosures/*.txt`` of github.com/aaroncapd/capdmathieu.
A row "a_low a_high b_low b_high" is a box in which x'' + (a + b (cos t + eps cos 2t)) x = 0, T = 2 pi, may
have an off-diagonal entry of the monodromy matrix that is zero; elsewhere in the range of the file it has
none. The potential is even, so on a boundary of stability one of both entries is zero: each boundary is in a
box. Along lines of constant b every change between trace inside and outside [-2, 2] that is proven at both
of its ends must meet a box; one that does not is a contradiction.
"""

import argparse
import math
from itertools import pairwise

import numpy as np

from floquet import FourierSeries, KnownMatrix, PeriodicSystem, monodromy

_PRINTED = 5e-7  # six decimals


def sides(a: np.ndarray, b: float, eps: float) -> np.ndarray:
    """1 where |trace| < 2 is proven, -1 where |trace| > 2 is, else 0."""
    found = np.zeros(a.size, dtype=int)
    for i, value in enumerate(a):
        potential = FourierSeries(2.0 * math.pi, float(value), [b, b * eps])
        result = monodromy(PeriodicSystem(KnownMatrix([[0.0, 1.0], [-potential, 0.0]]), 2.0 * math.pi), 1e-8)
        trace = abs(float(np.trace(result.matrix)))
        error = 2.0 * result.matrix_error  # the trace does not depend on the scaling
        found[i] = 1 if trace + error < 2.0 else -1 if trace - error > 2.0 else 0
    return found


def contradictions(boxes: np.ndarray, eps: float, lines: int, points: int) -> tuple[int, int]:
    """Changes that were found, and how many of them meet no box."""
    low, high = boxes[:, 0].min(), boxes[:, 1].max()
    changes = contrary = 0
    span = boxes[:, 2].min(), boxes[:, 3].max()
    for b in np.linspace(*span, lines + 2)[1:-1]:
        here = boxes[(boxes[:, 2] - _PRINTED <= b) & (b <= boxes[:, 3] + _PRINTED)]
        a = np.linspace(low, high, points)
        side = sides(a, float(b), eps)
        known = np.flatnonzero(side)
        for i, j in pairwise(known):
            if side[i] != side[j]:
                changes += 1
                meets = (here[:, 0] - _PRINTED <= a[j]) & (a[i] <= here[:, 1] + _PRINTED)
                contrary += int(not meets.any())
    return changes, contrary


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("file")
    parser.add_argument("--eps", type=float, required=True)
    parser.add_argument("--lines", type=int, default=40)
    parser.add_argument("--points", type=int, default=400)
    given = parser.parse_args()
    boxes = np.loadtxt(given.file, ndmin=2)[:, :4]
    changes, contrary = contradictions(boxes, given.eps, given.lines, given.points)
    print(f"{given.file}: {len(boxes)} boxes, {changes} boundaries met, {contrary} contradictions")


if __name__ == "__main__":
    main()
