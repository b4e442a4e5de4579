"""Code verification: what is known of the program itself, whatever the pair."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from validation.reporting.blocks import Badge, Content, Rows, Table, Text
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results
from validation.verification.evidence import source_hash, stored_evidence


def write(results: Results) -> Content:
    """Write the chapter."""
    return content(stored_evidence(), source_hash())


def content(evidence: Mapping[str, Any], source: str) -> Content:
    """One paragraph and one table of the stored evidence, and whether it is of this source."""
    found = [_row(kind["title"], kind["checks"]) for kind in evidence["kinds"]]
    passed, number = sum(row[2] for row in found), sum(row[1] for row in found)
    same = evidence["source_sha256"] == source
    text = Text(
        "Does the program solve its equations right? This does not depend on the pair, so it was computed "
        f"once, by “make evidence” on {evidence['date']}: {passed} of {number} checks pass. "
        + (
            "The source of this program is the one that was checked."
            if same
            else "The source of this program has changed since: its SHA-256 is not the one that was checked. "
            "Run “make evidence” in the repository to compute the evidence again."
        )
    )
    faults, sound = evidence["faults"], evidence["sound_pairs"]
    rows: Rows = [
        (title, count, use, Badge("within" if good == count else "outside"))
        for title, count, good, use in found
    ]
    note = (
        f"Of {faults['all']} faults put into the program on purpose, {faults.get('missed', 0)} are missed by "
        f"all checks. Of {sum(sound.values())} random sound pairs the cross-check refuses "
        f"{sound.get('fails', 0)}."
    )
    table = Table(
        "evidence",
        "Evidence about the program by its kind.",
        {"kind": "kind", "checks": "checks", "use": "largest error over its limit", "verdict": "verdict"},
        tuple(rows),
        note=note,
    )
    return Content((text, table))


def _row(title: str, checks: list[Mapping[str, Any]]) -> tuple[str, int, int, float]:
    """Title, number of checks, how many pass, and the largest error over its limit."""
    away = [(abs(one["value"] - one.get("theory", 0.0)), one["limit"]) for one in checks]
    use = max((error / limit for error, limit in away if limit), default=0.0)
    return title, len(checks), sum(error <= limit for error, limit in away), use


CHAPTER = Chapter("code_verification", "Code verification", write)
