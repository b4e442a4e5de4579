"""Does text from files stay text on the terminal?"""

import io
import os
import shlex
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

import lumped
from lumped.schema.files import preset_text
from validation.cli import app
from validation.commands.terminal import PlainConsole, fail, note, show

#: Text -> how it is shown: markup as it is written, characters that command a terminal as code writes them.
TEXTS = {
    "[/bold][red]x": "[/bold][red]x",
    "[link=file:///etc/passwd]x[/link]": "[link=file:///etc/passwd]x[/link]",
    "a\x1b]0;owned\x07b": "a\\x1b]0;owned\\x07b",
    "a\x9b31mb": "a\\x9b31mb",
    "gear\rpinion": "gear\\rpinion",
    "a\u202eb": "a\\u202eb",  # would turn the rest of the line round
    "µ = 5 °, ü, 齿": "µ = 5 °, ü, 齿",
}


@pytest.mark.parametrize("text", TEXTS)
def test_text_is_shown_as_it_is_written(text, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    console = PlainConsole(file=io.StringIO(), width=200)
    console.print(text)
    assert console.file.getvalue().count(TEXTS[text]) == 1
    show(text, text, [(text,)])
    assert capsys.readouterr().out.count(TEXTS[text]) == 3


def test_cells_of_a_table_have_digits_and_units(capsys):
    show("", "what | >value", [("length", (4.56e-6, "m")), ("speed", 1450.04), ("word", "kept")])
    rows = [line.strip("│ ").split(" │ ") for line in capsys.readouterr().out.splitlines() if "│" in line]
    assert [[cell.strip() for cell in row] for row in rows] == [
        ["length", "4.56\u00a0µm"], ["speed", "1450"], ["word", "kept"]
    ]  # fmt: skip


@cache
def presets_in(**variables):
    """What ``spurcheck presets`` prints with these variables of the environment, and no other COLUMNS."""
    environment = {name: value for name, value in os.environ.items() if name != "COLUMNS"} | variables
    command = [sys.executable, "-m", "spurcheck", "presets"]
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout


@pytest.mark.parametrize("columns", ["0", "1", "-3"])
def test_a_terminal_without_columns_hides_nothing(columns):
    """Some terminals and job schedulers set COLUMNS=0: every table was empty, and the exit code 0."""
    assert presets_in(COLUMNS=columns) == presets_in()
    assert "nasa_28_28" in presets_in()


@pytest.mark.parametrize("text", TEXTS)
def test_a_note_and_an_error_show_text_as_it_is_written(text, capsys):
    note(text)
    with pytest.raises(typer.Exit):
        fail(text, 2)
    assert capsys.readouterr().err.splitlines() == [f"note: {TEXTS[text]}", f"error: {TEXTS[text]}"]


def test_a_name_of_a_file_that_is_no_unicode_can_be_shown():
    console = PlainConsole(file=io.TextIOWrapper(io.BytesIO(), encoding="utf-8"), width=200)
    console.print("a\udcffb\nc")  # how Python names the byte 255, which UTF-8 cannot write
    console.file.flush()
    assert console.file.buffer.getvalue() == b"a\\udcffb\nc\n"


@pytest.mark.parametrize("name", ["[/red]", "a\x1b[31mb"])
def test_commands_show_names_of_files_and_pairs(tmp_path, name):
    pair = tmp_path / f"{name}.toml".replace("/", "|")
    pair.write_text(preset_text("nasa_28_28").replace('name = "nasa_28_28"', 'name = "[/red]"'))
    out = tmp_path / f"{name}.nc".replace("/", "|")
    run = CliRunner().invoke(app, ["simulate", str(pair), "--steady", "-o", str(out)])
    assert run.exit_code == 0, run.output
    assert "[/red]" in run.output
    assert "\x1b" not in run.output
    assert out.exists()


def test_what_is_unknown_is_quoted_in_the_refusal(tmp_path):
    (tmp_path / "x.toml").write_text('"a\\u001b[31m[/red]\\nerror: b" = 1\n')
    run = CliRunner().invoke(app, ["simulate", str(tmp_path / "x.toml")])
    assert run.exit_code == 2, run.output
    assert r"a\x1b[31m[/red]\nerror: b" in run.output


def test_an_encoding_without_box_drawing_characters_ends_no_command(tmp_path):
    pair = tmp_path / "pair.toml"
    pair.write_text(
        preset_text("nasa_28_28").replace('name = "nasa_28_28"', 'name = "─ é"'), encoding="utf-8"
    )
    run = [sys.executable, "-m", "spurcheck", "simulate", str(pair), "--steady"]
    shown = subprocess.run(
        run, env={**os.environ, "PYTHONIOENCODING": "ascii"}, capture_output=True, check=True
    )
    assert b"? ?" in shown.stdout


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="the full device of Linux")
@pytest.mark.parametrize(
    ("full", "words"), [("stdout", "presets"), ("stdout", "--help"), ("stderr", "floquet no.npz")]
)
def test_a_full_output_is_a_failure_of_writing_not_a_verdict_or_a_refusal(full, words):
    run = [sys.executable, "-m", "spurcheck", *words.split()]
    with open("/dev/full", "w") as device:
        streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | {full: device}
        done = subprocess.run(run, text=True, **streams)
    assert done.returncode == 3
    assert done.stderr in (None, "error: the result cannot be printed: No space left on device\n")


_LINES = Path(__file__).with_name("mistakes.txt").read_text(encoding="utf-8").splitlines()
MISTAKES = [line.split(" => ") for line in _LINES if not line.startswith("#")]
STUDY = """name = "s"
gear_pair = "nasa_28_28"
analysis = "floquet"
outputs = ["spectral_radius"]
[[axes]]
field = "operating.torque"
values = [1]
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Folder with the files that the mistakes name."""
    made = tmp_path_factory.mktemp("mistakes")
    pair = lumped.load_gear_pair("nasa_28_28").to_toml()
    other_teeth = pair.replace("teeth = 28", "teeth = 19", 1).replace("teeth = 28", "teeth = 41", 1)
    for name, text in {
        "pair": pair,
        "study": STUDY,
        "empty": "",
        "comma": pair.replace("module = 3.175", "module = 3,175"),
        "quote": pair.replace('name = "nasa_28_28"', "name = nasa"),
        "typo": pair.replace("face_width", "facewidth"),
        "bare_unit": pair.replace("module = 3.175", "module = 3.175 mm"),
        "output": STUDY.replace("operating.torque", "operating.pinion_torque").replace("_radius", "_radus"),
        "missing": pair.replace("teeth = 28\n", "", 1),
        "own": other_teeth.replace("module = 3.175", "module = 2.5"),
    }.items():
        (made / f"{name}.toml").write_text(text, encoding="utf-8")
    return made


@pytest.mark.parametrize(("typed", "answer"), MISTAKES, ids=[typed for typed, _ in MISTAKES])
def test_a_mistake_is_answered_in_its_own_words(folder, monkeypatch, typed, answer):
    monkeypatch.chdir(folder)
    before = sorted(path.name for path in folder.iterdir())
    terminal = {"COLUMNS": "400", "TERMINAL_WIDTH": "400", "NO_COLOR": "1"}
    result = CliRunner().invoke(app, shlex.split(typed), env=terminal)
    assert (result.exit_code, result.stdout) == (2, "")
    message = " ".join(result.stderr.replace("│", " ").split())
    first, _, last = answer.partition(" ... ")
    start = "error:" if first.startswith("error:") else first.split()[0]
    message = message[message.index(start) :].rstrip(" ╰─╯")
    assert message.startswith(first)
    assert message.endswith(last)
    assert sorted(path.name for path in folder.iterdir()) == before
