"""Does less work in Python leave the compiled code as it is, and numba as it was?"""

import gc
import operator
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from llvmlite import ir as llvm_ir  # type: ignore[import-untyped]
from llvmlite.binding import ffi  # type: ignore[import-untyped]
from numba.core import analysis, errors, event, ir
from numba.core.compiler import run_frontend
from numba.core.registry import cpu_target
from numba.core.types.functions import BaseFunction

from lumped import quick_compilation
from lumped.compiler import called, compiled
from lumped.quick_compilation import _STEPS, _less_work
from lumped.typing import FloatArray


class _Line(NamedTuple):
    values: FloatArray
    slope: float


@called
def _at(line: _Line, i: int) -> complex:
    return complex(line.values[i] + line.slope * i, -1.0)


def _all_kinds(values: FloatArray, n: int, flags: tuple[bool, float]) -> float:
    """Statements with variables in lists, tuples, keywords and expressions."""
    line = _Line(values, slope=0.5)
    box = np.zeros((n, 2))
    total = 0.0
    for i in range(n):
        box[i, 1] = abs(_at(line, i=i) * 2) ** 2
        box[i, 0] = values[-1] if flags[0] and i % 2 == 1 else max(flags[1], -values[i])
        total += box[i, 0] // 3 + box[i, 1] / 3
    box[:, 0] = 2.0 * box[:, 1] + 1.0
    total += box[:, 0].sum()
    return float(total)


@pytest.fixture(autouse=True)
def empty_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A cache folder without kernels."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))


def _code(function: Callable[..., Any]) -> str:
    """Intermediate code, without the numbers that numba gives to functions in their order, and addresses."""
    kernel: Any = compiled(function)
    kernel(np.linspace(0.0, 1.0, 5), 4, (True, 0.25))
    code = kernel.inspect_llvm(kernel.signatures[0])
    return re.sub(r"0x[0-9a-f]+|v\d+|\[\d+ x i8\]|B\d+|\b\d{12,}\b|globals\.[0-9a-f]+", "", code)


def test_the_code_is_that_of_numba(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    quick = _code(_all_kinds)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "other"))  # to compile it again
    monkeypatch.setattr(quick_compilation, "_ARE_KNOWN", False)
    assert quick == _code(_all_kinds)


def test_variables_are_listed_in_the_order_of_numba() -> None:
    statements = [one for block in run_frontend(_all_kinds).blocks.values() for one in block.body]
    nested = ir.Stmt()
    nested.parts = {"one": statements[0].target, "others": [(statements[1].target, "text"), {"": None}]}
    statements.append(nested)
    expressions = [one.value for one in statements if isinstance(getattr(one, "value", None), ir.Expr)]
    listed = [one.list_vars() for one in statements + expressions]
    with _less_work():
        assert [one.list_vars() for one in statements + expressions] == listed
    assert {one.op for one in expressions} >= {"call", "binop", "getitem", "build_tuple", "getattr"}
    assert max(map(len, listed)) >= 3
    assert len(nested.list_vars()) == 2


def test_operations_of_other_types_have_other_types() -> None:
    def mixed(x: Any, y: Any) -> tuple[Any, Any]:
        return x * y, x > y

    kernel = compiled(mixed)
    for x, y in ((7, 2), (7.5, 2), (7, 2.5), (1j, 2.0)):
        if isinstance(x, complex):
            with pytest.raises(errors.TypingError):  # complex numbers have no order
                kernel(x, y)
            continue
        product, larger = kernel(x, y)
        assert (product, type(product), larger) == (x * y, type(x * y), x > y)


def test_the_type_of_an_operation_is_found_once(monkeypatch: pytest.MonkeyPatch) -> None:
    own_step = BaseFunction.get_call_type
    asked: list[Any] = []

    def count(function: Any, context: Any, args: Any, kws: Any) -> Any:
        asked.append((function.typing_key, tuple(args)))
        return own_step(function, context, args, kws)

    monkeypatch.setattr(BaseFunction, "get_call_type", count)
    monkeypatch.setattr(quick_compilation, "_SIGNATURES", {})

    def squares(x: float) -> float:
        return x * x + x * x * x

    assert compiled(squares)(3.0) == 36.0
    products = [key for key in asked if key[0] is operator.mul]
    assert len(products) == 1


def test_sizes_are_those_of_llvm() -> None:
    double = llvm_ir.DoubleType()
    kinds = [
        double,
        llvm_ir.IntType(8),
        llvm_ir.LiteralStructType([llvm_ir.IntType(8), double]),
        llvm_ir.LiteralStructType([llvm_ir.IntType(8), double], packed=True),
        llvm_ir.ArrayType(double, 3),
    ]
    context = cpu_target.target_context
    with _less_work():
        sizes = [context.get_abi_sizeof(kind) for kind in kinds * 2]
    assert sizes == [8, 1, 16, 9, 24] * 2


@pytest.mark.parametrize("collects", [True, False])
def test_numba_and_the_collector_are_as_before_also_after_an_error(collects: bool) -> None:
    def wrong(x: float) -> Any:
        return x.nothing  # type: ignore[attr-defined]

    steps = [vars(owner)[name] for owner, name in _STEPS]
    callbacks = list(ffi.lib._lock._cblist)
    assert callbacks  # of numba: without any there would be nothing to leave out
    try:
        if not collects:
            gc.disable()
        with pytest.raises(errors.TypingError):
            compiled(wrong)(1.0)
        assert gc.isenabled() is collects
    finally:
        gc.enable()
    assert [vars(owner)[name] for owner, name in _STEPS] == steps
    assert ffi.lib._lock._cblist == callbacks
    assert quick_compilation._Depth.value == 0


def test_no_garbage_is_collected_and_no_lock_is_told_while_a_function_is_compiled() -> None:
    @called
    def inner(x: float) -> float:
        return x * x + abs(x) / 3.0

    def outer(x: float) -> float:
        return inner(x) + inner(2.0 * x)

    compiling: list[str] = []
    inside: list[str] = []
    collections: list[str] = []
    locks: list[Any] = []

    class Compilations(event.Listener):  # type: ignore[misc]  # numba ships no types
        def on_start(self, one: Any) -> None:
            compiling.append(one.data["dispatcher"].py_func.__name__)
            inside.extend(compiling[1:])

        def on_end(self, one: Any) -> None:
            compiling.pop()

    class Locks(event.Listener):  # type: ignore[misc]
        def on_start(self, one: Any) -> None:
            if len(compiling) > 1:  # of a function that another one calls
                locks.append(one)

        def on_end(self, one: Any) -> None:
            """Nothing."""

    def note(phase: str, information: Any) -> None:
        if len(compiling) > 1:
            collections.append(phase)

    thresholds = gc.get_threshold()
    gc.set_threshold(50, 2, 2)
    gc.callbacks.append(note)
    try:
        with (
            event.install_listener("numba:compile", Compilations()),
            event.install_listener("numba:llvm_lock", Locks()),
        ):
            compiled(outer)(1.5)
    finally:
        gc.callbacks.remove(note)
        gc.set_threshold(*thresholds)
    assert not compiling
    assert "inner" in inside
    assert not collections
    assert not locks


def _count(monkeypatch: pytest.MonkeyPatch, owner: Any, name: str) -> list[Any]:
    """Note the arguments of each call of a step of numba."""
    calls: list[Any] = []
    own_step = getattr(owner, name)

    def step(*arguments: Any) -> Any:
        calls.append(arguments)
        return own_step(*arguments)

    monkeypatch.setattr(owner, name, step)
    return calls


def _in_both_ways(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, calls: list[Any]
) -> tuple[list[Any], list[Any]]:
    """Calls while a function is compiled with less work, and with numba's own steps."""
    _code(_all_kinds)
    quick = list(calls)
    calls.clear()
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "other"))
    monkeypatch.setattr(quick_compilation, "_ARE_KNOWN", False)
    _code(_all_kinds)
    return quick, calls


def test_registries_are_not_read_for_each_array(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    calls = _count(monkeypatch, type(cpu_target.target_context), "load_additional_registries")
    quick, own = _in_both_ways(monkeypatch, tmp_path, calls)
    assert 0 < 3 * len(quick) < len(own)


def test_variables_at_the_start_of_a_block_are_found_where_they_count(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    calls = _count(monkeypatch, analysis, "compute_live_variables")
    quick, own = _in_both_ways(monkeypatch, tmp_path, calls)
    assert 0 < 2 * len(quick) < len(own)


def test_errors_say_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    @called
    def inner(x: float) -> Any:
        return x.nothing  # type: ignore[attr-defined]

    def outer(x: float) -> Any:
        return inner(x) + 1.0

    def text() -> str:
        with pytest.raises(errors.TypingError) as caught:
            compiled(outer)(1.0)
        return re.sub("0x[0-9a-f]+", "", str(caught.value))

    quick = text()
    monkeypatch.setattr(quick_compilation, "_ARE_KNOWN", False)
    assert quick == text()
    assert quick.count("During: ") >= 3
