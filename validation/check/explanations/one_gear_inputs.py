"""Explanations that change one input of one gear: bore, face width, modulus, profile shift, tip relief.

Sources: docs/how_to/check_your_model.md, "Explanations".
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from lumped.errors import refuse
from lumped.fields.units import to_stated
from lumped.schema.fields_read import fields_read
from lumped.schema.pair import GearPair
from validation.check.explanations.cause import Cause, Kind, Variant
from validation.check.explanations.fields import GEARS, Fields, free_factor
from validation.check.explanations.surface_inputs import relieved_tips, tip_relief
from validation.check.problem import Problem

#: Trial factors of an input of one gear, and of a modulus.
_FACTOR = (0.5, 2.0)
_MODULUS = (0.1, 0.5, 2.0)
#: Trial changes of one profile shift.
_SHIFT = (-0.3, 0.3)


def _bore(pair: GearPair, value: float, gears: Sequence[str] = GEARS) -> Fields:
    return {f"{gear}.bore": to_stated(getattr(pair, gear).bore, "mm") * value for gear in gears}


def _width(pair: GearPair, value: float, gear: str) -> Fields:
    return {f"{gear}.face_width": to_stated(getattr(pair, gear).face_width, "mm") * value}


def _modulus(pair: GearPair, value: float, gears: Sequence[str] = GEARS) -> Fields:
    return {
        f"{gear}.youngs_modulus": to_stated(getattr(pair, gear).youngs_modulus, "GPa") * value
        for gear in gears
    }


def _relief(pair: GearPair, value: float, gear: str, key: str) -> Fields:
    if getattr(pair, gear).tip_relief is None:  # an earlier step has taken it away: this one acts on nothing
        raise refuse(f"{gear}.tip_relief", "none", "a tip relief", "Give the gear a tip relief.")
    relief = tip_relief(pair, gear)
    return {f"{gear}.tip_relief": relief | {key: relief[key] * value}}


def _shifted(gear: str) -> Callable[[Variant, float], Variant]:
    """Return the change of one profile shift. The centre distance follows, else teeth would wedge."""

    def change(variant: Variant, value: float) -> Variant:
        shifts = dict(zip(GEARS, variant.pair.profile_shifts, strict=True))
        return variant.with_inputs({f"{gear}.profile_shift": shifts[gear] + value, "centre_distance": None})

    return change


def _has_bores(gears: Sequence[str]) -> Callable[[Problem, Variant], bool]:
    """Whether masses follow from bores of these gears."""
    return lambda problem, variant: all(
        getattr(variant.pair, gear).bore > 0.0 and getattr(variant.pair, gear).mass is None for gear in gears
    )


def _reads(field: str) -> Callable[[Problem, Variant], bool]:
    return lambda problem, variant: field in fields_read(variant.pair)


def _of_both_tips(problem: Problem, variant: Variant) -> bool:
    """Whether the tips of both gears have relief that acts."""
    return variant.pair.mesh.relief != "ignored" and len(relieved_tips(variant.pair)) == len(GEARS)


def _causes() -> Iterator[Cause]:
    bores = free_factor("bores", "the bores of both gears", _FACTOR, _bore, _has_bores(GEARS))
    yield replace(bores, narrow=True)
    modulus = free_factor(
        "Young's modulus",
        "Young's modulus of both gears",
        _MODULUS,
        _modulus,
        _reads("pinion.youngs_modulus"),
    )
    yield replace(modulus, narrow=True)
    for gear in GEARS:
        bore = free_factor(
            f"bore of the {gear}",
            f"the bore of the {gear}",
            _FACTOR,
            lambda pair, value, gear=gear: _bore(pair, value, (gear,)),  # type: ignore[misc]
            _has_bores((gear,)),
        )
        yield replace(bore, narrow=True)
        yield free_factor(
            f"face width of the {gear}",
            f"the face width of the {gear}",
            _FACTOR,
            lambda pair, value, gear=gear: _width(pair, value, gear),  # type: ignore[misc]
        )
        modulus = free_factor(
            f"Young's modulus of the {gear}",
            f"Young's modulus of the {gear}",
            _MODULUS,
            lambda pair, value, gear=gear: _modulus(pair, value, (gear,)),  # type: ignore[misc]
            _reads(f"{gear}.youngs_modulus"),
        )
        yield replace(modulus, narrow=True)
        for key in ("amount", "length"):
            yield free_factor(
                f"{key} of the tip relief of the {gear}",
                f"the {key} of the tip relief of the {gear}",
                _FACTOR,
                lambda pair, value, gear=gear, key=key: _relief(pair, value, gear, key),  # type: ignore[misc]
                _of_both_tips,
            )
        yield Cause(
            name=f"profile shift of the {gear}",
            kind=Kind.INPUT,
            meaning=f"the profile shift of the {gear} larger, and the centre distance with it",
            span=f"about {_SHIFT[0]:g} to {_SHIFT[-1]:g}",
            grid=_SHIFT,
            neutral=0.0,
            change=_shifted(gear),
            words=f"the profile shift of the {gear} larger by {{value}}, and the centre distance with it",
        )


#: Causes that change one input of one gear.
OF_ONE_GEAR = tuple(_causes())
