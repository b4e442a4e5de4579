"""Public names of a package: imported on first use, and functions that raise typed errors.

A user may call a function through its package, ``floquet.monodromy``, or through ``spurcheck``. Both raise
``ParameterError`` or ``NumericalError`` where a library fails. Modules of the four packages import from the
modules themselves, whose functions are not wrapped: an error is turned once, where the call of the user ends.
"""

from __future__ import annotations

import functools
import sys
from collections.abc import Callable
from types import FunctionType
from typing import Any, NamedTuple

import lazy_loader


class PublicNames(NamedTuple):
    """What a package binds to ``__getattr__``, ``__dir__`` and ``__all__``."""

    of_name: Callable[[str], Any]
    directory: Callable[[], list[str]]
    names: list[str]


def public_names(package: str, file: str) -> PublicNames:
    """Return the public names of a package, which its ``__init__.pyi`` lists.

    Parameters
    ----------
    package : ``__name__`` of the package
    file : ``__file__`` of the package
    """
    of_stub, directory, names = lazy_loader.attach_stub(package, file)

    def of_name(name: str) -> Any:
        value = of_stub(name)
        if isinstance(value, FunctionType) and name in names:
            value = _with_typed_errors(package, name, value)
            setattr(sys.modules[package], name, value)
        return value

    return PublicNames(of_name, directory, names)


def _with_typed_errors(package: str, name: str, function: FunctionType) -> Callable[..., Any]:
    """Return a function whose errors of libraries are typed errors."""

    @functools.wraps(function)
    def call(*arguments: Any, **named: Any) -> Any:
        from lumped.errors import typed_errors

        with typed_errors():
            return function(*arguments, **named)

    # pickle looks for the function by these names
    call.__module__ = package
    call.__qualname__ = name
    return call
