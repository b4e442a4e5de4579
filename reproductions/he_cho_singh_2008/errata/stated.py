"""An erratum by its equation: the words of ``errata.toml`` with the numbers of a computation in them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from reproductions.he_cho_singh_2008.records import Erratum, Evidence
from validation.files.formatting import read_table

_TABLE = read_table("reproductions.he_cho_singh_2008.errata", "errata.toml")
_WORDS = {row["equation"]: row for row in _TABLE["erratum"]}


def stated(equation: str, numbers: Mapping[str, Any], further: Iterable[Evidence] = ()) -> Erratum:
    """Return the erratum of an equation.

    Parameters
    ----------
    equation : number of the equation, as in ``errata.toml``
    numbers : name -> number; the text has these names in braces, the evidence has them as entries
    further : evidence to add after the evidence of the file
    """
    words = _WORDS[equation]

    def evidence(quantity: str, unit: str, printed: Any, repaired: Any, requirement: str = "") -> Evidence:
        quantity = quantity.format(**numbers)
        return Evidence(
            quantity, unit, numbers.get(printed, printed), numbers.get(repaired, repaired), requirement
        )

    rows_of_evidence = (evidence(*row) for row in words.get("evidence", ()))
    text = words["text"].format(**numbers)
    return Erratum(**words | {"text": text, "evidence": (*rows_of_evidence, *further)})
