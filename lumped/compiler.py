"""numba with a typed decorator, and a disk cache that notices every edit.

numba's cache looks only at the file a function is in. A function that calls another file's would keep the old
code of that one after an edit or an upgrade of the package, and give wrong numbers without a word.
"""

from __future__ import annotations

import contextlib
import hashlib
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba

F = TypeVar("F", bound=Callable[..., Any])


class Compiler:
    """Compiles functions that call each other across files.

    Parameters
    ----------
    files : all files with such functions; an edit of one makes all compile anew
    """

    def __init__(self, files: Iterable[Path]) -> None:
        self.stamp = hashlib.sha256(b"".join(path.read_bytes() for path in sorted(files))).hexdigest()

    def __call__(self, function: F, **options: Any) -> F:
        """Compile with numba, cached on disk, IEEE arithmetic unless options say otherwise.

        Without the wrapper for callers in C: there are none, and it takes a tenth of the time.
        """
        dispatcher = numba.njit(cache=True, error_model="numpy", no_cfunc_wrapper=True, **options)(function)
        with contextlib.suppress(AttributeError):  # no cache when the compiler is switched off
            index = dispatcher._cache._cache_file
            index._source_stamp = (index._source_stamp, self.stamp)
        return cast(F, dispatcher)
