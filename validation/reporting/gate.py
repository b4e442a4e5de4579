"""Report.json as a gate: verdicts that fail, and what changed since an earlier report."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Never

from lumped.arguments import file_path, real_number
from lumped.errors import refuse
from lumped.fields.text_file import read_text
from validation.files.folder import FORMAT, FORMAT_VERSION, REPORT
from validation.reporting.blocks import REMARKS, STATES

#: Relative change of a number that passes; numbers are compared as computed, not as shown.
TOLERANCE = 1e-3
#: Numbers that measure a numerical error change with every rounding; they may grow by this factor.
_ERROR_GROWTH = 10.0
#: Errors below this are rounding, whatever they were before.
_ROUNDING = 1e-9
#: Names of such numbers, and tables that hold nothing else.
_ERRORS = frozenset(
    {"error", "error_estimate", "liouville_residual", "unsettled", "law_difference", "bound", "closure"}
)
_ERROR_TABLES = frozenset(
    {
        "code_verification/evidence",
        "solution_verification/refinement",
    }
)
#: A number counts as zero below this share of the largest of its unit in its table, or of its column.
_SMALL = 1e-4
_MAX_BYTES = 100_000_000
_LARGEST_TEXT = 60
#: Blocks that repeat the input, or name the software, which is free to change.
_NOT_COMPARED = {("parameters", "parameters"), ("provenance", "versions")}
#: First parts of the paths of what a report is made from.
_INPUT = ("input/", "provenance/")
_TONES = {"good": 0, "plain": 0, "fair": 1, "bad": 2}


def failures(document: Mapping[str, Any]) -> tuple[str, ...]:
    """Verdicts of report.json that are bad, one line each: the answers on top, chapters, rows of tables."""
    bad = [f"answers: {a['question']}: {a['verdict']['text']}" for a in document["answers"] if _rank(a) == 2]
    for key, chapter in document["chapters"].items():
        if _rank(chapter) == 2:
            bad.append(f"{key}: {chapter['title']}: {chapter['verdict']['text']}")
        for name, block in chapter.items():
            for row_name, row in zip(_row_names(block), block, strict=True) if _is_table(block) else ():
                # Other badges only mark a row.
                for column in ("verdict", "state"):
                    if _rank(row, column) == 2:
                        bad.append(f"{key}.{name}: {row_name}: {row[column]['text']}")
    return tuple(bad)


def _is_table(block: Any) -> bool:
    return isinstance(block, list) and all(isinstance(row, dict) for row in block)


def _rank(row: Mapping[str, Any], column: str = "verdict") -> int:
    """How bad the badge of a row is, 0 to 2; 0 without one."""
    badge = row.get(column)
    return _TONES[STATES.get(badge["state"], "plain")] if isinstance(badge, dict) and "state" in badge else 0


@dataclass(frozen=True)
class Change:
    """One difference between two reports.

    Attributes
    ----------
    path : place in report.json
    old, new : values as text
    size : relative change of a number; 0 for anything else
    fails : whether it is past its tolerance
    """

    path: str
    old: str
    new: str
    size: float = 0.0
    fails: bool = False

    def __str__(self) -> str:
        size = f" ({100 * self.size:.3g} %)" if self.size else ""
        return f"{self.path}: {self.old} -> {self.new}{size}"


@dataclass(frozen=True)
class Comparison:
    """Two reports beside each other.

    Attributes
    ----------
    old_name : gear pair of the earlier report
    compared : number of values compared
    changes : differences, those that fail first, numbers by size
    """

    old_name: str
    compared: int
    changes: tuple[Change, ...]

    @property
    def regressions(self) -> tuple[Change, ...]:
        """Changes past their tolerance."""
        return tuple(change for change in self.changes if change.fails)


def checked_tolerance(tolerance: float) -> float:
    """Return the tolerance of a comparison, or refuse it."""
    advice = "0.001 lets numbers change by a tenth of a percent."
    return real_number("--tolerance", tolerance, 0.0, 1.0, action=advice)


def load_report(source: str | Path, *, quick: bool) -> dict[str, Any]:
    """Read report.json, or the one of a report folder, which a new report is to be compared with.

    ``source``: file or folder; ``quick``: whether the new report is a quick one.
    """
    action = "Give the report.json of an earlier report."
    path = file_path("compare", source)
    path = path / REPORT.file if path.is_dir() else path
    text = read_text(path, _MAX_BYTES, field="--compare", kind="report.json", action=action)
    try:
        data = json.loads(text, parse_constant=_refuse_constant)
        dict(_leaves(data))
        name, version, sampled = data["format"], data["format_version"], data["quick"]
    except (ArithmeticError, AttributeError, LookupError, RecursionError, TypeError, ValueError) as error:
        why = f"This is no report, or only a part of one ({type(error).__name__}: {error}). {action}"
        raise refuse("--compare", source, "a report.json as it was written", why) from None
    if (name, version) != (FORMAT, FORMAT_VERSION):
        why = f"This one is {name} {version}: write the earlier report again with this version of spurcheck."
        raise refuse("--compare", source, f"a report of layout {FORMAT} {FORMAT_VERSION}", why)
    if sampled != quick:
        words = {True: "a quick report", False: "a full report"}
        why = f"The earlier one is {words[bool(sampled)]}: sample both alike, with or without --quick."
        raise refuse("--compare", source, f"{words[quick]}, as the new one", why)
    return dict(data)


def _refuse_constant(name: str) -> Never:
    raise ValueError(f"{name} is no number")


def compare(old: Mapping[str, Any], new: Mapping[str, Any], *, tolerance: float = TOLERANCE) -> Comparison:
    """Compare two reports.
    A number fails where it changes by more than the tolerance, relative to the larger of the two and to a
    ten-thousandth of the largest number of its unit in its table, without a unit in its column. One that
    measures a numerical error fails where it grows tenfold and beyond rounding. A verdict fails where it gets
    worse, and an entry where it is gone. Texts, new entries, changed parameters and settings are shown and do
    not fail.

    old, new: data of report.json; ``tolerance``: relative change of a number that passes, 0 to 1.
    """
    tolerance = checked_tolerance(tolerance)
    before, after = dict(_leaves(old)), dict(_leaves(new))
    scales: dict[tuple[str, str, str], float] = {}
    for path, leaf in before.items():
        if isinstance(leaf, _Number):
            kind = _kind(path, leaf)
            scales[kind] = max(scales.get(kind, 0.0), abs(leaf.value))
    changes = [
        change
        for path in before | after
        if (change := _change(path, before, after, tolerance, scales)) is not None
    ]
    changes.sort(key=lambda c: (not c.fails, -c.size))
    return Comparison(str(old["gear_pair"]), len(before.keys() & after.keys()), tuple(changes))


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
    """Number at a leaf."""

    value: float
    unit: str = ""


Leaf = _Number | _State | str | bool | None


def _leaves(document: Mapping[str, Any]) -> Iterator[tuple[str, Leaf]]:
    """Paths and values of everything that a report says; versions are left out."""
    for answer in document["answers"]:
        yield f"answers/{answer['question']}", _State(answer["verdict"]["state"], answer["verdict"]["text"])
    for key, chapter in document["chapters"].items():
        for name, block in chapter.items():
            if name not in ("title", *REMARKS) and (key, name) not in _NOT_COMPARED:
                yield from _walk(f"{key}/{name}", block)
    yield from _walk("input", document["parameters"])


def _walk(path: str, value: Any) -> Iterator[tuple[str, Leaf]]:
    if isinstance(value, dict):
        if set(value) == {"state", "text"}:
            yield path, _State(str(value["state"]), str(value["text"]))
        elif set(value) == {"value", "unit"}:
            number = value["value"]
            yield path, None if number is None else _Number(float(number), str(value["unit"]))
        elif {"label", "value"} <= set(value) <= {"label", "value", "note"}:
            yield from _walk(path, value["value"])
        else:
            for key, item in value.items():
                yield from _walk(f"{path}/{key}", item)
    elif isinstance(value, list):
        for name, item in zip(_row_names(value), value, strict=True):
            yield from _walk(f"{path}/{name}", item)
    else:
        is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
        yield path, _Number(float(value)) if is_number else value


def _row_names(rows: list[Any]) -> list[str]:
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
    return [f"{name} ({names[: place + 1].count(name)})".strip() for place, name in enumerate(names)]


def _kind(path: str, number: _Number) -> tuple[str, str, str]:
    """What tells the numbers that this one may be small beside: table and unit, or table and column."""
    table, column = _column(path)
    return (table, "", number.unit) if number.unit not in ("", "1") else (table, column, "")


def _column(path: str) -> tuple[str, str]:
    parts = path.split("/")
    return "/".join(parts[:2]), parts[-1]


def _change(
    path: str,
    before: Mapping[str, Leaf],
    after: Mapping[str, Leaf],
    tolerance: float,
    scales: Mapping[tuple[str, str, str], float],
) -> Change | None:
    if path not in before:
        return Change(path, "not there", _shown(after[path]))
    if path not in after:
        return Change(path, _shown(before[path]), "gone", fails=not path.startswith(_INPUT))
    old, new = before[path], after[path]
    if old == new and type(old) is type(new):
        return None
    texts = _shown(old), _shown(new)
    if path.startswith(_INPUT):
        return Change(path, *texts)
    if isinstance(old, _Number) and isinstance(new, _Number) and old.unit == new.unit:
        table, column = _column(path)
        difference, largest = abs(new.value - old.value), max(abs(old.value), abs(new.value))
        if column in _ERRORS or table in _ERROR_TABLES:
            fails = new.value > max(_ERROR_GROWTH * old.value, _ROUNDING)
            return Change(path, *texts, difference / largest, fails)
        size = difference / max(largest, _SMALL * scales.get(_kind(path, old), 0.0))
        return Change(path, *texts, size, size > tolerance)
    if isinstance(old, _State) and isinstance(new, _State):
        return None if old.state == new.state else Change(path, *texts, fails=new.rank > old.rank)
    # A number that is gone, or one where there was a word, is a change of what is said.
    fails = isinstance(old, (_Number, _State)) or isinstance(new, (_Number, _State))
    return Change(path, *texts, fails=fails)


def _shown(value: Leaf) -> str:
    if isinstance(value, _State):
        return value.text
    if isinstance(value, _Number):
        return f"{value.value:.6g} {value.unit}".rstrip()
    text = "no value" if value is None else str(value)
    return text if len(text) <= _LARGEST_TEXT else text[:_LARGEST_TEXT] + "…"
