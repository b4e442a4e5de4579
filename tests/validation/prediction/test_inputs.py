"""Are the uncertain inputs those that the file and the documented defaults state?"""

import numpy as np
import pytest

import lumped
from lumped.errors import ParameterError
from tests.unlike_pairs import unlike_pair
from validation.prediction.inputs import given_and_assumed, uncertain_inputs

PAIR = lumped.load_gear_pair("nasa_28_28")


def stated(field: str, spread: object) -> lumped.GearPair:
    return PAIR.with_({"uncertainty": {field: spread}})


def input_of(pair: lumped.GearPair, field: str):
    return next(one for one in uncertain_inputs(pair) if one.field == field)


@pytest.mark.parametrize(("field", "spread", "low", "high"), [
    ("mesh.damping_ratio", "0.02 .. 0.10", 0.02, 0.10),
    ("pinion.tip_relief.amount", "+- 2 um", 21.0, 25.0),
    ("pinion.tip_relief.amount", "+- 0.002 mm", 21.0, 25.0),
    ("pinion.tip_relief.amount", "+- 2", 21.0, 25.0),
    ("operating.pinion_torque", "+- 10 %", 50.85, 62.15),
    ("bearings.pinion.loa_stiffness", "/ 2 .. * 2", 5e7, 2e8),
    ("bearings.pinion.loa_stiffness", "50 N/um .. 200 N/um", 5e7, 2e8),
    ("lubricant.viscosity", "* 0.7 .. * 1.4", 7.0, 14.0),
    ("mesh.stiffness_factor", "+- 8 %", 0.92, 1.08),
])  # fmt: skip
def test_ranges_are_read_in_the_units_of_the_field(field, spread, low, high):
    found = input_of(stated(field, spread), field)
    assert (found.low, found.high) == pytest.approx((low, high), rel=1e-12)


def test_a_wide_range_of_positive_values_is_log_uniform_and_a_narrow_one_uniform():
    wide, narrow = (
        input_of(stated("mesh.damping_ratio", s), "mesh.damping_ratio")
        for s in ("0.02 .. 0.08", "0.04 .. 0.06")
    )
    assert wide.at(0.5) == pytest.approx(0.04)  # the geometric mean
    assert narrow.at(0.5) == pytest.approx(0.05)


def test_a_choice_takes_each_of_its_values_equally_often():
    found = input_of(stated("mesh.stiffness", ["energy", "parabolic"]), "mesh.stiffness")
    assert [found.at(u) for u in (0.0, 0.49, 0.51, 1.0)] == ["energy", "energy", "parabolic", "parabolic"]
    assert PAIR.with_(found.changes(0.9)).mesh.stiffness.model == "parabolic"


def test_defaults_are_for_values_that_are_assumed_and_for_no_others():
    fields = {one.field for one in uncertain_inputs(PAIR)}
    assert "mesh.damping_ratio" in fields  # its source: assumed
    assert "bearings.gear.stiffness" in fields  # the section's source: assumed
    assert "mesh.stiffness" in fields  # "assumed model"
    assert "operating.pinion_torque" not in fields  # published
    assert "friction.law" not in fields
    assert "pinion.tip_relief.amount" not in fields
    assert all(one.reason for one in uncertain_inputs(PAIR))


def test_what_the_file_states_takes_the_place_of_a_default():
    found = input_of(stated("mesh.damping_ratio", "0.04 .. 0.06"), "mesh.damping_ratio")
    assert (found.written, found.reason) == ("0.04 .. 0.06", "stated in the file")


@pytest.mark.parametrize(("field", "spread", "words"), [
    ("mesh.damping_ratio", "0.1 .. 0.02", "lower end below"),
    ("mesh.damping_ratio", "0.5 .. 1.5", "Narrow the range"),
    ("mesh.damping_ratio", "about 0.05", "0.02 .. 0.10"),
    ("mesh.stiffness", ["energy", "magic"], "rectangular"),
    ("mesh.damping_ratio", ["a", "b"], "a range"),
    ("friction.coefficient", "+- 30 %", "has a number"),
    ("operating.pinion_torque", "+- 2 um", "torque"),
])  # fmt: skip
def test_a_range_that_cannot_be_is_refused(field, spread, words):
    with pytest.raises(ParameterError, match=f"uncertainty.{field}") as caught:
        uncertain_inputs(stated(field, spread))
    assert words in str(caught.value)


def test_a_field_that_does_not_exist_is_refused_when_the_file_is_read():
    with pytest.raises(ParameterError, match=r"uncertainty\.mesh\.damping_ratios"):
        stated("mesh.damping_ratios", "0.02 .. 0.1")


def test_ranges_survive_the_parameter_file():
    import tomllib

    pair = PAIR.with_(
        {"uncertainty": {"mesh.stiffness": ["energy", "parabolic"], "mesh.backlash": "+- 10 %"}}
    )
    assert lumped.load_gear_pair(tomllib.loads(pair.to_toml())) == pair


def test_values_without_a_source_are_called_so():
    assert given_and_assumed(PAIR)[2] == "assumed"
    assert given_and_assumed(PAIR.with_({"sources": {}}))[2] == "assumed or without a source"


def test_the_factor_scales_the_stiffness_and_what_follows_from_it():
    """k -> f k: the compliances of contact and neighbours fall as 1/f (docs/theory/mesh_physics.md)."""
    from lumped.path_of_contact import pair_stiffness
    from lumped.path_of_contact.stiffness import contact_softening, cross_compliances

    pair = unlike_pair("larger_gear_drives_contact_lost")
    twice = pair.with_({"mesh.stiffness_factor": 2.0})
    xi = np.linspace(pair.geometry.L_XA, pair.geometry.L_XD, 7)[1:-1]
    np.testing.assert_allclose(pair_stiffness(twice)(xi), 2.0 * pair_stiffness(pair)(xi), rtol=1e-14)
    assert contact_softening(twice) == pytest.approx(0.5 * contact_softening(pair), rel=1e-14)
    for one, other in zip(cross_compliances(twice), cross_compliances(pair), strict=True):
        inside = np.linspace(*one.interval, 5)[1:-1]
        np.testing.assert_allclose(one(inside), 0.5 * other(inside), rtol=1e-14)
