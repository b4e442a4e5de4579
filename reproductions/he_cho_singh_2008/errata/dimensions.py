"""Dimension checks of the printed equations, with pint.

Each function writes one equation down with units and says what comes out. Checks that dimensions cannot
decide are not here: the errata say so.
"""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    import pint

PASSES = "passes"


@cache
def _registry() -> pint.UnitRegistry[Any]:
    import pint

    return pint.UnitRegistry()


def _sum_check(*terms: Any) -> str:
    """Whether quantities may be added."""
    import pint

    total = terms[0]
    try:
        for term in terms[1:]:
            total = total + term
    except pint.DimensionalityError as error:
        return f"fails: a term in {error.units2} is added to one in {error.units1}"
    return PASSES


def verdicts(check: Callable[[bool], str]) -> dict[str, str]:
    """What the dimension check of an equation says of it as printed and as repaired, for ``stated``."""
    return {"dimension_printed": check(True), "dimension_repaired": check(False)}


def equation_8(printed: bool) -> str:
    """Inertia, damping, stiffness and friction terms of the pinion's OLOA equation."""
    u = _registry()
    # x and y are both lengths: the mixed-up symbols of the print do not show in the dimensions.
    displacement = 1.0 * u.m
    inertia = (1.0 * u.kg) * displacement / u.s**2
    stiffness = (1.0 * u.N / u.m) * displacement
    damping = ((1.0 * u.N / u.m) * (1.0 * u.kg)) ** 0.5 * displacement / u.s
    return _sum_check(inertia, damping, stiffness, -1.0 * u.N)


def equation_14(printed: bool) -> str:
    """Logarithm's argument in law II: its constant carries units, so any velocity cubed passes."""
    u = _registry()
    v_s = 2.0 * u.m / u.s
    v_e = 10.0 * u.m / u.s
    velocities = v_s * v_s**2 if printed else v_s * v_e**2
    constant = 29700.0 * u.mPa * u.s * (u.m / u.s) ** 3 / (u.N / u.mm)
    argument = constant * (100.0 * u.N / u.mm) / (10.0 * u.mPa * u.s * velocities)
    return PASSES if argument.check("[]") else f"fails: {argument.dimensionality}"


def equation_16(printed: bool) -> str:
    """sqrt(w E'/(2000 pi rho)): the printed symbol rho_h is a radius, the repaired p_h a pressure."""
    u = _registry()
    value = ((100.0 * u.N / u.mm) * (226.0 * u.GPa) / (8.0 * u.mm)) ** 0.5
    wanted = "[length]" if printed else "[pressure]"
    return PASSES if value.check(wanted) else f"fails: a {wanted[1:-1]} is set equal to a pressure"


def hertz_factor() -> float:
    """The pure number that turns sqrt(N/mm * GPa / mm) into GPa: 1/sqrt(1000), the 2000 of equation 16."""
    u = _registry()
    return float(((1.0 * u.N / u.mm) * (1.0 * u.GPa) / (1.0 * u.mm)).to("GPa**2").magnitude ** 0.5)


def equation_19(printed: bool) -> str:
    """The two summands of law IV: arctan(Phi d) and d (...)/(1 + Phi^2 d^2)."""
    u = _registry()
    d = 0.1 * u.mm
    phi = 50.0 / u.mm
    sigma = 1.64 * u.dimensionless
    first = (phi * d).to("").magnitude * u.dimensionless  # arctan of it is a pure number
    second = d * (sigma if printed else phi) / (1.0 + (phi * d) ** 2)
    return _sum_check(first, second)


def speed_exponent() -> float:
    """log10 of the factor that makes eta v_e/(E rho) dimensionless for mPa s, m/s, N/mm^2 and mm (21d)."""
    u = _registry()
    value = (1.0 * u.mPa * u.s) * (1.0 * u.m / u.s) / ((1.0 * u.N / u.mm**2) * (1.0 * u.mm))
    return math.log10(float(value.to("").magnitude))


def film_exponent() -> float:
    """log10 of the factor from H_c rho in mm to a film in um (21a)."""
    return math.log10(float((1.0 * _registry().mm).to("um").magnitude))
