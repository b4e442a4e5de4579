"""Callables A(t) of the user: what they return is checked before work starts, and a mistake is named.

A callable takes one time, t -> (n, n), or with ``vectorized`` an array of times, (k,) -> (k, n, n).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from lumped.errors import SpurcheckError, refuse
from lumped.typing import FloatArray

#: Part of the largest entry by which the matrix at one time may depend on how many times are asked for:
#: rounding of sums in another order.
_SAME_VALUE = 1e-9
_VECTORIZED = "A with vectorized=True"


def dimension_of(A: Callable[..., npt.ArrayLike], vectorized: bool, low: float, high: float) -> int:
    """Return n of a callable A, evaluated strictly inside an interval of time [s]; refuse another form.

    Raises
    ------
    ParameterError
        A returns no square matrices, takes the times in another form than ``vectorized`` says, returns the
        times last, or mixes the times.
    """
    times = low + (high - low) * np.array([0.13, 0.37, 0.5, 0.71, 0.83])
    asked = times[1:4]
    try:
        values = _values(A, asked, vectorized)
    except SpurcheckError:
        raise
    except Exception as error:
        _refuse_other_convention(A, times, vectorized, f"{type(error).__name__}: {error}", error)
        raise
    if vectorized and values.shape == (3, 3, 3):  # times first or last: five times tell
        asked = times
        values = _values(A, asked, vectorized)
    n = values.shape[1] if values.ndim == 3 else 0
    if values.shape != (asked.size, n, n) or not n:
        shape = values.shape if vectorized else values.shape[1:]
        _refuse_other_convention(A, times, vectorized, f"shape {shape}")
        if not vectorized:
            raise refuse("A", f"shape {shape}", "(n, n)", "Check the shape that the callable returns.")
        turned = values.ndim == 3 and values.shape == (n, n, asked.size)
        action = "Put the times first: return numpy.moveaxis(matrices, -1, 0)."
        if not turned:
            action = "Check the shape that the callable returns."
        raise refuse(_VECTORIZED, f"shape {shape}", f"(k, n, n) for k = {asked.size} times", action)
    if vectorized:
        _refuse_mixed_times(A, asked, values)
    return n


def _values(A: Callable[..., npt.ArrayLike], times: FloatArray, vectorized: bool) -> FloatArray:
    """Values of A at times, as `as_matrices` reads them."""
    return as_matrices(A(times) if vectorized else [A(float(t)) for t in times])


def as_matrices(values: Any) -> FloatArray:
    """Return what a callable returned as an array of real numbers, or refuse it."""
    try:
        result = np.asarray(values)
    except ValueError:
        result = np.empty(0, dtype=object)
    if result.dtype.kind not in "fiu":  # complex numbers and text would become numbers without a word
        shapes = result.dtype.kind == "O"
        kind = "numbers of different shapes" if shapes else f"values of type {result.dtype}"
        raise refuse("A", kind, "real numbers", "Return real numbers of one shape for every time.")
    return result.astype(float)


def _refuse_other_convention(
    A: Callable[..., npt.ArrayLike],
    times: FloatArray,
    vectorized: bool,
    fault: str,
    cause: Exception | None = None,
) -> None:
    """Refuse an A that works if the times are given in the other form than ``vectorized`` says."""
    try:
        values = _values(A, times, not vectorized)
    except Exception:  # noqa: BLE001  (any error: the other form is no better)
        return
    if values.ndim != 3 or len(values) != times.size or values.shape[1] != values.shape[2]:
        return
    if vectorized:
        action = "A takes one time: leave vectorized out, or let A take an array of times."
    else:
        action = "A takes an array of times: set vectorized=True."
    raise refuse("vectorized", f"{vectorized} ({fault})", f"{not vectorized} for this A", action) from cause


def _refuse_mixed_times(A: Callable[..., npt.ArrayLike], times: FloatArray, values: FloatArray) -> None:
    """Refuse an A whose matrix at one time depends on the other times that are asked for."""
    middle = times.size // 2  # neither the first nor the last of them
    alone = as_matrices(A(times[middle : middle + 1]))
    if alone.shape != (1, *values.shape[1:]):
        allowed = f"(1, {values.shape[1]}, {values.shape[2]}) for one time"
        raise refuse(_VECTORIZED, f"shape {alone.shape}", allowed, "Keep the axis of the times.")
    size = np.abs(values).max()
    with np.errstate(invalid="ignore"):
        differ = np.abs(alone[0] - values[middle]).max() > _SAME_VALUE * size
    if differ:
        value = f"another matrix at t = {times[middle]:g} s alone than among {times.size} times"
        action = "Compute each matrix of its own time alone."
        raise refuse(_VECTORIZED, value, "one matrix for each time, whatever the others", action)
