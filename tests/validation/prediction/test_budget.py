"""Does the error budget compute what it is asked for, and say what it left out?"""

import math
from types import SimpleNamespace

import pytest

import lumped
from lumped.outcomes import Absent, Outcome
from tests.unlike_pairs import unlike_pair
from validation.exchange.new_pair_file import new_pair
from validation.prediction.budget import error_budget
from validation.prediction.motion import predicted


@pytest.mark.parametrize("model", ["rectangular", "finite_elements"])
def test_finite_elements_are_a_row_of_every_other_stiffness(model):
    pair = unlike_pair("rack_25_degrees_always_pushing").with_({"mesh.stiffness": {"model": model}})
    as_stated = predicted(pair)
    none = Absent(Outcome.NOT_ASKED)
    results = SimpleNamespace(
        pair=pair, like=as_stated, linear=none, second=none, same_equations=None, uncertainty=none,
        measured_error=None,
    )  # fmt: skip
    budget = error_budget(results)
    row = budget.sel(row="stiffness")
    note = dict(zip(budget["row"].to_numpy(), budget.attrs["notes"], strict=True))["stiffness"]
    if model == "rectangular":
        other = predicted(pair.with_({"mesh.stiffness": {"model": "finite_elements"}}))
        expected = abs(as_stated.peak_to_peak - other.peak_to_peak)
        assert float(row["dte"]) == pytest.approx(expected, rel=1e-12)
        assert float(row["result"]) == pytest.approx(other.peak_to_peak, rel=1e-12)
        assert "whole gears" in note
    else:
        assert math.isnan(float(row["dte"]))
        assert note == "the pair has it"


@pytest.mark.parametrize(("pair", "note"), [
    (new_pair("19/41", module=2.5, face_width=20, speed=1450, torque=80, stiffness="energy"),
     "its contact and dampers are those of the mean load"),
    (unlike_pair("larger_gear_drives_contact_lost"), "teeth pull in the linear motion"),
], ids=["pushes", "pulls"])  # fmt: skip
def test_it_says_that_teeth_pull_only_where_they_do(pair, note):
    linear = lumped.steady_state(pair)
    none = Absent(Outcome.NOT_ASKED)
    assert (float(linear["normal_load"].min()) < 0.0) == ("pull" in note)
    results = SimpleNamespace(
        pair=pair, like=predicted(pair), linear=linear, second=none, same_equations=None,
        uncertainty=none, measured_error=None,
    )  # fmt: skip
    budget = error_budget(results)
    assert dict(zip(budget["row"].to_numpy(), budget.attrs["notes"], strict=True))["linear"] == note


def test_what_a_stiffness_of_the_whole_mesh_decides_is_no_error_of_it():
    """It comes with its contact and from elsewhere: neither another contact nor other teeth are beside it."""
    pair = unlike_pair("heavily_relieved_under_load").healthy
    whole_mesh = pair.with_(
        {"mesh.contact": None, "mesh.relief": None}, stiffness=[3e8, 3.4e8, 3.2e8, 2.9e8, 3e8]
    )
    none = Absent(Outcome.NOT_ASKED)
    results = SimpleNamespace(
        pair=whole_mesh, like=predicted(whole_mesh), linear=none, second=none, same_equations=None,
        uncertainty=none, measured_error=None,
    )  # fmt: skip
    budget = error_budget(results)
    notes = dict(zip(budget["row"].to_numpy(), budget.attrs["notes"], strict=True))
    for row in ("contact", "stiffness"):
        assert math.isnan(float(budget["dte"].sel(row=row)))
        assert notes[row] == "the stiffness of the whole mesh is given, with its contact"


def test_a_mesh_that_does_not_vibrate_has_no_shares():
    pair = unlike_pair("heavily_relieved_under_load").healthy
    pair = pair.with_({"mesh.contact": None, "mesh.relief": None, "friction.law": "none"}, stiffness=3e8)
    none = Absent(Outcome.NOT_ASKED)
    motionless = predicted(pair)
    assert motionless.peak_to_peak == motionless.bearing_rms == 0.0
    results = SimpleNamespace(
        pair=pair, like=motionless, linear=none, second=none, same_equations=None, uncertainty=none,
        measured_error=None,
    )  # fmt: skip
    assert error_budget(results)["share"].isnull().all()
