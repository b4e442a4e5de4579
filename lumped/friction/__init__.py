"""Friction laws of the tooth contact, one file each, and their registry."""

from lumped.friction.base import ContactPath, FrictionLaw, FrictionSettings, mean_coefficient
from lumped.friction.benedict_kelley import benedict_kelley
from lumped.friction.composite import composite
from lumped.friction.coulomb import coulomb
from lumped.friction.registry import FRICTIONAL, LAWS
from lumped.friction.smoothed_coulomb import smoothed_coulomb
from lumped.friction.xu_kahraman import xu_kahraman

__all__ = [
    "FRICTIONAL",
    "LAWS",
    "ContactPath",
    "FrictionLaw",
    "FrictionSettings",
    "benedict_kelley",
    "composite",
    "coulomb",
    "mean_coefficient",
    "smoothed_coulomb",
    "xu_kahraman",
]
