"""Explanations that change inputs of the pair: load, speed, stiffness, friction, dampers, deviations.

Sources: docs/how_to/check_your_model.md, "Explanations".
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from lumped.fields.units import to_stated
from lumped.friction.registry import FRICTIONAL
from lumped.path_of_contact.stiffness import pair_stiffness
from lumped.schema.bodies import bodies_of
from lumped.schema.pair import GearPair
from lumped.stiffness.registry import MODELS
from validation.check.explanations.cause import Cause, Choice, Kind, Variant
from validation.check.explanations.design_inputs import has_relief
from validation.check.explanations.fields import (
    DAMPER,
    GEARS,
    LINES,
    NEAR,
    Fields,
    choice,
    constant,
    fixed_values,
    free_factor,
    on_springs,
    times,
    with_prescribed_contact,
)
from validation.check.explanations.path_alterations import may_vary, recess_share, with_ends_of
from validation.check.mesh_frequency import circular_over_base
from validation.check.problem import Problem

#: Trial factors of a stiffness or a load.
_LOAD = (0.15, *NEAR, 6.0)
#: Trial friction coefficients, and one below them from which the search counts.
_COEFFICIENTS = (0.012, 0.03, 0.06, 0.12)
_LEAST_COEFFICIENT = 0.004
#: Trial steps of an integrator, and steps of 1 in a mesh cycle.
_STEPS = (-2.0, -0.5, 0.5, 2.0, 6.0)
_STEPS_PER_CYCLE = 500.0


#: A frequency is that of another velocity, or of a table that repeats too early, up to these differences.
#: Most rows of such a table.
_SAME_VELOCITY = 1e-3
#: A factor on the stiffness is 1 up to this share.
_SAME_STIFFNESS = 5e-3
_SAME_TABLE = 1.5e-4
_MOST_ROWS = 64


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
    for gear in GEARS:
        bearing = getattr(pair.bearings, gear)
        mass = getattr(bodies, f"mass_{gear}")
        for line in LINES:
            name = f"{line}_damping_ratio"
            stiffness = getattr(bearing, f"{line}_stiffness")
            fields[f"bearings.{gear}.{name}"] = ratio(getattr(bearing, name), stiffness, mass)
    return variant.with_inputs(fields)


def _twice(problem: Problem, variant: Variant) -> list[Choice]:
    return [
        choice(2.0, "the series stiffness of both teeth forgotten: k times 2", lambda p: _stiffness(p, 2.0))
    ]


def _half(problem: Problem, variant: Variant) -> list[Choice]:
    words = "the compliance of both teeth counted twice: k times 0.5"
    return [choice(0.5, words, lambda pair: _stiffness(pair, 0.5))]


def _stiffness_formulas(problem: Problem, variant: Variant) -> list[Choice]:
    """Known mistakes in the stiffness of a tooth pair, each a factor."""
    pair = variant.pair
    ratio = 0.75 * pair.geometry.contact_ratio + 0.25
    common = min(pair.pinion.face_width, pair.gear.face_width)
    strain = 1.0 / (1.0 - pair.pinion.poisson_ratio**2)
    factors = {
        "mean mesh stiffness": (ratio, "the mean stiffness c_gamma of the mesh for each tooth pair"),
        "c_gamma taken for c'": (1.0 / ratio, "a stiffness of each tooth pair divided by c_gamma/c'"),
        "0.8 forgotten": (1.25, "the factor 0.8 of ISO 6336-1 forgotten: tooth pairs 1.25 times too stiff"),
        "0.8 twice": (0.8, "the factor 0.8 of ISO 6336-1 counted twice: 0.8 times the stiffness"),
        "plane strain": (strain, "plane strain, E/(1 - nu^2), in the stiffness of the tooth pairs"),
        "unit 1000": (1e3, "a stiffness of the tooth pairs 1000 times too large, by its unit"),
        "unit 0.001": (1e-3, "a stiffness of the tooth pairs 1000 times too small, by its unit"),
        "for a millimetre": (
            1e-3 / common,
            "a stiffness of the tooth pairs for a millimetre of face width, without the width",
        ),
        **{
            f"width of the {gear}": (
                getattr(pair, gear).face_width / common,
                f"a stiffness of the tooth pairs by the face width of the {gear}",
            )
            for gear in GEARS
        },
    }
    return [
        choice(label, words, times(_stiffness, factor))
        for label, (factor, words) in factors.items()
        if abs(factor - 1.0) > _SAME_STIFFNESS
    ]


def _stiffness_models(problem: Problem, variant: Variant) -> list[Choice]:
    own = variant.pair.mesh.stiffness.model
    return [
        choice(name, f"the stiffness model {name!r}", constant({"mesh.stiffness": {"model": name}}))
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
        choices = [choice("prescribed", words, lambda pair: prescribed)]
        if has_relief(variant.pair):
            without = {**prescribed, "mesh.relief": "ignored"}
            words = "prescribed contact of perfect involutes: relief is ignored"
            choices.append(choice("prescribed, relief ignored", words, lambda pair: without))
        return choices
    words = "loaded contact: teeth touch where their gaps close under load"
    return [choice("loaded", words, lambda pair: {"mesh.contact": "loaded"})]


def _deviations(problem: Problem, variant: Variant) -> list[Choice]:
    pair = variant.pair
    own = [gear for gear in GEARS if getattr(pair, gear).has_own_teeth]
    if not own:
        return []
    none = {"deviations": None, "mounting": None, "faults": ()}

    def without(gears: Sequence[str]) -> Fields:
        return {f"{gear}.{field}": value for gear in gears for field, value in none.items()}

    words = "all deviations, eccentricities and faults of single teeth ignored"
    choices = [choice("ignored", words, lambda pair: without(own))]
    if len(own) == 2:
        for gear in GEARS:
            words = f"the deviations of the {gear} ignored"
            choices.append(
                choice(f"of the {gear} ignored", words, lambda pair, gear=gear: without((gear,)))  # type: ignore[misc]
            )
    if pair.pinion.teeth == pair.gear.teeth:
        exchanged = {
            f"{one}.{field}": getattr(getattr(pair, other), field)
            for one, other in (GEARS, GEARS[::-1])
            for field in none
        }
        words = "the deviations of the other gear: pinion and gear are exchanged"
        choices.append(choice("of the other gear", words, lambda pair: exchanged))
    return choices


def _no_friction(problem: Problem, variant: Variant) -> list[Choice]:
    if variant.pair.friction.law == "none":
        return []
    return [choice("left out", "friction left out", lambda pair: {"friction.law": "none"})]


def _laws(problem: Problem, variant: Variant) -> list[Choice]:
    own = variant.pair.friction.law
    return [
        choice(law, f"the friction law {law!r}", constant({"friction.law": law}))
        for law in FRICTIONAL
        if law != own
    ]


def _no_mesh_damping(problem: Problem, variant: Variant) -> list[Choice]:
    if variant.pair.mesh.damping_ratio == 0.0:
        return []
    return [choice("left out", "the damping of the mesh left out", lambda pair: _mesh_damping(pair, 0.0))]


def _damper_formulas(problem: Problem, variant: Variant) -> list[Choice]:
    """Known mistakes in 2 zeta sqrt(k m_e): a factor, or another mass than the effective one."""
    pair = variant.pair
    if pair.mesh.damping_ratio == 0.0:
        return []
    bodies = bodies_of(pair)
    g = pair.geometry
    masses = {
        "masses of translation": bodies.mass_pinion
        * bodies.mass_gear
        / (bodies.mass_pinion + bodies.mass_gear),
        "mass of the pinion": bodies.inertia_pinion / g.base_radius_pinion**2,
        "mass of the gear": bodies.inertia_gear / g.base_radius_gear**2,
        "mass of translation of the pinion": bodies.mass_pinion,
        "mass of translation of the gear": bodies.mass_gear,
        "sum of the masses of translation": bodies.mass_pinion + bodies.mass_gear,
    }
    factors = {
        "0.5": (0.5, "the damping of the mesh times 0.5: the factor 2 of 2 zeta sqrt(k m) forgotten"),
        "2": (2.0, "the damping of the mesh times 2: a factor 2 of 2 zeta sqrt(k m) counted twice"),
        "Hz for rad/s": (
            2.0 * math.pi,
            "the damping of the mesh by 2 zeta k/f with a frequency in Hz, not rad/s",
        ),
        "logarithmic decrement": (
            0.5 / math.pi,
            "the damping ratio of the mesh read as a logarithmic decrement, and divided by 2 pi",
        ),
        "per cent": (0.01, "the damping ratio of the mesh read as per cent"),
        "of per cent": (100.0, "per cent of the damping ratio of the mesh read as the ratio"),
        **{
            label: (
                math.sqrt(mass / bodies.effective_mass),
                f"the damping of the mesh with the {label} in place of the effective mass of the rotations",
            )
            for label, mass in masses.items()
        },
    }
    return [
        choice(label, words, times(_mesh_damping, factor))
        for label, (factor, words) in factors.items()
        if pair.mesh.damping_ratio * factor <= 1.0
    ]


def _ratio(pair: GearPair) -> float:
    return pair.gear.teeth / pair.pinion.teeth


def _torque_of_gear(problem: Problem, variant: Variant) -> list[Choice]:
    ratio = _ratio(variant.pair)
    if ratio == 1.0:
        return []
    return [
        choice(
            ratio,
            "the torque of the gear on the pinion",
            lambda pair: _torque(pair, ratio),
        ),
        choice(1.0 / ratio, "the torque of the pinion on the gear", lambda pair: _torque(pair, 1.0 / ratio)),
    ]


def _speed_of_gear(problem: Problem, variant: Variant) -> list[Choice]:
    """The speed that the mesh frequency of the curves shows, or without times the speed of the other gear."""
    cause = problem.frequency.cause
    shown = problem.frequency.factor
    if problem.curves.abscissa == "time":
        if not cause and abs(shown - 1.0) < 5e-3:
            return []
        cause = cause or "the mesh frequency shows another speed"
        others = "".join(f", or {one}" for one in _other_frequencies(variant.pair, shown))
        words = f"a motion at {shown:.4g} times the speed: {cause}{others}"
        return [
            choice(shown, words, lambda pair: _speed(pair, shown)),
            *_circular_pitches(problem, variant, shown),
        ]
    ratio = _ratio(variant.pair)
    turns = {math.pi / 30.0: "rpm taken for rad/s", 30.0 / math.pi: "rad/s taken for rpm"}
    if ratio != 1.0:
        turns |= {ratio: "the pinion's speed on the gear", 1.0 / ratio: "the gear's speed on the pinion"}
    return [choice(value, words, times(_speed, value)) for value, words in turns.items()]


def _circular_pitches(problem: Problem, variant: Variant, shown: float) -> Iterator[Choice]:
    """The circular pitch for the base pitch: mesh cycles are longer by 1/cos(alpha), and pairs touch less."""
    ratio = variant.pair.geometry.contact_ratio
    less = ratio * (shown - 1.0)
    is_one = min(abs(shown / cosine - 1.0) for cosine in circular_over_base(variant.pair)) < _SAME_VELOCITY
    if not (is_one and may_vary(problem, variant) and ratio + less >= 1.0):
        return

    def change(share: float) -> Callable[[Variant], Variant]:
        def changed(one: Variant) -> Variant:
            slower = with_prescribed_contact(one).with_inputs(dict(_speed(one.pair, shown)))
            ends = with_ends_of(slower, less)
            return ends.with_physics(path_start=-(1.0 - share) * less, path_end=share * less)

        return changed

    words = "the circular pitch in place of the base pitch, in the mesh period and between tooth pairs"
    yield Choice("circular pitch", f"{words}, from the start of contact", change(1.0))
    # Approach and recess in the same ratio: positions over the circular pitch.
    share = recess_share(variant.pair)
    yield Choice("circular pitch, about the pitch point", words, change(share))


def _other_frequencies(pair: GearPair, factor: float) -> Iterator[str]:
    """What else makes a mesh frequency near that of the pair: a table, or another velocity of the contact."""
    cosine = math.cos(pair.geometry.operating_pressure_angle)
    for value, words in (
        (1.0 / cosine, "pitch line velocity"),
        (cosine, "base line velocity times cos(alpha)"),
    ):
        if abs(factor / value - 1.0) < _SAME_VELOCITY:
            yield f"contact that travels along the line of action with the {words}"
    for rows in range(4, _MOST_ROWS):
        for value, words in ((rows / (rows - 1), "early"), ((rows - 1) / rows, "late")):
            if abs(factor - value) < _SAME_TABLE:
                yield f"a table of {rows} rows over the mesh cycle that repeats one row too {words}"


def _fixed() -> Iterator[Cause]:
    """Causes with fixed values, the most usual first."""
    yield fixed_values(
        "speed of the curves",
        "the speed that the mesh frequency of the curves shows",
        "ratio of the teeth, half, twice, rpm, rad/s; circular pitch",
        _speed_of_gear,
    )
    yield fixed_values(
        "deviations",
        "deviations of single teeth ignored, or those of the other gear",
        "ignored, exchanged",
        _deviations,
    )
    yield fixed_values(
        "torque of the other gear",
        "the torque of the gear on the pinion, or the reverse",
        "ratio of the teeth",
        _torque_of_gear,
    )
    yield fixed_values(
        "contact form",
        "prescribed contact in place of loaded contact, or the reverse",
        "prescribed, loaded",
        _contact,
    )
    yield fixed_values("friction left out", "no friction", "left out", _no_friction)
    yield fixed_values("friction law", "another law of friction", ", ".join(FRICTIONAL), _laws)
    yield fixed_values(
        "stiffness model",
        "another model of the stiffness of a tooth pair",
        ", ".join(name for name in MODELS if name != "table"),
        _stiffness_models,
    )
    yield fixed_values(
        "series stiffness of both teeth", "the stiffness of one tooth in place of two in series", "2", _twice
    )
    yield fixed_values("compliance counted twice", "the compliance of both teeth counted twice", "0.5", _half)
    yield fixed_values(
        "formula of the stiffness",
        "a mistake in the stiffness of a tooth pair that is a factor",
        "c_gamma for c', factor 0.8, plane strain, face width of one gear, a millimetre; 1000, 0.001",
        _stiffness_formulas,
    )
    yield fixed_values("mesh damping left out", "no damping of the mesh", "left out", _no_mesh_damping)
    yield fixed_values(
        "formula of the mesh damper",
        "a mistake in 2 zeta sqrt(k m_e) of the mesh damper",
        "factors 0.5 and 2, Hz for rad/s, decrement, per cent, mass of one gear, of translation, sum",
        _damper_formulas,
    )


def _constant_friction(variant: Variant, value: float) -> Variant:
    return variant.with_inputs({"friction.law": "coulomb", "friction.coefficient": value})


def _free() -> Iterator[Cause]:
    """Causes with a free factor."""
    yield Cause(
        name="constant friction coefficient",
        kind=Kind.INPUT,
        meaning="one friction coefficient everywhere, in place of that of a law",
        span=f"coefficient, about {_COEFFICIENTS[0]:g} to {_COEFFICIENTS[-1]:g}",
        grid=_COEFFICIENTS,
        neutral=_LEAST_COEFFICIENT,
        change=_constant_friction,
        words="the friction coefficient {value} everywhere, in place of that of a law",
        applies=lambda problem, variant: variant.pair.friction.law not in ("none", "coulomb"),
    )
    yield free_factor("mesh stiffness", "the stiffness of the tooth pairs", _LOAD, _stiffness)
    yield free_factor(
        "mesh damping",
        "the damping of the mesh",
        DAMPER,
        _mesh_damping,
        lambda problem, variant: variant.pair.mesh.damping_ratio > 0.0,
    )
    yield free_factor("torque", "the torque", _LOAD, _torque)
    yield free_factor(
        "speed", "the speed", NEAR, _speed, lambda problem, variant: problem.curves.abscissa != "time"
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
        applies=on_springs,
    )


#: Causes that change inputs of the pair: load, speed, stiffness, friction, dampers, deviations.
OF_PAIR = (*_fixed(), *_free())
