"""Reference of the command, from its own help."""

from __future__ import annotations

import os
import re
import textwrap
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

from typer.main import get_command
from typer.testing import CliRunner

from validation.cli import app

_RUNNER = CliRunner()
_TERMINAL = {"COLUMNS": "92", "TERMINAL_WIDTH": "92", "TERM": "dumb", "NO_COLOR": "1"}
_ESCAPES = re.compile(r"\x1b\[[0-9;]*m")


def help_text(*command: str) -> str:
    """What ``--help`` prints, for a terminal of 92 columns."""
    result = _RUNNER.invoke(app, [*command, "--help"], env=_TERMINAL)
    if result.exit_code:
        raise RuntimeError(f"spurcheck {' '.join(command)} --help: exit code {result.exit_code}")
    lines = (line.rstrip() for line in _ESCAPES.sub("", result.output).strip("\n").splitlines())
    return "\n".join(lines)


def commands() -> str:
    """One section per command."""
    parts = [f"```text\n{help_text()}\n```\n"]
    for name in get_command(app).commands:  # type: ignore[attr-defined]
        parts.append(f"## spurcheck {name}\n\n```text\n{help_text(name)}\n```\n")
    return "\n".join(parts)


def transcript(*command: str, exit_code: int = 0, before: tuple[str, ...] = ()) -> str:
    """What a command prints, run in an empty folder after another one."""
    home = Path.cwd()
    with TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            if before:
                _RUNNER.invoke(app, list(before))
            result = _RUNNER.invoke(app, list(command), env=_TERMINAL)
        finally:
            os.chdir(home)
    if result.exit_code != exit_code:
        raise RuntimeError(f"spurcheck {' '.join(command)}: exit code {result.exit_code}\n{result.output}")
    return transcript_text(result.output)


def transcript_text(output: str) -> str:
    """Block of text of what a command printed."""
    lines = (wrapped(line.rstrip()) for line in _ESCAPES.sub("", output).strip("\n").splitlines())
    return "```text\n" + "\n".join(lines) + "\n```\n"


def wrapped(line: str) -> str:
    """A line as a terminal of 92 columns breaks it."""
    return "\n".join(textwrap.wrap(line, 92, drop_whitespace=False)) if len(line) > 92 else line


_INIT = ("init", "nasa_28_28", "-o", "mypair.toml")

FILES: dict[str, Callable[[], str]] = {
    "commands.md": commands,
    "output_crosscheck.md": lambda: transcript("crosscheck", "nasa_28_28"),
    "output_simulate.md": lambda: transcript("simulate", "mypair.toml", "-o", "run.nc", before=_INIT),
    "output_compare.md": lambda: transcript(
        *("compare", "mypair.toml", "--variant", "bearings.stiffness=3e8"),
        *("--variant", "torque=40; oil=vg220; temperature=60"),
        before=_INIT,
    ),
    "output_refused.md": lambda: transcript(
        "simulate", "mypair.toml", "--set", "centre_distance=80", exit_code=2, before=_INIT
    ),
    "output_stability.md": lambda: transcript("stability", "mypair.toml", "-o", "chart.png", before=_INIT),
}
