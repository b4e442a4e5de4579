"""Has every drawn pair a prediction or a stated reason, and is the stored run the one of this draw?"""

import dataclasses
import math

import numpy as np
import pytest

import validation.prediction.motion as prediction_module
from tests.evidence.drawn_pairs import KINDS, PAIRS, SEED, Request, answer, main, requests, stored


def test_the_stored_run_is_the_draw_and_has_no_exception():
    rows = stored()["answers"]
    assert [row["request"] for row in rows] == [one.text for one in requests()]
    assert len(rows) == PAIRS
    assert stored()["seed"] == SEED
    assert {row["kind"] for row in rows} <= set(KINDS) - {"exception"}
    assert all(row["text"] for row in rows)


@pytest.mark.parametrize("number", [0, 3, 5, 17, 26, 27, 999])
def test_a_drawn_pair_has_the_stored_answer(number):
    """One of each kind that takes little time: predictions, refused bearings, no contact ratio."""
    request = list(requests(number + 1))[number]
    row = stored()["answers"][number]
    found = answer(request)
    assert (found.kind, found.text, found.request) == (row["kind"], row["text"], row["request"])


def test_a_request_depends_on_its_number_alone():
    assert list(requests(30))[20:] == list(requests(40))[20:30]
    assert list(requests(5, seed=1))[1:] != list(requests(5, seed=2))[1:]


REQUEST = Request((19, 41), 2.5, 20, 1450, 80, {"mesh.stiffness.model": "energy"})


@pytest.mark.parametrize("value", [math.nan, math.inf, 0.99])
def test_a_prediction_that_contradicts_itself_is_an_exception(monkeypatch, value):
    assert answer(REQUEST).kind == "prediction"
    monkeypatch.setattr(prediction_module.Prediction, "dynamic_factor", value)
    assert answer(REQUEST).kind == "exception"


def test_an_error_of_another_kind_is_an_exception(monkeypatch, capsys):
    def fail(*_: object, **__: object) -> None:
        np.zeros(3)[[5]]

    monkeypatch.setattr("tests.evidence.drawn_pairs.predict", fail)
    found = answer(REQUEST)
    assert (found.kind, found.text[:10]) == ("exception", "IndexError")
    assert main(["--pairs", "2", "--processes", "1"]) == 1
    assert "2 exception" in capsys.readouterr().out


def test_an_undercut_pair_of_many_steps_repeats_with_the_mesh():
    """9/21 at 20 rpm: 41,856 steps a cycle. Its vibrations fade within a cycle, so few cycles are run."""
    slow = Request((9, 21), 3.96, 36.6, 20.3, 81.2, {"mesh.stiffness.model": "energy"})
    found = answer(slow)
    assert found.kind == "prediction"
    assert found.text.endswith(", 1 mesh cycles")
    assert found.seconds < 60.0
    assert dataclasses.asdict(found)["request"].startswith("--teeth 9/21")
