"""Arguments of public functions: numbers, lists and names, each read or refused before work starts."""

from __future__ import annotations

import difflib
import math
import operator
import os
from collections.abc import Callable, Collection, Hashable, Iterable, Iterator, Set, ValuesView
from pathlib import Path
from typing import Any, SupportsIndex, TypeVar

import numpy as np
from numpy.typing import NDArray

from lumped.errors import refuse, shown
from lumped.typing import FloatArray

Name = TypeVar("Name", str, int)
T = TypeVar("T")


def whole_number(
    field: str, value: object, low: int, high: int, action: str = "Choose a number in that range."
) -> int:
    """Return a whole number from ``low`` to ``high`` of any integer type, or refuse it."""
    try:
        if isinstance(value, bool) or not isinstance(value, SupportsIndex):
            raise TypeError
        number = operator.index(value)  # arrays have the method and refuse
        if low <= number <= high:
            return number
    except TypeError:
        pass
    raise refuse(field, shown(value), f"a whole number, {low} to {high}", action)


def real_number(
    field: str,
    value: object,
    low: float = -math.inf,
    high: float = math.inf,
    *,
    above: bool = False,
    unit: str = "",
    action: str = "Choose a number in that range.",
) -> float:
    """Return a finite number from ``low`` to ``high`` of any real type, or refuse it. Text is refused.

    With ``above`` the lower end itself is refused; ``unit`` is for the message.
    """
    array = _real(value)
    if array is None or array.ndim or not _inside(array, low, high, above):
        raise refuse(field, shown(value), _allowed(low, high, above, unit), action)
    return float(array)


def real_numbers(
    field: str,
    value: object,
    low: float = -math.inf,
    high: float = math.inf,
    *,
    above: bool = False,
    increasing: bool = False,
    unit: str = "",
    action: str = "Correct the list.",
) -> FloatArray:
    """Return one or more finite numbers as an array (n,), or refuse them. A single number is allowed.

    Arguments as of ``real_number``. With ``increasing`` each number must be larger than the previous number.
    """
    array = _real(value)
    if array is not None and array.ndim <= 1 and array.size:
        array = np.atleast_1d(array)
        if _inside(array, low, high, above) and not (increasing and (np.diff(array) <= 0.0).any()):
            return array
    allowed = (
        f"one or more {'increasing ' if increasing else ''}numbers, each {_allowed(low, high, above, unit)}"
    )
    raise refuse(field, shown(value), allowed, action)


def real_array(field: str, value: object, *, finite: bool = True) -> FloatArray:
    """Return an array of (finite) real numbers of any shape, or refuse it."""
    array = _real(value)
    if array is None or (finite and not np.isfinite(array).all()):
        raise refuse(
            field, shown(value), f"{'finite ' if finite else ''}numbers of any shape", "Give numbers."
        )
    return array


def nearest(name: str, known: Iterable[str]) -> str:
    """Return a question whether a similar name was meant; an empty text where no name is similar.

    Names that contain the given name as a word are similar: torque, pinion_torque.
    """
    names = list(known)
    parts = [one for one in names if name and name in one.split("_")]  # torque: pinion_torque, brake_torque
    close = parts or difflib.get_close_matches(name[:80], names, n=1, cutoff=0.5)
    return f"Did you mean {' or '.join(map(repr, close))}?" if close else ""


def one_of(field: str, value: object, names: Iterable[str], action: str = "Choose one of them.") -> str:
    """Return a name out of ``names``, or refuse it."""
    allowed_names = tuple(names)
    if not isinstance(value, str) or value not in allowed_names:
        near = nearest(str(value), allowed_names)
        raise refuse(field, shown(value), "one of " + ", ".join(allowed_names), near or action)
    return value


def some_of(
    field: str,
    values: Collection[Name],
    names: Iterable[Name],
    action: str = "Correct the name.",
    spelling: Callable[[object], object] = lambda value: value,
) -> tuple[Name, ...]:
    """Return a selection of names or numbers, or refuse it. A single text is refused.

    ``spelling`` turns another spelling of a name into the name.
    """
    allowed_names = tuple(names)
    single = (
        not isinstance(values, Iterable)
        or isinstance(values, (str, bytes))
        or getattr(values, "ndim", 1) == 0
    )
    chosen: list[Any] = []
    for value in [values] if single else map(spelling, values):
        if single or not isinstance(value, Hashable) or value not in allowed_names:
            raise refuse(field, shown(value), "a list out of " + ", ".join(map(str, allowed_names)), action)
        chosen.append(value)
    return tuple(chosen)


def of_type(field: str, value: object, kind: type[T], what: str) -> T:
    """Return an object of one type, or refuse it. ``what`` names the type, and the function that makes it."""
    if not isinstance(value, kind):
        is_prediction = isinstance(getattr(type(value), "cycle", None), property)
        if is_prediction and "run_up" not in what:
            raise refuse(field, f"a {type(value).__name__}", what, "Give its dataset: prediction.cycle.")
        raise refuse(field, shown(value), what, "Give one of these.")
    return value


def file_path(field: str, value: object) -> Path:
    """Return a path given as text or as a path, or refuse it."""
    if not isinstance(value, (str, os.PathLike)):
        raise refuse(field, shown(value), "a path", "Give the name of a file or folder.")
    return Path(value)


def _real(value: object) -> FloatArray | None:
    """Return a value as an array of real numbers; None where the value has anything else."""
    if isinstance(value, np.ndarray) and value.dtype == np.float64:  # laws are evaluated very often
        return np.asarray(value)
    try:
        array: NDArray[Any] = np.asarray(
            list(value) if isinstance(value, (Iterator, Set, ValuesView)) else value
        )
    except (TypeError, ValueError, OverflowError, MemoryError):
        return None
    return array.astype(np.float64, copy=False) if array.dtype.kind in "iuf" else None


def _inside(array: FloatArray, low: float, high: float, above: bool) -> bool:
    inside = np.isfinite(array) & (array <= high) & ((array > low) if above else (array >= low))
    return bool(inside.all())


def _allowed(low: float, high: float, above: bool, unit: str) -> str:
    if low == -math.inf:
        text = "finite" if high == math.inf else f"<= {high:g}"
    elif high == math.inf:
        text = f"{'>' if above else '>='} {low:g}"
    else:
        text = f"> {low:g} and <= {high:g}" if above else f"{low:g} to {high:g}"
    return f"{text} {unit}".rstrip()
