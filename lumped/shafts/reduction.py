"""Craig-Bampton reduction of a structure that is held at one coordinate, and its modes.

Sources: R. R. Craig and M. C. C. Bampton, AIAA J. 6 (1968) 1313.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

from lumped.typing import FloatArray


@dataclass(frozen=True, eq=False)
class Modes:
    """Modes of the reduced structure.

    Attributes
    ----------
    frequencies : (k,) natural, increasing [rad/s]
    shapes : (n, k) over the coordinates of the whole structure, of unit modal mass
    held : (k - 1,) natural frequencies with the boundary held [rad/s]
    """

    frequencies: FloatArray
    shapes: FloatArray
    held: FloatArray


def reduced_modes(
    mass: FloatArray, stiffness: FloatArray, boundary: int, highest: float, *, floating: bool = False
) -> Modes:
    """Modes of what remains of a structure: the static shape of a boundary coordinate and modes with it held.

    Statics by forces on the boundary is kept exactly.

    Parameters
    ----------
    mass, stiffness : (n, n) symmetric
    boundary : the coordinate that forces act on
    highest : modes with the boundary held are kept up to this [rad/s]
    floating : whether nothing holds the structure but its boundary, so that its first mode is rigid
    """
    n = mass.shape[0]
    inner = np.delete(np.arange(n), boundary)
    k = stiffness[np.ix_(inner, inner)]
    squares, vectors = eigh(k, mass[np.ix_(inner, inner)], subset_by_value=(0.0, highest**2))
    basis = np.zeros((n, 1 + squares.size))
    basis[boundary, 0] = 1.0
    basis[inner, 0] = -np.linalg.solve(k, stiffness[inner, boundary])
    basis[inner, 1:] = vectors
    reduced = basis.T @ mass @ basis, basis.T @ stiffness @ basis
    # The boundary and the modes with it held do not work on each other.
    reduced[1][0, 1:] = reduced[1][1:, 0] = 0.0
    if floating:
        reduced[1][0, 0] = 0.0
    found, shapes = eigh(reduced[1], reduced[0])
    whole = basis @ shapes
    if floating:
        found[0] = 0.0
    signs = np.where(whole[boundary] < 0.0, -1.0, 1.0)
    return Modes(np.sqrt(np.maximum(found, 0.0)), whole * signs, np.sqrt(squares))
