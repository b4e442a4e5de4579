"""Mistakes in what a friction law reads: velocities, load, modulus. The rest of the model keeps its values.

Each mistake is a contact path that gives the law another value.

Sources: docs/how_to/check_your_model.md, "Explanations"; docs/theory/friction.md for the laws.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields, replace
from types import MappingProxyType
from typing import Literal, NamedTuple

import numpy as np

from lumped.friction.average_coefficient import longer_path
from lumped.friction.base import ContactPath
from lumped.friction.registry import law_of
from lumped.path_function import PathFunction
from lumped.path_of_contact.friction import contact_path, fit_law
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray

FrictionInput = Literal[
    "",
    "mean of the rolling velocities",
    "sum of the rolling velocities",
    "sum of the rolling velocities everywhere",
    "half of the slide-to-roll ratio",
    "half of the modulus",
    "twice the modulus",
    "half of the load",
    "load per metre",
    "viscosity in pascal seconds",
    "radius in millimetres",
    "smooth flanks",
]


class _MeanRolling(ContactPath):
    """The mean of both rolling velocities where a law wants their sum."""

    def entraining_velocity(self, xi: FloatArray) -> FloatArray:
        return 0.5 * super().entraining_velocity(xi)


class _SumOfRolling(ContactPath):
    """The sum of both rolling velocities where a law wants their mean; the slide-to-roll ratio is right."""

    def entraining_velocity(self, xi: FloatArray) -> FloatArray:
        return 2.0 * super().entraining_velocity(xi)

    def slide_to_roll(self, xi: FloatArray) -> FloatArray:
        return np.asarray(2.0 * self.sliding_velocity(xi) / super().entraining_velocity(xi))


class _SumEverywhere(ContactPath):
    """The sum of both rolling velocities where a law wants their mean, in the slide-to-roll ratio too."""

    def entraining_velocity(self, xi: FloatArray) -> FloatArray:
        return 2.0 * super().entraining_velocity(xi)


class _HalfSlideToRoll(ContactPath):
    """The sliding velocity over the sum of the rolling velocities, not over their mean."""

    def slide_to_roll(self, xi: FloatArray) -> FloatArray:
        return 0.5 * super().slide_to_roll(xi)


class _RadiusInMillimetres(ContactPath):
    """A reduced radius in millimetres where a law wants metres."""

    def radius(self, xi: FloatArray) -> FloatArray:
        return 1e3 * super().radius(xi)

    def hertz_pressure(self, xi: FloatArray) -> FloatArray:
        return super().hertz_pressure(xi) * math.sqrt(1e3)  # the pressure keeps the radius in metres


class _Mistake(NamedTuple):
    """A mistake, and the laws that read the value.

    Attributes
    ----------
    words : the explanation, behind "compatible with"
    laws : names of the laws
    path : kind of the contact path
    factors : field of the contact path -> factor
    """

    words: str
    laws: tuple[str, ...]
    path: type[ContactPath] = ContactPath
    factors: Mapping[str, float] = MappingProxyType({})


#: Label -> mistake.
FRICTION_INPUTS: Mapping[FrictionInput, _Mistake] = MappingProxyType(
    {
        "mean of the rolling velocities": _Mistake(
            "the mean of both rolling velocities in place of their sum in the friction law",
            ("benedict_kelley",),
            _MeanRolling,
        ),
        "sum of the rolling velocities": _Mistake(
            "the sum of both rolling velocities in place of their mean in the friction law",
            ("xu_kahraman",),
            _SumOfRolling,
        ),
        "sum of the rolling velocities everywhere": _Mistake(
            "the sum of both rolling velocities in place of their mean everywhere in the friction law",
            ("xu_kahraman",),
            _SumEverywhere,
        ),
        "half of the slide-to-roll ratio": _Mistake(
            "a slide-to-roll ratio with the sum of the rolling velocities, not their mean",
            ("xu_kahraman",),
            _HalfSlideToRoll,
        ),
        "half of the modulus": _Mistake(
            "half of the effective modulus E' in the friction law",
            ("xu_kahraman", "composite"),
            factors=MappingProxyType({"effective_modulus": 0.5}),
        ),
        "twice the modulus": _Mistake(
            "twice the effective modulus E' in the friction law",
            ("xu_kahraman", "composite"),
            factors=MappingProxyType({"effective_modulus": 2.0}),
        ),
        "half of the load": _Mistake(
            "half of the load, that of two pairs in contact, in the friction law",
            ("benedict_kelley", "xu_kahraman", "iso_14179"),
            factors=MappingProxyType({"unit_load": 0.5}),
        ),
        "load per metre": _Mistake(
            "a load in newtons per metre in place of newtons per millimetre in the friction law",
            ("benedict_kelley", "iso_14179"),
            factors=MappingProxyType({"unit_load": 1e3}),
        ),
        "viscosity in pascal seconds": _Mistake(
            "a viscosity in pascal seconds in place of millipascal seconds in the friction law",
            ("benedict_kelley", "iso_14179"),
            factors=MappingProxyType({"viscosity": 1e-3}),
        ),
        "radius in millimetres": _Mistake(
            "a reduced radius in millimetres in place of metres in the friction law",
            ("xu_kahraman",),
            _RadiusInMillimetres,
        ),
        "smooth flanks": _Mistake(
            "flanks without roughness in the friction law",
            ("benedict_kelley", "xu_kahraman", "iso_14179"),
            factors=MappingProxyType({"roughness": 0.0}),
        ),
    }
)


def with_friction_input(pair: GearPair, friction: PathFunction, label: FrictionInput) -> PathFunction:
    """Return the friction coefficient over xi of a law that reads a mistaken value."""
    mistake = FRICTION_INPUTS[label]
    law = law_of(pair.friction, None)
    path = contact_path(pair)
    if friction.interval != (path.L_XA, path.L_XD):
        path = longer_path(path, friction.interval, law, pair.friction)
    path = replace(path, **{name: getattr(path, name) * factor for name, factor in mistake.factors.items()})
    kept = {one.name: getattr(path, one.name) for one in fields(path)}
    return fit_law(mistake.path(**kept), pair.friction, law.name)
