"""Nine-node quadrilaterals of plane stress: shape functions, stiffness, mass, assembly.

Young's modulus, density and thickness are 1. Plane strain is plane stress with E/(1 - nu^2) and nu/(1 - nu).
Source: O. C. Zienkiewicz and R. L. Taylor, The Finite Element Method, 5th ed. (2000), vol. 1, chapters 4, 8,
9.
"""

from __future__ import annotations

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


def gradients(corners: FloatArray, slopes: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Gradients (e, 2, p, 9) of shape functions and Jacobian (e, p), by nodes (e, 9, 2), slopes (2, p, 9)."""
    j = np.einsum("dpk,ekc->epdc", slopes, corners)
    determinant = j[..., 0, 0] * j[..., 1, 1] - j[..., 0, 1] * j[..., 1, 0]
    inverse = np.stack(
        [np.stack([j[..., 1, 1], -j[..., 0, 1]], -1), np.stack([-j[..., 1, 0], j[..., 0, 0]], -1)], -2
    )
    inverse /= determinant[..., None, None]
    return np.einsum("epcd,dpk->ecpk", inverse, slopes), determinant


def plane_law(poisson: float) -> FloatArray:
    """Stresses (xx, yy, xy) by strains (xx, yy, 2 xy) in plane stress with E = 1; (3, 3)."""
    rows = [[1.0, poisson, 0.0], [poisson, 1.0, 0.0], [0.0, 0.0, 0.5 * (1.0 - poisson)]]
    return np.array(rows) / (1.0 - poisson**2)


def assembled(nodes: FloatArray, elements: IntArray, poisson: float) -> tuple[sparse.csc_array, FloatArray]:
    """Stiffness matrix (2 n, 2 n); loads (2 n, 3) of unit accelerations along x, along y and about 0."""
    shapes, slopes, weights = square_shapes(3)
    corners = nodes[elements]
    gradient, determinant = gradients(corners, slopes)
    strain = np.zeros((len(elements), weights.size, 3, 18))
    strain[..., 0, 0::2] = strain[..., 2, 1::2] = gradient[:, 0]
    strain[..., 1, 1::2] = strain[..., 2, 0::2] = gradient[:, 1]
    area = determinant * weights
    stress = np.einsum("ab,epbj->epaj", plane_law(poisson), strain) * area[..., None, None]
    size = len(elements)
    rows = weights.size * 3
    stiffness = strain.reshape(size, rows, 18).transpose(0, 2, 1) @ stress.reshape(size, rows, 18)
    freedoms = np.stack([2 * elements, 2 * elements + 1], axis=-1).reshape(size, 18)
    index = np.broadcast_to(freedoms[:, :, None], stiffness.shape)
    pairs = (index.ravel(), index.transpose(0, 2, 1).ravel())
    count = 2 * len(nodes)
    matrix = sparse.csc_array(sparse.coo_array((stiffness.ravel(), pairs), shape=(count, count)))
    mass = np.einsum("ep,pi,pj,ejc->eic", area, shapes, shapes, np.ones_like(corners))
    turned = np.einsum(
        "ep,pi,pj,ejc->eic", area, shapes, shapes, np.stack([-corners[..., 1], corners[..., 0]], -1)
    )
    loads = np.zeros((count, 3))
    np.add.at(loads[:, 0], 2 * elements, mass[..., 0])
    np.add.at(loads[:, 1], 2 * elements + 1, mass[..., 1])
    for axis in (0, 1):
        np.add.at(loads[:, 2], 2 * elements + axis, turned[..., axis])
    return matrix, loads
