"""Several numbers as text: ranges, columns, shares. Also: reading of texts in TOML files."""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Iterable, Sequence
from importlib.resources import files
from typing import Any

from lumped.display.formatting import MINUS, PREFIXED, PREFIXES, SPACE, SUPERSCRIPT
from lumped.display.formatting import number as number
from lumped.display.formatting import prefix_exponent as prefix_exponent
from lumped.display.formatting import quantity as quantity

#: Mantissa and exponent of a number in computer notation, such as 9.43e-03.
_EXPONENT = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)e(-\d+|\+\d{2,})(?!\w)")


def span(low: float, high: float, unit: str, digits: int = 2) -> str:
    """Return a range as text, with a common prefix and a common unit.

    ``digits``: significant digits of each end. Up to two digits are added if both ends read alike.
    """
    largest = max(abs(low), abs(high))
    exponent = prefix_exponent(largest, digits) if largest else None
    for more in range(digits, digits + 3):
        first, last = (
            quantity(end, unit, more, measured=True, exponent=exponent).partition(SPACE)
            for end in (low, high)
        )
        if first[0] != last[0]:
            break
    return f"{first[0]} to {''.join(last)}"


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
    name = "" if unit == "1" else f"{SPACE}{unit.replace(' ', SPACE)}"
    factor = 1.0
    if unit in PREFIXED and largest > 0.0:
        exponent = prefix_exponent(largest, digits)
        factor = 10.0**exponent
        name = f"{SPACE}{PREFIXES[exponent]}{unit}"
    scaled = [value / factor for value in values]
    size = max(map(abs, scaled), default=0.0)
    first = digits - 1 - math.floor(math.log10(size)) if size > 0.0 else 0
    for places in range(max(first, 0), max(first, 0) + 4):
        texts = [f"{round(value, places) + 0.0:.{places}f}".replace("-", MINUS) for value in scaled]
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
    factor = "" if mantissa == "1" else f"{mantissa}{SPACE}×{SPACE}"
    return f"{factor}10{str(exponent).translate(SUPERSCRIPT)}"


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
