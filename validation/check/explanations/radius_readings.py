"""Explanations that read a channel over another radius: angles for lengths, torques, tangential forces.

Sources: docs/how_to/check_your_model.md, "Explanations".
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import partial

from validation.check.explanations.cause import Choice, Variant
from validation.check.explanations.fields import tip_radii
from validation.check.explanations.reading import Reading, families
from validation.check.problem import Problem

#: Units of an angle by which a transmission error is given: words -> units in a radian.
ANGLES = {
    "degrees": 180.0 / math.pi,
    "arc seconds": 180.0 * 3600.0 / math.pi,
    "microradians": 1e6,
}


def reading_choice(label: float | str, words: str, change: Callable[[Reading], Reading]) -> Choice:
    """Return a fixed value that changes the reading."""
    return Choice(label, words, lambda variant: variant.with_reading(change(variant.reading)))


def groups(problem: Problem) -> dict[str, tuple[str, ...]]:
    """Return families of channels, then each channel alone: words -> names."""
    channels = problem.curves.channels
    return families(channels) | {channel.name: (channel.name,) for channel in channels}


def radii_of_channels(problem: Problem, variant: Variant) -> list[Choice]:
    """Return lengths for angles, angles and torques of the other gear, and forces over another radius."""
    g = problem.pair.geometry
    ratio = g.base_radius_gear / g.base_radius_pinion
    radii = {"pinion": g.base_radius_pinion, "gear": g.base_radius_gear}
    choices = []
    for channel in problem.curves.channels:
        factors: dict[str, float] = {}
        name = channel.quantity
        if name.startswith("dte"):
            factors = {f"an angle of the {gear}": 1.0 / radius for gear, radius in radii.items()}
            cosine = math.cos(g.operating_pressure_angle)
            factors |= {"a length on the pitch circle": 1.0 / cosine, "a length over 1/cos(alpha)": cosine}
            for gear, tip in zip(radii, tip_radii(problem.pair), strict=True):
                factors[f"a length on the tip circle of the {gear}"] = tip / radii[gear]
                for unit, per_radian in ANGLES.items():
                    factors[f"an angle of the {gear} in {unit}"] = per_radian / radii[gear]
        elif name.startswith("theta"):
            own = "pinion" if "_p" in name else "gear"
            cosine = math.cos(g.operating_pressure_angle)
            factors = {
                "a length on the base circle": radii[own],
                "a length on the pitch circle": radii[own] / cosine,
            }
            if ratio != 1.0:
                factors |= {
                    "the angle times the ratio of the teeth": ratio,
                    "the angle over the ratio of the teeth": 1.0 / ratio,
                }
        elif channel.kind.unit == "N":
            factors = {
                "a force per millimetre of face width": 1e-3 / g.face_width,
                "a force over the static mesh force": g.base_radius_pinion
                / problem.pair.operating.pinion_torque,
                "a torque on the pinion": g.base_radius_pinion,
                "a torque on the gear": g.base_radius_gear,
            }
        elif channel.kind.unit == "N*m" and ratio != 1.0:
            factors = {
                "the torque times the ratio of the teeth": ratio,
                "the torque over the ratio of the teeth": 1.0 / ratio,
            }
        for words, factor in factors.items():

            def change(reading: Reading, name: str = channel.name, factor: float = factor) -> Reading:
                return reading.with_factors({name: factor})

            choices.append(reading_choice(f"{channel.name}: {words}", f"{channel.name} as {words}", change))
    return choices + list(_tangential(problem))


def _tangential(problem: Problem) -> Iterator[Choice]:
    """Forces by the torque over the pitch radius, cos(alpha) times those along the line of action."""
    cosine = math.cos(problem.pair.geometry.operating_pressure_angle)
    for words, names in groups(problem).items():
        forces = [one.name for one in problem.curves.channels if one.name in names and one.kind.unit == "N"]
        if len(forces) < len(names):
            continue
        for text, factor in (("over the pitch radius", cosine), ("times 1/cos(alpha)", 1.0 / cosine)):
            label = f"{words}: a force {text}"
            sentence = f"{words} as a tangential force, the torque over the pitch radius"
            if factor > 1.0:
                sentence = f"{words} over cos(alpha), as if they were tangential forces"
            change = partial(Reading.with_factors, factors=dict.fromkeys(forces, factor))
            yield reading_choice(label, sentence, change)._replace(vague=True)
