"""Static load sharing among tooth pairs: linear springs with initial gaps, solved exactly.

Where the stiffness model has it, the load of a pair moves its neighbours too, by the whole compliance matrix.

Sources: docs/theory/mesh_physics.md, "Load sharing and static transmission error".
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from lumped.arguments import real_array
from lumped.errors import NumericalError
from lumped.path_function import PathFunction
from lumped.typing import BoolArray, FloatArray

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

    Pairs that stand alone: for any set S of pairs sum_i N_i is at least the sum of k_i (delta - e_i) over S,
    and equal to it for the pairs in contact. So delta is the least, over sets, of (F + sum_S k_i e_i)/sum_S
    k_i, and only the sets of the m smallest errors can be the ones in contact.

    Pairs that move each other: of all sets the one is taken in which no pair pulls and no other is closed.

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
    k, e = real_array("stiffness", stiffness), real_array("error", error, finite=False)
    applied = real_array("force", force)[..., None]
    if coupling is not None and np.any(coupling):
        return _coupled(k, e, applied, real_array("coupling", coupling))
    k, e = np.broadcast_arrays(k, e)
    order = np.argsort(e, axis=-1, kind="stable")
    k_sorted, e_sorted = np.take_along_axis(k, order, -1), np.take_along_axis(e, order, -1)
    reach = np.isfinite(e_sorted)
    k_sorted, e_sorted = np.where(reach, k_sorted, 0.0), np.where(reach, e_sorted, 0.0)
    stiff, preload = np.cumsum(k_sorted, axis=-1), np.cumsum(k_sorted * e_sorted, axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        candidates = np.where(stiff > 0.0, (applied + preload) / stiff, np.inf)
    delta = candidates.min(axis=-1)
    if not np.isfinite(delta).all():
        raise NumericalError(_NO_PAIR)
    gap = delta[..., None] - e
    return LoadSharing(delta, np.where(gap > 0.0, k * np.where(gap > 0.0, gap, 0.0), 0.0))


def _coupled(k: FloatArray, e: FloatArray, force: FloatArray, coupling: FloatArray) -> LoadSharing:
    """The same for pairs that move each other; ``force`` (..., 1)."""
    shape = np.broadcast_shapes(k.shape, e.shape, force.shape[:-1] + k.shape[-1:])
    can = np.isfinite(e) & (k > 0.0)
    own, late = 1.0 / np.where(k > 0.0, k, 1.0), np.where(np.isfinite(e), e, 0.0)
    delta, load = np.zeros(shape[:-1]), np.zeros(shape)
    best = np.full(shape[:-1], np.inf)
    for one in _sets(can):
        matrix = coupling[..., one, :][..., one] + own[..., one, None] * np.eye(len(one))
        touching = can[..., one].all(axis=-1)
        inverse = _inverses(np.moveaxis(matrix, (-2, -1), (0, 1)))
        weight = inverse.sum(axis=1)
        approach = force[..., 0] + sum(weight[n] * late[..., i] for n, i in enumerate(one))
        approach = approach / weight.sum(axis=0)
        pressed = [approach - late[..., i] for i in one]
        loads = [sum(entry * by for entry, by in zip(row, pressed, strict=True)) for row in inverse]
        # Lengths: how far a pair of the set would have to pull, how far another is through its mate.
        wrong = np.where(touching, 0.0, np.inf)
        for i, carried in zip(one, loads, strict=True):
            wrong = np.maximum(wrong, -carried * own[..., i])
        for other in set(range(k.shape[-1])) - set(one):
            moved = sum(coupling[..., other, i] * carried for i, carried in zip(one, loads, strict=True))
            wrong = np.maximum(wrong, np.where(can[..., other], approach - moved - late[..., other], 0.0))
        better = wrong < best
        best, delta = np.where(better, wrong, best), np.where(better, approach, delta)
        load[better] = 0.0
        for i, carried in zip(one, loads, strict=True):
            load[..., i] = np.where(better, carried, load[..., i])
    if not np.isfinite(best).all():
        raise NumericalError(_NO_PAIR)
    return LoadSharing(delta, np.maximum(load, 0.0))


def _inverses(matrix: FloatArray) -> FloatArray:
    """Inverses of positive definite matrices (n, n, ...), by Gauss and Jordan: for many small ones."""
    found = np.array(matrix)
    for i in range(len(found)):
        pivot = 1.0 / found[i, i]
        found[i, i] = 1.0
        found[i] *= pivot
        for j in range(len(found)):
            if j != i:
                factor = found[j, i].copy()
                found[j, i] = 0.0
                found[j] -= factor * found[i]
    return found


def _sets(can: BoolArray) -> list[list[int]]:
    """Sets of pairs that can touch together at some position (..., pairs), smallest first."""
    bits = 1 << np.arange(can.shape[-1])
    found = {
        chosen
        for together in np.unique(can @ bits).tolist()
        for count in range(1, can.shape[-1] + 1)
        for chosen in itertools.combinations(np.flatnonzero(together & bits).tolist(), count)
    }
    return [list(one) for one in sorted(found, key=lambda one: (len(one), one))]


def coupled(neighbours: Sequence[PathFunction], place: FloatArray, near: BoolArray) -> FloatArray:
    """How far pairs at xi (n, pairs) [m], whole pitches apart, move each other; (n, pairs, pairs) [m/N].

    ``neighbours`` are w_m(xi) of the stiffness model; the pair behind is first; ``near`` pairs are followed.
    """
    pairs = place.shape[1]
    found = np.zeros((*place.shape, pairs))
    for apart, moved in enumerate(neighbours, 1):
        if apart < pairs:
            both = near[:, :-apart] & near[:, apart:]
            behind = np.arange(pairs - apart)
            values = np.where(both, moved(place[:, :-apart]), 0.0)
            found[:, behind, behind + apart] = found[:, behind + apart, behind] = values
    return found
