"""Gears of a REXS stage without the tooth system: blank, material, roughness and reliefs."""

from __future__ import annotations

import math

from lumped.fields.units import to_file
from lumped.gear_geometry.geometry import Geometry
from validation.exchange.rexs.draft import Draft, Reading
from validation.exchange.rexs.model import NOT_TAKEN, Component, derived_number

#: Field -> attribute of the gear, and of its material.
_BLANK = {"bore": "inner_diameter", "mass": "mass_of_component"}
_MATERIAL = {"youngs_modulus": "elastic_modulus", "poisson_ratio": "poisson_ratio", "density": "density"}
#: Attribute of the flank roughness (REXS up to 1.7, and 2.0.0) -> value over Ra; Rz = 6 Ra (ISO 6336-2).
_ROUGHNESS = {
    "arithmetic_average_roughness_flank": 1.0,
    "arithmetic_mean_roughness_flank_iso_4287_1997": 1.0,
    "averaged_peak_to_valley_height_flank": 6.0,
    "mean_peak_to_valley_roughness_flank_iso_4287_1997": 6.0,
}
RELIEFS = ("tip_relief", "root_relief")


def read_gears(draft: Draft, gears: dict[str, Component]) -> None:
    """Read blanks and materials of "pinion" and "gear". Reliefs: see `read_reliefs`."""
    for gear_name, component in gears.items():
        _read_blank(draft, gear_name, component)
        for material in draft.model.referenced(component, "material"):
            draft.take_all(gear_name, material, _MATERIAL)


def _read_blank(draft: Draft, gear_name: str, gear: Component) -> None:
    draft.take_all(gear_name, gear, _BLANK)
    for attribute, factor in _ROUGHNESS.items():
        if (result := draft.number(gear, attribute)) is not None:
            remark = "" if factor == 1.0 else ", Ra = Rz/6 (ISO 6336-2)"
            draft.take(f"{gear_name}.roughness", Reading(result.si / factor, result.where), remark)
            break


def read_reliefs(draft: Draft, stage: Component, gears: dict[str, Component], geometry: Geometry) -> None:
    """Read the reliefs of "pinion" and "gear". The geometry is needed to convert diameters to roll angles."""
    for gear_name, gear in gears.items():
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
                _read_relief(draft, gear_name, reliefs[0], geometry)


def _working_flank(draft: Draft, stage: Component, gear: Component) -> Component | None:
    """Return the loaded flank. If the file does not state the loaded flank, the left flank is returned."""
    flanks = draft.model.flanks(gear)
    for data in draft.model.gear_data(stage, gear):
        if (side := draft.text(data, "loaded_tooth_flank")) in flanks:
            return flanks[side]
    return next(iter(flanks.values()), None)


def _read_relief(draft: Draft, gear_name: str, relief: Component, geometry: Geometry) -> None:
    """Read one relief.

    If the depth is stated at a diameter before the end of the flank, the depth at the end follows from the
    shape of the relief.
    """
    kind = relief.type
    depth, start, stated_at = (
        draft.number(relief, f"{kind}_{name}") for name in ("depth", "datum_diameter", "evaluation_reference")
    )
    shape = draft.text(relief, "shape_of_relief") or "linear"
    base = 2.0 * getattr(geometry, f"base_radius_{gear_name}")
    if depth is None or start is None or start.si <= base or shape not in ("linear", "parabolic"):
        draft.note(
            f"{relief.label} is left out: a depth, the diameter of its start above the base circle and a "
            "linear or parabolic shape are needed"
        )
        return
    start_roll = _roll_angle(start.si, base)
    end = end_of_flank(geometry, gear_name, kind)
    number = to_file(depth.si, "um")
    remark = ""
    if stated_at is not None and stated_at.si > base:
        stated_roll = _roll_angle(stated_at.si, base)
        # If both diameters are equal but for the 15 digits of the file, the depth is used unchanged.
        if (
            not math.isclose(stated_roll, end, rel_tol=1e-9)
            and (stated_roll - start_roll) * (end - start_roll) > 0.0
        ):
            carried = ((end - start_roll) / (stated_roll - start_roll)) ** (1 if shape == "linear" else 2)
            number = derived_number(depth.si * carried, "um")
            remark = f", carried from {kind}_evaluation_reference to the end of the flank"
    path = f"{gear_name}.{kind}"
    draft.put(f"{path}.shape", shape, draft.where(relief, "shape_of_relief"))
    draft.put(f"{path}.amount", number, depth.where + remark)
    draft.put(f"{path}.start_roll_angle", derived_number(start_roll, "deg"), f"{start.where}, as roll angle")


def end_of_flank(g: Geometry, gear_name: str, kind: str) -> float:
    """Return the roll angle [rad] at which a relief has its full amount: at tip or start of the flank."""
    if gear_name == "pinion":
        return (g.L_XD if kind == "tip_relief" else g.L_XA) / g.base_radius_pinion
    return (g.L_XY - (g.L_XA if kind == "tip_relief" else g.L_XD)) / g.base_radius_gear


def _roll_angle(diameter: float, base: float) -> float:
    """Return the roll angle [rad] at a circle: the tangent of the pressure angle there."""
    return math.sqrt((diameter / base) ** 2 - 1.0)


def diameter_at(roll: float, base: float) -> float:
    """Return the diameter of the circle at a roll angle."""
    return base * math.hypot(1.0, roll)
