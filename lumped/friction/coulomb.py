"""Law I: Coulomb friction with one coefficient, equation (10).

Sources: Abbas Al-Zubaidi 2008, eq. 10 (docs/theory/friction.md, "The laws").
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from lumped.arguments import real_array
from lumped.friction.average_coefficient import AVERAGE_READS, AVERAGE_SLOPE, average_coefficient
from lumped.friction.base import ContactPath, FrictionLaw, FrictionSettings
from lumped.friction.misfit import constant
from lumped.ranges import checked
from lumped.typing import FloatArray


def coulomb(coefficient: ArrayLike, distance: ArrayLike) -> FloatArray:
    """Coulomb friction along the path of contact, mu = mu_avg sgn(d), equation (10).

    Parameters
    ----------
    coefficient : mu_avg, average magnitude [-]
    distance : d = xi - L_XP, signed distance of the contact point from the pitch point, any length unit

    Returns
    -------
    mu [-], negative in approach, positive in recess, 0 at the pitch point

    Examples
    --------
    >>> float(coulomb(0.05, -2.0))
    -0.05
    """
    mu = checked("coefficient", coefficient, "", allow_zero=True)
    return np.asarray(mu * np.sign(real_array("distance", distance)), dtype=np.float64)


def _signed(xi: FloatArray, path: ContactPath, settings: FrictionSettings) -> FloatArray:
    return coulomb(average_coefficient(path, settings), xi - path.L_XP)


LAW = FrictionLaw(
    name="coulomb",
    numeral="I",
    label="Coulomb",
    formula=_signed,
    switches=lambda path, settings: [path.L_XP],
    coefficient=True,
    average_slope=AVERAGE_SLOPE,
    reads=AVERAGE_READS,
    factor=average_coefficient,
    analytic=constant(average_coefficient),
)
