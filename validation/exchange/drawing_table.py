"""The table of a pair beside its drawing: what gear programs print, and what of it is assumed."""

from __future__ import annotations

from lumped.gear_geometry.measures import TableRow, gear_table
from lumped.schema.assumed import State
from lumped.schema.pair import GearPair

#: Headings of the rows.
HEADINGS = ("quantity", "symbol", "unit", "pinion", "gear", "assumed")


def drawing_rows(pair: GearPair) -> list[tuple[str, ...]]:
    """Return the rows of a pair's table as text, in the order of a drawing.

    Returns
    -------
    rows of `HEADINGS`: quantity, symbol, unit, value of the pinion or of the pair, value of the gear or "",
    and whose deciding field is assumed: "both", "pinion", "gear"; "yes" for a value of the pair; or ""
    """
    return [
        (row.label, row.symbol, row.unit, *(*row.texts(), "")[:2], _assumed(pair, row))
        for row in gear_table(pair).rows()
    ]


def _assumed(pair: GearPair, row: TableRow) -> str:
    assumed = [path for path in row.decided_by if pair.state(path) is State.ASSUMED]
    if len(assumed) == 2:
        return "both"
    if not assumed:
        return ""
    return assumed[0].partition(".")[0] if len(row.values) == 2 else "yes"
