"""Does the command do what its help says, and refuse bad input with one message and the right exit code?"""

import inspect
import json
import math
import re

import numpy as np
import pytest
import xarray as xr
from typer.main import get_command

import lumped
from lumped import NumericalError
from tests.validation.prediction.test_uncertainty import LINEAR
from validation.cli import app
from validation.cross_check import comparison
from validation.cross_check.verdict import Verdict
from validation.reporting import Report
from validation.reporting.gate import Change, Comparison
from validation.reporting.page_one import PageOne
from validation.reporting.page_one import Verdict as VERDICT

from .conftest import refused, run

COMMANDS = ("report", "presets", "init", "simulate", "crosscheck", "stability")


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_explains_itself_with_an_example(command):
    text = run(command, "--help").stdout
    assert "Example" in text
    assert f"spurcheck {command}" in text


def test_every_option_is_explained_and_no_unit_is_taken_for_markup():
    """Rich drops "[rpm]": what it takes for a tag begins with a small letter."""
    for command in get_command(app).commands.values():
        assert [one.name for one in command.params if not one.help] == []
        text = " ".join(parameter.help for parameter in command.params)
        assert not re.search(r"(?<!\\)\[[a-z#@/]", text), command.name


def test_version():
    assert re.fullmatch(r"spurcheck \d+\.\d+\.\d+\S*\n", run("--version").stdout)


def test_presets_are_listed_and_shown():
    listed = run("presets").stdout
    assert all(name in listed for name in lumped.preset_names())
    shown = run("presets", "nasa_28_28").stdout
    assert "# mm" in shown
    assert "[sources]" in shown


def test_init_writes_a_file_that_loads_and_never_overwrites(tmp_path):
    path = tmp_path / "mine.toml"
    pair = lumped.load_gear_pair("nasa_28_28")
    assert run("init", "-o", path).exit_code == 0
    assert lumped.load_gear_pair(path) == pair
    path.write_text("edited")
    assert "--force" in refused("init", "-o", path)
    assert path.read_text() == "edited"
    assert run("init", "-o", path, "--force").exit_code == 0
    assert lumped.load_gear_pair(path) == pair


def test_a_numerical_failure_says_what_to_try_and_exits_3(monkeypatch):
    def fail(*_, **__):
        raise NumericalError("No periodic motion. Change the speed slightly.")

    monkeypatch.setattr(lumped, "simulate", fail)
    result = run("simulate")
    assert result.exit_code == 3
    assert "Change the speed slightly" in result.stderr


def test_simulate_prints_numbers_and_writes_by_suffix(tmp_path):
    for suffix in ("nc", "csv", "png", "svg"):
        path = tmp_path / f"run.{suffix}"
        result = run("simulate", "--cycles", 2, "--samples", 64, "-o", path)
        assert result.exit_code == 0, result.stderr
        assert path.stat().st_size > 1000
    assert "transmission error, peak to peak" in result.stdout
    assert sorted(p.suffix for p in tmp_path.iterdir()) == [".csv", ".nc", ".png", ".svg"]


def test_simulate_says_where_its_motion_is_not_to_be_relied_on():
    prescribed = ("--set", "mesh.contact=prescribed")
    involutes = ("--set", "mesh.relief=ignored")
    assert run("simulate", "nasa_28_28", "--steady", *prescribed, *involutes).stderr == ""
    assert "contact loss: lowest load of a tooth pair -181" in run("simulate", "--steady", *prescribed).stderr
    separated = run("simulate", "--steady", "--speed", 8500, "--torque", 5, *prescribed, *involutes)
    assert "contact loss: lowest load of a tooth pair -50" in separated.stderr
    assert "--contact unilateral" in separated.stderr
    undamped = ["nasa_art_25_31", "--speed", 18000, "--set", "mesh.damping_ratio=0"]
    assert (
        "is unstable: a disturbance grows 1.081 times"
        in run("simulate", *undamped, *prescribed, "--steady").stderr
    )


def test_simulate_on_shafts(tmp_path, shafted_file):
    path = tmp_path / "run.nc"
    for arguments in (("--steady",), ("--cycles", 1), ("--cycles", 1, "--model", "multibody")):
        on_shafts = ("--supports", "shafts", "--samples", 32, "-o", path, "--force")
        result = run("simulate", shafted_file, *arguments, *on_shafts)
        assert result.exit_code == 0, result.stderr
        with xr.open_dataset(path, engine="h5netcdf") as data:
            assert data.attrs["supports"] == "shafts"
            assert data["bearing_force"].shape[:2] == (4, 2)
    assert "springs for a pair without [shafts]" in refused("simulate", "--supports", "shafts")


@pytest.mark.parametrize(
    ("verdict", "code"),
    [(Verdict.AGREES, 0), (Verdict.DIFFERS, 4), (Verdict.NOT_CHECKED, 0), (Verdict.FAILS, 1)],
)
def test_crosscheck_exits_by_its_verdict(check, monkeypatch, tmp_path, verdict, code):
    class Judged(type(check)):
        pass

    judged = Judged(**vars(check))
    Judged.verdict = property(lambda self: verdict)
    crosscheck_options = {}
    monkeypatch.setattr(
        "validation.cross_check.comparison.crosscheck",
        lambda *_, **options: crosscheck_options.update(options) or judged,
    )
    path = tmp_path / "agreement.png"
    result = run("crosscheck", "-o", path, "--limit", "2%")
    assert result.exit_code == code
    assert crosscheck_options["limit"] == pytest.approx(0.02)
    assert f"{verdict}: {verdict.text}" in result.stdout
    assert path.read_bytes().startswith(b"\x89PNG")
    assert json.loads(run("crosscheck", "--json").stdout)["verdict"] == verdict.word


def test_stability_exits_by_the_operating_point():
    assert run("stability").exit_code == 0
    free = [f"bearings.{g}.{d}_damping_ratio=0" for g in ("pinion", "gear") for d in ("loa", "oloa")]
    changes = [item for field in ["mesh.damping_ratio=0", *free] for item in ("--set", field)]
    assert run("stability", "--speed", 18000, *changes).exit_code == 1


@pytest.fixture
def report_options(monkeypatch):
    """Arguments that reach the report, which is not computed; what it finds can be set."""
    options_of_report = {"failed": (), "findings": frozenset(), "comparison": None}

    def write(pair, out, **options):
        options_of_report.update(options, pair=pair, out=out)
        first = PageOne("a pair", VERDICT.UNCERTAIN, "It compares.", "", (), (), (), "", "", (), ())
        return Report(
            out,
            first,
            options_of_report["failed"],
            options_of_report["findings"],
            1.0,
            options_of_report["comparison"],
        )

    monkeypatch.setattr("validation.reporting.report", write)
    return options_of_report


def test_options_reach_the_report(report_options, tmp_path, shafted_file):
    out = tmp_path / "out"
    old = tmp_path / "old"
    options = ("--quick", "--speed", "3000 rpm", "--law", "coulomb", "--tolerance", "0.01")
    result = run("report", "fzg_c", "-o", out, *options, "--compare", old)
    assert result.exit_code == 0, result.stderr
    assert "It compares." in result.stdout
    assert report_options["pair"].friction.law == "coulomb"
    assert report_options["pair"].operating.pinion_speed == pytest.approx(100 * math.pi)
    expected = {"out": out, "quick": True, "compare": old, "tolerance": 0.01, "force": False, "name": "fzg_c"}
    assert report_options | expected == report_options
    for supports in ((), ("--supports", "springs")):
        assert run("report", shafted_file, "-o", out, *supports).exit_code == 0
        assert report_options["supports"] == (supports[1] if supports else None)


@pytest.mark.parametrize("bad", [(), ("conservation: efficiency, lumped",)])
def test_a_report_with_a_failing_check_exits_1_and_names_it(report_options, tmp_path, bad):
    report_options["failed"] = bad
    result = run("report", "-o", tmp_path / "out")
    assert result.exit_code == (1 if bad else 0)
    assert ("fails: conservation: efficiency" in result.stdout) == bool(bad)


@pytest.mark.parametrize(("require", "findings", "code"), [
    ((), {"contact", "holds"}, 0),
    (("contact",), {"contact", "holds"}, 4),
    (("stable",), {"contact"}, 0),
    (("stable", "holds"), {"holds"}, 4),
    (("contact",), set(), 0),
])  # fmt: skip
def test_findings_about_the_machine_exit_4_where_a_gate_forbids_them(
    report_options, tmp_path, require, findings, code
):
    report_options["findings"] = frozenset(findings)
    result = run("report", "-o", tmp_path / "out", *(word for one in require for word in ("--require", one)))
    assert result.exit_code == code
    assert "holds, stable, contact, record" in refused("report", "-o", tmp_path / "out", "--require", "quiet")


def test_a_record_that_does_not_confirm_exits_4_where_it_is_required(report_options, tmp_path):
    report_options["findings"] = frozenset({"record"})
    options = ("report", "-o", tmp_path / "out", "--record", tmp_path / "run12.toml")
    assert run(*options).exit_code == 0
    result = run(*options, "--require", "record")
    assert result.exit_code == 4
    assert "--require is not met: record" in result.stdout
    report_options["findings"] = frozenset()
    assert run(*options, "--require", "record").exit_code == 0
    assert "Add --record" in refused("report", "-o", tmp_path / "out", "--require", "record")


@pytest.mark.parametrize("fails", [False, True])
def test_a_change_past_its_tolerance_exits_1(report_options, tmp_path, fails):
    change = Change("response/motion/dte", "1", "2", 0.5, fails)
    inputs = Change("parameters/mesh/damping_ratio", "0.05", "0.06", 0.0, False)
    report_options["comparison"] = Comparison("old", 7, (change, inputs))
    result = run("report", "-o", tmp_path / "out", "--compare", tmp_path / "old")
    assert result.exit_code == int(fails)
    assert f"2 changed, {int(fails)} past tolerance" in result.stdout
    assert f"{'past tolerance' if fails else 'within'}  response/motion/dte: 1 -> 2 (50 %)" in result.stdout
    assert "within  parameters/mesh/damping_ratio: 0.05 -> 0.06" in result.stdout


def test_simulate_prints_its_numbers():
    result = run("simulate", "--json", "--cycles", 3, "--samples", 64)
    numbers = json.loads(result.stdout)
    # Extremes between samples are computed: the range of a far finer history, not of the 64 samples.
    last = lumped.simulate("nasa_28_28", 3, samples_per_cycle=4096).isel(time=slice(-4096, None))
    assert numbers["dte_peak_to_peak"] == pytest.approx(float(last.dte.max() - last.dte.min()), rel=1e-4)
    assert (result.exit_code, numbers["gear_pair"], numbers["model"]) == (0, "nasa_28_28", "lumped")


def test_a_run_up_prints_where_each_order_is_largest(tmp_path):
    """So slow that the amplitude of order 1 is that of the periodic motion at that speed."""
    result = run("simulate", "--run-up", "2000..2200", "--seconds", 1, "--json", "-o", tmp_path / "run.png")
    amplitude, rpm = json.loads(result.stdout)["largest"]["1"]
    periodic = lumped.steady_state(lumped.load_gear_pair("nasa_28_28").with_(speed=rpm))["dte"]
    assert amplitude == pytest.approx(2 * abs(np.fft.rfft(periodic)[1]) / periodic.size, rel=0.01)
    assert (tmp_path / "run.png").exists()


def test_stability_and_crosscheck_print_their_verdicts(monkeypatch):
    # The variant is judged in tests/validation/cross_check.
    monkeypatch.setitem(inspect.unwrap(comparison.crosscheck).__kwdefaults__, "variant", False)
    stable = json.loads(run("stability", "--json").stdout)
    assert (stable["verdict"], stable["margin"]) == ("stable", 1.0 - stable["spectral_radius"])
    check = run("crosscheck", "--json", "--cycles", 6, "--samples", 64)
    data = json.loads(check.stdout)
    assert (data["verdict"], check.exit_code) == ("agrees", 0)
    assert data["agreements"]


@pytest.mark.parametrize("command", [("simulate", "--cycles", 2), ("stability",)])
def test_quiet_is_silent(command):
    result = run(*command, "--quiet")
    assert (result.exit_code, result.output) == (0, "")
    assert json.loads(run(*command, "-q", "--json").output)
    refused = run(*command, "-q", "--speed", -5)
    assert refused.exit_code == 2
    assert refused.stderr.startswith("error:")
    assert run(*command).stdout, "silence ends with the command"


def test_samples_end_with_the_time_and_a_number_that_is_asked_for_does_not(tmp_path):
    """Without time the uncertainty has no samples and a comparison 32; with --samples all are taken."""
    path = tmp_path / "mine.toml"
    path.write_text(LINEAR.to_toml(), encoding="utf-8")
    result = run("uncertainty", path, "--seconds", "1e-9")
    assert "0 of 128 samples, seed 1" in result.stdout
    assert "the time of 1e-09 s was used up; --samples 128 takes all" in result.stderr
    result = run("uncertainty", path, "--samples", "16")
    assert "16 of 16 samples, seed 1: 0 refused" in result.stdout
    assert "used up" not in result.stderr
    arguments = "compare", path, "--variant", "torque=90"
    result = run(*arguments, "--seconds", "1e-9")
    assert "32 of 128 possible machines, seed 1; the time of 1e-09 s was used up" in result.stdout
    summary = json.loads(run(*arguments, "--seconds", "1e-9", "--json").stdout)
    assert (summary["taken"], summary["asked"], summary["samples"]) == (32, 128, 32)
