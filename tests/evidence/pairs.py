"""The gear pairs on which the evidence is computed."""

from collections.abc import Iterator, Mapping

from lumped import GearPair, load_gear_pair
from tests.evidence.faults.fault import Fault

PAIR = "nasa_28_28"
#: The default pair with nothing alike on both sides, where faults show that symmetry hides.
ASYMMETRIC: Mapping[str, object] = {
    "pinion.teeth": 23, "gear.teeth": 31, "pinion.profile_shift": 0.25, "gear.profile_shift": 0.1,
    "centre_distance": None, "pinion.face_width": 6.0, "gear.face_width": 7.5, "gear.density": 7600.0,
    "gear.youngs_modulus": 180.0, "pinion.roughness": 0.09, "gear.roughness": 0.12,
    "pinion.tip_relief": None, "gear.tip_relief": None, "bearings.pinion.loa_stiffness": 8e7,
    "bearings.pinion.oloa_stiffness": 1.5e8, "bearings.gear.loa_stiffness": 2e8,
    "bearings.gear.oloa_stiffness": 5e7, "bearings.gear.oloa_damping_ratio": 0.08,
    "basic_rack.dedendum_coefficient": 1.3, "operating.pinion_speed": 3700.0,
}  # fmt: skip
_RELIEF = {"shape": "linear", "amount": 15.0, "start_roll_angle": 26.0}


def pairs(fault: Fault | None = None, *, wrong: bool = False) -> Iterator[GearPair]:
    """Yield the default pair and the asymmetric variant, with the changes that the fault needs.

    The default pair has no relief, because with relief contact would be lost. ``wrong``: with the wrong input
    of the fault.
    """
    changes_of_fault = {} if fault is None else dict(fault.on) | (dict(fault.input) if wrong else {})
    for changes in ({}, ASYMMETRIC):
        fields = {"mesh.relief": "ignored", **changes, **changes_of_fault}
        if changes and "mesh.relief" in changes_of_fault:
            fields |= {"pinion.tip_relief": _RELIEF, "gear.tip_relief": _RELIEF | {"amount": 10.0}}
        yield load_gear_pair(PAIR).with_(fields)


def gear_pairs() -> list[GearPair]:
    """Those of ``pairs``, and the first with loaded contact and relief."""
    first, second = pairs()
    reliefs = {f"{gear}.tip_relief": _RELIEF for gear in ("pinion", "gear")}
    energy = {"mesh.contact": "loaded", "mesh.stiffness": {"model": "energy"}}
    return [first, second, first.with_({**energy, **reliefs, "mesh.relief": "static"})]
