"""Explanations that read tip relief or deviations of single teeth in another way than the drawing means.

Sources: docs/how_to/check_your_model.md, "Explanations"; ISO 1328-1 for single and cumulative pitch
deviations.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from lumped.fields.units import to_stated
from lumped.schema.pair import GearPair
from lumped.schema.tooth_errors import tooth_errors
from validation.check.explanations.cause import Cause, Choice, Kind, Variant
from validation.check.explanations.fields import GEARS, fixed_values, tip_radii
from validation.check.explanations.surface_inputs import relieved_tips, tip_relief
from validation.check.problem import Problem

#: Lengths of a relief closer than this share are one.
_SAME = 0.01
#: How a model may take errors of all tooth pairs for one: label of the alteration -> words.
_COMMON = {
    "smallest": "one error for all pairs in contact, the smallest: the unloaded transmission error",
    "mean": "one error for all pairs in contact, their mean by stiffness",
    "newest pair": "the error of the newest pair for all pairs in contact",
    "mean stiffness": "errors of the teeth that act through the mean stiffness of the mesh",
}


def _acts(variant: Variant) -> bool:
    """Whether tip relief acts."""
    return variant.pair.mesh.relief != "ignored" and bool(relieved_tips(variant.pair))


def _with_tips(fields: dict[str, Any]) -> Callable[[Variant], Variant]:
    return lambda one: one.with_inputs(fields)


def _end_of_relief(problem: Problem, variant: Variant) -> list[Choice]:
    """Tip relief at the wrong end of the path of contact, or on the other gear.

    The tip of the pinion ends contact at D, the tip of the gear starts it at A. A root relief acts at the
    other end than the tip relief of the same gear.
    """
    if not _acts(variant):
        return []
    pair = variant.pair
    tips = relieved_tips(pair)
    reliefs = {gear: tip_relief(pair, gear) for gear in tips}
    ends = {"pinion": "the start", "gear": "the end"}
    moved = {
        gear: {f"{gear}.tip_relief": None, f"{gear}.root_relief": reliefs[gear]}
        for gear in tips
        if getattr(pair, gear).root_relief is None
    }
    choices = [
        Choice(
            f"of the {gear}",
            f"the tip relief of the {gear} at {ends[gear]} of contact, the wrong end",
            _with_tips(fields),
        )
        for gear, fields in moved.items()
    ]
    if len(tips) == 2:
        if len(moved) == 2:
            words = "the tip relief of both gears at the wrong ends of contact"
            choices.append(Choice("of both gears", words, _with_tips(moved["pinion"] | moved["gear"])))
        for gear, other in (GEARS, GEARS[::-1]):
            words = f"the tip relief of the {gear} on both gears"
            choices.append(
                Choice(f"of the {gear} on both", words, _with_tips({f"{other}.tip_relief": reliefs[gear]}))
            )
    other_of = dict((GEARS, GEARS[::-1]))
    exchanged = {f"{other_of[gear]}.tip_relief": reliefs.get(gear) for gear in GEARS}
    choices.append(Choice("exchanged", "the tip relief of each gear on the other one", _with_tips(exchanged)))
    return choices


def _start_of_relief(problem: Problem, variant: Variant) -> list[Choice]:
    """Tip relief whose start is read in another measure."""
    if not _acts(variant):
        return []
    pair = variant.pair
    g = pair.geometry
    roots = {"pinion": g.L_XA, "gear": g.L_XY - g.L_XD}
    tips = dict(zip(GEARS, tip_radii(pair), strict=True))
    bases = {"pinion": g.base_radius_pinion, "gear": g.base_radius_gear}
    lengths: dict[str, dict[str, float]] = {}
    for gear in relieved_tips(pair):
        base, tip = bases[gear], tips[gear]
        length = 1e-3 * tip_relief(pair, gear)["length"]
        end = math.sqrt(tip**2 - base**2)
        height = tip - math.hypot(end - length, base)
        radius = max(tip - length, base)
        lengths[gear] = {
            "roll angle from the start of contact": length - roots[gear],
            "height as a length": height,
            "difference of diameters as a length": 2.0 * height,
            "length as a height": end - math.sqrt(radius**2 - base**2),
        }
    texts = {
        "roll angle from the start of contact": "a relief whose roll angle counts from the start of contact",
        "height as a length": "the radial height of the relief as its length on the line of action",
        "difference of diameters as a length": "the difference of diameters of the relief as its length on "
        "the line of action",
        "length as a height": "the length of the relief on the line of action as its radial height",
    }
    choices = []
    for label, words in texts.items():
        fields = {}
        for gear, values in lengths.items():
            relief = tip_relief(pair, gear)
            within = min(values[label], 0.98 * (g.L_XD - g.L_XA))
            changed = relief | {"length": to_stated(within, "mm")}
            fields[f"{gear}.tip_relief"] = changed if within > _SAME * 1e-3 * relief["length"] else None
        choices.append(Choice(label, words, _with_tips(fields)))
    return choices


def _errors_may_change(problem: Problem, variant: Variant) -> bool:
    """Whether the error of all teeth can be altered: prescribed contact with relief that acts."""
    physics = variant.physics
    return _acts(variant) and variant.pair.mesh.contact == "prescribed" and not physics.of_error


def _sign_of_relief(problem: Problem, variant: Variant) -> list[Choice]:
    """Relief that adds material."""
    if not _errors_may_change(problem, variant):
        return []
    groups: dict[str, tuple[str, ...]] = {f"of the {gear}": (gear,) for gear in relieved_tips(variant.pair)}
    if len(groups) == 2:
        groups = {"of both gears": GEARS, **groups}

    def turned(gears: Sequence[str]) -> Callable[[Variant], Variant]:
        return lambda one: one.with_physics(**{f"relief_{gear}": -1.0 for gear in gears})

    return [
        Choice(words, f"the relief {words} with the wrong sign, adding material", turned(gears))
        for words, gears in groups.items()
    ]


def _common_error(problem: Problem, variant: Variant) -> list[Choice]:
    """One error for all tooth pairs in contact."""
    if not _errors_may_change(problem, variant):
        return []

    def change(label: str) -> Callable[[Variant], Variant]:
        return lambda one: one.with_physics(common_error=label)

    return [Choice(label, words, change(label)) for label, words in _COMMON.items()]


def _rate_of_errors(problem: Problem, variant: Variant) -> list[Choice]:
    """Dampers of the teeth that do not see the rate of the errors."""
    if not _errors_may_change(problem, variant) or variant.pair.mesh.damping_ratio == 0.0:
        return []
    words = "dampers of the teeth by the rate of the transmission error, without that of the relief"
    return [Choice("left out", words, lambda one: one.with_physics(contact="no rate of the errors"))]


def _pitches(
    pair: GearPair, change: Callable[[np.ndarray[Any, Any]], np.ndarray[Any, Any]]
) -> dict[str, Any]:
    """Index deviations of both gears after a change of their numbers (z,) [m]."""
    fields: dict[str, Any] = {}
    for gear, errors in zip(GEARS, tooth_errors(pair), strict=True):
        deviations = getattr(pair, gear).deviations
        if deviations is None:
            continue
        fields[f"{gear}.deviations"] = {
            "index": tuple(to_stated(value, "um") for value in change(np.asarray(errors.index))),
            "profile_slope": tuple(to_stated(value, "um") for value in errors.slope),
            "first_order": deviations.first_order,
        }
    return fields


def _reading_of_deviations(problem: Problem, variant: Variant) -> list[Choice]:
    """Deviations of single teeth that are read in another way, or turn with the other gear."""
    pair = variant.pair
    choices = []
    if any(getattr(pair, gear).deviations is not None for gear in GEARS):
        changes: dict[str, tuple[str, Callable[[Any], Any]]] = {
            "single for cumulative": (
                "single pitch deviations in place of the cumulative ones",
                lambda index: index - np.roll(index, 1),
            ),
            "cumulative for single": (
                "cumulative pitch deviations summed once more",
                lambda index: np.cumsum(index - index.mean()),
            ),
            "numbered backwards": (
                "teeth that are numbered backwards",
                lambda index: np.roll(index[::-1], 1),
            ),
        }
        for label, (words, change) in changes.items():
            choices.append(Choice(label, words, _with_tips(_pitches(pair, change))))
    for gear, other in (GEARS, GEARS[::-1]):
        mounting = getattr(pair, gear).mounting
        if mounting is not None and getattr(pair, other).mounting is None:
            moved = {
                f"{gear}.mounting": None,
                f"{other}.mounting": {
                    "eccentricity": to_stated(mounting.eccentricity, "um"),
                    "phase": to_stated(mounting.phase, "deg"),
                },
            }
            words = f"the eccentricity of the {gear} on the {other}"
            choices.append(Choice(f"eccentricity on the {other}", words, _with_tips(moved)))
    return choices


def _causes() -> Iterator[Cause]:
    yield fixed_values(
        "end of the relief",
        "tip relief at the wrong end of contact, or on the other gear",
        "of the pinion, of the gear, of both gears; of one gear on both; exchanged",
        _end_of_relief,
    )
    yield fixed_values(
        "start of the relief",
        "the start of the tip relief in another measure",
        "roll angle from the start of contact; height or diameters as a length; length as a height",
        _start_of_relief,
    )
    yield fixed_values(
        "reading of the deviations",
        "deviations of single teeth read in another way, or an eccentricity on the other gear",
        "single for cumulative, cumulative for single, numbered backwards; eccentricity",
        _reading_of_deviations,
    )
    for name, meaning, span, choices in (
        (
            "sign of the relief",
            "relief with the wrong sign, adding material",
            "of both gears, of the pinion, of the gear",
            _sign_of_relief,
        ),
        (
            "one error for all pairs",
            "one error for all tooth pairs in contact, in place of the error of each",
            "smallest, mean, newest pair, mean stiffness",
            _common_error,
        ),
        (
            "rate of the errors",
            "dampers of the teeth without the rate of the relief",
            "left out",
            _rate_of_errors,
        ),
    ):
        yield Cause(name, Kind.PHYSICS, meaning, span, choices)


#: Causes that read relief and deviations in another way.
OF_RELIEF = tuple(_causes())
