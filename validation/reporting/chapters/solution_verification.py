"""Solution verification: the numbers of this report against finer steps, tolerances and sampling."""

from __future__ import annotations

from validation.reporting.blocks import Badge, Content, Rows, Table, Text
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results
from validation.verification import Refinement, refinements


def write(results: Results) -> Content | None:
    """Refine the solutions and write the chapter; None in a quick report."""
    if not results.effort.full:
        return None
    results.stage("solution verification")
    return content(refinements(results.pair, results.effort.samples))


def content(studies: tuple[Refinement, ...]) -> Content:
    """Content of the chapter from its refinements."""
    passed = sum(s.passes for s in studies)
    text = Text(
        f"How large is the numerical error of this report's numbers? Every kind of solution was computed "
        f"again at other resolutions: {passed} of {len(studies)} are within their limits. Marked: the "
        "resolution that the report uses."
    )
    rows: Rows = []
    marked: set[int] = set()
    for study in studies:
        for level in study.levels:
            if level.used:
                marked.add(len(rows))
            verdict = Badge("within" if study.passes else "outside") if level.used else None
            limit = study.limit if level.used else None
            rows.append((study.subject, level.setting, level.error, limit, verdict))
    table = Table(
        "refinement",
        "Error at each resolution.",
        {
            "solution": "solution",
            "setting": "resolution",
            "error": "error",
            "limit": "limit",
            "verdict": "verdict",
        },
        tuple(rows),
        marked=frozenset(marked),
    )
    what = Text("Errors and limits:", tuple(f"{s.subject}: {s.measure}; {s.reason}." for s in studies))
    badge = Badge("confirmed" if passed == len(studies) else "not confirmed")
    return Content((text, table, what), badge)


CHAPTER = Chapter("solution_verification", "Solution verification", write, seconds=2)
