"""Does a pair survive the way through a REXS file, and does the file say what REXS says it should?"""

import json
import math
import re
import xml.etree.ElementTree as ET

import pytest

import lumped
from lumped.lubrication.viscosity import ISO_VG_MIDPOINT
from validation.exchange import gear_pair_from_rexs, write_rexs
from validation.exchange.rexs.exporting import rexs_model
from validation.exchange.rexs.vocabulary import ATTRIBUTES, WRITTEN

#: Ending -> first letter of the file after its byte order mark: XML, JSON, and ZIP, which packs XML.
ENDINGS = {
    ".rexs": b"<",
    ".rexs.xml": b"<",
    ".rexsj": b"{",
    ".rexs.json": b"{",
    ".rexsz": b"P",
    ".rexs.zip": b"P",
}


def read_back(pair, path, **options):
    mapping, notes = gear_pair_from_rexs(write_rexs(pair, path, **options))
    return lumped.load_gear_pair(mapping), notes


def without_sources(pair):
    return pair.with_(sources={})


@pytest.mark.parametrize("version", WRITTEN)
@pytest.mark.parametrize("suffix", [".rexs", ".rexsj"])
def test_every_preset_comes_back_exactly_in_both_encodings_and_every_version(
    preset, tmp_path, suffix, version
):
    pair, _ = read_back(preset, tmp_path / f"pair{suffix}", version=version)
    assert without_sources(pair) == without_sources(preset)


@pytest.mark.parametrize("suffix", ENDINGS)
def test_the_ending_says_the_form_and_every_form_is_read(tmp_path, suffix):
    sent, path = lumped.load_gear_pair("fzg_c"), tmp_path / f"pair{suffix}"
    pair, _ = read_back(sent, path)
    assert path.read_bytes().removeprefix(b"\xef\xbb\xbf")[:1] == ENDINGS[suffix]
    assert without_sources(pair) == without_sources(sent)


def test_a_pair_with_odd_digits_and_every_option_comes_back_exactly(tmp_path):
    third = 1.0 / 3.0
    pair = lumped.load_gear_pair("nasa_28_28").with_(
        basic_rack__module=3.0 + third / 7.0,
        centre_distance=None,
        pinion__profile_shift=third / 2.0,
        pinion__addendum=3.1 + third / 10.0,
        gear__tip_diameter=None,
        pinion__tip_relief={"shape": "parabolic", "amount": 20 * third, "start_roll_angle": 24 + third},
        gear__root_relief={"amount": 10 * third, "start_roll_angle": 17 - third},
        pinion__mass=third,
        pinion__inertia=third / 1000.0,
        mesh__stiffness={"model": "energy", "hertz": "linear"},
        lubricant__viscosity_law={"iso_vg": 100, "temperature": 60 + third},
        friction__law="smoothed_coulomb",
        friction__coefficient=third / 5.0,
        operating__pinion_torque=100 * third,
        operating__brake_torque=99 * third,
        operating__pinion_speed=4000 * third,
    )
    for suffix in (".rexs", ".rexsj"):
        back, notes = read_back(pair, tmp_path / f"pair{suffix}")
        assert without_sources(back) == without_sources(pair)
        assert not any("changed in the file" in note for note in notes)


def test_without_the_record_everything_that_rexs_can_say_comes_back(preset, tmp_path, leaves):
    back, _ = read_back(preset, tmp_path / "pair.rexs", record=False)
    sent, got = leaves(preset.to_mapping()), leaves(back.to_mapping())
    lost = {path for path in sent if got.get(path) != sent[path]}
    beyond = (
        "bearings.",
        "mesh.damping_ratio",
        "mesh.contact",
        "mesh.stiffness.",
        "lubricant.viscosity",
        "friction.composite_roughness",
    )
    assert all(path.startswith(beyond) for path in lost), lost
    # A tip diameter says what a default addendum said; the geometry is the same to the fifteenth digit.
    assert set(got) - set(sent) <= {"pinion.tip_diameter", "gear.tip_diameter"}
    for name in ("contact_ratio", "L_XA", "L_XD", "centre_distance", "normal_backlash", "mesh_period"):
        sent_value, got_value = (getattr(lumped.geometry(p), name) for p in (preset, back))
        # backlash is a difference of lengths 1000 times its size, in fifteen digits
        assert got_value == pytest.approx(sent_value, rel=1e-11)


def test_a_value_changed_by_another_program_wins_over_the_record(tmp_path):
    preset = lumped.load_gear_pair("nasa_28_28")
    path = write_rexs(preset, tmp_path / "pair.rexs")
    text = path.read_text(encoding="utf-8-sig")
    changed = re.sub(r'(id="face_width" unit="mm">)6.35<', r"\g<1>7.5<", text, count=1)
    changed = changed.replace(">56.5<", ">60<")
    assert changed != text
    path.write_text(changed, encoding="utf-8")
    mapping, notes = gear_pair_from_rexs(path)
    pair = lumped.load_gear_pair(mapping)
    expected = preset.with_(pinion__face_width=7.5, operating__pinion_torque=60)
    assert without_sources(pair) == without_sources(expected)
    assert "changed in the file since spurcheck wrote it: pinion.face_width, operating.pinion_torque" in notes
    assert mapping["sources"]["pinion.face_width"] == "REXS pair.rexs cylindrical_gear 4/face_width"


def test_a_relief_taken_off_and_an_oil_put_in_by_another_program_are_followed(tmp_path):
    preset = lumped.load_gear_pair("nasa_28_28")
    document = json.loads(write_rexs(preset, tmp_path / "pair.rexsj").read_text(encoding="utf-8-sig"))
    model = document["model"]
    reliefs = {c["id"] for c in model["components"] if c["type"] == "tip_relief"}
    model["components"] = [c for c in model["components"] if c["id"] not in reliefs]
    model["relations"] = [r for r in model["relations"] if not reliefs & {ref["id"] for ref in r["refs"]}]
    oil = {"viscosity_at_40_degree_celsius": 150.0, "viscosity_at_100_degree_celsius": 15.0}
    attributes = [{"id": k, "unit": "mm^2 / s", "floating_point": v} for k, v in oil.items()]
    model["components"].append({"id": 99, "type": "lubricant", "attributes": attributes})
    (tmp_path / "changed.rexsj").write_text(json.dumps(document), encoding="utf-8")
    pair = lumped.load_gear_pair(gear_pair_from_rexs(tmp_path / "changed.rexsj")[0])
    assert pair.pinion.tip_relief is None
    assert pair.gear.tip_relief is None
    assert pair.lubricant.viscosity is None
    assert pair.lubricant.viscosity_law.kinematic_viscosity_40 == pytest.approx(150e-6, rel=1e-15)
    assert pair.friction == preset.friction


def test_an_assumption_stays_an_assumption_however_often_it_is_passed_on(tmp_path):
    pair = lumped.load_gear_pair("fzg_c")
    for turn in range(3):
        pair, _ = read_back(pair, tmp_path / f"turn{turn}.rexs")
    sources = dict(pair.sources)
    assert sources["pinion.roughness"] == "assumed"
    assert sources["bearings.gear.loa_stiffness"] == "assumed"
    assert sources["pinion.teeth"].endswith("FZG test gears type C: 16/24")


def test_an_oil_by_grade_is_written_by_its_two_viscosities():
    law = {"iso_vg": 220, "viscosity_index": 95, "temperature": 70}
    model = rexs_model(lumped.load_gear_pair("fzg_c").with_(lubricant__viscosity_law=law))
    (oil,) = model.of_type("lubricant")
    v40, v100 = (oil.attributes[f"viscosity_at_{t}_degree_celsius"].value for t in (40, 100))
    assert v40 == pytest.approx(ISO_VG_MIDPOINT[220], rel=1e-12)  # the grade is its viscosity at 40 degC
    # ISO VG 220 of viscosity index 95 has about 19 mm^2/s at 100 degC in any data sheet
    assert 18.0 < v100 < 20.0


def test_speeds_and_torques_have_the_signs_of_an_external_pair(tmp_path):
    pair = lumped.load_gear_pair("nasa_art_25_31").with_(operating__brake_torque=70)
    first, second = rexs_model(pair).of_type("shaft")
    drive, brake = rexs_model(pair).of_type("external_load")

    def value(component, key):
        return component.attributes[key].value

    speeds = [value(shaft, "rotational_speed") for shaft in (first, second)]
    torques = [value(load, "torque_around_u_axis") for load in (drive, brake)]
    assert speeds[0] == 4875.0
    assert speeds[1] == pytest.approx(-4875.0 * 25 / 31, rel=1e-14)  # an external pair turns opposite ways
    assert torques[0] * speeds[0] > 0 > torques[1] * speeds[1]  # power goes in at the drive, out at the brake
    assert (
        math.dist(first.attributes["support_vector"].value, second.attributes["support_vector"].value) == 88.9
    )


@pytest.mark.parametrize("version", WRITTEN)
def test_the_file_uses_only_checked_attributes_and_fits_the_rules_of_the_schema(preset, tmp_path, version):
    root = ET.parse(write_rexs(preset, tmp_path / "pair.rexs", version)).getroot()
    assert (tmp_path / "pair.rexs").read_bytes().startswith(b"\xef\xbb\xbf<?xml")
    assert {"version", "applicationId", "applicationVersion", "date"} <= set(root.attrib)
    assert root.get("version") == version
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d[+-]\d\d:\d\d", root.get("date"))
    assert [child.tag for child in root] == ["relations", "components"]
    components = {c.get("id"): c for c in root.iter("component")}
    assert len(components) == len(list(root.iter("component")))
    assert {ref.get("id") for ref in root.iter("ref")} == set(components), "every component is related"
    ids = [relation.get("id") for relation in root.iter("relation")]
    assert len(set(ids)) == len(ids)
    for component in components.values():
        for attribute in component:
            key = attribute.get("id")
            if key == "custom_spurcheck_parameters":
                assert re.fullmatch("[a-z0-9_]+", key)  # what REXS allows in a name
                continue
            known = ATTRIBUTES[component.get("type")][key]
            assert known.of(version)
            assert attribute.get("unit") == known.unit
            if known.kind == "floating_point":
                digits = re.sub(r"e.*|\D", "", attribute.text).lstrip("0")
                assert len(digits) <= 15


def test_both_forms_hold_the_same_model(preset, tmp_path):
    document = json.loads(write_rexs(preset, tmp_path / "pair.rexsj").read_text(encoding="utf-8-sig"))
    root = ET.parse(write_rexs(preset, tmp_path / "pair.rexs")).getroot()
    for written, element in zip(document["model"]["components"], root.iter("component"), strict=True):
        assert (str(written["id"]), written["type"]) == (element.get("id"), element.get("type"))
        for one, other in zip(written["attributes"], element, strict=True):
            assert one["id"] == other.get("id")
            kind, value = next((k, v) for k, v in one.items() if k not in ("id", "unit"))
            if kind in ("floating_point", "integer", "reference_component"):
                assert value == float(other.text)
                assert value == float(f"{value:.15g}")  # the digits that REXS allows
            elif kind == "boolean":
                assert value == (other.text == "true")
            elif kind == "floating_point_array":
                assert value == [float(cell.text) for cell in other.iter("c")]
            else:
                assert value == other.text
    relations = [[(ref["id"], ref["role"]) for ref in r["refs"]] for r in document["model"]["relations"]]
    assert relations == [[(int(ref.get("id")), ref.get("role")) for ref in r] for r in root.iter("relation")]
