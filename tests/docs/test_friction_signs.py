"""The table of wrong signs of friction in docs/verification/faults.md says what the stored faults say."""

import json
import re
from pathlib import Path

import pytest

_FOLDER = Path(__file__).parents[2] / "docs" / "verification"
_ROW = re.compile(r"^\| `(\w+)` \|.*\| ([^|]+) \|$", re.MULTILINE)
_PAGE = (_FOLDER / "faults.md").read_text(encoding="utf-8")
SECTION = _PAGE.split("## A wrong sign of friction")[1].split("\n## ")[0]
ROWS = _ROW.findall(SECTION)
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
