"""Does an export hold what REXS has attributes for, as the published schemas have it, and come back?"""

import math
import re
import xml.etree.ElementTree as ET

import pytest

import lumped
from lumped.lubrication.viscosity import ISO_VG_MIDPOINT
from lumped.schema.pair import leaf_paths
from validation.exchange import gear_pair_from_rexs, write_rexs
from validation.exchange.rexs.exporting import rexs_document
from validation.exchange.rexs.model import ATTRIBUTES, KINDS, WRITTEN, model_of


@pytest.mark.parametrize(("suffix", "first"), [(".rexs", b"<"), (".rexsj", b"{")])
def test_the_ending_says_the_form_and_every_form_is_read(tmp_path, suffix, first):
    path = write_rexs("fzg_c", tmp_path / f"pair{suffix}")
    assert path.read_bytes().removeprefix(b"\xef\xbb\xbf")[:1] == first
    pair = lumped.load_gear_pair(gear_pair_from_rexs(path)[0])
    reference = lumped.load_gear_pair(gear_pair_from_rexs(write_rexs("fzg_c", tmp_path / "other.rexs"))[0])
    assert pair.with_(sources={}, description="") == reference.with_(sources={}, description="")


def test_everything_that_rexs_can_say_comes_back(preset, tmp_path):
    back = lumped.load_gear_pair(gear_pair_from_rexs(write_rexs(preset, tmp_path / "pair.rexs"))[0])
    sent = leaf_paths(preset)
    got = leaf_paths(back)
    lost = {path for path in sent if got.get(path) != sent[path]} - {"description"}
    beyond = (
        "bearings.", "mesh.damping_ratio", "mesh.contact", "mesh.stiffness.", "lubricant.viscosity",
        "friction.composite_roughness", "friction.law",
    )  # fmt: skip
    assert all(path.startswith(beyond) for path in lost), lost
    # A tip diameter says what a default addendum said; the geometry is the same to the fifteenth digit.
    # REXS has no stiffness model and no bearings: what stands in has parameters of its own.
    more = {p for p in set(got) - set(sent) if not p.startswith(("mesh.stiffness.", "bearings."))}
    assert more <= {"pinion.tip_diameter", "gear.tip_diameter"}
    for name in ("contact_ratio", "L_XA", "L_XD", "centre_distance", "normal_backlash", "mesh_period"):
        sent_value, got_value = (getattr(lumped.geometry(p), name) for p in (preset, back))
        # backlash is a difference of lengths 1000 times its size, in fifteen digits
        assert got_value == pytest.approx(sent_value, rel=1e-11)


def test_an_oil_by_grade_is_written_by_its_two_viscosities():
    law = {"iso_vg": 220, "viscosity_index": 95, "temperature": 70}
    pair = lumped.load_gear_pair("fzg_c").with_(lubricant__viscosity_law=law)
    (oil,) = model_of(rexs_document(pair), "").of_type("lubricant")
    v40, v100 = (oil.attributes[f"viscosity_at_{t}_degree_celsius"].value for t in (40, 100))
    assert v40 == pytest.approx(ISO_VG_MIDPOINT[220], rel=1e-12)  # the grade is its viscosity at 40 degC
    # ISO VG 220 of viscosity index 95 has about 19 mm^2/s at 100 degC in any data sheet
    assert 18.0 < v100 < 20.0


def test_speeds_and_torques_have_the_signs_of_an_external_pair(tmp_path):
    pair = lumped.load_gear_pair("nasa_art_25_31").with_(operating__brake_torque=70)
    document = rexs_document(pair)
    first, second = model_of(document, "").of_type("shaft")
    drive, brake = model_of(document, "").of_type("external_load")

    def value(component, key):
        return component.attributes[key].value

    speeds = [value(shaft, "rotational_speed") for shaft in (first, second)]
    torques = [value(load, "torque_around_u_axis") for load in (drive, brake)]
    assert speeds[0] == 4875.0
    assert speeds[1] == pytest.approx(-4875.0 * 25 / 31, rel=1e-14)  # an external pair turns opposite ways
    assert torques[0] * speeds[0] > 0 > torques[1] * speeds[1]  # power goes in at the drive, out at the brake
    places = [
        attribute["floating_point_array"]
        for component in document["model"]["components"]
        for attribute in component["attributes"]
        if component["type"] == "shaft" and attribute["id"] == "support_vector"
    ]
    assert math.dist(*places) == 88.9


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
            assert attribute.get("unit") == ATTRIBUTES[key]
            if key not in KINDS:
                digits = re.sub(r"e.*|\D", "", attribute.text).lstrip("0")
                assert len(digits) <= 15
