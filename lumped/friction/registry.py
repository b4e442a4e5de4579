"""The friction laws by name: "none" and six laws in `LAWS`, and the table of a user (``friction.table``).

A further law is a file beside this one, and its ``LAW`` in `LAWS`. The second, optional place is
``multibody/contact/friction.py``. Where the multibody model has no formula of a law, it reads mu(xi) of the
lumped model, and no independent formula checks the law. CONTRIBUTING.md, "Add a friction law", has the steps.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from lumped.arguments import one_of
from lumped.errors import refuse
from lumped.friction.base import FrictionLaw, FrictionSettings
from lumped.friction.benedict_kelley import LAW as BENEDICT_KELLEY
from lumped.friction.composite import LAW as COMPOSITE
from lumped.friction.coulomb import LAW as COULOMB
from lumped.friction.iso_14179 import LAW as ISO_14179
from lumped.friction.smoothed_coulomb import LAW as SMOOTHED_COULOMB
from lumped.friction.table import TABLE
from lumped.friction.xu_kahraman import LAW as XU_KAHRAMAN

#: The law "none": mu is 0.
NO_FRICTION = FrictionLaw(
    name="none",
    label="no friction",
    formula=lambda xi, path, settings: np.zeros_like(xi),
    switches=lambda path, settings: [],
    reads=frozenset(),
    varies=False,
)

#: Every law that ``friction.law`` may name, in the order of the paper, then those that it does not have.
LAWS: Mapping[str, FrictionLaw] = MappingProxyType(
    {
        law.name: law
        for law in (
            NO_FRICTION,
            COULOMB,
            BENEDICT_KELLEY,
            XU_KAHRAMAN,
            SMOOTHED_COULOMB,
            COMPOSITE,
            ISO_14179,
        )
    }
)


#: Names of the laws with friction that need no table.
FRICTIONAL = tuple(name for name in LAWS if name != NO_FRICTION.name)
#: Every name of ``friction.law``.
NAMES = (*LAWS, TABLE)


#: What to do where the law is "table" and the pair has no table.
NO_TABLE = "Give friction.table, or in Python pair.with_(law=...) a function, an array or columns."


def _plain(text: str) -> str:
    return re.sub(r"[\W_]+", " ", text).strip().casefold().removeprefix("law ")


_SPELLINGS = {
    _plain(spelling): law.name
    for law in LAWS.values()
    for spelling in (law.name, law.label, law.numeral, law.title)
    if spelling
}


def file_name(spelling: object) -> object:
    """Return the name in parameter files of a law by number or label: "II", "Coulomb", "law III".

    A value that names no law is returned unchanged.
    """
    return _SPELLINGS.get(_plain(spelling), spelling) if isinstance(spelling, str) else spelling


def law_of(settings: FrictionSettings, name: str | None = None) -> FrictionLaw:
    """Return a law by name in parameter files, number or label; default: the law of the pair."""
    law_name = file_name(settings.law if name is None else name)
    one_of("friction.law", law_name, NAMES)
    if law_name != TABLE:
        return LAWS[str(law_name)]
    if settings.own_law is None:
        raise refuse("friction.table", None, "a table of mu over the path of contact", NO_TABLE)
    return settings.own_law


def laws_with_friction(settings: FrictionSettings) -> dict[str, FrictionLaw]:
    """Return the laws with which a pair can be computed: all with a formula, and the table of the pair."""
    table = {} if settings.own_law is None else {TABLE: settings.own_law}
    return {name: LAWS[name] for name in FRICTIONAL} | table
