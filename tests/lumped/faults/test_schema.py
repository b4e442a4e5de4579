"""Are teeth that differ read from files, and malformed files refused? Lists that do not fit: tests/guards."""

import pytest

from lumped import ParameterError, load_gear_pair

INDEX = [round(0.1 * j, 1) for j in range(28)]


def test_a_misspelt_fault_is_refused_with_the_kinds_there_are(nasa):
    with pytest.raises(ParameterError) as caught:
        nasa.with_({"pinion.faults": [{"kind": "crak", "tooth": 3}]})
    (problem,) = caught.value.problems
    assert problem.field == "pinion.faults.0.kind"
    assert "crack, spall, chip" in problem.allowed


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
    deviations = load_gear_pair(tmp_path / "pair.toml").pinion.deviations
    assert [value.to("um") for value in deviations.index] == INDEX
    assert [value.to("um") for value in deviations.profile_slope] == [-value for value in INDEX]


@pytest.mark.parametrize("code", ["utf-8", "utf-16-le", "utf-16-be"])
def test_a_file_of_a_spreadsheet_with_a_mark_and_decimal_commas_is_read(nasa, tmp_path, code):
    rows = [f"{j + 1};{value};".replace(".", ",") for j, value in enumerate(INDEX)]
    (tmp_path / "d.csv").write_text("\ufeff" + "\r\n".join(["Tooth;index_um;", *rows, ""]), encoding=code)
    deviations = nasa.with_({"pinion.deviations": {"file": str(tmp_path / "d.csv")}}).pinion.deviations
    assert [value.to("um") for value in deviations.index] == INDEX


def test_the_healthy_twin_has_like_teeth_and_a_like_pair_is_its_own(nasa):
    changes = {"gear.deviations": {"tolerance_class": 6}, "pinion.mounting": {"eccentricity": 9}}
    changes |= {"operating.torque_ripple": [{"shaft": "pinion", "order": 1, "amplitude": 1.0}]}
    assert nasa.healthy is nasa
    again = nasa.with_({})
    assert (again.healthy == nasa.healthy, again == nasa) == (True, True)  # whatever was cached on the way
    healthy = nasa.with_(changes).healthy
    assert {**healthy.to_mapping(), "sources": None} == {**nasa.to_mapping(), "sources": None}
