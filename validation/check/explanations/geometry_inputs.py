"""Explanations that change the geometry of the pair: pressure angle, shifts, teeth, tips, centre distance.

Sources: docs/how_to/check_your_model.md, "Explanations".
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from lumped.fields.units import to_stated
from lumped.schema.pair import GearPair
from validation.check.explanations.cause import Cause, Choice, Variant
from validation.check.explanations.fields import (
    GEARS,
    NEAR,
    Fields,
    choice,
    constant,
    fixed_values,
    free_factor,
    reference_radii,
    times,
    tip_radii,
)
from validation.check.problem import Problem

#: Young's modulus [GPa] and Poisson's ratio of steel, the defaults of many programs.
_STEEL = (206.0, 0.3)
#: Trial factors of an addendum and a module, and of a centre distance.
_LENGTH = (0.8, 0.87, 0.94, 1.06, 1.13, 1.25)
_CENTRES = (0.99, 0.993, 0.9955, 0.998, 1.002, 1.0045, 1.007, 1.01)
#: A centre distance is the standard one up to this share.
_SAME_CENTRE = 1e-4
#: Clearance of a tip at the mate's root over the module.
_CLEARANCE = 0.05
#: Pressure angles of usual racks [degrees], and the least difference between two of them.
_PRESSURE_ANGLES = (14.5, 15.0, 17.5, 20.0, 22.5, 25.0, 28.0, 30.0)
_SAME_ANGLE = 0.01
#: Addendum coefficients of usual racks, and the least difference between two of them.
_ADDENDA = (1.0, 0.8, 1.25)
_SAME_ADDENDUM = 0.01
#: A module is 1 mm up to this length [mm].
_SAME_MODULE = 0.01


def _width(pair: GearPair, value: float) -> Fields:
    return {f"{gear}.face_width": to_stated(getattr(pair, gear).face_width, "mm") * value for gear in GEARS}


def _addendum(pair: GearPair, value: float) -> Fields:
    """Tip diameters of both gears, for an addendum coefficient of the rack times a factor."""
    addendum = pair.basic_rack.addendum_coefficient * pair.basic_rack.module
    return {
        f"{gear}.tip_diameter": to_stated(2.0 * (tip + (value - 1.0) * addendum), "mm")
        for gear, tip in zip(GEARS, tip_radii(pair), strict=True)
    }


def tips(pair: GearPair) -> Fields:
    """Tip diameters of both gears as they are."""
    return {
        f"{gear}.tip_diameter": to_stated(2.0 * tip, "mm")
        for gear, tip in zip(GEARS, tip_radii(pair), strict=True)
    }


def _roots_for_tips(pair: GearPair) -> Fields:
    """A larger dedendum where the tips have no room at the standard centre distance; else nothing."""
    rack = pair.basic_rack
    references = reference_radii(pair)
    overlaps = [
        tip + other - sum(references) for tip, other in zip(tip_radii(pair), references[::-1], strict=True)
    ]
    needed = max(overlaps) / rack.module + _CLEARANCE
    if needed <= rack.dedendum_coefficient:
        return {}
    return {"basic_rack.dedendum_coefficient": needed, "basic_rack.fillet_radius_coefficient": None}


def _addendum_of(gear: str) -> Callable[[GearPair, float], Fields]:
    """Tip diameter of one gear, for its addendum coefficient times a factor."""
    field = f"{gear}.tip_diameter"
    return lambda pair, value: {field: _addendum(pair, value)[field]}


def _centre_distance(pair: GearPair, value: float) -> Fields:
    shifts = {f"{gear}.profile_shift": x for gear, x in zip(GEARS, pair.profile_shifts, strict=True)}
    return {
        "centre_distance": to_stated(pair.geometry.centre_distance, "mm") * value,
        **shifts,
        **tips(pair),
    }


def _module(pair: GearPair, value: float) -> Fields:
    """Module and all lengths that go with it, with the face width as it is."""
    fields: dict[str, Any] = {"basic_rack.module": to_stated(pair.basic_rack.module, "mm") * value}
    fields["centre_distance"] = to_stated(pair.geometry.centre_distance, "mm") * value
    for gear, tip, x in zip(GEARS, tip_radii(pair), pair.profile_shifts, strict=True):
        fields[f"{gear}.tip_diameter"] = to_stated(2.0 * tip, "mm") * value
        fields[f"{gear}.profile_shift"] = x
        fields[f"{gear}.bore"] = to_stated(getattr(pair, gear).bore, "mm") * value
    return fields


def _pressure_angle(problem: Problem, variant: Variant) -> list[Choice]:
    """Other usual racks, or the pressure angle of operation typed as that of the rack."""
    own = to_stated(variant.pair.basic_rack.pressure_angle, "deg")
    operating = to_stated(variant.pair.geometry.operating_pressure_angle, "deg")
    angles: dict[float | str, tuple[float, str]] = {
        angle: (angle, f"a pressure angle of {angle:g} degrees") for angle in _PRESSURE_ANGLES
    }
    angles["of operation"] = operating, "the pressure angle of operation as that of the rack"
    return [
        choice(label, words, constant(_of_rack(variant.pair, angle)))
        for label, (angle, words) in angles.items()
        if abs(angle - own) > _SAME_ANGLE
    ]


def _of_rack(pair: GearPair, angle: float) -> Fields:
    """Another pressure angle of the rack [degrees]; a fillet that does not fit is that of the standard."""
    return {"basic_rack.pressure_angle": angle, "basic_rack.fillet_radius_coefficient": None}


def _shifts(problem: Problem, variant: Variant) -> list[Choice]:
    first, second = variant.pair.profile_shifts
    choices = []
    none: dict[str, Any] = {
        f"{gear}.{field}": value
        for gear in GEARS
        for field, value in (
            ("profile_shift", 0.0),
            ("tip_diameter", None),
            ("addendum", None),
            ("tip_alteration", None),
        )
    }
    if first != 0.0 or second != 0.0:
        choices.append(
            choice("ignored", "profile shifts ignored", lambda pair: {**none, "centre_distance": None})
        )
        signs = (("both", -first, -second), ("pinion", -first, second), ("gear", first, -second))
        for which, pinion, gear in signs:
            if (pinion, gear) == (first, second):  # a shift of 0 has no sign
                continue
            fields = none | {
                "pinion.profile_shift": pinion, "gear.profile_shift": gear, "centre_distance": None
            }  # fmt: skip
            words = "profile shifts" if which == "both" else f"a profile shift of the {which}"
            choices.append(choice(f"wrong sign: {which}", f"{words} with the wrong sign", constant(fields)))
        choices += _other_shifts(variant.pair, none)
        for name, shift in dict(zip(GEARS, (first, second), strict=True)).items():
            if first != second:
                alike = none | {f"{one}.profile_shift": shift for one in GEARS} | {"centre_distance": None}
                words = f"the profile shift of the {name} for both gears"
                choices.append(choice(f"of the {name} for both", words, constant(alike)))
    standard = sum(reference_radii(variant.pair)) / variant.pair.geometry.centre_distance
    if abs(standard - 1.0) > _SAME_CENTRE:
        words = "the standard centre distance, half of the module times the sum of the teeth"
        # With the shifts the teeth would wedge: the line of action and the tips are those of the curves.
        fields = {**none, **tips(variant.pair), **_roots_for_tips(variant.pair), "centre_distance": None}
        choices.append(choice("standard centre", words, constant(fields)))
    if first != second:
        exchanged = {"pinion.profile_shift": second, "gear.profile_shift": first}
        words = "the profile shifts of pinion and gear exchanged"
        choices.append(choice("exchanged", words, lambda pair: exchanged))
    return choices


def _other_shifts(pair: GearPair, none: Fields) -> Iterator[Choice]:
    """The profile shift of one gear ignored, and shifts in millimetres for shifts over the module."""
    shifts = dict(zip(GEARS, pair.profile_shifts, strict=True))
    module = to_stated(pair.basic_rack.module, "mm")
    changes: dict[str, tuple[str, dict[str, float]]] = {}
    if all(shifts.values()):
        for gear in GEARS:
            changes[f"ignored: {gear}"] = f"the profile shift of the {gear} ignored", shifts | {gear: 0.0}
    if abs(module - 1.0) > _SAME_MODULE:
        for words, factor in (("over the module as millimetres", 1.0 / module), ("times the module", module)):
            moved = {gear: factor * shift for gear, shift in shifts.items()}
            changes[words] = f"profile shifts {words}", moved
    for label, (words, moved) in changes.items():
        fields = {**none, "centre_distance": None} | {f"{gear}.profile_shift": x for gear, x in moved.items()}
        yield choice(label, words, constant(fields))
        if "module" in words and any(shifts.values()):
            # At the centre distance of the drawing shifts move the tips, by the tip alteration that follows.
            text = f"{words}, in the tip circles at the right centre distance"
            yield choice(f"{label}, centre kept", text, constant(_tips_for_shifts(pair, moved)))
    centre = to_stated(pair.geometry.centre_distance, "mm")
    for gear, shift in shifts.items():
        if shift > 0.0:  # without a negative shift the teeth would wedge
            fields = {f"{gear}.profile_shift": 0.0, "centre_distance": centre, f"{gear}.tip_diameter": None}
            text = f"the profile shift of the {gear} ignored, at the right centre distance"
            yield choice(f"ignored: {gear}, centre kept", text, constant(fields))


def _tips_for_shifts(pair: GearPair, shifts: Mapping[str, float]) -> Fields:
    """Tip diameters that give the bottom clearance of the rack with other shifts at the same centre distance.

    r_a1 = a - m z2/2 + m (h_a - x2): the radius of one tip has the shift of the other gear (ISO 21771).
    """
    rack, first = pair.basic_rack, pair.profile_shifts
    moves = {
        gear: (shifts[other] - own) * rack.module
        for gear, other, own in zip(GEARS, GEARS[::-1], first[::-1], strict=True)
    }
    return {
        f"{gear}.tip_diameter": to_stated(2.0 * (tip - moves[gear]), "mm")
        for gear, tip in zip(GEARS, tip_radii(pair), strict=True)
    }


def _addendum_of_rack(problem: Problem, variant: Variant) -> list[Choice]:
    """The addendum coefficient of another usual rack, with the tips that follow from it."""
    own = variant.pair.basic_rack.addendum_coefficient
    return [
        choice(value, f"an addendum coefficient of {value:g}", times(_addendum, value / own))
        for value in _ADDENDA
        if abs(value / own - 1.0) > _SAME_ADDENDUM
    ]


def _number_of_teeth(problem: Problem, variant: Variant) -> list[Choice]:
    """One tooth or two more or less on a gear; tips and centre distance stay, or follow the teeth."""
    choices = []
    for gear in GEARS:
        for more in (-1, 1, -2, 2):
            count = getattr(variant.pair, gear).teeth + more
            # Another profile shift, so that the tooth has its thickness at the same centre distance.
            fields = {
                **_centre_distance(variant.pair, 1.0), f"{gear}.teeth": count, f"{gear}.profile_shift": None
            }  # fmt: skip
            words = f"a {gear} with {count} teeth"
            choices.append(choice(f"{gear}: {more:+d}", words, constant(fields)))
            sizes = dict.fromkeys(("pinion.tip_diameter", "gear.tip_diameter", "centre_distance"))
            shifts = dict(
                zip((f"{one}.profile_shift" for one in GEARS), variant.pair.profile_shifts, strict=True)
            )
            fields = {**sizes, **shifts, f"{gear}.teeth": count}
            words = f"a {gear} with {count} teeth, with the sizes of as many teeth"
            choices.append(choice(f"{gear}: {more:+d}, with their size", words, constant(fields)))
    return choices


def _one_width(problem: Problem, variant: Variant) -> list[Choice]:
    """Both gears as wide as one of them."""
    widths = [to_stated(getattr(variant.pair, gear).face_width, "mm") for gear in GEARS]
    if widths[0] == widths[1]:
        return []
    return [
        choice(
            f"of the {gear}",
            f"both gears with the face width of the {gear}",
            constant({"gears.face_width": width}),
        )
        for gear, width in zip(GEARS, widths, strict=True)
    ]


def _material(problem: Problem, variant: Variant) -> list[Choice]:
    """Both gears of one material, or each of that of the other. What repeats the file is left out."""
    pinion, gear = (
        (to_stated(one.youngs_modulus, "GPa"), one.poisson_ratio)
        for one in (variant.pair.pinion, variant.pair.gear)
    )
    cases = (
        ("of the pinion", "both gears of the pinion's material", (pinion, pinion)),
        ("of the gear", "both gears of the gear's material", (gear, gear)),
        ("exchanged", "the materials of pinion and gear exchanged", (gear, pinion)),
        ("steel", "both gears of steel", (_STEEL, _STEEL)),
    )
    choices = []
    seen = [(pinion, gear)]
    for label, words, materials in cases:
        if materials in seen:
            continue
        seen.append(materials)
        fields: dict[str, float] = {}
        for one, (modulus, poisson) in zip(GEARS, materials, strict=True):
            fields |= {f"{one}.youngs_modulus": modulus, f"{one}.poisson_ratio": poisson}
        choices.append(choice(label, words, constant(fields)))
    return choices


def _causes() -> Iterator[Cause]:
    yield fixed_values(
        "pressure angle",
        "another pressure angle",
        ", ".join(f"{angle:g}" for angle in _PRESSURE_ANGLES) + ", of operation",
        _pressure_angle,
    )
    yield fixed_values(
        "profile shifts",
        "profile shifts ignored, exchanged or with the wrong sign; the standard centre distance",
        "ignored (both, one gear), wrong sign (both, one gear), millimetres (at the centre distance that "
        "follows, or at the right one), standard centre, exchanged, of one gear for both",
        _shifts,
    )
    yield fixed_values(
        "number of teeth",
        "one tooth or two more or less on a gear",
        "pinion, gear: -2, -1, 1, 2",
        _number_of_teeth,
    )
    yield fixed_values(
        "material of the gears",
        "Young's modulus and Poisson's ratio of another material",
        "of the pinion, of the gear, exchanged, steel",
        _material,
    )
    yield fixed_values("one face width", "one face width for both gears", "pinion, gear", _one_width)
    yield free_factor("face width", "the face width of both gears", NEAR, _width)
    yield fixed_values(
        "addendum of the rack",
        "the addendum coefficient of another usual rack",
        ", ".join(f"{value:g}" for value in _ADDENDA),
        _addendum_of_rack,
    )
    yield free_factor("addendum", "the addendum coefficient of both gears", _LENGTH, _addendum)
    for gear in GEARS:
        yield free_factor(
            f"addendum of the {gear}", f"the addendum coefficient of the {gear}", _LENGTH, _addendum_of(gear)
        )
    yield free_factor("centre distance", "the centre distance", _CENTRES, _centre_distance)
    yield free_factor("module", "the module, with every length of the transverse section", _LENGTH, _module)


#: Causes that change the geometry of the pair.
OF_GEOMETRY = tuple(_causes())
