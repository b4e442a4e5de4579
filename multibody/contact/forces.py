"""Forces of the tooth contacts at either fidelity: of the linear mesh where the flags say so, else exact."""

from __future__ import annotations

import numpy as np

from lumped.typing import FloatArray, IntArray
from multibody.contact.compiled import compiled
from multibody.contact.kernels import LINEAR, contact_forces
from multibody.contact.kernels_linear import linear_forces


@compiled
def tooth_forces(
    t: float, state: FloatArray, p: FloatArray, flags: int, table: FloatArray, contacts: FloatArray
) -> int:
    """Wrench and contact records of one state.

    Parameters
    ----------
    state : (3, 6) coordinates, velocities, and the wrench, which is written; one array, for Python pays for
        every one that it hands over
    t, p, flags, table, contacts : and the result, as ``kernels.contact_forces``
    """
    q, v, wrench = state[0], state[1], state[2]
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
    counts, state = np.empty(times.size, np.int64), np.empty((3, 6))
    for i in range(times.size):
        for j in range(6):
            state[0, j], state[1, j] = q[i, j], v[i, j]
        counts[i] = tooth_forces(times[i], state, p, flags, table, contacts[i])
        for j in range(6):
            wrenches[i, j] = state[2, j]
    return counts
