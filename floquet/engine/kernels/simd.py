"""Eight numbers side by side as one value of compiled code.

The compiler does not turn short loops over possibly overlapping arrays into vector instructions. ``load`` and
``store`` move eight numbers of the last axis of an array; everything else works on registers.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from llvmlite import ir  # type: ignore[import-untyped]
from numba.core import cgutils, types
from numba.core.datamodel import models
from numba.extending import intrinsic, register_model

from lumped.compiler import compiled
from lumped.typing import FloatArray

LANES = 8
_VECTOR = ir.VectorType(ir.DoubleType(), LANES)
_UNALIGNED = 8  # bytes that numpy arrays are sure to be aligned to
_CONTRACT = ("contract",)  # a product and the sum it goes into may round once


class _Lanes(types.Type):  # type: ignore[misc,unused-ignore]
    def __init__(self) -> None:
        super().__init__(name="Lanes8")


_vector = _Lanes()


@register_model(_Lanes)
class _LanesModel(models.PrimitiveModel):  # type: ignore[misc,unused-ignore]
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, _VECTOR)


def _pointer(context: Any, builder: Any, kinds: Any, array: Any, index: Any) -> Any:
    view = context.make_array(kinds[0])(context, builder, array)
    parts = zip(cgutils.unpack_tuple(builder, index), kinds[1], strict=True)
    where = [context.cast(builder, value, kind, types.intp) for value, kind in parts]
    if len(where) < kinds[0].ndim:
        where.append(context.get_constant(types.intp, 0))
    pointer = cgutils.get_item_pointer(context, builder, kinds[0], view, where)
    return builder.bitcast(pointer, ir.PointerType(_VECTOR))


def _splat(builder: Any, value: Any) -> Any:
    blank = ir.Constant(_VECTOR, ir.Undefined)
    first = builder.insert_element(blank, value, ir.Constant(ir.IntType(32), 0))
    zeros = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES)
    return builder.shuffle_vector(first, blank, zeros)


@intrinsic
def load(typing: Any, array: Any, index: Any) -> Any:
    """load(array, (i, ..., c)): array[i, ..., c : c + 8]; c is 0 where it is left out."""

    def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.load(_pointer(context, builder, signature.args, *args), align=_UNALIGNED)

    return _vector(array, index), code


@intrinsic
def store(typing: Any, array: Any, index: Any, value: Any) -> Any:
    """store(array, (i, ..., c), x): array[i, ..., c : c + 8] = x; c is 0 where it is left out."""

    def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        pointer = _pointer(context, builder, signature.args, args[0], args[1])
        builder.store(args[2], pointer, align=_UNALIGNED)
        return context.get_dummy_value()

    return types.void(array, index, _vector), code


@intrinsic
def zero(typing: Any) -> Any:
    """zero(): eight zeros."""

    def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return ir.Constant(_VECTOR, [0.0] * LANES)

    return _vector(), code


@intrinsic
def scaled(typing: Any, factor: Any, x: Any) -> Any:
    """scaled(factor, x): factor x."""

    def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.fmul(_splat(builder, args[0]), args[1], flags=_CONTRACT)

    return _vector(types.float64, _vector), code


@intrinsic
def plus(typing: Any, factor: Any, x: Any, total: Any) -> Any:
    """plus(factor, x, total): factor x + total."""

    def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        product = builder.fmul(_splat(builder, args[0]), args[1], flags=_CONTRACT)
        return builder.fadd(product, args[2], flags=_CONTRACT)

    return _vector(types.float64, _vector, _vector), code


@intrinsic
def plus_product(typing: Any, x: Any, y: Any, total: Any) -> Any:
    """plus_product(x, y, total): x y + total, lane by lane."""

    def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        product = builder.fmul(args[0], args[1], flags=_CONTRACT)
        return builder.fadd(product, args[2], flags=_CONTRACT)

    return _vector(_vector, _vector, _vector), code


@intrinsic
def plus_square(typing: Any, x: Any, total: Any) -> Any:
    """plus_square(x, total): x x + total, lane by lane."""

    def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        product = builder.fmul(args[0], args[0], flags=_CONTRACT)
        return builder.fadd(product, args[1], flags=_CONTRACT)

    return _vector(_vector, _vector), code


def _folded(builder: Any, value: Any, join: Any) -> Any:
    """All eight joined into one, in a tree of three."""
    blank = ir.Constant(_VECTOR, ir.Undefined)
    kind = ir.VectorType(ir.IntType(32), LANES)
    for width in (4, 2, 1):
        across = ir.Constant(kind, [(lane + width) % LANES for lane in range(LANES)])
        value = join(value, builder.shuffle_vector(value, blank, across))
    return builder.extract_element(value, ir.Constant(ir.IntType(32), 0))


@intrinsic
def total(typing: Any, x: Any) -> Any:
    """total(x): sum of the eight."""

    def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return _folded(builder, args[0], builder.fadd)

    return types.float64(_vector), code


@intrinsic
def least(typing: Any, x: Any, y: Any) -> Any:
    """least(x, y): the smallest of the sixteen."""

    def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        def smaller(one: Any, other: Any) -> Any:
            return builder.select(builder.fcmp_ordered("<", one, other), one, other)

        return _folded(builder, smaller(args[0], args[1]), smaller)

    return types.float64(_vector, _vector), code


# Arrays that begin where a cache line of the processor begins. Eight numbers that lie in two cache lines take
# twice as long to move.


@compiled(no_cpython_wrapper=True)
def aligned_empty(size: int) -> FloatArray:
    """Array (size,) of any values."""
    block = np.empty(size + LANES)
    first = (-(block.ctypes.data // 8)) % LANES
    return block[first : first + size]


@compiled(no_cpython_wrapper=True)
def aligned_matrices(count: int, rows: int, lanes: int) -> FloatArray:
    """Zeros (count, rows, lanes)."""
    zeros = aligned_empty(count * rows * lanes)
    zeros[:] = 0.0
    return zeros.reshape((count, rows, lanes))


@compiled(no_cpython_wrapper=True)
def aligned_rows(rows: int, lanes: int) -> FloatArray:
    """Zeros (rows, lanes)."""
    zeros = aligned_empty(rows * lanes)
    zeros[:] = 0.0
    return zeros.reshape((rows, lanes))
