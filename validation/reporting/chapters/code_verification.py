"""Code verification: closed forms and laws of mechanics, computed for this report."""

from __future__ import annotations

from validation.reporting.blocks import Badge, Content, Text
from validation.reporting.chapter import Chapter
from validation.reporting.checks import check_table
from validation.reporting.results import Results
from validation.verification import Check, code_checks


def write(results: Results) -> Content | None:
    """Check the code and write the chapter; None in a quick report."""
    if not results.effort.full:
        return None
    results.stage("code verification")
    return content(code_checks(results.pair))


def content(checks: tuple[Check, ...]) -> Content:
    """Content of the chapter from its checks."""
    passed, total = sum(c.passes for c in checks), len(checks)
    text = Text(
        f"Is the mathematics solved as stated? {passed} of {total} checks pass. Each was computed for this "
        "report, with this installation: a formula against its published or closed-form value, a model "
        "against a law of mechanics."
    )
    table = check_table(
        "closed_forms", "Errors against exact values; relative where not said otherwise.", checks
    )
    badge = Badge("confirmed" if passed == total else "not confirmed")
    return Content((text, table), badge)


CHAPTER = Chapter("code_verification", "Code verification", write, seconds=2)
