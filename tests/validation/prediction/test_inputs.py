"""Are the uncertain inputs those that the file and the documented defaults state?"""

import tomllib

import numpy as np
import pytest

import lumped
from floquet.gear.axes import GEAR_AXES
from lumped.elasticity import gear as elasticity
from lumped.errors import ParameterError
from lumped.gear_geometry.profile_shift import distance_without_backlash
from lumped.schema.bodies import bodies
from lumped.schema.fields_read import fields_read
from lumped.schema.pair import leaf_paths
from lumped.stiffness import finite_elements
from lumped.stiffness.registry import MODELS
from tests.unlike_pairs import all_assumed, but_known, known_sizes, unlike_pair
from validation.exchange.new_pair_file import new_pair
from validation.prediction.inputs import (
    forms_beside,
    given_and_assumed,
    read_values,
    source_of,
    uncertain_inputs,
)
from validation.prediction.sobol import sobol_points
from validation.prediction.uncertainty import varied

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
    spread_input = input_of(stated(field, spread), field)
    assert (spread_input.low, spread_input.high) == pytest.approx((low, high), rel=1e-12)


def test_a_wide_range_of_positive_values_is_log_uniform_and_a_narrow_one_uniform():
    wide_range, narrow_range = (
        input_of(stated("mesh.damping_ratio", s), "mesh.damping_ratio")
        for s in ("0.02 .. 0.08", "0.04 .. 0.06")
    )
    assert wide_range.at(0.5) == pytest.approx(0.04)  # the geometric mean
    assert narrow_range.at(0.5) == pytest.approx(0.05)


def test_a_choice_takes_each_of_its_values_equally_often():
    choice = input_of(stated("mesh.stiffness", ["energy", "parabolic"]), "mesh.stiffness")
    assert [choice.at(u) for u in (0.0, 0.49, 0.51, 1.0)] == ["energy", "energy", "parabolic", "parabolic"]
    assert PAIR.with_(choice.changes(0.9)).mesh.stiffness.model == "parabolic"


def test_defaults_are_for_values_that_are_assumed_and_for_no_others():
    fields = {one.field for one in uncertain_inputs(PAIR)}
    assert "mesh.damping_ratio" in fields
    assert "bearings.gear.stiffness" in fields
    assert "mesh.stiffness" in fields  # its model is assumed
    assert "mesh.stiffness_factor" in fields
    assert "operating.pinion_torque" not in fields  # published
    assert "friction.law" not in fields
    assert "pinion.tip_relief.amount" not in fields
    assert all(one.reason for one in uncertain_inputs(PAIR))


def test_what_the_file_states_takes_the_place_of_a_default():
    damping = input_of(stated("mesh.damping_ratio", "0.04 .. 0.06"), "mesh.damping_ratio")
    assert (damping.written, damping.reason) == ("0.04 .. 0.06", "stated in the file")


PLASTIC = {"gears.youngs_modulus": "3 GPa", "gears.density": 1400}
NEW = {
    "plastic": new_pair("18/35", 0.5, 5, 3000, 0.02, PLASTIC),
    "industrial": new_pair("19/41", 2.5, 20, 1450, 80, oil="vg220"),
    "large ratio": new_pair("25/103", 1.5, 12, 1500, 10, {"bearings.gear.loa_stiffness": 9e7}),
    "wind": new_pair("22/95", 14, 300, 400, 12000),
}


@pytest.mark.parametrize("name", NEW)
def test_an_assumed_value_is_the_middle_of_its_range(name):
    """Half of the samples of an input lie below the value that is assumed, as far as it is a number."""
    pair = NEW[name]
    values = leaf_paths(NEW[name])
    numbers = [one for one in uncertain_inputs(pair) if not one.choices]
    assert {"mesh.damping_ratio", "gears.roughness", "pinion.inertia"} < {one.field for one in numbers}
    for one in numbers:
        for part in one.parts:
            assumed_value = values.get(part.field, 1.0)
            if part.field.endswith(".tip_alteration"):
                assumed_value = 1e3 * pair.tip_alteration
            if part.field.endswith((".inertia", ".mass")):
                gear, _, key = part.field.partition(".")
                assumed_value = getattr(bodies(pair), f"{key}_{gear}")
            assert part.at(0.5) == pytest.approx(assumed_value, rel=1e-9, abs=1e-15), part.field


@pytest.mark.parametrize("name", NEW)
def test_the_assumed_friction_law_is_between_the_others_and_the_stiffness_has_both_methods(name):
    inputs = {one.field: one for one in uncertain_inputs(NEW[name])}
    assumed_law = NEW[name].friction.law
    mean = {
        law: GEAR_AXES["friction_coefficient"].own(NEW[name].with_(law=law))
        for law in inputs["friction.law"].choices
    }
    assert (
        sum(mu < mean[assumed_law] for mu in mean.values())
        == sum(mu > mean[assumed_law] for mu in mean.values())
        == 1
    )
    assert set(inputs["mesh.stiffness"].choices) >= {"finite_elements", "energy"}


def test_both_directions_of_a_bearing_and_both_gears_flanks_are_one_input():
    pair = lumped.load_gear_pair("high_contact_ratio_29_47")  # four unlike bearings
    pair = pair.with_(
        {"sources": {"bearings": "assumed", "pinion.roughness": "assumed", "gear.roughness": "assumed"}}
    )
    for gear in ("pinion", "gear"):
        one = input_of(pair, f"bearings.{gear}.stiffness")
        bearing = getattr(pair.bearings, gear)
        for share in (0.0, 0.3, 1.0):
            varied_bearing = getattr(varied(pair, [(one, share)]).bearings, gear)
            factor = varied_bearing.loa_stiffness / bearing.loa_stiffness
            assert factor == pytest.approx(0.5 * 4.0**share)
            assert varied_bearing.oloa_stiffness / bearing.oloa_stiffness == pytest.approx(factor)
    rough = varied(pair, [(input_of(pair, "gears.roughness"), 1.0)])
    ratios = [getattr(rough, g).roughness / getattr(pair, g).roughness for g in ("pinion", "gear")]
    assert ratios == pytest.approx([1.5, 1.5])
    fields = [part.field for one in uncertain_inputs(pair) for part in one.parts]
    assert len(set(fields)) == len(fields)


def test_a_direction_whose_stiffness_is_known_does_not_move():
    pair = but_known(all_assumed(PAIR), "bearings.gear.oloa_stiffness")
    one = input_of(pair, "bearings.gear.loa_stiffness")
    assert list(one.changes(0.1)) == ["bearings.gear.loa_stiffness"]


def test_mass_and_inertia_of_an_assumed_blank_move_together_and_those_of_a_known_one_do_not():
    pair = NEW["large ratio"]
    heavy = bodies(varied(pair, [(input_of(pair, "gear.inertia"), 1.0)]))
    assumed = bodies(pair)
    assert heavy.inertia_gear / assumed.inertia_gear == pytest.approx(1.25)
    assert heavy.mass_gear / assumed.mass_gear == pytest.approx(1.25)
    assert heavy.mass_pinion == assumed.mass_pinion
    drawn = but_known(pair, "gear.bore")
    assert "gear.inertia" not in {one.field for one in uncertain_inputs(drawn)}
    weighed = pair.with_({"gear.mass": 2.0, "gear.inertia": 3e-3})
    assert not {"gear.inertia", "gear.mass"} & {one.field for one in uncertain_inputs(weighed)}


def test_a_model_that_stays_keeps_its_parameters():
    pair = all_assumed(PAIR.with_({"mesh.stiffness": {"model": "parabolic", "end_ratio": 0.61}}))
    one = input_of(pair, "mesh.stiffness")
    shares = {name: (number + 0.5) / len(one.choices) for number, name in enumerate(one.choices)}
    assert varied(pair, [(one, shares["parabolic"])]).mesh.stiffness.end_ratio == 0.61
    assert varied(pair, [(one, shares["energy"])]).mesh.stiffness.model == "energy"


def test_every_model_of_the_stiffness_and_both_contacts_are_in_the_range_or_beside_it():
    for pair in (*NEW.values(), NEW["wind"].with_({"mesh.contact": "prescribed"})):
        beside = forms_beside(pair)
        models = {f"mesh.stiffness = {name}" for name in MODELS if name != "table"}
        varied_models = {f"mesh.stiffness = {name}" for name in input_of(pair, "mesh.stiffness").choices}
        assert models <= varied_models | set(beside)
        assert not varied_models & set(beside)
        assert sum(pair.with_(change).mesh.contact != pair.mesh.contact for change in beside.values()) == 1
    measured = but_known(NEW["wind"], "mesh.stiffness")
    assert set(forms_beside(measured)) == {"mesh.contact = prescribed"}


@pytest.mark.parametrize("stiffness", [5e8, lambda phase: 5e8 + 3e7 * np.cos(2 * np.pi * phase)])
def test_beside_a_stiffness_of_the_whole_mesh_stands_nothing_that_it_decides(stiffness):
    """It is used as given: another contact is none of its forms, and its size and model are known."""
    for pair in NEW.values():
        whole_mesh = pair.with_(stiffness=stiffness)
        assert forms_beside(whole_mesh) == {}
        fields = {part.field for one in uncertain_inputs(whole_mesh) for part in one.parts}
        assert not {"mesh.stiffness", "mesh.stiffness_factor", "mesh.contact", "mesh.relief"} & fields
        assert not any("_relief" in field for field in fields)
    assert len(forms_beside(NEW["wind"])) > 0


def test_every_default_names_its_source():
    for pair in NEW.values():
        for one in uncertain_inputs(pair):
            assert one.reason.startswith(("published", "estimate", "computed")), one.field


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


@pytest.mark.parametrize("words", ["Assumed", "a guess", "estimated", "measured"])
def test_words_of_sources_change_neither_counts_nor_ranges(words):
    """The file of a new pair, into whose [sources] a user writes of every value what he likes."""
    pair = new_pair("23/81", 3.0, 26.0, 2900, 210.0, oil="vg150")
    given_count, assumed_count = given_and_assumed(pair)
    assert given_count == 8
    assert assumed_count > 20
    text = pair.with_({"sources": dict.fromkeys(leaf_paths(pair), words)}).to_toml()
    stated = lumped.load_gear_pair(tomllib.loads(text))
    assert given_and_assumed(stated) == (given_count, assumed_count)
    assert repr(uncertain_inputs(stated)) == repr(uncertain_inputs(pair))  # a choice has NaN as its ends
    assert source_of(stated, "mesh.damping_ratio") == words
    known_pair = known_sizes(stated.with_({"assumed": {}}))
    assert given_and_assumed(known_pair) == (len(fields_read(known_pair)), 0)
    assert uncertain_inputs(known_pair) == ()


def test_what_no_chosen_law_reads_is_neither_counted_nor_varied():
    pair = unlike_pair("rack_25_degrees_always_pushing").with_({"friction.law": "xu_kahraman"})
    values = read_values(pair)
    assert sum(given_and_assumed(pair)) == len(values) < len(leaf_paths(pair)) - 7
    # The stiffness of the teeth may be that of their form, which has a fillet.
    assert values - fields_read(pair) == {"basic_rack.fillet_radius_coefficient"}
    fields = {one.field for one in uncertain_inputs(pair)}
    assert {"lubricant.viscosity", "gears.roughness"} < fields
    assert "mesh.backlash" not in fields
    coulomb = {"friction.law": "coulomb", "friction.coefficient": 0.06}
    fields = {one.field for one in uncertain_inputs(pair.with_(coulomb))}
    assert not {"lubricant.viscosity", "gears.roughness", "pinion.roughness"} & fields
    assert given_and_assumed(pair, contact_lost=True)[1] == given_and_assumed(pair)[1] + 1


def test_a_law_that_may_be_another_one_has_what_these_read():
    """Coulomb friction that is assumed: among the samples are laws that read oil and roughness."""
    pair = unlike_pair("rack_25_degrees_always_pushing").with_({"friction.coefficient": 0.06})
    pair = all_assumed(pair.with_({"friction.law": "coulomb"}))
    fields = {one.field for one in uncertain_inputs(pair)}
    assert {"friction.law", "friction.coefficient", "lubricant.viscosity", "gears.roughness"} < fields
    assert "lubricant.viscosity" not in fields_read(pair)
    assert "lubricant.viscosity" in read_values(pair)


def test_samples_leave_the_states_of_the_pair():
    pair = lumped.load_gear_pair("high_contact_ratio_29_47")
    before = given_and_assumed(pair)
    for one in uncertain_inputs(pair):
        pair.with_(one.changes(0.3))
    assert given_and_assumed(pair) == before


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


@pytest.mark.parametrize(("made", "more"), [
    (("19/41", 2.5, 20, 1450, 80), {}),
    (("12/24", 3.0, 25, 800, 60), {"pinion.profile_shift": 0.6, "gear.profile_shift": 0.36}),
    (("60/24", 1.0, 10, 3000, 5), {"pinion.tip_alteration": -0.1}),
])  # fmt: skip
def test_an_assumed_tip_ranges_about_the_one_that_keeps_the_clearance(made, more):
    """0.02 modules up and down on the radius, each gear for itself; a tip that is given does not move."""
    pair = new_pair(*made, more)
    tips = {one.field: one for one in uncertain_inputs(pair) if "tip" in one.field}
    stated_tips = {field.removesuffix(".tip_alteration") for field in more if "tip" in field}
    assert set(tips) == {f"{gear}.tip_alteration" for gear in ("pinion", "gear") if gear not in stated_tips}
    module = 1e3 * pair.basic_rack.module
    for field, one in tips.items():
        gear = field.partition(".")[0]
        gear_index, mate_index = (0, 1) if gear == "pinion" else (1, 0)
        assert (one.low + one.high) / 2.0 == pytest.approx(1e3 * pair.tip_alteration, abs=1e-12)
        assert one.high - one.low == pytest.approx(0.04 * module, rel=1e-9)
        for share, change in ((0.01, -0.02 * 8 / 9), (0.5, 0.0), (0.99, 0.02 * 8 / 9)):
            varied_pair = pair.with_(one.changes(share))
            radius = varied_pair.wheels[gear_index].tip_radius - pair.wheels[gear_index].tip_radius
            assert 1e3 * radius == pytest.approx(change * module, abs=1e-9)
            assert varied_pair.wheels[mate_index].tip_radius == pair.wheels[mate_index].tip_radius


def test_the_range_of_a_tip_is_half_of_the_tolerance_h11():
    """ISO 286-1: i = 0.45 D^(1/3) + 0.001 D um of D in mm, IT 11 = 100 i; tips of 18 to 60 teeth."""
    halves = []
    for module in (2.5, 3.0, 4.0, 5.0):
        for teeth in (18, 60):
            diameter = module * (teeth + 2)
            unit = 0.45 * diameter ** (1.0 / 3.0) + 0.001 * diameter
            halves.append(0.5 * 0.1 * unit / module)
    assert 0.02 < min(halves) < 0.04 < max(halves) < 0.053
    reason = next(one for one in uncertain_inputs(new_pair("19/41", 2.5, 20, 1450, 80)) if "tip" in one.field)
    assert "h11 (ISO 286-2)" in reason.reason
    assert reason.reason.startswith("estimate")


def test_a_stated_tip_replaces_the_default_and_takes_few_values_too():
    pair = new_pair("21/34", 3.0, 25, 2000, 150)
    pair = pair.with_({"pinion.tip_diameter": 69.0, "uncertainty": {"pinion.tip_diameter": "+- 0.2 mm"}})
    inputs = {one.field: one for one in uncertain_inputs(pair)}
    assert "pinion.tip_alteration" not in inputs
    one = inputs["pinion.tip_diameter"]
    values = {one.at(share) for share in np.linspace(0.0, 1.0, 400)}
    assert len(values) == 9
    assert (min(values), max(values)) == pytest.approx((69.0 - 0.2 * 8 / 9, 69.0 + 0.2 * 8 / 9))
    assert len({inputs["mesh.damping_ratio"].at(share) for share in np.linspace(0.0, 1.0, 400)}) == 400


def test_the_finite_elements_of_a_tip_are_solved_once_for_each_value(monkeypatch):
    """Samples of 32 machines need no more solutions than the values of both tips."""
    solved = []
    solve = elasticity.flank_compliance
    monkeypatch.setattr(
        elasticity,
        "flank_compliance",
        lambda body: solved.append((body.profile.teeth, body.tip)) or solve(body),
    )
    pair = new_pair("23/29", 2.0, 15, 1200, 40)
    inputs = [one for one in uncertain_inputs(pair) if "tip" in one.field]
    for point in sobol_points(np.zeros(2), 64, 1):
        varied_pair = varied(pair, list(zip(inputs, map(float, point), strict=True)))
        for tooth in finite_elements.elastic_teeth(varied_pair):
            assert tooth.flank is not None
    assert {teeth: len({round(tip, 9) for z, tip in solved if z == teeth}) for teeth in (23, 29)} == {
        23: 9,
        29: 9,
    }
    assert len(set(solved)) == 18  # to the last digit


def test_a_tip_that_an_old_file_leaves_out_ranges_too():
    """In format 1 it meant an alteration of zero, which is assumed; with the file's own entry alike."""
    text = new_pair("19/41", 2.5, 20, 1450, 80).to_mapping()
    for gear in ("pinion", "gear"):
        text[gear].pop("tip_alteration", None)
    old = lumped.load_gear_pair(text | {"format": 1})
    assert old.gear.tip_alteration == 0.0
    one = input_of(old, "gear.tip_alteration")
    assert (one.low, one.high) == pytest.approx((-0.05, 0.05))


@pytest.mark.parametrize(
    ("teeth", "total"), [("23/61", 0.9), ("61/23", 0.9), ("31/57", -0.3), ("57/31", -0.3)]
)
def test_the_shares_of_profile_shifts_that_a_centre_distance_asks_for_are_varied(teeth, total):
    numbers = tuple(map(int, teeth.split("/")))
    centre = 1e3 * distance_without_backlash(sum(numbers), 3e-3, np.radians(20.0), total)
    pair = new_pair(teeth, 3.0, 25.0, 1200.0, 90.0, {"centre_distance": centre, "mesh.stiffness": "energy"})
    one = {one.field: one for one in uncertain_inputs(pair)}["pinion.profile_shift"]
    # Between half to each gear, and all to the gear with fewer teeth (of a negative sum: with more).
    takes_all = numbers.index(min(numbers) if total > 0 else max(numbers)) == 0
    assert sorted((one.low, one.high)) == pytest.approx(
        sorted((total / 2, total if takes_all else 0.0)), abs=1e-9
    )
    assert one.low < pair.profile_shifts[0] < one.high
    for share in (0.01, 0.99):
        machine = varied(pair, [(one, share)])
        assert sum(machine.profile_shifts) == pytest.approx(total, abs=1e-9)
        assert machine.geometry.centre_distance == pair.geometry.centre_distance
        assert machine.profile_shifts != pair.profile_shifts
    stated = pair.with_({"gear.profile_shift": pair.profile_shifts[1]})
    assert "pinion.profile_shift" not in {one.field for one in uncertain_inputs(stated)}


def test_gears_stay_as_they_are_cut_where_the_centre_distance_has_a_tolerance():
    pair = new_pair("23/61", 3.0, 25.0, 1200.0, 90.0, {"centre_distance": 127.0, "mesh.stiffness": "energy"})
    pair = pair.with_(uncertainty={"centre_distance": "+- 0.05 mm"})
    one = {one.field: one for one in uncertain_inputs(pair)}["centre_distance"]
    apart = varied(pair, [(one, 0.999)])
    assert apart.geometry.centre_distance > pair.geometry.centre_distance + 0.04e-3
    assert apart.profile_shifts == pair.profile_shifts
    assert apart.geometry.normal_backlash > pair.geometry.normal_backlash + 0.02e-3


def test_an_assumed_inertia_of_motor_or_load_is_varied_and_a_known_one_is_not():
    pair = unlike_pair("contact_ratio_2_3_on_shafts")
    fields = {"shafts.motor.inertia", "shafts.load.inertia"}
    inertias = {path: value for path, value in leaf_paths(pair).items() if path in fields}
    assert set(inertias) == fields
    assumed = pair.with_({"assumed": pair.assumed.to_mapping() | inertias})
    ranges = {one.field: one for one in uncertain_inputs(assumed) if one.field in fields}
    assert {(one.low / inertias[field], one.high / inertias[field]) for field, one in ranges.items()} == {
        (0.5, 2.0)
    }
    assert set(ranges) == fields
    assumptions = {path: value for path, value in pair.assumed.to_mapping().items() if path not in fields}
    assert not fields & {one.field for one in uncertain_inputs(pair.with_({"assumed": assumptions}))}
