"""What changed between two reports: every number, every verdict, every entry, by report.json alone."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from lumped.arguments import real_number
from validation.reporting.blocks import REMARKS, STATES

#: Relative change of a number that passes; numbers are compared as computed, not as shown.
TOLERANCE = 1e-3
#: Numbers that measure a numerical error change with every rounding; they may grow by this factor.
ERROR_GROWTH = 10.0
#: Errors below this are rounding, whatever they were before.
ROUNDING = 1e-9
#: Names of such numbers: column, fact or end of a row's name; and tables that hold nothing else.
_ERRORS = frozenset(
    {"error", "error_estimate", "liouville_residual", "unsettled", "law_difference", "bound", "closure"}
)
_ERROR_ROWS = ("change over one more cycle",)
_ERROR_TABLES = frozenset(
    {
        "code_verification/closed_forms",
        "solution_verification/refinement",
        "reference_model/checks",
        "stability/routes",
    }
)
#: A number counts as zero below this share of the largest of its unit in its table, or of its column.
_SMALL = 1e-4
_LARGEST_TEXT = 60
#: Blocks that repeat the input, or name the software, which is free to change.
_SAID_ELSEWHERE = {("parameters", "parameters"), ("provenance", "versions")}
#: First parts of the paths of what a report is made from.
_INPUT = ("input/", "provenance/")

Kind = Literal["number", "verdict", "text", "missing", "new", "parameter"]
_TONES = {"good": 0, "plain": 0, "fair": 1, "bad": 2}


@dataclass(frozen=True)
class Change:
    """One difference between two reports.

    Attributes
    ----------
    path : place in report.json
    kind : "number", "verdict", "text", "missing", "new" or "parameter"
    old, new : values as text
    size : relative change of a number; None for anything else
    fails : whether it is past its tolerance
    """

    path: str
    kind: Kind
    old: str
    new: str
    size: float | None
    fails: bool

    def __str__(self) -> str:
        size = "" if self.size is None else f" ({100 * self.size:.3g} %)"
        return f"{self.path}: {self.old} -> {self.new}{size}"


@dataclass(frozen=True)
class Comparison:
    """Two reports beside each other.

    Attributes
    ----------
    old_name : gear pair of the earlier report
    tolerance : relative change of a number that passes
    compared : number of values compared
    changes : differences, those that fail first, numbers by size
    """

    old_name: str
    tolerance: float
    compared: int
    changes: tuple[Change, ...]

    @property
    def regressions(self) -> tuple[Change, ...]:
        """Changes past their tolerance."""
        return tuple(change for change in self.changes if change.fails)


def compare(old: Mapping[str, Any], new: Mapping[str, Any], *, tolerance: float = TOLERANCE) -> Comparison:
    """Compare two reports.

    A number fails where it changes by more than the tolerance, relative to the larger of the two and to a
    ten-thousandth of the largest number of its unit in its table, without a unit in its column. Where a row
    states the unit of its numbers each stands for itself. One that measures a numerical error fails where it
    grows tenfold and beyond rounding. A verdict fails where it gets worse. An entry fails where it is gone; a
    chapter that is gone counts once. Texts, new entries, changed parameters and settings are shown and do not
    fail.

    Parameters
    ----------
    old, new : data of report.json
    tolerance : relative change of a number that passes, 0 to 1

    Raises
    ------
    ParameterError : the tolerance is out of range
    """
    advice = "0.001 lets numbers change by a tenth of a percent."
    tolerance = real_number("--tolerance", tolerance, 0.0, 1.0, action=advice)
    before, after = dict(leaves(old)), dict(leaves(new))
    scales = _scales(before)
    changes = [
        Change(key, "missing", chapter["title"], "gone", None, True)
        for key, chapter in old["chapters"].items()
        if key not in new["chapters"] and key != "changes"
    ]
    gone = {change.path for change in changes}
    for path in before | after:
        if path.partition("/")[0] in gone:
            continue
        first, second = before.get(path), after.get(path)
        if first != second or type(first) is not type(second):
            change = _change(path, path in before, path in after, first, second, tolerance, scales)
            if change is not None:
                changes.append(change)
    changes.sort(key=lambda c: (not c.fails, c.kind != "verdict", -(c.size or 0.0)))
    return Comparison(
        str(old.get("gear_pair", "")), tolerance, len(before.keys() & after.keys()), tuple(changes)
    )


@dataclass(frozen=True)
class _State:
    """Verdict at a leaf."""

    state: str
    text: str

    @property
    def rank(self) -> int:
        return _TONES.get(STATES.get(self.state, "plain"), 0)


@dataclass(frozen=True)
class _Number:
    """Number at a leaf; ``alone``: its row states its unit, so its column holds other things."""

    value: float
    unit: str = ""
    alone: bool = False


Leaf = _Number | str | bool | None | _State


def leaves(document: Mapping[str, Any]) -> Iterator[tuple[str, Leaf]]:
    """Paths and values of everything that a report says; the chapter of changes and versions are left out."""
    for answer in document["answers"]:
        yield f"answers/{answer['question']}", _State(answer["verdict"]["state"], answer["verdict"]["text"])
    for key, chapter in document["chapters"].items():
        if key == "changes":
            continue
        for name, block in chapter.items():
            if name not in ("title", *REMARKS) and (key, name) not in _SAID_ELSEWHERE:
                yield from _walk(f"{key}/{name}", block)
    yield from _walk("input", document["parameters"])


def _walk(path: str, value: Any, unit: str | None = None) -> Iterator[tuple[str, Leaf]]:
    """Leaves below a value; ``unit`` is that of plain numbers where their row states one."""
    if isinstance(value, dict):
        if set(value) == {"state", "text"}:
            yield path, _State(str(value["state"]), str(value["text"]))
        elif set(value) == {"value", "unit"}:
            number = value["value"]
            yield path, None if number is None else _Number(float(number), str(value["unit"]))
        elif {"label", "value"} <= set(value) <= {"label", "value", "note"}:
            yield from _walk(path, value["value"])
        else:
            own = value.get("unit")
            for key, item in value.items():
                yield from _walk(f"{path}/{key}", item, own if isinstance(own, str) else None)
    elif isinstance(value, list):
        names = row_names(value)
        for name, item in zip(names, value, strict=True):
            yield from _walk(f"{path}/{name}", item)
    else:
        is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
        yield path, _Number(float(value), unit or "", unit is not None) if is_number else value


def row_names(rows: list[Any]) -> list[str]:
    """Names of a table's rows: as many leading words and whole numbers as tell them apart, else numbered."""
    words = [
        [str(v) for v in row.values() if type(v) in (str, int)] if isinstance(row, dict) else []
        for row in rows
    ]
    names = [""] * len(rows)
    for count in (1, 2):
        names = [", ".join(w[:_LARGEST_TEXT] for w in found[:count]) for found in words]
        if len(set(names)) == len(names):
            return names
    seen: dict[str, int] = {}
    for place, name in enumerate(names):
        seen[name] = seen.get(name, 0) + 1
        names[place] = f"{name} ({seen[name]})".strip()
    return names


def _scales(leaves: Mapping[str, Leaf]) -> dict[tuple[str, str, str], float]:
    """Largest number of each kind, see ``_kind``."""
    scales: dict[tuple[str, str, str], float] = {}
    for path, leaf in leaves.items():
        if isinstance(leaf, _Number):
            kind = _kind(path, leaf)
            scales[kind] = max(scales.get(kind, 0.0), abs(leaf.value))
    return scales


def _kind(path: str, number: _Number) -> tuple[str, str, str]:
    """What tells the numbers that this one may be small beside: table and unit, or table and column."""
    table, column = _column(path)
    return (table, "", number.unit) if number.unit not in ("", "1") else (table, column, "")


def _column(path: str) -> tuple[str, str]:
    parts = path.split("/")
    return "/".join(parts[:2]), parts[-1]


def _number_change(path: str, old: _Number, new: _Number, tolerance: float, scale: float) -> Change:
    table, column = _column(path)
    difference, largest = abs(new.value - old.value), max(abs(old.value), abs(new.value))
    row = path.rpartition("/")[0]
    if column in _ERRORS or table in _ERROR_TABLES or row.endswith(_ERROR_ROWS):
        fails = new.value > max(ERROR_GROWTH * old.value, ROUNDING)
        return Change(path, "number", _shown(old), _shown(new), difference / largest, fails)
    if old.alone:
        # A unit that a row states is chosen for reading: what is rounding in it is nothing.
        size = difference / largest
        fails = size > tolerance and largest > ROUNDING
    else:
        size = difference / max(largest, _SMALL * scale)
        fails = size > tolerance
    return Change(path, "number", _shown(old), _shown(new), size, fails)


def _change(
    path: str,
    was: bool,
    is_: bool,
    old: Leaf,
    new: Leaf,
    tolerance: float,
    scales: Mapping[tuple[str, str, str], float],
) -> Change | None:
    if path.startswith(_INPUT):
        return Change(path, "parameter", _shown(old), _shown(new), None, False)
    if not is_:
        return Change(path, "missing", _shown(old), "gone", None, True)
    if not was:
        return Change(path, "new", "not there", _shown(new), None, False)
    if isinstance(old, _Number) and isinstance(new, _Number):
        if old.unit != new.unit:
            return Change(path, "text", _shown(old), _shown(new), None, True)
        return _number_change(path, old, new, tolerance, scales.get(_kind(path, old), 0.0))
    if isinstance(old, _State) and isinstance(new, _State):
        if old.state == new.state:
            return None
        return Change(path, "verdict", old.text, new.text, None, new.rank > old.rank)
    # A number that is gone, or one where there was a word, is a change of what is said.
    fails = isinstance(old, (_Number, _State)) or isinstance(new, (_Number, _State))
    return Change(path, "text", _shown(old), _shown(new), None, fails)


def _shown(value: Leaf) -> str:
    if isinstance(value, _State):
        return value.text
    if isinstance(value, _Number):
        return f"{value.value:.6g} {value.unit}".rstrip()
    text = "no value" if value is None else str(value)
    return text if len(text) <= _LARGEST_TEXT else text[:_LARGEST_TEXT] + "…"
