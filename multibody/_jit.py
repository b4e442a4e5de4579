"""One typed name for the compiler decorator, so that compiled functions keep their signatures."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba

F = TypeVar("F", bound=Callable[..., Any])


def compiled(function: F) -> F:
    """Compile with numba, cached on disk, IEEE arithmetic (no fast-math: NaN checks must work)."""
    return cast(F, numba.njit(cache=True, fastmath=False, error_model="numpy")(function))
