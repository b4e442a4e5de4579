"""Less work in Python while numba compiles: half of the time of a compilation goes there.

numba does some things again and again whose result is known or that nobody asked for. While one of the
functions of this repository is compiled

- Python does not look for garbage: it would look at everything that numba has made, nearly all of it in use;
- no events tell how long LLVM is locked: each of the 100,000 calls of LLVM would tell every function that is
  being compiled, and nobody listens;
- the variables of a statement are listed by the types of its parts, not by asking each part what it might be;
- the type of an operation, such as float64 + float64, is found once;
- the size of a machine type is found once: LLVM would read a text for each variable.

The code of the functions stays as it is, and so do their results. Afterwards numba is as it was.
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from typing import Any

from llvmlite.binding import ffi  # type: ignore[import-untyped]
from numba.core import base, ir
from numba.core.types.functions import BaseFunction

#: Steps that are replaced. With a numba that lacks one of them all steps are its own.
_STEPS: tuple[tuple[Any, str], ...] = (
    (getattr(ir, "Stmt", None), "list_vars"),
    (getattr(ir, "Expr", None), "list_vars"),
    (BaseFunction, "get_call_type"),
    (base.BaseContext, "get_abi_sizeof"),
)
_ARE_KNOWN = all(name in vars(owner or object) for owner, name in _STEPS) and hasattr(
    getattr(getattr(ffi, "lib", None), "_lock", None), "_cblist"
)


def compile_quickly(dispatcher: Any) -> None:
    """Compile a function, and the functions that it calls, with less work in Python."""
    compile_function = dispatcher._compiler.compile

    def compile_with_less_work(arguments: Any, result: Any) -> Any:
        with _less_work():
            return compile_function(arguments, result)

    dispatcher._compiler.compile = compile_with_less_work


class _Depth:
    """How many compilations are under way, one in another. Numba compiles in one thread at a time."""

    value = 0


@contextmanager
def _less_work() -> Iterator[None]:
    """Less work from the first compilation to its end, those inside it included."""
    _Depth.value += 1
    try:
        with ExitStack() as stack:
            if _Depth.value == 1:
                stack.enter_context(_without_collections())
                if _ARE_KNOWN:
                    stack.enter_context(_without_lock_events())
                    stack.enter_context(_replaced_steps())
            yield
    finally:
        _Depth.value -= 1


@contextmanager
def _without_collections() -> Iterator[None]:
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


@contextmanager
def _without_lock_events() -> Iterator[None]:
    """No call of LLVM calls back."""
    lock: Any = ffi.lib._lock
    callbacks = lock._cblist
    lock._cblist = []
    try:
        yield
    finally:
        lock._cblist = callbacks


@contextmanager
def _replaced_steps() -> Iterator[None]:
    own_steps = [vars(owner)[name] for owner, name in _STEPS]
    steps = _list_vars_of_statement, _list_vars_of_expression, _call_type(own_steps[2]), _size(own_steps[3])
    for (owner, name), step in zip(_STEPS, steps, strict=True):
        setattr(owner, name, step)
    try:
        yield
    finally:
        for (owner, name), step in zip(_STEPS, own_steps, strict=True):
            setattr(owner, name, step)


def _list_vars_of_statement(statement: Any) -> list[Any]:
    return _variables(vars(statement).values())


def _list_vars_of_expression(expression: Any) -> list[Any]:
    return _variables(expression._kws.values())


def _variables(parts: Iterable[Any]) -> list[Any]:
    """Variables among the parts of a statement and inside them, in the order of numba."""
    found: list[Any] = []
    for part in parts:
        kind = type(part)
        if kind is ir.Var:
            found.append(part)
        elif kind is ir.Expr:
            found += _variables(part._kws.values())
        elif kind in _WITHOUT_VARIABLES:
            continue
        elif isinstance(part, ir.Var):
            found.append(part)
        elif isinstance(part, ir.Inst):
            found += part.list_vars()
        elif isinstance(part, list | tuple):
            found += _variables(part)
        elif isinstance(part, dict):
            found += _variables(part.values())
    return found


#: Kinds of parts that hold no variable.
_WITHOUT_VARIABLES = frozenset({str, int, float, bool, type(None), ir.Loc})


def _call_type(own_step: Callable[..., Any]) -> Callable[..., Any]:
    """Type of a call, found once for an operator and the types of its arguments.

    Functions of numba's library are typed each time: their code depends on the flags of the caller too.
    """

    def get_call_type(function: Any, context: Any, args: Any, kws: Any) -> Any:
        operator = function.typing_key
        if kws or getattr(operator, "__module__", None) != "_operator":
            return own_step(function, context, args, kws)
        key = id(function), id(context), tuple(args)
        if (found := _SIGNATURES.get(key)) is not None:
            return found[0]
        signature = own_step(function, context, args, kws)
        if function._impl_keys.get(signature.args) is operator:  # no function of the library
            _SIGNATURES[key] = signature, function, context
        return signature

    return get_call_type


def _size(own_step: Callable[..., Any]) -> Callable[..., Any]:
    """Bytes of a machine type, found once for each text that describes it."""

    def get_abi_sizeof(context: Any, kind: Any) -> int:
        data = context.target_data
        key = id(data), str(kind)
        if (found := _SIZES.get(key)) is None:
            found = _SIZES[key] = own_step(context, kind), data
        return found[0]

    return get_abi_sizeof


#: By the addresses of function and context, which the values keep: two objects never have one address.
_SIGNATURES: dict[tuple[int, int, tuple[Any, ...]], tuple[Any, Any, Any]] = {}
_SIZES: dict[tuple[int, str], tuple[int, Any]] = {}
