"""Does compiled code on disk always belong to the source that runs?"""

import cProfile
import importlib
import math
import pkgutil
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import filelock
import numpy as np
import pytest
from numba.core import errors, event
from numba.core.compiler import Flags
from numba.core.dispatcher import Dispatcher

import lumped.compiler
from lumped import kernel_stamps
from lumped.compiler import compiled
from lumped.compiler_flags import SharingFlags
from lumped.typing import FloatArray

CALLED = """
from lumped.compiler import compiled

@compiled
def double(x):
    return 2.0 * x

@compiled
def half(x):
    return 0.5 * x
"""
CALLER = """
from lumped.compiler import compiled
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
    for name, text in (("__init__", ""), ("called", CALLED), ("caller", CALLER)):
        (folder / f"{name}.py").write_text(text, encoding="utf-8")
    return folder


@pytest.fixture
def run(package: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    def run() -> tuple[float, int]:
        """Value, and the number of functions taken from the disk."""
        for name in [name for name in sys.modules if name.partition(".")[0] == "pkg"]:
            monkeypatch.delitem(sys.modules, name)
        caller = importlib.import_module("pkg.caller")
        value = caller.f(1.0)
        return value, sum(getattr(caller, "kernel", caller.f).stats.cache_hits.values())

    return run


def test_edits_of_called_files_are_noticed(package: Path, run: Run) -> None:
    assert run() == (2.0, 0)
    assert run() == (2.0, 1)
    (package / "called.py").write_text(CALLED.replace("2.0", "3.0"), encoding="utf-8")
    assert run() == (3.0, 0)
    (package / "called.py").write_text(CALLED, encoding="utf-8")
    assert run() == (2.0, 1)  # both states of the source have their own files


def test_an_edit_that_does_not_act_leaves_the_stored_code(package: Path, run: Run) -> None:
    assert run() == (2.0, 0)
    (package / "called.py").write_text("# moved down\n\n" + CALLED.replace("0.5", "0.3"), encoding="utf-8")
    assert run() == (2.0, 1)


#: Files that make f(1.0) = 2.0, and an edit of the second one that makes it 3.0.
DEPENDENCIES = {
    "operation of a called function": (
        "from pkg.called import add\n@compiled\ndef f(x):\n    return add(x)",
        "@compiled\ndef add(x):\n    return 2.0 * x",
        ("*", "+"),
    ),
    "number of another file": (
        "from pkg.called import FACTOR\n@compiled\ndef f(x):\n    return FACTOR * x",
        "FACTOR = 2.0",
        ("2.0", "3.0"),
    ),
    "number that another file computes": (
        "from pkg import called\n@compiled\ndef f(x):\n    return called.FACTOR * x",
        "def _sum(a, b):\n    return a + b\nFACTOR = _sum(1.0, 1.0)",
        ("(1.0,", "(2.0,"),
    ),
    "array": (
        "from pkg.called import TABLE\n@compiled\ndef f(x):\n    return TABLE[1, 0] * x",
        "import numpy as np\nTABLE = np.array([[1.0, 3.0], [2.0, 4.0]])",
        ("]])", "]]).T.copy()"),
    ),
    "members of an enum": (
        "from pkg.called import Gear\n@compiled\ndef f(x):\n    return Gear.WHEEL.value * x",
        "from enum import Enum\nclass Gear(Enum):\n    PINION, WHEEL = 3.0, 2.0",
        ("3.0, 2.0", "2.0, 3.0"),
    ),
    "default of a called function": (
        "from pkg.called import times\n@compiled\ndef f(x):\n    return times(x)",
        "@compiled\ndef times(x, by=2.0):\n    return by * x",
        ("2.0", "3.0"),
    ),
    "closure of a called function": (
        "from pkg.called import times\n@compiled\ndef f(x):\n    return times(x)",
        "def by(n):\n    @compiled\n    def f(x):\n        return n * x\n    return f\ntimes = by(2.0)",
        ("2.0", "3.0"),
    ),
    "function inside a called function": (
        "from pkg.called import times\n@compiled\ndef f(x):\n    return times(x)",
        "@compiled\ndef times(x):\n    def inner(x):\n        return 2.0 * x\n    return inner(x)",
        ("2.0", "3.0"),
    ),
    "fields of a record that is made": (
        "from pkg.called import Record\n@compiled\ndef f(x):\n    return Record(3.0, 2.0).second * x",
        "from typing import NamedTuple\nclass Record(NamedTuple):\n    first: float\n    second: float",
        ("first: float\n    second", "second: float\n    first"),
    ),
    "fields of a record in an argument": (
        "from pkg.called import Record\n@compiled\ndef kernel(pair, x):\n    return pair[0].second * x\n"
        "def f(x):\n    return kernel((Record(3.0, 2.0), 0), x)",
        "from typing import NamedTuple\nclass Record(NamedTuple):\n    first: float\n    second: float",
        ("first: float\n    second", "second: float\n    first"),
    ),
    "dtype": (
        "import numpy as np\nfrom pkg.called import KIND\n@compiled\ndef f(x):\n"
        "    rows = np.zeros(1, KIND)\n    rows[0].n = 2.5\n    return 2.0 * rows[0].n - 2.0 * x",
        "import numpy as np\nKIND = np.dtype([('n', 'i8')])",
        ("i8", "f8"),
    ),
}


def _write(package: Path, **files: str) -> None:
    for name, text in files.items():
        text = f"from lumped.compiler import compiled\n{text}\n"
        (package / f"{name}.py").write_text(text, encoding="utf-8")


@pytest.mark.parametrize("name", DEPENDENCIES)
def test_every_kind_of_dependency_is_noticed(name: str, package: Path, run: Run) -> None:
    caller, called, edit = DEPENDENCIES[name]
    assert called.count(edit[0]) == 1
    _write(package, caller=caller, called=called)
    assert [run(), run()] == [(2.0, 0), (2.0, 1)]
    _write(package, called=called.replace(*edit))
    assert [run(), run()] == [(3.0, 0), (3.0, 1)]


def test_an_edit_at_the_end_of_a_chain_of_files_is_noticed(package: Path, run: Run) -> None:
    last = "@compiled\ndef last(x):\n    return 2.0 * x"
    _write(
        package,
        caller="from pkg.called import middle\n@compiled\ndef f(x):\n    return middle(x)",
        called="from pkg.last import last\n@compiled\ndef middle(x):\n    return last(x)",
        last=last,
    )
    assert [run(), run()] == [(2.0, 0), (2.0, 1)]
    _write(package, last=last.replace("2.0", "3.0"))
    assert [run(), run()] == [(3.0, 0), (3.0, 1)]


#: Globals that count with files: of which ``called`` is one, and imports ``last``.
BY_FILES = {
    "intrinsic": """
from numba.extending import intrinsic
from pkg.last import FACTOR

@intrinsic
def times(typing, x):
    def code(context, builder, signature, args):
        return builder.fmul(args[0], context.get_constant(x, FACTOR))

    return x(x), code
""",
    "object of another kind": """
from numba import types
from . import last

kind = (types.int8, types.int16)[last.FACTOR > 2.5]
""",
}


@pytest.fixture(params=BY_FILES)
def by_files(request: pytest.FixtureRequest, package: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    name, result = (
        ("times", "times(x)") if request.param == "intrinsic" else ("kind", "1.0 + x + (kind(257) == 257)")
    )
    _write(package, called=BY_FILES[request.param], last="FACTOR = 2.0")
    _write(package, caller=f"from pkg.called import {name}\n@compiled\ndef f(x):\n    return {result}")
    kernel_stamps._text_behind.cache_clear()  # as a new process has it
    return package


def test_files_behind_a_global_that_cannot_be_taken_apart_are_noticed(
    by_files: Path, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(kernel_stamps, "_IMPORTED", math.inf)  # files are older than the process
    assert [run(), run()] == [(2.0, 0), (2.0, 1)]
    _write(by_files, last="FACTOR = 3.0")
    kernel_stamps._text_behind.cache_clear()
    assert [run(), run()] == [(3.0, 0), (3.0, 1)]


def test_code_of_a_file_that_was_written_after_its_import_is_not_stored(
    by_files: Path, run: Run, tmp_path: Path
) -> None:
    assert [run(), run()] == [(2.0, 0), (2.0, 0)]
    assert not list((tmp_path / "cache").rglob("*.kernel"))


LINKED = CALLED.replace("@compiled\n", "@compiled(no_cpython_wrapper=True)\n")


def test_edits_of_linked_code_are_noticed_and_it_is_stored_in_its_callers(
    package: Path, run: Run, tmp_path: Path
) -> None:
    _write(package, called=LINKED)
    assert [run(), run()] == [(2.0, 0), (2.0, 1)]
    assert [path.name[:2] for path in (tmp_path / "cache").rglob("*.kernel")] == ["f-"]
    _write(package, called=LINKED.replace("2.0", "3.0"))
    assert [run(), run()] == [(3.0, 0), (3.0, 1)]


@pytest.mark.parametrize(
    "called",
    [
        "@compiled\ndef double(x):\n    return x if x < 1.0 else double(0.5 * x)",
        "@compiled\ndef other(x):\n    return double(x)\n@compiled\ndef double(x):\n    return other(x)",
    ],
    ids=["itself", "each other"],
)
def test_functions_that_call_themselves_are_refused(called: str, package: Path, run: Run) -> None:
    _write(package, called=called)
    with pytest.raises(errors.TypingError, match="double calls itself"):
        run()


def test_code_for_callers_in_python_is_compiled_when_python_calls(
    package: Path, run: Run, tmp_path: Path
) -> None:
    _write(package, called=CALLED)
    assert run() == (2.0, 0)
    assert [path.name[:2] for path in (tmp_path / "cache").rglob("*.kernel")] == ["f-"]
    function = sys.modules["pkg.called"].double
    assert not function.signatures
    assert function(1.0) == 2.0
    assert list((tmp_path / "cache").rglob("double-*.kernel"))


@pytest.mark.parametrize("decorator", ["@compiled", "@compiled(no_cpython_wrapper=True)"])
def test_code_that_calls_older_code_is_not_stored(
    decorator: str, package: Path, run: Run, tmp_path: Path
) -> None:
    """A module is loaded again after an edit; another one holds its function, compiled before the edit."""
    called = f"FACTOR = 2.0\n{decorator}\ndef times(x):\n    return FACTOR * x"
    late = "@compiled\ndef late(x):\n    return times(x)"
    first = "@compiled\ndef f(x):\n    return times(x)"
    _write(package, called=called, caller=f"from pkg.called import times\n{first}\n{late}")
    assert run() == (2.0, 0)
    _write(package, called=called.replace("2.0", "3.0"))
    importlib.reload(sys.modules["pkg.called"])
    assert sys.modules["pkg.caller"].late(1.0) == 2.0
    assert not list((tmp_path / "cache").rglob("late-*.kernel"))


def test_older_linked_code_is_found_behind_linked_code(package: Path, run: Run, tmp_path: Path) -> None:
    """A kernel calls a function that is up to date, and in which an older function is linked."""
    called = "FACTOR = 2.0\n@compiled(no_cpython_wrapper=True)\ndef times(x):\n    return FACTOR * x"
    middle = "@compiled(no_cpython_wrapper=True)\ndef middle(x):\n    return times(x)"
    first, late = (f"@compiled\ndef {name}(x):\n    return middle(x)" for name in ("f", "late"))
    _write(package, called=called, caller=f"from pkg.called import times\n{middle}\n{first}\n{late}")
    assert run() == (2.0, 0)
    _write(package, called=called.replace("2.0", "3.0"))
    importlib.reload(sys.modules["pkg.called"])
    assert sys.modules["pkg.caller"].late(1.0) == 2.0
    assert not list((tmp_path / "cache").rglob("late-*.kernel"))


def test_each_linked_function_is_looked_at_without_those_behind_it(
    package: Path, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A chain of 20 functions: were each looked at with all below it, the work would grow as 20 * 20 / 2."""
    length = 20
    chain = ["@compiled(no_cpython_wrapper=True)\ndef link_0(x):\n    return 2.0 * x"]
    for n in range(1, length):
        body = f"return link_{n - 1}(x)"
        chain.append(f"@compiled(no_cpython_wrapper=True)\ndef link_{n}(x):\n    {body}")
    _write(package, caller="\n".join([*chain, f"@compiled\ndef f(x):\n    return link_{length - 1}(x)"]))
    looked: list[str] = []
    plain = kernel_stamps._Dependencies._of_code

    def counted(self: Any, code: Any, function: Any) -> Any:
        looked.append(code.co_name)
        return plain(self, code, function)

    monkeypatch.setattr(kernel_stamps._Dependencies, "_of_code", counted)
    assert run() == (2.0, 0)
    assert looked.count("link_0") <= 6  # by the kernel and for its file name, and twice for itself
    assert len(looked) <= 6 * (length + 1)


def test_linked_code_works_in_a_process_that_finds_its_caller_on_the_disk(package: Path, run: Run) -> None:
    """The caller raises: for this its code looks for Python objects, one for each function."""
    check = "def checked(x):\n    if x > 2.0:\n        raise ValueError(x)\n    return x"
    caller = "from pkg.called import checked\n@compiled\ndef f(x):\n    return checked(x)"
    _write(package, called=f"@compiled(no_cpython_wrapper=True)\n{check}", caller=caller)
    assert [run(), run()] == [(1.0, 0), (1.0, 1)]
    with pytest.raises(ValueError, match="3"):
        sys.modules["pkg.caller"].f(3.0)


def test_python_cannot_call_linked_code(package: Path, run: Run) -> None:
    _write(package, called=LINKED)
    run()  # which calls double, not half
    for name in ("double", "half"):
        with pytest.raises(TypeError, match=f"{name} is compiled as a part of its callers alone"):
            getattr(sys.modules["pkg.called"], name)(1.0)


def test_options_are_noticed() -> None:
    def double(x: float) -> float:
        return 2.0 * x

    options: list[dict[str, Any]] = [{}, {"nogil": True}, {"fastmath": {"contract"}}, {"fastmath": {"nnan"}}]
    options.append({"long_loops": True})
    kernels = [compiled(**chosen)(double) for chosen in options]
    assert len({kernel_stamps.stamp_of(kernel) for kernel in kernels}) == len(options)


def test_a_profiler_leaves_the_stamp() -> None:
    @compiled
    def double(x: float) -> float:
        return 2.0 * x

    before = kernel_stamps.stamp_of(double)
    assert cProfile.Profile().runcall(double, 1.0) == 2.0
    assert kernel_stamps.stamp_of(double) == before


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
    run()  # two kernels, each with a folder
    assert len(list((tmp_path / "cache" / "spurcheck").iterdir())) == 2
    assert run() == (2.0, 1)  # the newest is one of them


def test_of_the_globals_in_compiled_functions_intrinsics_alone_count_with_files(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """So an edit compiles what it acts on, and nothing else."""
    by_files: list[object] = []
    monkeypatch.setattr(kernel_stamps._Dependencies, "_of_files", lambda _, value, __: by_files.append(value))
    modules = [
        importlib.import_module(module.name)
        for package in ("lumped", "multibody", "floquet")
        for module in pkgutil.walk_packages(importlib.import_module(package).__path__, f"{package}.")
    ]
    functions = {f for module in modules for f in vars(module).values() if isinstance(f, Dispatcher)}
    stamps = {kernel_stamps.stamp_of(function) for function in functions}
    assert len(stamps) == len(functions) > 100
    assert by_files
    assert {type(value).__name__ for value in by_files} == {"_Intrinsic"}


@pytest.fixture
def empty_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A cache folder without kernels: of a stored kernel there is no intermediate code, and no event."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))


def _scaled(values: FloatArray, factor: float) -> None:
    for i in range(values.size):
        values[i] = 0.1 + factor * values[i]


def test_only_long_loops_are_copied_into_vector_instructions(empty_cache: None) -> None:
    """LLVM calls the copy of a loop in vector instructions vector.body. The results are the same bits."""
    results = []
    for long_loops in (False, True):
        kernel: Any = compiled(long_loops=long_loops)(_scaled)
        values = np.linspace(0.0, 1.0, 37)
        kernel(values, 1.0 / 3.0)
        code = kernel.inspect_llvm(kernel.signatures[0])
        assert ("vector.body" in code) is long_loops
        results.append(values)
    assert np.array_equal(results[0], results[1])


def test_a_function_of_numba_is_compiled_once_for_callers_of_all_kinds(empty_cache: None) -> None:
    def larger(x: float, y: float) -> float:
        return max(x, y)

    names: list[str] = []

    class Names(event.Listener):  # type: ignore[misc]  # numba ships no types
        def on_start(self, one: Any) -> None:
            names.append(one.data["dispatcher"].py_func.__qualname__)

        def on_end(self, one: Any) -> None:
            """Nothing."""

    with event.install_listener("numba:compile", Names()):
        for options in ({"nogil": True}, {}, {"nogil": True, "boundscheck": False}):
            assert compiled(**options)(larger)(1.5, 2.5) == 2.5
    assert names.count("ol_max.<locals>.impl") <= 1  # another test may have compiled it
    assert names.count(larger.__qualname__) == 3


def test_flags_that_numba_hands_on_part_functions() -> None:
    plain = SharingFlags()
    for name, value in (("nrt", True), ("fastmath", True), ("error_model", "numpy"), ("forceinline", True)):
        changed = SharingFlags()
        setattr(changed, name, value)
        assert changed != plain, name
    alone = SharingFlags()
    alone.release_gil = True
    assert alone == plain
    assert hash(alone) == hash(plain) == hash(Flags())
