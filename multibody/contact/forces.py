"""Forces of the tooth contacts at either fidelity: of the linear mesh where the flags say so, else exact."""

from __future__ import annotations

import numpy as np

from lumped.typing import FloatArray, IntArray
from multibody.contact.compiled import compiled
from multibody.contact.kernels import LINEAR, contact_forces
from multibody.contact.kernels_linear import linear_forces


@compiled
def tooth_forces(
    t: float,
    q: FloatArray,
    v: FloatArray,
    p: FloatArray,
    flags: int,
    table: FloatArray,
    wrench: FloatArray,
    contacts: FloatArray,
) -> int:
    """Wrench and contact records of one state; arguments and result as ``kernels.contact_forces``."""
    if flags & LINEAR:
        return linear_forces(t, q, v, p, flags, table, wrench, contacts)
    return contact_forces(t, q, v, p, flags, table, wrench, contacts)


@compiled
def tooth_forces_over(
    times: FloatArray,
    q: FloatArray,
    v: FloatArray,
    p: FloatArray,
    flags: int,
    table: FloatArray,
    wrenches: FloatArray,
    contacts: FloatArray,
) -> IntArray:
    """``tooth_forces`` at n states; returns the numbers of contacts (n,).

    Parameters
    ----------
    times : (n,) [s]
    q, v, wrenches : (n, 6)
    contacts : (n, 2 MAX_PAIRS, N_RECORD)
    p, flags, table : as ``tooth_forces``
    """
    counts = np.empty(times.size, np.int64)
    for i in range(times.size):
        counts[i] = tooth_forces(times[i], q[i], v[i], p, flags, table, wrenches[i], contacts[i])
    return counts
