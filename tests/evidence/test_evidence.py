"""Does every number of the evidence keep its limit, and is a changed source noticed?"""

import json
import math

import pytest

from tests.evidence.__main__ import main
from tests.evidence.check import Check, failing
from tests.evidence.kinds import KINDS, OF_PAIRS, TARGET
from tests.evidence.pairs import gear_pairs
from validation.reporting.chapters import evidence


@pytest.mark.parametrize("number", range(3), ids=["default", "asymmetric", "loaded"])
@pytest.mark.parametrize("kind", OF_PAIRS)
def test_every_number_of_a_pair_keeps_its_limit(kind, number):
    checks = list(OF_PAIRS[kind][1](gear_pairs()[number]))
    assert checks
    assert failing(checks) == []


def test_loaded_contact_has_checks_of_its_own():
    subjects = {check.subject for check in OF_PAIRS["written_twice"][1](gear_pairs()[2])}
    assert {"softening of a pair by load, Hertz", "motion by the load of a neighbour"} <= subjects


def test_what_is_no_number_fails():
    assert not Check("s", "e", math.nan, 1.0).passes
    assert not Check("s", "e", 1.0, 0.3, theory=2.0).passes


def test_the_stored_figures_have_every_kind_and_pass():
    found = json.loads(TARGET.read_text(encoding="utf-8"))
    assert found.keys() == {"date", "source_sha256", "kinds", "faults", "sound_pairs"}
    assert [kind["key"] for kind in found["kinds"]] == list(KINDS)
    checks = [Check(**row) for kind in found["kinds"] for row in kind["checks"]]
    assert len(checks) > 60
    assert failing(checks) == []
    assert TARGET.stat().st_size < 20_000


def test_the_command_prints_a_kind_and_refuses_what_is_none(capsys):
    assert main(["orders"]) == 0
    assert "propagator gauss" in capsys.readouterr().out
    with pytest.raises(SystemExit):
        main(["orderz"])


def test_a_changed_source_is_noticed(tmp_path, monkeypatch):
    roots = {}
    for package in evidence._OWN:
        roots[package] = tmp_path / package
        roots[package].mkdir()
        (roots[package] / "a.py").write_text("x = 1")
    monkeypatch.setattr(evidence.resources, "files", lambda name: roots[name])
    first = evidence.source_hash.__wrapped__()
    assert len(first) == 64
    assert evidence.source_hash.__wrapped__() == first
    for package in evidence._OWN:
        (roots[package] / "a.py").write_text("x = 2")
        assert evidence.source_hash.__wrapped__() != first
        (roots[package] / "a.py").write_text("x = 1")
    (roots["lumped"] / "a.py").rename(roots["lumped"] / "b.py")
    assert evidence.source_hash.__wrapped__() != first
