"""Second-order systems with rank-one periodic feedback: the structure that the fast kernel exploits.

Sources: docs/theory/floquet.md, "Structure".
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import eigh

from floquet.engine.system import second_order
from lumped.display.result import DisplayedResult
from lumped.errors import refuse, shown
from lumped.typing import ComplexArray, FloatArray


@dataclass(frozen=True, eq=False)
class Gains:
    """Periodic gains on the pieces of one period; polynomials in powers of u in [-1, 1].

    Attributes
    ----------
    w, wd : (P, m, d+1) feedback of v . z [1/s^2] and of v . z' [1/s], lowest power first
    fit_errors : (P, 2) largest error of w and wd on each piece, norm sqrt(sum metric e^2)
    edge_errors : (P+1, 2) integral over the phase of what the errors of w and wd are beyond that next to
        each end of a piece, on either side; None: nothing
    """

    w: FloatArray
    wd: FloatArray
    fit_errors: FloatArray
    edge_errors: FloatArray | None = None


@dataclass(frozen=True, eq=False, repr=False)
class RankOneSystem(DisplayedResult):
    """z'' + (D + G/T) z' + L z + w(t) (v . z) + wd(t) (v . z') = 0, periodic w and wd, m coordinates.

    Attributes
    ----------
    stiffness, damping : (m, m) L [1/s^2], diag(g) L being symmetric, and D [1/s]
    v : (m,) how the coordinates feed back
    phases : (P+1,) ends of the pieces as parts of the period, switches among them
    gains : w and wd
    period : T [s]
    metric : (m,) positive weights g (masses): diag(g) makes the mean feedback symmetric as nearly as can
        be, so that the energy of the mean system measures errors well
    varied : one or more further sets of gains that a chart adds, each times a factor of its own for every
        point, as where the friction coefficient goes up and down with speed; the system by itself has them
        with factor 1
    gyroscopic : (m, m) G, dimensionless, of parts that turn by fixed angles within a period; None: nothing
    mean : (m,) mean of w whose modes are the coordinates; None: that over the phases
    """

    stiffness: FloatArray
    damping: FloatArray
    v: FloatArray
    phases: FloatArray
    gains: Gains
    period: float
    metric: FloatArray
    varied: tuple[Gains, ...] = ()
    gyroscopic: FloatArray | None = None
    mean: FloatArray | None = None

    @property
    def parts(self) -> tuple[Gains, ...]:
        """The gains whose sum acts."""
        return (self.gains, *self.varied)

    @cached_property
    def total(self) -> Gains:
        """The sum of the parts, each with factor 1."""
        w, wd = (stacked(self.parts, key).sum(axis=0) for key in ("w", "wd"))
        return Gains(w, wd, np.sum([part.fit_errors for part in self.parts], axis=0))

    def _state_matrices(self, w: FloatArray, wd: FloatArray) -> FloatArray:
        """A (..., 2m, 2m) of (z, z') with gains (..., m)."""
        C = self.damping if self.gyroscopic is None else self.damping + self.gyroscopic / self.period
        return second_order(self.stiffness + w[..., None] * self.v, C + wd[..., None] * self.v)

    def mean_exponents(self) -> ComplexArray:
        """Exponents (2m,) [1/s] of the system with gains averaged over the period."""
        A = self._state_matrices(self.mean_of(self.total.w), self.mean_of(self.total.wd))
        return np.asarray(np.linalg.eigvals(A), dtype=complex)

    def mean_of(self, poly: FloatArray) -> FloatArray:
        """Mean over the period of polynomials (P, m, d+1)."""
        powers = np.arange(poly.shape[2])
        moments = np.where(powers % 2 == 0, 1.0 / (powers + 1.0), 0.0)  # mean of u^j over [-1, 1]
        return np.asarray(np.einsum("p,pmj,j->m", np.diff(self.phases), poly, moments))

    def modal(self) -> ModalForm:
        """Return the system in modal coordinates of its time average, see `ModalForm`."""
        g = self.metric
        mean = self.mean_of(self.total.w) if self.mean is None else self.mean
        k = float(g @ (mean * self.v)) / float(self.v @ self.v) if (g * mean) @ self.v > 0 else 0.0
        K = g[:, None] * self.stiffness + k * np.outer(self.v, self.v)
        if not np.abs(K - K.T).max() <= 1e-9 * np.abs(K).max():
            raise refuse(
                "stiffness", shown(self.stiffness), "symmetric in the metric", "Use the general engine."
            )
        squares, Phi = eigh(K, np.diag(g))
        if squares.min() <= 0.0:
            allowed = "a mean system that is statically stable"
            raise refuse("stiffness", shown(self.stiffness), allowed, "Use the general engine.")
        inverse = Phi.T * g
        w, wd = (
            np.ascontiguousarray(np.einsum("ab,qpbj->qpaj", inverse, stacked(self.parts, key)))
            for key in ("w", "wd")
        )
        return ModalForm(
            omega=np.sqrt(squares),
            C=inverse @ self.damping @ Phi,
            gyroscopic=np.zeros_like(Phi) if self.gyroscopic is None else inverse @ self.gyroscopic @ Phi,
            v=Phi.T @ self.v,
            w=w,
            wd=wd,
            # The mean feedback k g^-1 v v^T is part of omega^2.
            reference=inverse @ (k * self.v / g),
            shapes=Phi,
        )


@dataclass(frozen=True, eq=False)
class ModalForm:
    """eta'' + (C + G/T) eta' + omega^2 eta + (w - reference) (v . eta) + wd (v . eta') = 0, z = shapes @ eta.

    In the states x = (omega eta, eta') the squared norm is twice the energy of the mean undamped
    frictionless system, the natural measure of errors.

    Attributes
    ----------
    omega : (m,) natural frequencies of that system [rad/s]
    C, gyroscopic : (m, m) damping of the supports [1/s], and G, dimensionless
    v : (m,) the deflection is v . eta
    w, wd : (Q, P, m, d+1) polynomials of the Q parts of `RankOneSystem.parts` on P pieces
    reference : (m,) constant part of w that omega^2 has already
    shapes : (m, m) modes of that system as columns, orthonormal in the metric
    """

    omega: FloatArray
    C: FloatArray
    gyroscopic: FloatArray
    v: FloatArray
    w: FloatArray
    wd: FloatArray
    reference: FloatArray
    shapes: FloatArray

    @property
    def drive(self) -> float:
        """Bound on the rate at which C lets energy grow [1/s]; 0 where all supports are damped."""
        return _drive(self.C)

    @property
    def gyroscopic_drive(self) -> float:
        """The same of G, dimensionless; 0 but for rounding where G does no work."""
        return _drive(self.gyroscopic)


def _drive(C: FloatArray) -> float:
    return max(0.0, -float(np.linalg.eigvalsh(0.5 * (C + C.T)).min()))


def padded(poly: FloatArray, count: int) -> FloatArray:
    """Polynomials (..., d+1), lowest power first, with zeros up to ``count`` coefficients."""
    return np.pad(poly, [(0, 0)] * (poly.ndim - 1) + [(0, count - poly.shape[-1])])


def trimmed(poly: FloatArray) -> FloatArray:
    """Polynomials (P, m, d+1) without the highest powers that are zero on all pieces."""
    used = np.flatnonzero(np.abs(poly).max(axis=(0, 1)))
    return np.ascontiguousarray(poly[:, :, : 1 + (int(used[-1]) if used.size else 0)])


def stacked(parts: tuple[Gains, ...], key: str) -> FloatArray:
    """The polynomials of all parts, of several degrees, as one array (Q, P, m, d+1)."""
    polys = [getattr(part, key) for part in parts]
    count = max(poly.shape[2] for poly in polys)
    return np.stack([padded(poly, count) for poly in polys])
