"""The errata of the paper, each shown by computation."""

from __future__ import annotations

import lumped
from computed.markdown import Cell, greek, table, text
from reproductions.he_cho_singh_2008.errata.catalogue import errata_chapter


def _value(value: float | str, unit: str) -> Cell:
    return value if isinstance(value, str) or not unit or unit == "1" else f"{text(value)} {unit}"


def chapter() -> str:
    """Summary table, then one section per equation."""
    found = errata_chapter(lumped.load_gear_pair("nasa_28_28"))
    conditions = "; ".join(f"{name}: {value}" for name, value in found.conditions.items())
    parts = [
        f"{found.text}\n\nConditions: {conditions}.\n",
        table(
            ("equation", "printed", "repaired", "verdict"),
            [(e.equation, e.printed, e.repaired, e.verdict) for e in found.errata],
        ),
    ]
    for e in found.errata:
        rows = [
            (v.quantity, _value(v.printed, v.unit), _value(v.repaired, v.unit), v.requirement)
            for v in e.evidence
        ]
        parts += [
            f"## Equation {e.equation}\n\n{text(e.text)}\n",
            table(("computed", "as printed", "as repaired", "what must hold"), rows),
        ]
    return greek("\n".join(parts))


FILES = {"errata.md": chapter}
