"""The table of faults and the sound pairs, as stored by ``python -m validation.faults``."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from validation.faults.sound import summary
from validation.faults.table import markdown

FOLDER = Path(__file__).resolve().parents[1] / "verification"


def rows(name: str) -> list[dict[str, Any]]:
    """Rows of a stored table."""
    found: list[dict[str, Any]] = json.loads((FOLDER / name).read_text(encoding="utf-8"))
    return found


FILES = {
    "faults.md": lambda: markdown(rows("faults.json")),
    "sound_pairs.md": lambda: summary(rows("sound_pairs.json")),
}
