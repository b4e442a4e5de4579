"""The table of mutants: its rows, the arguments for survivors, the file that is written as a run goes on."""

from __future__ import annotations

import hashlib
import json
import os
import tomllib
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from tests.evidence.mutants.drawing import Mutant, files
from tests.evidence.mutants.judging import Verdict

Row = dict[str, Any]
ARGUMENTS = Path(__file__).with_name("arguments.toml")


def row(mutant: Mutant, verdict: Verdict) -> Row:
    """One row as plain data."""
    shown = {name: value for name, value in vars(mutant).items() if name != "source"}
    return shown | asdict(verdict)


def arguments(source: Path = ARGUMENTS) -> dict[tuple[str, str, str], str]:
    """File, line before and line after -> why the change is no fault. Lines may move: no number enters."""
    entries = tomllib.loads(source.read_text(encoding="utf-8")).get("harmless", [])
    return {(one["file"], one["before"], one["after"]): one["why"] for one in entries}


def argued(rows: Iterable[Row], known: Mapping[tuple[str, str, str], str] | None = None) -> list[Row]:
    """Rows in which survivors that are harmless are ``argued``, with the reason."""
    reasons = arguments() if known is None else known
    return [
        one | {"verdict": "argued", "by": why}
        if one["verdict"] == "survived" and (why := reasons.get((one["file"], one["before"], one["after"])))
        else one
        for one in rows
    ]  # fmt: skip


def counts(rows: Iterable[Row]) -> Counter[str]:
    """How many rows have each verdict."""
    return Counter(one["verdict"] for one in rows)


def share_killed(rows: Iterable[Row]) -> float:
    """Killed mutants over those that are killed or survive without an argument; nan where there are none."""
    number = counts(rows)
    decided = number["killed"] + number["survived"]
    return number["killed"] / decided if decided else float("nan")


class Stored:
    """Rows of one run. An incomplete run is stored in ``<name>.part``; a second start continues the run.

    A part of another seed, number or state of the library is begun anew.
    """

    def __init__(self, target: Path | None, head: Mapping[str, Any]) -> None:
        self.target = target
        self.head = dict(head)
        self.rows: dict[str, Row] = {}
        self.part = target.with_name(f"{target.name}.part") if target else None
        if self.part and self.part.exists():
            first, *rest = self.part.read_text(encoding="utf-8").split("\n")
            if first == json.dumps(self.head):
                complete = [json.loads(line) for line in rest[:-1]]  # a kill may leave half of the last line
                self.rows = {one["key"]: one for one in complete}
        self._rewrite()

    def _rewrite(self) -> None:
        if self.part:
            lines = [self.head, *self.rows.values()]
            _write(self.part, "".join(json.dumps(line, ensure_ascii=False) + "\n" for line in lines))

    def add(self, one: Row) -> None:
        """Keep a row at once."""
        self.rows[one["key"]] = one
        if self.part:
            with self.part.open("a", encoding="utf-8") as file:
                file.write(json.dumps(one, ensure_ascii=False) + "\n")

    def finish(self) -> None:
        """Write the table whole, in the order of files and lines."""
        if self.target and self.part:
            ordered = sorted(self.rows.values(), key=lambda one: (one["file"], one["line"]))
            content = self.head | {"mutants": ordered}
            _write(self.target, json.dumps(content, indent=1, ensure_ascii=False) + "\n")
            self.part.unlink()


def _write(target: Path, text: str) -> None:
    """Write a file that appears when it is complete."""
    temporary = target.with_name(f"{target.name}.new")
    temporary.write_text(text, encoding="utf-8")
    os.replace(temporary, target)


def library_digest(root: Path) -> str:
    """Digest of all files from which lines are drawn."""
    digest = hashlib.sha256()
    for file in files(root):
        digest.update(file.encode() + (root / file).read_bytes())
    return digest.hexdigest()[:16]
