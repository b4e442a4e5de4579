"""Does an edit of one compiled file reach the functions of other files that call it?"""

from __future__ import annotations

import importlib
import pkgutil
import sys
from pathlib import Path

import pytest
from numba.core.dispatcher import Dispatcher

JIT = """
from pathlib import Path
from lumped.compiler import Compiler

compiled = Compiler(Path(__file__).parent.glob("*.py"))
"""
CALLED = """
from pkg.jit import compiled

@compiled
def double(x):
    return 2.0 * x
"""
CALLER = """
from pkg.jit import compiled
from pkg.called import double

@compiled
def f(x):
    return double(x)
"""


def test_the_cache_notices_edits_of_called_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "dont_write_bytecode", True)  # it knows an edit by the second and the size
    monkeypatch.syspath_prepend(tmp_path)
    package = tmp_path / "pkg"
    package.mkdir()
    for name, text in (("__init__", ""), ("jit", JIT), ("called", CALLED), ("caller", CALLER)):
        (package / f"{name}.py").write_text(text, encoding="utf-8")

    def run() -> tuple[float, ...]:
        """Value, and the number of functions taken from the cache."""
        for name in [name for name in sys.modules if name.partition(".")[0] == "pkg"]:
            monkeypatch.delitem(sys.modules, name)
        f = importlib.import_module("pkg.caller").f
        return f(1.0), sum(f.stats.cache_hits.values())

    assert run() == (2.0, 0)
    assert run() == (2.0, 1)  # there is a cache to go stale
    (package / "called.py").write_text(CALLED.replace("2.0", "3.0"), encoding="utf-8")
    assert run() == (3.0, 0)


@pytest.mark.parametrize("package", ["floquet.rank_one.kernels", "multibody.contact"])
def test_every_compiled_function_that_calls_across_files_has_the_stamp(package: str) -> None:
    folder = importlib.import_module(package).__path__
    modules = [importlib.import_module(f"{package}.{module.name}") for module in pkgutil.iter_modules(folder)]
    functions = {f for module in modules for f in vars(module).values() if isinstance(f, Dispatcher)}
    own = {f for f in functions if f.py_func.__module__.startswith(package)}
    assert len(own) > 10
    stamps = {f._cache._cache_file._source_stamp[1] for f in own}  # without it: (time, size) of one file
    assert len(stamps) == 1
    assert len(str(stamps.pop())) == 64  # SHA-256
