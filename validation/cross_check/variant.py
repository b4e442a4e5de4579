"""The asymmetric variant of a gear pair: both gears and all bearings of the variant are unlike.

A pair whose pinion, gear and bearings are alike cannot show swapped bearings, a lever of the wrong gear or a
mirrored drawing. The variant has other tooth numbers, profile shifts, densities and roughnesses on both gears
and four unlike bearings; law, stiffness model, lubricant and torque stay.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from lumped import GearPair
from lumped.errors import SpurcheckError
from lumped.model.steady import UNSTABLE, periodic_cycle
from lumped.quasi_static.contacts import contact_of

#: Factors of the bearings' stiffness and damping, along and off the line of action.
_BEARINGS = {
    "pinion.loa": (0.8, 1.2),
    "pinion.oloa": (1.5, 0.9),
    "gear.loa": (1.3, 0.8),
    "gear.oloa": (0.6, 1.4),
}
#: Factors of the speed, in the order in which they are tried.
_SPEEDS = (0.93, 0.77, 1.19, 0.61, 0.43)
#: Mesh damping ratio of the variant, at least: a quick run must not ring for long.
_DAMPING = 0.03
#: Times per mesh cycle at which teeth must touch and press: between fewer, contact may be lost unseen.
_SAMPLES = 4096


def asymmetric_variant(pair: GearPair) -> GearPair | None:
    """Return the variant, or None where every variation is refused, unstable or lets its teeth separate."""
    for factor in _SPEEDS:
        for changes in _variations(pair):
            speed = pair.operating.pinion_speed * factor * 30.0 / np.pi
            try:
                variant = pair.with_(changes | {"operating.pinion_speed": speed})
                if prediction_holds(variant):
                    return variant
            except SpurcheckError:
                continue
    return None


def prediction_holds(pair: GearPair) -> bool:
    """Whether the lumped motion is possible: the motion is stable, and teeth in contact touch and press.

    In the lumped model alone, damping may press teeth that approach each other before they touch. In loaded
    contact, where a pair begins and ends contact gradually, all pairs together must press.
    """
    motion = periodic_cycle(pair, _SAMPLES)
    pairs = motion.system.cycle.sample(motion.time)
    values = motion.values
    touching = (values["dte"] >= pairs.error) | (pairs.stiffness == 0.0)
    load, touching = contact_of(pair).pressing(values["normal_load"], touching)
    return bool(motion.spectral_radius <= UNSTABLE and touching.all() and load.min() >= 0.0)


def _variations(pair: GearPair) -> Iterator[dict[str, Any]]:
    """Changes of fields; the first changes most fields."""
    fields = pair.to_mapping()
    plain: dict[str, Any] = {"name": f"{pair.name[:70]}, variant", "operating.brake_torque": "balanced"}
    plain["mesh.damping_ratio"] = max(_DAMPING, pair.mesh.damping_ratio)
    for place, (stiffness, damping) in _BEARINGS.items():
        gear, axis = place.split(".")
        bearing = getattr(pair.bearings, gear)
        plain[f"bearings.{gear}.{axis}_stiffness"] = getattr(bearing, f"{axis}_stiffness") * stiffness
        ratio = max(_DAMPING, getattr(bearing, f"{axis}_damping_ratio")) * damping
        plain[f"bearings.{gear}.{axis}_damping_ratio"] = min(ratio, 2.0)
    for gear, density, roughness in (("pinion", 0.9, 1.3), ("gear", 1.1, 0.8)):
        plain[f"{gear}.density"] = fields[gear].get("density", 7850.0) * density
        plain[f"{gear}.roughness"] = getattr(pair, gear).roughness * 1e6 * roughness
    teeth = {
        "pinion.teeth": pair.pinion.teeth + 1,
        "gear.teeth": pair.gear.teeth + 1 + pair.gear.teeth // 8,
        "pinion.profile_shift": pair.profile_shifts[0] + 0.08,
        "gear.profile_shift": pair.profile_shifts[1] - 0.03,
        "centre_distance": None,
    }
    without_tips, without_reliefs = (
        {
            f"{g}.{n}": None
            for g in ("pinion", "gear")
            for n in names
            if getattr(getattr(pair, g), n) is not None
        }
        for names in (("addendum", "tip_diameter", "tip_alteration"), ("tip_relief", "root_relief"))
    )
    yield plain | teeth | without_tips
    if without_reliefs:
        yield plain | teeth | without_tips | without_reliefs
    yield plain
