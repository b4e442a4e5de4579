"""A gear mesh between two rotors that are given by their matrices, as finite elements of shafts make them.

The mesh adds k(t) v v^T to the stiffness and c(t) v v^T to the damping of both rotors side by side; v takes
from their coordinates how far the teeth approach each other along the line of action.

Sources: docs/theory/floquet.md, "A mesh between two rotors".
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError, block_diag, eigh

from floquet.engine.coefficients import PiecewisePolynomial
from floquet.engine.periodic_matrix import PeriodicMatrix, square
from floquet.engine.second_order import SecondOrderSystem, from_second_order
from lumped.arguments import of_type, real_number, whole_number
from lumped.errors import NumericalError, refuse
from lumped.model.mesh_cycle import MeshCycle, mesh_cycle
from lumped.path_function import PathFunction
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.typing import FloatArray

#: Energy of a motion over that of its parts below which it meets no spring: a turn of both gears together.
_FREE = 1e-9


@dataclass(frozen=True, eq=False)
class GearRotor:
    """A rotor at its running speed: M x'' + C x' + K x = 0, and where its gear sits.

    x and y are fixed directions across the shaft, the same for both rotors; rotation from x to y is positive.

    Attributes
    ----------
    M, C, K : (n, n) in SI units; gyroscopic parts belong to C, the inertia of the gear to M
    station : numbers, from 0, of the coordinates x [m], y [m] and rotation about the shaft [rad] of the gear

    Raises
    ------
    ParameterError : matrices of different shapes, or a station without three different coordinates
    """

    M: FloatArray
    C: FloatArray
    K: FloatArray
    station: tuple[int, int, int]

    def __post_init__(self) -> None:
        M = square("M", self.M)
        n = len(M)
        for name in ("M", "C", "K"):
            object.__setattr__(self, name, square(name, getattr(self, name), n))
        try:
            station = tuple(whole_number("station", k, 0, n - 1) for k in self.station)
        except TypeError:
            station = ()
        if len(set(station)) != 3:
            advice = "Name the coordinates x, y and rotation of the gear."
            raise refuse("station", self.station, f"three different numbers, 0 to {n - 1}", advice)


def gears_on_rotors(
    pair: AnyPair, pinion: GearRotor, gear: GearRotor, *, modes: int = 12, centre_angle: float = 0.0
) -> SecondOrderSystem:
    """Return two rotors joined by the mesh of a gear pair, over one mesh cycle.

    Of the pair it takes teeth, stiffness and damping of the mesh, and speed; bodies, shafts and bearings are
    those of the rotors. The pinion turns from x to y and drives; the gear's rotor must have been made for the
    opposite sense. Friction is left out.

    The system is reduced to the lowest modes of M and the mean of K. A free turn of both gears together,
    whose multipliers are 1 and tell nothing, is left out. Twice as many modes show what is missing.

    Parameters
    ----------
    pair : the gear pair, at the running speed
    pinion, gear : the rotors
    modes : how many to keep, at most those that there are
    centre_angle : direction from the pinion's centre to the gear's, from x to y [rad]

    Raises
    ------
    ParameterError : no rotors, or a mass matrix that is not symmetric and positive
    """
    pair = load_gear_pair(pair)
    for name, rotor in (("pinion", pinion), ("gear", gear)):
        of_type(name, rotor, GearRotor, "a GearRotor; of ROSS: validation.exchange.ross_rotor")
    modes = whole_number("modes", modes, 1, 1000)
    centre_angle = real_number("centre_angle", centre_angle, -10.0, 10.0, unit="rad")
    cycle = mesh_cycle(pair)
    v = _deflection(cycle, pinion, gear, centre_angle)
    M, C, K = (block_diag(getattr(pinion, name), getattr(gear, name)) for name in ("M", "C", "K"))
    T = _modes(M, C, K, v, cycle.mean_stiffness)[:, :modes]
    M, C, K = (T.T @ B @ T for B in (M, C, K))
    mesh = np.outer(v @ T, v @ T)
    k, c = (_over_time(cycle, law) for law in (cycle.elements.stiffness, cycle.elements.damping))
    return from_second_order(M, PeriodicMatrix(C, (c, mesh)), PeriodicMatrix(K, (k, mesh)), cycle.period)


def _deflection(cycle: MeshCycle, pinion: GearRotor, gear: GearRotor, centre_angle: float) -> FloatArray:
    """Row v: v.x is the approach of the flanks along the line of action [m].

    The pinion pushes along n, at right angles to the radius to its tangent point: (sin a, cos a) for a gear
    in the direction x, a the operating pressure angle.
    """
    g = cycle.geometry
    angle = 0.5 * np.pi - g.operating_pressure_angle + centre_angle
    n = np.array([np.cos(angle), np.sin(angle)])
    size = len(pinion.M)
    v = np.zeros(size + len(gear.M))
    v[list(pinion.station)] = [*n, g.base_radius_pinion]
    v[size + np.array(gear.station)] = [*-n, g.base_radius_gear]
    return v


def _modes(M: FloatArray, C: FloatArray, K: FloatArray, v: FloatArray, stiffness: float) -> FloatArray:
    """Modes with the mean mesh stiffness by rising frequency, mass-normalised, without free motions."""
    mean = K + stiffness * np.outer(v, v)
    if np.abs(M - M.T).max() > 1e-9 * np.abs(M).max():
        raise refuse("M", "unsymmetric", "a symmetric mass matrix", "Move what is not symmetric to C and K.")
    try:
        _, shapes = eigh(0.5 * (mean + mean.T), 0.5 * (M + M.T))
    except LinAlgError:
        advice = "Leave out coordinates without mass."
        raise refuse("M", "not positive definite", "a positive definite mass matrix", advice) from None
    parts = np.abs(mean) + np.abs(C)
    size = np.einsum("ij,ik,kj->j", np.abs(shapes), parts, np.abs(shapes))
    met = np.stack([np.abs(B @ shapes).max(axis=0) for B in (mean, mean.T, C, C.T)])
    met = np.einsum("aj,j->aj", met, np.abs(shapes).max(axis=0)).max(axis=0)
    kept = shapes[:, met > _FREE * size]
    if not kept.size:
        raise NumericalError("no motion of these rotors meets a spring. Check K and the units.")
    return np.asarray(kept)


def _over_time(cycle: MeshCycle, law: PathFunction) -> PiecewisePolynomial:
    """Sum of a law over all tooth pairs as polynomials of time."""
    edges, pitch = cycle.breaks, cycle.geometry.base_pitch
    rate = pitch / cycle.period
    middle = 0.5 * (edges[:-1] + edges[1:])
    degree = law.coefficients.shape[0] - 1
    rows = np.zeros((middle.size, degree + 1))
    for offset in cycle.offsets:
        at = offset + rate * middle
        inside = (at > law.breaks[0]) & (at < law.breaks[-1])
        piece = np.clip(np.searchsorted(law.breaks, at) - 1, 0, law.breaks.size - 2)
        x = offset + rate * edges[:-1] - law.breaks[piece]
        moved = law.coefficients[::-1, piece].T.copy()
        for j in range(degree):
            for i in range(degree - 1, j - 1, -1):
                moved[:, i] += x * moved[:, i + 1]
        rows += np.where(inside[:, None], moved * rate ** np.arange(degree + 1), 0.0)
    return PiecewisePolynomial(edges, rows)
