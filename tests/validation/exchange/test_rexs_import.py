"""Does the import take each value from its place, in its unit, and say where it is from?"""

import math
import re

import pytest

import lumped
from lumped import ParameterError
from lumped.schema.pair import leaf_paths
from validation.exchange import gear_pair_from_rexs, write_rexs


def _relief(kind, depth, start, end, shape="linear"):
    return (
        f'<component id="70" type="{kind}"><attribute id="shape_of_relief" unit="none">{shape}</attribute>'
        f'<attribute id="{kind}_depth" unit="mm">{depth}</attribute>'
        f'<attribute id="{kind}_datum_diameter" unit="mm">{start!r}</attribute>'
        f'<attribute id="{kind}_evaluation_reference" unit="mm">{end!r}</attribute></component>'
    )


_ON_BOTH_FLANKS = "".join(
    f'<relation id="{90 + i}" type="reference"><ref id="{flank}" role="origin"/>'
    '<ref id="70" role="referenced"/></relation>'
    for i, flank in enumerate((41, 42))
)


@pytest.mark.parametrize("version", ["1.4", "1.5", "1.6", "1.7", "2.0.0"])
def test_a_hand_written_stage_is_read_value_by_value(xml, save, version):
    modulus_unit = "MPa" if version == "2.0.0" else "N / mm^2"
    mapping, _ = gear_pair_from_rexs(save(xml(version=version, modulus_unit=modulus_unit)))
    pair = lumped.load_gear_pair(mapping)
    assert pair.name == "first stage"
    assert pair.description == f"stage 1 of model.rexs, written by by hand 1, REXS {version}"
    assert (pair.pinion.teeth, pair.gear.teeth) == (20, 30)
    assert mapping["basic_rack"]["module"] == 2.0
    assert mapping["basic_rack"]["pressure_angle"] == 20.0
    assert mapping["centre_distance"] == 50.2
    assert mapping["pinion"]["tip_diameter"] == 44.2
    assert (mapping["pinion"]["face_width"], mapping["gear"]["face_width"]) == (15.0, 14.0)
    assert (mapping["pinion"]["profile_shift"], mapping["gear"]["profile_shift"]) == (0.1, 0.0)
    assert mapping["gear"]["bore"] == 12.0
    assert mapping["gear"]["youngs_modulus"] == 210.0
    assert mapping["gear"]["density"] == 7800.0
    # REXS has signs for speed and torque; here the pinion drives in its positive sense.
    assert mapping["operating"]["pinion_speed"] == 1500.0
    assert mapping["operating"]["pinion_torque"] == 42.5


def test_every_value_has_its_place_in_the_file_or_is_marked_assumed(xml, save):
    mapping, notes = gear_pair_from_rexs(save(xml()))
    sources = mapping["sources"]
    assumed = mapping["assumed"]
    pair = lumped.load_gear_pair(mapping)
    assert {*sources, *assumed} == set(leaf_paths(pair)) - {"name", "description"}
    assert not {*sources} & {*assumed}
    # The gear's tip follows from what is written: it stands in no table of the file.
    follows = {"gear.tip_alteration": 0.0}
    assert pair.assumed.to_mapping() == assumed | follows
    assert sources["pinion.teeth"] == "REXS model.rexs cylindrical_gear 21/number_of_teeth"
    assert sources["operating.pinion_torque"] == "REXS model.rexs external_load 33/torque_around_u_axis"
    for path in ("pinion.roughness", "friction.law", "bearings.gear.size", "lubricant.viscosity"):
        assert path in assumed
    assert all(s.startswith("REXS model.rexs ") for s in sources.values())
    (summary,) = [note for note in notes if "weighs most" in note]
    assert summary.startswith(f"{len(assumed | follows)} values")
    assert len(summary) < 300
    assert any("does not say which gear drives" in note for note in notes)


def test_json_with_the_second_gear_driving_and_the_speed_in_a_load_case(json_model, save_json):
    mapping, notes = gear_pair_from_rexs(save_json(json_model))
    assert (mapping["pinion"]["teeth"], mapping["gear"]["teeth"]) == (30, 20)
    assert mapping["operating"]["pinion_torque"] == 12.0
    assert mapping["operating"]["pinion_speed"] == 900.0
    where = "REXS model.rexsj shaft 32/rotational_speed (load case 7)"
    assert mapping["sources"]["operating.pinion_speed"] == where
    assert not any("which gear drives" in note for note in notes)
    assert mapping["basic_rack"]["pressure_angle"] == 20.0


def test_speed_and_torque_that_the_file_does_not_have_are_assumed_aloud(json_model, save_json):
    json_model["model"]["components"] = [c for c in json_model["model"]["components"] if c["id"] != 61]
    relations = json_model["model"]["relations"]
    json_model["model"]["relations"] = [r for r in relations if r["type"] in ("stage", "flank")]
    del json_model["model"]["load_spectrum"]
    mapping, notes = gear_pair_from_rexs(save_json(json_model))
    for key in ("pinion_speed", "pinion_torque"):
        assert f"operating.{key}" in mapping["assumed"]
        assert any(f"operating.{key} is not in the file" in note for note in notes)
    # F_t/(b m) = 20 N/mm^2 on the reference circle of 40 mm: 20 * 15 * 2 N * 20 mm = 12 N m.
    assert mapping["operating"]["pinion_torque"] == 12.0


def test_a_byte_order_mark_a_namespace_and_utf16_do_not_matter(xml, save):
    plain = gear_pair_from_rexs(save(xml()))[0]
    spaced = xml().replace("<model ", '<model xmlns="https://www.rexs.info" ')
    prefixed = re.sub(r"<(/?)(?=[a-z])", r"<\1r:", xml())
    prefixed = prefixed.replace("<r:model ", '<r:model xmlns:r="https://www.rexs.info" ')
    utf16 = xml().replace('encoding="UTF-8"', 'encoding="UTF-16"').encode("utf-16")
    for content in (b"\xef\xbb\xbf" + xml().encode(), spaced, prefixed, utf16):
        assert gear_pair_from_rexs(save(content))[0] == plain


def test_backlash_leaves_out_what_the_centre_distance_gives(xml, save):
    stage = "".join(
        f'<attribute id="{key}_normal_backlash" unit="mm">{value}</attribute>'
        for key, value in (("minimum", 0.10), ("maximum", 0.16))
    )
    pair = lumped.load_gear_pair(gear_pair_from_rexs(save(xml(stage=stage)))[0])
    # The geometry of the imported pair must have the mean of both limits as its whole normal backlash; the
    # share of tooth thinning carries twelve digits.
    assert lumped.geometry(pair).normal_backlash == pytest.approx(0.13e-3, rel=1e-10)
    assert 0.0 < pair.mesh.backlash < 0.13e-3


def test_the_first_load_case_stands_in_and_the_accumulation_does_not(xml, save):
    def load(torque):
        attribute = f'<attribute id="torque_around_u_axis" unit="N m">{torque}</attribute>'
        return f'<component id="33">{attribute}</component>'

    cases = "".join(f'<load_case id="{n}">{load(torque)}</load_case>' for n, torque in ((1, 7.5), (2, 8.5)))
    # Results of the whole spectrum name the same components again.
    spectrum = f'<load_spectrum id="1">{cases}<accumulation>{load(99)}</accumulation></load_spectrum>'
    text = xml(spectrum=spectrum)
    stated, notes = gear_pair_from_rexs(save(text))
    assert stated["operating"]["pinion_torque"] == 42.5  # the component's own value decides
    assert any("2 load cases" in note for note in notes)
    torque_element = '<attribute id="torque_around_u_axis" unit="N m">-42.5</attribute>'
    assert torque_element in text
    mapping, _ = gear_pair_from_rexs(save(text.replace(torque_element, "")))
    assert mapping["operating"]["pinion_torque"] == 7.5
    assert "load case 1" in mapping["sources"]["operating.pinion_torque"]


def test_oil_by_two_viscosities_and_the_temperature_of_the_casing(xml, save):
    components = (
        '<component id="71" type="lubricant">'
        '<attribute id="viscosity_at_40_degree_celsius" unit="mm^2 / s">100</attribute>'
        '<attribute id="viscosity_at_100_degree_celsius" unit="mm^2 / s">11</attribute>'
        '<attribute id="density_at_15_degree_celsius" unit="kg / dm^3">0.88</attribute></component>'
        '<component id="72" type="gear_casing"><attribute id="temperature_lubricant" unit="C">80</attribute>'
        "</component>"
    )
    law = gear_pair_from_rexs(save(xml(components=components)))[0]["lubricant"]["viscosity_law"]
    assert law["kinematic_viscosity_40"] == 100.0
    assert law["kinematic_viscosity_100"] == 11.0
    assert law["density"] == 880.0
    assert law["temperature"] == 80.0


@pytest.mark.parametrize(
    ("name", "factor"),
    [("arithmetic_average_roughness_flank", 1), ("averaged_peak_to_valley_height_flank", 6)],
)
def test_roughness_is_ra_or_a_sixth_of_rz(xml, save, name, factor):
    gear = f'<attribute id="{name}" unit="mum">3</attribute>'
    mapping, _ = gear_pair_from_rexs(save(xml(gear_1=gear)))
    assert mapping["pinion"]["roughness"] == 3 / factor
    assert ("ISO 6336-2" in mapping["sources"]["pinion.roughness"]) == (factor == 6)


def test_the_dedendum_comes_from_the_tool_or_else_the_root_diameter(xml, save):
    # d_f = m (z + 2 x - 2 h_fP*) = 2 (20 + 0.2 - 2.8) = 34.8 mm for h_fP* = 1.4
    root = '<attribute id="root_diameter" unit="mm">34.8</attribute>'
    mapping, _ = gear_pair_from_rexs(save(xml(gear_1=root)))
    assert mapping["basic_rack"]["dedendum_coefficient"] == pytest.approx(1.4, rel=1e-12)  # one subtraction
    tool = (
        '<component id="73" type="rack_shaped_tool">'
        '<attribute id="addendum_coefficient_reference_profile" unit="none">1.3</attribute>'
        '<attribute id="tip_radius_factor" unit="none">0.25</attribute></component>'
        '<component id="74" type="cylindrical_gear_manufacturing_settings"/>'
    )
    step = (
        '<relation id="95" type="manufacturing_step" order="1"><ref id="41" role="workpiece"/>'
        '<ref id="73" role="tool"/><ref id="74" role="manufacturing_settings"/></relation>'
    )
    mapping, notes = gear_pair_from_rexs(save(xml(gear_1=root, components=tool, relations=step)))
    assert not any("dedendum" in note for note in notes)
    rack = mapping["basic_rack"]
    assert rack["dedendum_coefficient"] == 1.3
    assert rack["fillet_radius_coefficient"] == 0.25


@pytest.mark.parametrize(("shape", "power"), [("linear", 1), ("parabolic", 2)])
def test_tip_relief_becomes_a_roll_angle_and_an_amount_at_the_tip(xml, save, shape, power):
    base = 40.0 * math.cos(math.radians(20.0))
    start = 42.0
    stated = 43.5
    tip = 44.2
    parts = {"components": _relief("tip_relief", 0.02, start, stated, shape), "relations": _ON_BOTH_FLANKS}
    relief = gear_pair_from_rexs(save(xml(**parts)))[0]["pinion"]["tip_relief"]

    def roll(diameter):  # of an involute: tan(alpha) with cos(alpha) = base/diameter
        return math.tan(math.acos(base / diameter))

    assert relief["shape"] == shape
    assert relief["start_roll_angle"] == pytest.approx(math.degrees(roll(start)), rel=1e-11)
    carried = ((roll(tip) - roll(start)) / (roll(stated) - roll(start))) ** power
    assert relief["amount"] == pytest.approx(20.0 * carried, rel=1e-11)  # twelve digits are written


@pytest.mark.parametrize(("bore", "model"), [(20.0, "finite_elements"), (95.0, "energy")])
def test_tooth_stiffness_is_assumed_as_of_a_new_pair(bore, model, tmp_path):
    # What holds a thin rim decides its stiffness, so that finite elements of the gear alone do not.
    write_rexs(lumped.load_gear_pair("fzg_c").with_({"gear.bore": bore}), tmp_path / "pair.rexs")
    mapping, _ = gear_pair_from_rexs(tmp_path / "pair.rexs")
    assert mapping["mesh"]["stiffness"]["model"] == model
    assert mapping["assumed"]["mesh.stiffness.model"] == model


def test_values_that_cannot_be_assumed_are_asked_for_all_at_once(xml, save):
    text = (
        xml().replace('id="face_width"', 'id="custom_width"').replace('id="number_of_teeth"', 'id="custom_z"')
    )
    with pytest.raises(ParameterError) as refused:
        gear_pair_from_rexs(save(text))
    fields = {p.field.split(" ")[-1] for p in refused.value.problems}
    assert fields == {f"{gear}.{key}" for gear in ("pinion", "gear") for key in ("face_width", "teeth")}


@pytest.mark.parametrize(("old", "new", "message"), [
    (">50.2<", ">fifty<", "a finite number"),
    (">50.2<", ">NaN<", "a finite number"),
    (">50.2<", ">1e999<", "a finite number"),
    ('unit="mm">50.2<', 'unit="kg">50.2<', "a number in mm"),
    ('unit="mm">2<', 'unit="mm">3<', "Gears that mesh have one module"),
    ('"deg">20<', '"deg">22<', "only symmetric teeth"),
    (">14<", ">-14<", r"gear.face_width.*cylindrical_gear 22/face_width"),
])  # fmt: skip
def test_broken_values_are_refused(xml, save, old, new, message):
    text = xml()
    assert old in text
    with pytest.raises(ParameterError, match=message):
        gear_pair_from_rexs(save(text.replace(old, new, 1)))


def test_a_unit_that_is_left_out_is_that_of_the_database(xml, save):
    bare = xml().replace(' unit="mm"', "").replace(' unit="none"', ' unit=""')
    assert gear_pair_from_rexs(save(bare))[0] == gear_pair_from_rexs(save(xml()))[0]


def test_the_speed_of_the_other_shaft_is_carried_over_by_the_ratio(xml, save):
    speed = '<attribute id="rotational_speed" unit="1 / min">1500</attribute>'
    text = xml().replace(speed.replace("1500", "-1500"), "")
    text = text.replace(
        '<component id="32" type="shaft"/>', f'<component id="32" type="shaft">{speed}</component>'
    )
    mapping, _ = gear_pair_from_rexs(save(text))
    # 30 teeth at 1500 rpm drive 20 teeth at 2250 rpm; the conversion to SI rounds twice
    assert mapping["operating"]["pinion_speed"] == pytest.approx(2250.0, rel=1e-14)


def test_torque_from_power_over_speed(xml, save):
    text = xml().replace(
        '<attribute id="torque_around_u_axis" unit="N m">-42.5<', '<attribute id="power" unit="kW">3.5<'
    )
    pair = lumped.load_gear_pair(gear_pair_from_rexs(save(text))[0])
    # 3500 W at 1500 rpm = 157.0796 rad/s
    assert pair.operating.pinion_torque == pytest.approx(3500.0 / (50.0 * math.pi), rel=1e-14)


def test_an_external_torque_on_a_shaft_with_two_gears_is_not_that_of_the_stage(xml, save):
    refs = '<ref id="31" role="assembly"/><ref id="75" role="part"/>'
    further = f'<relation id="85" type="assembly">{refs}</relation>'
    components = '<component id="75" type="cylindrical_gear"/>'
    mapping, notes = gear_pair_from_rexs(save(xml(relations=further, components=components)))
    assert "operating.pinion_torque" in mapping["assumed"]
    assert any("operating.pinion_torque is not in the file" in note for note in notes)


def test_operating_viscosity_is_kinematic(xml, save):
    oil = (
        '<component id="71" type="lubricant">'
        '<attribute id="density_at_15_degree_celsius" unit="kg / dm^3">0.9</attribute></component>'
    )
    stage = '<attribute id="operating_viscosity" unit="mm^2 / s">20</attribute>'
    mapping, _ = gear_pair_from_rexs(save(xml(components=oil, stage=stage)))
    # 20 mm^2/s * 900 kg/m^3 = 18 mPa s, one multiplication
    assert lumped.load_gear_pair(mapping).lubricant.viscosity == pytest.approx(18e-3, rel=1e-15)


def test_other_units_of_the_same_kind_are_converted(xml, save):
    text = xml().replace('unit="mm">50.2<', 'unit="mum">50200<')
    text = text.replace('unit="deg">20<', f'unit="rad">{math.pi / 9!r}<').replace(
        'unit="deg">0<', 'unit="°">0<'
    )
    mapping, _ = gear_pair_from_rexs(save(text))
    pair = lumped.load_gear_pair(mapping)
    assert mapping["centre_distance"] == 50.2
    assert pair.basic_rack.pressure_angle == pytest.approx(math.pi / 9, rel=1e-15)  # one rounding


@pytest.mark.parametrize(("old", "new", "field", "beside"), [
    # a = m (z1 + z2) cos(alpha) / (2 cos(alpha_w)), inv(alpha_w) = inv(alpha) + 2 tan(alpha) x/(z1 + z2)
    (">50.2<", ">50<", "centre_distance = 50 mm.*0.1 and 0, .*10/center_distance", "50.1971 mm for these"),
    (">50.2<", ">502<", "centre_distance = 502 mm.*0.1 and 0, .*10/center_distance", "50.1971 mm for these"),
    # the base circle, m z cos(alpha) = 37.5877 mm
    (">44.2<", ">1<", "pinion.tip_diameter = 1 mm.*21/tip_diameter", "> 37.5877 mm"),
    (">44.2<", ">48<", "pinion.tip_diameter = 48.0000 mm.*21/tip_diameter", "<= 45.4000 mm"),
    # module 3 mm beside diameters of module 2 mm: a > m (z1 + z2) cos(alpha)/2 = 70.4769 mm
    (">2<", ">3<", "centre_distance = 50.2 mm.*10/center_distance", "> 70.4769 mm"),
])  # fmt: skip
def test_a_file_that_contradicts_itself_is_refused_with_both_values(xml, save, old, new, field, beside):
    with pytest.raises(ParameterError, match=rf"{field}\): allowed .*{beside}"):
        gear_pair_from_rexs(save(xml().replace(old, new)))


def test_shafts_of_a_file_are_not_read_and_a_note_says_so(xml, save):
    mapping, notes = gear_pair_from_rexs(save(xml(components='<component id="90" type="shaft_section"/>')))
    assert "shafts" not in mapping
    assert any("shafts of the file are not read" in note for note in notes)
    assert not any("shafts" in note for note in gear_pair_from_rexs(save(xml()))[1])


@pytest.mark.parametrize("version", ["0.9", "", "one", "1.4.x", "2.1.0", "99999999999999999999.0"])
def test_other_versions_are_read_where_they_are_understood_and_a_note_names_them(xml, save, version):
    mapping, notes = gear_pair_from_rexs(save(xml(version=version)))
    assert mapping | {"description": ""} == gear_pair_from_rexs(save(xml()))[0] | {"description": ""}
    assert any(f"of REXS version {version or '(not given)'};" in note for note in notes)
    assert not any("REXS version" in note for note in gear_pair_from_rexs(save(xml()))[1])
