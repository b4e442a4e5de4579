"""Explanations that exchange, add or leave out a whole part of the design: relief, roles, inertia, dampers.

Sources: docs/how_to/check_your_model.md, "Explanations".
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any

from lumped.fields.units import to_stated
from lumped.schema.bodies import bodies_of
from lumped.schema.pair import GearPair
from validation.check.explanations.cause import Cause, Choice, Kind, Variant
from validation.check.explanations.misreadings import exchanged_gears
from validation.check.problem import Problem

GEARS = ("pinion", "gear")
_LINES = ("loa", "oloa")
#: Micrometres of one unit of the free amount of relief, and trial amounts in this unit.
_MICROMETRES = 10.0
_AMOUNTS = (0.4, 1.0, 2.5)
#: Share of the path of contact over which an added relief grows.
_RELIEVED = 0.25
_RELIEF = (0.4, 0.7, 1.4, 2.5)
#: Inertia of a gear that turns at a constant speed, over its inertia.
_HEAVY = 1e3
#: Speed at which a motion is static, over the speed.
_SLOW = 1.0 / 40.0
#: A ratio of mesh frequencies is a ratio of teeth up to this difference.
_SAME = 0.01


def has_relief(pair: GearPair) -> bool:
    """Return whether a tooth has tip or root relief."""
    gears = (pair.pinion, pair.gear)
    return any(gear.tip_relief is not None or gear.root_relief is not None for gear in gears)


def relief_ignored(problem: Problem, variant: Variant) -> list[Choice]:
    """Return the choice of perfect involutes."""
    if variant.pair.mesh.relief == "ignored" or not has_relief(variant.pair):
        return []
    words = "tip and root relief ignored"
    return [Choice("ignored", words, lambda one: one.with_inputs({"mesh.relief": "ignored"}))]


def _with_relief(variant: Variant, value: float) -> Variant:
    """Both tips relieved by an amount, linearly over a share of the path of contact."""
    g = variant.pair.geometry
    relief = {
        "amount": _MICROMETRES * value,
        "length": to_stated(_RELIEVED * g.contact_ratio * g.base_pitch, "mm"),
    }
    tips = {f"{gear}.tip_relief": relief for gear in GEARS}
    return variant.with_inputs({"mesh.relief": "static", **tips})


def _relief_amount(variant: Variant, value: float) -> Variant:
    """All amounts of relief times a factor."""
    fields: dict[str, Any] = {}
    for gear in GEARS:
        for name in ("tip_relief", "root_relief"):
            relief = getattr(getattr(variant.pair, gear), name)
            if relief is not None:
                fields[f"{gear}.{name}.amount"] = to_stated(relief.amount, "um") * value
    return variant.with_inputs(fields)


def _can_be_relieved(problem: Problem, variant: Variant) -> bool:
    pair = variant.pair
    whole_mesh = pair.mesh.stiffness.whole_mesh
    return pair.healthy is pair and not has_relief(pair) and not whole_mesh and not variant.physics.stiffness


def _acts(problem: Problem, variant: Variant) -> bool:
    return variant.pair.mesh.relief != "ignored" and has_relief(variant.pair)


def exchanged_roles(pair: GearPair, share: float) -> dict[str, Any]:
    """Return the fields of the pair in which the gear drives, at ``share`` of the speed of the pinion.

    The power stays: the torque is that of the pinion over ``share``.
    """
    mapping = pair.to_mapping()
    bearings = mapping["bearings"]
    operating = pair.operating
    fields: dict[str, Any] = {
        "pinion": mapping["gear"],
        "gear": mapping["pinion"],
        "bearings.pinion": bearings["gear"],
        "bearings.gear": bearings["pinion"],
        "operating.pinion_speed": to_stated(operating.pinion_speed, "rpm") * share,
        "operating.pinion_torque": operating.pinion_torque / share,
        "uncertainty": {},
    }
    return fields


def driving_gear(problem: Problem, variant: Variant) -> list[Choice]:
    """Return the choices in which the gear drives: at its speed, or with the numbers of the pinion."""
    pair = variant.pair
    if pair.shafts is not None or pair.healthy is not pair:
        return []
    ratio = pair.gear.teeth / pair.pinion.teeth
    shown = problem.frequency.factor if problem.curves.abscissa == "time" else 1.0
    cases = []
    if abs(shown / ratio - 1.0) < _SAME:
        fields = exchanged_roles(pair, 1.0) | {"operating.pinion_torque": pair.operating.pinion_torque}
        cases.append(("with the speed and torque of the pinion", fields))
    elif abs(shown - 1.0) < _SAME:
        cases.append(("at its speed", exchanged_roles(pair, 1.0 / ratio)))
    choices = []
    for words, fields in cases:
        for names, turned in (("", False), (", called pinion", True)):

            def change(one: Variant, fields: dict[str, Any] = fields, turned: bool = turned) -> Variant:
                after = one.with_inputs(fields)
                # Our driving gear is the pinion; the curves of a pinion are those of the driven gear.
                return after if turned else after.with_reading(exchanged_gears(problem, one.reading))

            label = f"the gear {words}{names}"
            choices.append(Choice(label, f"a mesh in which the gear drives {words}{names}", change))
    return choices


def _constant_speed(problem: Problem, variant: Variant) -> list[Choice]:
    """One gear at a constant speed: its inertia does not vibrate.

    The damper of the mesh stays, or has the mass of the other gear alone.
    """

    def heavy(gear: str, *, dampers_stay: bool) -> Callable[[Variant], Variant]:
        def change(one: Variant) -> Variant:
            inertia = getattr(bodies_of(one.pair), f"inertia_{gear}") * _HEAVY
            heavier = one.with_inputs({f"{gear}.inertia": inertia})
            return with_dampers_of(one.pair, heavier) if dampers_stay else heavier

        return change

    return [
        Choice(
            f"the {gear}{ending}",
            f"a {gear} that turns at constant speed{words}",
            heavy(gear, dampers_stay=not ending),
        )
        for gear in GEARS
        for ending, words in (("", ""), (", with its damper", ", with the mesh damper of such a mesh"))
    ]


def _static(problem: Problem, variant: Variant) -> list[Choice]:
    """The motion at so low a speed that nothing vibrates."""
    words = "a static curve: loads and deflections without inertia"
    rpm = to_stated(variant.pair.operating.pinion_speed, "rpm") * _SLOW
    return [Choice("static", words, lambda one: one.with_inputs({"operating.pinion_speed": rpm}))]


def with_dampers_of(pair: GearPair, variant: Variant) -> Variant:
    """Return a variant with the dampers of a pair: ratios that keep 2 zeta sqrt(k m) [N s/m]."""
    before, after = bodies_of(pair), bodies_of(variant.pair)
    stiffness = variant.pair.mesh.stiffness_factor / pair.mesh.stiffness_factor
    mass = after.effective_mass / before.effective_mass
    fields = {"mesh.damping_ratio": _ratio(variant.pair.mesh.damping_ratio, stiffness * mass)}
    if variant.pair.shafts is None:
        for gear in GEARS:
            mass = getattr(after, f"mass_{gear}") / getattr(before, f"mass_{gear}")
            one, other = getattr(pair.bearings, gear), getattr(variant.pair.bearings, gear)
            for line in _LINES:
                stiffness = getattr(other, f"{line}_stiffness") / getattr(one, f"{line}_stiffness")
                name = f"{line}_damping_ratio"
                fields[f"bearings.{gear}.{name}"] = _ratio(getattr(other, name), stiffness * mass)
    return variant.with_inputs(fields)


def _ratio(ratio: float, product: float) -> float:
    """Damping ratio with which the damper stays where stiffness times mass changes, at most 1."""
    return min(ratio / math.sqrt(product), 1.0)


def _dampers_stay(problem: Problem, variant: Variant) -> list[Choice]:
    """Dampers that do not follow another stiffness, mass or inertia; none where none has changed."""
    pair = problem.pair
    kept = with_dampers_of(pair, variant)
    if kept.pair == variant.pair:
        return []
    words = "dampers [N s/m] that stay as they are, not the damping ratios"
    return [Choice("stay", words, lambda one: with_dampers_of(pair, one))]


def _causes() -> Iterator[Cause]:
    def fixed(
        name: str, meaning: str, span: str, choices: Callable[[Problem, Variant], Sequence[Choice]]
    ) -> Cause:
        return Cause(name, Kind.INPUT, meaning, span, choices)

    yield fixed("relief ignored", "tip and root relief ignored", "ignored", relief_ignored)
    added = Cause(
        name="relief added",
        kind=Kind.INPUT,
        meaning="relief of both tips, over a quarter of the path of contact",
        span="amount, about 4 to 25 um",
        grid=_AMOUNTS,
        neutral=0.0,
        change=_with_relief,
        words="{value} um of relief at both tips",
        shown=lambda value: _MICROMETRES * value,
        applies=_can_be_relieved,
        describes=True,
    )
    yield added
    yield replace(
        added,
        name="amount of relief",
        meaning="the amount of all tip and root relief",
        span=f"factor, about {_RELIEF[0]:g} to {_RELIEF[-1]:g}",
        grid=_RELIEF,
        neutral=1.0,
        change=_relief_amount,
        words="the amount of relief times {value}",
        shown=lambda value: value,
        applies=_acts,
        describes=False,
    )
    yield fixed(
        "driving gear", "the other gear drives", "at its speed; with the numbers of the pinion", driving_gear
    )
    yield fixed(
        "constant speed of a gear",
        "a gear that turns at constant speed: its inertia does not vibrate",
        "pinion, gear",
        _constant_speed,
    )
    yield fixed("static curve", "a static curve in place of the motion", "static", _static)
    yield fixed(
        "dampers stay",
        "dampers that do not follow another stiffness, mass or inertia",
        "stay",
        _dampers_stay,
    )


#: Causes that change a whole part of the design.
OF_DESIGN = tuple(_causes())
