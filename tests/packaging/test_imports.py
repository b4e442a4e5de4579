"""Does the wheel have every file, do imports stay light, does the module spurcheck have every name?"""

import ast
import json
import math
import subprocess
import sys
import tomllib
from fnmatch import fnmatch
from importlib import import_module
from importlib.util import find_spec
from inspect import unwrap
from pathlib import Path

import pytest

import lumped
import multibody
import spurcheck

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
    assert sorted(modules & (NUMERICS - {"lumped"})) == []
    # The package imports its names on first use; texts of numbers need no library.
    of_lumped = {name for name in modules if name.split(".")[0] == "lumped"}
    assert of_lumped == {"lumped", "lumped.display", "lumped.display.formatting", "lumped.public_names"}


#: Libraries that compute, read units or write results. A parameter file is read and written without them.
COMPUTING = HEAVY | {"exudyn", "h5py", "numba", "pint", "scipy"}
SIZES = ["--module", "2.5", "--face-width", "20", "--speed", "1450", "--torque", "80", "--oil", "vg220"]


@pytest.mark.parametrize(
    "arguments",
    [
        ["presets"],
        ["presets", "nasa_28_28"],
        ["init", "-o", "-"],
        ["init", "--teeth", "19/41", *SIZES, "-o", "-"],
    ],
    ids=lambda arguments: " ".join(arguments[:2]),
)
def test_parameter_files_are_shown_and_written_without_libraries_that_compute(arguments):
    _, modules = loaded(COMMAND.format([arguments]), 2.0)
    assert {"lumped", "pydantic"} <= modules
    assert sorted(modules & COMPUTING) == []


@pytest.mark.parametrize("package", ["spurcheck", "validation", "lumped", "floquet"])
def test_names_of_packages_are_imported_on_first_use(package):
    seconds, modules = loaded(f"import {package}", 0.3)
    # All packages take the list of their names from lumped.public_names, which needs no library.
    assert sorted(modules & (NUMERICS - {package, "lumped"})) == []
    of_lumped = {name for name in modules if name.split(".")[0] == "lumped"}
    assert of_lumped <= {"lumped", "lumped.public_names"}
    assert seconds < 0.3  # 0.03 s where this was written


@pytest.mark.parametrize("package", ["lumped", "multibody", "floquet"])
def test_an_import_loads_nothing_heavy_and_takes_a_second_and_a_half_at_most(package):
    seconds, modules = loaded(f"import {package}", 1.5)
    assert not modules & (HEAVY | (set() if package == "multibody" else {"exudyn"}))
    assert not [name for name in modules if name.startswith("floquet.rank_one.kernels")]  # slow to compile
    # 0.6 s to 0.8 s on a busy machine where this was written, most of it numpy, scipy, numba and pydantic.
    assert seconds < 1.5


def test_a_report_without_a_record_loads_nothing_that_reads_and_judges_records():
    """Both processes of a report would import 68 modules that only a record needs."""
    _, modules = loaded("import validation.reporting.build, validation.reporting.chapters", 10.0)
    assert "validation.reporting.chapters.record" in modules
    assert not [name for name in modules if name.startswith("validation.check")]
    assert "scipy.stats" not in modules  # a third of a second, before the first result


def test_samples_do_not_import_scipy_stats_once_their_points_are_stored():
    """It takes a quarter of a second, in both processes of a report."""
    samples = (
        "import lumped; from validation.prediction.uncertainty import uncertainty; "
        "uncertainty(lumped.load_gear_pair('nasa_28_28').with_({'uncertainty': {"
        "'operating.pinion_torque': '+- 4 %'}}), 16)"
    )
    loaded(samples, math.inf)  # another run has stored the points, or this one does
    _, modules = loaded(samples, math.inf)
    assert "validation.prediction.sobol" in modules
    assert "scipy.stats" not in modules


#: In the place of the report it prints what is imported of dask.
IN_A_REPORT = """
import sys, types
from validation.cli import main
def report(*arguments, **options):
    import xarray
    xarray.Dataset({"x": ("time", [1.0])}).to_dataframe()
    print(*(name for name in sys.modules if name.startswith("dask.")), "no more")
    sys.exit()
sys.modules["validation.reporting.build"] = types.SimpleNamespace(report=report)
sys.argv[1:] = ["report", "nasa_28_28"]
main()
"""


@pytest.mark.skipif(find_spec("dask") is None, reason="xarray finds no dask anyway")
def test_a_report_does_not_import_dask(tmp_path):
    """With the extra ``cluster`` xarray would import it, before the first result."""
    command = [sys.executable, "-c", IN_A_REPORT]
    assert subprocess.check_output(command, cwd=tmp_path, text=True).strip() == "no more"


ROOT = Path(__file__).parents[2]
PACKAGES = ("lumped", "multibody", "floquet", "validation")


def test_every_file_of_the_packages_goes_into_the_wheel():
    data = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    patterns = data["tool"]["setuptools"]["package-data"]
    found = 0
    left_out = []
    for package in PACKAGES:
        for path in sorted((ROOT / package).rglob("*")):
            if path.is_dir() or path.suffix == ".py" or path.parent.name == "__pycache__":
                continue
            found += 1
            name = path.relative_to(ROOT / package).as_posix()
            named = any(fnmatch(name, pattern) for pattern in patterns.get(package, ()))
            if not named and not any(fnmatch(path.name, pattern) for pattern in patterns["*"]):
                left_out.append(f"{package}/{name}")
    assert left_out == []
    assert found > 10


SOURCE = ast.parse(Path(spurcheck.__file__).read_text(encoding="utf-8"))


def test_every_name_is_what_its_annotation_imports():
    """Every name that `__getattr__` returns is the object of the import under TYPE_CHECKING."""
    (block,) = (
        node for node in SOURCE.body if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node)
    )
    packages = {alias.name for node in block.body if isinstance(node, ast.Import) for alias in node.names}
    verbs = {
        alias.name: node.module
        for node in block.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    assert {*packages, *verbs, "__version__"} == set(dir(spurcheck))
    for name, source in verbs.items():
        assert unwrap(getattr(spurcheck, name)) is unwrap(getattr(import_module(source), name)), name
    for name in packages:
        assert getattr(spurcheck, name) is import_module(name)


def test_a_name_that_two_packages_have_is_that_of_the_lumped_model():
    assert unwrap(spurcheck.simulate) is unwrap(lumped.simulate)
    assert spurcheck.multibody.simulate is multibody.simulate
    with pytest.raises(AttributeError, match="no_such_name"):
        spurcheck.no_such_name  # noqa: B018


def test_it_runs_the_command():
    run = [sys.executable, "-m", "spurcheck", "--version"]
    assert subprocess.check_output(run, text=True).strip() == f"spurcheck {spurcheck.__version__}"


IMPORTED = "import sys; sys.path[:0] = {paths!r}; import spurcheck; print(spurcheck.__file__)"


@pytest.mark.parametrize("how", ["earlier on the path", "replaced", "without __init__.py"])
def test_a_foreign_package_of_the_same_name_is_named_in_one_sentence(tmp_path, how):
    """A distribution of the package index installs a folder ``validation``, too."""
    root = Path(spurcheck.__file__).parent
    site = tmp_path / "site"
    site.mkdir()
    (site / "spurcheck.py").write_text((root / "spurcheck.py").read_text(encoding="utf-8"))
    for name in ("lumped", "multibody", "floquet", "validation"):
        (site / name).mkdir()
        (site / name / "__init__.py").write_text((root / name / "__init__.py").read_text(encoding="utf-8"))
    paths = [str(site)]
    command = [sys.executable, "-I", "-c", IMPORTED.format(paths=paths)]
    alone = subprocess.run(command, capture_output=True, text=True, check=True)
    assert alone.stdout.strip() == str(site / "spurcheck.py")
    if how == "replaced":
        (site / "validation" / "__init__.py").write_text("VERSION = 1\n")
    elif how == "without __init__.py":
        (site / "validation" / "__init__.py").unlink()
    else:
        (tmp_path / "other" / "validation").mkdir(parents=True)
        (tmp_path / "other" / "validation" / "__init__.py").write_text("VERSION = 1\n")
        paths.insert(0, str(tmp_path / "other"))
    command[-1] = IMPORTED.format(paths=paths)
    foreign = subprocess.run(command, capture_output=True, text=True, check=False)
    last = foreign.stderr.strip().splitlines()[-1]
    assert last.startswith("ImportError: spurcheck needs its package 'validation', but Python finds ")
    assert last.endswith("install spurcheck into an environment of its own (python -m venv).")
