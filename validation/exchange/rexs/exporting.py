"""A gear pair as a REXS model of a gear unit with one cylindrical stage."""

from __future__ import annotations

from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import Any

from lumped.arguments import file_path, one_of
from lumped.lubrication.viscosity import grade_viscosity
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from validation.exchange.rexs.encodings import FORMS, encoded
from validation.exchange.rexs.gears import RELIEFS, diameter_at, end_of_flank
from validation.exchange.rexs.model import ATTRIBUTES, KINDS, WRITTEN, Document, rexs_from_si
from validation.files.output import check_file, whole_file


def write_rexs(pair: AnyPair, path: str | Path, version: str = WRITTEN[-1], *, force: bool = False) -> Path:
    """Write a gear pair as a REXS file. Numbers have the fifteen digits that REXS allows.

    REXS has no attributes for bearings as springs along and off the line of action, damping, friction law,
    stiffness model, dynamic viscosity alone, and inertia of a gear. These values and shafts are not written.

    Parameters
    ----------
    pair : a validated gear pair
    path : file to write; .rexs (XML) or .rexsj (JSON)
    version : version of REXS, "1.4" to "1.7"
    force : overwrite an existing file

    Returns
    -------
    Path of the file

    Raises
    ------
    ParameterError : an unknown suffix or version, or an existing file without ``force``
    """
    pair = load_gear_pair(pair)
    path = file_path("path", path)
    check_file(path, tuple(FORMS), force=force)
    document = rexs_document(pair, one_of("version", version, WRITTEN))
    with whole_file(path, new=not force) as temporary:
        temporary.write_bytes(encoded(document, FORMS[path.suffix.lower()]))
    return path


class _Builder:
    """Components and relations of a model under construction. The ids are 1, 2, ..."""

    def __init__(self) -> None:
        self.components: list[dict[str, Any]] = []
        self.relations: list[dict[str, Any]] = []

    def add(self, kind: str, name: str = "", /, **values: object) -> int:
        """Add a component and return the id. Numbers are in SI. An attribute that is None is left out."""
        attributes = []
        for key, value in values.items():
            if value is not None:
                number = rexs_from_si(value, ATTRIBUTES[key]) if isinstance(value, float) else value
                attributes.append({"id": key, "unit": ATTRIBUTES[key], KINDS[key]: number})
        number = len(self.components) + 1
        self.components.append({"id": number, "type": kind, "name": name, "attributes": attributes})
        return number

    def relate(self, kind: str, order: int | None = None, **roles: int) -> None:
        """Add a relation. ``roles``: role -> id of the component."""
        refs = [{"id": i, "role": role, "hint": self.components[i - 1]["type"]} for role, i in roles.items()]
        numbered = {} if order is None else {"order": order}
        self.relations.append({"id": len(self.relations) + 1, "type": kind, **numbered, "refs": refs})


def rexs_document(pair: GearPair, version: str = WRITTEN[-1]) -> Document:
    """Build the REXS tree of a pair."""
    g = pair.geometry
    build = _Builder()
    unit = build.add("gear_unit", pair.name, number_of_gears=1, gear_shift_index=1, **_place(1, 0.0))
    backlash = dict.fromkeys(("minimum_normal_backlash", "maximum_normal_backlash"), g.normal_backlash)
    stage = build.add("cylindrical_stage", pair.name, center_distance=g.centre_distance, **backlash)
    build.relate("assembly", assembly=unit, part=stage)
    gears = [_add_gear(build, pair, unit, gear_name) for gear_name in ("pinion", "gear")]
    build.relate("stage", stage=stage, gear_1=gears[0], gear_2=gears[1])
    for gear, drives in zip(gears, (True, False), strict=True):
        data = build.add("cylindrical_stage_gear_data", is_driving_gear=drives)
        build.relate("stage_gear_data", stage=stage, gear=gear, stage_gear_data=data)
    _add_lubricant(build, pair, unit, stage)
    head = {
        "version": version,
        "applicationId": "spurcheck",
        "applicationVersion": metadata.version("spurcheck"),
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
    }
    return {"model": {**head, "relations": build.relations, "components": build.components}}


def _place(reference: int, offset: float) -> dict[str, object]:
    """Return the attributes of a position. All shafts are parallel to the u axis of the gear unit.

    ``reference``: id of the component to which the position refers. ``offset``: distance from the pinion [m].
    """
    return {
        "reference_component_for_position": reference,
        "support_vector": [0.0, rexs_from_si(offset, "mm"), 0.0],
        "u_axis_vector": [1.0, 0.0, 0.0],
        "w_axis_vector": [0.0, 0.0, 1.0],
    }


def _add_gear(build: _Builder, pair: GearPair, unit: int, gear_name: str) -> int:
    """Add a gear with shaft, load, material and flanks. Returns the id of the gear."""
    g = pair.geometry
    gear = getattr(pair, gear_name)
    is_driving = gear_name == "pinion"
    brake = pair.operating.brake_torque
    torque = pair.operating.pinion_torque if is_driving else brake if isinstance(brake, float) else None
    speed = g.omega_pinion if is_driving else -g.omega_gear
    place = _place(unit, 0.0 if is_driving else g.centre_distance)
    shaft = build.add(
        "shaft", f"{gear_name} shaft", **place, rotational_speed=speed, defines_speed=is_driving
    )
    build.relate("assembly", assembly=unit, part=shaft)
    gear_id = build.add(
        "cylindrical_gear",
        gear_name,
        number_of_teeth=gear.teeth,
        normal_module=pair.basic_rack.module,
        helix_angle_reference_diameter=0.0,
        face_width=gear.face_width,
        tip_diameter=2.0 * getattr(g, f"tip_radius_{gear_name}"),
        root_diameter=2.0 * getattr(g, f"root_radius_{gear_name}"),
        inner_diameter=gear.bore,
        mass_of_component=gear.mass,
        arithmetic_average_roughness_flank=gear.roughness,
        **place,
    )
    build.relate("assembly", assembly=shaft, part=gear_id)
    flags = {"transmits_torque": True, "defines_torque": torque is not None}
    load = build.add(
        "external_load", "drive" if is_driving else "brake", torque_around_u_axis=torque, **flags
    )
    build.relate("assembly", assembly=shaft, part=load)
    steel = {"elastic_modulus": gear.youngs_modulus, "poisson_ratio": gear.poisson_ratio}
    material = build.add("material", f"material of the {gear_name}", **steel, density=gear.density)
    build.relate("reference", origin=gear_id, referenced=material)
    _add_flanks(build, pair, gear_name, gear_id)
    return gear_id


def _add_flanks(build: _Builder, pair: GearPair, gear_name: str, gear_id: int) -> None:
    """Add two equal flanks with reliefs, and the rack-shaped tool of each flank."""
    rack = pair.basic_rack
    g = pair.geometry
    gear = getattr(pair, gear_name)
    flank_attributes = {
        "normal_pressure_angle": rack.pressure_angle,
        "addendum_modification_coefficient": float(pair.profile_shifts[0 if gear_name == "pinion" else 1]),
        "addendum_coefficient_basic_profile": rack.addendum_coefficient,
    }
    tool_attributes = {
        "normal_module": rack.module,
        "normal_pressure_angle": rack.pressure_angle,
        "addendum_coefficient_reference_profile": rack.dedendum_coefficient,
        "tip_radius_factor": rack.fillet_radius_coefficient or None,
    }
    sides = ("left", "right")
    flanks = {
        s: build.add("cylindrical_gear_flank", f"{gear_name}, {s} flank", **flank_attributes) for s in sides
    }
    build.relate("flank", gear=gear_id, **flanks)
    base = 2.0 * getattr(g, f"base_radius_{gear_name}")
    for flank in flanks.values():
        tool = build.add("rack_shaped_tool", **tool_attributes)
        settings = build.add("cylindrical_gear_manufacturing_settings")
        build.relate("manufacturing_step", 1, workpiece=flank, tool=tool, manufacturing_settings=settings)
        for kind in RELIEFS:
            if (relief := getattr(gear, kind)) is not None:
                values = {
                    "shape_of_relief": relief.shape,
                    f"{kind}_depth": relief.amount,
                    f"{kind}_datum_diameter": diameter_at(relief.start_roll_angle, base),
                    f"{kind}_evaluation_reference": diameter_at(end_of_flank(g, gear_name, kind), base),
                }
                build.relate("reference", origin=flank, referenced=build.add(kind, **values))


def _add_lubricant(build: _Builder, pair: GearPair, unit: int, stage: int) -> None:
    """Add the oil if kinematic viscosities are known. A dynamic viscosity alone has no attribute in REXS."""
    law = pair.lubricant.viscosity_law
    if law is None:
        return
    name = ""
    v40 = law.kinematic_viscosity_40
    v100 = law.kinematic_viscosity_100
    if law.iso_vg is not None:
        name = f"ISO VG {law.iso_vg}"
        index = law.viscosity_index
        v40, v100 = (1e-6 * float(grade_viscosity(law.iso_vg, celsius, index)) for celsius in (40.0, 100.0))
    casing = build.add("gear_casing", "casing", temperature_lubricant=law.temperature)
    build.relate("assembly", assembly=unit, part=casing)
    viscosities = {"viscosity_at_40_degree_celsius": v40, "viscosity_at_100_degree_celsius": v100}
    oil = build.add("lubricant", name, **viscosities, density_at_15_degree_celsius=law.density)
    build.relate("reference", origin=stage, referenced=oil)
