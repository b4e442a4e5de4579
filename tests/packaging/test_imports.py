"""Does the command answer at once, and does an import load only what it needs?"""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

#: Libraries that take a tenth of a second or more, or a display, and that a bare import has no use for.
HEAVY = {"control", "dask", "distributed", "matplotlib", "pandas", "plotly", "scipy.stats", "xarray"}
NUMERICS = HEAVY | {"exudyn", "lumped", "numba", "numpy", "pint", "scipy"}
TIMED = """
import contextlib, json, os, sys, time
start = time.process_time()
with open(os.devnull, "w") as nowhere, contextlib.redirect_stdout(nowhere):
    {code}
print(json.dumps([time.process_time() - start, list(sys.modules)]))
"""
COMMAND = "import typer.testing, validation.cli; typer.testing.CliRunner().invoke(validation.cli.app, {})"


def loaded(code):
    """Processor time [s] of a statement in a process of its own, the fastest of three, and the modules.

    Processor time too grows on a busy machine, therefore the fastest.
    """
    command = [sys.executable, "-c", TIMED.format(code=code)]
    runs = [json.loads(subprocess.check_output(command, text=True)) for _ in range(3)]
    return min(seconds for seconds, _ in runs), set(runs[0][1])


@pytest.mark.parametrize("arguments", [["--help"], ["--version"], ["sweep", "--help"], ["export", "--help"]])
def test_help_loads_no_numerics_and_answers_within_half_a_second(arguments):
    seconds, modules = loaded(COMMAND.format(arguments))
    assert sorted(modules & NUMERICS) == []
    assert seconds < 0.5  # 0.2 s where this was written


@pytest.mark.parametrize("package", ["lumped", "multibody", "floquet", "validation"])
def test_an_import_loads_nothing_heavy_and_takes_a_second_and_a_half_at_most(package):
    seconds, modules = loaded(f"import {package}")
    assert not modules & (HEAVY | (set() if package == "multibody" else {"exudyn"}))
    # 0.6 s to 0.8 s on a busy machine where this was written, most of it numpy, scipy, numba and pydantic.
    assert seconds < 1.5
