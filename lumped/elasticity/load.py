"""A load on a flank as a right-hand side for finite elements, without the singularity of the load.

The displacement is u = chi(r) u_F + u_c, where u_F is Flamant's solution for a line load on a half plane and
chi falls from 1 to 0 around the load. The rest u_c is smooth. For every motion v

    a(u_c, v) = -int chi s_F n.v ds + int (s_F grad chi).v dA - int C sym(grad chi x u_F) : e(v) dA,

the first over the surface of the tooth, which is no half plane, the others where chi falls. Young's modulus,
load and thickness are 1, lengths are in modules. Sources: K. L. Johnson, Contact Mechanics (1985), eq.
(2.23) for u_F; docs/theory/elasticity.md for the rest.
"""

from __future__ import annotations

import math

import numpy as np

from lumped.elasticity.elements import line_shapes, plane_law
from lumped.elasticity.sector import SPREAD_POINTS, Sector
from lumped.typing import FloatArray

#: Radii between which chi falls [modules].
NEAR = 0.15
FAR = 1.1


def flank_load(
    mesh: Sector, poisson: float, length: float, radii: tuple[float, float] = (NEAR, FAR)
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Right-hand side of u_c for a unit load into the tooth at a length along the base tangent [modules].

    chi falls between ``radii`` [modules]; the outer one ends at the cut to the next pitch at the latest.
    Returned are the loads (2 n,), the vector (2 n,) that reads the displacement at the point along the load,
    and the integrals (3,) of chi u_F along x, along y and times the lever about 0.
    """
    edge, shapes, point, normal = mesh.edge_at(length)
    reading = np.zeros(2 * len(mesh.nodes))
    reading[2 * edge] = shapes * normal[0]
    reading[2 * edge + 1] = shapes * normal[1]
    near = radii[0]
    far = outer_radius(mesh, point, radii[1])
    distance = np.hypot(*(mesh.nodes - point).T)
    load = np.zeros_like(reading)

    edges = mesh.surface[(distance[mesh.surface] < far).any(axis=1)]
    s, w = np.polynomial.legendre.leggauss(SPREAD_POINTS)
    values, slopes = line_shapes(s)
    places, along = (np.einsum("pk,ekc->epc", each, mesh.nodes[edges]) for each in (values, slopes))
    _, stress, chi, _ = flamant(places - point, normal, poisson, near, far)
    outward = np.stack([along[..., 1], -along[..., 0]], axis=-1)  # times the length of the edge
    traction = (chi * w)[..., None] * np.einsum("epcd,epd->epc", stress, outward)
    _add(load, edges, -np.einsum("epc,pk->ekc", traction, values))

    near_by = (distance[mesh.elements] < far).any(axis=1)
    elements = mesh.elements[near_by]
    square = mesh.quadrature.shapes
    places, gradient, area = (part[near_by] for part in mesh.quadrature[1:])
    displacement, stress, chi, fall = flamant(places - point, normal, poisson, near, far)
    force = (stress @ fall[..., None])[..., 0] * area[..., None]
    fall_x, fall_y = np.moveaxis(fall, -1, 0)
    x, y = np.moveaxis(displacement, -1, 0)
    strain = np.stack([fall_x * x, fall_y * y, fall_x * y + fall_y * x], -1)
    cut = np.swapaxes(strain @ plane_law(poisson) * area[..., None], 1, 2)
    for axis, rows in ((0, [0, 2]), (1, [2, 1])):  # of the symmetric tensor xx, yy, xy
        spread = force[..., axis] @ square - (cut[:, rows, None] @ gradient)[:, :, 0].sum(axis=1)
        np.add.at(load, 2 * elements + axis, spread)

    # Quadrature leaves force and moment off by some 1e-4, which the twist of a small bore would multiply.
    rigid, even = (np.zeros((len(mesh.nodes), 2, 3)) for _ in range(2))
    along_x, along_y, rotation = range(3)
    rigid[:, 0, along_x] = 1.0
    rigid[:, 1, along_y] = 1.0
    rigid[:, 0, rotation] = -mesh.nodes[:, 1]
    rigid[:, 1, rotation] = mesh.nodes[:, 0]
    a, b = np.moveaxis(places, -1, 0)
    for axis, motion, field in ((0, 0, area), (1, 1, area), (0, 2, -b * area), (1, 2, a * area)):
        np.add.at(even[:, axis, motion], elements, field @ square)
    motions = rigid.reshape(-1, 3)
    forces = even.reshape(-1, 3)
    load += forces @ np.linalg.solve(motions.T @ forces, motions.T @ (reading - load))
    cut_off = chi * area
    integrals = np.array([(cut_off * x).sum(), (cut_off * y).sum(), (cut_off * (a * y - b * x)).sum()])
    return load, reading, integrals


def outer_radius(mesh: Sector, point: FloatArray, far: float) -> float:
    """Radius around a point at which chi is zero: ``far``, or less near the next pitch [modules]."""
    across = math.atan2(*mesh.nodes[mesh.ahead[-1]][::-1]) - math.atan2(*point[::-1])
    return min(far, 0.99 * math.hypot(*point) * math.sin(across))


def _add(load: FloatArray, nodes: np.ndarray, values: FloatArray) -> None:
    for axis in (0, 1):
        np.add.at(load, 2 * nodes + axis, values[..., axis])


def flamant(
    from_load: FloatArray, normal: FloatArray, poisson: float, near: float, far: float
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Flamant's displacement (..., 2) and stress (..., 2, 2), chi (...) and its gradient (..., 2).

    ``from_load`` (..., 2) are the vectors from the load, ``normal`` (2,) is the direction of the load.
    """
    side = np.array([-normal[1], normal[0]])
    x = from_load @ normal
    y = from_load @ side
    r = np.maximum(np.hypot(x, y), 1e-9)
    angle = np.arctan2(y, x)
    c = x / r
    s = y / r
    radial = -(2.0 * c * np.log(r) + (1.0 - poisson) * angle * s) / np.pi
    around = (2.0 * s * np.log(r) - (1.0 - poisson) * angle * c + (1.0 + poisson) * s) / np.pi
    out = c[..., None] * normal + s[..., None] * side
    circumferential = c[..., None] * side - s[..., None] * normal
    stress = (-2.0 * c / (np.pi * r))[..., None, None] * out[..., :, None] * out[..., None, :]
    t = np.clip((r - near) / (far - near), 0.0, 1.0)
    chi = 1.0 - t**3 * (10.0 - 15.0 * t + 6.0 * t * t)
    slope = -30.0 * t**2 * (1.0 - t) ** 2 / (far - near)
    return radial[..., None] * out + around[..., None] * circumferential, stress, chi, slope[..., None] * out
