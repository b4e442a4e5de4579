"""Are everyday forms read as what they mean: relief, classes, oils, the fillet that nobody gave, scope?"""

import math
import re
import warnings

import numpy as np
import pytest

import spurcheck
from lumped import ParameterError, State, flank_tolerances, json_schema, load_gear_pair
from lumped.fields.scope import LIMITS, about_key, about_teeth
from lumped.gear_geometry.roll_angle import diameter_of, roll_angle_of
from lumped.quasi_static.tooth_error import relief_error
from lumped.schema.oil_grade import grade_of
from lumped.schema.tolerances import tolerance_class_of
from multibody.gears.circles import circles, reliefs
from tests.unlike_pairs import unlike_pair
from validation.exchange import gear_pair_from_rexs, write_rexs

RELIEFS = ("tip_relief", "root_relief")
PAIRS = ["rack_25_degrees_always_pushing", "contact_ratio_2_3_on_shafts", "heavily_relieved_under_load"]
DRAWING = {"module": 2.5, "face_width": 20, "speed": 1450, "torque": 80}


def ends(pair, gear):
    """Base radius, and roll lengths of the tip and of the mate's tip, from radii alone [mm]."""
    g = pair.geometry
    mate = {"pinion": "gear", "gear": "pinion"}[gear]
    base, tip = (1e3 * getattr(g, f"{what}_radius_{gear}") for what in ("base", "tip"))
    mate_base, mate_tip = (1e3 * getattr(g, f"{what}_radius_{mate}") for what in ("base", "tip"))
    line = math.sqrt((1e3 * g.centre_distance) ** 2 - (base + mate_base) ** 2)
    return base, math.sqrt(tip**2 - base**2), line - math.sqrt(mate_tip**2 - mate_base**2)


def test_a_roll_angle_is_the_tangent_of_the_profile_angle():
    for base, angle in ((37.1, 14.5), (81.4, 20.0), (12.3, 31.0)):
        diameter = 2.0 * base / math.cos(math.radians(angle))
        assert roll_angle_of(diameter, base) == pytest.approx(math.tan(math.radians(angle)), rel=1e-13)
        assert diameter_of(roll_angle_of(diameter, base), base) == pytest.approx(diameter, rel=1e-15)
    assert roll_angle_of(2.0 * 37.1, 37.1) == 0.0


@pytest.mark.parametrize("gear", ["pinion", "gear"])
@pytest.mark.parametrize("kind", ["tip_relief", "root_relief"])
@pytest.mark.parametrize("name", PAIRS)
def test_the_three_starts_of_a_relief_are_one_place(name, kind, gear):
    """Roll length is measured from the end at which the amount is removed; hand values from circles."""
    pair = unlike_pair(name).with_({f"{g}.{k}": None for g in ("pinion", "gear") for k in RELIEFS})
    base, tip, start = ends(pair, gear)
    length = 0.37 * (tip - start)
    place = tip - length if kind == "tip_relief" else start + length
    stated = {
        "length": f"{length!r} mm",
        "start_diameter": f"{2.0 * math.hypot(base, place)!r} mm",
        "start_roll_angle": f"{place / base!r} rad",
    }
    xi = np.linspace(pair.geometry.L_XA, pair.geometry.L_XD, 41)
    errors = []
    for field, value in stated.items():
        one = pair.with_({f"{gear}.{kind}": {"amount": 23, "shape": "parabolic", field: value}})
        relief = getattr(getattr(one, gear), kind)
        assert relief.start_roll_angle == pytest.approx(place / base, rel=1e-12)
        assert set(relief.to_mapping()) == {"amount", "shape", field}
        assert load_gear_pair(one.to_mapping()) == one
        assert one.state(f"{gear}.{kind}.{field}") is State.KNOWN
        assert not any(kind in path for path in one.assumed)
        errors.append(relief_error(one, xi))
    assert errors[0].max() == pytest.approx(23e-6, rel=1e-12)
    for other in errors[1:]:
        np.testing.assert_allclose(other, errors[0], rtol=0, atol=1e-16)


def test_the_multibody_model_starts_a_relief_by_its_own_formulas():
    pair = unlike_pair("rack_25_degrees_always_pushing")
    for gear, gear_number in (("pinion", 0.0), ("gear", 1.0)):
        base, tip, start = ends(pair, gear)
        for field, value, places in (
            ("length", 2.17, (tip - 2.17, start + 2.17)),
            (
                "start_diameter",
                2.0 * math.hypot(base, 0.6 * tip + 0.4 * start),
                (0.6 * tip + 0.4 * start,) * 2,
            ),
        ):
            for kind, place in zip(RELIEFS, places, strict=True):
                none = {f"{g}.{k}": None for g in ("pinion", "gear") for k in RELIEFS}
                one = pair.with_({**none, f"{gear}.{kind}": {"amount": 9, field: value}})
                rows = reliefs(one, circles(one))
                assert [(row.gear, row.amount) for row in rows] == [(gear_number, pytest.approx(9e-6))]
                assert rows[0].start == pytest.approx(place / base, rel=1e-11)


def test_a_relief_by_length_leaves_as_the_diameter_of_its_start(tmp_path):
    """REXS has a diameter; the base circle and the tip give it from the roll length."""
    pair = spurcheck.new_pair("23/38", **DRAWING, changes={"gear.tip_relief": {"amount": 17, "length": 2.3}})
    base, tip, _ = ends(pair, "gear")
    write_rexs(pair, tmp_path / "pair.rexs")
    mapping, _ = gear_pair_from_rexs(tmp_path / "pair.rexs")
    relief = load_gear_pair(mapping).gear.tip_relief
    assert relief.start_roll_angle == pytest.approx((tip - 2.3) / base, rel=1e-9)


def test_a_length_moves_with_the_tip_and_a_diameter_stays():
    pair = unlike_pair("heavily_relieved_under_load")
    base, tip, _ = ends(pair, "gear")
    by_length = pair.with_({"gear.tip_relief": {"amount": 21, "length": 3.1}})
    by_diameter = pair.with_(
        {"gear.tip_relief": {"amount": 21, "start_diameter": 2 * math.hypot(base, tip - 3.1)}}
    )
    lower = 2.0 * math.hypot(base, tip - 0.4)
    length_kept, diameter_kept = (one.with_(gear__tip_diameter=lower) for one in (by_length, by_diameter))
    assert length_kept.gear.tip_relief.start_roll_angle == pytest.approx((tip - 3.5) / base, rel=1e-11)
    assert diameter_kept.gear.tip_relief.start_roll_angle == pytest.approx((tip - 3.1) / base, rel=1e-11)


def test_naming_one_start_replaces_the_other():
    pair = unlike_pair("heavily_relieved_under_load").with_(pinion__tip_relief__length=2.9)
    assert "start_roll_angle" not in pair.pinion.tip_relief.to_mapping()
    back = pair.with_(pinion__tip_relief__start_roll_angle=27.0)
    assert set(back.pinion.tip_relief.to_mapping()) == {"shape", "amount", "start_roll_angle"}


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (
            {},
            r"start_roll_angle = missing: allowed exactly one of start_roll_angle, start_diameter or length",
        ),
        (
            {"length": 3, "start_diameter": 90},
            r"start_roll_angle = start_diameter and length: allowed exactly",
        ),
        ({"start_diameter": 70}, r"start_diameter = 70 mm: allowed \d+\.\d+ to \d+\.\d+ mm"),
        ({"length": 90}, r"length = 90 mm: allowed > 0 and < \d+\.\d+ mm, the active flank"),
        ({"length": 0}, r"length = 0 mm: allowed > 0 mm"),
    ],
)
def test_a_start_that_is_none_is_refused(nasa, more, words):
    with pytest.raises(ParameterError, match=rf"gear\.tip_relief\.{words}"):
        nasa.with_({"gear.tip_relief": {"amount": 20, **more}})


def test_the_json_schema_asks_for_one_start():
    relief = json_schema()["$defs"]["ProfileRelief"]
    assert [one["required"] for one in relief["oneOf"]] == [
        ["start_roll_angle"],
        ["start_diameter"],
        ["length"],
    ]
    assert relief["required"] == ["amount"]
    schemas = json_schema()["$defs"]
    for section, field in (("Deviations", "tolerance_class"), ("ViscosityLaw", "iso_vg")):
        kinds = {one.get("type") for one in schemas[section]["properties"][field]["anyOf"]}
        assert {"integer", "string"} <= kinds


# ---- accuracy class ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "text", ["7", "ISO 7", "iso7", "ISO 1328 class 7", "ISO 1328-1:2013, class 7", "DIN ISO 1328 - 7", "Q7",
             "class 7", "DIN EN ISO 1328-1 grade 7"],
)  # fmt: skip
def test_a_class_of_iso_1328(text):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        pair = unlike_pair("rack_25_degrees_always_pushing").with_({"gear.deviations.tolerance_class": text})
    assert pair.gear.deviations.tolerance_class == 7
    assert pair.to_mapping()["gear"]["deviations"]["tolerance_class"] == 7


@pytest.mark.parametrize("text", ["DIN 5", "DIN 3962 5", "DIN 3962-1 class 5", "din 5"])
def test_a_class_of_din_3962_is_read_with_a_warning(nasa, text):
    with pytest.warns(UserWarning, match="DIN 3962 has its own table"):
        assert nasa.with_({"gear.deviations": {"tolerance_class": text}}).gear.deviations.tolerance_class == 5


#: DIN 3962-1:1978, quality 6, module 1 to 2 mm: range of the diameter [mm], f_p and F_p [um].
DIN_6 = [((10, 50), 7, 18), ((50, 125), 7, 25), ((125, 280), 8, 28), ((280, 560), 8, 32)]


@pytest.mark.parametrize(("diameters", "pitch", "total"), DIN_6)
def test_class_6_of_both_standards_is_near(diameters, pitch, total):
    tolerances = flank_tolerances(round(sum(diameters) / 2 / 1.5), 1.5e-3, 6)
    assert 1e6 * tolerances["f_p"] == pytest.approx(pitch, rel=0.2)
    # Small gears: the fifth of the theory page begins at 50 mm.
    assert 1e6 * tolerances["F_p"] == pytest.approx(total, rel=0.2 if diameters[0] >= 50 else 0.28)


@pytest.mark.parametrize("value", ["DIN 5482 6", "ISO 6336 6", "AGMA 10", "ISO 53 6", "six", "", "ISO 1328"])
def test_text_that_is_no_class_is_refused(nasa, value):
    words = r"tolerance_class = .*: allowed 1 to 11, or text such as 'ISO 6' or 'DIN 6'\. Write the class"
    with pytest.raises(ParameterError, match=rf"pinion\.deviations\.{words}"):
        nasa.with_({"pinion.deviations.tolerance_class": value})


def test_classes_that_no_standard_has_are_refused(nasa):
    for value in ("ISO 12", "ISO 0"):
        with pytest.raises(ParameterError, match=r"tolerance_class = 1?[02]: allowed"):
            nasa.with_({"pinion.deviations.tolerance_class": value})
    assert tolerance_class_of(6) == 6
    with pytest.raises(ParameterError, match="17 less the number"):
        tolerance_class_of("AGMA Q10")


# ---- oil --------------------------------------------------------------------------------------------------

OILS = ["ISO VG 68", "VG68", "vg 68", "vg68", "ISO-VG 68", "iso 68", "68", 68, "CLP 68", "HLP 68",
        "ISO 3448 VG 68", "68 cSt", "68 mm²/s", "68 mm2/s at 40 °C", "0.68 St"]  # fmt: skip


@pytest.mark.parametrize("oil", OILS)
def test_an_oil_by_any_name(nasa, oil):
    assert grade_of(oil) == 68
    pair = unlike_pair("larger_gear_drives_contact_lost")
    by_name = pair.with_(oil=oil, temperature=71)
    assert by_name.lubricant.viscosity_law.iso_vg == 68
    law = {"iso_vg": oil, "temperature": 71}
    assert pair.with_({"lubricant.viscosity_law": law}).lubricant == by_name.lubricant


@pytest.mark.parametrize(
    ("oil", "words"),
    [
        ("70 cSt", "the nearest is VG 68. For an oil between grades"),
        ("68 cSt at 100 °C", "For example vg220"),
        ("SAE 90", "SAE numbers are classes of the viscosity at 100 degC"),
        ("mineral", "For example vg220"),
        ("VG 69", "Pick a grade of ISO 3448"),
    ],
)
def test_an_oil_that_has_no_grade_is_refused(nasa, oil, words):
    for changes in (
        {"oil": oil, "temperature": 60},
        {"lubricant.viscosity_law": {"iso_vg": oil, "temperature": 60}},
    ):
        with pytest.raises(ParameterError, match=words):
            nasa.with_(changes)


def test_a_kinematic_viscosity_is_no_dynamic_one(nasa):
    """nu rho = 32e-6 m^2/s x 870 kg/m^3 = 27.84 mPa s at the inlet; at 40 degC it is the oil VG 32."""
    with pytest.raises(ParameterError) as error:
        nasa.with_(viscosity="32 cSt")
    (problem,) = error.value.problems
    assert problem.field == "lubricant.viscosity"
    inlet = re.findall(r"'([\d.]+ mPa\*s)'", problem.action)
    law = "iso_vg = '32 cSt', temperature = 70"
    assert law in problem.action
    assert nasa.with_(viscosity=inlet[0]).lubricant.dynamic_viscosity == pytest.approx(32e-6 * 870, rel=1e-4)
    grade = {"iso_vg": "32 cSt", "temperature": 40}
    law_40 = nasa.with_({"lubricant.viscosity_law": grade}).lubricant
    # Oil is 1.6 % less dense at 40 than at 15 degC.
    assert law_40.dynamic_viscosity == pytest.approx(32e-6 * 870, rel=0.02)


# ---- fillet of a rack that gives none ---------------------------------------------------------------------


def full_radius(angle, dedendum):
    """Radius of the circle that touches the flanks and the tip of a rack's tooth, over module.

    Its centre is on the tooth's centre line, rho inside the tip; its distance from a flank is rho.
    """
    a = math.radians(angle)
    # At the height of the centre, h - rho, half the width is pi/4 - (h - rho) tan a; times cos a it is rho.
    low, high = 0.0, 1.0
    for _ in range(80):
        rho = 0.5 * (low + high)
        inside = (0.25 * math.pi - (dedendum - rho) * math.tan(a)) * math.cos(a) > rho
        low, high = (rho, high) if inside else (low, rho)
    return low


@pytest.mark.parametrize(
    ("changes", "angle", "dedendum"),
    [
        ({}, 20.0, 1.25),
        ({"pressure_angle": 25}, 25.0, 1.25),
        ({"pressure_angle": "28°"}, 28.0, 1.25),
        ({"basic_rack.dedendum_coefficient": 1.5}, 20.0, 1.5),
        ({"basic_rack.addendum_coefficient": 1.15, "pressure_angle": 22.5}, 22.5, 1.4),
        ({"basic_rack.addendum_coefficient": 0.8}, 20.0, 1.05),
    ],
)
def test_a_new_pair_assumes_a_fillet_that_fits(changes, angle, dedendum):
    pair = spurcheck.new_pair("37/52", **DRAWING, changes=changes)
    full = full_radius(angle, dedendum)
    expected = 0.38 if full >= 0.38 else math.floor(95.0 * full) / 100.0
    assert pair.basic_rack.dedendum_coefficient == pytest.approx(dedendum, abs=1e-12)
    assert pair.basic_rack.fillet_radius_coefficient == expected <= full
    assert pair.state("basic_rack.fillet_radius_coefficient") is State.ASSUMED
    assert load_gear_pair(pair.to_mapping()) == pair


def test_the_assumed_fillet_follows_and_a_typed_one_stays():
    pair = spurcheck.new_pair("29/41", **DRAWING)
    steep = pair.with_(pressure_angle=25)
    assert steep.basic_rack.fillet_radius_coefficient == 0.30
    assert steep.with_(pressure_angle=20) == pair.with_(pressure_angle=20)
    fillet = {"basic_rack.fillet_radius_coefficient": 0.25}
    for typed in (pair.with_(fillet), spurcheck.new_pair("29/41", **DRAWING, changes=fillet)):
        assert typed.with_(pressure_angle=25).basic_rack.fillet_radius_coefficient == 0.25
    with pytest.raises(ParameterError, match=r"fillet_radius_coefficient = 0.38: allowed <= 0.3179"):
        spurcheck.new_pair("29/41", **DRAWING, pressure_angle=25, basic_rack__fillet_radius_coefficient=0.38)
    with pytest.raises(ParameterError, match=r"dedendum_coefficient = 1.25: allowed <= 1.1217"):
        spurcheck.new_pair("29/41", **DRAWING, pressure_angle=35)


def test_a_guess_of_the_user_stays_a_guess():
    """A fillet that the user assumes, in [assumed], is not that of the rule, and is not replaced."""
    data = spurcheck.new_pair("29/41", **DRAWING).to_mapping()
    data["basic_rack"]["fillet_radius_coefficient"] = data["assumed"][
        "basic_rack.fillet_radius_coefficient"
    ] = 0.2
    guess = load_gear_pair(data)
    assert guess.state("basic_rack.fillet_radius_coefficient") is State.ASSUMED
    assert guess.with_(pressure_angle=25).basic_rack.fillet_radius_coefficient == 0.2


# ---- what is not computed ---------------------------------------------------------------------------------


@pytest.mark.parametrize(("key", "limit"), [(key, limit) for limit in LIMITS for key in limit.keys])
def test_a_key_of_what_is_not_computed_has_its_sentence(key, limit):
    sentence = re.escape(limit.sentence)
    base = unlike_pair("contact_ratio_2_3_on_shafts")
    with pytest.raises(ParameterError, match=sentence):
        base.with_({key: 5})
    with pytest.raises(ParameterError, match=sentence):
        spurcheck.new_pair("21/43", **DRAWING, changes={key: 5})


def test_every_limit_has_keys_and_a_sentence_of_its_own():
    assert all(limit.keys for limit in LIMITS)
    assert len({limit.sentence for limit in LIMITS}) == len(LIMITS)


def test_keys_of_the_schema_have_no_such_sentence():
    """Or a misspelt neighbour of a field would be told that it is not computed."""
    names = {name for section in json_schema()["$defs"].values() for name in section["properties"]}
    assert [name for name in names | set(json_schema()["properties"]) if about_key(name)] == []
    assert [about_key(name) for name in ("leading", "string", "stiffness")] == ["", "", ""]


@pytest.mark.parametrize(
    ("teeth", "limit"),
    [("20/-60", 1), ("-60/20", 1), ((20, -60), 1), ("20/−60", 1), ("12/24/48", 2), ((12, 24, 48), 2),
     ("12-24-48", 2), ("20/-40/60", 1)],
)  # fmt: skip
def test_teeth_of_what_is_not_computed_have_its_sentence(nasa, teeth, limit):
    sentence = re.escape(LIMITS[limit].sentence)
    for action in (lambda: spurcheck.new_pair(teeth, **DRAWING), lambda: nasa.with_(teeth=teeth)):
        with pytest.raises(ParameterError, match=rf"teeth = .*allowed PINION/GEAR\. {sentence}"):
            action()


def test_negative_teeth_of_a_file_have_its_sentence(nasa):
    data = nasa.to_mapping()
    data["gear"]["teeth"] = -60
    with pytest.raises(ParameterError, match=rf"gear\.teeth = -60.*{re.escape(LIMITS[1].sentence)}"):
        load_gear_pair(data)
    assert about_teeth("19") == about_teeth("nineteen/41") == about_teeth("19/41") == ""
