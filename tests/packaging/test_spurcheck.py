"""The module `spurcheck`: the verbs of the packages under one name, and the command."""

import ast
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

import lumped
import multibody
import spurcheck

SOURCE = ast.parse(Path(spurcheck.__file__).read_text(encoding="utf-8"))


def test_every_name_is_what_its_annotation_imports():
    """What a type checker sees, the imports of the block for it, is what `__getattr__` gives."""
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
        assert getattr(spurcheck, name) is getattr(import_module(source), name), name
    for name in packages:
        assert getattr(spurcheck, name) is import_module(name)


def test_a_name_that_two_packages_have_is_that_of_the_lumped_model():
    assert spurcheck.simulate is lumped.simulate
    assert spurcheck.multibody.simulate is multibody.simulate
    with pytest.raises(AttributeError, match="no_such_name"):
        spurcheck.no_such_name  # noqa: B018


def test_it_runs_the_command():
    run = [sys.executable, "-m", "spurcheck", "--version"]
    assert subprocess.check_output(run, text=True).strip() == f"spurcheck {spurcheck.__version__}"
