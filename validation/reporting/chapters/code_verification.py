"""Code verification: closed forms, laws of mechanics, orders, computed for this report."""

from __future__ import annotations

from validation.reporting.blocks import Badge, Content, Table, Text
from validation.reporting.chapter import Chapter
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
    table = Table(
        "closed_forms",
        "Errors against exact values; relative where not said otherwise.",
        {
            "key": "check",
            "subject": "what is checked",
            "exact": "what it must equal",
            "value": "error",
            "limit": "limit",
            "verdict": "verdict",
        },
        tuple(
            (
                c.key,
                c.subject,
                c.exact,
                c.value,
                c.limit,
                Badge("within" if c.passes else "outside"),
            )
            for c in checks
        ),
        note="Why these limits: " + "; ".join(f"{c.key}: {c.reason}" for c in checks) + ".",
    )
    order_table = Table(
        "orders",
        "Order of convergence on Mathieu's equation, a = 3, q = 2, over one period; step halved once.",
        {
            "method": "method",
            "theory": "theory",
            "observed": "observed",
            "steps": "coarse steps",
            "error": "error, fine steps",
            "verdict": "verdict",
        },
        tuple(
            (
                o.method,
                o.theory,
                o.observed,
                o.steps,
                o.error,
                Badge("within" if o.passes else "outside"),
            )
            for o in orders
        ),
        note="Within: observed and theory differ by at most 0.3, which leaves room for the next term of the "
        "error series at these coarse steps.",
    )
    badge = Badge("confirmed" if passed == total else "not confirmed")
    return Content((text, table, order_table), badge)


CHAPTER = Chapter("code_verification", "Code verification", write, seconds=2)
