"""Does compiled code on disk always belong to the source that runs?"""

import importlib
import pkgutil
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path

import filelock
import pytest
from numba.core.dispatcher import Dispatcher

import lumped.compiler

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


Run = Callable[[], tuple[float, int]]


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Two files of which one calls the other's kernel, and a cache folder of their own."""
    monkeypatch.setattr(sys, "dont_write_bytecode", True)  # it knows an edit by the second and the size
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))
    lumped.compiler._warn_once.cache_clear()
    monkeypatch.syspath_prepend(tmp_path)
    folder = tmp_path / "pkg"
    folder.mkdir()
    for name, text in (("__init__", ""), ("jit", JIT), ("called", CALLED), ("caller", CALLER)):
        (folder / f"{name}.py").write_text(text, encoding="utf-8")
    return folder


@pytest.fixture
def run(package: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    def run() -> tuple[float, int]:
        """Value, and the number of functions taken from the disk."""
        for name in [name for name in sys.modules if name.partition(".")[0] == "pkg"]:
            monkeypatch.delitem(sys.modules, name)
        f = importlib.import_module("pkg.caller").f
        return f(1.0), sum(f.stats.cache_hits.values())

    return run


def test_edits_of_called_files_are_noticed(package: Path, run: Run) -> None:
    assert run() == (2.0, 0)
    assert run() == (2.0, 1)
    (package / "called.py").write_text(CALLED.replace("2.0", "3.0"), encoding="utf-8")
    assert run() == (3.0, 0)
    (package / "called.py").write_text(CALLED, encoding="utf-8")
    assert run() == (2.0, 1)  # both states of the source have their own files


#: Ends the process at the moment at which the kernel that was compiled last would get its name.
KILLED = """
import os, sys
sys.dont_write_bytecode = True
os.replace = lambda *_: os._exit(9)
import pkg.caller
pkg.caller.f(1.0)
"""


def test_a_process_killed_while_it_writes_leaves_no_old_code(package: Path, run: Run, tmp_path: Path) -> None:
    assert run() == (2.0, 0)
    (package / "called.py").write_text(CALLED.replace("2.0", "3.0"), encoding="utf-8")
    root = Path(lumped.compiler.__file__).parents[1]
    killed = f"import sys; sys.path[:0] = [{str(tmp_path)!r}, {str(root)!r}]\n" + KILLED
    assert subprocess.run([sys.executable, "-c", killed], check=False).returncode == 9
    assert run() == (3.0, 0)
    assert run() == (3.0, 1)


def test_a_kernel_that_another_process_compiles_is_waited_for(run: Run, tmp_path: Path) -> None:
    run()
    stored = {path: path.read_bytes() for path in (tmp_path / "cache").rglob("*.kernel")}
    locks = [filelock.FileLock(path.with_suffix(".lock"), thread_local=False) for path in stored]
    for path, lock in zip(stored, locks, strict=True):
        path.unlink()
        lock.acquire()

    def finish() -> None:
        for (path, content), lock in zip(stored.items(), locks, strict=True):
            path.write_bytes(content)
            lock.release()

    threading.Timer(0.3, finish).start()
    assert run() == (2.0, 1)


def test_a_damaged_file_is_compiled_again(run: Run, tmp_path: Path) -> None:
    assert run() == (2.0, 0)
    for file in (tmp_path / "cache").rglob("*.kernel"):
        content = bytearray(file.read_bytes())
        content[-100] ^= 1
        file.write_bytes(content)
    assert run() == (2.0, 0)


@pytest.mark.parametrize("home", [True, False])
def test_without_a_place_to_write_it_says_so_once_and_goes_on(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, home: bool
) -> None:
    if home:
        (tmp_path / "cache").write_text("a file where the folder should be", encoding="utf-8")
    else:  # what platformdirs answers a user without one
        monkeypatch.delenv("NUMBA_CACHE_DIR")
        monkeypatch.setattr("lumped.cache.user_cache_path", lambda *_, **__: Path("~", ".cache"))
    with pytest.warns(UserWarning, match="Set NUMBA_CACHE_DIR") as warned:
        assert run() == (2.0, 0)
    assert len(warned) == 1


def test_old_folders_are_removed(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lumped.compiler, "_MOST_FOLDERS", 2)
    for name in ("a", "b", "c"):
        (tmp_path / "cache" / "spurcheck" / name).mkdir(parents=True)
    run()
    assert len(list((tmp_path / "cache" / "spurcheck").iterdir())) == 2
    assert run() == (2.0, 1)  # the newest is one of them


@pytest.mark.parametrize("package", ["floquet.rank_one.kernels", "multibody.contact"])
def test_all_kernels_that_call_each_other_across_files_have_one_stamp(package: str) -> None:
    folder = importlib.import_module(package).__path__
    modules = [importlib.import_module(f"{package}.{module.name}") for module in pkgutil.iter_modules(folder)]
    functions = {f for module in modules for f in vars(module).values() if isinstance(f, Dispatcher)}
    own = {f for f in functions if f.py_func.__module__.startswith(package)}
    assert len(own) > 10
    assert len({f._cache._stamp for f in own}) == 1
