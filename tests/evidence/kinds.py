"""Every kind of evidence about the program: its title, and what computes its checks."""

import json
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

from lumped import GearPair
from lumped.labelling import source_hash
from tests.evidence.check import Check
from tests.evidence.elasticity import elasticity
from tests.evidence.floquet.closed_forms import (
    check_closed_forms,
    check_gear_chain,
    check_hsu,
    check_invariants,
    check_orders,
    check_random_gears,
)
from tests.evidence.floquet.coulomb_zones import check_coulomb_gear_pair
from tests.evidence.mechanics import mechanics
from tests.evidence.pairs import gear_pairs
from tests.evidence.published import published
from tests.evidence.reference_model.checks import reference_model
from tests.evidence.stability_routes import stability_routes
from tests.evidence.written_twice import written_twice

ROOT = Path(__file__).parents[2]
TARGET = ROOT / "validation" / "evidence.json"


#: Evidence that is computed for a gear pair.
OF_PAIRS: Mapping[str, tuple[str, Callable[[GearPair], Iterable[Check]]]] = {
    "published": ("published formulas and values", published),
    "written_twice": ("what both models work out from the drawing", written_twice),
    "mechanics": ("laws of mechanics, and hand calculation", mechanics),
    "elasticity": ("plane elasticity of the teeth, and ISO 6336-1", elasticity),
    "stability": ("multipliers by the multibody model's flow map", stability_routes),
}


def worst(compute: Callable[[GearPair], Iterable[Check]]) -> list[Check]:
    """Checks of a kind on all gear pairs, each where it uses most of its limit."""
    worst_checks: dict[str, Check] = {}
    for pair in gear_pairs():
        for check in compute(pair):
            earlier = worst_checks.get(check.subject)
            if earlier is None or use(check) > use(earlier):
                worst_checks[check.subject] = check
    return list(worst_checks.values())


def use(check: Check) -> float:
    """Share of its limit; infinite where the check does not pass a limit of zero."""
    difference = abs(check.value - (check.theory or 0.0))
    return difference / check.limit if check.limit else float("inf") if difference else 0.0


def joined(*functions: Callable[[], Iterable[Check]]) -> list[Check]:
    """Checks of several functions."""
    return [check for function in functions for check in function()]


#: Key -> title, and what computes the checks.
KINDS: Mapping[str, tuple[str, Callable[[], Iterable[Check]]]] = {
    **{key: (title, partial(worst, compute)) for key, (title, compute) in OF_PAIRS.items()},
    "multibody": ("the multibody model by other means", reference_model),
    "floquet": (
        "the Floquet engine against closed forms and invariants",
        partial(joined, check_closed_forms, check_invariants),
    ),
    "orders": ("orders of convergence of the propagators", check_orders),
    "combinations": ("combination resonances", partial(joined, check_hsu, check_gear_chain)),
    "coulomb": ("one degree of freedom with Coulomb friction", check_coulomb_gear_pair),
    "random_gears": ("compiled multipliers of random gear pairs", check_random_gears),
}


def figures(keys: Iterable[str] = tuple(KINDS)) -> dict[str, Any]:
    """The evidence as plain data: what ``validation/evidence.json`` holds."""
    return {
        "date": datetime.now(UTC).date().isoformat(),
        "source_sha256": source_hash(),
        "kinds": [
            {"key": key, "title": KINDS[key][0], "checks": [_row(check) for check in KINDS[key][1]()]}
            for key in keys
        ],
        "faults": _faults(),
        "sound_pairs": _sound_pairs(),
    }


def _row(check: Check) -> dict[str, Any]:
    row = {"subject": check.subject, "exact": check.exact}
    numbers = {"value": float(f"{check.value:.3g}"), "limit": check.limit, "theory": check.theory}
    return row | {name: value for name, value in numbers.items() if value is not None}


def _stored(name: str) -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = json.loads((ROOT / "docs" / "verification" / name).read_text("utf-8"))
    return rows


def _faults() -> dict[str, int]:
    """Number of faults in the stored table, by the first part of program or tests that sees the fault."""
    rows = _stored("faults.json")
    seen = Counter(next(iter(row["caught"]), row["verdict"]) for row in rows)
    return {"all": len(rows), **dict(sorted(seen.items()))}


def _sound_pairs() -> dict[str, int]:
    return dict(Counter(row["verdict"] for row in _stored("sound_pairs.json")))
