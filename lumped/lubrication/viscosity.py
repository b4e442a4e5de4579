"""Viscosity of a lubricating oil against temperature: Walther's law, density, and a lubricant's eta.

Kinematic viscosities in mm^2/s (cSt) and temperatures in degC, the units of the standards.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from lumped.errors import refuse
from lumped.ranges import checked
from lumped.typing import FloatArray

ZERO_CELSIUS = 273.15


def walther_constants(
    viscosity_1: float, temperature_1: float, viscosity_2: float, temperature_2: float
) -> tuple[float, float]:
    """Constants of log10 log10(nu + 0.7) = A - B log10(T) through two measured points (ASTM D341).

    Parameters
    ----------
    viscosity_1, viscosity_2 : kinematic viscosities [mm^2/s]
    temperature_1, temperature_2 : [degC]

    Returns
    -------
    A, B, for T in kelvin

    Raises
    ------
    ParameterError : equal temperatures, or a viscosity that does not fall with temperature

    Notes
    -----
    0.7 stands for Z of ASTM D341, whose further exponential terms matter below about 2 mm^2/s only.

    Examples
    --------
    >>> [round(x, 4) for x in walther_constants(100, 40, 11.1, 100)]
    [9.2034, 3.5668]
    """
    nu = checked("kinematic_viscosity", [viscosity_1, viscosity_2], "mm^2/s")
    if (temperature_2 - temperature_1) * (viscosity_1 - viscosity_2) <= 0.0:
        raise refuse(
            "kinematic_viscosity",
            f"{viscosity_1:g} mm^2/s at {temperature_1:g} degC, "
            f"{viscosity_2:g} mm^2/s at {temperature_2:g} degC",
            "two temperatures, less viscous at the higher one",
            "Check the two points of the oil's data sheet.",
        )
    level = np.log10(np.log10(nu + 0.7))
    kelvin = np.log10(np.array([temperature_1, temperature_2]) + ZERO_CELSIUS)
    slope = float((level[0] - level[1]) / (kelvin[1] - kelvin[0]))
    return float(level[0] + slope * kelvin[0]), slope


def kinematic_viscosity(temperature: ArrayLike, constants: tuple[float, float]) -> FloatArray:
    """Kinematic viscosity by Walther's law, nu = 10^10^(A - B log10 T) - 0.7 (ASTM D341).

    Parameters
    ----------
    temperature : [degC], any shape
    constants : A, B of ``walther_constants``

    Returns
    -------
    nu [mm^2/s]

    Examples
    --------
    >>> round(float(kinematic_viscosity(60, walther_constants(100, 40, 11.1, 100))), 2)
    39.68
    """
    a, b = constants
    kelvin = np.asarray(temperature, dtype=float) + ZERO_CELSIUS
    return np.asarray(10.0**10.0 ** (a - b * np.log10(kelvin)) - 0.7, dtype=np.float64)


def oil_density(density_15: ArrayLike, temperature: ArrayLike) -> FloatArray:
    """Density of a lubricating oil, rho = rho_15 exp(-a dT (1 + 0.8 a dT)), a = 0.6278/rho_15 1/K.

    Parameters
    ----------
    density_15 : at 15 degC [kg/m^3]
    temperature : [degC]

    Returns
    -------
    rho [kg/m^3]

    References
    ----------
    ASTM D1250 / API MPMS 11.1, thermal expansion of lubricating oils (commodity group D).

    Examples
    --------
    >>> round(float(oil_density(870, 60)), 1)
    841.5
    """
    rho = checked("density", density_15, "kg/m^3")
    expansion = 0.6278 / rho * (np.asarray(temperature, dtype=float) - 15.0)
    return np.asarray(rho * np.exp(-expansion * (1.0 + 0.8 * expansion)), dtype=np.float64)
