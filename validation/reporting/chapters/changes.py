"""Changes against an earlier report."""

from __future__ import annotations

from validation.reporting.blocks import Badge, Block, Content, Text, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.compare import ERROR_GROWTH, Comparison

_MOST = 500


def changes(comparison: Comparison) -> Chapter:
    """Return the chapter, which no report without a comparison has."""
    return Chapter("changes", "Changes", lambda _: _write(comparison))


def _write(comparison: Comparison) -> Content:
    failed = comparison.regressions
    blocks: list[Block] = [
        Text(
            f"{comparison.compared} values were compared with an earlier report of {comparison.old_name}: "
            f"{len(comparison.changes)} differ, {len(failed)} past their tolerance. Numbers may change by "
            f"{100 * comparison.tolerance:g} %, numbers that measure a numerical error may grow "
            f"{ERROR_GROWTH:g} times, verdicts may not get worse, and nothing may be gone. Texts, new "
            "entries, changed parameters and settings are shown and do not count."
        )
    ]
    if comparison.changes:
        blocks.append(
            table_of(
                "changes",
                "What changed, the worst first.",
                comparison.changes[:_MOST],
                {
                    "path": ("value", lambda c: c.path),
                    "kind": ("kind", lambda c: c.kind),
                    "old": ("before", lambda c: c.old),
                    "new": ("now", lambda c: c.new),
                    "size_percent": ("change [%]", lambda c: None if c.size is None else 100 * c.size),
                    "verdict": ("tolerance", lambda c: Badge("outside" if c.fails else "within")),
                },
                note="" if len(comparison.changes) <= _MOST else f"The first {_MOST} are shown.",
            )
        )
    badge = Badge("violated", "past tolerance") if failed else Badge("ok", "within tolerance")
    return Content(tuple(blocks), badge)
