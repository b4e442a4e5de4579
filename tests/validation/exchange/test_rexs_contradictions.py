"""Does a file that contradicts itself still become a draft, with just the doubtful lines marked?"""

import pytest

import lumped
from validation.exchange import gear_pair_from_rexs, parameter_text, write_rexs


def attribute(key, value, unit="none"):
    return f'<attribute id="{key}" unit="{unit}">{value}</attribute>'


def doubtful(path):
    """Fields whose lines of the draft are marked; the draft must be one that the other commands take."""
    mapping, notes = gear_pair_from_rexs(path)
    lumped.load_gear_pair(mapping)
    text = parameter_text(mapping, notes)
    marked = {key for key, source in mapping["sources"].items() if "; doubtful: " in source}
    lines = [line for line in text.partition("[sources]")[0].splitlines() if line.endswith("doubtful")]
    assert len(lines) == len(marked)
    assert bool(marked) == any(note.startswith("doubtful: ") for note in notes)
    return marked


def test_files_without_a_contradiction_have_no_doubtful_line(xml, save, preset, tmp_path):
    assert doubtful(save(xml())) == set()
    assert doubtful(write_rexs(preset, tmp_path / "pair.rexs")) == set()


# By hand for z = 20/30, m = 2 mm, alpha = 20 deg, x = 0.1/0, a = 50.2 mm, h_aP* = 1:
# reference 40 and 60 mm, base 37.588 and 56.382 mm, base pitch 5.9043 mm, ratio 1.5, sum of shifts 0.1,
# pitch circles 2 a z/(z1 + z2) = 40.16 and 60.24 mm, contact ratio 1.54.
_RIGHT = {
    "stage": attribute("radial_contact_ratio", 1.53) + attribute("overlap_contact_ratio",
     0) + attribute("gear_ratio", -1.5) + attribute("sum_of_addendum_modification_coefficients",
     0.1) + attribute("normal_base_pitch", 5.9043, "mm"),
    "gear_1": attribute("reference_circle_diameter", 40, "mm") + attribute("base_circle_diameter", 37.588,
     "mm"),
    "gear_2": attribute("reference_circle_diameter", 60, "mm") + attribute("base_circle_diameter", 56.382,
     "mm"),
}  # fmt: skip


def test_right_derived_values_raise_no_doubt(xml, save):
    assert doubtful(save(xml(**_RIGHT))) == set()


@pytest.mark.parametrize(("right", "wrong", "fields"), [
    (">1.53<", ">1.8<", {"centre_distance", "pinion.tip_diameter", "basic_rack.addendum_coefficient"}),
    ('ratio" unit="none">0<', 'ratio" unit="none">1.1<', {"pinion.face_width", "gear.face_width"}),
    (">-1.5<", ">-1.6<", {"pinion.teeth", "gear.teeth"}),
    ('coefficients" unit="none">0.1<', 'coefficients" unit="none">0.2<', {"pinion.profile_shift",
     "gear.profile_shift"}),
    (">5.9043<", ">6.2832<", {"basic_rack.module", "basic_rack.pressure_angle"}),
    (">60<", ">62<", {"basic_rack.module", "gear.teeth"}),
    (">37.588<", ">38.5<", {"basic_rack.module", "basic_rack.pressure_angle", "pinion.teeth"}),
])  # fmt: skip
def test_a_wrong_derived_value_marks_the_lines_it_contradicts(xml, save, right, wrong, fields):
    text = xml(**_RIGHT)
    assert text.count(right) == 1
    path = save(text.replace(right, wrong))
    assert doubtful(path) == fields
    value = wrong.rpartition(">")[2].strip("<")
    assert value.strip("-") in " ".join(gear_pair_from_rexs(path)[1])


def test_a_ratio_may_be_stated_either_way_round(xml, save):
    assert doubtful(save(xml(stage=attribute("gear_ratio", 20 / 30)))) == set()


def test_pitch_diameters_and_operating_pressure_angle_are_compared(json_model, save_json):
    data = next(c for c in json_model["model"]["components"] if c["type"] == "cylindrical_stage_gear_data")
    # z = 30 of 20/30, m = 2 mm, no centre distance, no shift: it runs on its reference circle.
    entry = {"id": "pitch_diameter", "unit": "mm", "floating_point": 60.0}
    angle = {
        "id": "operating_pressure_angle_in_the_transverse_section",
        "unit": "deg",
        "floating_point": 20.0,
    }
    data["attributes"] += [entry, angle]
    assert doubtful(save_json(json_model)) == set()
    angle["floating_point"] = 24.0
    assert "basic_rack.pressure_angle" in doubtful(save_json(json_model))
    stage = next(c for c in json_model["model"]["components"] if c["type"] == "cylindrical_stage")
    stage["attributes"] = [{"id": "center_distance", "unit": "mm", "floating_point": 50.05}]
    angle["floating_point"] = 20.157  # arccos(50 cos 20 deg / 50.05)
    entry["floating_point"] = 60.06
    assert doubtful(save_json(json_model)) == set()
    entry["floating_point"] = 61.0
    assert doubtful(save_json(json_model)) == {"centre_distance"}


@pytest.mark.parametrize("centre", ["48", "0", "52", "502"])
def test_a_centre_distance_that_no_pair_has_gives_way_to_that_of_the_teeth(xml, save, centre):
    path = save(xml().replace(">50.2<", f">{centre}<"))
    assert doubtful(path) == {"centre_distance"}
    mapping, notes = gear_pair_from_rexs(path)
    # a = m (z1 + z2) cos(alpha) / (2 cos(alpha_w)), inv(alpha_w) = inv(alpha) + 2 tan(alpha) x/(z1 + z2)
    assert mapping["centre_distance"] == pytest.approx(50.1971, abs=1e-4)
    assert f"center_distance has {centre} mm" in " ".join(notes)


def test_a_backlash_reckoned_with_a_wrong_centre_distance_goes_with_it(xml, save):
    limits = "".join(attribute(f"{key}_normal_backlash", 0.1, "mm") for key in ("minimum", "maximum"))
    path = save(xml(stage=limits).replace(">50.2<", ">0<"))
    assert doubtful(path) == {"centre_distance", "mesh.backlash"}


def test_more_backlash_than_gears_have_is_doubtful_but_kept(xml, save):
    path = save(xml().replace(">50.2<", ">51<"))
    assert doubtful(path) == {"centre_distance"}
    assert gear_pair_from_rexs(path)[0]["centre_distance"] == 51.0


@pytest.mark.parametrize("tip", ["1", "40", "48"])
def test_a_tip_diameter_that_no_pair_has_gives_way_to_that_of_the_rack(xml, save, tip):
    path = save(xml().replace(">44.2<", f">{tip}<"))
    assert doubtful(path) == {"pinion.tip_diameter"}
    assert gear_pair_from_rexs(path)[0]["pinion"]["tip_diameter"] == pytest.approx(44.4, rel=1e-12)


def test_a_tip_diameter_far_from_the_basic_profile_is_doubtful_but_kept(xml, save):
    flank = attribute("normal_pressure_angle", 20, "deg") + attribute(
        "addendum_modification_coefficient", 0.1
    )
    profile = flank + attribute("addendum_coefficient_basic_profile", 1)
    assert doubtful(save(xml(flank_1=profile))) == set()
    path = save(xml(flank_1=profile).replace(">44.2<", ">43<"))
    assert doubtful(path) == {"pinion.tip_diameter"}
    assert gear_pair_from_rexs(path)[0]["pinion"]["tip_diameter"] == 43.0


def test_several_wrong_values_are_left_out_together(xml, save):
    path = save(xml().replace(">2<", ">3<"))  # module 3 mm beside diameters of module 2 mm
    assert doubtful(path) == {"centre_distance", "pinion.tip_diameter"}


def test_a_value_changed_after_the_export_is_doubted_too(tmp_path):
    path = write_rexs(lumped.load_gear_pair("fzg_c"), tmp_path / "pair.rexs")
    text = path.read_text(encoding="utf-8-sig")
    centre = attribute("center_distance", 91.5, "mm")
    assert centre in text
    path.write_text(text.replace(centre, attribute("center_distance", 85, "mm")), encoding="utf-8")
    assert "centre_distance" in doubtful(path)


@pytest.mark.parametrize(
    "version", ["1.0", "1.3", "0.9", "", "one", "1.4.x", "2.1.0", "99999999999999999999.0"]
)
def test_other_versions_are_read_where_they_are_understood_and_a_note_names_them(xml, save, leaves, version):
    mapping, notes = gear_pair_from_rexs(save(xml(version=version)))
    assert leaves(mapping) == leaves(gear_pair_from_rexs(save(xml()))[0])
    assert any(f"of REXS version {version or '(not given)'};" in note for note in notes)
    assert not any("REXS version" in note for note in gear_pair_from_rexs(save(xml()))[1])


def test_flanks_of_the_first_versions_are_not_taken_for_known(xml, save):
    angle = attribute("normal_pressure_angle", 25, "deg")
    flank = f'<component id="77" type="flank_geometry">{angle}</component>'
    fields = {"pinion.profile_shift", "gear.profile_shift", "basic_rack.pressure_angle"}
    assert doubtful(save(xml(version="1.2", components=flank))) == fields
