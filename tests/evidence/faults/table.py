"""The table of faults: its rows, and what can be counted in them."""

import hashlib
import json
import math
import random
import re
from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from tests.evidence.faults.fault import FAULTS, GROUPS, Fault
from tests.evidence.faults.outcome import Outcome

#: What ends the name of a law that is checked for each axis or bearing.
_AXIS = re.compile(r" [xy](_[pg])?$")


def sample(count: int, seed: str) -> tuple[Fault, ...]:
    """Some of the faults, chosen by a text such as a commit's name."""
    number = int.from_bytes(hashlib.sha256(seed.encode()).digest()[:8], "big")
    return tuple(random.Random(number).sample(list(FAULTS.values()), count))


def row(fault: Fault, outcome: Outcome) -> dict[str, Any]:
    """One row as plain data."""
    group = next(name for name, faults in GROUPS.items() if fault in faults)
    return {
        "key": fault.key, "group": group, "words": fault.words,
        "size": None if math.isinf(outcome.size) else outcome.size, "quantity": outcome.quantity,
        "caught": {part: list(checks) for part, checks in outcome.caught.items() if checks},
        "verdict": verdict(fault, outcome), "unseen": fault.unseen,
    }  # fmt: skip


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
    """Conservation law and model -> how many faults of the rows break it there."""
    found: Counter[tuple[str, str]] = Counter()
    for one in rows:
        checks = [check.removeprefix("variant: ") for names in one["caught"].values() for check in names]
        laws = {one.removeprefix("conservation: ") for one in checks if one.startswith("conservation: ")}
        split = (law.rsplit(", ", 1) for law in laws)
        found.update({(_AXIS.sub("", law), model) for law, model in split})
    return dict(found)


def stored(source: Path | None) -> dict[str, Any]:
    """Rows of a file by their keys, of faults that exist; none without a file."""
    if source is None or not source.exists():
        return {}
    rows = json.loads(source.read_text(encoding="utf-8"))
    return {one["key"]: one for one in rows if one["key"] in FAULTS}


def save(rows: Mapping[str, Any], target: Path) -> None:
    """Write rows as JSON, in the order of the catalogue."""
    ordered = [rows[key] for key in FAULTS if key in rows]
    target.write_text(json.dumps(ordered, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
