"""What explanations that change inputs of the pair share: fields, causes with a factor or fixed values.

Sources: docs/how_to/check_your_model.md, "Explanations".
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from lumped.schema.pair import GearPair
from validation.check.explanations.cause import Cause, Choice, Kind, Variant
from validation.check.problem import Problem

GEARS = ("pinion", "gear")
LINES = ("loa", "oloa")
#: Trial factors of a quantity that is rarely far from its value.
NEAR = (0.4, 0.63, 0.8, 1.25, 1.6, 2.5)
#: Trial factors of a damper.
DAMPER = (0.1, 0.4, 2.5, 10.0)
Fields = Mapping[str, Any]


def changing(fields: Callable[[GearPair, float], Fields]) -> Callable[[Variant, float], Variant]:
    """Return the change of a variant by a factor on fields of the pair."""
    return lambda variant, value: variant.with_inputs(dict(fields(variant.pair, value)))


def choice(label: float | str, words: str, fields: Callable[[GearPair], Fields]) -> Choice:
    """Return a fixed value that changes fields of the pair."""
    return Choice(label, words, lambda variant: variant.with_inputs(dict(fields(variant.pair))))


def constant(fields: Fields) -> Callable[[GearPair], Fields]:
    """Return the same fields for every pair."""
    return lambda pair: fields


def times(fields: Callable[[GearPair, float], Fields], value: float) -> Callable[[GearPair], Fields]:
    """Return fields of a pair with a factor."""
    return lambda pair: fields(pair, value)


def with_prescribed_contact(variant: Variant) -> Variant:
    """Return a variant with prescribed contact. Relief is ignored where contact was loaded, else it stays."""
    if variant.pair.mesh.contact == "prescribed":
        return variant
    return variant.with_inputs({"mesh.contact": "prescribed", "mesh.relief": "ignored"})


def on_springs(problem: Problem, variant: Variant) -> bool:
    """Return whether the gears stand on springs, not on shafts."""
    return variant.pair.shafts is None


def tip_radii(pair: GearPair) -> tuple[float, float]:
    """Return the tip radii of both gears [m]."""
    g = pair.geometry
    return g.tip_radius_pinion, g.tip_radius_gear


def reference_radii(pair: GearPair) -> tuple[float, float]:
    """Return the reference radii of both gears [m]."""
    g = pair.geometry
    return g.reference_radius_pinion, g.reference_radius_gear


def free_factor(
    name: str,
    meaning: str,
    grid: tuple[float, ...],
    fields: Callable[[GearPair, float], Fields],
    applies: Callable[[Problem, Variant], bool] = lambda problem, variant: True,
) -> Cause:
    """Return a cause with a free factor on fields of the pair."""
    return Cause(
        name=name,
        kind=Kind.INPUT,
        meaning=meaning,
        span=f"factor, about {grid[0]:g} to {grid[-1]:g}",
        grid=grid,
        change=changing(fields),
        words=f"{meaning} times {{value}}",
        applies=applies,
    )


def fixed_values(
    name: str, meaning: str, span: str, choices: Callable[[Problem, Variant], Sequence[Choice]]
) -> Cause:
    """Return a cause with fixed values of inputs, the most usual first."""
    return Cause(name, Kind.INPUT, meaning, span, choices)
