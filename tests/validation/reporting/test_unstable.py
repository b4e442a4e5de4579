"""Does a report of an unstable motion say so wherever it shows that motion, and does --strict fail it?"""

import dataclasses
import json
import re

import numpy as np
import pytest
from typer.testing import CliRunner

import lumped
from lumped.model.periodic_cycle import UNSTABLE
from validation import plots
from validation.cli import app
from validation.reporting import build, results
from validation.reporting.chapters.steady_state import off_line_modes

#: In the widest tongue of the default pair: largest multiplier 1.29 without mesh damping.
UNSTABLE_POINT = ("--speed", "17000 rpm", "--set", "mesh.damping_ratio=0")


def run(*arguments):
    result = CliRunner().invoke(app, list(map(str, arguments)), env={"COLUMNS": "400", "NO_COLOR": "1"})
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result


@pytest.fixture(scope="module", autouse=True)
def tiny():
    effort = dataclasses.replace(
        results.QUICK, samples=64, cycles=6, sweep_speeds=9, chart_speeds=4, chart_dampings=2, map_speeds=2
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(build, "QUICK", effort)
        yield


@pytest.fixture(scope="module")
def unstable(tmp_path_factory):
    out = tmp_path_factory.mktemp("reports") / "unstable"
    return run("report", "--quick", "--strict", *UNSTABLE_POINT, "-o", out), out


def test_strict_exits_1_and_names_what_fails(unstable):
    result, out = unstable
    assert result.exit_code == 1
    failing = [line for line in result.stdout.splitlines() if line.startswith("fails: ")]
    assert any("Is the motion stable?" in line for line in failing)
    assert any("Periodic motion is stable" in line for line in failing)
    # The folder is whole all the same: a gate's evidence.
    assert json.loads((out / "report.json").read_text(encoding="utf-8"))["format"] == "spurcheck-report"


def _patched(monkeypatch, bad):
    written = build.Report(build.Path("out"), "It holds.", {}, bad, 1.0)
    monkeypatch.setattr("validation.reporting.report", lambda *_, **__: written)


@pytest.mark.parametrize("bad", [(), ("validity: Torques balance: violated",)])
@pytest.mark.parametrize("strict", [False, True])
def test_only_strict_turns_a_failing_verdict_into_an_exit_code(monkeypatch, tmp_path, strict, bad):
    _patched(monkeypatch, bad)
    result = run("report", "-o", tmp_path / "out", *(["--strict"] if strict else []))
    assert result.exit_code == (1 if strict and bad else 0)
    assert ("Torques balance" in result.stdout) == bool(strict and bad)


def test_every_chapter_on_the_motion_warns(unstable):
    _, out = unstable
    data = json.loads((out / "report.json").read_text(encoding="utf-8"))
    assert data["verdict"].startswith("Do not rely on this prediction: the periodic motion is unstable")
    assert "the lumped model predicts" not in data["verdict"]
    prediction = data["answers"][0]
    assert prediction["verdict"] == {"state": "violated", "text": "not reliable"}
    assert prediction["text"].startswith("Not to be relied on: the periodic motion is unstable")
    for key in ("steady_state", "losses", "cross_check"):
        assert data["chapters"][key]["text"][0][0].startswith("Warning: the periodic motion"), key
    motion = data["chapters"]["steady_state"]["key_results"]["stability"]
    assert motion["value"]["state"] == "unstable"
    assert "1.28" in motion["note"]


def test_a_stable_report_warns_of_nothing(check, tmp_path):
    result = run("report", "--quick", "-o", tmp_path / "calm")
    assert result.exit_code == 0
    text = (tmp_path / "calm" / "index.html").read_text(encoding="utf-8")
    assert "Warning" not in re.sub(r"data:image[^\"]*", "", text)
    data = json.loads((tmp_path / "calm" / "report.json").read_text(encoding="utf-8"))
    assert data["answers"][0]["verdict"]["state"] == "prediction"
    assert data["chapters"]["steady_state"]["over_speed"]["share_unstable"]["value"] == 0.0


def test_the_sweep_counts_unstable_speeds_and_names_no_peak_among_them(unstable, pair):
    _, out = unstable
    data = json.loads((out / "report.json").read_text(encoding="utf-8"))
    facts = data["chapters"]["steady_state"]["over_speed"]
    at = pair.with_({"mesh.damping_ratio": 0.0})
    speeds = np.linspace(facts["speed_low"]["value"]["value"], facts["speed_high"]["value"]["value"], 9)
    radii = lumped.speed_sweep(at, speeds, samples_per_cycle=8)["spectral_radius"].to_numpy()
    assert facts["share_unstable"]["value"] == np.mean(radii > UNSTABLE)
    peak = facts["speed_of_largest"]["value"]["value"]
    assert radii[np.argmin(np.abs(speeds - peak))] < UNSTABLE
    assert facts["speed_of_largest"]["note"] == "among stable motions"


def test_the_sweep_figure_crosses_unstable_motions_out(pair):
    sweep = lumped.speed_sweep(pair.with_({"mesh.damping_ratio": 0.0}), [4000, 17000], samples_per_cycle=16)
    figure = plots.sweep_figure(sweep, 4000.0, 1000.0)
    crosses = [line for line in figure.axes[0].lines if line.get_marker() == "x"]
    assert [line.get_xdata().tolist() for line in crosses] == [[17000.0]]


def test_equal_gears_have_three_modes_of_one_frequency_of_which_two_are_off_the_line(pair):
    # x_p = x_g moves no tooth: its frequency is that of the bearings, which here are alike in x and y.
    found = lumped.model.averaged.modes(pair)
    frequency = np.sqrt(1e8 / lumped.bodies(pair).mass_pinion) / (2 * np.pi)
    same = [mode for mode in found if abs(mode.natural_frequency / frequency - 1) < 1e-9]
    assert len(same) == 3
    places = off_line_modes(_Only(pair, found))
    assert len(places) == 2
    # With softer bearings off the line the two are told by frequency.
    soft = pair.with_(
        {"bearings.pinion.oloa_stiffness": 2e7, "bearings.gear.oloa_stiffness": 3e7, "pinion.mass": 0.5}
    )
    found = lumped.model.averaged.modes(soft)
    chosen = sorted(found[k].natural_frequency for k in off_line_modes(_Only(soft, found)))
    expected = sorted(
        np.sqrt(k / m) / (2 * np.pi) for k, m in ((2e7, 0.5), (3e7, lumped.bodies(soft).mass_gear))
    )
    np.testing.assert_allclose(chosen, expected, rtol=1e-9)


@dataclasses.dataclass
class _Only:
    """The results that the modes' table reads."""

    pair: lumped.GearPair
    modes: tuple
