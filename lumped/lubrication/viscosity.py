"""Viscosity of a lubricating oil: Walther's law, density, ISO viscosity grade and viscosity index.

Kinematic viscosities in mm^2/s (cSt) and temperatures in degC, the units of the standards.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from lumped.errors import refuse
from lumped.ranges import checked
from lumped.root_in_bracket import root_in_bracket
from lumped.typing import FloatArray

ZERO_CELSIUS = 273.15


def walther_constants(
    viscosity_1: float, temperature_1: float, viscosity_2: float, temperature_2: float
) -> tuple[float, float]:
    """A, B of log10 log10(nu + 0.7) = A - B log10(T [K]) through two measured points (ASTM D341).

    0.7 stands for Z of the standard, whose further exponential terms matter below about 2 mm^2/s only.

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
    """Kinematic viscosity by Walther's law, nu = 10^10^(A - B log10 T) - 0.7 (ASTM D341) [mm^2/s].

    >>> round(float(kinematic_viscosity(60, walther_constants(100, 40, 11.1, 100))), 2)
    39.68
    """
    a, b = constants
    kelvin = np.asarray(temperature, dtype=float) + ZERO_CELSIUS
    return np.asarray(10.0**10.0 ** (a - b * np.log10(kelvin)) - 0.7, dtype=np.float64)


def oil_density(density_15: float, temperature: ArrayLike) -> FloatArray:
    """Density of a lubricating oil [kg/m^3], rho_15 exp(-a dT (1 + 0.8 a dT)), a = 0.6278/rho_15 1/K.

    ASTM D1250 / API MPMS 11.1, thermal expansion of lubricating oils (commodity group D).

    >>> round(float(oil_density(870, 60)), 1)
    841.5
    """
    expansion = 0.6278 / density_15 * (np.asarray(temperature, dtype=float) - 15.0)
    return np.asarray(density_15 * np.exp(-expansion * (1.0 + 0.8 * expansion)), dtype=np.float64)


#: ISO 3448 grade -> mid-point kinematic viscosity at 40 degC [mm^2/s]; limits are 10 per cent either side.
ISO_VG_MIDPOINT = {
    **{2: 2.2, 3: 3.2, 5: 4.6, 7: 6.8},
    **{step * decade: float(step * decade) for decade in (1, 10) for step in (10, 15, 22, 32, 46, 68)},
    **{grade: float(grade) for grade in (1000, 1500, 2200, 3200)},
}

#: Viscosity index of a plain mineral gear oil, where a data sheet does not give one.
DEFAULT_VISCOSITY_INDEX = 95.0

# ASTM D2270, appendix: L = a Y^2 + b Y + c and H = d Y^2 + e Y + f from the viscosity Y at 100 degC; upper
# end of Y [mm^2/s], then a..f. The first row starts at Y = 2.
_INDEX_TABLE = (
    (3.8, 1.14673, 1.7576, -0.109, 0.84155, 1.5521, -0.077),
    (4.4, 3.38095, -15.4952, 33.196, 0.78571, 1.7929, -0.183),
    (5.0, 2.5, -7.2143, 13.812, 0.82143, 1.5679, 0.119),
    (6.4, 0.101, 16.635, -45.469, 0.04985, 9.1613, -18.557),
    (7.0, 3.35714, -23.5643, 78.466, 0.22619, 7.7369, -16.656),
    (7.7, 0.01191, 21.475, -72.870, 0.79762, -0.7321, 14.61),
    (9.0, 0.41858, 16.1558, -56.040, 0.05794, 10.5156, -28.240),
    (12.0, 0.88779, 7.5527, -16.600, 0.26665, 6.7015, -10.810),
    (15.0, 0.76720, 10.7972, -38.180, 0.20073, 8.4658, -22.490),
    (18.0, 0.97305, 5.3135, -2.200, 0.28889, 5.9741, -4.930),
    (22.0, 0.97256, 5.25, -0.980, 0.24504, 7.416, -16.730),
    (28.0, 0.91413, 7.4759, -21.820, 0.20323, 9.1267, -34.230),
    (40.0, 0.87031, 9.7157, -50.770, 0.18411, 10.1015, -46.750),
    (55.0, 0.84703, 12.6752, -133.310, 0.17029, 11.4866, -80.620),
    (70.0, 0.85921, 11.1009, -83.190, 0.17130, 11.368, -76.940),
    (math.inf, 0.83531, 14.6731, -216.246, 0.16841, 11.8493, -96.947),
)
_LOWEST_Y = 2.0


def viscosity_index(viscosity_40: float, viscosity_100: float) -> float:
    """Viscosity index of an oil by its viscosities at 40 and 100 degC (ASTM D2270), not rounded.

    Up to 100: VI = 100 (L - U)/(L - H). Above: VI = 100 + (10^N - 1)/0.00715, N = log(H/U)/log(Y), with U and
    Y the viscosities at 40 and 100 degC, Y >= 2, L and H those at 40 degC of the reference oils of index 0
    and 100 with the same Y.

    >>> round(viscosity_index(73.30, 8.86))
    92
    """
    u, y = viscosity_40, viscosity_100
    if not (_LOWEST_Y <= y < u and math.isfinite(u)):
        raise refuse(
            "kinematic_viscosity_100",
            f"{y:g} mm^2/s, {u:g} mm^2/s at 40 degC",
            f"from {_LOWEST_Y:g} mm^2/s to the viscosity at 40 degC",
            "Check the oil's data sheet.",
        )
    low, high = reference_oils(y)
    if u >= high:
        return 100.0 * (low - u) / (low - high)
    exponent = math.log10(high / u) / math.log10(y)
    return 100.0 + (math.pow(10.0, exponent) - 1.0) / 0.00715


def viscosity_at_100(viscosity_40: float, index: float = DEFAULT_VISCOSITY_INDEX) -> float:
    """Kinematic viscosity at 100 degC from that at 40 degC and the viscosity index [mm^2/s].

    The inverse of ``viscosity_index``; the pieces of the standard's table join within 0.2 per cent.

    >>> round(viscosity_at_100(73.30, 92), 2)
    8.84
    """
    top = 0.9 * viscosity_40

    def excess(y: float) -> float:
        return viscosity_index(viscosity_40, y) - index

    if top <= _LOWEST_Y or excess(_LOWEST_Y) > 0.0 or excess(top) < 0.0:
        raise refuse(
            "viscosity_index",
            f"{index:g} at {viscosity_40:g} mm^2/s and 40 degC",
            f"an oil of at least {_LOWEST_Y:g} mm^2/s at 100 degC (ASTM D2270)",
            "Give the viscosity at 100 degC instead.",
        )
    return float(root_in_bracket(excess, _LOWEST_Y, top, xtol=1e-12, rtol=1e-12))


def grade_viscosity(grade: int, temperature: ArrayLike, index: float = DEFAULT_VISCOSITY_INDEX) -> FloatArray:
    """Kinematic viscosity of an oil of an ISO viscosity grade at a temperature [mm^2/s].

    The grade's mid-point at 40 degC, the viscosity index's viscosity at 100 degC, and Walther's law through
    both (ISO 3448, ASTM D2270, ASTM D341).

    >>> round(float(grade_viscosity(100, 60)), 1)
    39.6
    """
    middle = midpoint(grade)
    constants = walther_constants(middle, 40.0, viscosity_at_100(middle, index), 100.0)
    return np.asarray(kinematic_viscosity(temperature, constants), dtype=np.float64)


def midpoint(grade: int) -> float:
    """Kinematic viscosity at 40 degC in the middle of a grade [mm^2/s]."""
    if grade not in ISO_VG_MIDPOINT:
        raise refuse("iso_vg", grade, ", ".join(map(str, ISO_VG_MIDPOINT)), "Pick a grade of ISO 3448.")
    return ISO_VG_MIDPOINT[grade]


def reference_oils(y: float) -> tuple[float, float]:
    """L and H: viscosities at 40 degC of the oils with index 0 and 100 [mm^2/s]."""
    _, a, b, c, d, e, f = next(row for row in _INDEX_TABLE if y <= row[0])
    return (a * y + b) * y + c, (d * y + e) * y + f
