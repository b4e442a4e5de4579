"""The table of faults: run, written and read."""

from __future__ import annotations

import hashlib
import json
import math
import random
import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from validation.faults.catalogue import FAULTS, GROUPS
from validation.faults.fault import Fault
from validation.faults.judging import Outcome

_MODELS = ("lumped", "linear", "exact")
#: What ends the name of a law that is checked for each axis or bearing.
_AXIS = re.compile(r" [xy](_[pg])?$")


def sample(count: int, seed: str) -> tuple[Fault, ...]:
    """Some of the faults, chosen by a text such as a commit's name.

    Parameters
    ----------
    count : how many
    seed : the text
    """
    number = int.from_bytes(hashlib.sha256(seed.encode()).digest()[:8], "big")
    return tuple(random.Random(number).sample(list(FAULTS.values()), count))


def row(fault: Fault, outcome: Outcome) -> dict[str, Any]:
    """One row as plain data."""
    group = next(name for name, faults in GROUPS.items() if fault in faults)
    return {
        "key": fault.key,
        "group": group,
        "words": fault.words,
        "size": None if math.isinf(outcome.size) else outcome.size,
        "quantity": outcome.quantity,
        "caught": {part: list(checks) for part, checks in outcome.caught.items() if checks},
        "verdict": verdict(fault, outcome),
        "unseen": fault.unseen,
    }


def verdict(fault: Fault, outcome: Outcome) -> str:
    """In a word: caught, missed, only measurement can tell, or no fault (changes nothing by 1 %)."""
    if outcome.first:
        return "caught"
    if fault.unseen:
        return "only measurement can tell"
    return "missed" if outcome.felt else "no effect"


def counts(rows: Iterable[Mapping[str, Any]]) -> dict[str, int]:
    """How many rows have each verdict."""
    return dict(Counter(str(one["verdict"]) for one in rows))


def laws_that_act(rows: Iterable[Mapping[str, Any]]) -> dict[tuple[str, str], int]:
    """Law of nature and model -> how many faults of the rows break it there."""
    found: Counter[tuple[str, str]] = Counter()
    for one in rows:
        checks = [check.removeprefix("twin: ") for names in one["caught"].values() for check in names]
        laws = {check.removeprefix("nature: ") for check in checks if check.startswith("nature: ")}
        split = (law.rsplit(", ", 1) for law in laws)
        found.update({(_AXIS.sub("", law), model) for law, model in split})
    return dict(found)


def _laws(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Section of the Markdown table: how many faults break each law of nature, on each model."""
    found = laws_that_act(rows)
    lines = ["## Laws of nature", "", "Faults that break each law, by the model on which it is checked.", ""]
    lines += ["| law | " + " | ".join(_MODELS) + " |", "|---" * (len(_MODELS) + 1) + "|"]
    for law in sorted({law for law, _ in found}):
        counted = (str(found.get((law, model), "")) for model in _MODELS)
        lines.append(f"| {law.replace('_', ' ')} | {' | '.join(counted)} |")
    return [*lines, ""] if found else []


def markdown(rows: Sequence[Mapping[str, Any]]) -> str:
    """The table in Markdown, one section per group."""
    lines = [", ".join(f"{number} {name}" for name, number in sorted(counts(rows).items())) + ".", ""]
    for group in GROUPS:
        mine = [one for one in rows if one["group"] == group]
        if not mine:
            continue
        lines += [
            f"## {group.capitalize()}",
            "",
            "| fault | change | of | crosscheck | report | first seen by |",
        ]
        lines += ["|---|---|---|---|---|---|"]
        for one in mine:
            size = "not computed" if one["size"] is None else f"{100.0 * one['size']:.3g} %"
            caught = one["caught"]
            seen = _seen(caught) or f"**{one['verdict']}**" + (f": {one['unseen']}" if one["unseen"] else "")
            by_check = "fails" if {"refused", "cross-check"} & caught.keys() else "passes"
            by_report = "fails" if caught else "passes"
            lines.append(
                f"| {one['words']} | {size} | {one['quantity']} | {by_check} | {by_report} | {seen} |"
            )
        lines.append("")
    return "\n".join([*lines, *_laws(rows)]).replace("|mu|", "mu")


def _seen(caught: Mapping[str, Sequence[str]]) -> str:
    for part, checks in caught.items():
        more = f" and {len(checks) - 1} more" if len(checks) > 1 else ""
        return f"{part}: {checks[0]}{more}".replace("|", "/")
    return ""


def save(rows: Sequence[Mapping[str, Any]], target: Path) -> None:
    """Write rows as .json, or as a Markdown table."""
    text = markdown(rows) if target.suffix == ".md" else json.dumps(rows, indent=1, ensure_ascii=False) + "\n"
    target.write_text(text, encoding="utf-8")
