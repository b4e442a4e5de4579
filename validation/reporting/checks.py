"""Checks of the verification as a table of the report."""

from __future__ import annotations

from collections.abc import Sequence

from validation.reporting.blocks import Badge, Table, table_of
from validation.verification import Check


def check_table(key: str, caption: str, checks: Sequence[Check]) -> Table:
    """One row a check, with its error, its limit and its verdict.

    key, caption: of the table; ``checks``: computed errors with their limits.
    """
    return table_of(
        key,
        caption,
        checks,
        {
            "key": ("check", lambda c: c.key),
            "subject": ("what is checked", lambda c: c.subject),
            "exact": ("what it must equal", lambda c: c.exact),
            "value": ("error", lambda c: c.value),
            "limit": ("limit", lambda c: c.limit),
            "verdict": ("verdict", lambda c: Badge("within" if c.passes else "outside")),
        },
        note="Why these limits: " + "; ".join(f"{c.key}: {c.reason}" for c in checks) + ".",
    )
