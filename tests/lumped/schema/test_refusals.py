"""Is every input that cannot be right refused, with field, value, allowed range and next action?"""

import copy
import math

import pytest

from lumped import ParameterError, load_gear_pair


def problem(source, field, **expected):
    """The one problem of a refused source that concerns ``field``."""
    with pytest.raises(ParameterError) as caught:
        load_gear_pair(source)
    problems = [p for p in caught.value.problems if p.field == field]
    assert len(problems) == 1, f"{field} not named once in: {caught.value}"
    one = problems[0]
    # Every part that the user needs is there, and the message shows all of it.
    for part in (one.field, one.value, one.allowed, one.action):
        assert part
        assert part in str(caught.value)
    assert len(str(one)) < 700
    for name, text in expected.items():
        assert text in getattr(one, name), f"{name}: {getattr(one, name)!r}"
    return one


#: Sections that the default pair leaves out, so that their fields can be set.
LAW = {"kinematic_viscosity_40": 32.0, "kinematic_viscosity_100": 5.4, "temperature": 60.0, "density": 870.0}
RELIEF = {"shape": "linear", "amount": 23.0, "start_roll_angle": 24.0}
FAULTS = [
    {"kind": "crack", "tooth": 1, "depth": 0.5, "angle": 70},
    {"kind": "spall", "tooth": 1, "start_roll_angle": 18, "end_roll_angle": 22, "width": 2, "pit_depth": 9},
    {"kind": "chip", "tooth": 1, "roll_angle": 27},
]
STIFFNESS = {
    "pair_stiffness": {"model": "rectangular"}, "peak": {"model": "parabolic"},
    "end_ratio": {"model": "parabolic"}, "ramp_length": {"model": "parabolic"},
}  # fmt: skip


@pytest.fixture(scope="module")
def complete(nasa, shaft_tables):
    """The default pair's data with a given leaf set, whatever section it needs."""

    def build(path, value):
        data = copy.deepcopy(nasa.to_mapping())
        *parents, leaf = path.split(".")
        if parents[:2] == ["lubricant", "viscosity_law"]:
            del data["lubricant"]["viscosity"]
            data["lubricant"]["viscosity_law"] = dict(LAW)
        if parents and parents[-1] in ("tip_relief", "root_relief"):
            data[parents[0]][parents[-1]] = dict(RELIEF)
        if parents[:2] == ["mesh", "stiffness"]:
            data["mesh"]["stiffness"] = dict(STIFFNESS[leaf])
        if parents == ["friction", "table"]:
            data["friction"]["table"] = {"points": [1, 2, 3, 4], "coefficient": [0.05] * 4}
        if parents[1:] == ["mounting"]:
            data[parents[0]]["mounting"] = {}
        if parents[1:] == ["faults", "0"]:
            data[parents[0]]["faults"] = [dict(next(one for one in FAULTS if leaf in one))]
        if parents[:2] == ["operating", "torque_ripple"]:
            data["operating"]["torque_ripple"] = [{"shaft": "pinion", "order": 1, "amplitude": 1.0}]
        if parents and parents[0] == "bearings" and leaf in ("size", "contact_angle", "stiffness_factor"):
            data["bearings"][parents[1]] = {"type": "ball", "number": 9, "size": 7.9}
        if parents and parents[0] == "shafts":
            data["shafts"] = copy.deepcopy(shaft_tables)
        node_at(data, parents)[leaf] = value
        return data

    return build


def node_at(data, parents):
    """Table at a path of keys and, in lists, numbers."""
    for part in parents:
        data = data[int(part) if isinstance(data, list) else part]
    return data


class TestEveryQuantity:
    def test_what_is_no_number_is_refused(self, quantity_field, complete):
        path, _ = quantity_field
        for value in (math.nan, True, [1.0], "plenty", "9" * 100_000):
            problem(complete(path, value), path)

    def test_wrong_dimension_is_refused(self, quantity_field, complete):
        path, quantity = quantity_field
        wrong = "1 A" if quantity.unit == "1" else "1 ampere"
        problem(complete(path, wrong), path, value="1 a" if quantity.unit != "1" else "1 A")

    def test_its_name_is_checked(self, quantity_field, complete):
        path, _ = quantity_field
        data = complete(path, 1.0)
        *parents, leaf = path.split(".")
        node = node_at(data, parents)
        node[leaf + "x"] = node.pop(leaf)
        with pytest.raises(ParameterError) as caught:
            load_gear_pair(data)
        named = [p for p in caught.value.problems if p.field == f"{path}x"]
        assert named
        assert named[0].action == f"Did you mean '{leaf}'?"


@pytest.mark.parametrize("value", ["balancd", True, math.nan, "3 m", [1]])
def test_brake_torque_is_balanced_or_a_torque(edited, value):
    one = problem(edited("operating.brake_torque", value), "operating.brake_torque")
    assert "balanced" in one.allowed + one.action


class TestOtherFields:
    @pytest.mark.parametrize("value", [28.0, 28.5, "28", True, None, math.nan])
    def test_teeth_that_are_no_whole_number(self, edited, value):
        one = problem(edited("pinion.teeth", value), "pinion.teeth", allowed="5")
        assert ("without a point" in one.action) == isinstance(value, float)

    @pytest.mark.parametrize(("path", "value", "near"), [
        ("friction.law", "colomb", "coulomb"),
        ("friction.law", "Xu-Kaharman", "xu_kahraman"),
        ("mesh.stiffness", {"model": "parabolc"}, "parabolic"),
        ("pinion.tip_relief.shape", "liner", "linear"),
    ])  # fmt: skip
    def test_a_misspelt_choice_suggests_the_nearest(self, edited, path, value, near):
        one = problem(edited(path, value), path if path != "mesh.stiffness" else "mesh.stiffness.model")
        assert f"'{near}'" in one.action

    @pytest.mark.parametrize(("path", "near"), [
        ("pinion.teth", "teeth"),
        ("operating.pinion_sped", "pinion_speed"),
        ("mesh.stifness", "stiffness"),
        ("lubrication", "lubricant"),
        ("pinion.tip_relief.amout", "amount"),
        ("bearings.pinion.loa_stifness", "loa_stiffness"),
    ])  # fmt: skip
    def test_an_unknown_key_suggests_the_nearest(self, edited, path, near):
        problem(edited(path, 1.0), path, value="unknown key", action=f"Did you mean '{near}'?")

    def test_the_other_models_key_is_not_suggested(self, edited):
        one = problem(edited("mesh.stiffness", {"model": "rectangular", "peak": 8e7}), "mesh.stiffness.peak")
        assert "pair_stiffness" in one.allowed
        assert "peak" not in one.allowed
        assert "Did you mean 'peak'" not in one.action

    @pytest.mark.parametrize(("path", "values", "texts"), [
        ("operating.pinion_speed", [-0.0, "0 rpm", "-3 rad/s"],
         {"allowed": "> 0 rpm", "action": "drive"}),
        ("friction.thresholds", [3.0, "many", [], {"a": 1}, ["1", 4, 10], [math.nan, 4.0, 10.0]],
         {"allowed": "three increasing"}),
        ("name", [3, "", None, "x" * 81, ["a"]], {}),
        *((section, [3, None, "text", [1, 2]], {"allowed": "table"})
          for section in ("pinion", "bearings.gear", "mesh", "mesh.stiffness", "friction")),
        *((path, [...], {"value": "missing", "action": "Add it"})
          for path in ("pinion.face_width", "mesh.damping_ratio", "operating", "friction.law")),
    ])  # fmt: skip
    def test_values_of_another_kind_or_none(self, edited, path, values, texts):
        for value in values:
            problem(edited(path, value), path, **texts)

    def test_every_problem_is_listed(self, edited):
        data = edited("pinion.face_width", -1)
        data["gear"]["teeth"] = 2
        data["surprise"] = 1
        with pytest.raises(ParameterError) as caught:
            load_gear_pair(data)
        assert {p.field for p in caught.value.problems} == {"pinion.face_width", "gear.teeth", "surprise"}
        assert "3 problems" in str(caught.value)


class TestFiles:
    @pytest.mark.parametrize("name", ["pair.toml", "/no/such/folder/pair.toml", "folder/pair"])
    def test_missing_file(self, name):
        problem(name, "file", value=name, action="spurcheck init")

    def test_unknown_preset_suggests_the_nearest(self):
        problem("nasa_28_29", "preset", value="nasa_28_29", action="Did you mean 'nasa_28_28'?")
        problem("fzgc", "preset", action="Did you mean 'fzg_c'?")
        problem("zzzzzz", "preset", allowed="nasa_28_28", action="spurcheck presets")

    @pytest.mark.parametrize(
        "text", ["name = ", "[pinion", "a = 1\na = 2", "x = {", "= 3", "[" * 5000, "a" * 10, "\x00", "x = 1e"]
    )
    def test_malformed_toml(self, tmp_path, text):
        path = tmp_path / "pair.toml"
        path.write_text(text, encoding="utf-8")
        problem(path, "file", value=str(path), allowed="TOML")

    def test_empty_file_lists_what_is_missing(self, tmp_path):
        path = tmp_path / "pair.toml"
        path.write_text("", encoding="utf-8")
        problem(path, "basic_rack", value="missing")

    @pytest.mark.parametrize("source", [None, 3, 1.5, ["nasa_28_28"], b"nasa_28_28"])
    def test_other_types(self, source):
        problem(source, "pair", allowed="preset")


@pytest.mark.parametrize(("path", "suggestion"), [
    ("mesh.dampin_ratio", "damping_ratio"),
    ("bearings.pinon", "pinion"),
    ("operating.pinion_speed.rpm", "Remove"),
    ("", "Remove"),
])  # fmt: skip
def test_a_source_of_a_field_that_does_not_exist_is_refused(nasa, path, suggestion):
    data = nasa.to_mapping()
    data["sources"] = {**data["sources"], path: "measured"}
    problem(data, f"sources.{path or '(empty)'}", value="unknown key", action=suggestion)


#: Changes of the default pair (None: without the field), field that is named, and numbers of its refusal. The
#: model page has the base diameter, 2 * 41.7693 mm; the limits themselves are in tests/guards.
IMPOSSIBLE = [
    ({"pinion.tip_diameter": 83.0}, "pinion.tip_diameter", {"allowed": "83.5387"}),
    ({"centre_distance": 80.0}, "centre_distance", {"allowed": "> 83.5387 mm"}),
    (
        {"pinion.profile_shift": 0.1},
        "centre_distance",
        {"allowed": "backlash >= 0", "action": "Delete centre_distance (it is then 89.2134 mm)"},
    ),
    # Full tip radius of the rack: (pi/4 - h tan a) cos a/(1 - sin a) = 0.3179 at 25 deg and h = 1.25.
    (
        {"basic_rack.pressure_angle": 25.0},
        "basic_rack.fillet_radius_coefficient",
        {"allowed": "<= 0.3179"},
    ),
]


@pytest.mark.parametrize(("changes", "field", "texts"), IMPOSSIBLE)
def test_what_cannot_exist_is_refused_with_its_limit(nasa, changes, field, texts):
    data = copy.deepcopy(nasa.to_mapping())
    for path, value in changes.items():
        *parents, leaf = path.split(".")
        node = node_at(data, parents)
        node[leaf] = value
        if value is None:
            del node[leaf]
    problem(data, field, **texts)


def test_a_centre_distance_of_other_teeth_is_named_first(edited):
    data = edited("pinion.teeth", 19)
    data["gear"]["teeth"] = 41
    for gear in ("pinion", "gear"):
        del data[gear]["profile_shift"]
    with pytest.raises(ParameterError, match=r"without profile shifts it is 95\.25 mm"):
        load_gear_pair(data)
    data["pinion"]["profile_shift"] = data["gear"]["profile_shift"] = 0
    with pytest.raises(ParameterError) as caught:
        load_gear_pair(data)
    assert "it is then 95.25 mm" in caught.value.problems[0].action
    data["centre_distance"] = 95.25
    assert load_gear_pair(data).geometry.contact_ratio > 1.5


@pytest.fixture(scope="module")
def pair(nasa, shaft_tables):
    return nasa.with_(shafts=shaft_tables)


@pytest.mark.parametrize(("changes", "field", "allowed"), [
    ({"shafts.pinion.bearings": []}, "shafts.pinion.bearings", "at least 1 item"),
    ({"shafts.pinion": None}, "shafts.pinion", "the pinion's shaft"),
    ({"shafts.pinion.segments": 30}, "shafts.pinion.segments", "a list of tables"),
    ({"shafts.pinion.segments": [30]}, "shafts.pinion.segments.0", "a table of keys and values"),
])  # fmt: skip
def test_no_shaft_at_all(pair, changes, field, allowed):
    with pytest.raises(ParameterError) as caught:
        pair.with_(changes)
    (problem,) = caught.value.problems
    assert problem.field == field
    assert allowed in problem.allowed
    assert problem.value
    assert problem.action
