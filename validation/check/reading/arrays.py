"""Arrays by name become a table: mappings, structures of MATLAB and Simulink, data frames."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lumped.errors import refuse, shown
from validation.check.curves import STATICS
from validation.check.quantities import PAIR_LABELS, QUANTITIES
from validation.check.reading.attributes import operating_point, text_of
from validation.check.reading.meaning import abscissa_of, understood, value_over_speed
from validation.check.reading.places_of_pairs import heading_of_place
from validation.check.reading.table import MOST_COLUMNS, Column, Table, listed, numbers_of

if TYPE_CHECKING:
    import pandas as pd

#: Deepest nesting of mappings.
_DEEPEST = 8
#: Sections of a file of results that are about its arrays.
_UNITS = "units."
_ATTRIBUTES = "attributes."
_ABOUT = ("units.", "long_names.", "dimensions.", "attributes.")
#: Fields of a Simulink "Structure with time" beside the values of a signal.
_ABOUT_SIGNALS = (
    "label", "blockName", "dimensions", "title", "plotStyle", "inReport", "valueDimensions",
)  # fmt: skip
_FACTS = (*STATICS, "pinion_speed", "pinion_torque", "recurrence", "role", "name")


class _Named(NamedTuple):
    """Value of a mapping with its path, and the unit that stands beside it."""

    path: str
    value: Any
    unit: str | None


def table_of_mapping(source: Mapping[Any, Any], name: str, remarks: tuple[str, ...] = ()) -> Table:
    """Make a table of a mapping from names to arrays; a mapping inside it is a group.

    Numbers and texts become stated values. An array (k, n) or (n, k) with k samples and n columns must be a
    quantity of tooth pairs: column 0 is pair A.
    """
    flat = list(_without_structures(_flat(source)))
    if len(flat) > MOST_COLUMNS:
        raise refuse("theirs", f"{len(flat)} arrays", f"<= {MOST_COLUMNS}", "Give the arrays to compare.")
    units = {one.path.removeprefix(_UNITS): text_of(one.value) for one in flat if one.path.startswith(_UNITS)}
    attributes = {
        one.path.removeprefix(_ATTRIBUTES): one.value for one in flat if one.path.startswith(_ATTRIBUTES)
    }
    flat = [one for one in flat if not one.path.startswith(_ABOUT)]
    one_speed = not any(one.path == "speed" for one in flat)
    stated: dict[str, Any] = operating_point(attributes, one_speed=one_speed)
    arrays: list[tuple[str, NDArray[Any], str | None]] = []
    unused = []
    headings = _short([one.path for one in flat])
    for one, heading in zip(flat, headings, strict=True):
        unit = one.unit if one.unit is not None else units.get(one.path)
        array = numbers_of(one.value)
        if _is_fact(heading) or (array is not None and array.size == 1):
            stated[heading if unit is None else f"{heading} [{unit}]"] = one.value
        elif array is None:
            if _wanted(heading):
                raise _no_numbers(heading, one.value)
            unused.append(heading)
        else:
            arrays.append((heading, array, unit))
    samples = _samples(arrays)
    columns: list[Column] = []
    for heading, array, unit in arrays:
        columns += _columns(heading, array, unit, samples)
    if unused:
        remarks = (*remarks, f"Without numbers and not used: {listed(unused)}.")
    return Table(name, tuple(columns), stated, remarks=remarks)


def _is_fact(heading: str) -> bool:
    plain = heading.partition("[")[0].strip().replace(" ", "_")
    return plain in _FACTS or plain.lower() in _FACTS[-5:]


def _wanted(heading: str) -> bool:
    """Whether a heading is understood."""
    return understood(heading) is not None or abscissa_of(heading) is not None


def _no_numbers(heading: str, value: Any) -> Exception:
    kind = type(value).__name__
    action = "Give an array of numbers: numpy.asarray(values, dtype=float)."
    return refuse(shown(heading), f"{kind} {shown(value)}", "an array of numbers", action)


def _flat(source: Mapping[Any, Any], path: str = "", depth: int = 0) -> Iterator[_Named]:
    """Entries of a mapping and of the mappings inside it."""
    if depth > _DEEPEST:
        raise refuse("theirs", "mappings inside mappings", f"at most {_DEEPEST} levels", "Flatten them.")
    for key, value in source.items():
        if not isinstance(key, str):
            raise refuse("theirs", f"the name {shown(key)}", "names that are text", "Rename the array.")
        name = f"{path}.{key}" if path else key
        if isinstance(value, Mapping):
            yield from _flat(value, name, depth + 1)
            continue
        unit = getattr(value, "attrs", {}).get("units") if hasattr(value, "attrs") else None
        if hasattr(value, "magnitude") and hasattr(value, "units"):  # a quantity of pint
            unit, value = f"{value.units:~}", value.magnitude
        yield _Named(name, value, str(unit) if unit is not None else None)


def _without_structures(flat: Iterator[_Named]) -> Iterator[_Named]:
    """Entries with the signals of Simulink and time series under the names that they have there."""
    entries = {one.path: one for one in flat}
    for path, one in entries.items():
        owner, _, last = path.rpartition(".")
        values = entries.get(f"{owner}.values")
        if (
            last in ("label", "blockName", "dimensions", "title", "plotStyle", "inReport", "valueDimensions")
            and values
        ):
            continue
        if last == "values" and (title := _title(entries, owner)):
            yield from _signals(title, one.value)
        elif last == "Data" and f"{owner}.Time" in entries:
            yield _Named(owner, one.value, one.unit)
        elif last == "Time" and f"{owner}.Data" in entries:
            yield _Named(f"{owner}.time", one.value, one.unit)
        elif last in ("Name", "TimeInfo", "DataInfo") and f"{owner}.Data" in entries:
            continue
        else:
            yield one


def _title(entries: Mapping[str, _Named], owner: str) -> str:
    """Name of a signal of Simulink: its label, else the last part of the name of its block."""
    for key in ("label", "blockName"):
        if (found := entries.get(f"{owner}.{key}")) is not None:
            text = np.asarray(found.value).ravel()
            if text.dtype.kind in "SU" and text.size and (name := str(text[0]).strip()):
                return name.rpartition("/")[2]
    return ""


def _signals(title: str, values: Any) -> Iterator[_Named]:
    """Columns of a signal; a label such as "x_p, y_p" names its columns."""
    array = np.squeeze(np.asarray(values))
    names = [name.strip() for name in title.split(",")]
    if array.ndim == 2 and len(names) == array.shape[1]:
        for name, column in zip(names, array.T, strict=True):
            yield _Named(name, column, None)
    else:
        yield _Named(title, values, None)


def _short(paths: list[str]) -> list[str]:
    """Longest ends of paths that are understood; a path that is not understood is unchanged."""
    result = []
    for path in paths:
        parts = path.split(".")
        ends = [" ".join(parts[start:]) for start in range(len(parts))]
        known = [end for end in ends if _wanted(end) or _is_fact(end) or value_over_speed(end) is not None]
        result.append(known[0] if known else path)
    return result


def _samples(arrays: list[tuple[str, NDArray[Any], str | None]]) -> int:
    """Number of samples: of the first abscissa, else of the longest vector."""
    for heading, array, _ in arrays:
        if abscissa_of(heading) is not None and max(array.shape, default=0) == array.size:
            return array.size
    return max((max(array.shape, default=0) for _, array, _ in arrays), default=0)


def _columns(heading: str, array: NDArray[Any], unit: str | None, samples: int) -> list[Column]:
    """Columns of an array: one of a vector, one for each tooth pair of a matrix."""
    if max(array.shape, default=0) == array.size:
        return [Column(heading, array.ravel(), unit)]
    known = understood(heading)
    name = heading.strip()
    of_pair = name in QUANTITIES and QUANTITIES[name].of_tooth_pair
    if not of_pair and name != "position":
        if known is None:
            return [Column(heading, np.zeros(0), unit)]
        action = "Give each column its own name."
        raise refuse(shown(heading), f"shape {array.shape}", f"{samples} values", action)
    if array.ndim != 2 or samples not in array.shape or min(array.shape) > len(PAIR_LABELS):
        action = "Give one row for each sample, one column for each tooth pair."
        raise refuse(shown(heading), f"shape {array.shape}", f"({samples}, number of pairs)", action)
    rows = array if array.shape[1] == samples else array.T
    return [Column(heading_of_place(name, place), row, unit) for place, row in enumerate(rows)]


def table_of_frame(frame: pd.DataFrame, name: str) -> Table:
    """Make a table of a data frame; a named index is a column too."""
    import pandas as pd

    columns = []
    if frame.index.name is not None and not isinstance(frame.index, pd.MultiIndex):
        columns.append(_of_series(str(frame.index.name), pd.Series(frame.index)))
    elif isinstance(frame.index, pd.TimedeltaIndex):
        columns.append(_of_series("time", pd.Series(frame.index)))
    if frame.shape[1] > MOST_COLUMNS:
        raise refuse("theirs", f"{frame.shape[1]} columns", f"<= {MOST_COLUMNS}", "Keep those to compare.")
    for place, label in enumerate(frame.columns):
        heading = " ".join(str(part) for part in label) if isinstance(label, tuple) else str(label)
        columns.append(_of_series(heading, frame.iloc[:, place]))
    return Table(name, tuple(columns))


def _of_series(heading: str, series: pd.Series[Any]) -> Column:
    """Column of a series; times become seconds, texts are damage."""
    if series.dtype.kind == "m":
        return Column(heading, series.dt.total_seconds().to_numpy(), "s")
    numbers = numbers_of(series.to_numpy())
    if numbers is not None:
        return Column(heading, numbers)
    damage = refuse(
        shown(heading), f"{shown(str(series.iloc[0]))} of type {series.dtype}", "numbers in every row",
        "Convert the column: frame.astype(float).",
    )  # fmt: skip
    try:
        return Column(heading, series.to_numpy(dtype=np.float64))
    except (TypeError, ValueError):
        return Column(heading, np.full(len(series), np.nan), damage=damage)
