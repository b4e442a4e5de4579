"""Evidence about the program, assumptions checked for this pair, versions."""

from __future__ import annotations

import json
from collections.abc import Mapping
from contextlib import suppress
from functools import cache
from importlib import resources
from typing import Any, NamedTuple

from lumped.errors import NumericalError
from lumped.labelling import provenance, source_hash
from validation.reporting.blocks import Badge, Block, Column, Content, Table, Text, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.facts import Fact, facts_of
from validation.reporting.relations import broken_relations, failed_checks
from validation.reporting.results import Results
from validation.validity.flags import Flag


@cache
def stored_evidence() -> Mapping[str, Any]:
    """Return ``validation/evidence.json``: checks of the program by kind, with the day and the source.

    An entry of ``kinds`` has key, title and ``checks``. A check has subject, exact, value and limit; a
    check of an order of convergence also has theory.
    """
    text = resources.files("validation").joinpath("evidence.json").read_text(encoding="utf-8")
    evidence: Mapping[str, Any] = json.loads(text)
    return evidence


def write(results: Results) -> Content:
    """Write the chapter."""
    failed = failed_checks(results)
    blocks: list[Block] = []
    for table in (_claims_table, _assumptions_table, _relations_table):
        with suppress(NumericalError):  # page 1 says what could not be computed
            blocks.append(table(results))
    blocks += [*_program(stored_evidence(), source_hash()), _provenance_table(results)]
    result = (
        "Every check of the program passes." if not failed else f"{len(failed)} checks of the program fail."
    )
    return Content(result, tuple(blocks))


def _claims_table(results: Results) -> Table:
    return table_of(
        "claims",
        "What page 1 says, and over what it was computed.",
        facts_of(results).values(),
        (
            Column[Fact]("claim", "claim", lambda fact: f"{fact.claim[0].upper()}{fact.claim[1:]}."),
            Column[Fact]("scope", "scope", lambda fact: fact.scope.words),
            Column[Fact]("computed_by", "by", lambda fact: fact.computed_by),
        ),
    )


def _assumptions_table(results: Results) -> Table:
    return table_of(
        "assumptions",
        f"Assumptions of the linear model, checked at the operating point{results.in_place_of_shafts}.",
        results.flags,
        (
            Column[Flag]("name", "assumption", lambda flag: flag.name),
            Column[Flag]("state", "", lambda flag: Badge(flag.state)),
            Column[Flag]("detail", "found", lambda flag: flag.detail),
            Column[Flag]("action", "what to do", lambda flag: flag.action),
        ),
    )


class _Relation(NamedTuple):
    """A row of the table of relations: the sentence and its badge."""

    words: str
    state: str


def _relations_table(results: Results) -> Table:
    broken = [_Relation(words, "failed") for words in broken_relations(results)]
    return table_of(
        "relations",
        "Relations between the numbers of this report.",
        broken or [_Relation("all hold", "ok")],
        (
            Column[_Relation]("relation", "", lambda relation: relation.words),
            Column[_Relation]("state", "", lambda relation: Badge(relation.state)),
        ),
    )


class _Origin(NamedTuple):
    """A row of the table of the origin of the report."""

    name: str
    value: str


def _provenance_table(results: Results) -> Table:
    origin = provenance(results.pair)
    return table_of(
        "made_from",
        "What this report was made from.",
        (
            _Origin("versions", str(origin["versions"])),
            _Origin("parameters, SHA-256", str(origin["parameters_sha256"])),
        ),
        (
            Column[_Origin]("name", "", lambda row: row.name),
            Column[_Origin]("value", "", lambda row: row.value),
        ),
    )


class _Kind(NamedTuple):
    """A row of the table of evidence: a kind of check of the program.

    Attributes
    ----------
    title : name of the kind
    checks : number of checks
    use : largest error of a check, as a share of the limit of the check
    passed : every error is within its limit
    """

    title: str
    checks: int
    use: float
    passed: bool


def _kind(kind: Mapping[str, Any]) -> _Kind:
    """Row of an entry of ``kinds`` of the stored evidence."""
    errors = [abs(check["value"] - check.get("theory", 0.0)) for check in kind["checks"]]
    limits = [check["limit"] for check in kind["checks"]]
    use = max((error / limit for error, limit in zip(errors, limits, strict=True) if limit), default=0.0)
    passed = all(error <= limit for error, limit in zip(errors, limits, strict=True))
    return _Kind(kind["title"], len(errors), use, passed)


def _program(evidence: Mapping[str, Any], source: str) -> tuple[Block, ...]:
    """Paragraph and table on the program itself, the same for all pairs. ``source``: hash of the source."""
    same = evidence["source_sha256"] == source
    made = f"Checks of the program itself were computed on {evidence['date']}. "
    made += (
        "They were made with this version." if same else "The source has changed since: run “make evidence”."
    )
    faults = evidence["faults"]
    note = (
        f"Of {faults['all']} faults put into the program, {faults.get('missed', 0)} are missed by all checks."
    )
    table = table_of(
        "evidence",
        "Evidence about the program.",
        [_kind(kind) for kind in evidence["kinds"]],
        (
            Column[_Kind]("kind", "kind", lambda kind: kind.title),
            Column[_Kind]("checks", "checks", lambda kind: kind.checks),
            Column[_Kind]("use", "largest error / limit", lambda kind: kind.use),
            Column[_Kind]("state", "", lambda kind: Badge("ok" if kind.passed else "failed")),
        ),
        note,
    )
    return Text(made), table


CHAPTER = Chapter("evidence", "Evidence and versions", write, seconds=0.2, needs_motion=False)
