"""The compiler of the kernels."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from lumped.compiler import Compiler

F = TypeVar("F", bound=Callable[..., Any])

_COMPILE = Compiler(Path(__file__).parent.glob("*.py"))


def compiled(**options: Any) -> Callable[[F], F]:
    """Compile with these options of numba.njit."""
    return lambda function: _COMPILE(function, **options)
