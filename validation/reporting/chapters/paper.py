"""Comparison with the paper: figures 2 to 7 and the claims table."""

from __future__ import annotations

import math
from functools import partial
from pathlib import Path

from validation.paper.records import PAPER, ClaimsTable
from validation.reporting.blocks import Badge, Block, Content, Picture, Quantity, Rows, Table, Text, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results


def write(results: Results) -> Content | None:
    """Write the chapter; None where the comparison was not asked for."""
    found = results.paper
    if found is None:
        return None
    if isinstance(found, str):
        return Content((Text(f"Not at the paper's operating points with this gear pair: {found}"),))
    from validation.paper import DRAW  # most reports do without the paper

    table = found.claims
    counted = {
        verdict: sum(c.verdict == verdict for c in table.claims)
        for verdict in ("reproduced", "not reproduced", "cannot be judged")
    }
    words = ", ".join(f"{count} {verdict}" for verdict, count in counted.items())
    blocks: list[Block] = [
        Text(
            f"{PAPER}. Figures 2 to 7 are computed with this gear pair at the paper's speeds, torques and "
            "laws; lumped curves have their multibody twin. As the paper assumes, flanks have no relief and "
            "are in contact from A to D. What the paper does not give (inertia, bearings, roughness, oil) is "
            "this pair's."
        ),
        Text(f"Of {len(table.claims)} claims: {words}. {table.text}"),
        _claims(table),
        _definitions(table),
        Text(
            f"The Latin hypercube has {table.samples} samples (seed {table.seed}, {table.failed} without a "
            f"periodic motion); a share of them has a standard error of at most "
            f"{50.0 / math.sqrt(table.samples):.2g} percentage points. It covers:",
            tuple(f"{name}: {span}" for name, span in table.ranges.items()),
        ),
        _details(table),
    ]
    for record in found.figures:
        blocks.append(
            Picture(
                f"paper_figure{record.number}",
                f"Figure {record.number} of the paper. {record.title}. {record.text}",
                partial(DRAW[record.number], record),
            )
        )
        numbers: Rows = [(name, Quantity(one.value, one.unit or "1")) for name, one in record.numbers.items()]
        blocks.append(
            Table(
                f"figure{record.number}",
                f"Read off figure {record.number}.",
                {"quantity": "quantity", "value": "value"},
                tuple(numbers),
            )
        )

    def write_more(folder: Path) -> None:
        for record in found.figures:
            record.write(folder / "paper")

    return Content(tuple(blocks), write_more=write_more)


def _claims(table: ClaimsTable) -> Table:
    return table_of(
        "claims",
        "The paper's statements as numbers.",
        table.claims,
        {
            "name": ("claim", lambda c: c.name),
            "statement": ("the paper says", lambda c: c.statement),
            "value": ("value", lambda c: c.value),
            "unit": ("unit", lambda c: c.unit if c.unit not in ("", "1") else "–"),
            "criterion": ("reproduced if", lambda c: c.criterion),
            "low": ("5 %", lambda c: c.low),
            "high": ("95 %", lambda c: c.high),
            "share_percent": (
                "met in [%]",
                lambda c: None if c.share is None else float(round(100 * c.share)),
            ),
            "verdict": ("verdict", lambda c: Badge(c.verdict)),
            "reason": ("why, or a remark", lambda c: c.reason or "–"),
        },
        note="5 %, 95 %: percentiles of the number over the samples of the assumptions; met in: share of the "
        "samples in which the criterion holds.",
    )


def _definitions(table: ClaimsTable) -> Table:
    return table_of(
        "claim_definitions",
        "How each number is defined, and in how many samples its motion is stable and in contact.",
        table.claims,
        {
            "name": ("claim", lambda c: c.name),
            "definition": ("number", lambda c: c.definition),
            "usable": ("samples", lambda c: c.usable),
        },
    )


def _details(table: ClaimsTable) -> Table:
    rows: Rows = [
        (claim.name, name, Quantity(one.value, one.unit or "1"))
        for claim in table.claims
        for name, one in claim.details.items()
    ]
    return Table(
        "claim_details",
        "Further numbers behind the claims.",
        {"claim": "claim", "quantity": "quantity", "value": "value"},
        tuple(rows),
    )


CHAPTER = Chapter("paper", "Comparison with the paper", write, seconds=20)
