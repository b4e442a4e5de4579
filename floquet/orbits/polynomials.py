"""Polynomials on one step: values, first crossings, extremes; compiled."""

from __future__ import annotations

from lumped.compiler import called, compiled
from lumped.typing import FloatArray

_SAMPLES = 8
_MOST_BISECTIONS = 100
#: Of a zero, relative: a bit or two.
_ROOT = 4e-16
#: An extreme is flat: its value is good to the square of this power of a half.
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
    """Bounds on [0, h]: those of the quadratic part, less and more the size of the rest."""
    rest = 0.0
    power = h * h * h
    for j in range(3, c.size):
        rest += abs(c[j]) * power
        power *= h
    end = c[0] + h * (c[1] + h * c[2])
    low, high = min(c[0], end), max(c[0], end)
    if c[1] * (c[1] + 2.0 * c[2] * h) < 0.0:
        turn = c[0] - 0.25 * c[1] * c[1] / c[2]
        low, high = min(low, turn), max(high, turn)
    return low - rest, high + rest


@compiled(nogil=True)
def crossing(c: FloatArray, h: float, sign: float) -> float:
    """First s in (0, h] where the polynomial leaves the sign that it counts as having at 0; else 2 h."""
    least, most = bounds(c, h)
    if (least if sign > 0.0 else -most) > 0.0:
        return 2.0 * h
    low = 0.0
    before = sign * c[0]
    falling = sign * c[1] < 0.0
    for k in range(1, _SAMPLES + 1):
        high = h * k / _SAMPLES
        y, rate = value_and_slope(c, high)
        now = sign * y
        down = sign * rate < 0.0
        if now <= 0.0:
            return _root(c, low, high, sign, before, now)
        if falling and not down:  # it may have crossed twice between the samples
            a, b = low, high
            for _ in range(_MOST_BISECTIONS):
                middle = 0.5 * (a + b)
                if middle <= a or middle >= b:
                    break
                y, rate = value_and_slope(c, middle)
                if sign * rate < 0.0:
                    a = middle
                else:
                    b = middle
                if sign * y <= 0.0:
                    return _root(c, low, middle, sign, before, sign * y)
        low = high
        before = now
        falling = down
    return 2.0 * h


@called
def _root(c: FloatArray, low: float, high: float, sign: float, above: float, below: float) -> float:
    """Zero between low, where the sign holds or counts as holding, and high, where it does not.

    Values there, times the sign, are above and below; the first step is that of the secant.
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
    """The given smallest and largest value, or those on [0, h] where they are beyond."""
    least, most = bounds(c, h)
    if least >= low and most <= high:
        return low, high
    low, high = min(low, c[0]), max(high, c[0])
    before = 0.0
    rising = c[1] > 0.0
    for k in range(1, _SAMPLES + 1):
        s = h * k / _SAMPLES
        y, rate = value_and_slope(c, s)
        now = rate > 0.0
        low, high = min(low, y), max(high, y)
        if now != rising:
            a, b = before, s
            for _ in range(_HALVINGS):
                middle = 0.5 * (a + b)
                if (slope(c, middle) > 0.0) == rising:
                    a = middle
                else:
                    b = middle
            y = value(c, 0.5 * (a + b))
            low, high = min(low, y), max(high, y)
        before = s
        rising = now
    return low, high
