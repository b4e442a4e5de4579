"""Law II: Benedict and Kelley's fit of roller tests in mixed lubrication, equation (14)."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from lumped.arguments import real_array
from lumped.errors import refuse, shown
from lumped.friction.base import (
    MEAN_COEFFICIENT,
    PITCH_RESOLUTION,
    ContactPath,
    FrictionLaw,
    FrictionSettings,
)
from lumped.friction.misfit import Ellipses, entraining
from lumped.ranges import NOT_STATED, ValidityRange, checked
from lumped.typing import FloatArray

#: The roughness [um] at which the factor 1.13/(1.13 - S) has its pole.
ROUGHNESS_LIMIT = 1.13

#: Default upper bound of the law: boundary lubricated steel; the fit itself is unbounded at the pitch point.
DEFAULT_MAXIMUM = 0.2

RANGES = (
    ValidityRange(
        "roughness",
        "um",
        0.0,
        0.75,
        "AGMA 925-A03 holds 1.13/(1.13 - S) at 3, source not checked",
    ),
    ValidityRange(
        "friction_number", "1", 1.0, None, "below 1 the logarithm is negative; the law is held at 0"
    ),
    MEAN_COEFFICIENT,
    ValidityRange("unit_load", "N/mm", None, None, NOT_STATED),
    ValidityRange("viscosity", "mPa s", None, None, NOT_STATED),
    ValidityRange("sliding_velocity", "m/s", None, None, NOT_STATED),
    ValidityRange("entraining_velocity", "m/s", None, None, NOT_STATED),
)


def friction_number(
    unit_load: ArrayLike, viscosity: ArrayLike, sliding_velocity: ArrayLike, entraining_velocity: ArrayLike
) -> FloatArray:
    """The argument 29700 w / (eta v_s v_e^2) of law II's logarithm; infinite where v_s = 0.

    >>> float(friction_number(100, 10, 2, 10))
    1485.0
    """
    w = checked("unit_load", unit_load, "N/mm")
    eta = checked("viscosity", viscosity, "mPa s")
    v_s = checked("sliding_velocity", sliding_velocity, "m/s", allow_zero=True)
    v_e = checked("entraining_velocity", entraining_velocity, "m/s")
    with np.errstate(divide="ignore"):  # the pole at the pitch point is part of the law
        return np.asarray(29700.0 * w / (eta * v_s * v_e**2), dtype=np.float64)


def benedict_kelley(
    unit_load: ArrayLike,
    viscosity: ArrayLike,
    sliding_velocity: ArrayLike,
    entraining_velocity: ArrayLike,
    roughness: ArrayLike,
    *,
    maximum: float = DEFAULT_MAXIMUM,
) -> FloatArray:
    """Benedict-Kelley friction coefficient, equation (14).

    mu = 0.0127 * 1.13/(1.13 - S) * log10(29700 w / (eta v_s v_e^2)), held between 0 and ``maximum``.

    Parameters
    ----------
    unit_load : w, normal load per face width [N/mm]
    viscosity : eta at the inlet, dynamic [mPa s = cP]
    sliding_velocity : v_s, difference of the rolling velocities, >= 0 [m/s]
    entraining_velocity : v_e, *sum* of the rolling velocities [m/s]
    roughness : S, average roughness of the two surfaces, 0 <= S < 1.13 [um]
    maximum : upper bound of mu [-]; ``inf`` leaves the pole at the pitch point

    Returns
    -------
    magnitude of mu [-]

    Raises
    ------
    ParameterError : roughness at or above 1.13 um; an argument negative, or not finite (``maximum`` may be)

    References
    ----------
    G. H. Benedict and B. W. Kelley, "Instantaneous coefficients of gear tooth friction",
    ASLE Transactions 4 (1961) 59-70.

    Examples
    --------
    >>> round(float(benedict_kelley(100, 10, 2, 10, 0.4)), 8)
    0.06235267
    """
    number = friction_number(unit_load, viscosity, sliding_velocity, entraining_velocity)
    upper = real_array("maximum", maximum, finite=False)
    if not (upper >= 0.0).all():
        raise refuse("maximum", shown(maximum), ">= 0", "Use inf for none.")
    magnitude = _factor(roughness) * np.log10(number)
    return np.asarray(np.clip(magnitude, 0.0, upper), dtype=np.float64)


def _factor(roughness: ArrayLike) -> FloatArray:
    s = checked("roughness", roughness, "um", allow_zero=True)
    if (s >= ROUGHNESS_LIMIT).any():
        raise refuse(
            "roughness",
            f"{float(s.max()):g} um",
            "0 <= S < 1.13 um (law II, Benedict-Kelley)",
            "S is the mean Ra of both gears: make them smoother, or take another law such as xu_kahraman.",
        )
    return np.asarray(0.0127 * ROUGHNESS_LIMIT / (ROUGHNESS_LIMIT - s), dtype=np.float64)


def _level(xi: FloatArray, path: ContactPath) -> FloatArray:
    """The law before its bounds."""
    number = friction_number(
        path.unit_load * 1e-3, path.viscosity * 1e3, path.sliding_velocity(xi), path.entraining_velocity(xi)
    )
    return np.asarray(_factor(path.roughness * 1e6) * np.log10(number), dtype=np.float64)


@lru_cache(maxsize=256)
def _cap(path: ContactPath, settings: FrictionSettings) -> float:
    """The bound in force: ``maximum``, or the law at ``PITCH_RESOLUTION`` from the pitch point if less."""
    nearest = np.array([path.L_XP - PITCH_RESOLUTION, path.L_XP + PITCH_RESOLUTION])
    return min(settings.maximum, float(_level(nearest, path).min()))


def _signed(xi: FloatArray, path: ContactPath, settings: FrictionSettings) -> FloatArray:
    magnitude = np.clip(_level(xi, path), 0.0, max(_cap(path, settings), 0.0))
    return np.asarray(np.sign(xi - path.L_XP) * magnitude, dtype=np.float64)


def _switches(path: ContactPath, settings: FrictionSettings) -> list[float]:
    cap = _cap(path, settings)
    bounded = path.crossings(lambda xi: _level(xi, path) - cap)
    return [path.L_XP, *bounded, *path.crossings(lambda xi: _level(xi, path))]


def _analytic(
    low: FloatArray, high: FloatArray, path: ContactPath, settings: FrictionSettings
) -> tuple[FloatArray, FloatArray]:
    """Constant at the bounds of the law. Else each complex logarithm is at most |log10| plus pi/ln 10."""
    centre = 0.5 * (low + high)
    cap = max(_cap(path, settings), 0.0)
    level = _level(centre, path)
    constant = (level <= 0.0) | (level >= cap)
    around = Ellipses.clear_of(low, high, [p for p in (path.L_XP, path.still) if p is not None])
    d = around.distances(path.L_XP)
    v_e = entraining(around, path)
    with np.errstate(divide="ignore"):
        logs = [
            np.maximum(np.abs(np.log10(v[0] / v_0)), np.abs(np.log10(v[1] / v_0))) + np.pi / np.log(10.0)
            for v, v_0 in ((d, np.abs(centre - path.L_XP)), (v_e, path.entraining_velocity(centre)))
        ]
    size = np.abs(level) + _factor(path.roughness * 1e6) * (logs[0] + 2.0 * logs[1])
    return np.where(constant, Ellipses.clear_of(low, high).ratio, around.ratio), np.where(constant, cap, size)


LAW = FrictionLaw(
    name="benedict_kelley",
    numeral="II",
    label="Benedict-Kelley",
    formula=_signed,
    switches=_switches,
    ranges=RANGES,
    reads=frozenset({"viscosity", "roughness", "maximum"}),
    fluid_film=True,
    shift=lambda path, settings: float(-3.0 * _factor(path.roughness * 1e6) * np.log10(path.omega_pinion)),
    analytic=_analytic,
)
