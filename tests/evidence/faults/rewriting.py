"""Change one line of a function in the running process, and take the change out again.

The function's source is read, the text replaced, and the result compiled in the module's own names.
Whatever holds the original, in any module, class or record of the packages, holds the changed one until the
end. Results that the packages keep are dropped before and after. Functions compiled by numba are compiled
again without its disk cache, and with them all that call them. No file is written.
"""

from __future__ import annotations
import __future__

import contextlib
import dataclasses
import functools
import importlib
import inspect
import sys
import textwrap
import types
from collections.abc import Callable, Iterator
from typing import Any

import numba
from numba.core.dispatcher import Dispatcher

from lumped import cache
from tests.evidence.faults.fault import Fault

_PACKAGES = ("lumped", "multibody", "floquet", "validation")


class FaultError(Exception):
    """A fault that does not fit the program any more: its line is gone or occurs more than once."""


@contextlib.contextmanager
def applied(fault: Fault) -> Iterator[None]:
    """Run with a fault in the program."""
    if not fault.target:  # a wrong input is wrong in the parameter file
        yield
        return
    owner, original, wrong = fitted(fault)
    replaced: dict[int, tuple[Any, Any]] = {id(original): (original, wrong)}
    if isinstance(original, Dispatcher):
        _with_callers(replaced)
    forget()
    if fault.target.startswith("lumped.elasticity"):  # nothing of a wrong program is stored, or read
        replaced[id(cache.cached)] = (cache.cached, _not_cached)
    undo = []
    for one in replaced.values():
        undo += _exchange(*one, owner)
    try:
        yield
    finally:
        for restore in reversed(undo):
            restore()
        forget()


def fitted(fault: Fault) -> tuple[Any, Any, Any]:
    """Module or class that holds the function of a fault, the function, and the wrong one, uncompiled."""
    owner, name = _place(fault)
    original = vars(owner)[name]
    return owner, original, _rewritten(fault, owner, name, original)


def _not_cached(
    folder: str, sources: object, inputs: bytes, compute: Callable[[], dict[str, Any]]
) -> dict[str, Any]:
    return compute()


def forget() -> None:
    """Drop every result that a function of the packages keeps."""
    for module in _modules(_PACKAGES):
        for value in list(vars(module).values()):
            clear = getattr(value, "cache_clear", None)
            if clear is not None and not isinstance(value, type):
                clear()


def _modules(packages: tuple[str, ...] = (*_PACKAGES, "tests")) -> list[types.ModuleType]:
    """Those of the packages, and of the evidence, which hold functions too."""
    names = [name for name in sys.modules if name.partition(".")[0] in packages]
    return [sys.modules[name] for name in names if isinstance(sys.modules[name], types.ModuleType)]


def _place(fault: Fault) -> tuple[Any, str]:
    """Module or class that holds the function, and its name there."""
    module, _, path = fault.target.partition(":")
    *outer, name = path.split(".")
    owner: Any = importlib.import_module(module)
    for part in outer:
        owner = getattr(owner, part, None)
    if owner is None or name not in vars(owner):
        raise FaultError(f"{fault.key}: {fault.target} is not there")
    return owner, name


def _function(member: Any) -> Callable[..., Any]:
    """The plain function inside a property, a cached function or a compiled one."""
    for attribute in ("fget", "func", "__wrapped__", "__func__", "py_func"):
        inner = getattr(member, attribute, None)
        if isinstance(inner, types.FunctionType):
            return inner
    if isinstance(member, types.FunctionType):
        return member
    raise FaultError(f"{member!r} is no function")


def _rewritten(fault: Fault, owner: Any, name: str, original: Any) -> Any:
    function = _function(original)
    source = textwrap.dedent(inspect.getsource(function))
    if source.count(fault.old) != 1:
        raise FaultError(f"{fault.key}: {fault.target} has {source.count(fault.old)} times {fault.old!r}")
    source = source.replace(fault.old, fault.new)
    if isinstance(original, Dispatcher):
        source = source[source.index("def ") :]  # the packages' decorator keeps code on disk
    flags = __future__.annotations.compiler_flag
    made: dict[str, Any] = {}
    exec(compile(source, f"<{fault.key}>", "exec", flags, dont_inherit=True), function.__globals__, made)
    result = made[name]
    if isinstance(original, Dispatcher):
        return _compiled(result, original)
    if isinstance(result, functools.cached_property):
        result.__set_name__(owner, name)
    return result


def _compiled(function: Callable[..., Any], original: Dispatcher) -> Any:
    options = {k: v for k, v in original.targetoptions.items() if k not in ("nopython", "cache")}
    return numba.njit(**options)(function)


def _with_callers(replaced: dict[int, tuple[Any, Any]]) -> None:
    """Add all compiled functions that call a replaced function, directly or through other functions."""
    dispatchers = {
        id(value): value
        for module in _modules()
        for value in vars(module).values()
        if isinstance(value, Dispatcher)
    }
    grown = True
    while grown:
        grown = False
        for key, value in dispatchers.items():
            function = value.py_func
            called = _named(function)
            if key not in replaced and any(id(one) in replaced for one in called):
                copy = types.FunctionType(function.__code__, function.__globals__, function.__name__)
                replaced[key] = (value, _compiled(copy, value))
                grown = True


def _named(function: types.FunctionType) -> Iterator[Any]:
    """Yield all objects that a function may call: globals of the module, and members of imported modules."""
    names = function.__code__.co_names
    for name in names:
        value = function.__globals__.get(name)
        yield value
        if isinstance(value, types.ModuleType):
            yield from (getattr(value, inner, None) for inner in names)


def _exchange(original: Any, changed: Any, owner: Any) -> list[Callable[[], None]]:
    """Replace the original by the changed object everywhere. Returns functions that undo each replacement.

    A package holds its public functions inside one that types errors, see ``lumped.public_names``.
    """
    undo: list[Callable[[], None]] = []
    holders: list[Any] = [*_modules(), owner]
    records = {
        id(value): value
        for module in _modules()
        for value in vars(module).values()
        if dataclasses.is_dataclass(value) and not isinstance(value, type)
    }
    for holder in {id(one): one for one in [*holders, *records.values()]}.values():
        for name, value in list(vars(holder).items()):
            if value is original or _wrapped(value) is original:
                set_attribute = _frozen if id(holder) in records else setattr
                set_attribute(holder, name, changed)
                undo.append(functools.partial(set_attribute, holder, name, value))
    return undo


def _wrapped(value: Any) -> Any:
    """The function inside a public name of a package, or None."""
    return (
        value.__wrapped__ if isinstance(value, types.FunctionType) and hasattr(value, "__wrapped__") else None
    )


def _frozen(record: Any, name: str, value: Any) -> None:
    object.__setattr__(record, name, value)
