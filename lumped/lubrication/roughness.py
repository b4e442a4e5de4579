"""Roughness conventions: arithmetic mean Ra, root mean square Rq, and the two surfaces together.

Files and the friction laws of this package take Ra. Data sheets may give Rq: Rq/Ra is sqrt(pi/2) = 1.253 for
Gaussian heights and pi/(2 sqrt(2)) = 1.111 for a sine.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from lumped.ranges import checked
from lumped.typing import FloatArray


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
