"""Deflection of a gear body under the feet of its teeth, by a ring of plane stress.

The ring is solved order by order: displacements u_r cos(n x), u_t sin(n x) with polynomials in ln r minimise
the elastic energy (Ritz's method). The closed solutions of a ring are not used. A tooth loads the ring by
two forces and a couple at its foot, spread over an arc of the root circle evenly and linearly. All lengths in
this file are over the root radius, all moduli over Young's modulus.

Sources: P. Sainsot, P. Velex and O. Duverger (J. Mech. Des. 126 (2004) 748-752) for the body, the loads at
the foot and the polynomials; S. P. Timoshenko and J. N. Goodier, Theory of Elasticity, for strain and energy
in polar coordinates; docs/theory/elasticity.md, "What checks the stiffness of a pair".
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lumped.typing import ComplexArray, FloatArray

#: How the body is held. "clamped": the bore is fixed. "untwisted": the same, less the twist of the ring.
#: "free": the body's inertia balances the load, and a motion counts from the mean motion of the mass.
BodySupport = Literal["clamped", "untwisted", "free"]


class Body(NamedTuple):
    """A gear below its teeth.

    Attributes
    ----------
    support : how the body is held
    bore_ratio : root radius over bore radius
    poisson : Poisson's ratio in plane stress
    tooth_mass : mass of all teeth for an angle of one radian, over density and face width
    tooth_inertia : polar inertia of all teeth for an angle of one radian, over density and face width
    """

    support: BodySupport
    bore_ratio: float
    poisson: float
    tooth_mass: float = 0.0
    tooth_inertia: float = 0.0


class RimResponse(NamedTuple):
    """Radial and tangential motion of the rim by unit stresses on the rim.

    The radial parts go as cos(n x), the tangential parts as sin(n x); order 0 has both parts even.

    Attributes
    ----------
    solved : orders 0 to ``_SOLVED``, each a matrix (2, 2) of motions by stresses
    series : coefficients of 1/n, 1/n^2, ... for the orders above, each a matrix (2, 2)
    """

    solved: FloatArray
    series: FloatArray


#: Root over bore radius of the ring in the published polynomials and for a solid gear. A hole as small as
#: the second changes the motion of the rim by less than 1e-3.
PUBLISHED_RING = 4.0
SOLID = 40.0
#: Largest order of the Fourier series, times half the angle of a foot; the terms fall as 1/n^3.
_WAVES = 60.0
#: Up to this order the ring is solved. Above, its motions are a series in 1/n through the sampled orders.
_SOLVED = 40
_SAMPLED = np.array([50, 100, 200, 400])
#: Points over the radius. Displacements of order n fall by r^(n-1): nothing is left below depth/n in ln r.
_POINTS = 18
_DEPTH = 14.0
#: Points of the quadrature over the arc of a foot.
_ARC_POINTS = 96
#: A to F of each polynomial A/t^2 + B h^2 + C h/t + D/t + E h + F, t half the angle of the foot, h root over
#: bore radius, by Sainsot, Velex and Duverger (2004), table 1.
_POLYNOMIALS = {
    "L": (-5.574e-5, -1.9986e-3, -2.3015e-4, 4.7702e-3, 0.0271, 6.8045),
    "M": (60.111e-5, 28.100e-3, -83.431e-4, -9.9256e-3, 0.1624, 0.9086),
    "P": (-50.952e-5, 185.50e-3, 0.0538e-4, 53.300e-3, 0.2895, 0.9236),
    "Q": (-6.2042e-5, 9.0889e-3, -4.0964e-4, 7.8297e-3, -0.1472, 0.6904),
}


def published_deflection(
    half_angle: float, bore_ratio: float, lever: FloatArray, load_angle: FloatArray
) -> FloatArray:
    """Deflection of a foot by the published polynomials, bore clamped, twist of the ring included.

    ``lever`` is the height above the root circle at which the line of the load crosses the middle of the
    tooth, ``load_angle`` the angle of the load [rad].
    """
    values = {}
    for name, (a, b, c, d, e, f) in _POLYNOMIALS.items():
        constant = a / half_angle**2 + d / half_angle + f
        values[name] = constant + bore_ratio * (b * bore_ratio + c / half_angle + e)
    ratio = lever / (2.0 * half_angle)
    cosine = np.cos(load_angle)
    bent = (values["L"] * ratio + values["M"]) * ratio * cosine**2
    pushed = values["P"] * (cosine**2 + values["Q"] * np.sin(load_angle) ** 2)
    return np.asarray(bent + pushed, dtype=np.float64)


def ring_twist(bore_ratio: float, poisson: float, lever: float) -> float:
    """Twist of a ring with a clamped bore, as motion at a lever under a unit force at the same lever.

    The shear stress M/(2 pi r^2) over the shear modulus, integrated over the radius, is the angle.
    """
    shear_modulus = 0.5 / (1.0 + poisson)
    return lever**2 * (bore_ratio**2 - 1.0) / (4.0 * math.pi * shear_modulus)


def foot_forces(load_angle: FloatArray, base_radius: float, half_angle: float) -> FloatArray:
    """Force across the tooth, force along the tooth and couple at its foot by a unit load; (3, n).

    ``load_angle`` is the angle between the load and the normal of the tooth's middle [rad]. The load pushes
    across the tooth and towards the root. Its line passes the gear's centre at the base radius. The couple is
    about the mean place of the evenly spread forces, which the bulge of the arc puts below the root circle.
    """
    mean_place = math.sin(half_angle) / half_angle
    across = -np.cos(load_angle)
    along = -np.sin(load_angle)
    couple = -base_radius - across * mean_place
    return np.asarray(np.stack([across, along, couple]), dtype=np.float64)


@lru_cache(maxsize=64)
def foot_motions(body: Body, half_angle: float, apart: float) -> FloatArray:
    """Motions of a foot by unit loads at the foot of another tooth; (3, 3), ordered as in ``foot_forces``.

    ``half_angle`` is half the angle of a foot, ``apart`` the angle between both teeth [rad]; 0 for the loaded
    foot. The motions are the weighted means that do the work of the loads.
    """
    stresses = _foot_stresses(half_angle)
    orders = np.arange(stresses.shape[2])
    response = _all_orders(rim_response(body), orders.size)
    # A stress exp(i n x) is the stress of order n with its tangential part turned by a quarter wave.
    quarter = np.array([1.0, 1j])
    waves = quarter.conj()[:, None] * response * quarter
    weights = np.where(orders == 0, 1.0, 2.0) / (2.0 * math.pi)  # orders n and -n are conjugates
    response_ahead = waves * (weights * np.exp(1j * orders * apart))[:, None, None]
    displacements = np.einsum("nab,jbn->jan", response_ahead, stresses)
    work = np.einsum("ian,jan->ij", stresses.conj(), displacements, optimize=True)
    motions = np.array(work.real, dtype=np.float64)
    motions.setflags(write=False)
    return motions


def _all_orders(response: RimResponse, count: int) -> FloatArray:
    """Motions of the rim for the orders 0, 1, ...; (count, 2, 2)."""
    above = np.arange(_SOLVED + 1, max(count, _SOLVED + 1), dtype=np.float64)
    powers = above[:, None] ** -np.arange(1.0, 1.0 + _SAMPLED.size)
    series = np.tensordot(powers, response.series, axes=1)
    return np.asarray(np.concatenate([response.solved, series])[:count], dtype=np.float64)


@lru_cache(maxsize=16)
def _foot_stresses(half_angle: float) -> ComplexArray:
    """Fourier integrals of the radial and tangential stress of three unit loads at a foot; (3, 2, n).

    The angle counts in the sense of the force across the tooth.
    """
    nodes, weights = np.polynomial.legendre.leggauss(_ARC_POINTS)
    angle = half_angle * nodes
    weights = half_angle * weights
    even = np.full(angle.shape, 0.5 / half_angle)
    across = np.sin(angle)  # distance of a point of the foot from the middle of the tooth
    linear = -across / (weights @ across**2)  # stress along the tooth of a unit couple
    radial = np.stack([even * np.sin(angle), even * np.cos(angle), linear * np.cos(angle)])
    tangential = np.stack([even * np.cos(angle), -even * np.sin(angle), -linear * np.sin(angle)])
    orders = np.arange(math.ceil(_WAVES / half_angle))
    waves = np.exp(-1j * np.outer(angle, orders)) * weights[:, None]
    return np.stack([radial @ waves, tangential @ waves], axis=1)


@lru_cache(maxsize=16)
def rim_response(body: Body) -> RimResponse:
    """Solve the ring of a body."""
    ring_depth = math.log(body.bore_ratio)
    orders = np.concatenate([np.arange(1, _SOLVED + 1), _SAMPLED])
    depth = np.minimum(ring_depth, _DEPTH / orders)
    # The inner end is held, or so deep that nothing is left there.
    clamped = (depth < ring_depth) | (body.support != "free")
    motions = np.zeros((orders.size, 2, 2))
    motions[clamped] = _held_rim(_energy(orders[clamped], depth[clamped], body.poisson))
    for place in np.flatnonzero(~clamped).tolist():
        motions[place] = _free_rim(int(orders[place]), float(depth[place]), body)
    powers = _SAMPLED[:, None] ** -np.arange(1.0, 1.0 + _SAMPLED.size)
    series = np.linalg.solve(powers, motions[_SOLVED:].reshape(_SAMPLED.size, 4)).reshape(-1, 2, 2)
    solved = np.concatenate([_even_motions(body)[None], motions[:_SOLVED]])
    return RimResponse(solved, series)


def _even_motions(body: Body) -> FloatArray:
    """Motions of order 0: an even pressure widens the ring, an even shear stress twists the ring; (2, 2)."""
    depth = math.log(body.bore_ratio)
    if body.support == "free":
        return _free_rim(0, depth, body)
    motions = _held_rim(_energy(np.array([0]), np.array([depth]), body.poisson))[0]
    if body.support == "untwisted":
        motions[1, 1] = 0.0
    return np.asarray(motions, dtype=np.float64)


def _energy(orders: NDArray[np.int64], depth: FloatArray, poisson: float) -> FloatArray:
    """Twice the elastic energy as a matrix of the displacements at the points; (orders, 2 points, 2 points).

    Over s = ln r the strains times r are u_r', u_r + n u_t and u_t' - u_t - n u_r, so the energy of a ring
    has constant coefficients. The points of u_r come first, then those of u_t; the last point is the rim.
    """
    rule = _radius_rule()
    n = orders[:, None, None].astype(np.float64)
    derivative = rule.slope * (2.0 / depth)[:, None, None]
    weight = rule.product * (0.5 * depth)[:, None, None]
    identity = np.eye(_POINTS)
    zero = np.zeros_like(derivative)
    radial = np.concatenate([derivative, zero], axis=2)
    hoop = np.concatenate([identity + zero, n * identity], axis=2)
    sheared = np.concatenate([-n * identity, derivative - identity], axis=2)

    def product(one: FloatArray, other: FloatArray) -> FloatArray:
        return np.asarray(np.swapaxes(one, 1, 2) @ (weight @ other), dtype=np.float64)

    normal_modulus = 1.0 / (1.0 - poisson**2)
    shear_modulus = 0.5 / (1.0 + poisson)
    mixed = product(radial, hoop)
    matrix = product(radial, radial) + product(hoop, hoop) + poisson * (mixed + np.swapaxes(mixed, 1, 2))
    matrix = normal_modulus * matrix + shear_modulus * product(sheared, sheared)
    return np.asarray(matrix, dtype=np.float64)


def _held_rim(energy: FloatArray) -> FloatArray:
    """Motions of the rim (orders, 2, 2) by unit stresses on the rim, the inner end held."""
    moving = np.delete(np.arange(2 * _POINTS), [0, _POINTS])
    rim = [_POINTS - 2, 2 * _POINTS - 3]
    loads = np.zeros((len(energy), moving.size, 2))
    loads[:, rim, [0, 1]] = 1.0
    solved = np.linalg.solve(energy[:, moving[:, None], moving], loads)
    return np.asarray(solved[:, rim], dtype=np.float64)


def _free_rim(order: int, depth: float, body: Body) -> FloatArray:
    """Motions of the rim (2, 2) by unit stresses on the rim, the inner end free.

    Orders 0 and 1 turn and move the whole gear: the inertia of body and teeth balances the load, and the
    motion is without the mean motion of this mass. The teeth move with the rim.
    """
    matrix = _energy(np.array([order]), np.array([depth]), body.poisson)[0]
    rim = [_POINTS - 1, 2 * _POINTS - 1]
    loads = np.zeros((2 * _POINTS, 2))
    loads[rim, [0, 1]] = 1.0
    if order <= 1:
        rule = _radius_rule()
        radius = np.exp(0.5 * depth * (rule.nodes - 1.0))
        mass = np.kron(np.eye(2), 0.5 * depth * rule.product * radius**2)
        mass[rim, rim] += body.tooth_inertia if order == 0 else body.tooth_mass
        still = np.zeros(_POINTS)
        even = np.ones(_POINTS)
        rigid = np.concatenate([still, radius] if order == 0 else [even, -even])
        inertia = (mass @ rigid)[:, None]
        matrix = np.block([[matrix, inertia], [inertia.T, np.zeros((1, 1))]])
        loads = np.concatenate([loads, np.zeros((1, 2))])
    return np.asarray(np.linalg.solve(matrix, loads)[rim], dtype=np.float64)


class RadiusRule(NamedTuple):
    """Polynomials through Chebyshev's extreme points from -1, the inner end, to 1, the rim.

    Attributes
    ----------
    nodes : the points
    slope : matrix of the derivative at the points
    product : matrix of the integral of the product of two polynomials
    """

    nodes: FloatArray
    slope: FloatArray
    product: FloatArray


@lru_cache(maxsize=1)
def _radius_rule() -> RadiusRule:
    """Polynomials by their values at the points, from Legendre's series."""
    legendre = np.polynomial.legendre
    nodes = -np.cos(np.pi * np.arange(_POINTS) / (_POINTS - 1))
    gauss, weights = legendre.leggauss(_POINTS + 1)
    series = legendre.legvander(nodes, _POINTS - 1)
    rates = np.stack([legendre.legval(nodes, legendre.legder(row)) for row in np.eye(_POINTS)], axis=1)
    values = np.linalg.solve(series.T, legendre.legvander(gauss, _POINTS - 1).T).T
    slope = np.linalg.solve(series.T, rates.T).T
    product = values.T @ (weights[:, None] * values)
    return RadiusRule(nodes, np.asarray(slope, dtype=np.float64), np.asarray(product, dtype=np.float64))
