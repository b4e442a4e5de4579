"""The trial set: sound records, records with one mistake, records with two.

Every case is the parameter file of the pair that the user says he modelled, and the curves of his program.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from benchmarks.foreign_models.mistakes import Wrong
from benchmarks.foreign_models.sound import sound_recipes
from benchmarks.foreign_models.two import TWO
from benchmarks.foreign_models.wrong import WRONG

KINDS = ("sound", "wrong", "two")


class Case(NamedTuple):
    """One record of a user.

    Attributes
    ----------
    name : unique
    kind : "sound", "wrong" with one mistake, or "two" mistakes
    truth : the mistakes in plain words; empty for a sound record
    pair : the parameter file that the user says he modelled, for ``lumped.load_gear_pair``
    curves : makes the record: "time" [s] and channels by the names and signs of the result datasets, SI;
        normal_load and friction_force have the shape (pair, time), mesh_force is the sum of the normal loads
    """

    name: str
    kind: str
    truth: tuple[str, ...]
    pair: Mapping[str, Any]
    curves: Callable[[], Mapping[str, np.ndarray]]


def cases(kind: str | None = None) -> list[Case]:
    """Return the cases of a kind, or all."""
    sound = [Case(name, "sound", (), recipe.pair, recipe) for name, recipe in sound_recipes()]
    every = [*sound, *(case_of(one, "wrong") for one in WRONG), *(case_of(one, "two") for one in TWO)]
    return [case for case in every if kind in (None, case.kind)]


def case_of(one: Wrong, kind: str) -> Case:
    truth = tuple(mistake.words for mistake in one.mistakes)
    return Case(one.name, kind, truth, one.pair, one.recipe())
