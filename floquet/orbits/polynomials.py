"""Polynomials on one step: values, first crossings, extremes; compiled."""

from __future__ import annotations

from lumped.compiler import called, compiled
from lumped.typing import FloatArray

_SAMPLES = 8
_MOST_BISECTIONS = 100
#: Relative tolerance of a zero: one or two bits.
_ROOT = 4e-16
#: Halvings of the interval around an extreme. The error of the value is of second order in the last interval.
_HALVINGS = 20


@compiled(nogil=True)
def value(c: FloatArray, s: float) -> float:
    """Polynomial, lowest power first."""
    total = 0.0
    for j in range(c.size - 1, -1, -1):
        total = total * s + c[j]
    return total


@called
def slope(c: FloatArray, s: float) -> float:
    total = 0.0
    for j in range(c.size - 1, 0, -1):
        total = total * s + j * c[j]
    return total


@called
def value_and_slope(c: FloatArray, s: float) -> tuple[float, float]:
    total = 0.0
    rate = 0.0
    for j in range(c.size - 1, -1, -1):
        rate = rate * s + total
        total = total * s + c[j]
    return total, rate


@called
def shift(c: FloatArray, s: float, out: FloatArray) -> None:
    """Coefficients of c(s + x) in powers of x."""
    n = c.size
    for j in range(n):
        out[j] = c[j]
    if s == 0.0:
        return
    for i in range(n - 1):
        for j in range(n - 2, i - 1, -1):
            out[j] += s * out[j + 1]


@compiled(nogil=True)
def bounds(c: FloatArray, h: float) -> tuple[float, float]:
    """Lower and upper bound of a polynomial on [0, h].

    The bounds are the extremes of the quadratic part, widened by the size of the higher powers.
    """
    constant = c[0]
    linear = c[1]
    quadratic = c[2]
    rest = 0.0
    power = h * h * h
    for j in range(3, c.size):
        rest += abs(c[j]) * power
        power *= h
    end = constant + h * (linear + h * quadratic)
    low = min(constant, end)
    high = max(constant, end)
    if linear * (linear + 2.0 * quadratic * h) < 0.0:
        extreme = constant - 0.25 * linear * linear / quadratic
        low = min(low, extreme)
        high = max(high, extreme)
    return low - rest, high + rest


@compiled(nogil=True)
def crossing(c: FloatArray, h: float, sign: float) -> float:
    """First s in (0, h] at which a polynomial loses the sign; 2 h where the polynomial keeps the sign.

    ``sign`` is the sign at 0. A polynomial that vanishes at 0 counts as having this sign there.
    """
    least, most = bounds(c, h)
    if (least if sign > 0.0 else -most) > 0.0:
        return 2.0 * h
    low = 0.0
    before = sign * c[0]
    falling = sign * c[1] < 0.0
    for k in range(1, _SAMPLES + 1):
        high = h * k / _SAMPLES
        y, rate = value_and_slope(c, high)
        after = sign * y
        still_falling = sign * rate < 0.0
        if after <= 0.0:
            return _root(c, low, high, sign, before, after)
        if falling and not still_falling:  # the polynomial may have crossed zero twice between the samples
            one = low
            two = high
            for _ in range(_MOST_BISECTIONS):
                middle = 0.5 * (one + two)
                if middle <= one or middle >= two:
                    break
                y, rate = value_and_slope(c, middle)
                if sign * rate < 0.0:
                    one = middle
                else:
                    two = middle
                if sign * y <= 0.0:
                    return _root(c, low, middle, sign, before, sign * y)
        low = high
        before = after
        falling = still_falling
    return 2.0 * h


@called
def _root(c: FloatArray, low: float, high: float, sign: float, above: float, below: float) -> float:
    """Zero of a polynomial between low and high, by Newton's method with bisection.

    ``above`` and ``below`` are the values at low and high times the sign: the polynomial has the sign at low,
    or counts as having the sign, and has lost the sign at high. The first step is a secant step.
    """
    s = low + (high - low) * above / (above - below) if above > 0.0 else 0.5 * (low + high)
    for _ in range(_MOST_BISECTIONS):
        y, rate = value_and_slope(c, s)
        if sign * y > 0.0:
            low = s
        else:
            high = s
        new = s - y / rate if rate != 0.0 else low
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - s) <= _ROOT * high or new in (low, high):
            return new
        s = new
    return s


@called
def extremes(c: FloatArray, h: float, low: float, high: float) -> tuple[float, float]:
    """Smallest and largest value: ``low`` and ``high``, widened by the values of a polynomial on [0, h]."""
    least, most = bounds(c, h)
    if least >= low and most <= high:
        return low, high
    low = min(low, c[0])
    high = max(high, c[0])
    before = 0.0
    rising = c[1] > 0.0
    for k in range(1, _SAMPLES + 1):
        s = h * k / _SAMPLES
        y, rate = value_and_slope(c, s)
        still_rising = rate > 0.0
        low = min(low, y)
        high = max(high, y)
        if still_rising != rising:
            one = before
            two = s
            for _ in range(_HALVINGS):
                middle = 0.5 * (one + two)
                if (slope(c, middle) > 0.0) == rising:
                    one = middle
                else:
                    two = middle
            extreme = value(c, 0.5 * (one + two))
            low = min(low, extreme)
            high = max(high, extreme)
        before = s
        rising = still_rising
    return low, high
