"""numba with a typed decorator, and compiled kernels on disk that belong to one state of the source.

numba's own cache looks only at the file a function is in and writes its index before the code: after an edit,
a second process or a kill at that moment can leave old code under the new index for good. Here each kernel is
one file, named after everything its code depends on, see ``lumped.kernel_stamps`` and ``lumped.cache``. Of
processes side by side one compiles a kernel and the others wait for its file.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import pickle
import shutil
import warnings
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache, partial
from pathlib import Path
from typing import Any, TypeVar, overload

import filelock
import numba
from numba.core.caching import FunctionCache
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps

from lumped.cache import cache_folder, cores, read_whole, write_whole
from lumped.compiler_flags import share_library_functions
from lumped.kernel_stamps import (
    UnknownDependencyError,
    compiled_behind,
    described,
    own_state_of,
    stamp_of,
)
from lumped.linked_code import (
    LINKING_IS_KNOWN,
    LinkedCompiler,
    OptimisingCompiler,
    ShortLoopCompiler,
    forms_of,
    link_into_callers,
    refuse_calls_from_python,
)
from lumped.quick_compilation import compile_quickly

F = TypeVar("F", bound=Callable[..., Any])
Part = TypeVar("Part")
Result = TypeVar("Result")

#: Folders of kernels that stay: one for each function in each of its latest states, some 200 in a state.
_MOST_FOLDERS = 4000
#: Longest wait for a kernel that another process compiles [s]; the largest one takes a tenth of it.
_LONGEST_WAIT = 120.0


@overload
def compiled(function: F, /) -> F: ...
@overload
def compiled(**options: Any) -> Callable[[F], F]: ...
def compiled(function: Any = None, /, **options: Any) -> Any:
    """Compile the function below with numba, stored on disk, IEEE arithmetic unless options say otherwise.

    Without the wrapper for callers in C: there are none, and it takes a tenth of the time. In compiled
    callers the function is a part of their code, see ``lumped.linked_code``; code of its own is compiled when
    Python calls it. A function may not call itself, directly or through others.
    ``no_cpython_wrapper=True`` is for functions that compiled functions alone call.
    ``optimised_first=True`` is for those of
    them that do most of the work of an inner loop, and have many functions below: the callers become faster,
    and compiling takes longer. ``long_loops=True`` is for functions with an inner loop of many iterations:
    LLVM writes their loops in vector instructions too, and compiling takes longer.
    """
    if function is None:
        return partial(_compiled, **options)
    return _compiled(function, **options)


def _compiled(
    function: Callable[..., Any],
    /,
    *,
    optimised_first: bool = False,
    long_loops: bool = False,
    **options: Any,
) -> Any:
    linked = options.get("no_cpython_wrapper", False) and LINKING_IS_KNOWN
    part = None
    if LINKING_IS_KNOWN and not linked and not long_loops:
        part = _compiled(function, **(options | {"no_cpython_wrapper": True}))
    if linked:
        options["pipeline_class"] = OptimisingCompiler if optimised_first else LinkedCompiler
    elif LINKING_IS_KNOWN and not long_loops:
        options["pipeline_class"] = ShortLoopCompiler
    dispatcher = numba.njit(error_model="numpy", no_cfunc_wrapper=True, **options)(function)
    if not numba.config.DISABLE_JIT:
        share_library_functions(dispatcher)
        compile_quickly(dispatcher)
        dispatcher._cache = _NoFiles(dispatcher) if linked else _KernelFiles(dispatcher)
        if linked:
            refuse_calls_from_python(dispatcher)
        if part is not None:
            link_into_callers(dispatcher, part)
    return dispatcher


#: Of functions that compiled functions alone call, and that allocate nothing: counting references to arrays
#: would take half of the time of a call.
called = compiled(_nrt=False, no_cpython_wrapper=True)
#: The same for functions of a few lines, whose calls would take longer than their work.
inlined = compiled(_nrt=False, no_cpython_wrapper=True, forceinline=True)
#: The same for a function that does most of the work of an inner loop.
inlined_optimised = compiled(_nrt=False, no_cpython_wrapper=True, forceinline=True, optimised_first=True)


def is_stored(function: Callable[..., Any]) -> bool:
    """Whether a file has the code of this compiled function in its present state."""
    return any(Path(function._cache.cache_path).glob("*.kernel"))  # type: ignore[attr-defined]


def kernel_folder() -> Path:
    """Folder of all compiled kernels: in ``NUMBA_CACHE_DIR`` if set, else in the user's cache folder."""
    chosen = os.environ.get("NUMBA_CACHE_DIR")
    return Path(chosen, "spurcheck") if chosen else cache_folder() / "kernels"


def in_threads(run: Callable[[Part], Result], parts: Sequence[Part]) -> list[Result]:
    """Return the results of ``run`` on all parts.

    Threads run in parallel: kernels release the interpreter lock.
    """
    count = min(cores(), len(parts))
    if count <= 1:
        return [run(part) for part in parts]
    with ThreadPoolExecutor(count) as pool:
        return list(pool.map(run, parts))


class _KernelFiles(FunctionCache):  # type: ignore[misc]  # numba ships no types
    """Stored code of one compiled function: one file for each stamp, types of arguments and processor."""

    def __init__(self, dispatcher: Any) -> None:
        self._dispatcher = dispatcher
        self._py_func = dispatcher.py_func
        self._first_state: Any = None
        self._compiling: dict[Any, Path] = {}
        self._held: dict[Path, filelock.BaseFileLock] = {}
        self.enable()

    @property
    def cache_path(self) -> str:
        try:
            return str(kernel_folder() / stamp_of(self._dispatcher)[:24])
        except UnknownDependencyError:
            return str(kernel_folder())

    def _path(self, sig: Any, codegen: Any) -> Path:
        function = self._py_func
        stamp = stamp_of(self._dispatcher)
        self._first_state = self._first_state or stamp
        key = repr((stamp, described(sig), codegen.magic_tuple()))
        digest = hashlib.sha256(key.encode()).hexdigest()
        return kernel_folder() / stamp[:24] / f"{function.__name__}-{digest[:32]}.kernel"

    def _load_overload(self, sig: Any, target_context: Any) -> Any:
        try:
            path = self._path(sig, target_context.codegen())
        except UnknownDependencyError:
            return None
        content = read_whole(path)
        if content is None:
            self._compiling[sig] = path  # numba freezes what is named now, not what is when it has compiled
            if self._hold(path):
                content = read_whole(path)  # another process may have stored it while this one waited
                if content is not None:
                    self._release(path)
        return None if content is None else CompileResult._rebuild(target_context, *pickle.loads(content))

    def _save_overload(self, sig: Any, data: Any) -> None:
        path = self._compiling.pop(sig, None)
        if path is None:
            return
        try:
            has_addresses = data.library.has_dynamic_globals  # of this process
            if self._enabled and not has_addresses and not self._calls_older_code():
                write_whole(path, dumps(data._reduce()))
        except OSError as error:
            _warn_once(f"{kernel_folder()}: {error.strerror}")
        finally:
            self._release(path)

    def _calls_older_code(self) -> bool:
        """Whether a called function was compiled before one of its globals changed in this process.

        A module that is loaded again changes the globals of functions that other modules still call.
        """
        behind = compiled_behind(self._dispatcher)
        caches = [form._cache for one in behind for form in forms_of(one)]
        files = [one for one in caches if isinstance(one, _KernelFiles)]
        return any(one._first_state not in (None, one._state()) for one in files)

    def _state(self) -> Any:
        """State of all source behind the function: code from the disk has functions in it that this process
        has not compiled.
        """
        return stamp_of(self._dispatcher)

    def _hold(self, path: Path) -> bool:
        """Lock a kernel file: wait until no other process compiles the kernel, and make other processes wait.

        Returns False where the file cannot be written, or where this process has the lock already because the
        kernel calls itself through another kernel.
        """
        if path in self._held:
            return False
        try:
            if not path.parent.exists():
                path.parent.mkdir(parents=True, exist_ok=True)
                _remove_old(path.parent.parent)
            lock = filelock.FileLock(path.with_suffix(".lock"), timeout=_LONGEST_WAIT)
            lock.acquire()
        except (OSError, filelock.Timeout):
            return False
        self._held[path] = lock
        return True

    def _release(self, path: Path) -> None:
        if (lock := self._held.pop(path, None)) is not None:
            with contextlib.suppress(OSError):
                lock.release()

    def flush(self) -> None:
        """Remove the files of this function."""
        for path in Path(self.cache_path).glob("*.kernel"):
            path.unlink(missing_ok=True)


class _NoFiles(_KernelFiles):
    """Of a function that is stored as a part of its callers: notes which state of the source is compiled."""

    def load_overload(self, sig: Any, target_context: Any) -> None:
        """Nothing is loaded, so numba has no registers to read again before."""
        with contextlib.suppress(UnknownDependencyError):
            self._first_state = self._first_state or self._state()

    def _state(self) -> Any:
        """State of this function alone: those that it calls have theirs.

        If every function looked at all below it, the work would grow with the square of their number.
        """
        return own_state_of(self._dispatcher)

    def _save_overload(self, sig: Any, data: Any) -> None:
        """Nothing: the callers are stored."""


def _remove_old(folder: Path) -> None:
    """Remove the folders that have gone longest without a new kernel."""
    folders = sorted(
        (p for p in folder.iterdir() if p.is_dir()), key=lambda p: p.stat().st_mtime, reverse=True
    )
    for old in folders[_MOST_FOLDERS:]:
        shutil.rmtree(old, ignore_errors=True)


@cache
def _warn_once(reason: str) -> None:
    warnings.warn(
        f"Compiled code cannot be stored ({reason}), so every run compiles for about a minute. "
        "Set NUMBA_CACHE_DIR to a folder that you can write.",
        stacklevel=2,
    )
