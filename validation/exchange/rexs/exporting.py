"""A gear pair as a REXS model of a gear unit with one cylindrical stage."""

from __future__ import annotations

from dataclasses import dataclass, field
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import Any

from lumped.arguments import file_path, one_of
from lumped.lubrication.viscosity import grade_viscosity
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from validation.exchange.rexs.encodings import encoded, form_of
from validation.exchange.rexs.gears import RELIEFS, diameter_at, end_of_flank
from validation.exchange.rexs.model import Document
from validation.exchange.rexs.vocabulary import ATTRIBUTES, KINDS, WRITTEN, rexs_from_si
from validation.files.output import check_file, whole_file


def write_rexs(pair: AnyPair, path: str | Path, version: str = WRITTEN[-1], *, force: bool = False) -> Path:
    """Write what REXS has attributes for of a gear pair, with the fifteen digits that it allows.

    REXS has no place for bearings as springs along and off the line of action, damping, the friction law, the
    stiffness model, a bare dynamic viscosity and the inertia of a gear; shafts are not written.

    Parameters
    ----------
    pair : a validated gear pair
    path : file to write; .rexs, .rexs.xml (XML), .rexsj, .rexs.json (JSON)
    version : of REXS, "1.4" to "1.7"
    force : overwrite an existing file

    Returns
    -------
    Path that was written, whole or not at all

    Raises
    ------
    ParameterError : an unknown suffix or version, or an existing file without ``force``
    """
    pair, path = load_gear_pair(pair), file_path("path", path)
    form = form_of(path)
    check_file(path, (path.suffix.lower(),), force=force)
    document = rexs_document(pair, one_of("version", version, WRITTEN))
    with whole_file(path, new=not force) as temporary:
        temporary.write_bytes(encoded(document, form))
    return path


@dataclass
class _Builder:
    """Components and relations under construction; ids count up."""

    components: list[dict[str, Any]] = field(default_factory=list)
    relations: list[dict[str, Any]] = field(default_factory=list)

    def add(self, kind: str, name: str = "", **values: object) -> int:
        """Add a component; numbers are SI, None is left out."""
        attributes = []
        for key, value in values.items():
            if value is not None:
                unit, kind_of_value = ATTRIBUTES[key], KINDS.get(key, "floating_point")
                number = rexs_from_si(value, unit) if isinstance(value, float) else value
                attributes.append({"id": key, "unit": unit, kind_of_value: number})
        number = len(self.components) + 1
        self.components.append({"id": number, "type": kind, "name": name, "attributes": attributes})
        return number

    def relate(self, kind: str, order: int | None = None, **roles: int) -> None:
        """Add a relation: role=component."""
        refs = [{"id": i, "role": role, "hint": self.components[i - 1]["type"]} for role, i in roles.items()]
        numbered = {} if order is None else {"order": order}
        self.relations.append({"id": len(self.relations) + 1, "type": kind, **numbered, "refs": refs})


def rexs_document(pair: GearPair, version: str = WRITTEN[-1]) -> Document:
    """Build the REXS tree of a pair."""
    g = pair.geometry
    build = _Builder()
    unit = build.add("gear_unit", pair.name, number_of_gears=1, gear_shift_index=1, **_place(1, 0.0))
    stage = build.add(
        "cylindrical_stage",
        pair.name,
        center_distance=g.centre_distance,
        minimum_normal_backlash=g.normal_backlash,
        maximum_normal_backlash=g.normal_backlash,
    )
    build.relate("assembly", assembly=unit, part=stage)
    gears = [_add_gear(build, pair, unit, which) for which in ("pinion", "gear")]
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
    """Position in the gear unit: shafts are parallel to its u axis, the gear's beside the pinion's."""
    return {
        "reference_component_for_position": reference,
        "support_vector": [0.0, rexs_from_si(offset, "mm"), 0.0],
        "u_axis_vector": [1.0, 0.0, 0.0],
        "w_axis_vector": [0.0, 0.0, 1.0],
    }


def _add_gear(build: _Builder, pair: GearPair, unit: int, which: str) -> int:
    g, driving = pair.geometry, which == "pinion"
    gear = pair.pinion if driving else pair.gear
    place = _place(unit, 0.0 if driving else g.centre_distance)
    speed = g.omega_pinion if driving else -g.omega_gear
    shaft = build.add("shaft", f"{which} shaft", **place, rotational_speed=speed, defines_speed=driving)
    build.relate("assembly", assembly=unit, part=shaft)
    number = build.add(
        "cylindrical_gear",
        which,
        number_of_teeth=gear.teeth,
        normal_module=pair.basic_rack.module,
        helix_angle_reference_diameter=0.0,
        face_width=gear.face_width,
        tip_diameter=2.0 * getattr(g, f"tip_radius_{which}"),
        root_diameter=2.0 * getattr(g, f"root_radius_{which}"),
        inner_diameter=gear.bore,
        mass_of_component=gear.mass,
        arithmetic_average_roughness_flank=gear.roughness,
        **place,
    )
    build.relate("assembly", assembly=shaft, part=number)
    brake = pair.operating.brake_torque
    torque = pair.operating.pinion_torque if driving else brake if isinstance(brake, float) else None
    load = build.add(
        "external_load",
        "drive" if driving else "brake",
        torque_around_u_axis=torque,
        transmits_torque=True,
        defines_torque=torque is not None,
    )
    build.relate("assembly", assembly=shaft, part=load)
    material = build.add(
        "material",
        f"material of the {which}",
        elastic_modulus=gear.youngs_modulus,
        poisson_ratio=gear.poisson_ratio,
        density=gear.density,
    )
    build.relate("reference", origin=number, referenced=material)
    _add_flanks(build, pair, which, number)
    return number


def _add_flanks(build: _Builder, pair: GearPair, which: str, number: int) -> None:
    """Add both flanks, alike, with their reliefs, and the tool whose tip makes the root."""
    rack, g, gear = pair.basic_rack, pair.geometry, getattr(pair, which)
    flanks = {
        side: build.add(
            "cylindrical_gear_flank",
            f"{which}, {side} flank",
            normal_pressure_angle=rack.pressure_angle,
            addendum_modification_coefficient=gear.profile_shift,
            addendum_coefficient_basic_profile=rack.addendum_coefficient,
        )
        for side in ("left", "right")
    }
    build.relate("flank", gear=number, **flanks)
    base = 2.0 * getattr(g, f"base_radius_{which}")
    for flank in flanks.values():
        tool = build.add(
            "rack_shaped_tool",
            normal_module=rack.module,
            normal_pressure_angle=rack.pressure_angle,
            addendum_coefficient_reference_profile=rack.dedendum_coefficient,
            tip_radius_factor=rack.fillet_radius_coefficient or None,
        )
        settings = build.add("cylindrical_gear_manufacturing_settings")
        build.relate("manufacturing_step", 1, workpiece=flank, tool=tool, manufacturing_settings=settings)
        for kind in RELIEFS:
            if (relief := getattr(gear, kind)) is not None:
                values = {
                    "shape_of_relief": relief.shape,
                    f"{kind}_depth": relief.amount,
                    f"{kind}_datum_diameter": diameter_at(relief.start_roll_angle, base),
                    f"{kind}_evaluation_reference": diameter_at(end_of_flank(g, which, kind), base),
                }
                build.relate("reference", origin=flank, referenced=build.add(kind, **values))


def _add_lubricant(build: _Builder, pair: GearPair, unit: int, stage: int) -> None:
    """Add the oil where its kinematic viscosities are known; a bare dynamic viscosity has no attribute."""
    law = pair.lubricant.viscosity_law
    if law is None:
        return
    v40, v100 = law.kinematic_viscosity_40, law.kinematic_viscosity_100
    if law.iso_vg is not None:
        grade, index = law.iso_vg, law.viscosity_index
        v40, v100 = (1e-6 * float(grade_viscosity(grade, celsius, index)) for celsius in (40.0, 100.0))
    casing = build.add("gear_casing", "casing", temperature_lubricant=law.temperature)
    build.relate("assembly", assembly=unit, part=casing)
    oil = build.add(
        "lubricant",
        "" if law.iso_vg is None else f"ISO VG {law.iso_vg}",
        viscosity_at_40_degree_celsius=v40,
        viscosity_at_100_degree_celsius=v100,
        density_at_15_degree_celsius=law.density,
    )
    build.relate("reference", origin=stage, referenced=oil)
