"""Numbers for readers: significant digits, SI prefixes, powers of ten; words that stand in TOML files."""

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
#: Mantissa and exponent of a number as a computer writes it.
_EXPONENT = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)e(-\d+|\+\d{2,})(?!\w)")
_PREFIXED = frozenset({"m", "N", "Pa", "N/m", "N m", "W", "s", "Hz", "m/s", "N s/m"})
_PREFIXES = {9: "G", 6: "M", 3: "k", 0: "", -3: "m", -6: "µ", -9: "n", -12: "p"}


def number(value: float, digits: int = 4, *, measured: bool = False) -> str:
    """A number with significant digits; powers of ten outside 0.001 to 99999.

    Zeros at the end are left out, but where the number is good to that many digits (``measured``).
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
    """A number in SI with its unit, prefixed where that is usual.

    ``exponent`` of ten of the prefix, by default the number's own; other arguments as those of ``number``.
    """
    if unit == "1" or value == 0.0:  # nothing has no unit that a reader would miss
        return number(value, digits, measured=measured)
    if unit in _PREFIXED and math.isfinite(value):
        exponent = prefix_exponent(value, digits) if exponent is None else exponent
        value = value / 10.0**exponent
        unit = f"{_PREFIXES[exponent]}{unit}"
    return f"{number(value, digits, measured=measured)}{_SPACE}{unit.replace(' ', _SPACE)}"


def span(low: float, high: float, unit: str, digits: int = 2) -> str:
    """A range with one prefix and one unit, each end with its digits, more where they read alike."""
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
    """Exponent of ten of the SI prefix with which a number other than 0 is printed from 1 to 999."""
    exponent = min(max(3 * math.floor(math.log10(abs(value)) / 3), -12), 9)
    rounded = abs(float(f"{value / 10.0**exponent:.{digits}g}"))
    return exponent + 3 if rounded >= 1000.0 and exponent < 9 else exponent  # 999.99 rounds to 1000


def common_exponent(values: Sequence[float], digits: int = 4) -> int | None:
    """Exponent of the one prefix of numbers that are read beside each other; None where all are 0.

    It is the one with which most are printed without a power of ten and with at most four digits before the
    point; of two alike that of the larger prefix.
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
    """Numbers in SI in the unit of the largest, with decimals that tell them apart; and that unit.

    ``digits`` of the largest, and at most three further ones; what is equal then reads the same.
    ``beside``: other numbers of the same line of a table, whose largest chooses the unit.
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
    """Text in which numbers as a computer writes them (9.43e-03) are as people write them."""
    return _EXPONENT.sub(_plain, text)


def _plain(match: re.Match[str]) -> str:
    mantissa = match[1]
    exponent = int(match[2])
    if -3 <= exponent <= 4:
        places = max(len(mantissa.partition(".")[2]) - exponent, 0)
        return f"{float(match[0]):.{places}f}"
    factor = "" if mantissa == "1" else f"{mantissa}{_SPACE}×{_SPACE}"
    return f"{factor}10{str(exponent).translate(_SUPERSCRIPT)}"


def read_table(folder: str, file: str) -> dict[str, Any]:
    """Read a TOML file of a package; the lines of every text in it are joined.

    ``folder``: package that the file is in; ``file``: its name.
    """
    found: dict[str, Any] = _joined(tomllib.loads((files(folder) / file).read_text(encoding="utf-8")))
    return found


def _joined(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _joined(one) for key, one in value.items()}
    if isinstance(value, list):
        return [_joined(one) for one in value]
    return " ".join(value.split()) if isinstance(value, str) else value
