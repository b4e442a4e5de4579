"""Two steps at once: which two changes, straight and added, leave least of the residuals.

The effect of a change is taken from its trial alone. A fixed value is a point d = r - r0. A free parameter is
a straight line between neighbouring trials, s + a e with 0 <= a <= 1; a fixed value has e = 0. Of two changes

    |r0 + s_i + a e_i + s_j + b e_j|^2

is a quadratic form in (a, b) whose coefficients are products of two vectors, so that all pairs are few
products of matrices. Its minimum within both limits is found one coordinate after the other.

Sources: docs/how_to/check_your_model.md, "Explanations".
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from lumped.typing import FloatArray
from validation.check.steps import Step

#: First changes whose pairs are in memory at the same time.
_BLOCK = 64
#: Rounds in which both coordinates are found, one after the other.
_ROUNDS = 3
#: Most pairs with the same change, so that not one change takes them all.
_EACH = 4


class Effect(NamedTuple):
    """What a change does to the residuals, alone.

    Attributes
    ----------
    step : the change; the coordinate of a free parameter is that of ``start``
    start : change of the residuals (m,)
    along : further change (m,) up to the next trial of a free parameter; 0 of a fixed value
    reach : distance of this trial on the scale of the search
    """

    step: Step
    start: FloatArray
    along: FloatArray
    reach: float = 0.0

    def at(self, share: float) -> Step:
        """Return the step at a share of the way to the next trial."""
        return self.step._replace(coordinate=self.step.coordinate + share * self.reach)


def promising_pairs(residual: FloatArray, effects: Sequence[Effect], most: int) -> list[tuple[Step, Step]]:
    """Return the two steps that leave least of a residual (m,), the best first.

    What is left counts with the prices of both steps. No two pairs have the same keys.
    """
    if len(effects) < 2:
        return []
    starts = np.stack([one.start for one in effects])
    along = np.stack([one.along for one in effects])
    prices = np.array([one.step.price for one in effects])
    names = np.unique([one.step.cause.name for one in effects], return_inverse=True)[1]
    squares = (along**2).sum(axis=1)
    slopes = along @ residual + (along * starts).sum(axis=1)
    sizes = (starts**2).sum(axis=1) + 2.0 * starts @ residual
    found: list[tuple[float, int, int, float, float]] = []
    for low in range(0, len(effects), _BLOCK):
        of = slice(low, min(low + _BLOCK, len(effects)))
        both = along[of] @ along.T
        first = slopes[of, None] + along[of] @ starts.T
        second = slopes[None, :] + starts[of] @ along.T
        a = b = np.zeros_like(both)
        for _ in range(_ROUNDS):
            a = _least(first + both * b, squares[of, None])
            b = _least(second + both * a, squares[None, :])
        left = residual @ residual + sizes[of, None] + sizes[None, :] + 2.0 * starts[of] @ starts.T
        left = left + a * (a * squares[of, None] + 2.0 * first) + b * (b * squares + 2.0 * second)
        left = np.sqrt(np.maximum(left + 2.0 * a * b * both, 0.0)) * np.outer(prices[of], prices)
        left[names[of, None] == names[None, :]] = np.inf
        left[np.arange(low, of.stop)[:, None] >= np.arange(len(effects))] = np.inf
        rows, columns = np.unravel_index(np.argsort(left, axis=None)[: 50 * most], left.shape)
        found += [(left[i, j], low + i, j, a[i, j], b[i, j]) for i, j in zip(rows, columns, strict=True)]
    return _distinct(effects, sorted(found), most)


def _least(slope: FloatArray, square: FloatArray) -> FloatArray:
    """Place in [0, 1] of the minimum of square x^2 + 2 slope x; 0 where there is no line."""
    has = np.broadcast_to(square > 0.0, slope.shape)
    place = np.divide(-slope, square, out=np.zeros_like(slope), where=has)
    return np.clip(place, 0.0, 1.0)


def _distinct(
    effects: Sequence[Effect], found: Sequence[tuple[float, int, int, float, float]], most: int
) -> list[tuple[Step, Step]]:
    """The first pairs without those that repeat keys, or one change too often."""
    chosen: list[tuple[Step, Step]] = []
    seen: set[frozenset[tuple[str, str]]] = set()
    count: dict[tuple[str, str], int] = {}
    for left, i, j, a, b in found:
        one, other = effects[i].at(a), effects[j].at(b)
        keys = frozenset((one.key, other.key))
        often = max(count.get(key, 0) for key in keys) >= _EACH
        if keys in seen or often or not np.isfinite(left):
            continue
        seen.add(keys)
        for key in keys:
            count[key] = count.get(key, 0) + 1
        chosen.append((one, other))
        if len(chosen) == most:
            break
    return chosen
