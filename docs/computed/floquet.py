"""The verification page of the Floquet engine."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial

from computed.markdown import must_pass, table
from tests.evidence.check import Check
from tests.evidence.floquet.closed_forms import (
    check_closed_forms,
    check_forced_motion,
    check_invariants,
    check_orders,
    check_random_gears,
)
from tests.evidence.floquet.combinations import check_gear_chain, check_hsu
from tests.evidence.floquet.coulomb_zones import check_coulomb_gear_pair


def numbers(*functions: Callable[[], Iterable[Check]]) -> str:
    """Every number of some checks beside what it must be."""
    rows = []
    for check in (check for function in functions for check in function()):
        must_pass(check.subject, check.passes)
        rows.append((check.subject, check.exact, check.value, check.limit))
    return table(
        (
            "what is checked",
            "what it must equal",
            "error or order",
            "largest error, or distance from the order",
        ),
        rows,
    )


FILES: dict[str, Callable[[], str]] = {
    "floquet_exact.md": partial(numbers, check_closed_forms, check_forced_motion, check_invariants),
    "orders.md": partial(numbers, check_orders),
    "floquet_combinations.md": partial(numbers, check_hsu, check_gear_chain),
    "floquet_coulomb.md": partial(numbers, check_coulomb_gear_pair),
    "floquet_random_gears.md": partial(numbers, check_random_gears),
}
