"""Bending, shear and axial compression of a tooth as a cantilever of its true section.

Potential-energy method: the tooth stands on the root circle and is loaded along the line of action. Its
strain energies give one compliance each (bending and compression: D. C. H. Yang and J. Y. Lin, J. Mech.
Transm. Autom. Des. 109 (1987) 189-196; shear: X. Tian, M. Zuo and K. Fyfe, IMECE 2004):

    1/k_b = int (cos(a) (u_c - u) - sin(a) h_c)^2 / (E I) du,   I = 2/3 h^3 b
    1/k_s = int 1.2 cos^2(a) / (G A) du,                        A = 2 h b
    1/k_a = int sin^2(a) / (E A) du

with the contact point (u_c, h_c), the load angle a, and u from the root circle to the contact point, over the
fillet and the involute; plane stress.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from lumped.errors import NumericalError
from lumped.gear_geometry.tooth_profile import ToothProfile
from lumped.typing import FloatArray

#: Gauss points on the fillet and on the involute; the error is measured by a rule with half as many more.
NODES = 24
#: Largest accepted quadrature error of a compliance, over its value.
TOLERANCE = 1e-8
#: Shear correction of the rectangular section.
SHEAR_FACTOR = 1.2


@dataclass(frozen=True)
class BeamCompliance:
    """Compliances of one tooth along the line of action, each times face width [m^2/N].

    Attributes
    ----------
    bending, shear, axial : (n,) the three parts
    quadrature_error : largest relative difference from a finer Gauss rule over the three [-]
    """

    bending: FloatArray
    shear: FloatArray
    axial: FloatArray
    quadrature_error: float


def beam_compliance(
    profile: ToothProfile, length: FloatArray, modulus: float, poisson: float, nodes: int = NODES
) -> BeamCompliance:
    """Compliances of a tooth loaded at points of its involute.

    Parameters
    ----------
    profile : the tooth
    length : (n,) contact points as lengths on the base tangent, at or beyond ``profile.form_length`` [m]
    modulus, poisson : E [Pa], nu [-]
    nodes : Gauss points on the fillet and on the involute to begin with; up to eight times as many are taken

    Raises
    ------
    NumericalError : the finer Gauss rule disagrees by more than ``TOLERANCE`` however many points are taken
    """
    (bending, area), error = _converged(profile, length, nodes)
    *_, angle = profile.involute_points(length)
    shear_modulus = modulus / (2.0 * (1.0 + poisson))
    return BeamCompliance(
        bending=bending / modulus,
        shear=SHEAR_FACTOR * np.cos(angle) ** 2 * area / shear_modulus,
        axial=np.sin(angle) ** 2 * area / modulus,
        quadrature_error=error,
    )


def _converged(
    profile: ToothProfile, length: FloatArray, nodes: int
) -> tuple[tuple[FloatArray, FloatArray], float]:
    """Both integrals, and their relative difference from a rule with two thirds of the points."""
    error = np.inf
    for count in (nodes, 2 * nodes, 4 * nodes, 8 * nodes):
        coarse = _integrals(profile, length, count)
        fine = _integrals(profile, length, count + count // 2)
        error = max(float(np.max(np.abs(a / b - 1.0))) for a, b in zip(coarse, fine, strict=True))
        if error <= TOLERANCE:
            return fine, error
    raise NumericalError(
        f"The tooth's strain energy did not converge (relative error {error:.1e}): the tooth is nearly "
        "pointed or its root nearly cut through; lower the tip diameter or change the profile shift."
    )


@cache
def _gauss(nodes: int) -> tuple[FloatArray, FloatArray]:
    points, weights = np.polynomial.legendre.leggauss(nodes)
    return points, weights


def _integrals(profile: ToothProfile, length: FloatArray, nodes: int) -> tuple[FloatArray, FloatArray]:
    """Integrals of arm^2/(2/3 h^3) and 1/(2 h) over u, root circle to each contact point; (n,) [-]."""
    points, weights = _gauss(nodes)
    start, end = profile.fillet_range
    u_1, h_1, slope_1 = profile.fillet_points(0.5 * (start + end) + 0.5 * (end - start) * points)
    w_1 = 0.5 * (end - start) * weights * slope_1
    form = profile.form_length
    half = 0.5 * (length - form)[:, None]
    u_2, h_2, slope_2, _ = profile.involute_points(form + half * (1.0 + points))
    w_2 = half * weights * slope_2
    u_c, h_c, _, angle = profile.involute_points(length)

    def bending(u: FloatArray, h: FloatArray, w: FloatArray) -> FloatArray:
        arm = np.cos(angle)[:, None] * (u_c[:, None] - u) - (np.sin(angle) * h_c)[:, None]
        return np.asarray(np.sum(1.5 * arm**2 / h**3 * w, axis=1), dtype=np.float64)

    area = np.sum(w_1 / (2.0 * h_1)) + np.sum(w_2 / (2.0 * h_2), axis=1)
    return bending(u_1, h_1, w_1) + bending(u_2, h_2, w_2), np.asarray(area, dtype=np.float64)
