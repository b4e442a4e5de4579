"""Multipliers of many monodromy matrices, by the quick bound where it holds and else by the careful one.

Sources: docs/theory/proven_bounds.md, "Multipliers".
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from floquet.engine.kernels.eigenvalue_bounds import spectra
from floquet.engine.multipliers import multipliers_with_bounds
from lumped.typing import BoolArray, ComplexArray, FloatArray


@dataclass(frozen=True, eq=False)
class FastMultipliers:
    """Multipliers of N variants of one system.

    Attributes
    ----------
    multipliers, errors : (N, 2m) with a proven bound on the error of each, dimensionless, in no order
    """

    multipliers: ComplexArray
    errors: FloatArray


class QuickMultipliers(NamedTuple):
    """Eigenvalues of N matrices by the quick bound.

    Attributes
    ----------
    values, errors : (N, n) eigenvalues, and bounds on their errors
    safe : (N,) where the bounds hold
    """

    values: ComplexArray
    errors: FloatArray
    safe: BoolArray


def multipliers_of(matrices: FloatArray, errors: FloatArray) -> FastMultipliers:
    """Eigenvalues of monodromy matrices (N, n, n), each with a bound, when these are wrong by errors (N,)."""
    values, radii, safe = quick_multipliers(matrices, errors)
    for point in np.flatnonzero(~safe):
        values[point], radii[point] = multipliers_with_bounds(matrices[point], float(errors[point]))
    return FastMultipliers(values, radii)


def quick_multipliers(matrices: FloatArray, errors: FloatArray) -> QuickMultipliers:
    """Eigenvalues of matrices (N, n, n) that are wrong by errors (N,), and where their bounds hold."""
    values = np.empty(matrices.shape[:2], dtype=complex)
    radii = np.empty(matrices.shape[:2])
    safe = np.empty(errors.size, dtype=bool)
    spectra(matrices, errors, values, radii, safe)
    return QuickMultipliers(values, radii, safe)
