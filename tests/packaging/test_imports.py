"""Does the command answer at once, and does an import load only what it needs?"""

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
COMMAND = """
import typer.testing, validation.cli
    for arguments in {}:
        assert typer.testing.CliRunner().invoke(validation.cli.app, arguments).exit_code == 0
"""


def loaded(code, limit):
    """Processor time [s] of a statement in a process of its own, and the modules it loads.

    Processor time too grows on a busy machine: what takes longer than the limit gets two more chances.
    """
    command = [sys.executable, "-c", TIMED.format(code=code.strip())]
    for _ in range(3):
        seconds, modules = json.loads(subprocess.check_output(command, text=True))
        if seconds < limit:
            break
    return seconds, set(modules)


def test_help_answers_within_half_a_second():
    seconds, _ = loaded(COMMAND.format([["--help"]]), 0.5)
    assert seconds < 0.5  # 0.2 s where this was written


def test_help_loads_no_numerics():
    helps = [["--version"], ["--help"], ["sweep", "--help"], ["export", "--help"]]
    _, modules = loaded(COMMAND.format(helps), 2.0)
    assert sorted(modules & NUMERICS) == []


@pytest.mark.parametrize("package", ["spurcheck", "validation"])
def test_names_of_packages_are_imported_on_first_use(package):
    seconds, modules = loaded(f"import {package}", 0.3)
    assert sorted(modules & NUMERICS) == []
    assert seconds < 0.3  # 0.03 s where this was written


@pytest.mark.parametrize("package", ["lumped", "multibody", "floquet"])
def test_an_import_loads_nothing_heavy_and_takes_a_second_and_a_half_at_most(package):
    seconds, modules = loaded(f"import {package}", 1.5)
    assert not modules & (HEAVY | (set() if package == "multibody" else {"exudyn"}))
    assert not [name for name in modules if name.startswith("floquet.rank_one.kernels")]  # slow to compile
    # 0.6 s to 0.8 s on a busy machine where this was written, most of it numpy, scipy, numba and pydantic.
    assert seconds < 1.5
