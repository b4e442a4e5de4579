"""Figures and printed lines of the tutorial on any system, of the files and commands of the page."""

from __future__ import annotations

import os
import re
import shlex
from collections.abc import Callable
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from typer.testing import CliRunner

from computed import DOCS
from computed.interface import transcript_text
from validation.cli import app

_PAGE = DOCS / "tutorial" / "own_system.md"
_BLOCK = re.compile(r"^```(python|sh)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
#: Section of the page -> the last lines that its first command prints.
_OUTPUTS = {"mathieu.py": "output_mathieu.md", "blade.py": "output_blade.md", "crack.npz": "output_crack.md"}


@cache
def _results() -> dict[str, str]:
    """File below docs/_generated -> its text. Figures are written as SVG."""
    home = Path.cwd()
    texts: dict[str, str] = {}
    with TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            for language, block in _BLOCK.findall(_PAGE.read_text(encoding="utf-8")):
                if language == "sh":
                    for line in block.strip().splitlines():
                        _run(line.replace(".png", ".svg"), texts)
                elif name := re.match(r"# (\w+\.py)\n", block):
                    Path(name[1]).write_text(block)
                elif "np.savez" in block:
                    exec(compile(block, str(_PAGE), "exec"), {})
            texts |= {path.name: path.read_text(encoding="utf-8") for path in Path().glob("*.svg")}
        finally:
            os.chdir(home)
    return texts


def _run(line: str, texts: dict[str, str]) -> None:
    """Run a command of the page; the first one on a file gives the lines that the page shows."""
    _, *arguments = shlex.split(line)
    result = CliRunner().invoke(app, arguments, env={"COLUMNS": "92", "TERM": "dumb", "NO_COLOR": "1"})
    if result.exit_code:
        raise RuntimeError(f"{line}: exit code {result.exit_code}\n{result.output}")
    output = _OUTPUTS[arguments[1].split(":")[0]]
    texts.setdefault(output, transcript_text(result.stdout))


def _file(name: str) -> Callable[[], str]:
    return lambda: _results()[name]


FILES: dict[str, Callable[[], str]] = {
    name: _file(name)
    for name in (*_OUTPUTS.values(), "mathieu.svg", "blade.svg", "blade_multipliers.svg", "crack.svg")
}
