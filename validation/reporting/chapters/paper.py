"""Comparison with the paper: figures 2 to 7 and the claims table."""

from __future__ import annotations

from functools import partial

from validation.paper import DRAW, PAPER
from validation.reporting.blocks import Badge, Block, Cell, Chapter, Column, Picture, Table, Text
from validation.reporting.results import Results


def paper(results: Results) -> Chapter | None:
    """Write the chapter; None where the comparison was not asked for."""
    title = "Comparison with the paper"
    if results.paper_refusal:
        text = f"Not at the paper's operating points with this gear pair: {results.paper_refusal}"
        return Chapter("paper", title, (Text(text),))
    if results.paper is None:
        return None
    table = results.paper.claims
    counted = {
        verdict: sum(c.verdict == verdict for c in table.claims)
        for verdict in ("reproduced", "not reproduced", "cannot be judged")
    }
    words = ", ".join(f"{count} {verdict}" for verdict, count in counted.items())
    blocks: list[Block] = [
        Text(
            f"{PAPER}. Figures 2 to 7 are computed with this gear pair at the paper's speeds, torques and "
            "laws; lumped curves have their multibody twin. What the paper does not give (inertia, bearings, "
            "roughness, oil) is this pair's."
        ),
        Text(f"Of {len(table.claims)} claims: {words}. {table.text}"),
        _claims(results),
        Text(
            "What each outcome means:",
            tuple(f"{claim.name}: {claim.text}" for claim in table.claims),
        ),
        Text(
            f"The Latin hypercube has {table.samples} samples (seed {table.seed}, {table.failed} without a "
            "periodic motion) over:",
            tuple(f"{name}: {span}" for name, span in table.ranges.items()),
        ),
        _details(results),
    ]
    for record in results.paper.figures:
        blocks.append(
            Picture(
                f"paper_figure{record.number}",
                f"Figure {record.number} of the paper. {record.title}. {record.text}",
                partial(DRAW[record.number], record),
            )
        )
        numbers: list[tuple[Cell, ...]] = [(name, value) for name, value in record.numbers.items()]
        blocks.append(
            Table(
                f"figure{record.number}",
                f"Read off figure {record.number}.",
                (Column("quantity", "quantity"), Column("value", "value")),
                tuple(numbers),
            )
        )
    return Chapter("paper", title, tuple(blocks))


def _claims(results: Results) -> Table:
    assert results.paper is not None
    rows: list[tuple[Cell, ...]] = [
        (
            c.name,
            c.statement,
            c.definition,
            c.value,
            c.unit if c.unit not in ("", "1") else "–",
            c.criterion,
            c.low,
            c.high,
            None if c.share is None else 100 * c.share,
            Badge(c.verdict),
        )
        for c in results.paper.claims.claims
    ]
    return Table(
        "claims",
        "The paper's statements as numbers.",
        (
            Column("name", "claim"),
            Column("statement", "the paper says"),
            Column("definition", "number"),
            Column("value", "value"),
            Column("unit", "unit"),
            Column("criterion", "reproduced if"),
            Column("low", "5 %"),
            Column("high", "95 %"),
            Column("share_percent", "met in [%]"),
            Column("verdict", "verdict"),
        ),
        tuple(rows),
        note="5 %, 95 %: percentiles of the number over the samples of the assumptions; met in: share of the "
        "samples in which the criterion holds.",
    )


def _details(results: Results) -> Table:
    assert results.paper is not None
    rows: list[tuple[Cell, ...]] = [
        (claim.name, name, value)
        for claim in results.paper.claims.claims
        for name, value in claim.details.items()
    ]
    return Table(
        "claim_details",
        "Further numbers behind the claims.",
        (Column("claim", "claim"), Column("quantity", "quantity"), Column("value", "value")),
        tuple(rows),
    )
