"""A gear pair as a REXS model of a gear unit with one cylindrical stage."""

from __future__ import annotations

from dataclasses import dataclass, field
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path

from lumped.arguments import file_path
from lumped.errors import refuse, shown
from lumped.gear_geometry.geometry import Geometry
from lumped.lubrication.viscosity import grade_viscosity
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.gear import Gear
from lumped.schema.pair import GearPair
from validation.exchange.rexs.container import form_of, zipped
from validation.exchange.rexs.json_form import to_json
from validation.exchange.rexs.model import Attribute, Component, Relation, RexsModel
from validation.exchange.rexs.record import ATTRIBUTE, record_text
from validation.exchange.rexs.relief import KINDS, diameter_at, end_of_flank
from validation.exchange.rexs.vocabulary import ATTRIBUTES, WRITTEN, rexs_from_si
from validation.exchange.rexs.xml_form import to_xml

LATEST = WRITTEN[-1]


def write_rexs(pair: AnyPair, path: str | Path, version: str = LATEST, *, record: bool = True) -> Path:
    """Write a gear pair as a REXS file.

    Standard attributes carry what REXS has attributes for, with the fifteen digits that it allows; whatever
    else spurcheck needs stands in the attribute ``custom_spurcheck_parameters`` of the stage, which other
    programs ignore.

    Parameters
    ----------
    pair : a validated gear pair
    path : file to write; .rexs, .rexs.xml (XML), .rexsj, .rexs.json (JSON), .rexsz, .rexs.zip (zipped XML)
    version : of REXS, "1.4" to "1.7"
    record : whether to write the attribute of spurcheck's own

    Returns
    -------
    Path that was written, whole or not at all

    Raises
    ------
    ParameterError : an unknown suffix or version
    """
    pair = load_gear_pair(pair)
    from validation.files.output import whole_file

    path = file_path("path", path)
    form = form_of(path)
    if version not in WRITTEN:
        raise refuse("version", shown(version), "one of " + ", ".join(WRITTEN), "Choose a version.")
    model = rexs_model(pair, version, record=record)
    head = {
        "version": version,
        "applicationId": "spurcheck",
        "applicationVersion": metadata.version("spurcheck"),
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
    }
    data = to_json(model, head) if form == "json" else to_xml(model, head)
    if form == "zip":
        data = zipped(data, f"{path.name.split('.')[0]}.rexs")
    with whole_file(path) as temporary:
        temporary.write_bytes(data)
    return path


@dataclass
class _Builder:
    """Components and relations under construction; ids count up."""

    version: str
    components: dict[int, Component] = field(default_factory=dict)
    relations: list[Relation] = field(default_factory=list)

    def add(self, kind: str, name: str, **values: object) -> int:
        """Add a component; numbers are SI, None is left out."""
        number = len(self.components) + 1
        attributes = {}
        for key, value in values.items():
            if value is None:
                continue
            known = ATTRIBUTES[kind][key]
            if not known.of(self.version):
                raise KeyError(f"{kind}/{key} is not in REXS {self.version}")
            if isinstance(value, float):
                value = _printed(value, known.unit)
            assert isinstance(value, (str, int, float, bool, tuple))
            attributes[key] = Attribute(value, known.unit)
        self.components[number] = Component(number, kind, name, attributes)
        return number

    def relate(self, kind: str, order: int | None = None, **roles: int) -> None:
        """Add a relation: role=component."""
        self.relations.append(Relation(kind, tuple(roles.items()), order))


def rexs_model(pair: GearPair, version: str = LATEST, *, record: bool = True, file: str = "") -> RexsModel:
    """Build the REXS model of a pair.

    Parameters
    ----------
    pair : a validated gear pair
    version : of REXS
    record : whether to add the attribute of spurcheck's own
    file : name of the file
    """
    g = pair.geometry
    build = _Builder(version)
    unit = build.add("gear_unit", pair.name, number_of_gears=1, gear_shift_index=1, **_place(1, 0.0))
    stage = build.add(
        "cylindrical_stage",
        pair.name,
        center_distance=g.centre_distance,
        minimum_normal_backlash=g.normal_backlash,
        maximum_normal_backlash=g.normal_backlash,
    )
    build.relate("assembly", assembly=unit, part=stage)
    if record:
        build.components[stage].attributes[ATTRIBUTE] = Attribute(record_text(pair), "none")
    gears = [_add_gear(build, pair, g, unit, which) for which in ("pinion", "gear")]
    build.relate("stage", stage=stage, gear_1=gears[0], gear_2=gears[1])
    for gear, drives in zip(gears, (True, False), strict=True):
        data = build.add("cylindrical_stage_gear_data", "", is_driving_gear=drives)
        build.relate("stage_gear_data", stage=stage, gear=gear, stage_gear_data=data)
    _add_lubricant(build, pair, unit, stage)
    application = f"spurcheck {metadata.version('spurcheck')}"
    return RexsModel(file, version, application, build.components, tuple(build.relations))


def _printed(si: float, unit: str) -> float:
    """An SI number in a REXS unit, with the fifteen digits that REXS allows, so that all forms agree."""
    return float(f"{rexs_from_si(si, unit):.15g}")


def _place(reference: int, offset: float) -> dict[str, object]:
    """Position in the gear unit: shafts are parallel to its u axis, the gear's beside the pinion's."""
    return {
        "reference_component_for_position": reference,
        "support_vector": (0.0, _printed(offset, "mm"), 0.0),
        "u_axis_vector": (1.0, 0.0, 0.0),
        "w_axis_vector": (0.0, 0.0, 1.0),
    }


def _add_gear(build: _Builder, pair: GearPair, g: Geometry, unit: int, which: str) -> int:
    driving = which == "pinion"
    gear = pair.pinion if driving else pair.gear
    place = _place(unit, 0.0 if driving else g.centre_distance)
    speed = g.omega_pinion if driving else -g.omega_gear
    shaft = build.add("shaft", f"{which} shaft", **place, rotational_speed=speed, defines_speed=driving)
    build.relate("assembly", assembly=unit, part=shaft)
    tip, root = (
        (g.tip_radius_pinion, g.root_radius_pinion) if driving else (g.tip_radius_gear, g.root_radius_gear)
    )
    number = build.add(
        "cylindrical_gear",
        which,
        number_of_teeth=gear.teeth,
        normal_module=pair.basic_rack.module,
        helix_angle_reference_diameter=0.0,
        face_width=gear.face_width,
        tip_diameter=2.0 * tip,
        root_diameter=2.0 * root,
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
    _add_flanks(build, pair, g, which, gear, number)
    return number


def _add_flanks(build: _Builder, pair: GearPair, g: Geometry, which: str, gear: Gear, number: int) -> None:
    """Add both flanks, alike, with their reliefs, and the tool whose tip makes the root."""
    rack = pair.basic_rack
    flanks = {}
    for side in ("left", "right"):
        flanks[side] = build.add(
            "cylindrical_gear_flank",
            f"{which}, {side} flank",
            normal_pressure_angle=rack.pressure_angle,
            addendum_modification_coefficient=gear.profile_shift,
            addendum_coefficient_basic_profile=rack.addendum_coefficient,
        )
    build.relate("flank", gear=number, left=flanks["left"], right=flanks["right"])
    for flank in flanks.values():
        tool = build.add(
            "rack_shaped_tool",
            "",
            normal_module=rack.module,
            normal_pressure_angle=rack.pressure_angle,
            addendum_coefficient_reference_profile=rack.dedendum_coefficient,
            tip_radius_factor=rack.fillet_radius_coefficient or None,
        )
        settings = build.add("cylindrical_gear_manufacturing_settings", "")
        build.relate("manufacturing_step", 1, workpiece=flank, tool=tool, manufacturing_settings=settings)
        for kind in KINDS:
            relief = gear.tip_relief if kind == "tip_relief" else gear.root_relief
            if relief is None:
                continue
            base = 2.0 * (g.base_radius_pinion if which == "pinion" else g.base_radius_gear)
            end = end_of_flank(g, which, kind)
            values: dict[str, object] = {
                "shape_of_relief": relief.shape,
                f"{kind}_depth": relief.amount,
                f"{kind}_datum_diameter": diameter_at(relief.start_roll_angle, base),
                f"{kind}_evaluation_reference": diameter_at(end, base),
            }
            modification = build.add(kind, "", **values)
            build.relate("reference", origin=flank, referenced=modification)


def _add_lubricant(build: _Builder, pair: GearPair, unit: int, stage: int) -> None:
    """Add the oil where its kinematic viscosities are known; a bare dynamic viscosity has no attribute."""
    law = pair.lubricant.viscosity_law
    if law is None:
        return
    v40, v100 = law.kinematic_viscosity_40, law.kinematic_viscosity_100
    if law.iso_vg is not None:
        v40, v100 = (
            1e-6 * float(grade_viscosity(law.iso_vg, celsius, law.viscosity_index))
            for celsius in (40.0, 100.0)
        )
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
