"""Roughness conventions: arithmetic mean Ra, root mean square Rq, and the two surfaces together.

Files and the friction laws of this package take Ra. Data sheets may give Rq; their ratio depends on the
shape of the profile.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from lumped.errors import refuse
from lumped.ranges import checked
from lumped.typing import FloatArray

Profile = Literal["gaussian", "sine"]

#: Rq/Ra of a profile shape. Gaussian heights: the mean of |z| is sqrt(2/pi) of the standard deviation; a
#: sine of amplitude a: Ra = 2a/pi, Rq = a/sqrt(2).
RMS_OVER_MEAN = {"gaussian": math.sqrt(math.pi / 2.0), "sine": math.pi / (2.0 * math.sqrt(2.0))}


def rms_from_mean(roughness: ArrayLike, profile: Profile = "gaussian") -> FloatArray:
    """Rq of a surface from its Ra, in the same unit: 1.253 Ra for Gaussian heights, 1.111 Ra for a sine.

    Raises
    ------
    ParameterError : a negative roughness or an unknown profile

    Examples
    --------
    >>> round(float(rms_from_mean(0.8)), 4)
    1.0027
    """
    return np.asarray(
        checked("roughness", roughness, "", allow_zero=True) * _ratio(profile), dtype=np.float64
    )


def mean_from_rms(roughness: ArrayLike, profile: Profile = "gaussian") -> FloatArray:
    """Ra of a surface from its Rq, in the same unit; the inverse of ``rms_from_mean``.

    Raises
    ------
    ParameterError : a negative roughness or an unknown profile

    Examples
    --------
    >>> round(float(mean_from_rms(1.0)), 4)
    0.7979
    """
    return np.asarray(
        checked("roughness", roughness, "", allow_zero=True) / _ratio(profile), dtype=np.float64
    )


def composite_roughness(pinion: ArrayLike, gear: ArrayLike) -> FloatArray:
    """R_comp = sqrt(R_p^2 + R_g^2), the roughness of the gap, in the convention and unit of its arguments.

    The root sum of squares belongs to independent surfaces: variances add. Lambda on Ra is 1.25 times Lambda
    on Rq for Gaussian heights.

    Examples
    --------
    >>> float(composite_roughness(0.3, 0.4))
    0.5
    """
    a = checked("pinion.roughness", pinion, "", allow_zero=True)
    b = checked("gear.roughness", gear, "", allow_zero=True)
    return np.asarray(np.hypot(a, b), dtype=np.float64)


def mean_roughness(pinion: ArrayLike, gear: ArrayLike) -> FloatArray:
    """S = (R_p + R_g)/2, the average roughness that laws II and III take, in the unit of its arguments.

    Examples
    --------
    >>> float(mean_roughness(0.3, 0.4))
    0.35
    """
    a = checked("pinion.roughness", pinion, "", allow_zero=True)
    return np.asarray(0.5 * (a + checked("gear.roughness", gear, "", allow_zero=True)), dtype=np.float64)


def _ratio(profile: str) -> float:
    if profile not in RMS_OVER_MEAN:
        raise refuse("profile", profile, ", ".join(RMS_OVER_MEAN), "Pick the shape nearest to the surface.")
    return RMS_OVER_MEAN[profile]
