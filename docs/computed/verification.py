"""Closed forms, laws of mechanics, refinement of every kind of solution."""

from __future__ import annotations

import lumped
from computed.markdown import must_pass, table
from lumped import GearPair
from validation.verification import code_checks, refinements

_SAMPLES = 256


def _pair() -> GearPair:
    return lumped.load_gear_pair("nasa_28_28")


def closed_forms() -> str:
    """Errors against exact values."""
    checks = code_checks(_pair())
    for check in checks:
        must_pass(check.key, check.passes)
    return table(
        ("what is checked", "what it must equal", "error", "limit", "why this limit"),
        [(c.subject, c.exact, c.value, c.limit, c.reason) for c in checks],
    )


def refinement() -> str:
    """Solutions against finer ones."""
    rows = []
    for r in refinements(_pair(), _SAMPLES):
        must_pass(r.key, r.passes)
        for level in r.levels:
            subject, measure = (r.subject, r.measure) if level is r.levels[0] else ("", "")
            rows.append((subject, measure, level.setting + (" (used)" if level.used else ""), level.error))
    return table(("solution", "measure", "level", "error"), rows)


FILES = {
    "closed_forms.md": closed_forms,
    "refinement.md": refinement,
}
