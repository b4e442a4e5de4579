"""A heading is split into words and a unit: "dte [um]", "TE (µm)", "theta_p / deg", "Zeit in s", "TE_um"."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import NamedTuple

from validation.check.reading.units import is_unit

#: Longest heading that is understood.
MOST_CHARACTERS = 120
#: A unit in brackets. Text after the brackets belongs to the name: "dte [um] rms".
_SQUARE = re.compile(r"^(.*?)\s*\[\s*([^\[\]]*?)\s*\]\s*(.*)$")
_ROUND = re.compile(r"^(.*?)\s*[({<]\s*([^(){}<>]*?)\s*[)}>]\s*(.*)$")
#: A unit behind a sign or word, as DIN 1313 and German tables write it.
_BEHIND = re.compile(r"^(.*\S)\s*(?:\s/\s|,\s+|\s+in\s+|;\s*|:\s+)(\S.*)$")
_LAST = re.compile(r"^(.*[^\s_.])[\s_.]+([^\s_.]+)$")
#: An argument behind the name of a function of time: theta(t).
_ARGUMENT = re.compile(r"(?<=[^\s(])(?<!^t)(?<!^s)\((t|time)\)(?=\s|$|\[)")
#: Letters of other alphabets in symbols -> words of the symbols.
_LETTERS = str.maketrans({
    "δ": "delta", "Δ": "delta", "Ü": "Ue", "θ": "theta", "ϑ": "theta", "φ": "phi", "ϕ": "phi",
    "ω": "omega", "Ω": "omega", "τ": "tau", "ä": "ae", "ö": "oe", "ü": "ue", "ß": "ss",
    "ẋ": "xdot", "ẏ": "ydot", "ẍ": "xddot",
    "ÿ": "yddot", "₁": "1", "₂": "2", "ₚ": "p",
})  # fmt: skip


class Heading(NamedTuple):
    """Words of a heading and its unit; None: the heading has no unit."""

    words: str
    unit: str | None


def readings(heading: str) -> Iterator[Heading]:
    """Yield the ways in which a heading can be split, the best first."""
    if len(heading) > MOST_CHARACTERS:
        return
    text = _ARGUMENT.sub(" ", heading.strip().strip("\"'\ufeff").strip()).strip()
    if (match := _SQUARE.match(text)) and (match[1] or match[3]):
        before, inside, after = match.groups()
        yield Heading(f"{before} {after}".strip(), inside or "-")
        yield Heading(f"{before} {inside} {after}".strip(), None)
        return
    if (match := _ROUND.match(text)) and (match[1] or match[3]):
        before, inside, after = match.groups()
        name = f"{before} {after}".strip()
        if is_unit(inside):
            yield Heading(name, inside)
        yield Heading(f"{before} {inside} {after}".strip(), None)
        yield Heading(name, inside)
        return
    if (match := _BEHIND.match(text)) and is_unit(match[2]):
        yield Heading(match[1], match[2])
    yield Heading(text, None)
    if (match := _LAST.match(text)) and is_unit(match[2]):
        yield Heading(match[1], match[2])


def words_of(text: str) -> list[str]:
    """Split a name into lower-case words: at signs, at capitals, and between letters and digits.

    >>> words_of("BearingForce_x1")
    ['bearing', 'force', 'x', '1']
    """
    latin = text.translate(_LETTERS)
    latin = re.sub(
        r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])|(?<=[A-Za-z])(?=\d)|(?<=\d)(?=[A-Za-z])", " ", latin
    )
    return [word.lower() for word in re.split(r"[^A-Za-z0-9]+", latin) if word]
