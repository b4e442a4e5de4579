"""The table of drawn mutants, as stored by ``python -m tests.evidence.mutants``."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from computed.markdown import Code, table
from tests.evidence.mutants.drawing import WEIGHTS
from tests.evidence.mutants.table import argued, counts, share_killed

STORED = Path(__file__).resolve().parents[1] / "verification" / "mutants.json"
_VERDICTS = ("killed", "survived", "argued", "undecided")

Row = dict[str, Any]


def mutants(stored: Mapping[str, Any]) -> str:
    """How many of each package are killed, and every mutant, survivors first."""
    rows = argued(stored["mutants"])
    text = f"Seed {stored['seed']}: {_share(rows)} of the decided mutants are killed.\n\n"
    packages = [(name, [one for one in rows if one["file"].startswith(f"{name}/")]) for name in WEIGHTS]
    counted = [
        (name, *(counts(mine)[word] for word in _VERDICTS), _share(mine))
        for name, mine in [*packages, ("all", rows)]
    ]
    text += table(("package", *_VERDICTS, "share killed"), counted)
    for word in ("survived", "argued", "undecided", "killed"):
        mine = [_row(one) for one in rows if one["verdict"] == word]
        columns = ("line", "before", "after", "killed by" if word == "killed" else "why", "s")
        text += f"\n## {word.capitalize()}\n\n{table(columns, mine)}" if mine else ""
    return text


def _row(one: Row) -> Sequence[str | float]:
    place = f"{one['file']}:{one['line']}"
    return Code(place), Code(one["before"]), Code(one["after"]), one["by"], round(one["seconds"])


def _share(rows: Sequence[Row]) -> str:
    share = share_killed(rows)
    return "–" if share != share else f"{100.0 * share:.0f} %"


def stored_table() -> str:
    """The stored table; a word where there is none yet."""
    if not STORED.exists():
        return "No run is stored yet.\n"
    return mutants(json.loads(STORED.read_text(encoding="utf-8")))


FILES = {"mutants.md": stored_table}
