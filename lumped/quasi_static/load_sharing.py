"""Static load sharing among tooth pairs that are linear springs with initial gaps.

If the stiffness model knows it, the load of a pair also moves the neighbours of the pair.

Sources: docs/theory/mesh_physics.md, "Load sharing and static transmission error".
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from lumped.arguments import real_array
from lumped.errors import NumericalError
from lumped.mesh.records import EXACT, FLANKS, ContactLaw
from lumped.mesh.statics import Phases, static_approaches, workspace
from lumped.mesh.unloaded import NeighbourLaws
from lumped.path_function import PathFunction
from lumped.typing import FloatArray

#: Flanks without ends, and linear springs that any neighbour may move.
_ENDLESS = np.array([(-np.inf, np.inf, np.inf, 0.0, 0.0, 0.0, 0.0)], FLANKS)
_SPRINGS = ContactLaw(
    force=1.0,
    softening=0.0,
    linear_below=0.0,
    converged=EXACT,
    full_damper=1.0,
    coupled=False,
    apart_below=-np.inf,
    prescribed=False,
    radius_pinion=1.0,
    radius_gear=1.0,
    rolling_speed=0.0,
)
_NO_PAIR = "At some position no tooth pair can carry the load: check stiffness and errors."


@dataclass(frozen=True)
class LoadSharing:
    """Static equilibrium: ``transmission_error`` delta (...,) [m] and ``load`` N_i (..., pairs) [N]."""

    transmission_error: FloatArray
    load: FloatArray


def share_load(
    stiffness: ArrayLike, error: ArrayLike, force: ArrayLike, coupling: ArrayLike | None = None
) -> LoadSharing:
    """Solve sum_i N_i = F with N_i = k_i max(delta - e_i - sum_j w_ij N_j, 0) for delta.

    The loads grow with delta by pieces that are linear, so Newton's method in a bracket ends after a few
    steps at the exact solution (``lumped.mesh.element``).

    Parameters
    ----------
    stiffness : k_i >= 0; (..., pairs) [N/m]
    error : e_i, infinite for a pair that cannot touch; broadcast against ``stiffness`` [m]
    force : F >= 0, broadcast against the leading dimensions [N]
    coupling : w_ij, symmetric with zeros on the diagonal, broadcast against (..., pairs, pairs); default none
        [m/N]

    Raises
    ------
    NumericalError : nowhere a pair that can carry the load
    """
    k = real_array("stiffness", stiffness)
    e = real_array("error", error, finite=False)
    applied = real_array("force", force)
    is_coupled = coupling is not None and bool(np.any(coupling))
    w = real_array("coupling", coupling) if is_coupled else np.zeros((1, 1))
    lead = np.broadcast_shapes(k.shape[:-1], e.shape[:-1], applied.shape, w.shape[:-2])
    pairs = max(k.shape[-1], e.shape[-1])
    reach = np.isfinite(e)
    gaps = _rows(np.where(reach, e, 0.0), lead, pairs)
    load = np.zeros((math.prod(lead), pairs))
    phases = Phases(
        position=np.zeros(gaps.shape),
        stiffness=_rows(np.where(reach, k, 0.0), lead, pairs),
        gap=gaps,
        coupling=_rows(w, lead if is_coupled else (1,), pairs, pairs),
        lengthening=0.0,
    )
    law = _SPRINGS._replace(coupled=is_coupled)
    approach = static_approaches(phases, _rows(applied, lead), _ENDLESS, law, load, workspace(phases))
    if not np.isfinite(approach).all():
        raise NumericalError(_NO_PAIR)
    return LoadSharing(approach.reshape(lead), load.reshape(*lead, pairs))


def _rows(values: FloatArray, lead: tuple[int, ...], *inner: int) -> FloatArray:
    """Broadcast values to (lead, inner), and return a copy (n, inner).

    The copy is row by row in memory: for another order the kernel would be compiled again.
    """
    broadcast = np.broadcast_to(values, (*lead, *inner)).reshape(-1, *inner)
    return np.array(broadcast, dtype=np.float64, order="C")


def neighbour_laws(functions: Sequence[PathFunction]) -> NeighbourLaws:
    """Return the functions w_m(xi) of a stiffness model, m = 1, 2, ..., as plain arrays."""
    sizes = [function.breaks.size for function in functions]
    order = max([1, *(len(function.coefficients) for function in functions)])
    first = np.cumsum([0, *sizes])
    coefficients = np.zeros((order, int(first[-1])))
    for start, function in zip(first, functions, strict=False):
        terms, pieces = function.coefficients.shape
        coefficients[order - terms :, start : start + pieces] = function.coefficients
    breaks = np.concatenate([np.empty(0), *(function.breaks for function in functions)])
    return NeighbourLaws(first, breaks, coefficients)
