"""The verification page of the Floquet engine."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path

from computed.markdown import must_pass, table
from floquet import PROPAGATORS, CoulombGearPair, stability_zones
from validation.plots.style import save
from validation.plots.tongues import zones_figure
from validation.reporting.formatting import number
from validation.verification import order_checks
from validation.verification.checks import Check
from validation.verification.closed_forms import (
    check_closed_forms,
    check_forced_motion,
    check_invariants,
    check_random_gears,
)
from validation.verification.combinations import check_gear_chain, check_hsu
from validation.verification.coulomb_zones import MU, check_coulomb_gear_pair, zone_tips


def numbers(*functions: Callable[[], Iterable[Check]]) -> str:
    """Every number of some checks beside what it must be."""
    rows = []
    for check in (check for function in functions for check in function()):
        must_pass(check.subject, check.passes)
        rows.append((check.subject, check.exact, check.value, check.wanted))
    return table(("what is checked", "what it must equal", "error or order", "must be"), rows)


def orders() -> str:
    """Orders of convergence of the propagators."""
    rows = []
    for check in order_checks():
        must_pass(check.method, check.passes)
        title = PROPAGATORS[check.method].title
        rows.append((f"`{check.method}`", title, check.theory, check.observed, check.steps, check.error))
    columns = (
        "name",
        "propagator",
        "order by theory",
        "observed",
        "coarse steps",
        "error with twice as many",
    )
    return table(columns, rows)


def coulomb_tips() -> str:
    """Where the zones of the pair with Coulomb friction close."""
    names = {"none": "no friction", "reversing": "reversing", "constant": "of one sign"}
    rows = [
        (zone, names[case], number(damping, 4), number(ratio, 4))
        for zone, case, damping, ratio in zone_tips()
    ]
    pair = CoulombGearPair(friction=MU)
    angle = math.degrees(pair.pressure_angle)
    head = f"μ = {MU:g}, contact ratio {pair.contact_ratio:g}, pressure angle {angle:g}°:\n\n"
    return head + table(
        ("zone", "friction", "closed by damping ratio", "at mesh over natural frequency"), rows
    )


def coulomb_zones() -> str:
    """Figure of its zones, as SVG."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "zones.svg"
        save(zones_figure(stability_zones(CoulombGearPair(friction=MU))), path)
        return path.read_text(encoding="utf-8")


FILES: dict[str, Callable[[], str]] = {
    "floquet_exact.md": partial(numbers, check_closed_forms, check_forced_motion, check_invariants),
    "orders.md": orders,
    "floquet_combinations.md": partial(numbers, check_hsu, check_gear_chain),
    "floquet_coulomb.md": partial(numbers, check_coulomb_gear_pair),
    "floquet_coulomb_tips.md": coulomb_tips,
    "floquet_coulomb_zones.svg": coulomb_zones,
    "floquet_random_gears.md": partial(numbers, check_random_gears),
}
