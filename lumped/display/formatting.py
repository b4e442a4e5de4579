"""Numbers as text: significant digits, SI prefixes, powers of ten."""

from __future__ import annotations

import math

#: Digits of an exponent of ten.
SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
MINUS = "\u2212"
#: A number and its unit stay on one line.
SPACE = "\u00a0"
#: Units that take an SI prefix.
PREFIXED = frozenset({"m", "N", "Pa", "N/m", "N m", "W", "s", "Hz", "m/s", "N s/m"})
#: Exponent of ten -> SI prefix.
PREFIXES = {9: "G", 6: "M", 3: "k", 0: "", -3: "m", -6: "µ", -9: "n", -12: "p"}


def number(value: float, digits: int = 4, *, measured: bool = False) -> str:
    """Return a number as text with significant digits, with a power of ten outside 0.001 to 99999.

    Zeros at the end are removed. With ``measured`` they stay, because the number is accurate to all digits.
    """
    if not math.isfinite(value):
        return "n/a"
    if value == 0.0:
        return "0"
    if 1e-3 <= abs(value) < 1e5:
        # Digits before the point are never rounded away: 16663 stays 16660 at four digits, not 1.666e+04.
        rounded = abs(float(f"{value:.{digits}g}"))  # 0.99999 to two digits is 1.0
        places = max(digits - 1 - math.floor(math.log10(rounded)), 0)
        text = f"{float(f'{value:.{digits}g}'):.{places}f}"
        text = text.rstrip("0").rstrip(".") if "." in text and not measured else text
        return text.replace("-", MINUS)
    mantissa, exponent = f"{value:.{min(digits, 3) - 1}e}".split("e")
    return f"{mantissa}{SPACE}×{SPACE}10{str(int(exponent)).translate(SUPERSCRIPT)}".replace("-", MINUS)


def quantity(
    value: float, unit: str, digits: int = 4, *, measured: bool = False, exponent: int | None = None
) -> str:
    """Return an SI number and its unit as text, with an SI prefix where a prefix is usual.

    ``exponent``: exponent of ten of the prefix; by default the prefix follows from the number. ``digits`` and
    ``measured``: as in ``number``.
    """
    if unit == "1" or value == 0.0:  # zero is printed without a unit
        return number(value, digits, measured=measured)
    if unit in PREFIXED and math.isfinite(value):
        exponent = prefix_exponent(value, digits) if exponent is None else exponent
        value = value / 10.0**exponent
        unit = f"{PREFIXES[exponent]}{unit}"
    return f"{number(value, digits, measured=measured)}{SPACE}{unit.replace(' ', SPACE)}"


def prefix_exponent(value: float, digits: int = 4) -> int:
    """Return the exponent of ten of the SI prefix with which a nonzero number is printed as 1 to 999."""
    exponent = min(max(3 * math.floor(math.log10(abs(value)) / 3), -12), 9)
    rounded = abs(float(f"{value / 10.0**exponent:.{digits}g}"))
    return exponent + 3 if rounded >= 1000.0 and exponent < 9 else exponent  # 999.99 rounds to 1000
