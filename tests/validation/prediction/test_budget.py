"""Does the error budget compute what it is asked for, and say what it left out?"""

import math
from types import SimpleNamespace

import pytest

from lumped.outcomes import Absent, Outcome
from tests.unlike_pairs import unlike_pair
from validation.prediction.budget import error_budget
from validation.prediction.motion import predicted


@pytest.mark.parametrize("asked", [True, False])
def test_finite_elements_are_computed_where_they_are_asked_for(asked):
    pair = unlike_pair("rack_25_degrees_always_pushing")
    own, none = predicted(pair), Absent(Outcome.NOT_ASKED)
    known = SimpleNamespace(
        pair=pair, prediction=own, linear=none, second=none, same_equations=None, uncertainty=none,
        measured_error=None, finite_elements=asked,
    )  # fmt: skip
    budget = error_budget(known)
    row = budget.sel(row="stiffness")
    note = dict(zip(budget["row"].to_numpy(), budget.attrs["notes"], strict=True))["stiffness"]
    if asked:
        other = predicted(pair.with_({"mesh.stiffness": {"model": "finite_elements"}}))
        expected = abs(own.peak_to_peak - other.peak_to_peak)
        assert float(row["dte"]) == pytest.approx(expected, rel=1e-12)
        assert "whole gears" in note
    else:
        assert math.isnan(float(row["dte"]))
        assert note == "left out of a quick report"
