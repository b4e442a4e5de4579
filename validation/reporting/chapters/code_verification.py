"""Code verification: closed forms, laws of mechanics, orders, computed for this report."""

from __future__ import annotations

from validation.reporting.blocks import Badge, Content, Text, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.checks import check_table
from validation.reporting.results import Results
from validation.verification import Check, OrderCheck, code_checks, order_checks


def write(results: Results) -> Content | None:
    """Check the code and write the chapter; None in a quick report."""
    if not results.effort.full:
        return None
    results.stage("code verification")
    return content(code_checks(results.pair), order_checks())


def content(checks: tuple[Check, ...], orders: tuple[OrderCheck, ...]) -> Content:
    """Content of the chapter from its checks."""
    passed = sum(c.passes for c in checks) + sum(o.passes for o in orders)
    total = len(checks) + len(orders)
    text = Text(
        f"Is the mathematics solved as stated? {passed} of {total} checks pass. Each was computed for this "
        "report, with this installation: a formula against its published or closed-form value, a model "
        "against a law of mechanics, a method against its order of convergence."
    )
    table = check_table(
        "closed_forms", "Errors against exact values; relative where not said otherwise.", checks
    )
    order_table = table_of(
        "orders",
        "Order of convergence on Mathieu's equation, a = 3, q = 2, over one period; step halved once.",
        orders,
        {
            "method": ("method", lambda o: o.method),
            "theory": ("theory", lambda o: o.theory),
            "observed": ("observed", lambda o: o.observed),
            "steps": ("coarse steps", lambda o: o.steps),
            "error": ("error, fine steps", lambda o: o.error),
            "verdict": ("verdict", lambda o: Badge("within" if o.passes else "outside")),
        },
        note="Within: observed and theory differ by at most 0.3, which leaves room for the next term of the "
        "error series at these coarse steps.",
    )
    badge = Badge("confirmed" if passed == total else "not confirmed")
    return Content((text, table, order_table), badge)


CHAPTER = Chapter("code_verification", "Code verification", write, seconds=2)
