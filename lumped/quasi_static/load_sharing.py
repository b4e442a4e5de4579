"""Static load sharing among tooth pairs: linear springs with initial gaps, solved exactly.

Sources: docs/theory/mesh_physics.md, "Load sharing and static transmission error".
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from lumped.arguments import real_array
from lumped.errors import NumericalError
from lumped.typing import FloatArray


@dataclass(frozen=True)
class LoadSharing:
    """Static equilibrium of a mesh.

    Attributes
    ----------
    transmission_error : delta, approach of the rigid flanks along the line of action; (..., ) [m]
    load : k_i (delta - e_i) where positive, 0 elsewhere; (..., pairs) [N]
    """

    transmission_error: FloatArray
    load: FloatArray


def share_load(stiffness: ArrayLike, error: ArrayLike, force: ArrayLike) -> LoadSharing:
    """Solve sum_i k_i max(delta - e_i, 0) = F for delta.

    For any set S of pairs the left side is at least the sum of k_i (delta - e_i) over S, and equal to it for
    the pairs in contact. So delta is the least, over sets, of (F + sum_S k_i e_i)/sum_S k_i, and only the
    sets of the m smallest errors can be the ones in contact.

    Parameters
    ----------
    stiffness : k_i >= 0; (..., pairs) [N/m]
    error : e_i, infinite for a pair that cannot touch; broadcast against ``stiffness`` [m]
    force : F >= 0, broadcast against the leading dimensions [N]

    Raises
    ------
    NumericalError : nowhere a pair that can carry the load
    """
    k, e = np.broadcast_arrays(real_array("stiffness", stiffness), real_array("error", error, finite=False))
    order = np.argsort(e, axis=-1, kind="stable")
    k_sorted, e_sorted = np.take_along_axis(k, order, -1), np.take_along_axis(e, order, -1)
    reach = np.isfinite(e_sorted)
    k_sorted, e_sorted = np.where(reach, k_sorted, 0.0), np.where(reach, e_sorted, 0.0)
    stiff, preload = np.cumsum(k_sorted, axis=-1), np.cumsum(k_sorted * e_sorted, axis=-1)
    applied = real_array("force", force)[..., None]
    with np.errstate(divide="ignore", invalid="ignore"):
        candidates = np.where(stiff > 0.0, (applied + preload) / stiff, np.inf)
    delta = candidates.min(axis=-1)
    if not np.isfinite(delta).all():
        raise NumericalError("At some position no tooth pair can carry the load: check stiffness and errors.")
    gap = delta[..., None] - e
    return LoadSharing(delta, np.where(gap > 0.0, k * np.where(gap > 0.0, gap, 0.0), 0.0))
