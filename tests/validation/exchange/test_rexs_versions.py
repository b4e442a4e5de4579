"""Is a stage the same pair in the form of every REXS version, and what decides it never assumed?"""

import itertools
import math
from dataclasses import replace

import pytest

import lumped
from lumped import ParameterError
from tests.validation.exchange.rexs_stages import STAGES, rexs_text
from validation.exchange import gear_pair_from_rexs, write_rexs
from validation.exchange.rexs import importing, model, tooth_system
from validation.exchange.rexs.model import VERSIONS

#: Way of giving profile shifts and tips -> the versions whose database has it.
_SHIFTS = {"coefficient": VERSIONS, "length": VERSIONS[2:], "sum": VERSIONS, "first": VERSIONS}
_TIPS = {
    "diameter": VERSIONS, "limits": VERSIONS[5:], "height": VERSIONS[2:8], "coefficient": VERSIONS,
}  # fmt: skip
#: Every way in every version that has it, over unlike stages: version, shifts, tips, teeth.
CASES = [
    (*ways, name)
    for ways, name in zip(
        [
            (version, shifts, tips)
            for version, shifts, tips in itertools.product(VERSIONS, _SHIFTS, _TIPS)
            if version in _SHIFTS[shifts] and version in _TIPS[tips]
        ],
        itertools.cycle(STAGES),
        strict=False,
    )
]


def shifts_of_centre(stage):
    """Sum of the profile shift coefficients that a centre distance asks for (DIN 3960)."""
    alpha = math.radians(stage.pressure_angle)
    working = math.acos(0.5 * stage.module * sum(stage.teeth) * math.cos(alpha) / stage.centre)
    involute = [math.tan(angle) - angle for angle in (working, alpha)]
    return sum(stage.teeth) * (involute[0] - involute[1]) / (2.0 * math.tan(alpha))


def wanted(stage, shifts, tips):
    """The stage that a file has to give: beside one shift alone, the centre distance leaves the other."""
    if shifts != "first":
        return stage
    other = shifts_of_centre(stage) - stage.shifts[0]
    return replace(
        stage, shifts=(stage.shifts[0], other), written_tips=None if tips == "coefficient" else stage.tips
    )


def differences(pair, stage):
    """What differs between a pair and a stage, by name; the shares are those of a few roundings."""
    first, second = pair.wheels
    tool = pair.basic_rack.dedendum_coefficient, pair.basic_rack.fillet_radius_coefficient
    compared = {
        "teeth": (stage.teeth, (first.tooth.teeth, second.tooth.teeth), 0.0),
        "module": (stage.module * 1e-3, first.tooth.module, 1e-14),
        "pressure angle": (math.radians(stage.pressure_angle), first.tooth.pressure_angle, 1e-14),
        # a sum of two, less one; from the centre distance by a difference of involutes of 0.02
        "profile shifts": (stage.shifts, pair.profile_shifts, 1e-11),
        "tips": (stage.tips, (2e3 * first.tip_radius, 2e3 * second.tip_radius), 1e-12),
        "centre distance": (stage.centre * 1e-3, pair.geometry.centre_distance, 1e-14),
        "contact ratio": (stage.contact_ratio(stage.tips), pair.geometry.contact_ratio, 1e-10),
        "tool": ((1.3, 0.25), tool, 1e-14),
        "face widths": (stage.width, (1e3 * pair.pinion.face_width, 1e3 * pair.gear.face_width), 1e-14),
    }
    return {
        name: (want, got)
        for name, (want, got, share) in compared.items()
        if got != pytest.approx(want, rel=share)
    }


def pair_of(path, **more):
    return lumped.load_gear_pair(gear_pair_from_rexs(path, **more)[0])


@pytest.mark.parametrize("case", CASES, ids="-".join)
def test_a_stage_is_the_same_pair_in_the_form_of_every_version(case, save):
    version, shifts, tips, name = case
    pair = pair_of(save(rexs_text(STAGES[name], version, shifts, tips)))
    assert not differences(pair, wanted(STAGES[name], shifts, tips))
    newest = pair_of(save(rexs_text(STAGES[name], VERSIONS[-1], shifts, "diameter")))
    for key in (
        "contact_ratio",
        "L_XA",
        "L_XD",
        "base_radius_gear",
        "normal_backlash",
        "operating_pressure_angle",
    ):
        # tips of a file have 15 digits; a path of contact is a difference of lengths ten times its size
        got, reference = (getattr(one.geometry, key) for one in (pair, newest))
        if shifts != "first" or tips != "coefficient":
            assert got == pytest.approx(reference, rel=1e-11, abs=1e-15)
    decisive = ("module", "pressure_angle", "profile_shift", "tip_diameter", "centre_distance")
    assert not [path for path in pair.assumed if path.endswith(decisive)]
    assert ("pinion.tip_alteration" in pair.assumed) == (tips == "coefficient")


def missed(texts, save):
    """Number of stages that are refused, or are another pair than was written."""
    count = 0
    for text, stage in texts:
        try:
            count += bool(differences(pair_of(save(text)), stage))
        except ParameterError:
            count += 1
    return count


def _texts(version, left_out=()):
    return [
        (rexs_text(STAGES[name], version, shifts, tips, left_out), wanted(STAGES[name], shifts, tips))
        for v, shifts, tips, name in CASES
        if v == version
    ]


@pytest.mark.parametrize(
    ("quantity", "place"),
    [(quantity, place) for quantity, places in tooth_system.PLACES.items() for place in places],
    ids=lambda one: one if isinstance(one, str) else f"{one.component}-{one.attribute}",
)
def test_a_place_that_is_not_read_is_missed(quantity, place, save, monkeypatch):
    places = tooth_system.PLACES[quantity]
    # What says the same in the same file: the transverse and the normal section of a spur gear are one.
    twins = {one.attribute for one in places} if quantity in ("module", "pressure_angle") else set()
    texts = _texts(place.versions[:3], twins - {place.attribute})
    assert texts
    assert missed(texts, save) == 0
    monkeypatch.setitem(tooth_system.PLACES, quantity, tuple(one for one in places if one != place))
    assert missed(texts, save) > 0


@pytest.mark.parametrize("version", ["1.1", "1.4"])
def test_a_tool_and_the_driving_gear_are_found_by_the_relations_of_the_version(version, save, monkeypatch):
    path = save(rexs_text(STAGES["13/76"], version, drives=2))
    pair = pair_of(path)
    assert (pair.pinion.teeth, pair.gear.teeth) == (76, 13)
    assert pair.profile_shifts == pytest.approx(STAGES["13/76"].shifts[::-1], rel=1e-14)
    assert pair.basic_rack.dedendum_coefficient == 1.3
    number = 1 if version == "1.1" else 0  # the other of two names
    monkeypatch.setattr(model, "GEAR_DATA", model.GEAR_DATA[1 - number : 2 - number])
    assert pair_of(path).pinion.teeth == 13
    monkeypatch.setattr(model, "FLANKS", model.FLANKS[1 - number : 2 - number])
    with pytest.raises(ParameterError, match="normal_pressure_angle of flank_geometry"):
        gear_pair_from_rexs(path)


@pytest.mark.parametrize(("attribute", "field", "component", "first", "last"), [
    ("number_of_teeth", "pinion.teeth", "cylindrical_gear 10", "1.0", "2.0.0"),
    ("face_width", "gear.face_width", "cylindrical_gear 20", "1.0", "2.0.0"),
    ("normal_module", "basic_rack.module", "cylindrical_gear 10", "1.0", "2.0.0"),
    ("normal_pressure_angle", "basic_rack.pressure_angle", "flank_geometry", "1.0", "1.2"),
    ("normal_pressure_angle", "basic_rack.pressure_angle", "cylindrical_gear_flank", "1.3", "2.0.0"),
    ("helix_angle_reference_diameter", "helix angle", "cylindrical_gear", "1.0", "2.0.0"),
])  # fmt: skip
@pytest.mark.parametrize("version", ["1.0", "1.6"])
def test_what_decides_the_geometry_is_refused_with_its_place(
    attribute, field, component, first, last, version, save
):
    twins = ("transverse_module", "pressure_angle_in_the_transverse_section")
    text = rexs_text(STAGES["23/67"], version, left_out=(attribute, *twins))
    with pytest.raises(ParameterError) as error:
        gear_pair_from_rexs(save(text))
    (message,) = [str(problem) for problem in error.value.problems if problem.field == field]
    assert attribute in message
    assert component in message
    assert f"(REXS {first} to {last})" in message
    assert "assumed" not in message


def test_without_a_centre_distance_a_missing_shift_is_refused_with_all_its_places(save):
    text = rexs_text(STAGES["14/87"], "1.2", "first", left_out=("center_distance",))
    with pytest.raises(ParameterError) as error:
        gear_pair_from_rexs(save(text))
    (problem,) = error.value.problems
    assert problem.field == "gear.profile_shift"
    for word in (
        "addendum_modification_coefficient of flank_geometry (REXS 1.0 to 1.2)", "cylindrical_gear 20",
        "addendum_modification of flank_geometry (REXS 1.2)", "cylindrical_gear_flank (REXS 1.3 to 2.0.0)",
        "sum_of_addendum_modification_coefficients of cylindrical_stage", "center_distance",
        "--set gear.profile_shift=VALUE",
    ):  # fmt: skip
        assert word in str(problem)
    pair = pair_of(save(text), changes={"gear.profile_shift": -0.4742})
    assert pair.profile_shifts[1] == -0.4742
    assert dict(pair.sources)["gear.profile_shift"] == "given by the user"


def test_everything_that_is_missing_is_asked_for_at_once(save):
    names = (
        "number_of_teeth",
        "normal_pressure_angle",
        "addendum_modification_coefficient",
        "center_distance",
    )
    with pytest.raises(ParameterError) as error:
        gear_pair_from_rexs(save(rexs_text(STAGES["14/87"], "1.0", left_out=names)))
    assert {problem.field for problem in error.value.problems} == {
        "pinion.teeth", "gear.teeth", "basic_rack.pressure_angle",
        "pinion.profile_shift", "gear.profile_shift",
    }  # fmt: skip


def test_a_shift_that_follows_from_the_centre_distance_is_known_and_a_remark_says_it(save):
    stage = STAGES["13/76"]
    mapping, notes = gear_pair_from_rexs(save(rexs_text(stage, "1.0", "first")))
    other = shifts_of_centre(stage) - stage.shifts[0]
    (note,) = [note for note in notes if "DIN 3960" in note]
    assert f"gear.profile_shift is not in the file: {other:.4f} follows" in note
    assert "gear.profile_shift" not in lumped.load_gear_pair(mapping).assumed
    mapping, notes = gear_pair_from_rexs(save(rexs_text(stage, "1.0", "none")))
    pair = lumped.load_gear_pair(mapping)
    assert sum(pair.profile_shifts) == pytest.approx(shifts_of_centre(stage), rel=1e-11)
    assert {"pinion.profile_shift", "gear.profile_shift"} <= set(pair.assumed)
    assert any("how the gears share it is assumed" in note for note in notes)


def test_of_a_sum_alone_the_share_is_assumed(save):
    stage = STAGES["27/51"]
    text = rexs_text(
        stage, "1.3", "sum", "none", left_out=("addendum_modification_coefficient", "center_distance")
    )
    mapping, notes = gear_pair_from_rexs(save(text))
    pair = lumped.load_gear_pair(mapping)
    assert sum(pair.profile_shifts) == pytest.approx(sum(stage.shifts), rel=1e-12)
    assert {"pinion.profile_shift", "gear.profile_shift"} <= set(pair.assumed)
    assert any("how the gears share it" in note for note in notes)


def test_tips_that_the_file_does_not_have_keep_the_clearance_and_stand_first_in_what_is_assumed(save):
    stage = STAGES["13/76"]
    _, notes = gear_pair_from_rexs(save(rexs_text(stage, "1.0", tips="none")))
    usual = replace(stage, addendum=1.0)
    (tips,) = [note for note in notes if "tip_diameter of cylindrical_gear (REXS 1.0 to 2.0.0)" in note]
    assert f"{usual.tips[0]:.3f} mm and {usual.tips[1]:.3f} mm" in tips
    assert f"contact ratio is then {usual.contact_ratio(usual.tips):.3f}" in tips
    (summary,) = [note for note in notes if "are assumed" in note and "values" in note]
    _, _, after_first = summary.partition("first: ")
    assert after_first.startswith("tips, speed, torque, backlash, bearings")
    mapping, _ = gear_pair_from_rexs(
        save(rexs_text(stage, "1.0", tips="none")), changes={"pinion.tip_diameter": 20.2, "speed": 1450}
    )
    assert mapping["pinion"]["tip_diameter"] == 20.2
    assert mapping["operating"]["pinion_speed"] == 1450
    assert "operating.pinion_speed" not in mapping["assumed"]


def test_what_the_user_gives_stands_in_place_of_the_file(save):
    stage = STAGES["23/34"]
    text = rexs_text(replace(stage, written_tips=(1.0, stage.tips[1])), "1.4")
    with pytest.raises(ParameterError, match=r"pinion\.tip_diameter = 1 mm"):
        gear_pair_from_rexs(save(text))
    pair = pair_of(save(text), changes={"pinion.tip_alteration": 0.0, "oil": "vg220"})
    first = stage.module * (23 + 2.0 * stage.shifts[0] + 2.0)  # the addendum coefficient is not in the file
    assert 2e3 * pair.wheels[0].tip_radius == pytest.approx(first, rel=1e-14)
    assert pair.lubricant.viscosity_law.iso_vg == 220
    text = rexs_text(stage, "1.4")
    wider = pair_of(save(text), changes={"face_width": 30, "module": f"{stage.module - 1e-4:.15g} mm"})
    assert (wider.pinion.face_width, wider.gear.face_width) == (0.03, 0.03)
    assert wider.basic_rack.module == pytest.approx(1e-3 * stage.module - 1e-7, rel=1e-14)
    assert dict(wider.sources)["gear.face_width"] == "given by the user"


def test_a_tool_may_give_lengths(save):
    stage = STAGES["23/67"]
    text = rexs_text(stage, "1.1")
    factors = '<attribute id="addendum_coefficient_reference_profile" unit="none">1.3</attribute>'
    radius = '<attribute id="tip_radius_factor" unit="none">0.25</attribute>'
    assert text.count(factors) == text.count(radius) == 2
    for old, name, share in ((factors, "addendum_reference_profile", 1.3), (radius, "tip_radius", 0.25)):
        text = text.replace(old, f'<attribute id="{name}" unit="mm">{share * stage.module!r}</attribute>')
    rack = pair_of(save(text)).basic_rack
    assert rack.dedendum_coefficient == pytest.approx(1.3, rel=1e-14)
    assert rack.fillet_radius_coefficient == pytest.approx(0.25, rel=1e-14)


def test_a_root_diameter_is_taken_at_the_shift_of_the_centre_distance(save):
    stage = STAGES["23/67"]
    x = shifts_of_centre(stage) - stage.shifts[0]
    text = rexs_text(stage, "1.2", "first", left_out=("addendum_coefficient_reference_profile",))
    # d_f = m (z + 2 x - 2 h_fP*) of the second gear, for h_fP* = 1.2
    root = f'<attribute id="root_diameter" unit="mm">{stage.module * (67 + 2.0 * x - 2.4)!r}</attribute>'
    head = '<component id="20" type="cylindrical_gear">'
    rack = pair_of(save(text.replace(head, head + root))).basic_rack
    assert rack.dedendum_coefficient == pytest.approx(1.2, rel=1e-11)


def test_two_addendum_coefficients_without_tip_diameters_are_refused(save):
    stage = STAGES["23/67"]
    text = rexs_text(stage, "1.3", tips="coefficient")
    first, _, second = text.partition('<component id="20"')
    path = save(f'{first}<component id="20"{second.replace(f">{stage.addendum!r}<", ">0.95<")}')
    with pytest.raises(ParameterError, match=r"--set pinion\.tip_diameter=VALUE"):
        gear_pair_from_rexs(path)
    pair = pair_of(path, changes={"gear.tip_diameter": 80.5})
    assert pair.basic_rack.addendum_coefficient == stage.addendum
    pair = pair_of(path, changes={"pinion.tip_diameter": 29.9})
    assert pair.basic_rack.addendum_coefficient == 0.95


def test_a_chamfer_of_the_tip_is_named(save):
    text = rexs_text(STAGES["23/67"], "1.0").replace(
        '<attribute id="normal_pressure_angle"',
        '<attribute id="tooth_tip_chamfer" unit="mm">0.2</attribute><attribute id="normal_pressure_angle"',
    )
    _, notes = gear_pair_from_rexs(save(text))
    assert len([note for note in notes if "tooth_tip_chamfer = 0.2 mm is left out" in note]) == 2


@pytest.mark.parametrize("name", STAGES)
def test_an_export_has_the_shifts_and_tips_that_follow(name, save, tmp_path):
    stage = STAGES[name]
    pair = pair_of(save(rexs_text(stage, "1.0", "first", "coefficient")))
    assert pair.gear.profile_shift is None
    back = pair_of(write_rexs(pair, tmp_path / "pair.rexs"))
    assert back.gear.profile_shift == pytest.approx(pair.profile_shifts[1], rel=1e-14)
    for one, other in zip(back.wheels, pair.wheels, strict=True):
        assert one.tip_radius == pytest.approx(other.tip_radius, rel=1e-14)
    assert back.geometry.contact_ratio == pytest.approx(pair.geometry.contact_ratio, rel=1e-12)


def test_the_places_are_those_of_the_attributes_of_the_vocabulary():
    named = {place.attribute for places in tooth_system.PLACES.values() for place in places}
    assert named <= set(model.ATTRIBUTES)
    assert importing.VERSIONS[0] == "1.0"
