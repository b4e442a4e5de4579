"""The ISO viscosity grade of an oil as drawings and data sheets name it.

Sources: ISO 3448 (grades and their mid-points at 40 degC); DIN 51517 (CLP) and DIN 51524 (HLP).
"""

from __future__ import annotations

import math
import re

import numpy as np

from lumped.errors import quoted, refuse, shown
from lumped.fields.units import to_si
from lumped.lubrication.viscosity import ISO_VG_MIDPOINT

_GRADE = re.compile(
    r"\s*(?:(?:clp|hlp)\b)?\s*(?:iso(?:\s*3448)?)?[\s_-]*(?:vg)?[\s_-]*(\d{1,4})\s*", re.IGNORECASE
)
#: The temperature of a grade may stand behind its viscosity.
_AT_40 = re.compile(r"\s*(?:at|@|,)?\s*40\s*(?:°|º|deg)?\s*C\s*$")


def grade_of(value: object, field: str = "") -> int:
    """Return the ISO viscosity grade of a number or text. The number may be any number, see ``midpoint``.

    Parameters
    ----------
    value : 68, "ISO VG 68", "VG68", "CLP 68" (DIN 51517: a mineral gear oil of this grade), or "68 cSt": the
        mid-point of a grade, a kinematic viscosity at 40 degC
    field : name of the field in a refusal

    Raises
    ------
    ParameterError : anything else, such as a viscosity between the grades or an SAE number

    >>> grade_of("ISO VG 68"), grade_of("68 cSt"), grade_of("4.6 mm2/s at 40 °C")
    (68, 68, 5)
    """
    text = value if isinstance(value, str) else quoted(value)
    if match := _GRADE.fullmatch(text) if isinstance(value, (int, str, np.integer)) else None:
        return int(match[1])
    allowed = "an ISO viscosity grade, such as 'ISO VG 220', or its viscosity at 40 degC"
    try:
        nu = 1e6 * to_si(_AT_40.sub("", value), "mm**2/s") if isinstance(value, str) else math.nan
    except (ValueError, OverflowError):
        nu = math.nan
    if math.isnan(nu):
        action = (
            "SAE numbers are classes of the viscosity at 100 degC: write the ISO VG grade of the data sheet."
            if "sae" in text.lower()
            else "For example vg220."
        )
        raise refuse(field, shown(text), allowed, action)
    for grade, middle in ISO_VG_MIDPOINT.items():
        if math.isclose(nu, middle, rel_tol=1e-9):
            return grade
    near = min(ISO_VG_MIDPOINT, key=lambda grade: abs(math.log(max(nu, 1e-9) / ISO_VG_MIDPOINT[grade])))
    action = (
        f"No grade of ISO 3448 has that mid-point; the nearest is VG {near}. For an oil between grades write "
        "kinematic_viscosity_40 and kinematic_viscosity_100 in lubricant.viscosity_law."
    )
    raise refuse(field, shown(text), allowed, action)
