"""Are teeth that differ read from files, with every list that does not fit its gear refused?"""

import pytest

from lumped import ParameterError, load_gear_pair

INDEX = [round(0.1 * j, 1) for j in range(28)]


@pytest.mark.parametrize(("changes", "field", "allowed"), [
    ({"pinion.deviations": {"index": INDEX[:27]}}, "pinion.deviations.index", "one a tooth, 28"),
    ({"gear.deviations": {"tolerance_class": 12}}, "gear.deviations.tolerance_class", "11"),
    ({"gear.deviations": {"seed": 3, "index": INDEX}}, "gear.deviations.seed", "tolerance_class"),
    ({"gear.deviations": {}}, "gear.deviations.tolerance_class", "index or file"),
    ({"gear.deviations": {"tolerance_class": 6, "index": INDEX}}, "gear.deviations.index", "tolerance_class"),
    ({"gear.deviations": {"tolerance_class": 6}, "gear.mounting": {"eccentricity": 9}},
     "gear.mounting.eccentricity", "one source"),
    ({"pinion.faults": [{"kind": "crak", "tooth": 3}]}, "pinion.faults.0.kind", "crack, spall, chip"),
    ({"pinion.faults": [{"kind": "crack", "tooth": 29, "depth": 1}]}, "pinion.faults.0.tooth", "1 to 28"),
    ({"pinion.faults": [{"kind": "spall", "tooth": 1, "start_roll_angle": 20, "end_roll_angle": 19,
     "width": 1}]}, "pinion.faults.0.end_roll_angle", "> start_roll_angle"),
    ({"pinion.faults": [{"kind": "crack", "tooth": 1, "depth": 3.5, "angle": 90}]}, "pinion.faults.0.depth",
     "half the root"),
    ({"gear.faults": [{"kind": "chip", "tooth": 1, "roll_angle": 40}]}, "gear.faults.0.roll_angle", "deg"),
    ({"pinion.faults": [{"kind": "spall", "tooth": 1, "start_roll_angle": 18, "end_roll_angle": 22,
     "width": 7}]}, "pinion.faults.0.width", "6.35 mm"),
    ({"gear.deviations": {"tip_relief": [1.0] * 28}, "gear.tip_relief": None}, "gear.deviations.tip_relief",
     "a gear with tip relief"),
    ({"mesh.first_teeth": [1, 29]}, "mesh.first_teeth", "from 1 to 28"),
    ({"operating.torque_ripple": [{"shaft": "pinion", "order": 0, "amplitude": 1}]}, None, "1 to 1000"),
])  # fmt: skip
def test_refused_with_field_and_range(nasa, changes, field, allowed):
    with pytest.raises(ParameterError) as caught:
        nasa.with_(changes)
    found = [p for p in caught.value.problems if field in (None, p.field)]
    assert len(found) == 1, caught.value
    assert allowed in found[0].allowed


@pytest.mark.parametrize(
    "text", ["index_um\n1\n", "tooth\n1\n", "tooth,index_um\n1,1\n1,2\n", "tooth,index_um\n1,a\n", ""]
)
def test_files_that_are_no_deviations_are_refused(nasa, tmp_path, text):
    path = tmp_path / "d.csv"
    path.write_text(text)
    with pytest.raises(ParameterError, match="file"):
        nasa.with_({"pinion.deviations": {"file": str(path)}})


def test_a_measured_file_is_its_lists_in_the_order_of_the_teeth(nasa, tmp_path):
    rows = [f"{j + 1}, {value}, {-value}" for j, value in enumerate(INDEX)]
    (tmp_path / "d.csv").write_text("\n".join(["# mine", "tooth, index_um, profile_slope_um", *rows[::-1]]))
    (tmp_path / "pair.toml").write_text(
        nasa.to_toml().replace("[gear]", "[pinion.deviations]\nfile = 'd.csv'\n\n[gear]")
    )
    found = load_gear_pair(tmp_path / "pair.toml").pinion.deviations
    assert [value.to("um") for value in found.index] == INDEX
    assert [value.to("um") for value in found.profile_slope] == [-value for value in INDEX]


@pytest.mark.parametrize("code", ["utf-8", "utf-16-le", "utf-16-be"])
def test_a_file_of_a_spreadsheet_with_a_mark_and_decimal_commas_is_read(nasa, tmp_path, code):
    rows = [f"{j + 1};{value};".replace(".", ",") for j, value in enumerate(INDEX)]
    (tmp_path / "d.csv").write_text("\ufeff" + "\r\n".join(["Tooth;index_um;", *rows, ""]), encoding=code)
    found = nasa.with_({"pinion.deviations": {"file": str(tmp_path / "d.csv")}}).pinion.deviations
    assert [value.to("um") for value in found.index] == INDEX


def test_the_healthy_twin_has_like_teeth_and_a_like_pair_is_its_own(nasa):
    changes = {"gear.deviations": {"tolerance_class": 6}, "pinion.mounting": {"eccentricity": 9}}
    changes |= {"operating.torque_ripple": [{"shaft": "pinion", "order": 1, "amplitude": 1.0}]}
    assert nasa.healthy is nasa
    again = nasa.with_({})
    assert (again.healthy == nasa.healthy, again == nasa) == (True, True)  # whatever was cached on the way
    healthy = nasa.with_(changes).healthy
    assert {**healthy.to_mapping(), "sources": None} == {**nasa.to_mapping(), "sources": None}
