"""Closing a period: unknowns at its start for which nothing is left at its end.

Source: C. G. Broyden, A class of methods for solving nonlinear simultaneous equations, Math. Comp. 19 (1965)
577-593.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from lumped.typing import FloatArray

#: What a pass over the period gives beside what is left at its end.
Passed = TypeVar("Passed")


@dataclass(frozen=True, eq=False)
class Closed(Generic[Passed]):
    """The unknowns (n,) after which least was left, over their scale.

    Attributes
    ----------
    unknowns : (n,)
    left : largest entry of what is left, over its scale
    passed : what the pass from these unknowns gave beside it
    derivatives : (n, n) of what is left by the unknowns, both over their scales, corrected along the way
    """

    unknowns: FloatArray
    left: float
    passed: Passed
    derivatives: FloatArray


def close_period(
    over_period: Callable[[FloatArray], tuple[FloatArray, Passed]],
    unknowns: FloatArray,
    scale: FloatArray,
    derivatives: FloatArray,
    *,
    closed: float,
    most: int = 40,
    patience: int = 8,
) -> Closed[Passed]:
    """Close a period by Broyden's method; the caller judges whether what is left is small enough.

    Each step passes over the period once and corrects the derivatives along the way it went. The unknowns
    found do not depend on the derivatives to begin with.

    Parameters
    ----------
    over_period : unknowns (n,) -> what is left at the end (n,), over its scale, and anything else
    unknowns : (n,) to begin with
    scale : (n,) of the unknowns
    derivatives : (n, n) to begin with, of what is left by the unknowns, both over their scales
    closed : largest entry left that ends the steps
    most, patience : most steps, and most steps without less that is left
    """
    left, passed = over_period(unknowns)
    best = Closed(unknowns, float(np.abs(left).max()), passed, derivatives)
    age = 0
    for _ in range(most):
        if not (best.left > closed and age <= patience and np.isfinite(left).all()):
            break
        try:
            change = np.linalg.solve(derivatives, -left)
        except np.linalg.LinAlgError:
            break
        unknowns = unknowns + change * scale
        left, passed = over_period(unknowns)
        # Along this change the derivatives must explain all that is still left.
        derivatives = derivatives + np.outer(left, change) / (change @ change)
        age += 1
        if (largest := float(np.abs(left).max())) < best.left:
            best = Closed(unknowns, largest, passed, derivatives)
            age = 0
    return best
