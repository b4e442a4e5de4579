"""Does the table of a pair print what published tables and protocols of gear programs print?

Each file of `published/` is one pair: inputs, printed results with their digits, and where they are printed.
"""

import math
import tomllib
from dataclasses import replace
from pathlib import Path

import pytest

from lumped import load_gear_pair
from lumped.gear_geometry.geometry import theoretical_backlash
from lumped.gear_geometry.measures import (
    as_made,
    ball_touching_at,
    gear_table,
    over_balls,
    shift_from_span,
    span,
    teeth_spanned,
)

FILES = sorted((Path(__file__).parent / "published").glob("*.toml"))
TABLES = {path.stem: tomllib.loads(path.read_text(encoding="utf-8")) for path in FILES}


def is_printed(value: float, text: str) -> bool:
    """Whether a value rounds to a printed one: half of its last digit, and the rounding of doubles."""
    _, _, decimals_of_text = text.partition(".")
    decimals = len(decimals_of_text)
    return abs(value - float(text)) <= 0.5 * 10.0**-decimals + 1e-9


def assert_printed(value: float, text: str, where: str) -> None:
    assert is_printed(value, text), f"{where}: {value:.6f}, printed {text}"


def loaded(inputs, **changes):
    """The pair of these inputs; the rest is that of the default pair, and no backlash."""
    data = load_gear_pair("nasa_28_28").to_mapping()
    for name in ("centre_distance", "assumed", "sources", "uncertainty"):
        data.pop(name, None)
    for name in ("pinion", "gear"):
        data[name] = {"face_width": 20.0, "roughness": 0.4}
    data["basic_rack"] = {}
    data["mesh"]["backlash"] = 0.0
    for path, value in (inputs | changes).items():
        *parents, leaf = path.split(".")
        node = data
        for parent in parents:
            node = node[parent]
        node[leaf] = value
    return load_gear_pair(data)


def of_pair(pair, table):
    """Printed quantities of a pair that the table does not name, in mm."""
    g = pair.geometry
    lengths = {name: 1e3 * getattr(g, name) for name in ("L_XA", "L_XB", "L_XP", "L_XC", "L_XD", "L_XY")}
    return lengths | {
        "base_pitch": 1e3 * g.base_pitch,
        "shift_sum": table.pinion.profile_shift + table.gear.profile_shift,
        "contact_path_AE": lengths["L_XD"] - lengths["L_XA"],
        "contact_path_AC": lengths["L_XP"] - lengths["L_XA"],  # C is the pitch point in German books
        "contact_path_AB": lengths["L_XB"] - lengths["L_XA"],
        "line_of_action_T1T2": lengths["L_XY"],
        "common_depth": 1e3 * (g.tip_radius_pinion + g.tip_radius_gear - g.centre_distance),
    }


def of_gear(pair, table, gear_index):
    """Printed quantities of one gear that the table does not name, in mm."""
    g = pair.geometry
    one = (table.pinion, table.gear)[gear_index]
    tooth = pair.wheels[gear_index].tooth
    contact = (g.L_XA, g.L_XY - g.L_XD)[gear_index]
    shifted = tooth.reference_radius + tooth.profile_shift * tooth.module
    radii = {
        f"{name}_radius": 5e2 * getattr(one, f"{name}_diameter")
        for name in ("tip", "root", "base", "operating", "form")
    }
    return radii | {
        "active_root_diameter": 2e3 * math.hypot(tooth.base_radius, contact),
        "tip_thickness_over_module": one.tip_thickness / tooth.module,
        "chosen_teeth_spanned": teeth_spanned(tooth, shifted),
        "ideal_ball": 1e3 * ball_touching_at(tooth, shifted),
    }


def in_drawing_units(record):
    """Values of a record of the table by name, in the units that its fields show."""
    scale = {"mm": 1e3, "deg": math.degrees(1.0), "": 1.0}
    named = {name: about for name, about in record.__dataclass_fields__.items() if about.metadata}
    return {name: getattr(record, name) * scale[about.metadata["unit"]] for name, about in named.items()}


@pytest.mark.parametrize("name", TABLES)
def test_every_printed_number_is_met_to_its_last_digit(name):
    printed = TABLES[name]
    pair = loaded(printed["inputs"])
    with_ = printed.get("measured_with", {})
    balls = tuple(1e-3 * ball for ball in with_["balls"]) if with_ else None
    table = gear_table(pair, tuple(with_["teeth_spanned"]) if with_ else None, balls)
    computed = {
        "pair": in_drawing_units(table) | of_pair(pair, table),
        "pinion": in_drawing_units(table.pinion) | of_gear(pair, table, 0),
        "gear": in_drawing_units(table.gear) | of_gear(pair, table, 1),
    }
    for section, values in computed.items():
        for quantity, text in printed.get(section, {}).items():
            assert_printed(values[quantity], text, f"{name}, {section}.{quantity}")


@pytest.mark.parametrize("name", [name for name, one in TABLES.items() if "made" in one])
def test_teeth_with_allowances_measure_as_printed(name):
    printed = TABLES[name]
    with_ = TABLES[name]["measured_with"]
    nominal = loaded(printed["inputs"])
    alpha = nominal.basic_rack.pressure_angle
    for made in printed["made"]:
        thinnings = [-1e-3 * allowance * math.cos(alpha) for allowance in made["thickness"]]
        for gear_index in (0, 1):
            tooth = as_made(nominal.wheels[gear_index].tooth, thinnings[gear_index])
            where = f"{name}, gear {gear_index + 1} with {made['thickness'][gear_index]} mm"
            assert_printed(
                1e3 * span(tooth, with_["teeth_spanned"][gear_index]), made["spans"][gear_index], where
            )
            ball = 1e-3 * with_["balls"][gear_index]
            assert_printed(1e3 * over_balls(tooth, ball), made["over_balls"][gear_index], where)
            arc = (0.5 * math.pi + 2.0 * tooth.profile_shift * math.tan(alpha)) * tooth.module
            assert_printed(1e3 * arc, made["tooth_thickness"][gear_index], where)
        # The same teeth at the end of the tolerance of the centre distance.
        shifts = {
            f"{gear}.profile_shift": s
            for gear, s in zip(("pinion", "gear"), nominal.profile_shifts, strict=True)
        }
        at_end = {"centre_distance": made["centre_distance"], "mesh.backlash": 1e3 * sum(thinnings)}
        table = gear_table(loaded(printed["inputs"], **shifts | at_end))
        assert_printed(1e3 * table.circumferential_backlash, made["circumferential_backlash"], name)


@pytest.mark.parametrize("name", [name for name, one in TABLES.items() if "default" in one])
def test_the_tip_alteration_is_found_where_it_is_not_given(name):
    printed = TABLES[name]
    inputs = {path: value for path, value in printed["inputs"].items() if "tip_alteration" not in path}
    pair = loaded(inputs)
    table = gear_table(pair)
    for one in (table.pinion, table.gear):
        assert_printed(1e3 * one.tip_alteration, printed["default"]["tip_alteration"], name)
    assert_printed(table.contact_ratio, printed["pair"]["contact_ratio"], name)


def test_shifts_follow_from_spans():
    finished = TABLES["stplus_36_54"]["finished"]
    teeth = [wheel.tooth for wheel in loaded(TABLES["stplus_36_54"]["inputs"]).wheels]
    for tooth, k, measured, shift in zip(
        teeth, finished["teeth_spanned"], finished["spans"], finished["shifts"], strict=True
    ):
        assert_printed(shift_from_span(tooth, k, 1e-3 * measured), shift, f"gear with {tooth.teeth} teeth")
    made = replace(teeth[0], profile_shift=float(finished["shifts"][0]))
    shifted = made.reference_radius + made.profile_shift * made.module
    assert teeth_spanned(made, shifted) == finished["nearest_teeth_spanned_of_pinion"]


def test_backlash_of_gears_made_with_other_shifts():
    table = TABLES["stplus_51_52"]
    pair = loaded(table["inputs"])
    generated = table["generated"]
    pinion, gear = (
        replace(wheel, tooth=replace(wheel.tooth, profile_shift=shift))
        for wheel, shift in zip(pair.wheels, generated["shifts"], strict=True)
    )
    normal = theoretical_backlash(pinion, gear, pair.geometry.operating_pressure_angle)
    assert_printed(1e3 * normal, generated["normal_backlash"], "j_n")
    # The same by thinning the teeth of the nominal shifts.
    as_thinned = gear_table(loaded(table["inputs"], **{"mesh.backlash": 1e3 * normal}))
    assert as_thinned.normal_backlash == pytest.approx(normal, abs=1e-15)
    assert_printed(1e3 * as_thinned.circumferential_backlash, generated["circumferential_backlash"], "j_t")


def test_the_default_tip_is_not_the_full_one():
    # The example: without tip alteration 45.600 and 80.160 mm and a contact ratio of 1.348.
    inputs = TABLES["khk_12_24"]["inputs"] | {"pinion.tip_alteration": 0.0, "gear.tip_alteration": 0.0}
    table = gear_table(loaded(inputs))
    assert is_printed(1e3 * table.pinion.tip_diameter, "45.600")
    assert is_printed(table.contact_ratio, "1.348")
    for name, text in TABLES["khk_12_24"]["pinion"].items():
        assert is_printed(1e3 * getattr(table.pinion, name), text) == (name != "tip_diameter"), name


def test_a_fault_of_half_a_digit_is_seen():
    assert is_printed(44.8404, "44.840")
    assert not is_printed(44.8406, "44.840")
    assert not is_printed(44.8394, "44.840")


def test_there_are_many():
    assert len(TABLES) >= 6
    assert (
        sum(len(one.get(section, ())) for one in TABLES.values() for section in ("pair", "pinion", "gear"))
        > 130
    )
    assert all({"title", "source", "where", "inputs"} <= set(one) for one in TABLES.values())
