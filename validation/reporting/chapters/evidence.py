"""Evidence about the program, assumptions checked for this pair, versions."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache
from importlib import resources
from typing import Any

from lumped.labelling import provenance, source_hash
from validation.reporting.blocks import Badge, Block, Content, Table, Text, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.facts import facts
from validation.reporting.results import Results, broken_relations, failed_checks


@cache
def stored_evidence() -> Mapping[str, Any]:
    """Figures by kind of evidence, the day and the source of their computation: ``validation/evidence.json``.

    ``kinds`` has key, title and ``checks``, each subject, exact, value, limit and, of an order, theory.
    """
    text = resources.files("validation").joinpath("evidence.json").read_text(encoding="utf-8")
    found: Mapping[str, Any] = json.loads(text)
    return found


def write(results: Results) -> Content:
    """Write the chapter."""
    failed = failed_checks(results)
    blocks: list[Block] = [
        table_of(
            "claims",
            "What page 1 says, and over what it was computed.",
            list(facts(results).values()),
            {
                "claim": ("claim", lambda fact: f"{fact.claim[0].upper()}{fact.claim[1:]}."),
                "scope": ("scope", lambda fact: fact.scope.words),
                "computed_by": ("by", lambda fact: fact.computed_by),
            },
        ),
        table_of(
            "assumptions",
            f"Assumptions of the linear model, checked at the operating point{results.in_place_of_shafts}.",
            results.flags,
            {
                "name": ("assumption", lambda f: f.name),
                "state": ("", lambda f: Badge(f.state)),
                "detail": ("found", lambda f: f.detail),
                "action": ("what to do", lambda f: f.action),
            },
        ),
        Table(
            "relations",
            "Relations between the numbers of this report.",
            {"relation": "", "state": ""},
            tuple((text, Badge("failed")) for text in broken_relations(results))
            or (("all hold", Badge("ok")),),
        ),
    ]
    made = provenance(results.pair)
    blocks += _program(stored_evidence(), source_hash())
    blocks.append(
        Table(
            "made_from",
            "What this report was made from.",
            {"name": "", "value": ""},
            (("versions", str(made["versions"])), ("parameters, SHA-256", str(made["parameters_sha256"]))),
        )
    )
    result = (
        "Every check of the program passes." if not failed else f"{len(failed)} checks of the program fail."
    )
    return Content(result, tuple(blocks))


def _program(evidence: Mapping[str, Any], source: str) -> list[Block]:
    """What is known of the program itself, whatever the pair: one paragraph and one table."""
    rows = []
    for kind in evidence["kinds"]:
        away = [(abs(one["value"] - one.get("theory", 0.0)), one["limit"]) for one in kind["checks"]]
        use = max((error / limit for error, limit in away if limit), default=0.0)
        passed = all(error <= limit for error, limit in away)
        rows.append((kind["title"], len(away), use, Badge("ok" if passed else "failed")))
    same = evidence["source_sha256"] == source
    made = f"Checks of the program itself were computed on {evidence['date']}. "
    made += "They are of this source." if same else "The source has changed since: run “make evidence”."
    faults = evidence["faults"]
    note = (
        f"Of {faults['all']} faults put into the program, {faults.get('missed', 0)} are missed by all checks."
    )
    columns = {"kind": "kind", "checks": "checks", "use": "largest error / limit", "state": ""}
    return [Text(made), Table("evidence", "Evidence about the program.", columns, tuple(rows), note)]


CHAPTER = Chapter("evidence", "Evidence and versions", write, seconds=0.2)
