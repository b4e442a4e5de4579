"""Are bearings that let the teeth part refused by their name?"""

import pytest

import spurcheck
from lumped.errors import ParameterError
from validation.exchange.new_pair_file import new_pair

CASES = {
    "slip of the unit": ((19, 41), 2.5, 20, 1450, 80),
    "large module": ((23, 97), 8.0, 90, 120, 9000),
    "small module": ((40, 41), 0.5, 4, 3000, 0.8),
}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("function", ["predict", "steady_state", "natural_frequencies", "simulate"])
def test_bearings_in_the_wrong_unit_are_refused_by_name(case, function):
    """Meant are N/um, and the bare number is in N/m: a million times softer."""
    pair = new_pair(*CASES[case], {"bearings.stiffness": 200})
    with pytest.raises(ParameterError) as caught:
        getattr(spurcheck, function)(pair)
    (problem,) = caught.value.problems
    assert problem.field == "bearings.pinion.loa_stiffness"
    assert problem.value == "200 N/m"
    assert "N/um" in problem.action
    assert "relief" not in str(problem)


def test_the_softer_bearing_is_named():
    pair = new_pair(*CASES["large module"], {"bearings.stiffness": "200 N/um"})
    soft = pair.with_({"bearings.gear.loa_stiffness": 150.0})
    with pytest.raises(ParameterError, match=r"bearings\.gear\.loa_stiffness = 150 N/m"):
        spurcheck.predict(soft)


@pytest.mark.parametrize("case", CASES)
def test_the_stated_stiffness_is_enough(case):
    """The refusal gives a limit: with twice the stiffness of the limit the pair has a prediction."""
    pair = new_pair(*CASES[case], {"bearings.stiffness": 200})
    g = pair.geometry
    force = pair.operating.pinion_torque / g.base_radius_pinion
    limit = 2.0 * force / ((g.contact_ratio - 1.0) * g.base_pitch)
    with pytest.raises(ParameterError) as caught:
        spurcheck.predict(pair)
    assert f">= {limit:.2g} N/m" in caught.value.problems[0].allowed
    spurcheck.predict(pair.with_({"bearings.stiffness": 2.0 * limit}))
