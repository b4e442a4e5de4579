"""One step of the search for a root in every bracket: the compiled part of ``roots_in_brackets`` in
``lumped/root_in_bracket.py``.

Source: T. R. Chandrupatla, Advances in Engineering Software 28 (1997) 145.
"""

from __future__ import annotations

from typing import NamedTuple

from lumped.compiler import compiled, inlined
from lumped.typing import FloatArray, IntArray


class Brackets(NamedTuple):
    """Brackets (n,): a function has opposite signs at ``last`` and ``beyond``.

    Attributes
    ----------
    last, f_last : (n,) argument of the last value, and this value
    beyond, f_beyond : (n,) end of the bracket across the root, and the value there
    before, f_before : (n,) the point that was ``last`` or ``beyond`` before, and is an end no more
    root : (n,) the root, where it is known
    """

    last: FloatArray
    f_last: FloatArray
    beyond: FloatArray
    f_beyond: FloatArray
    before: FloatArray
    f_before: FloatArray
    root: FloatArray


@inlined
def take_value(at: Brackets, i: int, argument: float, value: float) -> None:
    """Shorten the bracket i to the part in which a value leaves the change of the sign."""
    if (value < 0.0) == (at.f_last[i] < 0.0):
        at.before[i] = at.last[i]
        at.f_before[i] = at.f_last[i]
    else:
        at.before[i] = at.beyond[i]
        at.f_before[i] = at.f_beyond[i]
        at.beyond[i] = at.last[i]
        at.f_beyond[i] = at.f_last[i]
    at.last[i] = argument
    at.f_last[i] = value


@inlined
def inverse_parabola(at: Brackets, i: int) -> float:
    """Share of the way from ``last`` to ``beyond`` where the inverse parabola through the three points of a
    bracket has its root; 0.5, the middle, where that is not safe.
    """
    last, beyond, before = at.last[i], at.beyond[i], at.before[i]
    f_last, f_beyond, f_before = at.f_last[i], at.f_beyond[i], at.f_before[i]
    place = (last - beyond) / (before - beyond)
    value = (f_last - f_beyond) / (f_before - f_beyond)
    if not (value * value < place and (1.0 - value) * (1.0 - value) < 1.0 - place):
        return 0.5
    secant = f_last / (f_beyond - f_last) * f_before / (f_beyond - f_before)
    bend = (before - last) / (beyond - last) * f_last / (f_before - f_last)
    share: float = secant + bend * f_beyond / (f_before - f_beyond)
    return share


@compiled
def next_arguments(
    at: Brackets, left: IntArray, values: FloatArray, xtol: float, rtol: float, arguments: FloatArray
) -> int:
    """Shorten brackets by values of the function, and return the number k of brackets that are left.

    Parameters
    ----------
    at : the brackets, shortened; ``root`` is written where the root is known
    left : (n,) indices of the brackets without a known root: on entry those of ``values``, on return the
        first k
    values : of the function at the first entries of ``arguments``
    xtol, rtol : a root is known to xtol + rtol |x|
    arguments : (n,) on return the first k are the arguments of the next values
    """
    count = 0
    for j in range(values.size):
        i = left[j]
        take_value(at, i, arguments[j], values[j])
        best = at.last[i] if abs(at.f_last[i]) < abs(at.f_beyond[i]) else at.beyond[i]
        width = abs(at.beyond[i] - at.last[i])
        tolerance = 0.5 * (xtol + rtol * abs(best))
        if width < 2.0 * tolerance or at.f_last[i] == 0.0 or at.f_beyond[i] == 0.0:
            at.root[i] = best
            continue
        least = tolerance / width
        share = min(max(inverse_parabola(at, i), least), 1.0 - least)
        left[count] = i
        arguments[count] = at.last[i] + share * (at.beyond[i] - at.last[i])
        count += 1
    return count
