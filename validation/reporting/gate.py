"""Comparison of report.json with that of an earlier report: the gate of ``--compare``."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lumped.arguments import file_path
from lumped.errors import ParameterError, refuse
from lumped.fields.text_file import read_text
from validation.files.folder import FORMAT, FORMAT_VERSION
from validation.reporting.blocks import REMARKS
from validation.reporting.verdict import Verdict

#: Relative change of a number that passes. Numbers are compared as computed, not as printed.
TOLERANCE = 1e-3
#: A number counts as zero below this share of the largest of its column.
_SMALL = 1e-4
#: Tables of numerical errors, which change with every rounding. Every report compares them with their limits.
_ERRORS = frozenset({"agreement", "conservation", "error_budget"})
#: Chapters with inputs and software, which may change.
_FREE = frozenset({"inputs", "evidence"})
_MAX_BYTES = 100_000_000
#: Verdicts of page 1, the worst last.
_RANK = {verdict.name: rank for rank, verdict in enumerate(Verdict)}


@dataclass(frozen=True)
class Change:
    """One difference between two reports.

    Attributes
    ----------
    path : place of the value: chapter, table, row and column
    old, new : values as texts
    size : relative change of a number; 0 for other values
    fails : whether the change is past the tolerance
    """

    path: str
    old: str
    new: str
    size: float
    fails: bool

    def __str__(self) -> str:
        size = f" ({100 * self.size:.3g} %)" if self.size else ""
        return f"{self.path}: {self.old} -> {self.new}{size}"


@dataclass(frozen=True)
class Comparison:
    """The differences between two reports.

    Attributes
    ----------
    old_name : gear pair of the earlier report
    compared : number of compared values
    changes : differences, failures first
    """

    old_name: str
    compared: int
    changes: tuple[Change, ...]

    @property
    def regressions(self) -> tuple[Change, ...]:
        """Changes past the tolerance."""
        return tuple(change for change in self.changes if change.fails)


def compare(old: Mapping[str, Any], new: Mapping[str, Any], tolerance: float = TOLERANCE) -> Comparison:
    """Compare report.json of two reports.

    A number fails where it changes by more than the tolerance. The change is relative to the larger of the
    two numbers, or to a ten-thousandth of the largest number of the column if that is more. The verdict
    fails where it gets worse, an entry where it is missing. New entries and changed parameters are shown
    and do not fail.
    """
    before = dict(_leaves(old))
    after = dict(_leaves(new))
    largest: dict[str, float] = {}
    for path, value in before.items():
        if isinstance(value, float):
            column = _column(path)
            largest[column] = max(largest.get(column, 0.0), abs(value))
    changes = []
    for path in before | after:
        old_value = before.get(path)
        new_value = after.get(path)
        if old_value == new_value:
            continue
        size = 0.0
        fails = path in before and not path.startswith("parameters/")
        if path == "verdict":
            fails = _RANK[str(new_value)] > _RANK[str(old_value)]
        elif path not in before:
            fails = False
        elif isinstance(old_value, float) and isinstance(new_value, float):
            scale = max(abs(old_value), abs(new_value), _SMALL * largest[_column(path)])
            size = abs(old_value - new_value) / scale
            fails = fails and size > tolerance
        changes.append(Change(path, _shown(old_value), _shown(new_value), size, fails))
    changes.sort(key=lambda c: (not c.fails, -c.size))
    return Comparison(str(old.get("gear_pair", "")), len(before.keys() & after.keys()), tuple(changes))


def load_report(source: str | Path, *, quick: bool) -> dict[str, Any]:
    """Read report.json of an earlier report, or of its folder. Both reports must be quick, or both full."""
    path = file_path("--compare", source)
    path = path / "report.json" if path.is_dir() else path
    try:
        document = json.loads(read_text(path, _MAX_BYTES, field="--compare", kind="report.json"))
    except ParameterError:
        raise
    except ValueError as error:
        raise refuse("--compare", path, "report.json of a report", f"It is no JSON: {error}.") from None
    layout = (document.get("format"), document.get("format_version")) if isinstance(document, dict) else ()
    if layout != (FORMAT, FORMAT_VERSION):
        raise refuse("--compare", path, "report.json of this layout", "Make the earlier report again.")
    if document["quick"] != quick:
        action = "Compare reports that are both made with --quick, or both without."
        raise refuse("--compare", path, "a report of the same sampling", action)
    return dict(document)


def _leaves(document: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Paths and values of all compared entries."""
    yield "verdict", document["verdict"]["kind"]
    for key, one in document["numbers"].items():
        for name in ("value", "low", "high", "median", "second"):
            if one[name] is not None:
                yield f"page 1/{key}/{name}", float(one[name])
    for key, chapter in document["chapters"].items():
        for name, table in chapter.items() if key not in _FREE else ():
            if name in ("title", *REMARKS) or name in _ERRORS:
                continue
            for place, row in enumerate(table):
                title = next((v for v in row.values() if isinstance(v, str) and v), str(place))
                for column, value in row.items():
                    measured = isinstance(value, dict) and "unit" in value
                    number, unit = (value["value"], f" [{value['unit']}]") if measured else (value, "")
                    if isinstance(number, (int, float)) and not isinstance(number, bool):
                        yield f"{key}/{name}/{title} {place}/{column}{unit}", float(number)
    yield from _parameters(document["parameters"], "parameters")


def _parameters(data: Mapping[str, Any], prefix: str) -> Iterator[tuple[str, Any]]:
    for key, value in data.items():
        if isinstance(value, Mapping):
            yield from _parameters(value, f"{prefix}/{key}")
        else:
            yield f"{prefix}/{key}", str(value)


def _column(path: str) -> str:
    parts = path.split("/")
    return path if parts[0] == "page 1" else "/".join([*parts[:2], parts[-1]])


def _shown(value: Any) -> str:
    return "nothing" if value is None else f"{value:.6g}" if isinstance(value, float) else str(value)
