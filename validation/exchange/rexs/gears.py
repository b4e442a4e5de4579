"""The gears of a REXS stage: teeth, blank, material, flanks, tool and reliefs."""

from __future__ import annotations

import math

from lumped.fields.units import to_file
from lumped.gear_geometry.geometry import Geometry
from validation.exchange.rexs.draft import Draft, Reading
from validation.exchange.rexs.model import NOT_TAKEN, Component, derived_number

#: Field -> attribute of the gear, and of its material.
_BLANK = {
    "face_width": "face_width",
    "tip_diameter": "tip_diameter",
    "bore": "inner_diameter",
    "mass": "mass_of_component",
}
_MATERIAL = {"youngs_modulus": "elastic_modulus", "poisson_ratio": "poisson_ratio", "density": "density"}
#: Attribute of the flank's roughness, up to 1.7 and of 2.0.0 -> how many Ra it is; Rz = 6 Ra (ISO 6336-2).
_ROUGHNESS = {
    "arithmetic_average_roughness_flank": 1.0,
    "arithmetic_mean_roughness_flank_iso_4287_1997": 1.0,
    "averaged_peak_to_valley_height_flank": 6.0,
    "mean_peak_to_valley_roughness_flank_iso_4287_1997": 6.0,
}
RELIEFS = ("tip_relief", "root_relief")
_SYMMETRIC = "The flanks of a tooth differ; only symmetric teeth can be modelled."
_MESH = "Flanks that mesh have one pressure angle, and only symmetric teeth can be modelled."
_MISSING = "Nothing can stand in for it: complete the model in the program that exported it."


def read_gears(draft: Draft, pinion: Component, gear: Component) -> None:
    """Read both gears of a stage, reliefs apart; the pinion is the driving gear."""
    for which, component in (("pinion", pinion), ("gear", gear)):
        _read_blank(draft, which, component)
        for material in draft.model.referenced(component, "material"):
            draft.take_all(which, material, _MATERIAL)
        _read_shift(draft, which, component)
    _read_rack(draft, pinion, gear)


def flanks_of(draft: Draft, gear: Component) -> dict[str, Component]:
    """Return "left" and "right" -> flank, as far as the file has them."""
    return {
        side: flank
        for side in ("left", "right")
        for flank in draft.model.related(gear, "flank", "gear", side, "cylindrical_gear_flank")
    }


def gear_data_of(draft: Draft, stage: Component, gear: Component) -> list[Component]:
    """Return the components that hold what a gear does in a stage."""
    kind = "stage_gear_data"
    of_stage = draft.model.related(stage, kind, "stage", kind, "cylindrical_stage_gear_data")
    return [d for d in draft.model.related(gear, kind, "gear", kind) if d in of_stage]


def _read_blank(draft: Draft, which: str, gear: Component) -> None:
    teeth = draft.number(gear, "number_of_teeth")
    if teeth is not None and teeth.si != int(teeth.si):
        draft.problem(teeth.where, f"{teeth.si:g}", "a whole number")
    elif teeth is not None:
        draft.put(f"{which}.teeth", int(teeth.si), teeth.where)
    for needed in ("number_of_teeth", "face_width", "normal_module"):
        if draft.text(gear, needed) is None:
            draft.problem(draft.where(gear, needed), "not given", "a value", _MISSING)
    if draft.text(gear, "helix_angle_reference_diameter") is None:
        draft.note(f"{gear.label} has no helix angle: taken as a spur gear (assumed)")
    draft.take_all(which, gear, _BLANK)
    for attribute, factor in _ROUGHNESS.items():
        if (result := draft.number(gear, attribute)) is not None:
            remark = "" if factor == 1.0 else ", Ra = Rz/6 (ISO 6336-2)"
            draft.take(f"{which}.roughness", Reading(result.si / factor, result.where), remark)
            break


def _read_shift(draft: Draft, which: str, gear: Component) -> None:
    flanks = flanks_of(draft, gear).values()
    shift, length = (
        draft.agreed((draft.number(f, f"addendum_modification{end}") for f in flanks), _SYMMETRIC)
        for end in ("_coefficient", "")
    )
    module = draft.number(gear, "normal_module")
    if shift is None and length is not None and module is not None and module.si > 0.0:
        shift = Reading(length.si / module.si, f"{length.where} / normal_module")
    draft.take(f"{which}.profile_shift", shift)


def _read_rack(draft: Draft, *gears: Component) -> None:
    """Read the basic rack: module and pressure angle must agree; the tool's tip is the teeth's root."""
    module = draft.agreed(
        (draft.number(g, "normal_module") for g in gears), "Gears that mesh have one module."
    )
    draft.take("basic_rack.module", module)
    flanks = [flank for g in gears for flank in flanks_of(draft, g).values()]
    angle = draft.agreed((draft.number(f, "normal_pressure_angle") for f in flanks), _MESH)
    draft.take("basic_rack.pressure_angle", angle)
    step = ("manufacturing_step", "workpiece", "tool", "rack_shaped_tool")
    tools = [tool for flank in flanks for tool in draft.model.related(flank, *step)]
    dedenda = [draft.number(t, "addendum_coefficient_reference_profile") for t in tools]
    radii = ("tip_radius_factor", "tip_corner_radius_factor_reference_profile")
    for path, readings in {
        "addendum": [draft.number(f, "addendum_coefficient_basic_profile") for f in flanks],
        "dedendum": dedenda or [_dedendum(draft, g, module) for g in gears],
        "fillet_radius": [draft.number(t, name) for t in tools for name in radii],
    }.items():
        draft.take_first(f"basic_rack.{path}_coefficient", readings)


def _dedendum(draft: Draft, gear: Component, module: Reading | None) -> Reading | None:
    """h_fP* from the root diameter: d_f = m (z + 2 x - 2 h_fP*)."""
    root, teeth = draft.number(gear, "root_diameter"), draft.number(gear, "number_of_teeth")
    shifts = [draft.number(f, "addendum_modification_coefficient") for f in flanks_of(draft, gear).values()]
    if root is None or teeth is None or module is None or not shifts or shifts[0] is None:
        return None
    value = 0.5 * (teeth.si + 2.0 * shifts[0].si - root.si / module.si)
    return Reading(value, f"{root.where}, by d_f = m (z + 2 x - 2 h_fP*)")


def read_reliefs(draft: Draft, stage: Component, gears: dict[str, Component], geometry: Geometry) -> None:
    """Read the reliefs of "pinion" and "gear"; the geometry turns diameters into roll angles."""
    for which, gear in gears.items():
        flank = _working_flank(draft, stage, gear)
        if flank is None:
            continue
        for other in draft.model.referenced(flank, *NOT_TAKEN):
            draft.note(f"{other.label} of {flank.label} is left out: spurcheck has no such modification")
        for kind in RELIEFS:
            reliefs = draft.model.referenced(flank, kind)
            if len(reliefs) > 1:
                draft.note(f"{flank.label} has {len(reliefs)} components {kind}: all are left out")
            elif reliefs:
                _read_relief(draft, which, reliefs[0], geometry)


def _working_flank(draft: Draft, stage: Component, gear: Component) -> Component | None:
    """Return the flank that carries load; where the file does not say, the left one."""
    flanks = flanks_of(draft, gear)
    for data in gear_data_of(draft, stage, gear):
        if (side := draft.text(data, "loaded_tooth_flank")) in flanks:
            return flanks[side]
    return next(iter(flanks.values()), None)


def _read_relief(draft: Draft, which: str, relief: Component, geometry: Geometry) -> None:
    """Read one relief; a depth stated at another diameter is carried to the end along the relief's shape."""
    kind = relief.type
    depth, start, stated_at = (
        draft.number(relief, f"{kind}_{name}") for name in ("depth", "datum_diameter", "evaluation_reference")
    )
    shape = draft.text(relief, "shape_of_relief") or "linear"
    base = 2.0 * getattr(geometry, f"base_radius_{which}")
    if depth is None or start is None or start.si <= base or shape not in ("linear", "parabolic"):
        draft.note(
            f"{relief.label} is left out: a depth, the diameter of its start above the base circle and a "
            "linear or parabolic shape are needed"
        )
        return
    begin, end = _roll_angle(start.si, base), end_of_flank(geometry, which, kind)
    number, remark = to_file(depth.si, "um"), ""
    if stated_at is not None and stated_at.si > base:
        stated = _roll_angle(stated_at.si, base)
        # The same diameter printed with 15 digits is not carried: that would only add rounding.
        if not math.isclose(stated, end, rel_tol=1e-9) and (stated - begin) * (end - begin) > 0.0:
            carried = ((end - begin) / (stated - begin)) ** (1 if shape == "linear" else 2)
            number = derived_number(depth.si * carried, "um")
            remark = f", carried from {kind}_evaluation_reference to the end of the flank"
    path = f"{which}.{kind}"
    draft.put(f"{path}.shape", shape, draft.where(relief, "shape_of_relief"))
    draft.put(f"{path}.amount", number, depth.where + remark)
    draft.put(f"{path}.start_roll_angle", derived_number(begin, "deg"), f"{start.where}, as roll angle")


def end_of_flank(g: Geometry, which: str, kind: str) -> float:
    """Roll angle [rad] where the amount of a relief holds: of the tip, or of the active flank's start."""
    if which == "pinion":
        return (g.L_XD if kind == "tip_relief" else g.L_XA) / g.base_radius_pinion
    return (g.L_XY - (g.L_XA if kind == "tip_relief" else g.L_XD)) / g.base_radius_gear


def _roll_angle(diameter: float, base: float) -> float:
    """Roll angle of a circle [rad]: the tangent of its pressure angle."""
    return math.sqrt((diameter / base) ** 2 - 1.0)


def diameter_at(roll: float, base: float) -> float:
    """Diameter of the circle at a roll angle."""
    return base * math.hypot(1.0, roll)
