"""The table of guards: every range, doubt and refusal, each tried just inside and just outside its limit.

A row says where its limit comes from, and derives it from the numbers of a pair's file where it is not one
number (``by_hand``). Rows run on the unlike pairs, once with the pinion in question and once with the gear.
The limits are written here and not read from the program: one that changes there fails here.

========== ==================================================================================================
declared   ranges of the numbers of a parameter file
refused    what cannot exist: limits that follow from several numbers of a pair
fits       ranges in which published fits hold
doubts     values that hardly can be meant, assumptions of the model
verdicts   page 1 of the report
========== ==================================================================================================

``tests/<package>/<folder>/test_guards.py`` runs the rows of ``<package>/<folder>``, and
``tests/meta/test_guards.py`` looks for guards without a row.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterator
from typing import Protocol

import pytest

#: Folder whose guards a module of this table has, and its rows there. They are imported where they run.
_TABLES = {
    "refused": ("lumped", "REFUSED"),
    "fits": ("lumped", "FITS"),
    "doubts": ("validation/validity", "DOUBTED"),
    "verdicts": ("validation/reporting", "TURNS"),
}


class Row(Protocol):
    """What rows of every kind have."""

    @property
    def where(self) -> str:
        """The file that has the guard."""

    @property
    def names(self) -> str:
        """The field, range, flag or sentence by which it acts."""

    @property
    def title(self) -> str:
        """Name of the row in the list of tests."""

    @property
    def source(self) -> str:
        """Where the limit comes from."""

    def complaints(self) -> list[str]:
        """What the program does otherwise than the row says; empty where it is right."""


def rows(folder: str = "") -> Iterator[Row]:
    """Rows of a folder; default all rows but those of ``declared``, which has a list of fields."""
    for module, (place, name) in _TABLES.items():
        if folder.startswith(place) or not folder:
            table = getattr(importlib.import_module(f"tests.guards.{module}"), name)
            yield from (row for row in table if not folder or row.where.rpartition("/")[0] == folder)


def guards_of(folder: str) -> Callable[[Row], None]:
    """The test of the rows of one folder of a package."""
    own = list(rows(folder))
    assert own, f"no guard is in {folder}"

    @pytest.mark.parametrize("guard", own, ids=[row.title for row in own])
    def test(guard: Row) -> None:
        complaints = guard.complaints()
        assert not complaints, f"{guard.names}, {guard.source}:\n" + "\n".join(complaints)

    return test
