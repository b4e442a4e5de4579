"""Friction laws I to V of the tooth contact, one file each, and mu of a pair over the path of contact."""

from lumped.friction.along_path import (
    contact_path,
    friction_path_function,
    friction_settings,
    law_range_violations,
    mean_coefficient,
)
from lumped.friction.base import ContactPath, FrictionLaw, FrictionSettings
from lumped.friction.benedict_kelley import benedict_kelley
from lumped.friction.composite import composite
from lumped.friction.coulomb import coulomb
from lumped.friction.profile import friction_profile
from lumped.friction.registry import LAWS
from lumped.friction.smoothed_coulomb import smoothed_coulomb
from lumped.friction.xu_kahraman import xu_kahraman

__all__ = [
    "LAWS",
    "ContactPath",
    "FrictionLaw",
    "FrictionSettings",
    "benedict_kelley",
    "composite",
    "contact_path",
    "coulomb",
    "friction_path_function",
    "friction_profile",
    "friction_settings",
    "law_range_violations",
    "mean_coefficient",
    "smoothed_coulomb",
    "xu_kahraman",
]
