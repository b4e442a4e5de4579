"""Explanations that change the oil and the tooth flanks: roughness, relief, deviations, shifts, tips.

Sources: docs/how_to/check_your_model.md, "Explanations".
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from lumped.fields.units import to_stated
from lumped.schema.fields_read import fields_read
from lumped.schema.pair import GearPair
from lumped.schema.tooth_errors import tooth_errors
from lumped.stiffness.parabolic import ParabolicStiffness, iso_end_ratio
from validation.check.explanations.cause import Cause, Choice, Kind, Variant
from validation.check.problem import Problem

_GEARS = ("pinion", "gear")
#: Trial factors of a viscosity, of a roughness, of the length of a relief, of deviations.
_VISCOSITY = (0.05, 0.3, 3.0, 20.0)
_ROUGHNESS = (0.2, 0.5, 2.0, 5.0)
#: Rz over Ra of usual flanks.
_RZ_OVER_RA = (4.0, 5.0, 6.0, 7.0)
_RELIEF_LENGTH = (0.5, 0.75, 1.33, 2.0)
_DEVIATIONS = (0.5, 2.0)
#: Trial factors of the end ratio of a parabola.
_END_RATIO = (0.4, 0.7, 1.2, 1.5)
#: Trial amounts by which one profile shift grows and the other one falls.
_BALANCE = (-0.3, -0.12, 0.12, 0.3)
#: Torques of other units in N m: the pound-force inch and foot, the kilogram-force metre, thousands.
_TORQUE_UNITS = (
    ("N m taken for pound-force inches", 0.1129848),
    ("pound-force inches taken for N m", 1.0 / 0.1129848),
    ("N m taken for pound-force feet", 1.3558179),
    ("pound-force feet taken for N m", 1.0 / 1.3558179),
    ("N m taken for kilogram-force metres", 9.80665),
    ("kilogram-force metres taken for N m", 1.0 / 9.80665),
    ("N m taken for kN m", 1e3),
    ("N mm taken for N m", 1e-3),
)
#: Addenda, or lengths over the base pitch, closer than this are one.
_SAME = 5e-3
_RELIEFS = ("tip_relief", "root_relief")


def _reads(field: str) -> Callable[[Problem, Variant], bool]:
    """Whether the friction law of a variant reads a field."""
    return lambda problem, variant: field in fields_read(variant.pair)


def _viscosity(variant: Variant, value: float) -> Variant:
    """The dynamic viscosity of the oil times a factor, as a number in place of a law."""
    viscosity = to_stated(variant.pair.lubricant.dynamic_viscosity, "mPa*s") * value
    return variant.with_inputs({"lubricant.viscosity": viscosity, "lubricant.viscosity_law": None})


def _end_ratio(variant: Variant, value: float) -> Variant:
    """The stiffness at the ends of the path over the peak of the parabola, times a factor, at most 1."""
    stiffness = variant.pair.mesh.stiffness
    assert isinstance(stiffness, ParabolicStiffness)  # the cause applies to this model alone
    ratio = stiffness.end_ratio or iso_end_ratio(variant.pair.geometry.contact_ratio)
    return variant.with_inputs({"mesh.stiffness.end_ratio": min(ratio * value, 1.0)})


def _roughness(variant: Variant, value: float) -> Variant:
    return variant.with_inputs(
        {
            f"{gear}.roughness": to_stated(getattr(variant.pair, gear).roughness, "um") * value
            for gear in _GEARS
        }
    )


def _measures_of_roughness(problem: Problem, variant: Variant) -> list[Choice]:
    """The roughness Rz where Ra is wanted, or the reverse; both gears for their mean."""
    if "pinion.roughness" not in fields_read(variant.pair):
        return []

    def change(factor: float) -> Callable[[Variant], Variant]:
        return lambda one: _roughness(one, factor)

    first, second = (getattr(variant.pair, gear).roughness for gear in _GEARS)
    root = math.hypot(first, second) / max(0.5 * (first + second), 1e-300)
    composites = (
        ("sum of both", "as the sum of those of both gears, in place of their mean", 2.0),
        ("root of both", "as the root of the sum of the squares of both gears, in place of the mean", root),
        ("half of both", "half of the mean of both gears", 0.5),
        *(
            (f"of the {gear}", f"of the {gear} for both gears", 2.0 * one / max(first + second, 1e-300))
            for gear, one in zip(_GEARS, (first, second), strict=True)
            if first != second and one > 0.0
        ),
    )
    return [
        Choice(label, f"the roughness {words}", change(factor)) for label, words, factor in composites
    ] + [
        Choice(f"{label} {ratio:g}", f"the roughness {words}, with Rz/Ra of {ratio:g}", change(factor))
        for ratio in _RZ_OVER_RA
        for label, words, factor in (
            ("Rz for Ra", "Rz in place of Ra", ratio),
            ("Ra for Rz", "Ra divided as if it were Rz", 1.0 / ratio),
        )
    ]


def _with_torque(pair: GearPair, factor: float) -> dict[str, Any]:
    fields: dict[str, Any] = {"operating.pinion_torque": pair.operating.pinion_torque * factor}
    if pair.operating.brake_torque != "balanced":
        fields["operating.brake_torque"] = pair.operating.brake_torque * factor
    return fields


def _torque_units(problem: Problem, variant: Variant) -> list[Choice]:
    """The torque as a number of another unit."""

    def change(factor: float) -> Callable[[Variant], Variant]:
        return lambda one: one.with_inputs(_with_torque(one.pair, factor))

    return [
        Choice(f"{factor:.4g}", f"a torque of another unit: {words}", change(factor))
        for words, factor in _TORQUE_UNITS
    ]


def _reliefs_of(pair: GearPair) -> list[tuple[str, str]]:
    """Gear and name of each relief of a pair."""
    return [
        (gear, name) for gear in _GEARS for name in _RELIEFS if getattr(getattr(pair, gear), name) is not None
    ]


def _without_some_relief(problem: Problem, variant: Variant) -> list[Choice]:
    """Relief of one gear, of the tips or of the roots ignored, where the pair has others too."""
    pair = variant.pair
    if pair.mesh.relief == "ignored":
        return []
    present = _reliefs_of(pair)
    groups = {
        "of the pinion": [one for one in present if one[0] == "pinion"],
        "of the gear": [one for one in present if one[0] == "gear"],
        "of the tips": [one for one in present if one[1] == "tip_relief"],
        "of the roots": [one for one in present if one[1] == "root_relief"],
    }

    def without(some: Sequence[tuple[str, str]]) -> Callable[[Variant], Variant]:
        return lambda one: one.with_inputs({f"{gear}.{name}": None for gear, name in some})

    return [
        Choice(words, f"the relief {words} ignored", without(some))
        for words, some in groups.items()
        if 0 < len(some) < len(present)
    ]


def tip_relief(pair: GearPair, gear: str) -> dict[str, Any]:
    """The tip relief of a gear, with its length along the line of action [mm]."""
    g = pair.geometry
    tip, base = getattr(g, f"tip_radius_{gear}"), getattr(g, f"base_radius_{gear}")
    relief = getattr(pair, gear).tip_relief
    length = math.sqrt(tip**2 - base**2) - relief.start_roll_angle * base
    return {
        "shape": relief.shape,
        "amount": to_stated(relief.amount, "um"),
        "length": to_stated(length, "mm"),
    }


def relieved_tips(pair: GearPair) -> list[str]:
    return [gear for gear in _GEARS if getattr(pair, gear).tip_relief is not None]


def _relief_length(variant: Variant, value: float) -> Variant:
    """The length of the tip relief of each gear times a factor."""
    fields: dict[str, Any] = {}
    for gear in relieved_tips(variant.pair):
        relief = tip_relief(variant.pair, gear)
        fields[f"{gear}.tip_relief"] = relief | {"length": relief["length"] * value}
    return variant.with_inputs(fields)


def _relief_shape(problem: Problem, variant: Variant) -> list[Choice]:
    """Linear relief in place of parabolic relief, or the reverse."""
    tips = relieved_tips(variant.pair)
    if not tips or variant.pair.mesh.relief == "ignored":
        return []
    shape = getattr(variant.pair, tips[0]).tip_relief.shape
    other = "parabolic" if shape == "linear" else "linear"

    def change(one: Variant) -> Variant:
        relieved = relieved_tips(one.pair)
        return one.with_inputs(
            {f"{gear}.tip_relief": tip_relief(one.pair, gear) | {"shape": other} for gear in relieved}
        )

    return [Choice(other, f"{other} tip relief in place of {shape} tip relief", change)]


def _acts(problem: Problem, variant: Variant) -> bool:
    """Whether a tip relief acts."""
    return variant.pair.mesh.relief != "ignored" and bool(relieved_tips(variant.pair))


def _scaled_deviations(pair: GearPair, factor: float, gears: Sequence[str] = _GEARS) -> dict[str, Any]:
    """Index and slope deviations of the teeth of gears, and their eccentricities, times a factor."""
    fields: dict[str, Any] = {}
    for gear, errors in zip(_GEARS, tooth_errors(pair), strict=True):
        one = getattr(pair, gear)
        if gear not in gears:
            continue
        if one.deviations is not None:
            fields[f"{gear}.deviations"] = {
                "index": tuple(to_stated(factor * value, "um") for value in errors.index),
                "profile_slope": tuple(to_stated(factor * value, "um") for value in errors.slope),
                "first_order": one.deviations.first_order,
            }
        if one.mounting is not None:
            phase = to_stated(one.mounting.phase, "deg") + (180.0 if factor < 0.0 else 0.0)
            fields[f"{gear}.mounting"] = {
                "eccentricity": to_stated(abs(factor) * one.mounting.eccentricity, "um"),
                "phase": phase % 360.0,
            }
    return fields


def _deviating(pair: GearPair) -> list[str]:
    """Gears whose teeth have deviations or which turn about another axis."""
    return [
        gear
        for gear in _GEARS
        if getattr(pair, gear).deviations is not None or getattr(pair, gear).mounting is not None
    ]


def _sign_of_deviations(problem: Problem, variant: Variant) -> list[Choice]:
    """Deviations with the wrong sign, of one gear or of both."""
    gears = _deviating(variant.pair)
    groups: dict[str, tuple[str, ...]] = {f"of the {gear}": (gear,) for gear in gears}
    if len(gears) == len(_GEARS):
        groups = {"of both gears": _GEARS, **groups}

    def turned(some: Sequence[str]) -> Callable[[Variant], Variant]:
        return lambda one: one.with_inputs(_scaled_deviations(one.pair, -1.0, some))

    return [
        Choice(words, f"the deviations {words} with the wrong sign", turned(some))
        for words, some in groups.items()
    ]


def _tips_exchanged(problem: Problem, variant: Variant) -> list[Choice]:
    """Addenda of pinion and gear exchanged: contact starts and ends where the other gear's would."""
    g = variant.pair.geometry
    addenda = (g.tip_radius_pinion - g.reference_radius_pinion, g.tip_radius_gear - g.reference_radius_gear)
    fields = {
        "pinion.tip_diameter": to_stated(2.0 * (g.reference_radius_pinion + addenda[1]), "mm"),
        "gear.tip_diameter": to_stated(2.0 * (g.reference_radius_gear + addenda[0]), "mm"),
    }
    choices = []
    if abs(addenda[0] - addenda[1]) > _SAME * addenda[0]:
        words = "the addenda of pinion and gear exchanged"
        choices.append(Choice("addenda", words, lambda one: one.with_inputs(fields)))
    shifts = {
        "approach and recess": (
            2.0 * g.L_XP - g.L_XA - g.L_XD,
            "the lengths of approach and recess exchanged, about the pitch point",
        ),
        "line turned round": (
            g.L_XY - g.L_XD - g.L_XA,
            "the line of action turned round: contact starts at the pinion's tip and ends at the gear's",
        ),
    }

    def further(length: float) -> Callable[[Variant], Variant]:
        return lambda one: one.with_physics(path_shift=length / g.base_pitch)

    choices += [
        Choice(label, words, further(length))
        for label, (length, words) in shifts.items()
        if abs(length) > _SAME * g.base_pitch
    ]
    full = _tips_not_shortened(variant.pair)
    if full is not None:
        words = "tip circles that are not shortened"
        choices.append(Choice("not shortened", words, lambda one: one.with_inputs(full)))
    tips = _tips_without_shifts(variant.pair)
    if tips is not None:
        words = "tip circles of gears without profile shift"
        choices.append(Choice("without shifts", words, lambda one: one.with_inputs(tips)))
    return choices


def _tips_not_shortened(pair: GearPair) -> dict[str, Any] | None:
    """Tip diameters m (z/2 + h_a + x) 2 without tip alteration; None: they are those of the pair."""
    g = pair.geometry
    rack = pair.basic_rack
    tips = {
        gear: getattr(g, f"reference_radius_{gear}") + (rack.addendum_coefficient + shift) * rack.module
        for gear, shift in zip(_GEARS, pair.profile_shifts, strict=True)
    }
    if all(abs(tips[gear] - getattr(g, f"tip_radius_{gear}")) < _SAME * rack.module for gear in _GEARS):
        return None
    return {f"{gear}.tip_diameter": to_stated(2.0 * tip, "mm") for gear, tip in tips.items()}


def _tips_without_shifts(pair: GearPair) -> dict[str, Any] | None:
    """Tip diameters of gears without profile shift; None: they are those of the pair."""
    g = pair.geometry
    addendum = pair.basic_rack.addendum_coefficient * pair.basic_rack.module
    tips = {gear: getattr(g, f"reference_radius_{gear}") + addendum for gear in _GEARS}
    if all(abs(tips[gear] - getattr(g, f"tip_radius_{gear}")) < 1e-3 * addendum for gear in _GEARS):
        return None
    return {f"{gear}.tip_diameter": to_stated(2.0 * tip, "mm") for gear, tip in tips.items()}


def _shift_balance(variant: Variant, value: float) -> Variant:
    """Profile shifts x_p + value and x_g - value, at the same centre distance."""
    pinion, gear = variant.pair.profile_shifts
    centre = to_stated(variant.pair.geometry.centre_distance, "mm")
    return variant.with_inputs(
        {
            "pinion.profile_shift": pinion + value,
            "gear.profile_shift": gear - value,
            "centre_distance": centre,
        }
    )


def _like_teeth(problem: Problem, variant: Variant) -> bool:
    return variant.pair.healthy is variant.pair


def _causes() -> Iterator[Cause]:
    def free(
        name: str,
        meaning: str,
        grid: tuple[float, ...],
        change: Callable[[Variant, float], Variant],
        applies: Callable[[Problem, Variant], bool],
    ) -> Cause:
        span = f"factor, about {grid[0]:g} to {grid[-1]:g}"
        words = f"{meaning} times {{value}}"
        return Cause(name, Kind.INPUT, meaning, span, grid=grid, change=change, words=words, applies=applies)

    def fixed(
        name: str, meaning: str, span: str, choices: Callable[[Problem, Variant], Sequence[Choice]]
    ) -> Cause:
        return Cause(name, Kind.INPUT, meaning, span, choices)

    yield free(
        "ends of the parabola",
        "the end ratio of the parabolic stiffness",
        _END_RATIO,
        _end_ratio,
        lambda problem, variant: variant.pair.mesh.stiffness.model == "parabolic",
    )
    yield free("viscosity", "the viscosity of the oil", _VISCOSITY, _viscosity, _reads("lubricant.viscosity"))
    yield free("roughness", "the roughness of both gears", _ROUGHNESS, _roughness, _reads("pinion.roughness"))
    yield fixed(
        "measure of the roughness",
        "the roughness Rz in place of Ra, Ra divided as if it were Rz, or a sum of both gears for their mean",
        "Rz/Ra of 4, 5, 6, 7; sum, root of the squares, half of both",
        _measures_of_roughness,
    )
    yield fixed(
        "unit of the torque",
        "a torque of another unit",
        "pound-force inches and feet, kilogram-force metres",
        _torque_units,
    )
    yield fixed(
        "part of the relief ignored",
        "the relief of one gear, of the tips or of the roots ignored",
        "of the pinion, of the gear, of the tips, of the roots",
        _without_some_relief,
    )
    yield free("length of the relief", "the length of the tip relief", _RELIEF_LENGTH, _relief_length, _acts)
    yield fixed(
        "shape of the relief",
        "linear tip relief in place of parabolic tip relief, or the reverse",
        "linear, parabolic",
        _relief_shape,
    )
    yield free(
        "amount of the deviations",
        "all deviations and eccentricities",
        _DEVIATIONS,
        lambda variant, value: variant.with_inputs(_scaled_deviations(variant.pair, value)),
        lambda problem, variant: bool(_deviating(variant.pair)),
    )
    yield fixed(
        "sign of the deviations",
        "deviations with the wrong sign",
        "of both gears, of the pinion, of the gear",
        _sign_of_deviations,
    )
    yield fixed(
        "tips exchanged",
        "addenda, or approach and recess, exchanged; tips of gears without shift, or not shortened",
        "addenda; approach and recess; line turned round; not shortened; without shifts",
        _tips_exchanged,
    )
    yield Cause(
        name="balance of the profile shifts",
        kind=Kind.INPUT,
        meaning="profile shift that moves from one gear to the other, at the same centre distance",
        span=f"about {_BALANCE[0]:g} to {_BALANCE[-1]:g}",
        grid=_BALANCE,
        neutral=0.0,
        change=_shift_balance,
        words="{value} more profile shift of the pinion, and as much less of the gear",
        applies=_like_teeth,
    )


#: Causes that change the oil and the tooth surfaces.
OF_SURFACE = tuple(_causes())
