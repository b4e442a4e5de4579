"""Units in headings: what is a unit, and its factor to SI."""

from __future__ import annotations

import re
from functools import lru_cache

from lumped.arguments import nearest
from lumped.errors import refuse, shown
from lumped.fields.units import to_si

#: SI unit of a quantity -> stated unit of ``lumped.fields.units`` that converts to this SI unit.
_STATED = {
    "1": "1", "m": "m", "m/s": "mm/s", "m/s^2": "m/s**2", "rad": "rad", "rad/s": "rpm", "rad/s^2": "rad/s**2",
    "N": "N", "N*m": "N*m", "N/m": "N/m", "s": "s", "kg": "kg", "kg*m^2": "kg*m**2", "Hz": "Hz",
}  # fmt: skip
#: SI unit -> units to suggest.
_USUAL = {
    "1": ("-", "%"), "m": ("m", "mm", "um"), "m/s": ("m/s", "mm/s", "um/s"),
    "m/s^2": ("m/s^2", "mm/s^2", "g"),
    "rad": ("rad", "mrad", "deg"), "rad/s": ("rad/s", "deg/s", "rpm"), "rad/s^2": ("rad/s^2", "deg/s^2"),
    "N": ("N", "kN", "lbf"), "N*m": ("N*m", "Nmm", "lbf*in"), "N/m": ("N/m", "N/um", "N/mm"),
    "s": ("s", "ms", "us"), "kg": ("kg", "g"), "kg*m^2": ("kg*m^2", "kg*mm^2"), "Hz": ("Hz", "kHz"),
}  # fmt: skip
#: Words that exporters write for a unit -> the unit.
_WORDS = {
    "mikrometer": "um", "mum": "um", "µ": "um", "μ": "um", "my": "um", "sek": "s", "secs": "s",
    "mil": "thou", "mils": "thou",
    "sekunden": "s", "sekunde": "s", "grad": "deg", "degrees": "deg", "umdrehungen": "turn",
    "revs": "turn", "rev": "turn", "newtonmeter": "N*m",
}  # fmt: skip
#: Gravity of Earth, the unit of accelerometers [m/s^2], by definition (CGPM 1901).
_STANDARD_GRAVITY = 9.80665
#: A number is no unit; 1/min is.
_NUMBER = re.compile(r"\s*[+-]?[\d.]+(?!\s*/)")
_DIMENSIONLESS = ("", "-", "–", "1", "none", "ohne")


def _plain(unit: str) -> str:
    """Return a unit in the notation of the unit parser."""
    text = unit.strip().replace("°", "deg")
    return _WORDS.get(text.lower(), re.sub(r"\b(Deg|Rad|Mm|Sec)\b", lambda word: word[0].lower(), text))


@lru_cache(maxsize=4096)
def _converted(unit: str, si: str) -> float | None:
    """Factor of a unit to an SI unit; None where the unit is unknown or of another kind."""
    if si == "1" and unit.strip() in _DIMENSIONLESS:
        return 1.0
    if si == "m/s^2" and unit.strip() in ("g", "G", "g0", "gn"):
        return _STANDARD_GRAVITY
    if len(unit) > 40 or unit.strip() in _DIMENSIONLESS or _NUMBER.match(unit):
        return None
    try:
        return to_si(f"1 {_plain(unit)}", _STATED[si])
    except ValueError:
        return None


def si_factor(unit: str, si: str, field: str) -> float:
    """Return the factor from a unit to an SI unit of the same kind, or refuse the unit of ``field``."""
    if si == "":  # matrices of statics, whose units differ from entry to entry
        return 1.0
    factor = _converted(unit, si)
    if factor is not None and factor > 0.0:
        return factor
    usual = _USUAL[si]
    advice = nearest(unit, usual) or f"Write the unit in brackets after the name, such as [{usual[-1]}]."
    raise refuse(f"{field}: unit", shown(unit), f"a unit of {si}, such as {', '.join(usual)}", advice)


def converts(unit: str, si: str) -> bool:
    """Return whether a unit converts to an SI unit."""
    return _converted(unit, si) is not None


@lru_cache(maxsize=4096)
def is_unit(text: str) -> bool:
    """Return whether a text is a unit of any quantity that is read here, or the sign of no unit."""
    if text.strip() in ("-", "–", "1"):
        return True
    return bool(text.strip()) and any(_converted(text, si) for si in _STATED)
