"""Explanations that alter the equations of the model, which no input of the pair can say.

Sources: docs/how_to/check_your_model.md, "Explanations".
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from validation.check.explanations.cause import Cause, Choice, Kind, Variant
from validation.check.explanations.fields import with_prescribed_contact
from validation.check.explanations.friction_courses import Friction, reversal_of
from validation.check.explanations.friction_inputs import FRICTION_INPUTS
from validation.check.explanations.path_alterations import may_vary
from validation.check.explanations.physics import Arms, Bearings
from validation.check.problem import Problem

#: Trial amplitudes of a profile error, in steps of so many micrometres.
_ERRORS = (-1.0, -0.3, 0.3, 1.0)
_MICROMETRES = 10.0
#: Places closer than this share of the base pitch are one.
_APART = 5e-3
#: Trial slopes and curvatures of a stiffness over its path, and trial lags [mesh cycles].
_SHAPE = (-0.5, -0.2, 0.2, 0.5)
_LAG = (-0.3, -0.1, 0.1, 0.3)
_LATE = (0.001, 0.003, 0.01, 0.03)
#: Parts of the static error that are added: mesh orders, label, words.
_STATIC_PARTS = (
    (-1, "without its mean", "the varying part"),
    (1, "one order", "one mesh order"),
    (2, "two orders", "two mesh orders"),
    (3, "three orders", "three mesh orders"),
    (5, "five orders", "five mesh orders"),
)
#: A load below this share of the largest one is none.
_NO_LOAD = 1e-6
_RAMPS = (0.03, 0.1, 0.2, 0.4)
_SMOOTHED = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0)
#: Supports of which a part is rigid, in words.
_RIGID: dict[Bearings, str] = {
    "rigid pinion": "of the pinion",
    "rigid gear": "of the gear",
    "rigid along": "along the line of action",
    "rigid across": "across the line of action",
}


def _altered(label: float | str, words: str, **changes: Any) -> Choice:
    """A fixed value that alters the equations."""
    return Choice(label, words, lambda variant: variant.with_physics(**changes))


def _has_friction(variant: Variant) -> bool:
    return variant.pair.friction.law != "none"


def _friction_sign(problem: Problem, variant: Variant) -> list[Choice]:
    """Signs of the friction of both gears together, and of single equations."""
    if not _has_friction(variant):
        return []
    friction = variant.physics.friction
    choices = [_altered("reversed", "friction with the wrong sign everywhere", friction=-friction)]
    if variant.pair.shafts is not None:
        return choices
    return [
        *choices,
        _altered(
            "moments reversed",
            "friction moments with the wrong sign, forces with the right sign",
            moment_pinion=-1.0,
            moment_gear=-1.0,
        ),
        _altered(
            "forces reversed",
            "friction forces on the translations with the wrong sign, moments with the right sign",
            force_pinion=-1.0,
            force_gear=-1.0,
        ),
        _altered(
            "moment of the pinion",
            "the friction moment of the pinion with the wrong sign",
            moment_pinion=-1.0,
        ),
        _altered(
            "moment of the gear", "the friction moment of the gear with the wrong sign", moment_gear=-1.0
        ),
        _altered(
            "force on the pinion", "the friction force on the pinion with the wrong sign", force_pinion=-1.0
        ),
        _altered("force on the gear", "the friction force on the gear with the wrong sign", force_gear=-1.0),
    ]


def _friction_part(problem: Problem, variant: Variant) -> list[Choice]:
    """Moments or forces of friction left out."""
    if not _has_friction(variant) or variant.pair.shafts is not None:
        return []
    return [
        _altered("no moments", "the moments of friction forgotten", moment_pinion=0.0, moment_gear=0.0),
        _altered(
            "no forces", "friction forces on the translations forgotten", force_pinion=0.0, force_gear=0.0
        ),
        *(
            _altered(
                f"no {part} on the {gear}", f"the friction {part} on the {gear} forgotten", **{field: 0.0}
            )
            for part in ("moment", "force")
            for gear in ("pinion", "gear")
            if getattr(variant.physics, field := f"{part}_{gear}") != 0.0
        ),
    ]


def _friction_course(problem: Problem, variant: Variant) -> list[Choice]:
    """Other courses of the friction over the path of contact."""
    if not _has_friction(variant) or variant.physics.course:
        return []
    return [
        _altered(
            "without reversal", "friction that does not reverse at the pitch point", course="without reversal"
        ),
        _altered("leading pair", "friction of the leading tooth pair only", course="leading pair"),
        _altered(
            "total load on the leading pair",
            "friction of the whole mesh force at the leading tooth pair",
            course="total load on the leading pair",
        ),
        _altered("newest pair", "friction of the newest tooth pair only", course="newest pair"),
        _altered(
            "total load on the newest pair",
            "friction of the whole mesh force at the newest tooth pair",
            course="total load on the newest pair",
        ),
        _altered(
            "equal shares of the load",
            "friction of equal shares of the mesh force on the pairs in contact",
            course="equal shares of the load",
        ),
        _altered(
            "coefficient of the newest pair",
            "the friction coefficient of the newest tooth pair, with its sign, for all pairs",
            course="coefficient of the newest pair",
        ),
        _altered(
            "coefficient of the leading pair",
            "the friction coefficient of the leading tooth pair, with its sign, for all pairs",
            course="coefficient of the leading pair",
        ),
        *_reversals(variant),
        *_static_friction(variant),
    ]


def _static_friction(variant: Variant) -> Iterator[Choice]:
    """Friction by a load that does not vibrate, and the natural logarithm for the decimal one."""
    if variant.pair.healthy is variant.pair and not variant.pair.mesh.stiffness.whole_mesh:
        for course, words in (
            ("static load", "friction by the static load, shared as the stiffness"),
            ("static load in equal shares", "friction by the static load in equal shares"),
        ):
            yield Choice(course, f"{words}, not by the load that vibrates", _by_static_load(course))
    if variant.pair.friction.law == "benedict_kelley":
        yield _altered(
            "natural logarithm",
            "the natural logarithm in place of the decimal one in the friction law",
            course="natural logarithm",
        )


def _by_static_load(course: str) -> Callable[[Variant], Variant]:
    """Change of a variant by friction of a static load. Teeth touch from A to D, with their relief."""
    return lambda variant: variant.with_inputs({"mesh.contact": "prescribed"}).with_physics(course=course)


def _reversals(variant: Variant) -> list[Choice]:
    """Other places at which friction reverses, where they are not the pitch point."""
    pair = variant.pair
    g = pair.geometry
    places: tuple[tuple[Friction, str], ...] = (
        (
            "pitch point of the rack",
            "friction that reverses at the pitch point of the standard centre distance",
        ),
        ("middle of the path", "friction that reverses in the middle of the path of contact"),
        (
            "middle of the line of action",
            "friction that reverses in the middle between both base circles",
        ),
    )
    return [
        _altered(course, words, course=course)
        for course, words in places
        if abs((reversal_of(pair, course, g.L_XA, g.L_XD) or g.L_XP) - g.L_XP) > _APART * g.base_pitch
    ]


def _friction_inputs(problem: Problem, variant: Variant) -> list[Choice]:
    """Values that the friction law reads wrongly."""
    law = variant.pair.friction.law
    if variant.physics.friction_input:
        return []
    return [
        _altered(label, mistake.words, friction_input=label)
        for label, mistake in FRICTION_INPUTS.items()
        if law in mistake.laws
    ]


def _smoothed(field: str) -> Callable[[Variant, float], Variant]:
    """Change of a variant by friction that is smoothed over the sliding velocity."""
    return lambda variant, value: variant.with_physics(**{field: max(value, 0.0)})


def _mesh_force_sign(problem: Problem, variant: Variant) -> list[Choice]:
    if variant.pair.shafts is not None:
        return []
    words = "the mesh force on the translation of the {} with the wrong sign"
    return [
        _altered(-1.0, words.format("gear"), mesh_force_gear=-1.0),
        _altered("of the pinion", words.format("pinion"), mesh_force_pinion=-1.0),
    ]


def _approach(problem: Problem, variant: Variant) -> list[Choice]:
    """Displacements of the gears that the approach of the teeth leaves out, or has with the wrong sign."""
    if variant.pair.shafts is not None or variant.physics.bearings != "elastic":
        return []
    texts = (
        (
            "rotations alone",
            "by the rotations alone, without the displacements of the gears, as in a torsional model",
            {"approach_pinion": 0.0, "approach_gear": 0.0},
        ),
        ("without the pinion", "without the displacement of the pinion", {"approach_pinion": 0.0}),
        ("without the gear", "without the displacement of the gear", {"approach_gear": 0.0}),
        (
            "sign of the pinion",
            "with the displacement of the pinion of the wrong sign",
            {"approach_pinion": -1.0},
        ),
        ("sign of the gear", "with the displacement of the gear of the wrong sign", {"approach_gear": -1.0}),
    )
    return [
        _altered(label, f"an approach of the teeth {words}", **changes) for label, words, changes in texts
    ]


def _arms(problem: Problem, variant: Variant) -> list[Choice]:
    """Other lever arms of the friction moments."""
    if not _has_friction(variant) or variant.pair.shafts is not None or variant.physics.arms:
        return []
    texts: dict[Arms, str] = {
        "from A": "lever arms of friction that count from the start of contact, not from the line's tangent "
        "point",
        "from A on the pinion": "a lever arm of friction on the pinion that counts from the start of contact",
        "from both ends": "lever arms of friction that count from the start and the end of contact",
        "from the pitch point": "lever arms of friction that count from the pitch point",
        "of the other gear": "lever arms of friction of pinion and gear exchanged",
        "of the pinion": "the lever arm of friction of the pinion for both gears",
        "of the gear": "the lever arm of friction of the gear for both gears",
        "at the pitch point": "lever arms of friction that stay those at the pitch point",
        "pitch radii": "pitch radii as lever arms of friction",
        "base radii": "base radii as lever arms of friction",
    }
    return [_altered(arms, words, arms=arms) for arms, words in texts.items()]


def _static_error(problem: Problem, variant: Variant) -> list[Choice]:
    """The static deflection of the mesh as a second excitation."""
    if variant.pair.mesh.contact != "prescribed" or variant.pair.healthy is not variant.pair:
        return []
    words = "the static transmission error as an excitation beside the varying stiffness that makes it"
    return [
        _altered("second excitation", words, static_error=1.0),
        _altered("second excitation, wrong sign", f"{words}, with the wrong sign", static_error=-1.0),
        *(
            _altered(
                f"second excitation, {label}{ending}",
                f"{part} of {words}{', with the wrong sign' * bool(ending)}",
                static_error=sign,
                static_orders=orders,
            )
            for orders, label, part in _STATIC_PARTS
            for ending, sign in (("", 1.0), (", wrong sign", -1.0))
            if orders != -1 or sign > 0.0  # else it differs by its mean alone, which may be removed
        ),
        *_excited(problem, variant),
    ]


def _excited(problem: Problem, variant: Variant) -> Iterator[Choice]:
    """A constant mesh stiffness that an error or a force excites."""
    if not may_vary(problem, variant):
        return
    yield _altered(
        "constant stiffness",
        "a constant mesh stiffness that the static transmission error excites",
        excitation="static error",
    )
    yield _altered(
        "stiffness as a force",
        "a constant mesh stiffness, with the variation of the stiffness as a force",
        excitation="stiffness as a force",
    )


def _prescribed(field: str) -> Callable[[Variant, float], Variant]:
    """Change of a variant by a free parameter of the stiffness, with prescribed contact."""
    return lambda variant, value: with_prescribed_contact(variant).with_physics(**{field: value})


def _dampers(problem: Problem, variant: Variant) -> list[Choice]:
    if variant.pair.mesh.damping_ratio == 0.0:
        return []
    frequency = "proportional at the mesh frequency"
    texts = (
        ("constant", "constant", "a constant damper of the mesh"),
        ("proportional", "proportional", "a damper of the mesh proportional to its stiffness"),
        ("root of the whole mesh", "of the whole mesh", "one damper by the root of the whole mesh stiffness"),
        (
            "constant for each pair",
            "constant for each pair",
            "a constant damper for each tooth pair, the whole one of the mesh",
        ),
        (
            frequency,
            frequency,
            "a damper of the mesh proportional to its stiffness, 2 zeta k/omega with the mesh frequency",
        ),
    )
    choices = [_altered(label, words, damper=law) for label, law, words in texts]
    if variant.pair.shafts is None:
        words = "dampers of mesh and bearings proportional to stiffness, with the ratio of the mesh"
        for law, more in (("proportional", ""), (frequency, " at its frequency")):
            changes = {"damper": law, "proportional_bearings": True}
            choices.append(_altered(f"{law}, bearings too", words + more, **changes))
    return choices


def _pulling(problem: Problem, variant: Variant) -> list[Choice]:
    """A linear mesh; where teeth part also their other forces."""
    if variant.physics.pulling or variant.physics.contact:
        return []
    choices = [_altered("linear", "a linear mesh, in which teeth may pull, each by itself", pulling=True)]
    if not takes_contact_force(variant) or not _parts(problem):
        return choices
    return [
        *choices,
        _altered(
            "sum of the pairs",
            "contact loss of the sum of all pairs, so that a single pair may pull",
            contact="sum of the pairs",
        ),
        _altered(
            "damper across the gap",
            "dampers of the teeth that act on across the gap, with the spring alone cut",
            contact="damper across the gap",
        ),
    ]


def takes_contact_force(variant: Variant) -> bool:
    """Return whether another contact force can be computed."""
    pair = variant.pair
    like_teeth = pair.mesh.contact == "prescribed" and pair.healthy is pair
    return like_teeth and pair.shafts is None and variant.physics.bearings == "elastic"


def _parts(problem: Problem) -> bool:
    """Whether a tooth pair of our motion has no load while it is on its path."""
    motion = problem.motion.motion
    load = motion["normal_load"].to_numpy()[motion["contact"].to_numpy() > 0]
    return bool(load.min() <= _NO_LOAD * load.max())


def _exponent(problem: Problem, variant: Variant) -> list[Choice]:
    """Contact forces of impact functions."""
    if not takes_contact_force(variant) or variant.physics.contact:
        return []
    texts = {
        "exponent 1.5": "a contact force with the exponent 1.5, calibrated at the mean load",
        "exponent 1.5 of one pair": "a contact force with the exponent 1.5, calibrated on a single pair",
        "exponent 1.5 in millimetres": "a contact force with the exponent 1.5 of millimetres",
        "exponent 10/9": "a contact force with the exponent 10/9, calibrated at the mean load",
        "exponent 2.2": "a contact force with the exponent 2.2, calibrated at the mean load",
    }
    return [_altered(label, words, contact=label) for label, words in texts.items()]


def _over_cycle(problem: Problem, variant: Variant) -> list[Choice]:
    """Other stiffness over the mesh cycle, with prescribed contact."""
    texts = {
        "reversed": "the stiffness over the mesh cycle reversed in time",
        "constant": "a constant mesh stiffness: no parametric excitation",
        "single pair": "a single tooth pair in contact all the time",
        "double pair": "two tooth pairs in contact all the time",
        "shared evenly": "all tooth pairs in contact with the same share of the load",
        "whole mesh for each pair": "the stiffness of the whole mesh on each tooth pair",
        "levels exchanged": "the high and the low mesh stiffness exchanged",
        "first harmonic": "the mean and the first harmonic of the mesh stiffness",
        "first harmonic, half the swing": "the mean of the mesh stiffness and one harmonic, with half of the "
        "peak to peak as its amplitude",
        "two harmonics": "the mean and two harmonics of the mesh stiffness",
        "three harmonics": "the mean and three harmonics of the mesh stiffness",
        "five harmonics": "the mean and five harmonics of the mesh stiffness",
        "two levels": "a rectangular mesh stiffness, one value for each number of pairs in contact",
    }
    if not may_vary(problem, variant):
        return []

    def change(name: str) -> Callable[[Variant], Variant]:
        return lambda variant: with_prescribed_contact(variant).with_physics(stiffness=name)

    return [Choice(name, words, change(name)) for name, words in texts.items()]


def _variation(variant: Variant, value: float) -> Variant:
    """The variation of the stiffness of the whole mesh times a factor, with prescribed contact."""
    return with_prescribed_contact(variant).with_physics(variation=variant.physics.variation * value)


def _smoothing(variant: Variant, value: float) -> Variant:
    """The stiffness of the whole mesh averaged over a window [mesh cycles], with prescribed contact."""
    return with_prescribed_contact(variant).with_physics(smoothing=value)


def _changing_error(wave: str) -> Callable[[Variant, float], Variant]:
    """Change of a variant by an amplitude of a profile error at the mesh frequency [10 um]."""
    return lambda variant, value: variant.with_physics(**{f"error_{wave}": 1e-6 * _MICROMETRES * value})


def _radius(problem: Problem, variant: Variant) -> list[Choice]:
    if variant.pair.shafts is not None:
        return []
    angle = variant.pair.geometry.operating_pressure_angle
    words = "pitch radii in place of base radii as lever arms"
    cosine = math.cos(variant.pair.basic_rack.pressure_angle) / math.cos(angle)
    return [
        _altered("pitch radius", words, radius=1.0 / math.cos(angle)),
        _altered("diameter", "diameters in place of radii as lever arms", radius=2.0),
        *(
            [
                _altered(
                    "pitch radius by the rack",
                    "pitch radii of operation times the cosine of the rack as base radii",
                    radius=cosine,
                )
            ]
            if abs(cosine - 1.0) > _APART
            else []
        ),
    ]


def _bearings(problem: Problem, variant: Variant) -> list[Choice]:
    if variant.pair.shafts is not None:
        return []
    return [
        _altered("rigid", "rigid bearings: gears that only turn", bearings="rigid"),
        *(
            _altered(label, f"bearings {words} that are rigid", bearings=label)
            for label, words in _RIGID.items()
        ),
        _altered(
            "torsional", "a torsional model, without translations and bearing forces", bearings="left out"
        ),
    ]


def _shafts(problem: Problem, variant: Variant) -> list[Choice]:
    """The springs of the file in place of its shafts."""
    if variant.pair.shafts is None:
        return []
    words = "the springs of [bearings] in place of the shafts"

    def on_springs(variant: Variant) -> Variant:
        ranges = {path: one for path, one in variant.pair.uncertainty if not path.startswith("shafts")}
        return variant.with_inputs({"shafts": None, "uncertainty": ranges})

    return [Choice("springs", words, on_springs)]


def _causes() -> Iterator[Cause]:
    def altered(
        name: str, meaning: str, span: str, choices: Callable[[Problem, Variant], Sequence[Choice]]
    ) -> Cause:
        return Cause(name, Kind.PHYSICS, meaning, span, choices)

    yield altered(
        "friction sign", "friction with the wrong sign", "all, moments, forces, one gear", _friction_sign
    )
    yield altered(
        "part of friction",
        "moments or forces of friction forgotten",
        "moments, forces; both gears, one gear",
        _friction_part,
    )
    yield altered(
        "friction over the path",
        "another course of the friction over the path of contact",
        "without reversal; leading or newest pair, with its load or the load of the mesh; equal shares; "
        "coefficient of one pair for all; pitch point of the rack; middle of the path or of the line; static "
        "load; natural logarithm",
        _friction_course,
    )
    yield altered(
        "input of the friction law",
        "a value that the friction law reads wrongly",
        "mean or sum of the rolling velocities, slide-to-roll ratio, modulus, load, units, smooth flanks",
        _friction_inputs,
    )
    for field, shape in (("tanh", "a tanh"), ("ramp", "a ramp")):
        yield Cause(
            name=f"friction smoothed by {shape}",
            kind=Kind.PHYSICS,
            meaning=f"friction that rises by {shape} over a share of the largest sliding velocity",
            span=f"about {_SMOOTHED[0]:g} to {_SMOOTHED[-1]:g}",
            grid=_SMOOTHED,
            neutral=0.0,
            change=_smoothed(field),
            words=f"friction that rises by {shape} over {{value}} of the largest sliding velocity",
            applies=lambda problem, variant: _has_friction(variant),
        )
    yield Cause(
        name="friction coefficient",
        kind=Kind.PHYSICS,
        meaning="the friction coefficient",
        span="factor, about 0.07 to 5",
        grid=(0.07, 0.4, 1.8, 5.0),
        change=lambda variant, value: variant.with_physics(friction=variant.physics.friction * value),
        words="the friction coefficient times {value}",
        applies=lambda problem, variant: _has_friction(variant),
    )
    yield altered(
        "mesh force sign",
        "the mesh force on the translation of a gear reversed",
        "-1: of the gear, of the pinion",
        _mesh_force_sign,
    )
    yield altered(
        "damper law",
        "another law of the dampers of the teeth",
        "constant, proportional (at the mesh frequency too), root of the whole mesh, constant for each pair; "
        "bearings too",
        _dampers,
    )
    yield altered(
        "teeth pull",
        "a linear mesh in place of unilateral contact, or another force where teeth part",
        "linear, sum of the pairs, damper across the gap",
        _pulling,
    )
    yield altered(
        "exponent of the contact force",
        "a contact force that grows with a power of the deflection",
        "1.5, 1.5 of one pair, 1.5 in millimetres, 10/9, 2.2",
        _exponent,
    )
    yield Cause(
        name="forces one step late",
        kind=Kind.PHYSICS,
        meaning="forces of the teeth by an earlier motion, such as that of the last step, in mesh cycles",
        span=f"about {_LATE[0]:g} to {_LATE[-1]:g}",
        grid=_LATE,
        neutral=0.0,
        change=lambda variant, value: variant.with_physics(late_force=value),
        words="forces of the teeth by the motion of {value} mesh cycles before, as of the last step",
        applies=lambda problem, variant: takes_contact_force(variant),
    )
    yield altered(
        "stiffness over the mesh cycle",
        "another course of the mesh stiffness",
        "reversed, constant, single pair, double pair, shared evenly, whole mesh for each pair, levels "
        "exchanged, one to five harmonics, two levels",
        _over_cycle,
    )
    yield Cause(
        name="variation of the mesh stiffness",
        kind=Kind.PHYSICS,
        meaning="the variation of the mesh stiffness about its mean",
        span="factor, about 0.3 to 1.8",
        grid=(0.3, 0.6, 1.3, 1.8),
        change=_variation,
        words="the variation of the mesh stiffness about its mean times {value}",
        describes=True,
        applies=lambda problem, variant: (
            not variant.physics.stiffness and not variant.pair.mesh.stiffness.whole_mesh
        ),
    )
    yield Cause(
        name="smoothed mesh stiffness",
        kind=Kind.PHYSICS,
        meaning="a mesh stiffness without jumps: a moving average over the mesh cycle",
        span="window of 0.1 to 0.5 mesh cycles",
        grid=(0.1, 0.2, 0.35, 0.5),
        neutral=0.0,
        change=_smoothing,
        words="a mesh stiffness that is averaged over {value} mesh cycles",
        applies=lambda problem, variant: (
            not variant.physics.stiffness and not variant.pair.mesh.stiffness.whole_mesh
        ),
    )
    for wave in ("cosine", "sine"):
        yield Cause(
            name=f"profile error: {wave}",
            kind=Kind.PHYSICS,
            meaning=f"a profile error of all teeth, a {wave} at the mesh frequency from A on",
            span="amplitude, about -10 to 10 um",
            grid=_ERRORS,
            neutral=0.0,
            change=_changing_error(wave),
            describes=True,
            words=f"a profile error of all teeth, a {wave} of {{value}} um at the mesh frequency from A on",
            shown=lambda value: _MICROMETRES * value,
            applies=lambda problem, variant: (
                variant.pair.mesh.contact == "prescribed" and variant.pair.healthy is variant.pair
            ),
        )
    yield altered(
        "pitch radius",
        "pitch radii or diameters in place of base radii",
        "1/cos(alpha), 2, cos(alpha)/cos(alpha_w)",
        _radius,
    )
    yield altered(
        "approach of the teeth",
        "displacements of the gears that the approach of the teeth leaves out or turns",
        "rotations alone; without one gear; sign of one gear",
        _approach,
    )
    yield altered(
        "lever arms of friction",
        "other lever arms of the friction moments",
        "from A, from both ends, from the pitch point, of the other gear, of one gear, at the pitch point, "
        "pitch radii, base radii",
        _arms,
    )
    yield altered(
        "static error as an excitation",
        "the static transmission error as an excitation, beside the varying stiffness or in place of it",
        "right and wrong sign; one to five orders; constant stiffness; stiffness as a force",
        _static_error,
    )
    for field, meaning, grid in (
        ("slope", "a further slope of the stiffness of a tooth pair over its path, from A to D", _SHAPE),
        ("curvature", "a further curvature of the stiffness of a tooth pair, 0 in mid-path", _SHAPE),
        ("ramps", "ramps over which a tooth pair takes up its stiffness, as shares of its path", _RAMPS),
        ("lag", "the stiffness late against contact and friction, in mesh cycles", _LAG),
    ):
        yield Cause(
            name=f"{field} of the stiffness",
            kind=Kind.PHYSICS,
            meaning=meaning,
            span=f"about {grid[0]:g} to {grid[-1]:g}",
            grid=grid,
            neutral=0.0,
            change=_prescribed(field),
            words=f"{meaning}: {{value}}",
            applies=may_vary,
            describes=field in ("slope", "curvature"),
        )
    yield Cause(
        name="place of the path of contact",
        kind=Kind.PHYSICS,
        meaning="a path of contact that lies further along its line, for friction and its lever arms",
        span="-0.4 to 0.4 base pitches",
        grid=(-0.4, -0.15, 0.15, 0.4),
        neutral=0.0,
        change=lambda variant, value: variant.with_physics(path_shift=value),
        words="a path of contact {value} base pitches further along its line, for friction and its arms",
        applies=lambda problem, variant: _has_friction(variant) and variant.pair.shafts is None,
    )
    yield Cause(
        name="damping of the masses",
        kind=Kind.PHYSICS,
        meaning="dampers of all coordinates in proportion to masses and inertias",
        span="damping ratio at the mesh frequency, about 0.01 to 0.3",
        grid=(0.01, 0.05, 0.3),
        neutral=0.0,
        change=lambda variant, value: variant.with_physics(mass_damping=value),
        words="dampers in proportion to masses and inertias, {value} of the critical ones at the mesh "
        "frequency",
        applies=lambda problem, variant: variant.pair.shafts is None,
    )
    yield altered(
        "supports",
        "rigid bearings, or a torsional model",
        "rigid: all, one gear, one direction; torsional",
        _bearings,
    )
    yield altered("shafts left out", "springs in place of shafts", "springs", _shafts)


#: Causes that alter the equations of the model.
OF_MODEL = tuple(_causes())
