"""Flank tolerances of ISO 1328-1 and index deviations drawn within them.

Sources: ISO 1328-1:2013, eqs. of clause 5 (formulas from memory, see docs/theory/teeth.md).
"""

from __future__ import annotations

import math
import random
import re
import warnings

import numpy as np

from lumped.errors import refuse, shown
from lumped.typing import FloatArray

_CLASS = re.compile(
    r"\s*(?:(?P<body>DIN\s+EN\s+ISO|DIN\s+ISO|ISO|DIN)[\s-]*(?P<number>\d{4}(?:-\d)?(?::\d{4})?)?[\s,:-]*)?"
    r"(?:class|grade|quality|qualität|q)?\s*(?P<of>\d{1,2})\s*",
    re.IGNORECASE,
)


def tolerance_class_of(value: object) -> object:
    """Return the tolerance class of a text. Any other value is returned unchanged, and checked later.

    "ISO 6", "ISO 1328-1:2013 class 6", "Q6" and "6" are class 6 of ISO 1328-1:2013. "DIN 6" is class 6 of
    DIN 3962. DIN 3962 has another table: the text is read as the ISO class of the same number, with a
    warning. For modules of 1 to 2 mm and diameters of 50 to 560 mm, f_p and F_p of class 6 differ by less
    than a fifth (docs/theory/teeth.md).

    Raises
    ------
    ParameterError : text that names no class of these standards

    >>> tolerance_class_of("ISO 6"), tolerance_class_of("ISO 1328-1:2013 class 7"), tolerance_class_of(8)
    (6, 7, 8)
    """
    if not isinstance(value, str):
        return value
    match = _CLASS.fullmatch(value)
    body, number = (match["body"] or "", match["number"] or "") if match else ("", "")
    german = body.upper() == "DIN" and not number.startswith("1328")
    if not match or (number and not number.startswith("396" if german else "1328")):
        action = "Write the class of ISO 1328-1, 1 to 11: a smaller number is a more accurate gear."
        if "agma" in value.lower():
            action += (
                " Quality numbers of AGMA 2000 count the other way: 17 less the number is about the class."
            )
        raise refuse("", shown(repr(value)), "1 to 11, or text such as 'ISO 6' or 'DIN 6'", action)
    if german:
        warnings.warn(
            f"{shown(value)!r} is read as class {match['of']} of ISO 1328-1:2013: DIN 3962 has its own table "
            "of tolerances, which is near. Give measured deviations where the difference matters.",
            UserWarning,
            stacklevel=2,
        )
    return int(match["of"])


def flank_tolerances(teeth: int, module: float, tolerance_class: int) -> dict[str, float]:
    """Tolerances of a spur gear's flanks by ISO 1328-1:2013 [m].

    Parameters
    ----------
    teeth : number of teeth
    module : [m]
    tolerance_class : 1 to 11

    Returns
    -------
    "f_p", "F_p" single pitch and total cumulative pitch, "f_Ha", "f_fa", "F_a" profile slope, form and total,
    "F_r" runout

    Raises
    ------
    ParameterError : a class that the standard does not have
    """
    if not 1 <= tolerance_class <= 11:
        raise refuse("tolerance_class", tolerance_class, "1 to 11", "Choose a class of ISO 1328-1:2013.")
    m = module * 1e3
    d = m * teeth
    step = 1e-6 * math.sqrt(2.0) ** (tolerance_class - 5)
    slope = 0.4 * m + 0.001 * d + 4.0
    form = 0.55 * m + 5.0
    cumulative = 0.002 * d + 0.55 * math.sqrt(d) + 0.7 * m + 12.0
    tolerances = {"f_p": 0.001 * d + 0.4 * m + 5.0, "F_p": cumulative, "f_Ha": slope, "f_fa": form}
    tolerances |= {"F_a": math.hypot(slope, form), "F_r": 0.9 * cumulative}
    return {name: value * step for name, value in tolerances.items()}


def drawn_index(teeth: int, module: float, tolerance_class: int, seed: int) -> FloatArray:
    """Index deviations (teeth,) of a random gear of a class [m], the same for each seed.

    Pitch deviations are white, of zero sum; a first harmonic of as large a range as the tolerance F_p is
    added to the sum of the pitch deviations. All deviations are scaled until the largest pitch deviation or
    the range reaches the tolerance.
    """
    tolerance = flank_tolerances(teeth, module, tolerance_class)
    draw = random.Random(seed).random

    def normal() -> float:  # Box and Muller
        return math.sqrt(-2.0 * math.log(1.0 - draw())) * math.cos(2.0 * math.pi * draw())

    pitch = np.array([normal() for _ in range(teeth)])
    index = np.cumsum(0.5 * tolerance["f_p"] * (pitch - pitch.mean()))
    turn = 2.0 * math.pi * (np.arange(teeth) / teeth + draw())
    index += 0.5 * tolerance["F_p"] * np.cos(turn)
    largest = np.abs(np.diff(index, prepend=index[-1])).max()
    index *= min(tolerance["f_p"] / largest, tolerance["F_p"] / np.ptp(index))
    return np.asarray(index - index.mean(), dtype=np.float64)
