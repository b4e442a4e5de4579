"""Words and unit of an attribute of a result, read from the docstring that documents the attribute."""

from __future__ import annotations

import inspect
import re
from functools import cache, cached_property
from typing import NamedTuple

#: An entry of "Attributes" in a docstring: one or several names, then words over one or more lines.
_ENTRY = re.compile(r"^(\w+(?:, \w+)*) : (.*(?:\n +.*)*)", re.MULTILINE)
#: A unit in words: [m], [N m], [-], [kg m^2]. A list of examples in brackets is no unit.
_UNIT = re.compile(r"\s*\[([A-Za-z%°µ^*/ 0-9-]{1,12})\]")
#: Shape of an array in front of its words: (n,), (k, 2).
_SHAPE = re.compile(r"^\((?:\w+, ?)*\w*\) ")
#: End of a sentence. A point inside a number or an abbreviation has no blank and capital behind it.
_SENTENCE = re.compile(r"(?<=[^.\d])\.(?=\s+[A-Z]|\s*$)")


class Description(NamedTuple):
    """What an attribute means.

    Attributes
    ----------
    words : the meaning, one phrase; empty: the attribute has no documentation
    unit : unit of the value; "1": a pure number; empty: the documentation states no unit
    """

    words: str
    unit: str


@cache
def description(owner: type, name: str) -> Description:
    """Return words and unit of an attribute, from "Attributes" of the class or from a property's docstring.

    Parameters
    ----------
    owner : class of the result
    name : name of the attribute
    """
    member = inspect.getattr_static(owner, name, None)
    if isinstance(member, (property, cached_property)):
        return _parsed(_first_sentence(member))
    for base in owner.__mro__:
        _, _, entries = inspect.cleandoc(base.__doc__ or "").partition("\nAttributes\n----------\n")
        for names, words in _ENTRY.findall(entries):
            together = names.split(", ")
            if name in together:
                described = _parsed(words, together.index(name), len(together))
                return described if described.unit else described._replace(unit=_common_unit(base))
    return Description("", "")


def _first_sentence(documented: object) -> str:
    return _SENTENCE.split(inspect.cleandoc(documented.__doc__ or ""), maxsplit=1)[0]


def _common_unit(owner: type) -> str:
    """Unit that the first sentence of a class states for all its attributes; empty: it states none."""
    return _parsed(_first_sentence(owner)).unit


def _parsed(text: str, place: int = 0, places: int = 1) -> Description:
    """Words and unit of one entry. Of ``places`` names with as many phrases, each name has its phrase."""
    joined = _SHAPE.sub("", " ".join(text.split()).replace("`", ""))
    unit = _UNIT.search(joined)
    words = _UNIT.sub("", joined, count=1).split(";")[0].rstrip("., ").strip()
    phrases = [phrase.strip().removeprefix("and ") for phrase in words.split(",")]
    if places > 1 and len(phrases) == places:
        words = phrases[place]
    stated = "" if unit is None else unit[1]
    if words[1:2].islower():
        words = words[0].lower() + words[1:]
    return Description(words, "1" if stated == "-" else stated)
