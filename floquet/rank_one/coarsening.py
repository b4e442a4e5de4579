"""Fewer polynomial pieces for the same flow: gains replaced by ones with the same moments.

What a gain does within a short time depends on its first few moments only, not on its shape. With delta = w -
w~ the flows over a piece differ by

    int Phi(1, u) dA(u) Phi~(u, -1) du,   dA = delta times a fixed row,

and if delta is orthogonal to all polynomials up to degree d, then to first order only that part of K(u) =
Phi~(1, u) . Phi~(u, -1) contributes which no such polynomial matches. A logarithm at the pitch point then
needs no graded mesh: the mesh only has to be fine against the motion. K is an entire function of u. With a_j
the majorant of A~ about the middle of the piece (`floquet.rank_one.kernels.majorant`) and e^g a bound on the
growth of energy, |K| <= e^g exp(2 sum_j a_j R^(j+1)/(j+1)) on the ellipse of Bernstein with semi-axis R =
(rho + 1/rho)/2, so that (Trefethen, Approximation Theory and Approximation Practice, theorem 8.2) its
distance from degree d is at most

    2 e^g exp(2 sum_j a_j R^(j+1)/(j+1)) rho^-d/(rho - 1)   for every rho > 1.

Terms of second order are at most e^(g + eta) eta^2/2, eta the integral of |dA|.

Sources: docs/theory/floquet.md, "Computing M".
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from numpy.polynomial import legendre

from floquet.rank_one.system import Coarsening, Gains, RankOneSystem, padded, trimmed
from lumped.arguments import real_number, real_numbers
from lumped.errors import refuse, shown
from lumped.typing import FloatArray

_U = 0.5 * float(np.finfo(np.float64).eps)
_DEGREE = 8
_RHO = np.array([1.3, 1.6, 2.0, 2.5, 3.0, 4.0, 5.5, 8.0, 12.0, 20.0, 40.0])
_R = 0.5 * (_RHO + 1.0 / _RHO)
# Sums over j of a_j R^(j+1)/(j+1), one row per rho.
_ELLIPSE = _R[:, None] ** np.arange(1, _DEGREE + 2) / np.arange(1, _DEGREE + 2)
_DECAY = 2.0 * _RHO[:, None] ** -np.arange(_DEGREE + 1.0) / (_RHO[:, None] - 1.0)  # (rho, d)
_NODES, _WEIGHTS = legendre.leggauss(_DEGREE + 1)  # exact for the square of a polynomial of degree 8
_SHORT = 1.0 / 16.0  # of the period: shorter pieces may err as much as this one


def coarsened(
    system: RankOneSystem, longest: float, damping: float, factors: npt.ArrayLike, tolerance: float
) -> RankOneSystem:
    """Join pieces of a system as far as its flow allows.

    Parameters
    ----------
    system : with polynomials of degree 8 at most
    longest : longest period [s] for which the bounds are to hold
    damping : largest factor on wd
    factors : (Q-1,) largest |factor| on each varied part
    tolerance : wanted sum of the bounds on the errors of the flow over the pieces, energy norm; met where the
        errors of the given polynomials allow it

    Returns
    -------
    The system with the bounds as its `Coarsening`
    """
    longest = real_number("longest", longest, 0.0, above=True, unit="s")
    damping = real_number("damping", damping, 0.0)
    tolerance = real_number("tolerance", tolerance, 0.0, above=True)
    varied = real_numbers("factors", factors, 0.0) if np.size(factors) else np.empty(0)
    if varied.size != len(system.parts) - 1:
        raise refuse(
            "factors", shown(factors), f"{len(system.parts) - 1} numbers", "Give one for each varied part."
        )
    most = np.concatenate([[1.0], varied])
    given = _given(system)
    search = _Search.of(given, longest, damping, most)
    bounds, pieces = [0], []
    while bounds[-1] < system.phases.size - 1:
        piece = search.longest_piece(bounds[-1], tolerance)
        pieces.append(piece)
        bounds.append(piece.stop)
    m, Q = system.v.size, len(system.parts)
    powers = np.stack([piece.powers for piece in pieces]).reshape(len(pieces), 2, Q, m, _DEGREE + 1)
    misfits = np.stack([piece.misfits for piece in pieces])
    parts = [
        Gains(trimmed(powers[:, 0, q]), trimmed(powers[:, 1, q]), misfits[:, :, q], given.edges[bounds, :, q])
        for q in range(Q)
    ]
    return replace(
        system,
        phases=system.phases[bounds],
        gains=parts[0],
        varied=tuple(parts[1:]),
        coarsening=Coarsening(np.array([piece.error for piece in pieces]), longest, damping, most[1:]),
    )


class _Piece(NamedTuple):
    stop: int
    powers: FloatArray  # (2, Q, m, d+1) of w and wd
    misfits: FloatArray  # (2, Q) left to the kernel to account for
    error: float


class _Merged(NamedTuple):
    """Several of the given pieces as one, whatever the period; the axes (2, Q) are w and wd of all parts.

    Attributes
    ----------
    series : (d+1, 2, Q, m) Legendre coefficients: the moments
    powers : (2, Q, m, d+1) the same in powers
    sizes : (d+1, 2, Q) their norms
    missing : (d+1, 2, Q) mean moduli of what is missing at each degree, at most
    misfit : (2, Q) integral over the phase of the errors of the given pieces
    rounding : (2, Q) rounding of a moment
    """

    series: FloatArray
    powers: FloatArray
    sizes: FloatArray
    missing: FloatArray
    misfit: FloatArray
    rounding: FloatArray


class _Given:
    """The given pieces, as the search for longer ones needs them, and those tried so far.

    Attributes
    ----------
    form : modal form of the system
    phases : (P+1,)
    powers : (P, 2, Q, m, d+1) of w and wd
    values : (P, s, 2, Q, m) at Gauss nodes
    misfits, edges : (P, 2, Q), (P+1, 2, Q) fit and edge errors of the given pieces
    root : (m,) square roots of the metric
    """

    def __init__(self, system: RankOneSystem) -> None:
        self.form, self.phases, self.root = system.modal(), system.phases, np.sqrt(system.metric)
        self.powers = np.stack(
            [
                np.stack([padded(getattr(part, key), _DEGREE + 1) for part in system.parts], axis=1)
                for key in ("w", "wd")
            ],
            axis=1,
        )
        self.values = np.einsum("ijqmk,sk->isjqm", self.powers, _NODES[:, None] ** np.arange(_DEGREE + 1))
        self.misfits = np.stack([part.fit_errors for part in system.parts], axis=2)
        none = np.zeros((system.phases.size, 2))
        edges = [none if part.edge_errors is None else part.edge_errors for part in system.parts]
        self.edges = np.stack(edges, axis=2)
        self._merged: dict[tuple[int, int], _Merged] = {}

    def merged(self, start: int, stop: int) -> _Merged:
        """Pieces from ``start`` to ``stop`` as one; the same for every period."""
        found = self._merged.get((start, stop))
        if found is None:
            found = self._merged[start, stop] = self._merge(start, stop)
        return found

    def _merge(self, start: int, stop: int) -> _Merged:
        low, high = self.phases[start], self.phases[stop]
        length = high - low
        widths = np.diff(self.phases[start : stop + 1])
        middles = 0.5 * (self.phases[start:stop] + self.phases[start + 1 : stop + 1])
        u = (2.0 * (middles[:, None] + 0.5 * widths[:, None] * _NODES) - low - high) / length
        weight = (widths / length)[:, None] * 0.5 * _WEIGHTS  # they sum to one
        P = legendre.legvander(u.ravel(), _DEGREE)
        values = self.values[start:stop].reshape(u.size, -1)
        flat = (2.0 * np.arange(_DEGREE + 1) + 1.0)[:, None] * ((P * weight.reshape(-1, 1)).T @ values)
        series = flat.reshape(_DEGREE + 1, *self.values.shape[2:])
        # The mean square over the piece bounds the square of the mean modulus. What is missing at degree d is
        # the rest beyond degree 8 and the terms between.
        rest = np.square((values - P @ flat).reshape(u.size, *series.shape[1:]) * self.root).sum(axis=3)
        beyond = np.einsum("s,sjq->jq", weight.ravel(), rest)
        squares = np.square(series * self.root).sum(axis=3)
        terms = squares / (2.0 * np.arange(_DEGREE + 1) + 1.0)[:, None, None]
        missing = beyond + np.concatenate(
            [np.cumsum(terms[:0:-1], axis=0)[::-1], np.zeros((1, *beyond.shape))]
        )
        # At an edge that goes, both sides count.
        lost = (widths[:, None, None] * self.misfits[start:stop]).sum(axis=0)
        # Rounding of the moments and of the places of the nodes in the piece.
        squared = (np.square(values).reshape(u.size, *series.shape[1:]) * self.root**2).sum(axis=3)
        return _Merged(
            series=series,
            powers=np.einsum("kd,djqm->jqmk", _POWERS, series),
            sizes=np.sqrt(squares),
            missing=np.sqrt(missing),
            misfit=lost + 2.0 * self.edges[start + 1 : stop].sum(axis=0),
            rounding=_U * (u.size + 40.0 + 300.0 / length) * np.sqrt(squared.max(axis=0)),
        )


@lru_cache(maxsize=4)
def _given(system: RankOneSystem) -> _Given:
    """Kept, since the bands of a chart join the pieces of one system."""
    return _Given(system)


class _Search(NamedTuple):
    """The search for longer pieces, for all periods up to one.

    Attributes
    ----------
    given : the pieces
    weights : (2, Q) what turns the norm of a gain into that of A times the longest period
    reference : (m,) constant part of w that is none of A's
    calm, drive : max omega + |C| + |G|/T, and how fast these let energy grow, times the longest period
    """

    given: _Given
    weights: FloatArray
    reference: FloatArray
    calm: float
    drive: float

    @classmethod
    def of(cls, given: _Given, longest: float, damping: float, most: FloatArray) -> _Search:
        form = given.form
        rows = np.array([np.linalg.norm(form.v / form.omega), damping * np.linalg.norm(form.v)])
        return cls(
            given=given,
            weights=longest * rows[:, None] * most,
            reference=form.shapes @ form.reference,
            calm=longest * float(form.omega.max() + np.linalg.norm(form.C))
            + float(np.linalg.norm(form.gyroscopic)),
            drive=longest * form.drive + form.gyroscopic_drive,
        )

    def longest_piece(self, start: int, tolerance: float) -> _Piece:
        """Join as many pieces from ``start`` on as the tolerance allows: by doubling, then by bisection."""
        given, pieces, step = self.given, self.given.phases.size - 1, 1
        best, bad = _Piece(start + 1, given.powers[start], given.misfits[start], 0.0), pieces + 1
        while best.stop < pieces and best.stop + 1 < bad:
            stop = min(best.stop + step, pieces) if bad > pieces else (best.stop + bad) // 2
            piece = self._joined(start, stop, tolerance)
            if piece is None:
                bad = stop
            else:
                best, step = piece, 2 * step
        return best

    def _joined(self, start: int, stop: int, tolerance: float) -> _Piece | None:
        """One piece in place of several, of the smallest degree that will do; None where none will."""
        one, length = self.given.merged(start, stop), self.given.phases[stop] - self.given.phases[start]
        eta = length * (one.missing * self.weights).sum(axis=(1, 2))  # (d,)
        misfit = float((one.misfit * self.weights).sum())
        allowed = tolerance * max(length, _SHORT)
        for degree in np.flatnonzero(self._errors(one.powers, length, eta, misfit) <= allowed):
            # Rounding of the moments and of the change to powers.
            rounding = (2.0 * np.arange(degree + 1) + 1.0).sum() * one.rounding
            change = np.abs(_POWERS).sum(axis=0)[: degree + 1]
            rounding += 16.0 * _U * np.einsum("d,djq->jq", change, one.sizes[: degree + 1])
            # The bound is that of the polynomials that are kept, of this degree.
            kept = np.einsum("kd,djqm->jqmk", _POWERS[:, : degree + 1], one.series[: degree + 1])
            missed = eta + length * float((rounding * self.weights).sum())
            error = self._errors(kept, length, missed, misfit)[degree]
            if error <= allowed:
                return _Piece(stop, kept, rounding, float(error) * (1.0 + 1e-9))
        return None

    def _errors(self, powers: FloatArray, length: float, eta: FloatArray, misfit: float) -> FloatArray:
        """Bounds (d,) on the change of the flow over a piece that these polynomials make, by their degree."""
        a = 0.5 * length * self._majorant(powers)
        with np.errstate(over="ignore", invalid="ignore"):  # what is not finite is no good
            growth = np.exp(2.0 * a.sum() - length * (self.calm - self.drive))
            distance = (np.exp(2.0 * _ELLIPSE @ a)[:, None] * _DECAY).min(axis=0)
            first, second = np.minimum(distance, 1.0) * eta, 0.5 * np.exp(eta) * eta**2
            return np.asarray(growth * (first + second + np.exp(eta + misfit) * misfit))

    def _majorant(self, powers: FloatArray) -> FloatArray:
        """Bounds (d+1,) on the coefficients of A in powers of u, times the longest period."""
        centred = powers.copy()
        centred[0, 0, :, 0] -= self.reference
        norms = np.sqrt(np.square(centred * self.given.root[:, None]).sum(axis=2))  # (2, Q, d+1)
        a = np.einsum("jq,jqk->k", self.weights, norms)
        a[0] += self.calm
        return np.asarray(a)


def _power_matrix() -> FloatArray:
    """Column n: the Legendre polynomial P_n in powers, lowest first."""
    matrix = np.zeros((_DEGREE + 1, _DEGREE + 1))
    for n in range(_DEGREE + 1):
        poly = legendre.leg2poly(np.eye(_DEGREE + 1)[n])
        matrix[: poly.size, n] = poly
    return matrix


_POWERS = _power_matrix()
