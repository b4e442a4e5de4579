"""How far the load of one tooth moves the next ones, by the elasticity of the gear body that they share.

The body is the ring of Sainsot, Velex and Duverger (2004): outside the root circle, clamped at a bore a
quarter as large, its twist taken off, as in the local part of the fillet foundation. A tooth loads it at its
foot by a force along its centre line, a force across it and a couple, spread evenly and linearly over the
foot; the motion of another foot is the work-conjugate mean, so that loads and motions are reciprocal. Fourier
series solve the ring exactly. Derivation: docs/theory/contact_energy.md, "Neighbours".
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache, partial

import numpy as np

from lumped.gear_geometry.geometry import Wheel
from lumped.path_function import PathFunction
from lumped.stiffness.base import Material, MeshingPair
from lumped.stiffness.foundation import LOCAL_RATIO
from lumped.typing import FloatArray

#: Harmonics of the ring; the terms fall as the third power of their order.
_HARMONICS = 1000
#: Of ``_ring``: row of order 1, column of the solution that is a logarithm there, and rows of the conditions
#: on both tractions at the rim.
_ORDER_ONE = 0
_LOGARITHM = 2
_RADIAL_AT_RIM, _TANGENTIAL_AT_RIM = 2, 3
#: Pairs are coupled this fraction of a base pitch beyond A and D too.
REACH = 0.45


def neighbour_compliances(pair: MeshingPair) -> tuple[PathFunction, ...]:
    """Motion of one tooth pair along the line of action by a unit load on another, both gears together.

    One function for every number m = 1, 2, ... of base pitches between two pairs that may touch together:
    w_m(xi) with the pair behind at xi and the one ahead at xi + m p_b [m/N].
    """
    g = pair.geometry

    def motion(apart: int, xi: FloatArray) -> FloatArray:
        distance = apart * g.base_pitch
        pinion = _moved(pair.wheels[0], pair.pinion, xi, apart, distance)
        gear = _moved(pair.wheels[1], pair.gear, g.L_XY - xi - distance, apart, distance)
        return (pinion + gear) / g.face_width

    return coupled_pairs(pair, motion)


def coupled_pairs(
    pair: MeshingPair, motion: Callable[[int, FloatArray], FloatArray]
) -> tuple[PathFunction, ...]:
    """Fit the functions w_m(xi) of ``neighbour_compliances`` for all m.

    Parameters
    ----------
    pair : the gear pair
    motion : smooth function (m, xi (n,)) -> w_m (n,) [m/N]; xi reaches beyond A and D
    """
    g = pair.geometry
    low = g.L_XA - REACH * g.base_pitch
    high = g.L_XD + REACH * g.base_pitch
    # Analytic and nearly constant: one polynomial for the whole path.
    return tuple(
        PathFunction.interpolated(partial(motion, apart), low, high - apart * g.base_pitch)
        for apart in range(1, math.floor((high - low) / g.base_pitch) + 1)
    )


def _moved(wheel: Wheel, material: Material, length: FloatArray, apart: int, distance: float) -> FloatArray:
    """Compliance times face width of a tooth loaded at flank lengths (n,) and one ahead, (n,) [m^2/N]."""
    tooth = wheel.tooth
    feet = foot_compliance(
        LOCAL_RATIO, material.poisson_ratio, tooth.root_half_angle, 2.0 * math.pi * apart / tooth.teeth
    )
    ratio = tooth.base_radius / tooth.root_radius
    behind, ahead = (
        foot_loads(flank_length / tooth.base_radius - tooth.base_half_angle, ratio, tooth.root_half_angle)
        for flank_length in (length, length + distance)
    )
    return np.asarray(np.einsum("ik,ij,jk->k", ahead, feet, behind) / material.youngs_modulus)


def foot_loads(angle: FloatArray, base_ratio: float, half_angle: float) -> FloatArray:
    """Forces across and along the centre line and couple at the foot of a tooth under a unit load; (3, n).

    ``angle`` (n,) is between the load and the normal to the centre line, ``base_ratio`` base over root
    radius, ``half_angle`` that of the tooth on the root circle.
    """
    # The mean of evenly spread forces lies at sin(t)/t root radii.
    lever = base_ratio / np.cos(angle) - math.sin(half_angle) / half_angle
    return np.asarray(-np.stack([np.cos(angle), np.sin(angle), np.cos(angle) * lever]))


@lru_cache(maxsize=64)
def foot_compliance(ratio: float, poisson: float, half_angle: float, apart: float) -> FloatArray:
    """Motions of a foot on the ring by unit loads at another, times Young's modulus and face width; (3, 3).

    Rows: displacements across and along the centre line, rotation. Columns: forces across and along it,
    couple; root radius 1. ``ratio`` is root over bore radius, ``half_angle`` that of a tooth on the root
    circle, ``apart`` the angle between the centre lines, positive towards the loaded flank. The matrix of
    -apart is the transpose.
    """
    n = np.arange(1.0, _HARMONICS + 1.0)
    t = half_angle

    def even(k: int) -> FloatArray:  # integral of cos(k x) cos(n x) over the foot
        return np.asarray(t * (np.sinc((n - k) * t / np.pi) + np.sinc((n + k) * t / np.pi)))

    def odd(k: int) -> FloatArray:
        return np.asarray(t * (np.sinc((n - k) * t / np.pi) - np.sinc((n + k) * t / np.pi)))

    couple = 0.5 / (t - math.sin(t) * math.cos(t))
    # Radial and tangential traction: sin and -cos for the forces across and the couple, else cos and sin.
    loads = np.array(
        [
            [odd(1) / (2.0 * t), -even(1) / (2.0 * t)],
            [even(1) / (2.0 * t), -odd(1) / (2.0 * t)],
            [-couple * odd(2), couple * (even(2) - even(0))],
        ]
    )
    work = np.einsum("ian,nab,jbn->ijn", loads, _ring(ratio, poisson), loads) / math.pi
    same = work @ np.cos(n * apart)
    other = work @ np.sin(n * apart)
    sine = np.array([1.0, 0.0, 1.0])  # whether the radial traction is odd
    sign = sine - sine[:, None]
    motion = np.where(sign == 0.0, same, sign * other)
    # The ring under an even pressure.
    inner = ratio**-2
    breathing = (1.0 - inner) * (1.0 - poisson**2) / ((1.0 + inner) + poisson * (1.0 - inner))
    motion[1, 1] += breathing * (math.sin(t) / t) ** 2 / (2.0 * math.pi)
    result = np.asarray(motion, dtype=np.float64)
    result.setflags(write=False)
    return result


def _ring(ratio: float, poisson: float) -> FloatArray:
    """Radial and tangential displacement of a ring's rim by tractions of every order n >= 1; (n, 2, 2).

    Root radius and E are 1; u_r and the radial traction go as cos(n x), u_t and the tangential one as
    sin(n x). In polar coordinates u_r = r^s cos, u_t = B r^s sin solve plane stress for s = n + 1, n - 1,
    1 - n, -n - 1; of order 1 the third is ln(r) cos, (D - ln(r)) sin.
    """
    plane = 1.0 / (1.0 - poisson**2)
    shear = 0.5 / (1.0 + poisson)
    inner = 1.0 / ratio
    n = np.arange(1.0, _HARMONICS + 1.0)[:, None]
    s = np.concatenate([n + 1.0, n - 1.0, 1.0 - n, -n - 1.0], axis=1)
    # Radial equilibrium: s sigma_r + n tau - sigma_t = 0.
    free = plane * (s * s - 1.0) - shear * n * n
    tied = plane * n * (poisson * s - 1.0) + shear * n * (s - 1.0)
    b = -free / tied
    radial = plane * (s + poisson * (1.0 + n * b))
    tangential = shear * ((s - 1.0) * b - n)
    reference = np.where(s >= 0.0, 1.0, inner)  # each solution is 1 at its larger end
    with np.errstate(under="ignore"):
        outside = (1.0 / reference) ** s
        inside = (inner / reference) ** s
    conditions = np.stack([inside, b * inside, radial * outside, tangential * outside], axis=1)
    rim = np.stack([outside, b * outside], axis=1)
    d = -(shear + poisson * plane) / (plane + shear)
    deep = math.log(ratio)
    conditions[_ORDER_ONE, :, _LOGARITHM] = [-deep, deep + d, plane * (1.0 + poisson * d), -shear * (1.0 + d)]
    rim[_ORDER_ONE, :, _LOGARITHM] = 0.0, d
    tractions = np.zeros((n.size, 4, 2))
    tractions[:, _RADIAL_AT_RIM, 0] = 1.0
    tractions[:, _TANGENTIAL_AT_RIM, 1] = 1.0
    return np.asarray(rim @ np.linalg.solve(conditions, tractions))
