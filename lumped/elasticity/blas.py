"""BLAS on one thread, for many products of small matrices: more threads only wait for each other.

SuperLU solves by thousands of such products. On two threads a gear takes three times as long as on one, and
thirty times where another program has one of the two processors.
"""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import scipy

#: The number of threads belongs to the process: one change at a time.
_LOCK = threading.RLock()
#: Functions of OpenBLAS as the wheels name them, by their verb.
_NAMES = tuple(
    f"{vendor}openblas_{{}}_num_threads{size}" for vendor in ("scipy_", "") for size in ("", "64_")
)


class _Threads(NamedTuple):
    """Functions of a library that read and set how many threads it uses."""

    get: ctypes._NamedFuncPointer
    set: ctypes._NamedFuncPointer


@contextmanager
def one_thread() -> Iterator[None]:
    """Let the OpenBLAS of numpy and scipy use one thread; another library's BLAS stays as it is."""
    with _LOCK:
        before = [(library, library.get()) for library in libraries()]
        try:
            for library, _ in before:
                library.set(1)
            yield
        finally:
            for library, count in before:
                library.set(count)


@cache
def libraries() -> tuple[_Threads, ...]:
    """Return every OpenBLAS library in the wheels of numpy and scipy; both packages have loaded them."""
    result = []
    for package in (np, scipy):
        (root,) = map(Path, package.__path__)
        places = (root.with_name(f"{root.name}.libs"), root / ".dylibs")
        for path in sorted(path for place in places for path in place.glob("*openblas*")):
            library = ctypes.CDLL(str(path))
            for name in _NAMES:
                get, set_ = (getattr(library, name.format(verb), None) for verb in ("get", "set"))
                if get is not None and set_ is not None:
                    result.append(_Threads(get, set_))
    return tuple(result)
