"""Explanations that change inputs of the pair.

Sources: docs/how_to/check_your_model.md, "Explanations".
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from lumped.fields.units import to_stated
from lumped.friction.registry import FRICTIONAL
from lumped.path_of_contact.stiffness import pair_stiffness
from lumped.schema.bodies import bodies_of, solid_disc
from lumped.schema.pair import GearPair
from lumped.stiffness.registry import MODELS
from validation.check.explanations.cause import Cause, Choice, Kind, Variant
from validation.check.explanations.design_inputs import has_relief
from validation.check.problem import Problem

#: Trial factors: of a stiffness, of a load or a mass, of a damper, of a bearing.
_NEAR = (0.4, 0.63, 0.8, 1.25, 1.6, 2.5)
_LOAD = (0.15, *_NEAR, 6.0)
_MASS = (0.12, 0.35, 0.6, 0.8, 1.25, 1.7, 2.8, 8.0, 25.0)
_DAMPER = (0.1, 0.4, 2.5, 10.0)
_BEARING = (0.01, 0.1, 0.4, 2.5, 10.0, 100.0)
_LENGTH = (0.8, 0.87, 0.94, 1.06, 1.13, 1.25)
_CENTRES = (0.99, 0.993, 0.9955, 0.998, 1.002, 1.0045, 1.007, 1.01)
#: A centre distance is the standard one up to this share.
_SAME_CENTRE = 1e-4
#: Trial steps of an integrator, and steps of 1 in a mesh cycle.
_STEPS = (-2.0, -0.5, 0.5, 2.0, 6.0)
_STEPS_PER_CYCLE = 500.0
#: Clearance of a tip at the mate's root over the module.
_CLEARANCE = 0.05
_GEARS = ("pinion", "gear")
_LINES = ("loa", "oloa")
_PRESSURE_ANGLES = (14.5, 17.5, 20.0, 22.5, 25.0)
Fields = Mapping[str, Any]


def _changing(fields: Callable[[GearPair, float], Fields]) -> Callable[[Variant, float], Variant]:
    """Change of a variant by a factor on fields of the pair."""
    return lambda variant, value: variant.with_inputs(dict(fields(variant.pair, value)))


def _choice(label: float | str, words: str, fields: Callable[[GearPair], Fields]) -> Choice:
    """A fixed value that changes fields of the pair."""
    return Choice(label, words, lambda variant: variant.with_inputs(dict(fields(variant.pair))))


def _constant(fields: Fields) -> Callable[[GearPair], Fields]:
    """The same fields for every pair."""
    return lambda pair: fields


def _times(fields: Callable[[GearPair, float], Fields], value: float) -> Callable[[GearPair], Fields]:
    """Fields of a pair with a factor."""
    return lambda pair: fields(pair, value)


def _on_springs(problem: Problem, variant: Variant) -> bool:
    return variant.pair.shafts is None


def _stiffness(pair: GearPair, value: float) -> Fields:
    return {"mesh.stiffness_factor": pair.mesh.stiffness_factor * value}


def _mesh_damping(pair: GearPair, value: float) -> Fields:
    return {"mesh.damping_ratio": pair.mesh.damping_ratio * value}


def _torque(pair: GearPair, value: float) -> Fields:
    """Torque of the pinion, and of the brake where the file states it."""
    fields: dict[str, Any] = {"operating.pinion_torque": pair.operating.pinion_torque * value}
    if pair.operating.brake_torque != "balanced":
        fields["operating.brake_torque"] = pair.operating.brake_torque * value
    return fields


def _speed(pair: GearPair, value: float) -> Fields:
    return {"operating.pinion_speed": to_stated(pair.operating.pinion_speed, "rpm") * value}


def _bearing(pair: GearPair, key: str, value: float, gears: Sequence[str], lines: Sequence[str]) -> Fields:
    """Stiffness or damping ratio of bearings times a factor."""
    fields = {}
    for gear in gears:
        bearing = getattr(pair.bearings, gear)
        for line in lines:
            fields[f"bearings.{gear}.{line}_{key}"] = getattr(bearing, f"{line}_{key}") * value
    return fields


def _inertia(pair: GearPair, value: float, gears: Sequence[str] = _GEARS) -> Fields:
    bodies = bodies_of(pair)
    return {f"{gear}.inertia": getattr(bodies, f"inertia_{gear}") * value for gear in gears}


def _mass(pair: GearPair, value: float, gears: Sequence[str] = _GEARS) -> Fields:
    bodies = bodies_of(pair)
    return {f"{gear}.mass": getattr(bodies, f"mass_{gear}") * value for gear in gears}


def _density(pair: GearPair, value: float) -> Fields:
    return {**_inertia(pair, value), **_mass(pair, value)}


def _density_of(pair: GearPair, value: float, gear: str) -> Fields:
    return {**_inertia(pair, value, (gear,)), **_mass(pair, value, (gear,))}


def _width(pair: GearPair, value: float) -> Fields:
    return {f"{gear}.face_width": to_stated(getattr(pair, gear).face_width, "mm") * value for gear in _GEARS}


def _tip_radii(pair: GearPair) -> tuple[float, float]:
    g = pair.geometry
    return g.tip_radius_pinion, g.tip_radius_gear


def _reference_radii(pair: GearPair) -> tuple[float, float]:
    g = pair.geometry
    return g.reference_radius_pinion, g.reference_radius_gear


def _addendum(pair: GearPair, value: float) -> Fields:
    """Tip diameters of both gears, for an addendum coefficient of the rack times a factor."""
    addendum = pair.basic_rack.addendum_coefficient * pair.basic_rack.module
    return {
        f"{gear}.tip_diameter": to_stated(2.0 * (tip + (value - 1.0) * addendum), "mm")
        for gear, tip in zip(_GEARS, _tip_radii(pair), strict=True)
    }


def _tips(pair: GearPair) -> Fields:
    """Tip diameters of both gears as they are."""
    return {
        f"{gear}.tip_diameter": to_stated(2.0 * tip, "mm")
        for gear, tip in zip(_GEARS, _tip_radii(pair), strict=True)
    }


def _roots_for_tips(pair: GearPair) -> Fields:
    """A larger dedendum where the tips have no room at the standard centre distance; else nothing."""
    rack = pair.basic_rack
    references = _reference_radii(pair)
    overlaps = [
        tip + other - sum(references) for tip, other in zip(_tip_radii(pair), references[::-1], strict=True)
    ]
    needed = max(overlaps) / rack.module + _CLEARANCE
    if needed <= rack.dedendum_coefficient:
        return {}
    return {"basic_rack.dedendum_coefficient": needed, "basic_rack.fillet_radius_coefficient": None}


def _addendum_of(gear: str) -> Callable[[GearPair, float], Fields]:
    """Tip diameter of one gear, for its addendum coefficient times a factor."""
    field = f"{gear}.tip_diameter"
    return lambda pair, value: {field: _addendum(pair, value)[field]}


def _with_steps(variant: Variant, value: float) -> Variant:
    """Damping ratios as by Euler steps h: each motion at omega gets h omega/2 more, negative: explicit.

    The implicit step solves y' = A y - h/2 A^2 y in first order of h, so that a mode decays by h omega^2/2
    more. A spring k on a mass m gets the damper h k, which is h sqrt(k/m)/2 as a damping ratio.
    """
    pair = variant.pair
    bodies = bodies_of(pair)
    half = 0.5 * value / _STEPS_PER_CYCLE * pair.geometry.mesh_period

    def ratio(before: float, stiffness: float, mass: float) -> float:
        return min(max(before + half * math.sqrt(stiffness / mass), 0.0), 1.0)

    of_pair = pair_stiffness(pair).mean()
    fields = {"mesh.damping_ratio": ratio(pair.mesh.damping_ratio, of_pair, bodies.effective_mass)}
    for gear in _GEARS:
        bearing = getattr(pair.bearings, gear)
        mass = getattr(bodies, f"mass_{gear}")
        for line in _LINES:
            name = f"{line}_damping_ratio"
            stiffness = getattr(bearing, f"{line}_stiffness")
            fields[f"bearings.{gear}.{name}"] = ratio(getattr(bearing, name), stiffness, mass)
    return variant.with_inputs(fields)


def _centre_distance(pair: GearPair, value: float) -> Fields:
    shifts = {f"{gear}.profile_shift": x for gear, x in zip(_GEARS, pair.profile_shifts, strict=True)}
    return {
        "centre_distance": to_stated(pair.geometry.centre_distance, "mm") * value,
        **shifts,
        **_tips(pair),
    }


def _module(pair: GearPair, value: float) -> Fields:
    """Module and all lengths that go with it, with the face width as it is."""
    fields: dict[str, Any] = {"basic_rack.module": to_stated(pair.basic_rack.module, "mm") * value}
    fields["centre_distance"] = to_stated(pair.geometry.centre_distance, "mm") * value
    for gear, tip, x in zip(_GEARS, _tip_radii(pair), pair.profile_shifts, strict=True):
        fields[f"{gear}.tip_diameter"] = to_stated(2.0 * tip, "mm") * value
        fields[f"{gear}.profile_shift"] = x
        fields[f"{gear}.bore"] = to_stated(getattr(pair, gear).bore, "mm") * value
    return fields


def _free() -> Iterator[Cause]:
    """Causes with a free factor."""

    def free(
        name: str,
        meaning: str,
        grid: tuple[float, ...],
        fields: Callable[[GearPair, float], Fields],
        applies: Callable[[Problem, Variant], bool] = lambda problem, variant: True,
    ) -> Cause:
        return Cause(
            name=name,
            kind=Kind.INPUT,
            meaning=meaning,
            span=f"factor, about {grid[0]:g} to {grid[-1]:g}",
            grid=grid,
            change=_changing(fields),
            words=f"{meaning} times {{value}}",
            applies=applies,
        )

    yield free("mesh stiffness", "the stiffness of the tooth pairs", _LOAD, _stiffness)
    yield free(
        "mesh damping",
        "the damping of the mesh",
        _DAMPER,
        _mesh_damping,
        lambda problem, variant: variant.pair.mesh.damping_ratio > 0.0,
    )
    yield free("torque", "the torque", _LOAD, _torque)
    yield free(
        "speed", "the speed", _NEAR, _speed, lambda problem, variant: problem.curves.abscissa != "time"
    )
    yield free("inertia", "the inertia of both gears", _MASS, _inertia)
    yield free("mass", "the mass of both gears", _MASS, _mass, _on_springs)
    yield free("density", "the density, so mass and inertia of both gears", _MASS, _density)
    for gear in _GEARS:
        yield free(
            f"inertia of the {gear}",
            f"the inertia of the {gear}",
            _MASS,
            lambda pair, value, gear=gear: _inertia(pair, value, (gear,)),  # type: ignore[misc]
        )
        yield free(
            f"mass of the {gear}",
            f"the mass of the {gear}",
            _MASS,
            lambda pair, value, gear=gear: _mass(pair, value, (gear,)),  # type: ignore[misc]
            _on_springs,
        )
        yield free(
            f"density of the {gear}",
            f"the density of the {gear}, so its mass and inertia,",
            _MASS,
            lambda pair, value, gear=gear: _density_of(pair, value, gear),  # type: ignore[misc]
            _on_springs,
        )
    groups = {
        "": (_GEARS, _LINES, "of both gears"),
        " of the pinion": (("pinion",), _LINES, "of the pinion"),
        " of the gear": (("gear",), _LINES, "of the gear"),
        " along the line of action": (_GEARS, ("loa",), "along the line of action"),
        " across the line of action": (_GEARS, ("oloa",), "across the line of action"),
        **{
            f" of the {gear}, {words}": ((gear,), (line,), f"of the {gear} {words} the line of action")
            for gear in _GEARS
            for line, words in (("loa", "along"), ("oloa", "across"))
        },
    }
    for ending, (gears, lines, words) in groups.items():
        for key, noun, grid in (("stiffness", "stiffness", _BEARING), ("damping_ratio", "damping", _DAMPER)):

            def fields(
                pair: GearPair,
                value: float,
                key: str = key,
                gears: Sequence[str] = gears,
                lines: Sequence[str] = lines,
            ) -> Fields:
                return _bearing(pair, key, value, gears, lines)

            yield free(
                f"bearing {noun}{ending}", f"the {noun} of the bearings {words}", grid, fields, _on_springs
            )
    yield free("face width", "the face width of both gears", _NEAR, _width)
    yield free("addendum", "the addendum coefficient of both gears", _LENGTH, _addendum)
    for gear in _GEARS:
        yield free(
            f"addendum of the {gear}", f"the addendum coefficient of the {gear}", _LENGTH, _addendum_of(gear)
        )
    yield Cause(
        name="numerical damping",
        kind=Kind.INPUT,
        meaning="damping by steps of an integrator: implicit Euler steps add it, explicit ones take it away",
        span="steps of about 1/1000 to 1/50 of a mesh cycle, negative: explicit",
        grid=_STEPS,
        neutral=0.0,
        change=_with_steps,
        words="damping as by implicit Euler steps (negative: explicit ones) of {value} of a mesh cycle",
        shown=lambda value: value / _STEPS_PER_CYCLE,
        applies=_on_springs,
    )
    yield free("centre distance", "the centre distance", _CENTRES, _centre_distance)
    yield free("module", "the module, with every length of the transverse section", _LENGTH, _module)


def _twice(problem: Problem, variant: Variant) -> list[Choice]:
    return [
        _choice(2.0, "the series stiffness of both teeth forgotten: k times 2", lambda p: _stiffness(p, 2.0))
    ]


def _half(problem: Problem, variant: Variant) -> list[Choice]:
    words = "the compliance of both teeth counted twice: k times 0.5"
    return [_choice(0.5, words, lambda pair: _stiffness(pair, 0.5))]


def _stiffness_models(problem: Problem, variant: Variant) -> list[Choice]:
    own = variant.pair.mesh.stiffness.model
    return [
        _choice(name, f"the stiffness model {name!r}", _constant({"mesh.stiffness": {"model": name}}))
        for name in MODELS
        if name not in (own, "table")
    ]


def _contact(problem: Problem, variant: Variant) -> list[Choice]:
    mesh = variant.pair.mesh
    if mesh.stiffness.whole_mesh:
        return []
    if mesh.contact == "loaded":
        words = "prescribed contact: teeth touch from A to D, with a stiffness that no load changes"
        prescribed = {"mesh.contact": "prescribed"}
        choices = [_choice("prescribed", words, lambda pair: prescribed)]
        if has_relief(variant.pair):
            without = {**prescribed, "mesh.relief": "ignored"}
            words = "prescribed contact of perfect involutes: relief is ignored"
            choices.append(_choice("prescribed, relief ignored", words, lambda pair: without))
        return choices
    words = "loaded contact: teeth touch where their gaps close under load"
    return [_choice("loaded", words, lambda pair: {"mesh.contact": "loaded"})]


def _deviations(problem: Problem, variant: Variant) -> list[Choice]:
    pair = variant.pair
    own = [gear for gear in _GEARS if getattr(pair, gear).has_own_teeth]
    if not own:
        return []
    none = {"deviations": None, "mounting": None, "faults": ()}

    def without(gears: Sequence[str]) -> Fields:
        return {f"{gear}.{field}": value for gear in gears for field, value in none.items()}

    words = "all deviations, eccentricities and faults of single teeth ignored"
    choices = [_choice("ignored", words, lambda pair: without(own))]
    if len(own) == 2:
        for gear in _GEARS:
            words = f"the deviations of the {gear} ignored"
            choices.append(
                _choice(f"of the {gear} ignored", words, lambda pair, gear=gear: without((gear,)))  # type: ignore[misc]
            )
    if pair.pinion.teeth == pair.gear.teeth:
        exchanged = {
            f"{one}.{field}": getattr(getattr(pair, other), field)
            for one, other in (_GEARS, _GEARS[::-1])
            for field in none
        }
        words = "the deviations of the other gear: pinion and gear are exchanged"
        choices.append(_choice("of the other gear", words, lambda pair: exchanged))
    return choices


def _no_friction(problem: Problem, variant: Variant) -> list[Choice]:
    if variant.pair.friction.law == "none":
        return []
    return [_choice("left out", "friction left out", lambda pair: {"friction.law": "none"})]


def _laws(problem: Problem, variant: Variant) -> list[Choice]:
    own = variant.pair.friction.law
    return [
        _choice(law, f"the friction law {law!r}", _constant({"friction.law": law}))
        for law in FRICTIONAL
        if law != own
    ]


def _no_mesh_damping(problem: Problem, variant: Variant) -> list[Choice]:
    if variant.pair.mesh.damping_ratio == 0.0:
        return []
    return [_choice("left out", "the damping of the mesh left out", lambda pair: _mesh_damping(pair, 0.0))]


def _no_bearing_damping(problem: Problem, variant: Variant) -> list[Choice]:
    if variant.pair.shafts is not None:
        return []

    def none(gears: Sequence[str]) -> Callable[[GearPair], Fields]:
        return lambda pair: _bearing(pair, "damping_ratio", 0.0, gears, _LINES)

    return [
        _choice("left out", "the damping of the bearings left out", none(_GEARS)),
        *(
            _choice(f"left out, {gear}", f"the damping of the bearings of the {gear} left out", none((gear,)))
            for gear in _GEARS
        ),
    ]


def _ring(problem: Problem, variant: Variant) -> list[Choice]:
    """Inertia by m r^2 in place of m r^2/2, and the other way round."""
    choices = []
    for gears, words in ((_GEARS, "both gears"), *(((gear,), f"the {gear}") for gear in _GEARS)):
        for value, formula in ((2.0, "m r^2 in place of m r^2/2"), (0.5, "half of its value")):
            choices.append(
                _choice(
                    f"{words}: {value:g}",
                    f"the inertia of {words} by {formula}",
                    lambda pair, value=value, gears=gears: _inertia(pair, value, gears),  # type: ignore[misc]
                )
            )
    return choices


def _disc(problem: Problem, variant: Variant) -> list[Choice]:
    """Masses and inertias of discs of other radii."""
    if any(getattr(variant.pair, gear).mass is not None for gear in _GEARS):
        return []
    g = variant.pair.geometry
    radii = {
        "tip circle": _tip_radii(variant.pair),
        "base circle": (g.base_radius_pinion, g.base_radius_gear),
    }

    def discs(pair: GearPair, both: tuple[float, float]) -> Fields:
        fields: dict[str, float] = {}
        for name, radius in zip(_GEARS, both, strict=True):
            gear = getattr(pair, name)
            mass, inertia = solid_disc(radius, gear.face_width, gear.density, gear.bore)
            fields |= {f"{name}.mass": mass, f"{name}.inertia": inertia}
        return fields

    return [
        _choice(name, f"gears as discs of the {name}", lambda pair, both=both: discs(pair, both))  # type: ignore[misc]
        for name, both in radii.items()
    ]


def _ratio(pair: GearPair) -> float:
    return pair.gear.teeth / pair.pinion.teeth


def _torque_of_gear(problem: Problem, variant: Variant) -> list[Choice]:
    ratio = _ratio(variant.pair)
    if ratio == 1.0:
        return []
    return [
        _choice(
            ratio,
            "the torque of the gear on the pinion",
            lambda pair: _torque(pair, ratio),
        ),
        _choice(1.0 / ratio, "the torque of the pinion on the gear", lambda pair: _torque(pair, 1.0 / ratio)),
    ]


def _speed_of_gear(problem: Problem, variant: Variant) -> list[Choice]:
    """The speed that the mesh frequency of the curves shows, or without times the speed of the other gear."""
    cause = problem.frequency.cause
    shown = problem.frequency.factor
    if problem.curves.abscissa == "time":
        if not cause and abs(shown - 1.0) < 5e-3:
            return []
        words = (
            f"a motion at {shown:.4g} times the speed: {cause or 'the mesh frequency shows another speed'}"
        )
        return [_choice(shown, words, lambda pair: _speed(pair, shown))]
    ratio = _ratio(variant.pair)
    turns = {math.pi / 30.0: "rpm taken for rad/s", 30.0 / math.pi: "rad/s taken for rpm"}
    if ratio != 1.0:
        turns |= {ratio: "the pinion's speed on the gear", 1.0 / ratio: "the gear's speed on the pinion"}
    return [_choice(value, words, _times(_speed, value)) for value, words in turns.items()]


def _pressure_angle(problem: Problem, variant: Variant) -> list[Choice]:
    own = to_stated(variant.pair.basic_rack.pressure_angle, "deg")
    return [
        _choice(
            angle,
            f"a pressure angle of {angle:g} degrees",
            _constant({"basic_rack.pressure_angle": angle, "basic_rack.fillet_radius_coefficient": None}),
        )
        for angle in _PRESSURE_ANGLES
        if abs(angle - own) > 0.01
    ]


def _shifts(problem: Problem, variant: Variant) -> list[Choice]:
    first, second = variant.pair.profile_shifts
    choices = []
    none: dict[str, Any] = {
        f"{gear}.{field}": value
        for gear in _GEARS
        for field, value in (
            ("profile_shift", 0.0),
            ("tip_diameter", None),
            ("addendum", None),
            ("tip_alteration", None),
        )
    }
    if first != 0.0 or second != 0.0:
        choices.append(
            _choice("ignored", "profile shifts ignored", lambda pair: {**none, "centre_distance": None})
        )
        signs = (("both", -first, -second), ("pinion", -first, second), ("gear", first, -second))
        for which, pinion, gear in signs:
            if (pinion, gear) == (first, second):  # a shift of 0 has no sign
                continue
            fields = none | {
                "pinion.profile_shift": pinion, "gear.profile_shift": gear, "centre_distance": None
            }  # fmt: skip
            words = "profile shifts" if which == "both" else f"a profile shift of the {which}"
            choices.append(_choice(f"wrong sign: {which}", f"{words} with the wrong sign", _constant(fields)))
    standard = sum(_reference_radii(variant.pair)) / variant.pair.geometry.centre_distance
    if abs(standard - 1.0) > _SAME_CENTRE:
        words = "the standard centre distance, half of the module times the sum of the teeth"
        # With the shifts the teeth would wedge: the line of action and the tips are those of the curves.
        fields = {**none, **_tips(variant.pair), **_roots_for_tips(variant.pair), "centre_distance": None}
        choices.append(_choice("standard centre", words, _constant(fields)))
    if first != second:
        exchanged = {"pinion.profile_shift": second, "gear.profile_shift": first}
        words = "the profile shifts of pinion and gear exchanged"
        choices.append(_choice("exchanged", words, lambda pair: exchanged))
    return choices


def _number_of_teeth(problem: Problem, variant: Variant) -> list[Choice]:
    """One tooth or two more or less on a gear; tips and centre distance stay, or follow the teeth."""
    choices = []
    for gear in _GEARS:
        for more in (-1, 1, -2, 2):
            count = getattr(variant.pair, gear).teeth + more
            # Another profile shift, so that the tooth has its thickness at the same centre distance.
            fields = {
                **_centre_distance(variant.pair, 1.0), f"{gear}.teeth": count, f"{gear}.profile_shift": None
            }  # fmt: skip
            words = f"a {gear} with {count} teeth"
            choices.append(_choice(f"{gear}: {more:+d}", words, _constant(fields)))
            sizes = dict.fromkeys(("pinion.tip_diameter", "gear.tip_diameter", "centre_distance"))
            shifts = dict(
                zip((f"{one}.profile_shift" for one in _GEARS), variant.pair.profile_shifts, strict=True)
            )
            fields = {**sizes, **shifts, f"{gear}.teeth": count}
            words = f"a {gear} with {count} teeth, with the sizes of as many teeth"
            choices.append(_choice(f"{gear}: {more:+d}, with their size", words, _constant(fields)))
    return choices


def _exchanged(problem: Problem, variant: Variant) -> list[Choice]:
    """Bearings, masses or inertias of both gears exchanged, or both directions of the bearings."""
    pair = variant.pair
    if pair.shafts is not None:
        return []
    keys = [f"{line}_{key}" for line in _LINES for key in ("stiffness", "damping_ratio")]
    gears = {
        f"bearings.{one}.{key}": getattr(getattr(pair.bearings, other), key)
        for one, other in (_GEARS, _GEARS[::-1])
        for key in keys
    }
    lines = {
        f"bearings.{gear}.{one}_{key}": getattr(getattr(pair.bearings, gear), f"{other}_{key}")
        for gear in _GEARS
        for one, other in (_LINES, _LINES[::-1])
        for key in ("stiffness", "damping_ratio")
    }
    bodies = bodies_of(pair)
    masses = {
        f"{one}.{key}": getattr(bodies, f"{key}_{other}")
        for one, other in (_GEARS, _GEARS[::-1])
        for key in ("mass", "inertia")
    }
    return [
        _choice("bearings", "the bearings of pinion and gear exchanged", lambda pair: gears),
        _choice(
            "directions", "bearing stiffness along and across the line of action exchanged", lambda p: lines
        ),
        _choice("masses", "masses and inertias of pinion and gear exchanged", lambda pair: masses),
    ]


def _one_width(problem: Problem, variant: Variant) -> list[Choice]:
    """Both gears as wide as one of them."""
    widths = [to_stated(getattr(variant.pair, gear).face_width, "mm") for gear in _GEARS]
    if widths[0] == widths[1]:
        return []
    return [
        _choice(
            f"of the {gear}",
            f"both gears with the face width of the {gear}",
            _constant({"gears.face_width": width}),
        )
        for gear, width in zip(_GEARS, widths, strict=True)
    ]


def _fixed() -> Iterator[Cause]:
    """Causes with fixed values, the most usual first."""

    def fixed(
        name: str, meaning: str, span: str, choices: Callable[[Problem, Variant], Sequence[Choice]]
    ) -> Cause:
        return Cause(name, Kind.INPUT, meaning, span, choices)

    yield fixed(
        "speed of the curves",
        "the speed that the mesh frequency of the curves shows",
        "ratio of the teeth, rpm, rad/s",
        _speed_of_gear,
    )
    yield fixed(
        "deviations",
        "deviations of single teeth ignored, or those of the other gear",
        "ignored, exchanged",
        _deviations,
    )
    yield fixed(
        "torque of the other gear",
        "the torque of the gear on the pinion, or the reverse",
        "ratio of the teeth",
        _torque_of_gear,
    )
    yield fixed(
        "contact form",
        "prescribed contact in place of loaded contact, or the reverse",
        "prescribed, loaded",
        _contact,
    )
    yield fixed("friction left out", "no friction", "left out", _no_friction)
    yield fixed("friction law", "another law of friction", ", ".join(FRICTIONAL), _laws)
    yield fixed(
        "stiffness model",
        "another model of the stiffness of a tooth pair",
        ", ".join(name for name in MODELS if name != "table"),
        _stiffness_models,
    )
    yield fixed(
        "series stiffness of both teeth", "the stiffness of one tooth in place of two in series", "2", _twice
    )
    yield fixed("compliance counted twice", "the compliance of both teeth counted twice", "0.5", _half)
    yield fixed("mesh damping left out", "no damping of the mesh", "left out", _no_mesh_damping)
    yield fixed(
        "bearing damping left out", "no damping of the bearings", "both gears, one gear", _no_bearing_damping
    )
    yield fixed(
        "inertia by m r^2",
        "m r^2 in place of m r^2/2, or half of the inertia",
        "2, 0.5; both gears, one gear",
        _ring,
    )
    yield fixed(
        "radius of the discs", "mass and inertia of discs of another circle", "tip circle, base circle", _disc
    )
    yield fixed(
        "exchanged",
        "values of pinion and gear, or of both directions, exchanged",
        "bearings, directions, masses",
        _exchanged,
    )
    yield fixed(
        "pressure angle",
        "another pressure angle",
        ", ".join(f"{angle:g}" for angle in _PRESSURE_ANGLES),
        _pressure_angle,
    )
    yield fixed(
        "profile shifts",
        "profile shifts ignored, exchanged or with the wrong sign; the standard centre distance",
        "ignored, wrong sign (both, one gear), standard centre, exchanged",
        _shifts,
    )
    yield fixed(
        "number of teeth",
        "one tooth or two more or less on a gear",
        "pinion, gear: -2, -1, 1, 2",
        _number_of_teeth,
    )
    yield fixed("one face width", "one face width for both gears", "pinion, gear", _one_width)


#: Causes that change inputs of the pair.
OF_PAIR = (*_fixed(), *_free())
