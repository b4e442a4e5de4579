"""Records as a view of flat numbers in compiled code, without numba's check of sizes.

``ndarray.view`` of numba writes the sizes into the message of an error. To compile the functions that make
this text would take a twelfth of the time for the whole model.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from llvmlite import ir  # type: ignore[import-untyped]
from numba.core import types
from numba.core.imputils import impl_ret_borrowed
from numba.extending import intrinsic
from numba.np.arrayobj import make_array, populate_array

from lumped.typing import FloatArray

_NUMBER = np.dtype(np.float64).itemsize


def _as_records(typing_context: Any, numbers: Any, kind: Any) -> Any:
    """Types of ``as_records``, and the function that writes its code."""
    if not (isinstance(numbers, types.Array) and numbers.ndim == 1 and numbers.layout == "C"):
        return None
    record = kind.dtype
    records = types.Array(record, 1, "C", readonly=not numbers.mutable, aligned=numbers.aligned)

    def write(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        flat = make_array(numbers)(context, builder, arguments[0])
        view = make_array(records)(context, builder)
        size = ir.Constant(flat.nitems.type, record.size)
        count = builder.udiv(builder.mul(flat.nitems, ir.Constant(flat.nitems.type, _NUMBER)), size)
        populate_array(
            view,
            data=builder.bitcast(flat.data, view.data.type),
            shape=[count],
            strides=[size],
            itemsize=size,
            meminfo=flat.meminfo,
            parent=flat.parent,
        )
        return impl_ret_borrowed(context, builder, records, view._getvalue())

    return records(numbers, kind), write


#: See numbers (n,), contiguous, as records of a dtype. Numbers behind the last whole record are left out.
as_records: Callable[[FloatArray, np.dtype[Any]], np.ndarray[Any, np.dtype[Any]]] = intrinsic(_as_records)
