"""Numbers as text: significant digits, SI prefixes, powers of ten. Also: reading of texts in TOML files."""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Iterable, Sequence
from importlib.resources import files
from typing import Any

_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_MINUS = "\u2212"
#: A number and its unit stay on one line.
_SPACE = "\u00a0"
#: Mantissa and exponent of a number in computer notation, such as 9.43e-03.
_EXPONENT = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)e(-\d+|\+\d{2,})(?!\w)")
_PREFIXED = frozenset({"m", "N", "Pa", "N/m", "N m", "W", "s", "Hz", "m/s", "N s/m"})
_PREFIXES = {9: "G", 6: "M", 3: "k", 0: "", -3: "m", -6: "µ", -9: "n", -12: "p"}


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
        return text.replace("-", _MINUS)
    mantissa, exponent = f"{value:.{min(digits, 3) - 1}e}".split("e")
    return f"{mantissa}{_SPACE}×{_SPACE}10{str(int(exponent)).translate(_SUPERSCRIPT)}".replace("-", _MINUS)


def quantity(
    value: float, unit: str, digits: int = 4, *, measured: bool = False, exponent: int | None = None
) -> str:
    """Return an SI number and its unit as text, with an SI prefix where a prefix is usual.

    ``exponent``: exponent of ten of the prefix; by default the prefix follows from the number. ``digits`` and
    ``measured``: as in ``number``.
    """
    if unit == "1" or value == 0.0:  # zero is printed without a unit
        return number(value, digits, measured=measured)
    if unit in _PREFIXED and math.isfinite(value):
        exponent = prefix_exponent(value, digits) if exponent is None else exponent
        value = value / 10.0**exponent
        unit = f"{_PREFIXES[exponent]}{unit}"
    return f"{number(value, digits, measured=measured)}{_SPACE}{unit.replace(' ', _SPACE)}"


def span(low: float, high: float, unit: str, digits: int = 2) -> str:
    """Return a range as text, with a common prefix and a common unit.

    ``digits``: significant digits of each end. Up to two digits are added if both ends read alike.
    """
    largest = max(abs(low), abs(high))
    exponent = prefix_exponent(largest, digits) if largest else None
    for more in range(digits, digits + 3):
        first, last = (
            quantity(end, unit, more, measured=True, exponent=exponent).partition(_SPACE)
            for end in (low, high)
        )
        if first[0] != last[0]:
            break
    return f"{first[0]} to {''.join(last)}"


def prefix_exponent(value: float, digits: int = 4) -> int:
    """Return the exponent of ten of the SI prefix with which a nonzero number is printed as 1 to 999."""
    exponent = min(max(3 * math.floor(math.log10(abs(value)) / 3), -12), 9)
    rounded = abs(float(f"{value / 10.0**exponent:.{digits}g}"))
    return exponent + 3 if rounded >= 1000.0 and exponent < 9 else exponent  # 999.99 rounds to 1000


def common_exponent(values: Sequence[float], digits: int = 4) -> int | None:
    """Return the exponent of one prefix for numbers that stand side by side. None: all numbers are 0.

    With the chosen prefix most numbers are printed without a power of ten and with at most four digits before
    the point. If two prefixes are equally good, the larger prefix is chosen.
    """
    sizes = [abs(one) for one in values if one and math.isfinite(one)]
    if not sizes:
        return None
    tried = sorted({prefix_exponent(one, digits) for one in sizes}, reverse=True)
    return max(tried, key=lambda exponent: sum(_plain_with(one, exponent) for one in sizes))


def _plain_with(size: float, exponent: int) -> bool:
    return bool(0.1 <= size / 10.0**exponent < 1e4)


def side_by_side(
    values: Iterable[float], unit: str, digits: int = 3, beside: Iterable[float] = ()
) -> tuple[list[str], str]:
    """Return texts of several SI numbers in one unit, and the text of this unit.

    The prefix is chosen by the largest number. ``digits``: significant digits of the largest number. Up to
    three decimals are added until different numbers read differently. ``beside``: other numbers of the same
    line of a table; if given, the largest of these numbers chooses the prefix.
    """
    values = [float(value) for value in values]
    largest = max(map(abs, list(beside) or values), default=0.0)
    name = "" if unit == "1" else f"{_SPACE}{unit.replace(' ', _SPACE)}"
    factor = 1.0
    if unit in _PREFIXED and largest > 0.0:
        exponent = prefix_exponent(largest, digits)
        factor = 10.0**exponent
        name = f"{_SPACE}{_PREFIXES[exponent]}{unit}"
    scaled = [value / factor for value in values]
    size = max(map(abs, scaled), default=0.0)
    first = digits - 1 - math.floor(math.log10(size)) if size > 0.0 else 0
    for places in range(max(first, 0), max(first, 0) + 4):
        texts = [f"{round(value, places) + 0.0:.{places}f}".replace("-", _MINUS) for value in scaled]
        if len(set(texts)) == len(set(values)):
            break
    return texts, name


def prose(text: str) -> str:
    """Rewrite numbers in computer notation (9.43e-03) within a text as decimals or with powers of ten."""
    return _EXPONENT.sub(_plain, text)


def _plain(match: re.Match[str]) -> str:
    mantissa, exponent_text = match.groups()
    exponent = int(exponent_text)
    if -3 <= exponent <= 4:
        _, _, decimals = mantissa.partition(".")
        places = max(len(decimals) - exponent, 0)
        return f"{float(match[0]):.{places}f}"
    factor = "" if mantissa == "1" else f"{mantissa}{_SPACE}×{_SPACE}"
    return f"{factor}10{str(exponent).translate(_SUPERSCRIPT)}"


def read_table(folder: str, file: str) -> dict[str, Any]:
    """Read a TOML file from a package. In every text of the file the lines are joined.

    ``folder``: name of the package; ``file``: name of the file.
    """
    table: dict[str, Any] = _joined(tomllib.loads((files(folder) / file).read_text(encoding="utf-8")))
    return table


def _joined(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _joined(one) for key, one in value.items()}
    if isinstance(value, list):
        return [_joined(one) for one in value]
    return " ".join(value.split()) if isinstance(value, str) else value


def percent(share: float) -> str:
    """Return a share in per cent with two digits: "3.1 %"; "< 0.01 %" for a smaller one."""
    size = 100.0 * share
    if 0.0 < size < 0.01:
        return "< 0.01 %"
    return f"{size:.0f} %" if size >= 9.95 else f"{size:.2g} %"
