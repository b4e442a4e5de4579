"""The root of a function between two arguments where the function has opposite signs; of many brackets at
once where the function computes arrays.

``scipy.optimize.brentq`` computes the same root bit by bit, ``tests/lumped/test_root_in_bracket.py`` compares
both. Geometry needs a root for each pair that is loaded, and ``scipy.optimize`` takes longer to import than
the commands ``presets`` and ``init`` take to run.

Sources: R. P. Brent, Algorithms for Minimization without Derivatives, 1973, chapter 4; many brackets: T. R.
Chandrupatla, Advances in Engineering Software 28 (1997) 145.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from lumped.typing import FloatArray

#: Smallest useful relative tolerance: four roundings.
ROUNDING = 4.0 * 2.0**-52
_MOST_STEPS = 100


def root_in_bracket(
    function: Callable[[float], float],
    low: float,
    high: float,
    *,
    xtol: float = 2e-12,
    rtol: float = ROUNDING,
) -> float:
    """Return x between ``low`` and ``high`` with function(x) = 0, to xtol + rtol |x|.

    Each step interpolates between the last two or three arguments where that shortens the bracket fast, and
    halves the bracket elsewhere.

    Raises ValueError where the function has the same sign at both ends or is not a number, and RuntimeError
    where a hundred steps do not suffice.

    >>> root_in_bracket(lambda x: x * x - 2.0, 0.0, 2.0)
    1.4142135623731364
    """

    def value(x: float) -> float:
        result = float(function(x))
        if math.isnan(result):
            raise ValueError(f"The function value at x={x} is NaN; solver cannot continue.")
        return result

    before, now = float(low), float(high)
    f_before, f_now = value(before), value(now)
    if f_before == 0.0:
        return before
    if f_now == 0.0:
        return now
    if (f_before < 0.0) == (f_now < 0.0):
        raise ValueError("f(a) and f(b) must have different signs")
    beyond = f_beyond = step_before = step = 0.0  # ``beyond``: the end of the bracket across the root
    for _ in range(_MOST_STEPS):
        if f_before != 0.0 and f_now != 0.0 and (f_before < 0.0) != (f_now < 0.0):
            beyond, f_beyond = before, f_before
            step_before = step = now - before
        if abs(f_beyond) < abs(f_now):
            before, now, beyond = now, beyond, now
            f_before, f_now, f_beyond = f_now, f_beyond, f_now
        tolerance = (xtol + rtol * abs(now)) / 2.0
        half = (beyond - now) / 2.0
        if f_now == 0.0 or abs(half) < tolerance:
            return now
        trial = math.inf
        if abs(step_before) > tolerance and abs(f_now) < abs(f_before):
            trial = _interpolated(before, f_before, now, f_now, beyond, f_beyond)
        if 2.0 * abs(trial) < min(abs(step_before), 3.0 * abs(half) - tolerance):
            step_before, step = step, trial
        else:
            step_before = step = half
        before, f_before = now, f_now
        now += step if abs(step) > tolerance else math.copysign(tolerance, half)
        f_now = value(now)
    raise RuntimeError(f"Failed to converge after {_MOST_STEPS} iterations, value is {now}.")


def roots_in_brackets(
    function: Callable[[FloatArray], FloatArray], low: FloatArray, high: FloatArray, *, xtol: float
) -> FloatArray:
    """Return the roots (n,) of a function (k,) -> (k,), one in each bracket, to xtol + ROUNDING |x|.

    ``low`` and ``high`` (n,) are the ends of the brackets, where the function has opposite signs. All
    brackets are shortened together: the function is called some ten times, however many brackets there are.
    A step leads to the root of the inverse parabola through the last three points where that is safe, and
    halves the bracket elsewhere.

    Raises ValueError where the function has the same sign at both ends or is not a number, and RuntimeError
    where a hundred steps do not suffice.

    >>> roots_in_brackets(lambda x: x * x - 2.0, np.array([0.0, -2.0]), np.array([2.0, 0.0]), xtol=1e-15)
    array([ 1.41421356, -1.41421356])
    """
    arguments = np.array(low, dtype=np.float64)
    if not arguments.size:
        return arguments
    from lumped.bracket_steps import Brackets, next_arguments  # geometry needs no compiled code

    beyond = np.array(high, dtype=np.float64)
    values, f_beyond = np.split(function(np.concatenate([arguments, beyond])), 2)
    if not np.all((values <= 0.0) & (f_beyond >= 0.0) | (values >= 0.0) & (f_beyond <= 0.0)):
        raise ValueError("A function needs opposite signs at the ends of a bracket.")
    ends = (arguments.copy(), values.copy(), beyond, f_beyond.copy())
    brackets = Brackets(*ends, *np.zeros((3, arguments.size)))
    left = np.arange(arguments.size)  # the first ones: brackets whose root is not known yet
    for _ in range(_MOST_STEPS):
        count = next_arguments(brackets, left, values, xtol, ROUNDING, arguments)
        if count == 0:
            return brackets.root
        values = np.ascontiguousarray(function(arguments[:count]))
        if np.isnan(values).any():
            raise ValueError("The function value in a bracket is NaN; the solver cannot continue.")
    raise RuntimeError(f"Failed to converge after {_MOST_STEPS} iterations, value is {arguments[0]}.")


def _interpolated(
    before: float, f_before: float, now: float, f_now: float, beyond: float, f_beyond: float
) -> float:
    """Return the step to the root of the secant, or of the inverse parabola through all points."""
    if before == beyond:
        return -f_now * (now - before) / (f_now - f_before)
    slope_before = (f_before - f_now) / (before - now)
    slope_beyond = (f_beyond - f_now) / (beyond - now)
    difference = slope_beyond * slope_before * (f_beyond - f_before)
    if difference == 0.0:  # of underflow: the next step halves the bracket
        return math.inf
    return -f_now * (f_beyond * slope_beyond - f_before * slope_before) / difference
