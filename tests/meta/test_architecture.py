"""Is the engine free of gears, and are the public names there, described and cheap to import?"""

from __future__ import annotations

import ast
import inspect
import subprocess
import sys
from pathlib import Path

import pytest

import floquet

ROOT = Path(floquet.__file__).parent
ENGINE = sorted(
    path
    for path in ROOT.rglob("*.py")
    if "gear" not in path.relative_to(ROOT).parts and path.name != "__init__.py"
)


def imported(path: Path) -> set[str]:
    """Every module that a file imports, wherever in it."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            names.add(str(node.module))
    return names


@pytest.mark.parametrize("path", ENGINE, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_engine_knows_no_gears(path: Path) -> None:
    found = imported(path)
    allowed = {"lumped.arguments", "lumped.errors", "lumped.compiler"}
    assert {name for name in found if name.split(".")[0] == "lumped"} <= allowed
    assert not {name for name in found if name.startswith("floquet.gear.")}
    assert not {name for name in found if name.split(".")[0] in ("multibody", "validation", "matplotlib")}


def test_the_test_above_sees_imports() -> None:
    assert len(ENGINE) > 25
    assert "lumped.model.periodic_system" in imported(ROOT / "gear" / "block.py")


def test_public_names_exist_and_are_described() -> None:
    for name in floquet.__all__:
        value = getattr(floquet, name)
        assert name in dir(floquet)
        if inspect.ismodule(value):
            pytest.fail(f"floquet.{name} is a module")
        if callable(value):
            assert inspect.getdoc(value), name
    with pytest.raises(AttributeError, match="no_such_name"):
        floquet.no_such_name  # noqa: B018
    eager = {"PROPAGATORS", "Monodromy", "PeriodicSystem", "Propagator", "Spectrum", "chart", "load_chart"}
    eager |= {"monodromy", "save_chart", "scan", "gear_block"}
    assert set(floquet._MODULES) | eager == set(floquet.__all__)


def test_functions_survive_the_import_of_their_modules() -> None:
    # Importing a submodule sets it as an attribute of the package: a function of that name must stay.
    code = (
        "import floquet.engine.monodromy, floquet.engine.chart, floquet.gear.block, floquet\n"
        "assert all(callable(getattr(floquet, name)) for name in floquet.__all__ if name[0].islower())"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_kernels_are_loaded_on_demand() -> None:
    code = "import sys, floquet; print([m for m in sys.modules if m.startswith('floquet.rank_one.kernels')])"
    out = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout
    assert out.strip() == "[]"
