"""numba with a typed decorator, and compiled kernels on disk that belong to one state of the source.

numba's own cache looks only at the file a function is in and writes its index before the code: after an edit,
a second process or a kill at that moment can leave old code under the new index for good. Here each kernel is
one file, named after everything its code depends on, see ``lumped.cache``. Of processes side
by side one compiles a kernel and the others wait for its file.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import pickle
import shutil
import sys
import warnings
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

import filelock
import numba
from numba.core.caching import FunctionCache
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps

from lumped.cache import cache_folder, cores, read_whole, write_whole

F = TypeVar("F", bound=Callable[..., Any])
Part = TypeVar("Part")
Result = TypeVar("Result")

#: Folders of kernels that stay: one for each set of source files and each of its latest states.
_MOST_FOLDERS = 40
#: Longest wait for a kernel that another process compiles [s]; the largest one takes a tenth of it.
_LONGEST_WAIT = 120.0


class Compiler:
    """Compiles functions that call each other across files.

    Parameters
    ----------
    files : all files with such functions; an edit of one makes all compile anew
    """

    def __init__(self, files: Iterable[Path]) -> None:
        source = b"".join(path.read_bytes() for path in sorted(files))
        version = f"{numba.__version__} {sys.version}".encode()
        self.stamp = hashlib.sha256(version + source).hexdigest()

    def __call__(self, function: F, **options: Any) -> F:
        """Compile with numba, stored on disk, IEEE arithmetic unless options say otherwise.

        Without the wrapper for callers in C: there are none, and it takes a tenth of the time.
        """
        dispatcher = numba.njit(error_model="numpy", no_cfunc_wrapper=True, **options)(function)
        if not numba.config.DISABLE_JIT:
            dispatcher._cache = _KernelFiles(function, self.stamp)
        return cast(F, dispatcher)

    def stored(self, name: str) -> bool:
        """Whether there is a file with compiled code of the function of that name."""
        return any((kernel_folder() / self.stamp[:24]).glob(f"{name}-*.kernel"))


def kernel_folder() -> Path:
    """Folder of all compiled kernels: in ``NUMBA_CACHE_DIR`` if set, else in the user's cache folder."""
    chosen = os.environ.get("NUMBA_CACHE_DIR")
    return Path(chosen, "spurcheck") if chosen else cache_folder() / "kernels"


def in_threads(run: Callable[[Part], Result], parts: Sequence[Part]) -> list[Result]:
    """Results of ``run`` on parts, a thread a core, for kernels that release the interpreter lock."""
    count = min(cores(), len(parts))
    if count <= 1:
        return [run(part) for part in parts]
    with ThreadPoolExecutor(count) as pool:
        return list(pool.map(run, parts))


class _KernelFiles(FunctionCache):  # type: ignore[misc]  # numba ships no types
    """Compiled code of one function, under numba's key of signature, processor and bytecode."""

    def __init__(self, function: Callable[..., Any], stamp: str) -> None:
        self._py_func = function
        self._stamp = stamp
        self._held: dict[Path, filelock.BaseFileLock] = {}
        self.enable()

    @property
    def cache_path(self) -> str:
        return str(kernel_folder() / self._stamp[:24])

    def _path(self, sig: Any, codegen: Any) -> Path:
        function = self._py_func
        key = repr((self._stamp, function.__module__, function.__qualname__, self._index_key(sig, codegen)))
        digest = hashlib.sha256(key.encode()).hexdigest()
        return Path(self.cache_path, f"{function.__name__}-{digest[:32]}.kernel")

    def _load_overload(self, sig: Any, target_context: Any) -> Any:
        path = self._path(sig, target_context.codegen())
        content = read_whole(path)
        if content is None and self._hold(path):
            content = read_whole(path)  # another process may have stored it while this one waited
            if content is not None:
                self._release(path)
        return None if content is None else CompileResult._rebuild(target_context, *pickle.loads(content))

    def _save_overload(self, sig: Any, data: Any) -> None:
        path = self._path(sig, data.codegen)
        try:
            if self._enabled and not data.library.has_dynamic_globals:  # addresses of this process
                write_whole(path, dumps(data._reduce()))
        except OSError as error:
            _warn_once(f"{kernel_folder()}: {error.strerror}")
        finally:
            self._release(path)

    def _hold(self, path: Path) -> bool:
        """Wait until no other process compiles this kernel, and keep the others waiting; False: no place."""
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
        for path in Path(self.cache_path).glob(f"{self._py_func.__name__}-*.kernel"):
            path.unlink(missing_ok=True)


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
