"""The table of faults and the sound pairs, as stored by ``python -m tests.evidence.faults``."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from computed.markdown import table
from tests.evidence.faults.fault import GROUPS, REPORT_FAULTS
from tests.evidence.faults.table import counts, laws_that_act

FOLDER = Path(__file__).resolve().parents[1] / "verification"
_MODELS = ("lumped", "linear", "exact")

Row = Mapping[str, Any]


def rows(name: str) -> list[dict[str, Any]]:
    """Rows of a stored table."""
    found: list[dict[str, Any]] = json.loads((FOLDER / name).read_text(encoding="utf-8"))
    return found


def faults(stored: Sequence[Row]) -> str:
    """How many faults are seen, the faults of each group, and the conservation laws that they break."""
    text = ", ".join(f"{number} {name}" for name, number in sorted(counts(stored).items())) + ".\n"
    for group in GROUPS:
        mine = [_fault(one) for one in stored if one["group"] == group]
        columns = ("fault", "change", "of", "crosscheck", "report", "first seen by")
        text += f"\n## {group.capitalize()}\n\n{table(columns, mine)}" if mine else ""
    acting = laws_that_act(stored)
    laws = [
        (law.replace("_", " "), *(acting.get((law, model), "") for model in _MODELS))
        for law in sorted({law for law, _ in acting})
    ]
    words = "Faults that break each law, by the model on which it is checked."
    return f"{text}\n## Conservation laws\n\n{words}\n\n{table(('law', *_MODELS), laws)}"


def _fault(one: Row) -> tuple[str, ...]:
    caught = one["caught"]
    seen = ": ".join(filter(None, (one["verdict"], one["unseen"])))
    for part, checks in list(caught.items())[:1]:
        seen = f"{part}: {checks[0]}" + (f" and {len(checks) - 1} more" if len(checks) > 1 else "")
    return (
        one["words"],
        "not computed" if one["size"] is None else f"{100.0 * one['size']:.3g} %",
        one["quantity"],
        "sees it" if {"refused", "cross-check"} & caught.keys() else "",
        "sees it" if caught.keys() - {"tests"} else "",
        seen,
    )


def sound_pairs(stored: Sequence[Row]) -> str:
    """What became of sound pairs; those that failed one by one."""
    verdicts = Counter(row["verdict"] for row in stored)
    worst = max((row for row in stored if "use" in row), key=lambda row: row["use"])
    seconds = sum(row["seconds"] for row in stored) / len(stored)
    counted = ", ".join(f"{n} {name}" for name, n in sorted(verdicts.items()))
    text = (
        f"{len(stored)} pairs: {counted}. Largest use of a limit: {worst['use']:.2f} ({worst['check']}). "
        f"{seconds:.1f} s per pair.\n"
    )
    wrong = [row for row in stored if row["verdict"] == "fails"]
    return text + "".join(
        f"\n- {row['name']} ({row['preset']}): {'; '.join(row['failures'])}" for row in wrong
    )


def report_faults() -> str:
    """Faults in what the report shows, and the checks that see each."""
    stored = json.loads((FOLDER / "report_faults.json").read_text(encoding="utf-8"))
    seen = [
        (
            REPORT_FAULTS[key].words,
            ", ".join(one.removeprefix("test_").replace("_", " ") for one in checks[:2]),
        )
        for key, checks in stored.items()
    ]
    missed = sum(not checks for checks in stored.values())
    return f"{len(stored)} faults, {missed} missed.\n\n{table(('fault', 'seen by'), seen)}"


FILES = {
    "report_faults.md": report_faults,
    "faults.md": lambda: faults(rows("faults.json")),
    "sound_pairs.md": lambda: sound_pairs(rows("sound_pairs.json")),
}
