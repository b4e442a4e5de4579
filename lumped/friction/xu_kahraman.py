"""Law III: Xu and Kahraman's regression of elastohydrodynamic solutions, equation (18)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from lumped.arguments import real_array
from lumped.friction.base import MEAN_COEFFICIENT, ContactPath, FrictionLaw, FrictionSettings
from lumped.friction.misfit import Ellipses, entraining
from lumped.ranges import NOT_STATED, ValidityRange, checked
from lumped.typing import FloatArray

#: Regression coefficients b1..b9.
B = (-8.916465, 1.03303, 1.036077, -0.354068, 2.812084, -0.100601, 0.752755, -0.390958, 0.620305)

_RECALLED = "range of Xu's data, source not checked"
RANGES = (
    ValidityRange("slide_to_roll", "1", 0.0, 2.0, "2 v_s/v_e with both surfaces rolling the same way"),
    ValidityRange("viscosity", "mPa s", 1.0, None, "log10(eta) enters as a positive factor"),
    ValidityRange("pressure", "GPa", 0.5, 2.5, _RECALLED),
    ValidityRange("mean_rolling_velocity", "m/s", 1.0, 20.0, _RECALLED),
    MEAN_COEFFICIENT,
    ValidityRange("roughness", "um", None, None, NOT_STATED),
    ValidityRange("radius", "m", None, None, NOT_STATED),
)


def xu_kahraman(
    pressure: ArrayLike,
    slide_to_roll: ArrayLike,
    entraining_velocity: ArrayLike,
    viscosity: ArrayLike,
    roughness: ArrayLike,
    radius: ArrayLike,
) -> FloatArray:
    """Xu-Kahraman friction coefficient, equation (18).

    mu = exp(f) p_h^b2 |SR|^b3 V_e^b6 eta^b7 R^b8,
    f = b1 + b4 |SR| p_h log10(eta) + b5 exp(-|SR| p_h log10(eta)) + b9 exp(S)

    Parameters
    ----------
    pressure : p_h, largest Hertzian pressure [GPa]
    slide_to_roll : SR = 2 v_s/v_e, either sign [-]
    entraining_velocity : V_e, *half* the sum of the rolling velocities [m/s]
    viscosity : eta at the inlet, dynamic [mPa s]
    roughness : S [um]
    radius : R, reduced radius of curvature [m]

    Returns
    -------
    magnitude of mu [-]; 0 in pure rolling, where it vanishes as |SR|^1.036

    Raises
    ------
    ParameterError : an argument negative, zero where a power needs it, or not finite

    References
    ----------
    H. Xu, A. Kahraman, N. E. Anderson and D. G. Maddock, "Prediction of mechanical efficiency of
    parallel-axis gear pairs", J. Mech. Des. 129 (2007) 58-68.

    Examples
    --------
    >>> round(float(xu_kahraman(1.0, 0.1, 10.0, 10.0, 0.3, 0.008)), 8)
    0.01039515
    """
    p_h = checked("pressure", pressure, "GPa")
    sr = checked("slide_to_roll", np.abs(real_array("slide_to_roll", slide_to_roll)), "", allow_zero=True)
    v_e = checked("entraining_velocity", entraining_velocity, "m/s")
    eta = checked("viscosity", viscosity, "mPa s")
    s = checked("roughness", roughness, "um", allow_zero=True)
    r = checked("radius", radius, "m")
    b1, b2, b3, b4, b5, b6, b7, b8, b9 = B
    shear = sr * p_h * np.log10(eta)
    exponent = b1 + b4 * shear + b5 * np.exp(-shear) + b9 * np.exp(s)
    return np.asarray(np.exp(exponent) * p_h**b2 * sr**b3 * v_e**b6 * eta**b7 * r**b8, dtype=np.float64)


def _signed(xi: FloatArray, path: ContactPath, settings: FrictionSettings) -> FloatArray:
    magnitude = xu_kahraman(
        path.hertz_pressure(xi) * 1e-9,
        path.slide_to_roll(xi),
        path.entraining_velocity(xi) / 2.0,
        path.viscosity * 1e3,
        path.roughness * 1e6,
        path.radius(xi),
    )
    return np.asarray(np.sign(xi - path.L_XP) * magnitude, dtype=np.float64)


def _analytic(
    low: FloatArray, high: FloatArray, path: ContactPath, settings: FrictionSettings
) -> tuple[FloatArray, FloatArray]:
    """Powers of the distances to P, to both tangent points and to where v_e is 0, from the middle on.

    With s = |SR| p_h log10(eta), s_0 in the middle and |s - s_0| <= m, the exponential changes by a factor of
    at most exp(|b4| m + b5 exp(-s_0) (exp m - 1)).
    """
    _, b2, b3, b4, b5, b6, _, b8, _ = B
    points = [p for p in (path.L_XP, 0.0, path.L_XY, path.still) if p is not None]
    around = Ellipses.clear_of(low, high, points)
    centre = 0.5 * (low + high)
    v_e = entraining(around, path)
    middle = path.entraining_velocity(centre)
    slow = v_e[0] / middle
    fast = v_e[1] / middle
    far = around.distances(path.L_XP)[1] / np.abs(centre - path.L_XP)
    ends = [around.distances(end) for end in (0.0, path.L_XY)]
    least, most = (ends[0][k] * ends[1][k] / (centre * (path.L_XY - centre)) for k in (0, 1))
    shear = path.slide_to_roll(centre) * path.hertz_pressure(centre) * 1e-9 * np.log10(path.viscosity * 1e3)
    moved = np.abs(shear) * (far / slow / np.sqrt(least) - 1.0)
    power = b6 - b3
    curved = b8 - 0.5 * b2
    size = far**b3 * np.maximum(slow**power, fast**power) * np.maximum(least**curved, most**curved)
    size *= np.exp(abs(b4) * moved + b5 * np.exp(-shear) * np.expm1(moved))
    return around.ratio, np.abs(_signed(centre, path, settings)) * size


LAW = FrictionLaw(
    name="xu_kahraman",
    numeral="III",
    label="Xu-Kahraman",
    formula=_signed,
    switches=lambda path, settings: [path.L_XP],
    ranges=RANGES,
    reads=frozenset({"effective_modulus", "viscosity", "roughness"}),
    fluid_film=True,
    # Speed enters by V_e alone, since the slide-to-roll ratio has none.
    factor=lambda path, settings: path.omega_pinion ** B[5],
    analytic=_analytic,
)
