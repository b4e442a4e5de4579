"""Does ``spurcheck init --from-rexs`` write a parameter file that the other commands take?"""

import tomllib

import pytest
from typer.testing import CliRunner

import lumped
from validation.cli import app
from validation.exchange import gear_pair_from_rexs, parameter_text, write_rexs


def run(*arguments):
    result = CliRunner().invoke(app, list(map(str, arguments)), env={"COLUMNS": "200", "NO_COLOR": "1"})
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result


def test_a_stage_becomes_a_parameter_file_with_units_and_marks(xml, save, tmp_path):
    source, target = save(xml(), "gearbox.rexs"), tmp_path / "mine.toml"
    result = run("init", "--from-rexs", source, "--stage", 1, "-o", target)
    assert result.exit_code == 0
    assert "note: the file does not say which gear drives" in result.stderr
    text = target.read_text(encoding="utf-8")
    assert tomllib.loads(text) == gear_pair_from_rexs(source)[0]
    assert lumped.load_gear_pair(target).gear.teeth == 30
    lines = {line.partition(" = ")[0]: line for line in text.partition("[sources]")[0].splitlines()}
    assert lines["centre_distance"].endswith("# mm")
    assert lines["roughness"].endswith("# um, assumed")
    assert lines["law"].endswith("# assumed")
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


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--stage", "1"), "Give --from-rexs FILE too"),
        (("--from-rexs", "missing.rexs"), "a file that exists"),
    ],
)
def test_a_wrong_call_is_refused_with_exit_code_2(options, message):
    result = run("init", *options)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert message in result.stderr


def test_the_number_of_the_stage_is_passed_on(xml, save):
    result = run("init", "--from-rexs", save(xml()), "--stage", 2, "-o", "-")
    assert result.exit_code == 2
    assert "a whole number, 1 to 1" in result.stderr


def test_a_helical_stage_is_refused_and_nothing_is_written(xml, save, tmp_path):
    result = run("init", "--from-rexs", save(xml(helix="20")), "-o", tmp_path / "pair.toml")
    assert result.exit_code == 2
    assert "helix angle 20 deg" in result.stderr
    assert not (tmp_path / "pair.toml").exists()


def test_the_commented_text_of_every_exported_preset_says_what_was_read(preset, tmp_path):
    mapping, notes = gear_pair_from_rexs(write_rexs(preset, tmp_path / "pair.rexs"))
    assert tomllib.loads(parameter_text(mapping, notes)) == mapping


def test_text_from_elsewhere_cannot_break_out_of_a_comment_or_a_string(xml, save):
    evil = "x&#10;[mesh]&#10;damping_ratio = 9 &quot; '''"
    mapping, notes = gear_pair_from_rexs(save(xml().replace('name="first stage"', f'name="{evil}"')))
    text = parameter_text(mapping, (*notes, "a\nb = 1\r\x1b[31m"))
    assert tomllib.loads(text) == mapping
    assert mapping["mesh"]["damping_ratio"] == 0.05
    assert "\x1b" not in text
