"""One typed name for the compiler decorator, and a disk cache that notices every edit.

numba's cache looks only at the file a function is in. A function that calls another file's would keep the old
code of that one after an edit, and a test of the edit would pass or fail for no reason.
"""

from __future__ import annotations

import contextlib
import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba

F = TypeVar("F", bound=Callable[..., Any])


def _sources() -> str:
    """Hash of all files of this package that have compiled functions."""
    texts = [path.read_bytes() for path in sorted(Path(__file__).parent.glob("*.py"))]
    return hashlib.sha256(b"".join(text for text in texts if b"@compiled" in text)).hexdigest()


_STAMP = _sources()


def compiled(function: F) -> F:
    """Compile with numba, cached on disk, IEEE arithmetic (no fast-math: NaN checks must work)."""
    dispatcher = numba.njit(cache=True, fastmath=False, error_model="numpy")(function)
    with contextlib.suppress(AttributeError):  # no cache when the compiler is switched off
        index = dispatcher._cache._cache_file
        index._source_stamp = (index._source_stamp, _STAMP)
    return cast(F, dispatcher)
