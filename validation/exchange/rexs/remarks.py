"""Remarks of an import: assumed values, the most important first, and parts of the file that are left out."""

from __future__ import annotations

from lumped.fields.units import to_stated
from lumped.schema.pair import GearPair
from validation.exchange.rexs.draft import Draft
from validation.exchange.rexs.model import Component
from validation.exchange.rexs.tooth_system import places

_GEARS = ("pinion", "gear")
#: Group of fields -> ends or starts of the paths of the fields. The groups are named in this order: geometry
#: and load, supports and damping, lubricant and friction, all others.
_GROUPS: dict[str, tuple[str, ...]] = {
    "profile shifts": (".profile_shift",),
    "tips": (".tip_alteration", ".addendum_coefficient"),
    "roots": (".dedendum_coefficient", ".fillet_radius_coefficient"),
    "speed": (".pinion_speed",),
    "torque": (".pinion_torque",),
    "backlash": (".backlash",),
    "bearings": ("bearings.",),
    "damping of the mesh": ("mesh.damping_ratio",),
    "tooth stiffness": ("mesh.",),
    "lubricant": ("lubricant.",),
    "friction": ("friction.",),
    "roughness": (".roughness",),
    "material": (".youngs_modulus", ".poisson_ratio", ".density"),
    "bores": (".bore",),
}


def note_what_is_assumed(draft: Draft, pair: GearPair, gears: dict[str, Component]) -> None:
    """Add the remarks about a pair that was read."""
    _note_shifts(draft, pair)
    _note_tips(draft, pair, gears)
    speed = f"{to_stated(pair.operating.pinion_speed, 'rpm'):g} rpm"
    for key, value in (("speed", speed), ("torque", f"{pair.operating.pinion_torque:g} N m")):
        if f"operating.pinion_{key}" in pair.assumed:
            text = f"operating.pinion_{key} is not in the file: {value} is assumed"
            draft.note(f"{text}; give your own with --{key}")
    if pair.assumed:
        draft.note(
            f"{len(pair.assumed)} values are not in the file and are assumed; what weighs most stands first: "
            f"{_grouped(pair)}"
        )
    for gear_name in _GEARS:
        if f"{gear_name}.inertia" not in dict(pair.sources) and f"{gear_name}.mass" in dict(pair.sources):
            draft.note(f"{gear_name}.inertia is not in REXS: that of a solid disc is taken, not of its mass")
    if draft.model.of_type("shaft_section"):
        draft.note("shafts of the file are not read: describe them and their bearings in [shafts]")
    if pair.pinion.tip_relief or pair.gear.tip_relief:
        draft.note("reliefs are read but mesh.relief decides whether the dynamics use them")


def _grouped(pair: GearPair) -> str:
    """Return the groups of the assumed fields, then the paths of assumed fields without a group."""
    rest = list(pair.assumed)
    words = []
    for name, ends in _GROUPS.items():
        inside = [path for path in rest if path.endswith(ends) or path.startswith(ends)]
        rest = [path for path in rest if path not in inside]
        words += [name] if inside else []
    return ", ".join([*words, *rest])


def _note_shifts(draft: Draft, pair: GearPair) -> None:
    """Say which profile shifts follow from the centre distance."""
    gears_without_shift = [
        gear_name for gear_name in _GEARS if getattr(pair, gear_name).profile_shift is None
    ]
    if not gears_without_shift or pair.centre_distance is None:
        return
    first, second = pair.profile_shifts
    centre = f"the centre distance of {to_stated(pair.centre_distance, 'mm'):g} mm (DIN 3960)"
    if len(gears_without_shift) == 1:
        (gear_name,) = gears_without_shift
        value = pair.profile_shifts[_GEARS.index(gear_name)]
        other = _GEARS[1 - _GEARS.index(gear_name)]
        draft.note(
            f"{gear_name}.profile_shift is not in the file: {value:.4f} follows from that of the {other} and "
            f"{centre}"
        )
    else:
        draft.note(
            f"profile shifts are not in the file: their sum {first + second:.4f} follows from {centre}; how "
            f"the gears share it is assumed, {first:.4f} and {second:.4f}: give one, --set "
            "pinion.profile_shift=VALUE"
        )


def _note_tips(draft: Draft, pair: GearPair, gears: dict[str, Component]) -> None:
    """Note the assumed tip diameters, and the chamfers that are left out."""
    open_tips = [gear_name for gear_name in _GEARS if f"{gear_name}.tip_alteration" in pair.assumed]
    if open_tips:
        tips = " and ".join(f"{2e3 * getattr(pair.geometry, f'tip_radius_{w}'):.3f} mm" for w in open_tips)
        k = to_stated(pair.tip_alteration, "mm")
        rack = pair.basic_rack.addendum_coefficient
        named = " and ".join(f"{gear_name}.tip_diameter" for gear_name in open_tips)
        verb = "is" if len(open_tips) == 1 else "are"
        draft.note(
            f"{named} {verb} not in the file ({places('tip_diameter')}): {tips} {verb} assumed, by the "
            f"addendum coefficient {rack:g} and the clearance of the rack (DIN 3960, k m = {k:.4f} mm). The "
            f"contact ratio is then {pair.geometry.contact_ratio:.3f}. Compare with the drawing, or give it: "
            f"--set {open_tips[0]}.tip_diameter=VALUE"
        )
    for gear_name, gear in gears.items():
        for flank in draft.model.flanks(gear).values():
            chamfer = draft.number(flank, "tooth_tip_chamfer")
            if chamfer is not None and chamfer.si > 0.0:
                height = f"{to_stated(chamfer.si, 'mm'):g} mm"
                draft.note(
                    f"{flank.label}/tooth_tip_chamfer = {height} is left out: contact reaches the tip "
                    f"circle. For contact that ends at the chamfer give a smaller {gear_name}.tip_diameter"
                )
                break
