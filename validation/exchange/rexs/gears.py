"""The gears of a REXS stage: teeth, blank, material, flanks and tool."""

from __future__ import annotations

import math

from lumped.errors import FieldProblem
from validation.exchange.rexs.model import Component
from validation.exchange.rexs.said import Reading, Said

#: Field -> attribute of the gear, and of its material.
_BLANK = {
    "face_width": "face_width",
    "tip_diameter": "tip_diameter",
    "bore": "inner_diameter",
    "mass": "mass_of_component",
}
MATERIAL = {"youngs_modulus": "elastic_modulus", "poisson_ratio": "poisson_ratio", "density": "density"}
#: Ra and Rz of the flank: names up to 1.7, and of 2.0.0.
_RA = ("arithmetic_average_roughness_flank", "arithmetic_mean_roughness_flank_iso_4287_1997")
_RZ = ("averaged_peak_to_valley_height_flank", "mean_peak_to_valley_roughness_flank_iso_4287_1997")
#: Rz over Ra where a file has only Rz (ISO 6336-2).
_RZ_OVER_RA = 6.0


def read_gears(said: Said, pinion: Component, gear: Component) -> None:
    """Read both gears of a stage, reliefs apart.

    Parameters
    ----------
    said : collects what is found
    pinion, gear : components; the pinion is the driving gear
    """
    for which, component in (("pinion", pinion), ("gear", gear)):
        _read_blank(said, which, component)
        for material in said.model.related(component, "reference", "origin", "referenced", "material"):
            said.take_all(which, material, MATERIAL)
        _read_shift(said, which, component)
    _read_rack(said, pinion, gear)


def flanks_of(said: Said, gear: Component) -> list[tuple[str, Component]]:
    """Return ("left", flank) and ("right", flank), as far as the file has them."""
    return [
        (side, flank)
        for side in ("left", "right")
        for flank in said.model.related(gear, "flank", "gear", side, "cylindrical_gear_flank")
    ]


def _read_blank(said: Said, which: str, gear: Component) -> None:
    teeth = said.number(gear, "number_of_teeth")
    if teeth is None:
        _missing(said, gear, "number_of_teeth")
    elif teeth.si != int(teeth.si):
        problem = FieldProblem(teeth.where, f"{teeth.si:g}", "a whole number", "Correct the file.")
        said.problems.append(problem)
    else:
        said.put(f"{which}.teeth", int(teeth.si), teeth.where)
    if said.raw(gear, "face_width") is None:
        _missing(said, gear, "face_width")
    if said.raw(gear, "helix_angle_reference_diameter") is None:
        said.note(f"{gear.label} has no helix angle: taken as a spur gear (assumed)")
    said.take_all(which, gear, _BLANK)
    _read_roughness(said, which, gear)


def _missing(said: Said, component: Component, attribute: str) -> None:
    where = said.where(component, attribute)
    action = "Nothing can stand in for it: complete the model in the program that exported it."
    said.problems.append(FieldProblem(where, "not given", "a value", action))


def _read_roughness(said: Said, which: str, gear: Component) -> None:
    for names, factor, remark in ((_RA, 1.0, ""), (_RZ, _RZ_OVER_RA, ", Ra = Rz/6 (ISO 6336-2)")):
        for attribute in names:
            if (found := said.number(gear, attribute)) is not None:
                return said.take(f"{which}.roughness", Reading(found.si / factor, found.where), remark)
    return None


def _read_shift(said: Said, which: str, gear: Component) -> None:
    flanks = [flank for _, flank in flanks_of(said, gear)]
    why = "The flanks of a tooth differ; only symmetric teeth can be modelled."
    shift = said.agreed([said.number(f, "addendum_modification_coefficient") for f in flanks], why)
    if shift is None:
        length = said.agreed([said.number(f, "addendum_modification") for f in flanks], why)
        module = said.number(gear, "normal_module")
        if length is not None and module is not None and module.si > 0.0:
            shift = Reading(length.si / module.si, f"{length.where} / normal_module")
    said.take(f"{which}.profile_shift", shift)


def _read_rack(said: Said, pinion: Component, gear: Component) -> None:
    """Read the basic rack: module and pressure angle must agree; the tool's tip is the teeth's root."""
    both = (pinion, gear)
    for component in both:
        if said.raw(component, "normal_module") is None:
            _missing(said, component, "normal_module")
    modules = [said.number(g, "normal_module") for g in both]
    module = said.agreed(modules, "Gears that mesh have one module.")
    said.take("basic_rack.module", module)
    flanks = [flank for g in both for _, flank in flanks_of(said, g)]
    why = "Flanks that mesh have one pressure angle, and only symmetric teeth can be modelled."
    angle = said.agreed([said.number(f, "normal_pressure_angle") for f in flanks], why)
    said.take("basic_rack.pressure_angle", angle)
    tools = [
        tool
        for flank in flanks
        for tool in said.model.related(flank, "manufacturing_step", "workpiece", "tool", "rack_shaped_tool")
    ]
    _common(
        said,
        "basic_rack.addendum_coefficient",
        [said.number(f, "addendum_coefficient_basic_profile") for f in flanks],
    )
    _common(
        said,
        "basic_rack.dedendum_coefficient",
        [said.number(t, "addendum_coefficient_reference_profile") for t in tools]
        or [_dedendum(said, g, module) for g in both],
    )
    radii = [
        said.number(t, attribute)
        for t in tools
        for attribute in ("tip_radius_factor", "tip_corner_radius_factor_reference_profile")
    ]
    _common(said, "basic_rack.fillet_radius_coefficient", radii)


def _common(said: Said, path: str, readings: list[Reading | None]) -> None:
    """Take a value that spurcheck has once for both gears; where they differ the pinion's, with a note."""
    present = [r for r in readings if r is not None]
    if not present:
        return
    said.take(path, present[0])
    if any(not math.isclose(r.si, present[0].si, rel_tol=1e-9) for r in present[1:]):
        values = ", ".join(f"{r.si:.6g} in {r.where}" for r in present[1:])
        said.note(f"{path}: the first value is used for both gears, the file also has {values}")


def _dedendum(said: Said, gear: Component, module: Reading | None) -> Reading | None:
    """h_fP* from the root diameter: d_f = m (z + 2 x - 2 h_fP*)."""
    root, teeth = said.number(gear, "root_diameter"), said.number(gear, "number_of_teeth")
    shifts = [said.number(f, "addendum_modification_coefficient") for _, f in flanks_of(said, gear)]
    if root is None or teeth is None or module is None or not shifts or shifts[0] is None:
        return None
    value = 0.5 * (teeth.si + 2.0 * shifts[0].si - root.si / module.si)
    return Reading(value, f"{root.where}, by d_f = m (z + 2 x - 2 h_fP*)")


def gear_data_of(said: Said, stage: Component, gear: Component) -> list[Component]:
    """Return the components that hold what a gear does in a stage."""
    kind = "stage_gear_data"
    of_stage = said.model.related(stage, kind, "stage", kind, "cylindrical_stage_gear_data")
    data = said.model.related(gear, kind, "gear", kind, "cylindrical_stage_gear_data")
    return [d for d in data if d in of_stage]
