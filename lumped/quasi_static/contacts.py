"""The forms of contact by name, and the element laws of a pair in its own form.

Sources: Abbas Al-Zubaidi 2008, eqs. 3 and 4; docs/theory/contact_energy.md.
"""

from __future__ import annotations

from lumped.quasi_static.elements import Contact, MeshElements
from lumped.quasi_static.loaded import Loaded
from lumped.quasi_static.prescribed import Prescribed
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair

#: ``mesh.contact`` -> the form.
CONTACTS: dict[str, Contact] = {form.name: form for form in (Prescribed(), Loaded())}


def contact_of(pair: GearPair) -> Contact:
    """Return the form of contact of a pair."""
    return CONTACTS[pair.mesh.contact]


def mesh_elements(pair: AnyPair) -> MeshElements:
    """Return the element laws of a gear pair.

    Raises
    ------
    ParameterError : a law refuses its parameters
    NumericalError : a law is not finite on the path of contact
    """
    pair = load_gear_pair(pair)
    return contact_of(pair).elements(pair)
