"""The table of wrong signs of friction in docs/verification/faults.md says what the faults do."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

import floquet
import lumped
from lumped.losses import quasi_static_losses
from tests.evidence.faults.fault import FAULTS
from tests.evidence.faults.rewriting import applied
from tests.unlike_pairs import unlike_pair

_FOLDER = Path(__file__).parents[2] / "docs" / "verification"
_ROW = re.compile(r"^\| `(\w+)` \|.*\| ([^|]+) \|$", re.MULTILINE)
_CHANGES = re.compile(r"^\| `(\w+)` \|.*\| ([^|]+) \| [^|]+ \|$", re.MULTILINE)
_PAGE = (_FOLDER / "faults.md").read_text(encoding="utf-8")
SECTION = _PAGE.split("## A wrong sign of friction")[1].split("\n## ")[0]
ROWS = _ROW.findall(SECTION)
CHANGES = {fault: set(changes.split(", ")) for fault, changes in _CHANGES.findall(SECTION)}
#: Faults in functions that numba does not compile: to put one in takes no time.
PLAIN = ("friction_reversed", "law_i_sign", *(f"eq{n}_friction" for n in (1, 2, 8, 9)), "block_friction")
#: Largest change of a value, over the largest value, that is rounding. The smallest of the table is 1e-3.
ROUNDING = 1e-9
STORED = {row["key"]: row for row in json.loads((_FOLDER / "faults.json").read_text(encoding="utf-8"))}


def test_the_table_has_rows():
    assert len(ROWS) == SECTION.count("\n| `") >= 10


@pytest.mark.parametrize(("fault", "seen_by"), ROWS, ids=[fault for fault, _ in ROWS])
def test_what_sees_a_wrong_sign_is_what_the_stored_fault_says(fault, seen_by):
    checks = [check for part in STORED[fault]["caught"].values() for check in part]
    for name in re.sub(r" \(.*?\)", "", seen_by).split("; "):
        assert any(name in check for check in checks), f"faults.json: no check of {fault} is called {name!r}"


@pytest.mark.parametrize("fault", [fault for fault, seen_by in ROWS if seen_by != "differs"])
def test_a_comparison_of_motions_alone_does_not_stand_for_a_check_of_the_program(fault):
    checks = [check for part in STORED[fault]["caught"].values() for check in part]
    assert any(not check.startswith(("differs", "variant: differs")) for check in checks)


def _results():
    """The results of the lumped model and of stability that the column "changes" names."""
    pair = unlike_pair("larger_gear_drives_contact_lost").with_(
        friction={"law": "coulomb", "coefficient": 0.08}
    )
    coordinates = ("theta_p", "theta_g", "x_p", "y_p", "x_g", "y_g")
    motions = {
        f"{contact} motion": lumped.steady_state(pair, contact=contact, supports="springs")
        for contact in ("linear", "unilateral")
    }
    results = {
        name: np.concatenate([motion[one].to_numpy() for one in coordinates])
        for name, motion in motions.items()
    }
    losses = quasi_static_losses(pair)
    results["quasi-static losses"] = np.array([losses.mesh_efficiency])
    results["charts"] = floquet.gear_pair_multipliers(pair).multipliers
    return results


@pytest.fixture(scope="module")
def right():
    return _results()


@pytest.mark.parametrize("key", PLAIN)
def test_a_wrong_sign_changes_what_the_table_says_and_nothing_else(key, right):
    with applied(FAULTS[key]):
        wrong = _results()
    moved = {
        name: float(np.abs(wrong[name] - value).max() / np.abs(value).max()) for name, value in right.items()
    }
    assert {name for name, change in moved.items() if change > ROUNDING} == CHANGES[key], moved
