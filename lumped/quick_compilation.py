"""Less work in Python while numba compiles: half of the time of a compilation goes there.

numba does some things again and again whose result is known or that nobody asked for. While one of the
functions of this repository is compiled

- Python does not look for garbage: it would look at everything that numba has made, nearly all of it in use;
- no events tell how long LLVM is locked: each of the 100,000 calls of LLVM would tell every function that is
  being compiled, and nobody listens;
- the variables of a statement are listed by the types of its parts, not by asking each part what it might be;
- which variables live at the start of a block is found where numba needs it, once for a function and not
  after each pass;
- the type of an operation, such as float64 + float64, is found once;
- the size of a machine type is found once: LLVM would read a text for each variable;
- numba does not look through all its registries for a form of each array that there is not;
- where an error would be is written when there is an error.

The code of the functions stays as it is, and so do their results. Afterwards numba is as it was.
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from typing import Any

from llvmlite.binding import ffi  # type: ignore[import-untyped]
from numba.core import base, errors, ir, lowering, postproc, transforms, typeinfer
from numba.core.types.functions import BaseFunction

#: Names of this module are missing in the types that numba ships.
_ERRORS: Any = errors
#: Steps that are replaced. With a numba that lacks one of them all steps are its own.
_STEPS: tuple[tuple[Any, str], ...] = (
    (getattr(ir, "Stmt", None), "list_vars"),
    (getattr(ir, "Expr", None), "list_vars"),
    (BaseFunction, "get_call_type"),
    (base.BaseContext, "get_abi_sizeof"),
    (base.BaseContext, "get_function"),
    (getattr(postproc, "PostProcessor", None), "run"),
    (typeinfer, "new_error_context"),
    (lowering, "new_error_context"),
)
#: What the steps use of numba.
_USED: tuple[tuple[Any, str], ...] = (
    (getattr(ffi, "lib", None), "_lock"),
    (getattr(getattr(ffi, "lib", None), "_lock", None), "_cblist"),
    (errors, "loc_info"),
    (errors, "_format_msg"),
    (errors, "_numba_path"),
    (postproc, "VariableLifetime"),
    (transforms, "canonicalize_cfg"),
)
_ARE_KNOWN = all(name in vars(owner or object) for owner, name in _STEPS) and all(
    hasattr(owner, name) for owner, name in _USED
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
    steps: tuple[Any, ...] = (
        _list_vars_of_statement,
        _list_vars_of_expression,
        _call_type(own_steps[2]),
        _size(own_steps[3]),
        _implementation(own_steps[4]),
        _post_process(own_steps[5]),
        _ErrorContext,
        _ErrorContext,
    )
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


#: Operations for which numba asks whether there is a special form, and takes the general one where there is
#: none, as of nearly every array and index.
_OFTEN_WITHOUT_FORM = frozenset({"__array__", "static_getitem", "static_setitem"})


def _implementation(own_step: Callable[..., Any]) -> Callable[..., Any]:
    """What a function does in machine code. Its failure is numba's answer that there is no such form.

    Before it fails numba reads all its registries again: a module could have been imported meanwhile.
    """

    def get_function(context: Any, function: Any, signature: Any, _firstcall: bool = True) -> Any:
        again = _firstcall and not (isinstance(function, str) and function in _OFTEN_WITHOUT_FORM)
        return own_step(context, function, signature, again)

    return get_function


def _post_process(own_step: Callable[..., Any]) -> Callable[..., Any]:
    """What numba does with a function after each pass that changed it.

    The lifetimes of variables are found when they are asked for. Which variables are set when a block is
    entered is asked by generators alone, and by code in Python.
    """

    def run(processor: Any, emit_dels: bool = False, extend_lifetimes: bool = False) -> None:
        function = processor.func_ir
        if emit_dels or function.is_generator:
            own_step(processor, emit_dels, extend_lifetimes)
            return
        function.blocks = transforms.canonicalize_cfg(function.blocks)
        function.variable_lifetime = postproc.VariableLifetime(function.blocks)
        function.generator_info = None

    return run


class _ErrorContext:
    """Adds to an error what was being compiled; as numba's ``new_error_context``, without a generator."""

    __slots__ = ("arguments", "message", "names")

    def __init__(self, message: str, *arguments: Any, **names: Any) -> None:
        self.message = message
        self.arguments = arguments
        self.names = names
        place = names.get("loc")
        if place is not None and not place.filename.startswith(_ERRORS._numba_path):
            _ERRORS.loc_info.update(names)

    def __enter__(self) -> None:
        """Nothing."""

    def __exit__(self, kind: Any, error: BaseException | None, trace: Any) -> None:
        if isinstance(error, errors.NumbaError):
            error.add_context(_ERRORS._format_msg(self.message, self.arguments, self.names))
