"""Does the plugin pass right curves, fail wrong ones with the verdict, and load nothing unasked?"""

import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from tests.examples.test_check_in_ci import plugin
from tests.unlike_pairs import unlike_pair
from validation.check import check
from validation.check.ladder import Alternative, Explanation
from validation.check.words import percent
from validation.pytest_plugin import ladder_text

ROOT = Path(__file__).resolve().parents[2]
#: Tests of a reader, one for each fact; the test below says how each must end.
TESTS = """
import sys

import pytest


def test_nothing_is_loaded_before_a_test_asks(request):
    assert request.config.pluginmanager.hasplugin("spurcheck") or "validation.pytest_plugin" in sys.modules
    loaded = {name for name in sys.modules if name.startswith("lumped.")}
    assert loaded <= {"lumped.public_names"} and "numpy" not in sys.modules  # names of a package, no code


def curves(pair, factor=1.0):
    import numpy as np

    import spurcheck

    cycle = spurcheck.predict(pair).cycle
    dte = np.tile(cycle["dte"].to_numpy(), 4)
    return {"time [s]": np.arange(dte.size) * float(cycle["time"][1]), "dte [um]": 1e6 * factor * dte}


@pytest.mark.spurcheck(pair="mine.toml")
def test_right(spurcheck_reference):
    assert spurcheck_reference.limit == 0.05 and spurcheck_reference.options == {}
    assert spurcheck_reference.check(curves(spurcheck_reference.pair)).agrees


@pytest.mark.spurcheck(pair="mine.toml", explain=False)
def test_wrong(spurcheck_reference):
    spurcheck_reference.check(curves(spurcheck_reference.pair, 1.2))


@pytest.mark.spurcheck(pair="mine.toml", explain=False, limit=0.5)
def test_wrong_within_a_wider_limit(spurcheck_reference):
    result = spurcheck_reference.check(curves(spurcheck_reference.pair, 1.2))
    assert result.limit == 0.5 and 0.05 < result.misfit < 0.5


@pytest.mark.spurcheck(pair="mine.toml", phase=0.25, explain=False, limit=0.01)
def test_options_are_those_of_check(spurcheck_reference):
    with pytest.raises(AssertionError, match="Your model differs"):
        spurcheck_reference.check(curves(spurcheck_reference.pair))


def test_without_marker(spurcheck_reference):
    pass


@pytest.mark.spurcheck("mine.toml")
def test_without_keyword(spurcheck_reference):
    pass


@pytest.mark.spurcheck(pair="theirs.toml")
def test_no_such_pair(spurcheck_reference):
    pass
"""
#: Test -> how it ends, and words of its message.
ENDS = {
    "test_nothing_is_loaded_before_a_test_asks": ("PASSED", ()),
    "test_right": ("PASSED", ()),
    "test_wrong": ("FAILED", ("Your model differs: misfit", "limit 5 %. Most in dte", "  dte: misfit ")),
    "test_wrong_within_a_wider_limit": ("PASSED", ()),
    "test_options_are_those_of_check": ("PASSED", ()),
    "test_without_marker": ("ERROR", ('Mark the test: @pytest.mark.spurcheck(pair="mypair.toml").',)),
    "test_without_keyword": ("ERROR", ('Mark the test: @pytest.mark.spurcheck(pair="mypair.toml").',)),
    "test_no_such_pair": ("ERROR", ("theirs.toml",)),
}


@pytest.fixture(scope="module")
def output(tmp_path_factory):
    """Output of a second pytest, started in another folder than that of the tests."""
    start = tmp_path_factory.mktemp("start")
    folder = start / "project" / "tests"
    folder.mkdir(parents=True)
    (folder / "mine.toml").write_text(unlike_pair("rack_25_degrees_always_pushing").to_toml())
    (folder / "test_mine.py").write_text(TESTS)
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-rA", "--strict-markers", *plugin(), "project/tests"],
        cwd=start,
        env=os.environ | {"PYTHONPATH": str(ROOT), "PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    return done.stdout


@pytest.mark.slow
@pytest.mark.parametrize("test", ENDS)
def test_each_ends_as_it_should(output, test):
    end, words = ENDS[test]
    assert f"{end} project/tests/test_mine.py::{test}" in output, output
    assert [word for word in words if word not in output] == []


def test_the_message_has_the_ladder_and_what_is_not_told_apart():
    pair = unlike_pair("rack_25_degrees_always_pushing")
    time = np.linspace(0.0, 4.0 * pair.geometry.mesh_period, 400)
    wave = 1e-6 * np.sin(2.0 * np.pi * time / pair.geometry.mesh_period)
    result = check(pair, {"time [s]": time, "dte [m]": wave}, explain=False)
    width = Alternative("width", 0.85, 0.22, "Width less")
    steps = (
        Explanation("stiffness", 0.85, 0.2, "Stiffness 15 % lower", (width,)),
        Explanation("friction", 0.0, 0.01, "No friction"),
    )
    explained = SimpleNamespace(
        **{name: getattr(result, name) for name in ("words", "problem", "nearer", "remarks")}
    )
    explained.explanations = steps
    explained.ladder = SimpleNamespace(others_alone=(Alternative("density", 1.2, 0.41, "Denser"),))
    lines = ladder_text(explained).splitlines()
    assert lines[0] == result.words
    assert lines[1] == f"  dte: misfit {percent(result.misfit)}"
    assert lines[2:6] == [
        "  1. Stiffness 15 % lower: the misfit is then 20 %",
        "     or: Width less: 22 %",
        "  2. No friction: the misfit is then 1 %",
        "     alone: Denser: 41 %",
    ]
    assert lines[6:] == [f"  {remark}" for remark in result.remarks]
