"""The multibody model checked against values that do not come from its comparison with the lumped model."""

from __future__ import annotations

from validation.reporting.blocks import Badge, Block, Content, Text, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.checks import check_table
from validation.reporting.results import Results
from validation.verification.reference_model import ReferenceModel


def write(results: Results) -> Content:
    """Write the chapter."""
    found = results.reference
    passed = sum(check.passes for check in found.checks)
    blocks: list[Block] = [
        Text(
            "The multibody model judges the lumped model in the next chapter. Here the multibody model is "
            "checked itself, by evidence that does not come from comparing the two: "
            f"{passed} of {len(found.checks)} checks pass."
        ),
        check_table("checks", "The multibody model against other evidence.", found.checks),
        _published(found),
    ]
    return Content(tuple(blocks), Badge("confirmed" if found.passes else "not confirmed"))


def _published(found: ReferenceModel) -> Block:
    return table_of(
        "published",
        "Published formulas at published numbers, or at numbers worked out by hand, on this installation.",
        found.published,
        {
            "formula": ("formula", lambda v: v.formula),
            "published": ("stated", lambda v: v.published),
            "lumped": ("lumped", lambda v: v.lumped),
            "multibody": ("multibody", lambda v: v.multibody),
            "verdict": ("verdict", lambda v: Badge("within" if v.passes else "outside")),
        },
        note="Arguments are in the units of the publication. Within: both models meet the digits stated. "
        "An empty cell: the multibody model does not use this formula by itself.",
    )


CHAPTER = Chapter("reference_model", "The multibody model checked", write, seconds=0.5)
