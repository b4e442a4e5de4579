"""Polynomials on one step: values, first crossings, extremes; compiled."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from lumped.compiler import Compiler
from lumped.typing import FloatArray

F = TypeVar("F", bound=Callable[..., Any])

_COMPILE = Compiler(Path(__file__).parent.glob("*.py"))
_SAMPLES = 8
_MOST_BISECTIONS = 100
#: An extreme is flat: its value is good to the square of this power of a half.
_HALVINGS = 20


def compiled(function: F) -> F:
    """Compile; callers see the signature of the Python function."""
    return _COMPILE(function, nogil=True)


@compiled
def value(c: FloatArray, s: float) -> float:
    """Polynomial, lowest power first."""
    total = 0.0
    for j in range(c.size - 1, -1, -1):
        total = total * s + c[j]
    return total


@compiled
def slope(c: FloatArray, s: float) -> float:
    total = 0.0
    for j in range(c.size - 1, 0, -1):
        total = total * s + j * c[j]
    return total


@compiled
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


@compiled
def crossing(c: FloatArray, h: float, sign: float) -> float:
    """First s in (0, h] where the polynomial leaves the sign that it counts as having at 0; else 2 h."""
    rest, power = 0.0, h
    for j in range(1, c.size):
        rest += abs(c[j]) * power
        power *= h
    if sign * c[0] > rest:
        return 2.0 * h
    low, falling = 0.0, sign * c[1] < 0.0
    for k in range(1, _SAMPLES + 1):
        high = h * k / _SAMPLES
        down = sign * slope(c, high) < 0.0
        if sign * value(c, high) <= 0.0:
            return _root(c, low, high, sign)
        if falling and not down:  # it may have crossed twice between the samples
            a, b = low, high
            for _ in range(_MOST_BISECTIONS):
                middle = 0.5 * (a + b)
                if middle <= a or middle >= b:
                    break
                if sign * slope(c, middle) < 0.0:
                    a = middle
                else:
                    b = middle
                if sign * value(c, middle) <= 0.0:
                    return _root(c, low, middle, sign)
        low, falling = high, down
    return 2.0 * h


@compiled
def _root(c: FloatArray, low: float, high: float, sign: float) -> float:
    """Zero between low, where the sign holds or counts as holding, and high, where it does not."""
    s = 0.5 * (low + high)
    for _ in range(_MOST_BISECTIONS):
        f = sign * value(c, s)
        if f > 0.0:
            low = s
        else:
            high = s
        rate = sign * slope(c, s)
        new = s - f / rate if rate != 0.0 else low
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - s) <= 1e-16 * high or new in (low, high):
            return new
        s = new
    return s


@compiled
def extremes(c: FloatArray, h: float) -> tuple[float, float]:
    """Smallest and largest value on [0, h]."""
    low = high = c[0]
    before, rising = 0.0, c[1] > 0.0
    for k in range(1, _SAMPLES + 1):
        s = h * k / _SAMPLES
        now = slope(c, s) > 0.0
        y = value(c, s)
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
        before, rising = s, now
    return low, high
