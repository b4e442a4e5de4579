"""Table of a pair for comparison with its drawing: the quantities that gear programs print."""

from __future__ import annotations

from lumped.gear_geometry.measures import TableRow, gear_table
from lumped.schema.assumed import State
from lumped.schema.pair import GearPair

#: Headings of the rows.
HEADINGS = ("quantity", "symbol", "unit", "pinion", "gear", "assumed")


def drawing_rows(pair: GearPair) -> list[tuple[str, ...]]:
    """Return the table of a pair as rows of text, in the order of a drawing.

    Returns
    -------
    rows with the columns `HEADINGS`. Column "pinion": value of the pinion or of the pair. Column "gear":
    value of the gear, "" for a value of the pair. Column "assumed": the gear whose deciding field is assumed
    ("both", "pinion", "gear"); "yes" if a value of the pair is assumed; "" if nothing is assumed
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
