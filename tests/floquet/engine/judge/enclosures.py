"""Matrices and eigenvalues as balls, for bounds that are judged entry by entry.

Floating point numbers are taken as exact. Written without any code of the package under test but for what
describes the problem.
"""

from collections.abc import Sequence

import numpy as np
from flint import acb, acb_mat, arb, arb_mat, arb_poly, ctx

from floquet import RankOneSystem
from tests.floquet.engine.judge.balls import Piece, monodromy, polynomial

BITS = 256
"""Of all numbers here: 77 digits."""


def balls(values: np.ndarray) -> acb_mat:
    """Complex or real floating point numbers (n, m), exactly."""
    ctx.prec = BITS
    return acb_mat([[acb(arb(float(x.real)), arb(float(x.imag))) for x in row] for row in np.asarray(values)])


def real_balls(values: np.ndarray) -> arb_mat:
    """Real floating point numbers (n, m), exactly."""
    ctx.prec = BITS
    return arb_mat([[arb(float(x)) for x in row] for row in np.asarray(values)])


def least(x: arb | acb) -> float:
    """The modulus of a ball from below, rounded down."""
    return float(np.nextafter(float(abs(x).lower()), -np.inf))


def most(x: arb | acb) -> float:
    """The modulus of a ball from above, rounded up."""
    return float(np.nextafter(float(abs(x).upper()), np.inf))


def least_moduli(matrix: acb_mat | arb_mat) -> np.ndarray:
    """Moduli of the entries from below."""
    return np.array([[least(matrix[i, j]) for j in range(matrix.ncols())] for i in range(matrix.nrows())])


def most_moduli(matrix: acb_mat | arb_mat) -> np.ndarray:
    """Moduli of the entries from above."""
    return np.array([[most(matrix[i, j]) for j in range(matrix.ncols())] for i in range(matrix.nrows())])


def least_norm(matrix: acb_mat | arb_mat) -> float:
    """The Frobenius norm from below."""
    return float(np.linalg.norm(least_moduli(matrix))) * (1.0 - 1e-14)  # rounding of the norm


def disks(matrix: acb_mat | arb_mat) -> list[tuple[complex, float]]:
    """Middle and radius of a disk about each eigenvalue."""
    eigenvalues = acb_mat(matrix).eig(multiple=True)
    middles = [complex(value.mid()) for value in eigenvalues]
    return [
        (middle, float((value - acb(middle)).abs_upper()))
        for value, middle in zip(eigenvalues, middles, strict=True)
    ]


def nearly_defective(power: int) -> np.ndarray:
    """(6, 6) with multipliers 7/8, 7/8 + e, 7/8 + 2 e, e = 2^-power, that share an eigenvector but for e.

    In a basis of whole numbers, so that no entry is rounded; the others are 3/8 and 1/4 +- i/4. The condition
    of the eigenvectors is some 10/e^2. Rows of their computed inverse that belong to the other multipliers
    are as wrong as the three that are nearly parallel: by the inverse itself it does not show.
    """
    e = 2.0**-power
    core = np.diag([0.875, 0.875 + e, 0.875 + 2.0 * e, 0.375, 0.25, 0.25])
    core += np.diag([1.0, 1.0, 0.0, 0.0, 0.25], 1) - np.diag([0.0, 0.0, 0.0, 0.0, 0.25], -1)
    rng = np.random.default_rng(3)
    upper, lower = (np.eye(6) + np.triu(rng.integers(-1, 2, (6, 6)), 1) for _ in range(2))
    basis = upper @ lower.T
    inverse = np.rint(np.linalg.inv(basis))
    assert (basis @ inverse == np.eye(6)).all()
    return basis @ core @ inverse


def worst_errors(M: np.ndarray, delta: float) -> list[np.ndarray]:
    """Errors (n, n) of this norm that move one eigenvalue each as far as they can, to first order."""
    vectors = np.linalg.eig(M)[1]
    errors = []
    for row, column in zip(np.linalg.inv(vectors), vectors.T, strict=True):
        E = np.outer(row.conj(), column.conj())
        errors.append(delta * (1.0 - 1e-14) / np.linalg.norm(E) * E)
    return errors


def energy_monodromy(system: RankOneSystem, period: float, zeta: float, gains: Sequence[float]) -> arb_mat:
    """The monodromy matrix in the energy coordinates of ``system.modal()``: S^-1 Phi(T, 0) S.

    Every number of the system is exact, and so are its shapes and frequencies, which only name coordinates.
    """
    ctx.prec = BITS
    m = system.v.size
    T = arb(period)
    form = system.modal()
    rate = arb(2 ** round(float(np.log2(form.omega.max()))))  # of both halves of the state alike
    G = np.zeros((m, m)) if system.gyroscopic is None else system.gyroscopic
    pieces = []
    for i in range(system.phases.size - 1):
        low, high = arb(float(system.phases[i])), arb(float(system.phases[i + 1]))
        u = arb_poly([-(low + high) / (high - low), 2 / ((high - low) * T)])  # of the time
        entries = [(r, m + r, polynomial(arb_poly([rate]))) for r in range(m)]
        for r in range(m):
            spring_gain, damper_gain = [
                sum(
                    (
                        arb_poly([arb(float(x)) for x in poly[i, r]]) * arb(float(g))
                        for g, poly in zip(gains, polys, strict=True)
                    ),
                    arb_poly([0]),
                )
                for polys in ([p.w for p in system.parts], [p.wd for p in system.parts])
            ]
            for c in range(m):
                v = arb(float(system.v[c]))
                still = arb(float(system.stiffness[r, c]))
                moving = arb(float(system.damping[r, c]))
                moving += arb(float(G[r, c])) / T
                spring = spring_gain(u) * v + still
                damper = damper_gain(u) * v * arb(float(zeta)) + moving
                entries.append((m + r, c, polynomial(spring * (-1 / rate))))
                entries.append((m + r, m + c, polynomial(damper * arb(-1))))
        pieces.append(Piece(low * T, (high - low) * T, entries))
    shapes = real_balls(form.shapes)
    S = arb_mat(2 * m, 2 * m)
    for r in range(m):
        for c in range(m):
            S[r, c] = shapes[r, c] / arb(float(form.omega[c]))
            S[m + r, m + c] = shapes[r, c] / rate
    return S.inv() * monodromy(pieces, 2 * m, BITS) * S
