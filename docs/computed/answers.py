"""The table of answers for drawn pairs, as stored by ``python -m tests.evidence.drawn_pairs``."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping
from typing import Any

from computed.markdown import Code, table
from tests.evidence.drawn_pairs import KINDS, stored

#: Numbers of a reason, which differ from pair to pair.
_NUMBER = re.compile(r"\d[\d.e+-]*")


def answers(data: Mapping[str, Any]) -> str:
    """How many pairs have which answer, and the reasons."""
    rows = data["answers"]
    counts = Counter(row["kind"] for row in rows)
    text = f"Seed {data['seed']}, {len(rows)} pairs, {data['processor_seconds']} s of processor time.\n\n"
    text += table(("answer", "pairs"), [(kind, counts[kind]) for kind in KINDS])
    for kind in KINDS:
        mine = [row for row in rows if row["kind"] == kind]
        if not mine:
            continue
        reasons = Counter(_NUMBER.sub("…", row["text"]) for row in mine)
        example = {_NUMBER.sub("…", row["text"]): row for row in reversed(mine)}
        listed = [
            (reason, count, Code(example[reason]["request"])) for reason, count in reasons.most_common()
        ]
        text += f"\n## {kind.capitalize()}\n\n"
        text += table(("motion, field or reason", "pairs", "the first one"), listed)
    return text


FILES = {"answers.md": lambda: answers(stored())}
