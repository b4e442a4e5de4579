"""Is a study read as written, and is everything else refused with field, reason and next step?"""

import copy

import pytest

from lumped import load_gear_pair
from lumped.errors import ParameterError
from validation.studies import load_study

TEXT = """
name = "efficiency"
gear_pair = "nasa_28_28"
analysis = "lumped"
outputs = ["mesh_efficiency", "dte_peak_to_peak"]
[design]
method = "sobol"
samples = 8
seed = 5
sensitivity = true
[[axes]]
field = "operating.pinion_torque"
low = 10.0
high = 90.0
[[axes]]
field = "speed_rpm"
low = 500.0
high = 9000.0
spacing = "log"
"""
GRID = {
    "name": "grid", "gear_pair": "nasa_28_28", "analysis": "lumped", "outputs": ["mesh_efficiency"],
    "axes": [{"field": "operating.pinion_torque", "values": [10, 20]}],
}  # fmt: skip


def changed(path, value):
    """The grid study with one entry replaced; a path of keys and indices."""
    data = copy.deepcopy(GRID)
    node = data
    for part in path[:-1]:
        node = node.setdefault(part, {}) if isinstance(node, dict) else node[part]
    node[path[-1]] = value
    return data


def test_a_file_and_its_own_text_give_the_same_study(tmp_path):
    file = tmp_path / "study.toml"
    file.write_text(TEXT)
    study = load_study(file)
    again = load_study(study.to_toml())
    assert again == study
    assert again.sha256 == study.sha256
    assert load_study(study) is study
    assert study.gear_pair == load_gear_pair("nasa_28_28")


def test_the_written_study_needs_no_other_file(tmp_path):
    (tmp_path / "pair.toml").write_text(load_gear_pair("fzg_c").to_toml())
    file = tmp_path / "study.toml"
    file.write_text(TEXT.replace('"nasa_28_28"', '"pair.toml"'))
    study = load_study(file)
    (tmp_path / "pair.toml").unlink()
    assert load_study(study.to_toml()).gear_pair == load_gear_pair("fzg_c")


def test_every_change_of_a_study_changes_its_hash():
    base = load_study(GRID)
    changes = [
        (["outputs"], ["brake_torque"]), (["axes", 0, "values"], [10, 21]),
        (["axes", 0, "name"], "torque_axis"), (["settings"], {"samples_per_cycle": 64}),
        (["gear_pair"], "fzg_c"), (["description"], "other"),
    ]  # fmt: skip
    hashes = {load_study(changed(path, value)).sha256 for path, value in changes}
    assert len(hashes | {base.sha256}) == len(changes) + 1


def test_a_study_written_without_a_setting_means_the_same_for_ever():
    # A store names its study by the text without defaults: a new default would mix two studies in one store,
    # a default that is written would shut out every store from before the setting existed.
    study = load_study(GRID)
    assert set(study.to_mapping()) == set(GRID)
    defaults = {"samples_per_cycle": 128, "cycles": 20, "kept_cycles": 1, "fidelity": "exact", "rtol": None}
    defaults |= {"supports": None}  # the shafts of a pair that has them
    assert study.settings.model_dump() == defaults
    defaults = {"method": "grid", "samples": None, "seed": 0, "sensitivity": False}
    assert study.design.model_dump() == defaults


def test_text_with_a_unit_is_the_number_in_the_stated_unit():
    study = load_study(
        changed(["axes", 0], {"field": "pinion.face_width", "values": ["1 cm", 12, "0.5 inch"]})
    )
    assert study.axes[0].listed() == (10.0, 12.0, 12.7)


@pytest.mark.parametrize(("axis", "values"), [
    ({"field": "pinion.teeth", "low": 20, "high": 22, "count": 3}, (20, 21, 22)),
    ({"field": "pinion.teeth", "values": [28, 30.0]}, (28, 30)),
    ({"field": "lubricant.viscosity_law.iso_vg", "values": [32, 68.0]}, (32, 68)),
])  # fmt: skip
def test_an_axis_of_a_whole_number_has_whole_numbers(axis, values):
    listed = load_study(changed(["axes", 0], axis)).axes[0].listed()
    assert listed == values
    assert all(type(value) is int for value in listed)


REFUSED = {
    "unknown key": (["axess"], 1, "axess", "Did you mean 'axes'"),
    "unknown key of an axis": (["axes", 0, "feild"], 1, "axes.0.feild", "Did you mean 'field'"),
    "unknown field": (["axes", 0, "field"], "operating.pinion_sped", "axes.0", "Did you mean 'pinion_speed'"),
    "no field": (["axes", 0, "field"], [], "axes.0.field", "at least 1"),
    "text field": (["axes", 0, "field"], "name", "axes.0.field", "by dotted path"),
    "unknown output": (["outputs"], ["mesh_eficiency"], "outputs.0", "mesh_efficiency"),
    "output twice": (["outputs"], ["brake_torque"] * 2, "outputs", "all differ"),
    "name twice": (["axes"], [{"field": f"{gear}.bore", "name": "bore", "values": [1]} for gear in ("pinion",
     "gear")], "axes.1.name", "no other axis"),
    "field twice": (["axes"], [{"field": "pinion.bore", "name": name, "values": [1]} for name in ("one",
     "other")], "axes.1.field", "no other axis changes"),
    "too many samples for indices": (["design"], {"method": "sobol", "samples": 2**26, "sensitivity": True},
     "design", "split the study"),
    "one cycle": (["settings"], {"cycles": 1}, "settings.cycles", "2"),
    "no axes": (["axes"], [], "axes", "at least 1"),
    "other unit": (["axes", 0, "values"], ["3 mm"], "axes.0.values", "not a torque"),
    "value twice": (["axes", 0, "values"], [1, 1.0], "axes.0.values", "all differ"),
    "not finite": (["axes", 0, "values"], [1.0, float("nan")], "axes.0.values", "finite"),
    "truth value": (["axes", 0, "values"], [True], "axes.0.values", "number"),
    "both ways": (["axes", 0, "low"], 1.0, "axes.0.values", "Remove one"),
    "half a range": (["axes", 0], {"field": "speed_rpm", "low": 1}, "axes.0.low", "range or the list"),
    "reversed": (["axes", 0], {"field": "speed_rpm", "low": 2, "high": 1, "count": 3}, "axes.0.high", "Swap"),
    "range of one value": (["axes", 0], {"field": "speed_rpm", "low": 1, "high": 1, "count": 3},
     "axes.0.high", "> low"),
    "count in quotes": (["axes", 0], {"field": "speed_rpm", "low": 1, "high": 2, "count": "3"},
     "axes.0.count", "integer"),
    "range beyond floats": (["axes", 0], {"field": "speed_rpm", "low": -1e308, "high": 1e308, "count": 3},
     "axes.0.high", "Narrow"),
    "log of 0": (["axes", 0], {"field": "speed_rpm", "low": 0, "high": 1, "count": 3, "spacing": "log"},
     "axes.0.low", "linear"),
    "range without count": (["axes", 0], {"field": "speed_rpm", "low": 1, "high": 2}, "axes.0.count", "grid"),
    "range of a choice": (["axes", 0], {"field": "friction.law", "low": 1, "high": 2, "count": 3},
     "axes.0.field", "List"),
    "half a tooth": (["axes", 0], {"field": "pinion.teeth", "values": [27.5]}, "axes.0.values", "whole"),
    "too many whole numbers": (["axes", 0], {"field": "pinion.teeth", "low": 20, "high": 22, "count": 5},
     "axes.0.count", "<= 3"),
    "units mixed": (["axes", 0], {"field": ["pinion.face_width", "operating.pinion_torque"], "values": [1]},
     "axes.0.field", "same unit"),
    "samples of a grid": (["design"], {"samples": 8}, "design.samples", "Remove"),
    "no samples": (["design"], {"method": "sobol"}, "design.samples", "Give it"),
    "samples no power of two": (["design"], {"method": "sobol", "samples": 100}, "design.samples",
     "64 or 128"),
    "indices of a grid": (["design"], {"sensitivity": True}, "design.sensitivity", "sobol"),
    "values of samples": (["design"], {"method": "sobol", "samples": 8}, "axes.0.values",
     "Give the range only"),
    "floquet axis": (["axes", 0], {"field": "stiffness_variation", "values": [1, 2]}, "axes.0.field",
     "analysis = 'floquet'"),
    "taken name": (["axes", 0, "name"], "status", "axes.0.name", "Give the axis a name"),
    "dimension of the results": (["axes", 0, "name"], "failure", "axes.0.name", "Give the axis a name"),
    "name of the indices": (["axes", 0, "name"], "sobol_first", "axes.0.name", "Give the axis a name"),
    "number for a choice": (["axes", 0], {"field": "friction.law", "values": ["coulomb", 3]}, "axes.0.values",
     "quotes"),
    "no whole number inside": (["axes", 0], {"field": "pinion.teeth", "low": 28.2, "high": 28.8, "count": 2},
     "axes.0.low", "integers"),
    "whole numbers beyond floats": (["axes", 0], {"field": "pinion.teeth", "low": -1e300, "high": 1e300,
     "count": 2}, "axes.0.low", "integers"),
    "no word": (["axes", 0, "name"], "../x", "axes.0.name", "match"),
    "kept cycles": (["settings"], {"cycles": 3, "kept_cycles": 4}, "settings.kept_cycles", "<= cycles"),
    "bad pair": (["gear_pair"], "nasa_28_29", "gear_pair", "nasa_28_28"),
    "pair without a name": (["gear_pair"], "", "gear_pair", "folder"),
    "pair of no possible name": (["gear_pair"], "a\0b", "gear_pair", "a file that exists"),
    "pair of a name too long": (["gear_pair"], "a" * 1001, "gear_pair", "a file that exists"),
    "pair is a number": (["gear_pair"], 3, "gear_pair", "table"),
    "no name": (["name"], "", "name", "text that is not empty"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_refusals_name_the_field_and_the_way_out(case):
    path, value, field, words = REFUSED[case]
    with pytest.raises(ParameterError) as caught:
        load_study(changed(path, value))
    problems = {p.field: f"{p.value} {p.allowed} {p.action}" for p in caught.value.problems}
    near = {name: text for name, text in problems.items() if name.startswith(field)}
    assert near, problems
    assert any(words in text for text in near.values()), near


def test_all_problems_come_at_once():
    with pytest.raises(ParameterError) as caught:
        load_study({**GRID, "gear_pair": "nobody", "outputs": ["x"], "settings": {"cycles": 0}})
    fields = {p.field for p in caught.value.problems}
    assert "settings.cycles" in fields
    assert any(field.startswith("gear_pair") for field in fields)


def test_the_refused_items_of_a_list_do_not_make_it_too_short():
    with pytest.raises(ParameterError) as caught:
        load_study(changed(["axes", 0], {"field": "speed_rpm", "low": 1, "high": 2, "count": 10**12}))
    assert [p.field for p in caught.value.problems] == ["axes.0.count"]
    axis = {"field": "speed_rpm", "values": [1]}
    with pytest.raises(ParameterError, match="at most 32 items instead of 33"):
        load_study(changed(["axes"], [axis] * 33))


def test_a_study_too_large_is_refused_at_once():
    axes = [
        {"field": f"{gear}.{field}", "low": 1.0, "high": 2.0, "count": 10_000}
        for gear in ("pinion", "gear")
        for field in ("face_width", "roughness", "density")
    ]
    with pytest.raises(ParameterError, match="split the study"):
        load_study({**GRID, "axes": axes})
