"""Explanations that change masses, inertias and bearings.

Sources: docs/how_to/check_your_model.md, "Explanations".
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from lumped.schema.bodies import bodies_of, solid_disc
from lumped.schema.pair import GearPair
from validation.check.explanations.cause import Cause, Choice, Variant
from validation.check.explanations.fields import (
    DAMPER,
    GEARS,
    LINES,
    Fields,
    choice,
    constant,
    fixed_values,
    free_factor,
    on_springs,
    reference_radii,
    times,
    tip_radii,
)
from validation.check.problem import Problem

#: Factors by which inertias are mistaken: factor, label, words; those of both gears alone.
_INERTIAS = (
    (2.0, "2", "m r^2 in place of m r^2/2"),
    (0.5, "0.5", "half of its value"),
    (4.0, "4, GD^2", "GD^2, four times its value, or by a diameter for a radius"),
    (0.25, "0.25", "a quarter of its value, as if it were GD^2"),
    (1e3, "1000", "a unit that makes it 1000 times too large"),
    (1e-3, "0.001", "a unit that makes it 1000 times too small"),
    (1e4, "10000", "kg cm^2 in place of kg m^2"),
)
_OF_BOTH = (1e3, 1e-3, 1e4)
#: Units by which masses and inertias are mistaken together: factor, words.
_MASS_UNITS = (
    (1e3, "1000 times too large, as by kilograms beside newtons and millimetres"),
    (1e-3, "1000 times too small, as by tonnes beside newtons and metres"),
    (2.2046226, "in pounds taken for kilograms"),
    (0.45359237, "divided as if they were pounds"),
)
#: Trial factors of a mass, and of a bearing stiffness.
_MASS = (0.12, 0.35, 0.6, 0.8, 1.25, 1.7, 2.8, 8.0, 25.0)
_BEARING = (0.01, 0.1, 0.4, 2.5, 10.0, 100.0)
#: Parts of the values of one gear for both: words and what the names of their fields have in common.
_PARTS = {
    "bearings": {"bearing stiffness": "_stiffness", "bearing damping": "_damping_ratio"},
    "masses": {"mass": ".mass", "inertia": ".inertia"},
}
#: Values of a bearing in one direction.
_BEARING_KEYS = ("stiffness", "damping_ratio")


def _bearing(pair: GearPair, key: str, value: float, gears: Sequence[str], lines: Sequence[str]) -> Fields:
    """Stiffness or damping ratio of bearings times a factor."""
    fields = {}
    for gear in gears:
        bearing = getattr(pair.bearings, gear)
        for line in lines:
            fields[f"bearings.{gear}.{line}_{key}"] = getattr(bearing, f"{line}_{key}") * value
    return fields


def _inertia(pair: GearPair, value: float, gears: Sequence[str] = GEARS) -> Fields:
    bodies = bodies_of(pair)
    return {f"{gear}.inertia": getattr(bodies, f"inertia_{gear}") * value for gear in gears}


def _mass(pair: GearPair, value: float, gears: Sequence[str] = GEARS) -> Fields:
    bodies = bodies_of(pair)
    return {f"{gear}.mass": getattr(bodies, f"mass_{gear}") * value for gear in gears}


def _density(pair: GearPair, value: float) -> Fields:
    return {**_inertia(pair, value), **_mass(pair, value)}


def _density_of(pair: GearPair, value: float, gear: str) -> Fields:
    return {**_inertia(pair, value, (gear,)), **_mass(pair, value, (gear,))}


def _no_bearing_damping(problem: Problem, variant: Variant) -> list[Choice]:
    """Dampers of all bearings left out, of one gear, or of one direction."""
    if variant.pair.shafts is not None:
        return []
    groups = {
        "left out": (GEARS, LINES, ""),
        **{f"left out, {gear}": ((gear,), LINES, f" of the {gear}") for gear in GEARS},
        "left out, along": (GEARS, ("loa",), " along the line of action"),
        "left out, across": (GEARS, ("oloa",), " across the line of action"),
    }

    def none(gears: Sequence[str], lines: Sequence[str]) -> Callable[[GearPair], Fields]:
        return lambda pair: _bearing(pair, "damping_ratio", 0.0, gears, lines)

    return [
        choice(label, f"the damping of the bearings{words} left out", none(gears, lines))
        for label, (gears, lines, words) in groups.items()
    ]


def _ring(problem: Problem, variant: Variant) -> list[Choice]:
    """Inertia by m r^2 in place of m r^2/2, and the other way round; GD^2; about a diameter; other units."""
    choices = []
    for gears, words in ((GEARS, "both gears"), *(((gear,), f"the {gear}") for gear in GEARS)):
        for value, mark, formula in _INERTIAS:
            if value in _OF_BOTH and len(gears) == 1:
                continue
            choices.append(
                choice(
                    f"{words}: {mark}",
                    f"the inertia of {words} by {formula}",
                    lambda pair, value=value, gears=gears: _inertia(pair, value, gears),  # type: ignore[misc]
                )
            )
        choices.append(
            choice(
                f"{words}: about a diameter",
                f"the inertia of {words} about a diameter, not about the axis",
                lambda pair, gears=gears: _about_a_diameter(pair, gears),  # type: ignore[misc]
            )
        )
    return choices


def _units_of_masses(problem: Problem, variant: Variant) -> list[Choice]:
    """Masses and inertias of both gears in another unit."""
    return [
        choice(f"{factor:.4g}", f"masses and inertias {words}", times(_density, factor))
        for factor, words in _MASS_UNITS
    ]


def _about_a_diameter(pair: GearPair, gears: Sequence[str]) -> Fields:
    """J/2 + m b^2/12 of a disc of the width b."""
    bodies = bodies_of(pair)
    return {
        f"{gear}.inertia": 0.5 * getattr(bodies, f"inertia_{gear}")
        + getattr(bodies, f"mass_{gear}") * getattr(pair, gear).face_width ** 2 / 12.0
        for gear in gears
    }


def _disc(problem: Problem, variant: Variant) -> list[Choice]:
    """Masses and inertias of discs of other radii, or of discs without bore."""
    pair = variant.pair
    if any(getattr(pair, gear).mass is not None for gear in GEARS):
        return []
    g = pair.geometry
    bores = tuple(getattr(pair, gear).bore for gear in GEARS)
    discs = {
        "tip circle": ("gears as discs of the tip circle", tip_radii(pair), bores),
        "base circle": (
            "gears as discs of the base circle",
            (g.base_radius_pinion, g.base_radius_gear),
            bores,
        ),
        "root circle": (
            "gears as discs of the root circle",
            (g.root_radius_pinion, g.root_radius_gear),
            bores,
        ),
        "diameter": (
            "gears as discs with the diameter for the radius: 4 times the mass, 16 times the inertia",
            tuple(2.0 * radius for radius in reference_radii(pair)),
            tuple(2.0 * bore for bore in bores),
        ),
    }
    if any(bores):
        radii = reference_radii(pair)
        discs["without bore"] = "gears as discs without bore", radii, (0.0, 0.0)
        if all(bores):
            discs["without bore: pinion"] = "a pinion as a disc without bore", radii, (0.0, bores[1])
            discs["without bore: gear"] = "a gear as a disc without bore", radii, (bores[0], 0.0)
        for place, gear in enumerate(GEARS):
            if all(bores) and bores[0] != bores[1]:
                words = f"gears as discs with the bore of the {gear} for both"
                discs[f"bore of the {gear}"] = words, radii, (bores[place], bores[place])
        if bores[0] != bores[1]:
            discs["bores exchanged"] = "gears as discs with the bore of the other gear", radii, bores[::-1]
        discs["bore as a radius"] = (
            "gears as discs with the diameter of the bore as its radius",
            radii,
            tuple(2.0 * bore for bore in bores),
        )
        discs["half of the bore"] = (
            "gears as discs with half of the bore",
            radii,
            tuple(0.5 * bore for bore in bores),
        )
    return [
        choice(label, words, constant(_discs(pair, radii, holes)))
        for label, (words, radii, holes) in discs.items()
    ]


def _discs(pair: GearPair, radii: Sequence[float], bores: Sequence[float]) -> Fields:
    """Masses and inertias of discs with radii and bores [m]."""
    fields: dict[str, float] = {}
    for name, radius, bore in zip(GEARS, radii, bores, strict=True):
        gear = getattr(pair, name)
        mass, inertia = solid_disc(radius, gear.face_width, gear.density, bore)
        fields |= {f"{name}.mass": mass, f"{name}.inertia": inertia}
    return fields


def _values_of(pair: GearPair, what: str, gear: str) -> dict[str, float]:
    """Field without the name of the gear -> value of a gear: its bearings, or its mass and inertia."""
    if what == "bearings":
        bearing = getattr(pair.bearings, gear)
        keys = [f"{line}_{key}" for line in LINES for key in _BEARING_KEYS]
        return {key: getattr(bearing, key) for key in keys}
    bodies = bodies_of(pair)
    return {key: getattr(bodies, f"{key}_{gear}") for key in ("mass", "inertia")}


def _given(pair: GearPair, what: str, sources: dict[str, str]) -> Fields:
    """Bearings or masses of gears by those of others: gear -> gear whose values it has."""
    start = "bearings." if what == "bearings" else ""
    return {
        f"{start}{gear}.{key}": value
        for gear, source in sources.items()
        for key, value in _values_of(pair, what, source).items()
    }


def _exchanged(problem: Problem, variant: Variant) -> list[Choice]:
    """Bearings or masses of both gears exchanged, whole or in part; directions of the bearings exchanged."""
    pair = variant.pair
    if pair.shafts is not None:
        return []
    both = dict(zip(GEARS, GEARS[::-1], strict=True))
    bearings, masses = (_given(pair, what, both) for what in ("bearings", "masses"))
    of_gears = {
        gear: {
            f"bearings.{gear}.{one}_{key}": getattr(getattr(pair.bearings, gear), f"{other}_{key}")
            for one, other in (LINES, LINES[::-1])
            for key in _BEARING_KEYS
        }
        for gear in GEARS
    }
    directions: Fields = of_gears["pinion"] | of_gears["gear"]
    turned = "along and across the line of action exchanged"
    cases = (
        ("bearings", "the bearings of pinion and gear exchanged", bearings),
        ("directions", f"bearing stiffness {turned}", directions),
        ("masses", "masses and inertias of pinion and gear exchanged", masses),
        *(
            (f"directions of the {gear}", f"bearing stiffness of the {gear} {turned}", of_gears[gear])
            for gear in GEARS
        ),
        *(
            (
                f"bearing {noun}",
                f"the {noun} of the bearings of pinion and gear exchanged",
                _part(bearings, key),
            )
            for noun, key in (("stiffness", "_stiffness"), ("damping", "_damping_ratio"))
        ),
        *(
            (
                f"bearings {words}",
                f"the bearings {words} the line of action of pinion and gear exchanged",
                _part(bearings, f".{line}_"),
            )
            for line, words in zip(LINES, ("along", "across"), strict=True)
        ),
        *(
            (
                f"direction of the {noun}",
                f"bearing {noun} {turned}, the other values as they are",
                _part(directions, key),
            )
            for noun, key in (("stiffness", "_stiffness"), ("damping", "_damping_ratio"))
        ),
        ("masses alone", "the masses of pinion and gear exchanged, not the inertias", _part(masses, ".mass")),
        (
            "inertias alone",
            "the inertias of pinion and gear exchanged, not the masses",
            _part(masses, ".inertia"),
        ),
    )
    choices = []
    seen = [pair]
    for label, words, fields in cases:
        changed = pair.with_(dict(fields))
        if changed not in seen:
            seen.append(changed)
            choices.append(choice(label, words, constant(fields)))
    return choices


def _part(fields: Fields, word: str) -> Fields:
    """Fields with a word in their names."""
    return {name: value for name, value in fields.items() if word in name}


def _one_for_both(problem: Problem, variant: Variant) -> list[Choice]:
    """Both gears with the bearings or masses of one of them; one bearing stiffness in both directions."""
    pair = variant.pair
    if pair.shafts is not None:
        return []
    choices = []
    for what, words in (("bearings", "bearings"), ("masses", "mass and inertia")):
        values = [_values_of(pair, what, gear) for gear in GEARS]
        if values[0] == values[1]:
            continue
        for gear in GEARS:
            fields = _given(pair, what, dict.fromkeys(GEARS, gear))
            choices.append(
                choice(f"{what} of the {gear}", f"{words} of the {gear} for both gears", constant(fields))
            )
            for noun, key in _PARTS[what].items():
                one = _part(fields, key)
                if pair.with_(dict(one)) not in (pair, pair.with_(dict(fields))):
                    text = f"the {noun} of the {gear} for both gears, the other values as they are"
                    choices.append(choice(f"{noun} of the {gear}", text, constant(one)))
    for line, words in zip(LINES, ("along", "across"), strict=True):
        fields = {
            f"bearings.{gear}.{other}_{key}": getattr(getattr(pair.bearings, gear), f"{line}_{key}")
            for gear in GEARS
            for other in LINES
            for key in _BEARING_KEYS
        }
        if pair.with_(fields) != pair:
            text = f"the bearing stiffness {words} the line of action in both directions"
            choices.append(choice(f"bearings {words}", text, constant(fields)))
    means: dict[str, float] = {}
    for gear in GEARS:
        bearing = getattr(pair.bearings, gear)
        mean = sum(getattr(bearing, f"{line}_stiffness") for line in LINES) / len(LINES)
        means |= {f"bearings.{gear}.{line}_stiffness": mean for line in LINES}
    if pair.with_(means) != pair:
        text = "the mean of the bearing stiffness of both directions in both of them"
        choices.append(choice("bearings, mean of both directions", text, constant(means)))
    return choices


def _causes() -> Iterator[Cause]:
    yield fixed_values(
        "bearing damping left out",
        "no damping of the bearings",
        "both gears, one gear, one direction",
        _no_bearing_damping,
    )
    yield fixed_values(
        "inertia by m r^2",
        "m r^2 in place of m r^2/2, half of the inertia, GD^2, about a diameter, or another unit",
        "2, 0.5, 4, 0.25, about a diameter: both gears, one gear; 1000, 0.001; kg cm^2",
        _ring,
    )
    yield fixed_values(
        "unit of the masses",
        "masses and inertias of both gears in another unit",
        "1000, 0.001, pounds",
        _units_of_masses,
    )
    yield fixed_values(
        "radius of the discs",
        "mass and inertia of discs of another circle",
        "tip circle, base circle, root circle, diameter; without bore (both, one gear), other bores",
        _disc,
    )
    yield fixed_values(
        "exchanged",
        "values of pinion and gear, or of both directions, exchanged",
        "bearings, masses: whole, in part; directions: both gears, one gear, stiffness, damping",
        _exchanged,
    )
    yield fixed_values(
        "values of one for both",
        "bearings or masses of one gear for both gears, or one bearing stiffness for both directions",
        "bearings, masses: pinion, gear, whole or in part; bearings: along, across, mean",
        _one_for_both,
    )
    yield free_factor("inertia", "the inertia of both gears", _MASS, _inertia)
    yield free_factor("mass", "the mass of both gears", _MASS, _mass, on_springs)
    yield free_factor("density", "the density, so mass and inertia of both gears", _MASS, _density)
    for gear in GEARS:
        yield free_factor(
            f"inertia of the {gear}",
            f"the inertia of the {gear}",
            _MASS,
            lambda pair, value, gear=gear: _inertia(pair, value, (gear,)),  # type: ignore[misc]
        )
        yield free_factor(
            f"mass of the {gear}",
            f"the mass of the {gear}",
            _MASS,
            lambda pair, value, gear=gear: _mass(pair, value, (gear,)),  # type: ignore[misc]
            on_springs,
        )
        yield free_factor(
            f"density of the {gear}",
            f"the density of the {gear}, so its mass and inertia,",
            _MASS,
            lambda pair, value, gear=gear: _density_of(pair, value, gear),  # type: ignore[misc]
            on_springs,
        )
    groups = {
        "": (GEARS, LINES, "of both gears"),
        " of the pinion": (("pinion",), LINES, "of the pinion"),
        " of the gear": (("gear",), LINES, "of the gear"),
        " along the line of action": (GEARS, ("loa",), "along the line of action"),
        " across the line of action": (GEARS, ("oloa",), "across the line of action"),
        **{
            f" of the {gear}, {words}": ((gear,), (line,), f"of the {gear} {words} the line of action")
            for gear in GEARS
            for line, words in (("loa", "along"), ("oloa", "across"))
        },
    }
    for ending, (gears, lines, words) in groups.items():
        for key, noun, grid in (("stiffness", "stiffness", _BEARING), ("damping_ratio", "damping", DAMPER)):

            def fields(
                pair: GearPair,
                value: float,
                key: str = key,
                gears: Sequence[str] = gears,
                lines: Sequence[str] = lines,
            ) -> Fields:
                return _bearing(pair, key, value, gears, lines)

            yield free_factor(
                f"bearing {noun}{ending}", f"the {noun} of the bearings {words}", grid, fields, on_springs
            )


#: Causes that change masses, inertias and bearings.
OF_BODIES = tuple(_causes())
