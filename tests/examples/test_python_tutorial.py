"""Does every line of the Python tutorial and of the notebook run as printed, and are they the same?"""

import json
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def tutorial():
    text = (ROOT / "docs" / "tutorial" / "in_python.md").read_text(encoding="utf-8")
    return [code.strip() for code in re.findall(r"```python\n(.*?)```", text, re.DOTALL)]


def notebook():
    cells = json.loads((ROOT / "examples" / "first_session.ipynb").read_text(encoding="utf-8"))["cells"]
    return ["".join(cell["source"]).strip() for cell in cells if cell["cell_type"] == "code"]


@pytest.mark.parametrize("source", [tutorial, notebook])
def test_it_runs(source, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    names = {}
    for code in source():
        exec(code, names)
    assert {path.name for path in tmp_path.iterdir()} == {"steady.png", "chart.png"}
    assert "4875.0" in capsys.readouterr().out


def test_the_notebook_is_the_tutorial():
    assert notebook() == tutorial()
