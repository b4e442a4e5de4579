"""The table of guards: every range, doubt and refusal, each tried just inside and just outside its limit.

A row says where its limit comes from, and derives it from the numbers of a pair's file where it is not one
number (``by_hand``). Rows run on the unlike pairs, once with the pinion in question and once with the gear.
The limits are written here and not read from the program: one that changes there fails here.

========== ==================================================================================================
declared   ranges of the numbers of a parameter file
refused    what cannot exist: limits that follow from several numbers of a pair
fits       ranges in which published fits hold
doubts     values that hardly can be meant, assumptions of the model
========== ==================================================================================================

``tests/<package>/<folder>/test_guards.py`` runs the rows of ``<package>/<folder>``, and
``tests/meta/test_guards.py`` looks for guards without a row.
"""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tests.guards.declared import DECLARED, WHOLE, numbers, whole_numbers
from tests.guards.doubts import DOUBTED, Level
from tests.guards.fits import FITS, RANGES
from tests.guards.guard import GEARS, Choice, Guard
from tests.guards.refused import REFUSED

#: Every row but those of ``declared``, which have a table of their own.
GUARDS: tuple[Guard | Choice | Level, ...] = (*REFUSED, *FITS, *DOUBTED)

__all__ = ["DECLARED", "GUARDS", "RANGES", "WHOLE", "declared_fields", "guards_of"]


def guards_of(folder: str) -> Callable[[Guard | Choice | Level], None]:
    """The test of the rows of one folder of a package."""
    rows = [row for row in GUARDS if row.where.rpartition("/")[0] == folder]
    assert rows, f"no guard is in {folder}"

    @pytest.mark.parametrize("guard", rows, ids=[row.title for row in rows])
    def test(guard: Guard | Choice | Level) -> None:
        complaints = guard.complaints()
        assert not complaints, f"{guard.names}, {guard.source}:\n" + "\n".join(complaints)

    return test


def declared_fields() -> dict[str, Callable[[], list[str]]]:
    """Field of a parameter file -> its complaints about values around each of its limits."""
    rows: dict[str, Callable[[], list[str]]] = {}
    for pattern, (text, _) in DECLARED.items():
        for path in {pattern.format(gear=gear): None for gear in GEARS}:
            rows[path] = lambda path=path, text=text: list(numbers(path, text))
    for pattern, (low, high, _) in WHOLE.items():
        for path in {pattern.format(gear=gear): None for gear in GEARS}:
            rows[path] = lambda path=path, low=low, high=high: list(whole_numbers(path, low, high))
    return rows
