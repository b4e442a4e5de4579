"""Quantities as people write them -> text that pint reads: "80 Nm", "59 ft-lbf", "1450 U/min"."""

from __future__ import annotations

import re
from collections.abc import Callable

Rewriting = tuple[re.Pattern[str], str | Callable[[re.Match[str]], str]]

_WORD = "A-Za-zµμ"
#: Spellings of any quantity, rewritten one after the other.
_EVERYWHERE: tuple[Rewriting, ...] = (
    (re.compile(r"[·⋅×]"), "*"),
    (re.compile(r"\b[A-Z][a-z]{4,}"), lambda found: found[0].lower()),  # Newton, Meter
    # A power written small, raised or not at all: min-1, mm2, N m s^-1; the e of 1e-3 follows a digit.
    (re.compile(rf"(?<![\w.])([{_WORD}]+)(-?[1-4])(?![\w.])"), r"\1^\2"),
    (re.compile(rf"(?<=[{_WORD}²³])-(?=[{_WORD}])"), "*"),  # ft-lbf, newton-meters
    (re.compile(r"\bkg(c?m)(?=\^|²)"), r"kg*\1"),
    (re.compile(r"%"), " percent"),
)
_POUND_FORCE = (
    (re.compile(r"(?<![A-Za-z])(lbs?|pounds?)\b"), "lbf"),
    (re.compile(r"(?<![A-Za-z])kp(?![a-z])"), "kgf"),
    (re.compile(r"(?<![A-Za-z])kpm\b"), "kgf*m"),
)
_TURNS = (
    (re.compile(r"(?<=[\d.])\s+1\s*/\s*min\b"), " rpm"),
    (re.compile(r"(?:\b(?:rev|revs|r|tr|turns?)|(?<![A-Za-z])[Uu])?\s*/\s*min(ute)?\b"), " rpm"),
    (re.compile(r"\bmin\^-1|\bmin⁻¹|(?i:(?<![a-z])(rpm|upm)\b)"), "rpm"),
    (re.compile(r"(?<![A-Za-z])(?:rev|revs|r|tr|U)?\s*/\s*s(ec)?\b(?<=[a-zU]/s)"), " rps"),
    (re.compile(r"(?<![A-Za-z])(k?)Hz\b"), r"\1rps"),
)
#: Spellings that mean what they do in a quantity of this stated unit alone: a pound is a force in a torque.
_WHERE: dict[str, tuple[Rewriting, ...]] = {
    "N*m": _POUND_FORCE,
    "N": _POUND_FORCE,
    "N/m": _POUND_FORCE,
    "rpm": _TURNS,
    "degC": ((re.compile(r"(?<=[\d.])\s*[°º]?\s*([CF])\s*$"), r" deg\1"),),
}
#: Units that pint lacks, in its own notation; prefixes come with them.
DEFINITIONS = (
    "newton_meter = newton * meter = Nm",
    "newton_millimeter = newton * millimeter = Nmm",
    "newton_centimeter = newton * centimeter = Ncm",
    "pascal_second = pascal * second = Pas",
    "@alias pound = lbm",
)
_GAP = re.compile(r"(?<=\d)\s+(?=\d{3}(?!\d))")
_COMMA = re.compile(r"\s*([+-]?[\d.]*\d),(\d+)(?=$|[^\d,])")


def as_pint_reads(text: str, unit: str) -> str:
    """Return a quantity in pint's grammar; "lb" is a force where the stated unit is a torque, else a mass."""
    for pattern, instead in (*_EVERYWHERE, *_WHERE.get(unit, ())):
        text = pattern.sub(instead, text)
    return text


def about_digits(text: str) -> str:
    """Return what to write instead of a number with a comma or with gaps; nothing where it has neither."""
    if _GAP.search(text):  # pint would multiply the parts
        return f"leave the gap between the digits out: write '{_GAP.sub('', text)}'"
    result = _COMMA.match(text)
    if result is None:
        return "write decimals with a point" if "," in text else ""
    whole, decimals = result[1].replace(".", ""), result[2]
    rest = text[result.end() :]
    if len(decimals) == 3 and "." not in result[1]:
        return (
            f"the comma may be a decimal comma or part thousands: write '{whole}.{decimals}{rest}' or "
            f"'{whole}{decimals}{rest}'"
        )
    return f"this is a decimal comma: write '{whole}.{decimals}{rest}'"
