"""The verdicts of a report one by one, as other programs want them: from report.json's data alone."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from validation.reporting.blocks import STATES
from validation.reporting.compare import row_names

#: Columns and facts whose badge is a verdict; other badges only mark a row.
_VERDICTS = frozenset({"verdict", "state"})


@dataclass(frozen=True)
class Case:
    """One verdict.

    Attributes
    ----------
    group : chapter
    name : what is judged; the same from run to run, so without numbers
    state, text : its badge
    detail : the numbers beside it
    """

    group: str
    name: str
    state: str
    text: str
    detail: str

    @property
    def fails(self) -> bool:
        """Whether the verdict is bad."""
        return STATES[self.state] == "bad"


def cases(document: Mapping[str, Any]) -> tuple[Case, ...]:
    """Every verdict of report.json: the answers on top, chapters, and rows of tables."""
    found = [
        Case("answers", a["question"], a["verdict"]["state"], a["verdict"]["text"], a["text"])
        for a in document["answers"]
    ]
    for key, chapter in document["chapters"].items():
        if key == "changes":  # judged as a comparison, not as a report
            continue
        if "verdict" in chapter:
            badge = chapter["verdict"]
            found.append(Case(key, chapter["title"], badge["state"], badge["text"], ""))
        for name, block in chapter.items():
            found += _of_block(key, name, block)
    return tuple(found)


def failures(document: Mapping[str, Any]) -> tuple[Case, ...]:
    """Verdicts that are bad."""
    return tuple(case for case in cases(document) if case.fails)


def _of_block(chapter: str, name: str, block: Any) -> Iterator[Case]:
    if not isinstance(block, list):
        return
    for name_of_row, row in zip(row_names(block), block, strict=True):
        if not isinstance(row, dict):
            continue
        for column, value in row.items():
            if column in _VERDICTS and isinstance(value, dict) and "state" in value:
                detail = "; ".join(f"{k}: {_text(v)}" for k, v in row.items() if k != column and _text(v))
                yield Case(f"{chapter}.{name}", name_of_row, value["state"], value["text"], detail)


def _text(value: Any) -> str:
    if isinstance(value, dict):
        if "unit" in value:
            return f"{value['value']} {value['unit']}"
        return str(value.get("text", ""))
    return "" if value is None else str(value)
