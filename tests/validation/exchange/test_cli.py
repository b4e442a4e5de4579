"""Do ``spurcheck export`` and ``init --from-rexs`` write what others read, and refuse what they cannot?"""

import csv
import tomllib

import control
import numpy as np
import pytest
import scipy.io
import scipy.signal
import xarray as xr

import lumped
from lumped.model.averaged import averaged_state_space
from tests.validation.commands.conftest import run
from tests.validation.exchange.rexs_stages import STAGES, rexs_text
from validation.exchange import gear_pair_from_rexs, parameter_text
from validation.studies import load_study, run_sweep


@pytest.fixture
def command(tmp_path, monkeypatch):
    """Run the command in a folder of its own; gives exit code and output without line breaks."""
    monkeypatch.chdir(tmp_path)

    def answered(*arguments):
        ran = run(*arguments)
        return ran.exit_code, " ".join(ran.output.split())

    return answered


def test_a_pair_comes_back_from_rexs(command, tmp_path):
    code, text = command("export", "fzg_c", "--speed", "1234", "-o", "pair.REXS")
    assert (code, "wrote pair.REXS" in text) == (0, True)
    mapping, _ = gear_pair_from_rexs(tmp_path / "pair.REXS")
    assert mapping["operating"]["pinion_speed"] == 1234.0


def test_what_a_rexs_file_lacks_is_given_with_the_command(command, tmp_path):
    text = rexs_text(STAGES["23/67"], "1.0", tips="none", left_out=("normal_pressure_angle",))
    (tmp_path / "old.rexs").write_text(text)
    code, answer = command("init", "--from-rexs", "old.rexs", "-o", "pair.toml")
    assert code == 2
    assert "normal_pressure_angle of flank_geometry (REXS 1.0 to 1.2)" in answer
    assert "--set basic_rack.pressure_angle=VALUE" in answer
    assert not (tmp_path / "pair.toml").exists()
    angle = STAGES["23/67"].pressure_angle
    options = ("--set", f"basic_rack.pressure_angle={angle!r}", "--speed", "1450", "--oil", "vg220")
    code, answer = command("init", "--from-rexs", "old.rexs", *options, "-o", "pair.toml")
    assert code == 0
    assert answer.index("tip_diameter are not in the file") < answer.index("what weighs most stands first")
    pair = lumped.load_gear_pair(tmp_path / "pair.toml")
    assert pair.basic_rack.pressure_angle == pytest.approx(np.radians(angle), rel=1e-15)
    assert pair.lubricant.viscosity_law.iso_vg == 220
    assert pair.operating.pinion_speed == pytest.approx(1450.0 * np.pi / 30.0, rel=1e-14)


def test_the_linear_model_opens_in_python_control_scipy_and_matlab(command, tmp_path):
    expected = averaged_state_space(lumped.load_gear_pair("nasa_28_28"), "elastic")
    for name in ("model.npz", "model.mat"):
        assert command("export", "nasa_28_28", "-o", name)[0] == 0
    with np.load(tmp_path / "model.npz", allow_pickle=False) as file:
        f = dict(file)
    plant = control.ss(f["A"], f["B"], f["C"], f["D"], inputs=list(f["inputs"]), outputs=list(f["outputs"]))
    assert plant.nstates == 10
    assert plant.input_labels == expected.input_labels
    assert list(f["states"]) == expected.state_labels
    parameters = lumped.load_gear_pair(tomllib.loads(str(f["parameters"])))
    assert parameters == lumped.load_gear_pair("nasa_28_28")
    m = scipy.io.loadmat(tmp_path / "model.mat", simplify_cells=True)
    model = scipy.signal.StateSpace(m["A"], m["B"], m["C"], m["D"])
    for matrix in "ABCD":
        np.testing.assert_array_equal(getattr(plant, matrix), getattr(expected, matrix))
        np.testing.assert_array_equal(getattr(model, matrix), getattr(expected, matrix))


def test_a_result_file_becomes_csv_and_mat(command, tmp_path):
    assert command("simulate", "--cycles", "2", "--samples", "16", "-o", "run.nc")[0] == 0
    for name in ("again.csv", "again.mat", "again.nc"):
        assert command("export", "run.nc", "-o", name)[0] == 0
    assert command("simulate", "--cycles", "2", "--samples", "16", "-o", "run.csv")[0] == 0
    assert (tmp_path / "again.csv").read_text() == (tmp_path / "run.csv").read_text()
    read = scipy.io.loadmat(tmp_path / "again.mat", simplify_cells=True)
    with xr.open_dataset(tmp_path / "run.nc", engine="h5netcdf") as run:
        np.testing.assert_array_equal(read["normal_load"], run.normal_load)


AXES = [
    {"field": "operating.pinion_torque", "name": "torque", "low": 10.0, "high": 90.0},
    {"field": "centre_distance", "low": 88.0, "high": 89.4},  # below 88.9 mm the teeth wedge
]


@pytest.mark.parametrize("method", ["grid", "sobol"])
def test_a_sweep_becomes_one_table_with_its_axes_and_says_what_is_left_out(command, tmp_path, method):
    grid = method == "grid"
    study = {
        "name": "table", "gear_pair": "nasa_28_28", "analysis": "geometry", "outputs": ["contact_ratio"],
        "design": {"method": method} | ({} if grid else {"samples": 4}),
        "axes": [axis | ({"count": 2} if grid else {}) for axis in AXES],
    }  # fmt: skip
    assert run_sweep(load_study(study), "sweep").failed > 0
    code, text = command("export", "sweep/results.nc", "-o", "table.csv")
    assert code == 0
    assert "failure_message" in text
    with (tmp_path / "table.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 4
    with xr.open_dataset("sweep/results.nc", engine="h5netcdf") as result:
        for row in rows:
            case = (
                result.sel(
                    torque=float(row["torque [N*m]"]), centre_distance=float(row["centre_distance [mm]"])
                )
                if grid
                else result.sel(case=int(row["case [1]"]))
            )
            assert float(row["torque [N*m]"]) == float(case.torque)
            assert float(row["centre_distance [mm]"]) == float(case.centre_distance)
            np.testing.assert_array_equal(float(row["contact_ratio [1]"]), case.contact_ratio)
            assert int(row["status [1]"]) == int(case.status)
    assert command("export", "sweep/results.nc", "-o", "all.mat")[0] == 0
    everything = scipy.io.loadmat("all.mat", simplify_cells=True)
    assert "wedge" in str(np.atleast_1d(everything["failure_message"])[0])


@pytest.mark.parametrize(("arguments", "reason"), [
    (["nasa_28_28", "-o", "pair.xlsx"], ".rexs, .rexsj, .mat, .npz"),
    (["nasa_28_28", "-o", "old.rexs"], "--force"),
    (["nasa_28_28", "-o", "old.npz"], "--force"),
    (["none.nc", "-o", "run.csv"], "exists"),
    (["old.nc", "-o", "run.csv"], "cannot be read"),
    (["old.nc", "-o", "run.rexs"], ".nc, .csv, .mat"),
    (["old.nc", "--speed", "4000", "-o", "run.csv"], "--speed"),
])  # fmt: skip
def test_what_cannot_be_written_is_refused_and_nothing_is_left_behind(command, tmp_path, arguments, reason):
    for name in ("old.rexs", "old.npz", "old.nc"):
        (tmp_path / name).write_text("precious")
    code, text = command("export", *arguments)
    assert code == 2
    assert reason in text
    assert "Traceback" not in text
    assert {p.name: p.read_text() for p in tmp_path.iterdir()} == dict.fromkeys(
        ["old.rexs", "old.npz", "old.nc"], "precious"
    )


def test_a_stage_becomes_a_parameter_file_with_units_and_marks(xml, save, tmp_path):
    source = save(xml(), "gearbox.rexs")
    target = tmp_path / "mine.toml"
    result = run("init", "--from-rexs", source, "--stage", 1, "-o", target)
    assert result.exit_code == 0
    assert "note: the file does not say which gear drives" in result.stderr
    text = target.read_text(encoding="utf-8")
    assert tomllib.loads(text) == {"format": 2} | gear_pair_from_rexs(source)[0]
    assert lumped.load_gear_pair(target).gear.teeth == 30
    lines = {line.partition(" = ")[0]: line for line in text.partition("[sources]")[0].splitlines()}
    assert lines["centre_distance"].endswith("# mm")
    assert lines["roughness"].endswith("# um, assumed: ground flanks")
    assert "# assumed: law ISO/TR 14179-2" in lines["law"]
    assert text.startswith("# - the file does not say")


def test_the_default_name_is_that_of_the_file_and_dash_prints(xml, save, tmp_path, monkeypatch):
    source = save(xml(), "gearbox.rexs.zip", member="model.rexs")
    monkeypatch.chdir(tmp_path)
    assert run("init", "--from-rexs", source).exit_code == 0
    printed = run("init", "--from-rexs", source, "-o", "-")
    assert printed.stdout == (tmp_path / "gearbox.toml").read_text(encoding="utf-8")
    again = run("init", "--from-rexs", source)
    assert again.exit_code == 2
    assert "--force" in again.stderr


def test_the_number_of_the_stage_is_passed_on(xml, save):
    result = run("init", "--from-rexs", save(xml()), "--stage", 2, "-o", "-")
    assert result.exit_code == 2
    assert "a whole number, 1 to 1" in result.stderr


def test_text_from_elsewhere_cannot_break_out_of_a_comment_or_a_string(xml, save):
    evil = "x&#10;[mesh]&#10;damping_ratio = 9 &quot; '''"
    mapping, notes = gear_pair_from_rexs(save(xml().replace('name="first stage"', f'name="{evil}"')))
    text = parameter_text(mapping, (*notes, "a\nb = 1\r\x1b[31m"))
    assert tomllib.loads(text) == {"format": 2} | mapping
    assert mapping["mesh"]["damping_ratio"] == 0.05
    assert "\x1b" not in text
