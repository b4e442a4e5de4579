"""Pairs of every kind that page 1 speaks of, unlike each other."""

from __future__ import annotations

from collections.abc import Callable

import lumped
from lumped.schema.pair import GearPair
from validation.exchange import new_pair


def _shaft(diameter: float, stiffness: float) -> dict[str, object]:
    ends = [
        {"position": position, "loa_stiffness": stiffness, "oloa_stiffness": stiffness}
        for position in (10, 150)
    ]
    return {
        "segments": [{"length": 160, "diameter": diameter}], "gear_position": 80, "bearings": ends,
    }  # fmt: skip


def _without_relief(speed: float) -> GearPair:
    return lumped.load_gear_pair("nasa_28_28").with_({"speed": speed, "mesh.relief": "ignored"})


#: Kind -> the pair.
KINDS: dict[str, Callable[[], GearPair]] = {
    "linear": lambda: new_pair("33/35", 4.0, 40, 900, 300, {"pinion.profile_shift": 0.2}),
    "contact lost": lambda: _without_relief(8700.0),
    "resonance": lambda: new_pair("25/103", 3.0, 30, 1500, 100),
    "jump near": lambda: _without_relief(7450.0),
    "jump far": lambda: _without_relief(6500.0),
    "class": lambda: new_pair("21/34", 3.0, 25, 2000, 150, {
        "pinion.deviations": {"tolerance_class": 5}, "gear.deviations": {"tolerance_class": 6}}),
    "fault": lambda: new_pair("20/27", 2.0, 15, 1200, 40, {
        "pinion.faults": [{"kind": "crack", "tooth": 3, "depth": 1.2, "angle": 60}]}),
    "shafts": lambda: new_pair("19/41", 2.5, 20, 1450, 80, {
        "shafts": {"damping_ratio": 0.03, "pinion": _shaft(30, 2e8), "gear": _shaft(38, 3e8)}}),
    "plastic": lambda: new_pair("17/40", 0.5, 5, 3000, 0.02, {
        "gears.youngs_modulus": 3.0, "gears.density": 1400, "gears.poisson_ratio": 0.4}),
    "wind": lambda: new_pair("21/93", 14.0, 320, 300, 12000),
    # Mesh order 7 meets the mode of the pinion off the line of action: sliding is reversed.
    "outside": lambda: new_pair("19/41", 2.5, 20, 1450, 80, {
        "bearings.pinion.loa_stiffness": 2.435e8, "bearings.pinion.oloa_stiffness": 1.12e8,
        "bearings.gear.loa_stiffness": 2.652e8, "bearings.gear.oloa_stiffness": 1.22e8}),
}  # fmt: skip
