"""How multipliers change with parameters: exact first derivatives by left and right eigenvectors."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg

from floquet.engine.monodromy import monodromy
from floquet.engine.system import PeriodicSystem
from lumped.arguments import real_number
from lumped.errors import NumericalError
from lumped.typing import ComplexArray, FloatArray

Derivative = Callable[[FloatArray], FloatArray]
"""dA/dp at times strictly inside the smooth segments, (k,) -> (k, n, n)."""

# Beyond this an eigenvalue is so nearly defective that its derivative means nothing at the accuracy of M.
_CONDITION = 1e7


@dataclass(frozen=True, eq=False)
class MultiplierDerivatives:
    """First derivatives of the multipliers.

    Attributes
    ----------
    multipliers : (n,) complex, largest modulus first
    derivatives : (n,) complex, d multiplier/dp
    conditions : (n,) 1/|w^H v| >= 1 of unit left and right eigenvectors in balanced coordinates; infinite for
        a defective multiplier, which has no derivative
    """

    multipliers: ComplexArray
    derivatives: ComplexArray
    conditions: FloatArray

    @property
    def moduli(self) -> FloatArray:
        """Derivatives d |multiplier|/dp = Re(conj(multiplier) d multiplier/dp)/|multiplier|, (n,)."""
        return np.asarray((self.multipliers.conj() * self.derivatives).real / np.abs(self.multipliers))

    def radius(self) -> float:
        """Return d (spectral radius)/dp.

        Raises
        ------
        NumericalError : the largest multiplier is (nearly) defective
        """
        if self.conditions[0] > _CONDITION:
            raise NumericalError(
                "the largest multiplier is nearly defective, as at the edge of a tongue, where the spectral "
                "radius has no derivative. Move off the edge."
            )
        return float(self.moduli[0])


def multiplier_derivatives(
    system: PeriodicSystem, derivative: Derivative, rtol: float = 1e-10, *, magnitude: float = np.inf
) -> MultiplierDerivatives:
    """Derivatives of the multipliers with respect to a parameter on which A(t) depends smoothly.

    Phi' = A Phi and its derivative (dPhi)' = A dPhi + dA Phi together are a linear system of twice the size,
    with monodromy matrix [[M, 0], [dM, M]]: one event-aligned propagation gives dM as accurately as M. Then
    d lambda = w^H dM v/(w^H v) with the left and right eigenvectors w and v. Period and breakpoints must not
    depend on the parameter: scale time to the segments where they do, as `segment_time` does.

    Parameters
    ----------
    system : the system at the parameter
    derivative : dA/dp
    rtol : as in `monodromy`
    magnitude : size of the parameter, where dA/dp carries noise: a derivative smaller than rtol/100 over this
        size is not resolved, and noise is not mistaken for it
    """
    if not (isinstance(magnitude, float) and magnitude == np.inf):
        magnitude = real_number("magnitude", magnitude, 0.0, above=True)
    n = system.dimension
    probe = np.concatenate([system.edges[:-1] + f * np.diff(system.edges) for f in (0.25, 0.5, 0.75)])
    # The error of dM is relative to the larger of M and dM: bring dA to the size of A.
    size, weight = np.abs(system.evaluate(probe)).max(), np.abs(derivative(probe)).max()
    wanted = min(size / weight if weight > 0.0 else 1.0, 100.0 * magnitude)
    scale = float(2.0 ** np.round(np.log2(wanted)))

    def A(times: FloatArray) -> FloatArray:
        out = np.zeros((times.size, 2 * n, 2 * n))
        out[:, :n, :n] = out[:, n:, n:] = system.evaluate(times)
        out[:, n:, :n] = scale * derivative(times)
        return out

    double = PeriodicSystem(A, system.period, tuple(system.edges[1:-1]), vectorized=True)
    M = monodromy(double, rtol).matrix
    d = system.balancing()
    balance = d[None, :] / d[:, None]
    values, left, right = _eigenvectors(M[:n, :n] * balance)
    dM = M[n:, :n] * balance / scale
    overlap = np.einsum("ij,ij->j", left.conj(), right)
    with np.errstate(divide="ignore", invalid="ignore"):
        derivatives = np.einsum("ij,ik,kj->j", left.conj(), dM, right) / overlap
        conditions = 1.0 / np.abs(overlap)
    order = np.lexsort((-values.imag, -np.round(np.abs(values), 12)))
    return MultiplierDerivatives(values[order], derivatives[order], conditions[order])


def _eigenvectors(M: FloatArray) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """Eigenvalues (n,), left and right eigenvectors as unit columns (n, n)."""
    found: Any = scipy.linalg.eig(M, left=True, right=True)  # its stubs promise a pair
    values, left, right = found
    return values.astype(complex), left.astype(complex), right.astype(complex)


def segment_time(system: PeriodicSystem) -> PeriodicSystem:
    """Return the system with every smooth segment stretched to length one: same multipliers, fixed switches.

    With t = e_j + (s - j) h_j on segment j, dx/ds = h_j A(t(s)) x. Switches and period that move with a
    parameter become part of the coefficients, so the derivative with respect to it exists segment by segment.
    """
    edges = system.edges
    lengths = np.diff(edges)

    def A(s: FloatArray) -> FloatArray:
        j = np.clip(np.floor(s).astype(np.intp), 0, lengths.size - 1)
        times = edges[j] + (s - j) * lengths[j]
        inside = system.inside(times, edges[j], edges[j + 1])
        return system.evaluate(inside) * lengths[j][:, None, None]

    return PeriodicSystem(A, float(lengths.size), tuple(range(1, lengths.size)), vectorized=True)
