"""Stress test: the compiled route on random gear pairs against a reference in extended precision."""

from __future__ import annotations

from collections.abc import Iterator

from floquet.gear.reference import stress_test
from validation.verification.checks import Check, error_check

#: Gear pairs of the test and its seed; more of them by ``python benchmarks/bench_floquet.py``.
COUNT, SEED = 100, 1
_ROUTES = {"fine": "single points", "joined": "dense charts"}


def check_random_gears() -> Iterator[Check]:
    """Worst error of a multiplier, and its ratio to the bound that came with it."""
    found = stress_test(COUNT, SEED)
    for route, use in _ROUTES.items():
        one = found.sel(route=route)
        name = f"{COUNT} random gear pairs, {use}"
        error, excess = float(one["error"].max()), float(one["excess"].max())
        yield error_check(f"{name}: error", "multipliers of the reference", error, 1e-9)
        yield error_check(f"{name}: error over bound", "within the reported bound", excess, 1.0)
