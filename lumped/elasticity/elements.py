"""Nine-node quadrilaterals of plane stress: shape functions, stiffness, mass, assembly.

Young's modulus, density and thickness are 1. Plane strain is plane stress with E/(1 - nu^2) and nu/(1 - nu).
Source: O. C. Zienkiewicz and R. L. Taylor, The Finite Element Method, 5th ed. (2000), vol. 1, chapters 4, 8,
9.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy import sparse

from lumped.typing import FloatArray, IntArray


def line_shapes(s: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Quadratic shape functions of the nodes at -1, 0, 1 and their slopes at s (n,); both (n, 3)."""
    values = np.stack([0.5 * s * (s - 1.0), 1.0 - s * s, 0.5 * s * (s + 1.0)], axis=-1)
    return values, np.stack([s - 0.5, -2.0 * s, s + 0.5], axis=-1)


def square_shapes(points: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Gauss rule of points x points on the square: shapes (p, 9), slopes (2, p, 9), weights (p,)."""
    x, w = np.polynomial.legendre.leggauss(points)
    n, d = line_shapes(x)

    def product(a: FloatArray, b: FloatArray) -> FloatArray:
        return np.asarray(np.einsum("pi,qj->pqij", a, b).reshape(points**2, 9))

    return product(n, n), np.stack([product(d, n), product(n, d)]), np.outer(w, w).ravel()


class Quadrature(NamedTuple):
    """A Gauss rule in all elements.

    Attributes
    ----------
    shapes : (p, 9) shape functions
    places : (e, p, 2) coordinates
    gradients : (e, 2, p, 9) of the shape functions along x and y
    areas : (e, p)
    """

    shapes: FloatArray
    places: FloatArray
    gradients: FloatArray
    areas: FloatArray


def quadrature(nodes: FloatArray, elements: IntArray, points: int) -> Quadrature:
    """Gauss rule of points x points in each element (e, 9) of nodes (n, 2)."""
    shapes, slopes, weights = square_shapes(points)
    corners = nodes[elements]
    count = weights.size
    j = (slopes.reshape(2 * count, 9) @ corners).reshape(-1, 2, count, 2)
    (xs, ys), (xt, yt) = ((j[:, d, :, 0], j[:, d, :, 1]) for d in (0, 1))
    determinant = xs * yt - ys * xt
    along, across = slopes
    gradients = np.empty((len(elements), 2, count, 9))
    gradients[:, 0] = (yt / determinant)[..., None] * along - (ys / determinant)[..., None] * across
    gradients[:, 1] = (xs / determinant)[..., None] * across - (xt / determinant)[..., None] * along
    return Quadrature(shapes, shapes @ corners, gradients, determinant * weights)


def plane_law(poisson: float) -> FloatArray:
    """Stresses (xx, yy, xy) by strains (xx, yy, 2 xy) in plane stress with E = 1; (3, 3)."""
    rows = [[1.0, poisson, 0.0], [poisson, 1.0, 0.0], [0.0, 0.0, 0.5 * (1.0 - poisson)]]
    return np.array(rows) / (1.0 - poisson**2)


def assembled(nodes: FloatArray, elements: IntArray, poisson: float) -> tuple[sparse.csc_array, FloatArray]:
    """Stiffness matrix (2 n, 2 n); loads (2 n, 3) of unit accelerations along x, along y and about 0."""
    shapes, places, gradients, area = quadrature(nodes, elements, 3)
    strain = np.zeros((*area.shape, 3, 18))
    xx, yy, xy = range(3)
    strain[..., xx, 0::2] = gradients[:, 0]
    strain[..., xy, 1::2] = gradients[:, 0]
    strain[..., yy, 1::2] = gradients[:, 1]
    strain[..., xy, 0::2] = gradients[:, 1]
    stress = plane_law(poisson) @ strain * area[..., None, None]
    size = len(elements)
    rows = area.shape[1] * 3
    stiffness = strain.reshape(size, rows, 18).transpose(0, 2, 1) @ stress.reshape(size, rows, 18)
    freedoms = np.stack([2 * elements, 2 * elements + 1], axis=-1).reshape(size, 18)
    index = np.broadcast_to(freedoms[:, :, None], stiffness.shape)
    pairs = (index.ravel(), index.transpose(0, 2, 1).ravel())
    count = 2 * len(nodes)
    matrix = sparse.csc_array(sparse.coo_array((stiffness.ravel(), pairs), shape=(count, count)))
    loads = np.zeros((len(nodes), 2, 3))
    x, y = np.moveaxis(places, -1, 0)
    for axis, motion, field in ((0, 0, area), (1, 1, area), (0, 2, -y * area), (1, 2, x * area)):
        np.add.at(loads[:, axis, motion], elements, field @ shapes)
    return matrix, loads.reshape(count, 3)
