"""Does the command do what its options say, and does its exit code?"""

from __future__ import annotations

import io

import pytest
from rich.console import Console
from typer.testing import CliRunner

from validation.cli import app
from validation.studies import read_results
from validation.studies.cli_sweep import SweepProgress

OK, FAILED, REFUSED, STOPPED, INTERRUPTED = 0, 1, 2, 3, 130

STUDY = """
name = "command [red]"
gear_pair = "nasa_28_28"
analysis = "geometry"
outputs = ["contact_ratio"]
[[axes]]
field = "centre_distance"
values = {values}
"""


@pytest.fixture
def command(tmp_path, monkeypatch):
    """Run the command on a study with the given distances; returns exit code and what was printed."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "study.toml").write_text(STUDY.format(values=[88.9, 89.0, 89.1]))

    def run(values=None, **options):
        if values is not None:
            (tmp_path / "study.toml").write_text(STUDY.format(values=values))
        words = ["sweep", "study.toml"]
        for name, value in ({"workers": 0} | options).items():
            words += [f"--{name.replace('_', '-')}", *([] if value is True else [str(value)])]
        result = CliRunner().invoke(app, words)
        return result.exit_code, result.output

    return run


def test_all_cases_computed_is_0(command, tmp_path):
    code, text = command()
    assert code == OK
    assert "command [red]: 3 cases, geometry" in text
    assert "3 computed, 0 kept from before" in text
    assert read_results(tmp_path / "study-sweep").contact_ratio.notnull().all()


def test_a_failed_case_is_1_and_listed(command):
    code, text = command([88.5, 88.9])
    assert code == FAILED
    assert "case 0: " in text
    assert "refused" in text


def test_a_refused_study_is_2_and_one_message(command, tmp_path):
    code, text = command(["88.9 kg"])
    assert code == REFUSED
    assert "axes.0.values" in text
    assert "Traceback" not in text
    assert not (tmp_path / "study-sweep").exists()


@pytest.mark.parametrize("options", [{"workers": 1025}, {"scheduler": "nonsense"}, {"case_seconds": 1e-9}])
def test_refused_options_leave_the_folder_free(command, options):
    assert command(**options)[0] == REFUSED
    assert command()[0] == OK


def test_the_second_run_needs_resume(command):
    assert command()[0] == OK
    code, text = command()
    assert code == REFUSED
    assert "--resume" in text
    code, text = command(resume=True)
    assert code == OK
    assert "0 computed, 3 kept from before" in text


def test_a_store_that_cannot_be_written_is_3(command, tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "store.sqlite").symlink_to(tmp_path / "elsewhere")
    code, text = command(output=tmp_path / "out", resume=True)
    assert code == STOPPED
    assert "symbolic link" in text
    assert not (tmp_path / "elsewhere").exists()


def test_ctrl_c_is_130_and_says_how_to_go_on(command):
    def interrupt(self, done, total, failed):
        raise KeyboardInterrupt

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(SweepProgress, "__call__", interrupt)
        code, text = command()
    assert code == INTERRUPTED
    assert "--resume" in text
    assert command(resume=True)[0] == OK


def test_dry_run_only_counts(command, tmp_path):
    code, text = command(dry_run=True)
    assert (code, "3 cases" in text) == (OK, True)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["study.toml"]


def test_progress_shows_rate_failures_and_time_left(monkeypatch):
    monkeypatch.setenv("TERM", "xterm")
    text = io.StringIO()
    with SweepProgress(Console(file=text, width=200, force_terminal=True)) as progress:
        progress(30, 120, 2)
        progress._bar.refresh()
    shown = text.getvalue()
    assert "30/120" in shown
    assert "cases/s" in shown
    assert "2 failed" in shown
    assert "left" in shown


def test_progress_without_a_terminal_is_a_line_now_and_then(monkeypatch):
    monkeypatch.setattr("validation.studies.cli_sweep._PLAIN_SECONDS", -1.0)
    text = io.StringIO()
    with SweepProgress(Console(file=text, width=200)) as progress:
        progress(30, 120, 2)
    assert "30/120" in text.getvalue()
    assert "s left" in text.getvalue()


def test_the_command_is_part_of_spurcheck(command):
    arguments = ["sweep", "study.toml", "-o", "out", "--workers", "1"]
    first = CliRunner().invoke(app, arguments)
    assert first.exit_code == OK, first.output
    assert "3 computed" in first.output
    assert CliRunner().invoke(app, arguments).exit_code == REFUSED
    again = CliRunner().invoke(app, [*arguments, "--resume"])
    assert again.exit_code == OK, again.output
