"""Does a mistaken input get a message that names what was typed first, and ends with what to do?"""

import shlex
from pathlib import Path

import pytest
from typer.testing import CliRunner

import lumped
from validation.cli import app

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
    made, pair = tmp_path_factory.mktemp("mistakes"), lumped.load_gear_pair("nasa_28_28").to_toml()
    own = pair.replace("teeth = 28", "teeth = 19", 1).replace("teeth = 28", "teeth = 41", 1)
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
        "own": own.replace("module = 3.175", "module = 2.5"),
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
    said = " ".join(result.stderr.replace("│", " ").split())
    first, _, last = answer.partition(" ... ")
    start = "error:" if first.startswith("error:") else first.split()[0]
    said = said[said.index(start) :].rstrip(" ╰─╯")
    assert said.startswith(first)
    assert said.endswith(last)
    assert sorted(path.name for path in folder.iterdir()) == before
