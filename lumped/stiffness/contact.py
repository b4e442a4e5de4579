"""Compliance of the contact between two teeth: linearised Hertz, or Weber and Banaschek's at a load."""

from __future__ import annotations

import math

import numpy as np

from lumped.typing import FloatArray


def linear_hertz_compliance(modulus: tuple[float, float], poisson: tuple[float, float]) -> float:
    """Linear contact compliance times face width, 2/pi ((1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2) [m^2/N].

    For equal materials 4 (1 - nu^2)/(pi E), D. C. H. Yang and Z. S. Sun (J. Mech. Transm. Autom. Des. 107
    (1985) 529-535). It depends neither on load nor on curvature and is the usual choice of the
    potential-energy method; teeth in contact are some three times softer (``local_compliance``).

    Parameters
    ----------
    modulus, poisson : E [Pa] and nu [-] of both gears

    Examples
    --------
    >>> f"{linear_hertz_compliance((206e9, 206e9), (0.3, 0.3)):.4e}"
    '5.6245e-12'
    """
    return 2.0 / math.pi * sum((1.0 - nu**2) / e for e, nu in zip(modulus, poisson, strict=True))


def contact_half_width(
    load: float, radius: FloatArray, modulus: tuple[float, float], poisson: tuple[float, float]
) -> FloatArray:
    """Half width of the Hertzian line contact, sqrt(4 w rho ((1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2)/pi) [m].

    Parameters
    ----------
    load : w, normal load per face width [N/m]
    radius : rho, reduced radius of curvature [m], any shape
    modulus, poisson : E [Pa] and nu [-] of both gears

    Examples
    --------
    >>> f"{contact_half_width(100e3, np.array(0.008), (206e9, 206e9), (0.3, 0.3)):.5e}"
    '9.48642e-05'
    """
    plane = sum((1.0 - nu**2) / e for e, nu in zip(modulus, poisson, strict=True))
    return np.asarray(np.sqrt(4.0 * load * radius * plane / math.pi), dtype=np.float64)


def local_compliance(half_width: FloatArray, depth: FloatArray, modulus: float, poisson: float) -> FloatArray:
    """Shortening of a tooth between loaded flank and centre line, per load, times face width [m^2/N].

    2 (1 - nu^2)/(pi E) (ln(2 h/a) - nu/(2 (1 - nu))), C. Weber and K. Banaschek, Formaenderung und
    Profilruecknahme bei gerad- und schraegverzahnten Raedern, Vieweg 1953: the strain under a Hertzian
    pressure of half width a, integrated over the depth h (plane strain, h well beyond a). It depends on the
    load through a.

    Parameters
    ----------
    half_width : a [m], any shape
    depth : h, from the flank to the tooth's centre line along the load [m], same shape
    modulus, poisson : E [Pa], nu [-]

    Examples
    --------
    >>> f"{local_compliance(np.array(1e-4), np.array(2e-3), 206e9, 0.3):.4e}"
    '9.7714e-12'
    """
    shape = np.log(2.0 * depth / half_width) - poisson / (2.0 * (1.0 - poisson))
    return np.asarray(2.0 * (1.0 - poisson**2) / (math.pi * modulus) * shape, dtype=np.float64)


def softening(modulus: tuple[float, float], poisson: tuple[float, float]) -> float:
    """Fall of ``local_compliance`` of both teeth with the logarithm of the load, times face width [m^2/N].

    The half width grows as the root of the load, so D = sum (1 - nu^2)/(pi E), at every position.

    Parameters
    ----------
    modulus, poisson : E [Pa] and nu [-] of both gears

    Examples
    --------
    >>> f"{softening((206e9, 206e9), (0.3, 0.3)):.4e}"
    '2.8123e-12'
    """
    return sum((1.0 - nu**2) / e for e, nu in zip(modulus, poisson, strict=True)) / math.pi
