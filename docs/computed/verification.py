"""Evidence about the program as stored by ``make evidence``, and this pair's solutions against finer ones."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import lumped
from computed.markdown import must_pass, table
from tests.evidence.refinement import refinements
from validation.reporting.chapters.evidence import stored_evidence

#: File -> kinds of evidence.
_PARTS = {
    "evidence_formulas.md": ("published", "written_twice", "elasticity"),
    "evidence_mechanics.md": ("mechanics", "multibody"),
    "evidence_stability.md": ("stability",),
    "floquet_exact.md": ("floquet",),
    "orders.md": ("orders",),
    "floquet_combinations.md": ("combinations",),
    "floquet_coulomb.md": ("coulomb",),
    "floquet_random_gears.md": ("random_gears",),
}
_SAMPLES = 256


def evidence(*keys: str) -> str:
    """Every number of some kinds beside what it must be."""
    rows = []
    for kind in stored_evidence()["kinds"]:
        for one in kind["checks"] if kind["key"] in keys else ():
            must_pass(one["subject"], abs(one["value"] - one.get("theory", 0.0)) <= one["limit"])
            rows.append((one["subject"], one["exact"], float(one["value"]), float(one["limit"])))
    return table(("what is checked", "what it must equal", "error or order", "limit"), rows)


def day() -> str:
    """When the evidence was computed, and of which source."""
    found = stored_evidence()
    return f"Computed on {found['date']}; SHA-256 of the source: `{found['source_sha256'][:16]}…`.\n"


def refinement() -> str:
    """Solutions against finer ones."""
    rows = []
    for r in refinements(lumped.load_gear_pair("nasa_28_28"), _SAMPLES):
        must_pass(r.key, r.passes)
        for level in r.levels:
            subject, measure = (r.subject, r.measure) if level is r.levels[0] else ("", "")
            rows.append((subject, measure, level.setting + (" (used)" if level.used else ""), level.error))
    return table(("solution", "measure", "level", "error"), rows)


FILES: dict[str, Callable[[], str]] = {
    **{name: partial(evidence, *keys) for name, keys in _PARTS.items()},
    "evidence_day.md": day,
    "refinement.md": refinement,
}
