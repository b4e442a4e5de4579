"""Second-order systems with rank-one periodic feedback: the structure that the fast kernel exploits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.linalg import eigh

from floquet.system import FloatArray, PeriodicSystem
from lumped.errors import refuse


@dataclass(frozen=True, eq=False)
class RankOneSystem:
    """z'' + D z' + L z + w(t) (v . z) + wd(t) (v . z') = f, periodic w and wd, m <= 3 coordinates.

    Attributes
    ----------
    stiffness, damping : (m,) L [1/s^2] and D [1/s]
    v : (m,) how the coordinates feed back
    phases : (P+1,) ends of the pieces as parts of the period, switches among them
    w, wd : (P, m, d+1) polynomials on each piece in powers of u in [-1, 1], w [1/s^2], wd [1/s]
    forcing : (m,) constant f
    fit_errors : (P, 2) largest error of w and wd on each piece, norm sqrt(sum metric e^2)
    period : T [s]
    metric : (m,) positive weights g (masses): diag(g) makes the mean feedback symmetric as nearly as can
        be, so that the energy of the mean system measures errors well
    """

    stiffness: FloatArray
    damping: FloatArray
    v: FloatArray
    phases: FloatArray
    w: FloatArray
    wd: FloatArray
    forcing: FloatArray
    fit_errors: FloatArray
    period: float
    metric: FloatArray

    def to_periodic_system(self) -> PeriodicSystem:
        """Return the same system for the general engine, which checks the kernel independently."""
        m = self.v.size
        T = self.period

        def A(t: FloatArray) -> FloatArray:
            phase = t / T
            piece = np.clip(np.searchsorted(self.phases, phase, side="right") - 1, 0, self.phases.size - 2)
            low, high = self.phases[piece], self.phases[piece + 1]
            u = (2.0 * phase - low - high) / (high - low)
            out = np.zeros((t.size, 2 * m, 2 * m))
            out[:, :m, m:] = np.eye(m)
            out[:, m:, :m] = -np.diag(self.stiffness)
            out[:, m:, m:] = -np.diag(self.damping)
            out[:, m:, :m] -= _horner(self.w, piece, u)[:, :, None] * self.v
            out[:, m:, m:] -= _horner(self.wd, piece, u)[:, :, None] * self.v
            return out

        return PeriodicSystem(A, T, tuple(self.phases[1:-1] * T), vectorized=True)

    def modal(self) -> ModalForm:
        """Return the system in modal coordinates of its time average, see `ModalForm`."""
        g = self.metric
        widths = np.diff(self.phases)
        powers = np.arange(self.w.shape[2])
        moments = np.where(powers % 2 == 0, 1.0 / (powers + 1.0), 0.0)  # mean of u^j over [-1, 1]
        mean = np.einsum("p,pmj,j->m", widths, self.w, moments)
        k = float(g @ (mean * self.v)) / float(self.v @ self.v) if (g * mean) @ self.v > 0 else 0.0
        K = np.diag(g * self.stiffness) + k * np.outer(self.v, self.v)
        squares, Phi = eigh(K, np.diag(g))
        if squares.min() <= 0.0:
            raise refuse(
                "stiffness",
                self.stiffness,
                "a mean system that is statically stable",
                "Use the general engine.",
            )
        inverse = Phi.T * g
        # The reference feedback k g^-1 v v^T is part of omega^2; what is left of w stays time dependent.
        w = self.w.copy()
        w[:, :, 0] -= k * self.v / g
        return ModalForm(
            omega=np.sqrt(squares),
            C=inverse @ (self.damping[:, None] * Phi),
            v=Phi.T @ self.v,
            w=np.ascontiguousarray(np.einsum("ab,pbj->paj", inverse, w)),
            wd=np.ascontiguousarray(np.einsum("ab,pbj->paj", inverse, self.wd)),
            forcing=inverse @ self.forcing,
            shapes=Phi,
        )


@dataclass(frozen=True, eq=False)
class ModalForm:
    """eta'' + C eta' + omega^2 eta + w (v . eta) + wd (v . eta') = f with z = shapes @ eta.

    omega and shapes are the modes of the mean undamped frictionless system, orthonormal in the metric. In the
    states x = (omega eta, eta') the squared norm is twice the energy of that system, the natural measure of
    errors.
    """

    omega: FloatArray
    C: FloatArray
    v: FloatArray
    w: FloatArray
    wd: FloatArray
    forcing: FloatArray
    shapes: FloatArray

    def state_matrix(self) -> FloatArray:
        """Matrix (2m, 2m) that turns x = (omega eta, eta') into (z, z')."""
        m = self.omega.size
        out = np.zeros((2 * m, 2 * m))
        out[:m, :m] = self.shapes / self.omega
        out[m:, m:] = self.shapes
        return out


def _horner(poly: FloatArray, piece: npt.NDArray[np.intp], u: FloatArray) -> FloatArray:
    coefficients = poly[piece]
    value = np.zeros(coefficients.shape[:2])
    for j in range(coefficients.shape[2] - 1, -1, -1):
        value = value * u[:, None] + coefficients[:, :, j]
    return value
