"""A REXS model: components with attributes, and relations between them.

Both encodings are read as one tree: the JSON document of the specification, as nested mappings and lists.
``model_of`` checks a tree and returns the records for the import. Each name of the vocabulary was checked
against the published REXS databases. Each name has one unit and one value type in all components. Names
outside of the vocabulary are neither read nor written.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from lumped.errors import ParameterError, refuse, shown
from lumped.fields.units import to_si, to_stated

#: The JSON document of REXS: a mapping with the one key "model".
Document = dict[str, Any]
#: Keys of an attribute whose value is one number, text or flag.
_SCALARS = (
    "floating_point", "integer", "boolean", "enum", "string", "reference_component", "file_reference",
    "date_time",
)  # fmt: skip
#: Versions whose published database was checked, oldest first.
VERSIONS = ("1.0", "1.1", "1.2", "1.3", "1.4", "1.5", "1.6", "1.7", "2.0.0")
#: Versions that can be written. The XML form of 2.0.0 (with or without a namespace) could not be settled.
WRITTEN = ("1.4", "1.5", "1.6", "1.7")
#: Types of components: from 1.3 on, and up to 1.2, of the same attributes.
FLANKS = ("cylindrical_gear_flank", "flank_geometry")
GEAR_DATA = ("cylindrical_stage_gear_data", "stage_gear_data")
#: REXS unit -> (unit of ``lumped.fields.units``, the REXS unit as text for it).
UNITS = {
    "none": ("1", ""), "": ("1", ""), "mm": ("mm", "mm"), "mum": ("um", "um"), "deg": ("deg", "deg"),
    "°": ("deg", "deg"), "rad": ("deg", "rad"), "1 / min": ("rpm", "rpm"), "N m": ("N*m", "N*m"),
    "kg": ("kg", "kg"), "kg / dm^3": ("kg/m**3", "kg/dm**3"), "N / mm^2": ("GPa", "N/mm**2"),
    "MPa": ("GPa", "MPa"), "mm^2 / s": ("mm**2/s", "mm**2/s"), "C": ("degC", "degC"),
}  # fmt: skip
#: (REXS value type, REXS unit) -> attributes.
_NAMES = {
    ("integer", "none"): "number_of_gears gear_shift_index number_of_teeth",
    ("reference_component", "none"): "reference_component_for_position",
    ("boolean", "none"): "is_driving_gear defines_speed defines_torque transmits_torque",
    ("enum", "none"): "loaded_tooth_flank shape_of_relief",
    ("floating_point_array", "mm"): "support_vector u_axis_vector w_axis_vector",
    ("floating_point", "none"): "addendum_modification_coefficient addendum_coefficient_basic_profile "
    "poisson_ratio addendum_coefficient_reference_profile tip_radius_factor "
    "tip_corner_radius_factor_reference_profile sum_of_addendum_modification_coefficients",
    ("floating_point", "mm"): "center_distance minimum_normal_backlash maximum_normal_backlash normal_module "
    "face_width tip_diameter root_diameter inner_diameter addendum_modification tip_relief_depth "
    "root_relief_depth tip_relief_datum_diameter tip_relief_evaluation_reference root_relief_datum_diameter "
    "root_relief_evaluation_reference transverse_module addendum_basic_profile minimum_tip_diameter "
    "maximum_tip_diameter addendum_reference_profile tip_radius tooth_tip_chamfer",
    ("floating_point", "mum"): "arithmetic_average_roughness_flank averaged_peak_to_valley_height_flank "
    "arithmetic_mean_roughness_flank_iso_4287_1997 mean_peak_to_valley_roughness_flank_iso_4287_1997",
    ("floating_point", "deg"): "helix_angle_reference_diameter normal_pressure_angle "
    "pressure_angle_in_the_transverse_section",
    ("floating_point", "1 / min"): "rotational_speed",
    ("floating_point", "N m"): "torque torque_around_u_axis",
    ("floating_point", "kW"): "power",
    ("floating_point", "N / mm^2"): "elastic_modulus",  # the database of 2.0.0 calls the same unit MPa
    ("floating_point", "kg"): "mass_of_component",
    ("floating_point", "kg / dm^3"): "density density_at_15_degree_celsius",
    ("floating_point", "C"): "temperature_lubricant",
    ("floating_point", "mm^2 / s"): "operating_viscosity viscosity_at_40_degree_celsius "
    "viscosity_at_100_degree_celsius",
}
#: Attribute -> its unit and its value type in the database.
ATTRIBUTES = {name: unit for (_, unit), names in _NAMES.items() for name in names.split()}
KINDS = {name: kind for (kind, _), names in _NAMES.items() for name in names.split()}
#: Flank modifications that spurcheck has no place for.
NOT_TAKEN = (
    "end_relief_datum_face", "end_relief_non_datum_face", "helix_crowning", "helix_deviation", "helix_slope",
    "profile_crowning", "profile_deviation", "profile_slope", "profile_twist", "topographical_modification",
    "triangular_root_relief", "triangular_tip_relief",
)  # fmt: skip


class Attribute(NamedTuple):
    """One attribute of a component.

    Attributes
    ----------
    value : value as in the file; None for a table
    unit : unit as in the file; "" if the file states no unit
    """

    value: str | int | float | bool | None
    unit: str = ""


@dataclass(frozen=True)
class Component:
    """One component: a machine element or a part of a machine element."""

    id: int
    type: str
    name: str = ""
    attributes: dict[str, Attribute] = field(default_factory=dict)

    @property
    def label(self) -> str:
        """Name of the component in messages and sources."""
        return f"{self.type} {self.id}"


@dataclass(frozen=True)
class RexsModel:
    """A REXS model.

    Attributes
    ----------
    file : name of the file, for sources
    version, application : as the file says
    components : by id, in the order of the file
    relations : (type, ((role, id of a component), ...)), in the order of the file
    load_cases : (id, components with the attributes that hold in it), of the load spectrum
    """

    file: str
    version: str
    application: str
    components: dict[int, Component]
    relations: tuple[tuple[str, tuple[tuple[str, int], ...]], ...]
    load_cases: tuple[tuple[int, tuple[Component, ...]], ...] = ()

    def of_type(self, *types: str) -> list[Component]:
        """Return all components of the types, in the order of the file."""
        return [c for c in self.components.values() if c.type in types]

    def related(
        self, component: Component, kind: str, own_role: str, role: str, *types: str
    ) -> list[Component]:
        """Return the components with the role ``role`` in relations in which ``component`` has ``own_role``.

        ``kind``: type of the relations. ``types``: types of the components; none: all types.
        """
        partners = [
            self.components[number]
            for relation, refs in self.relations
            if relation == kind and (own_role, component.id) in refs
            for name, number in refs
            if name == role
        ]
        return [c for c in partners if not types or c.type in types]

    def referenced(self, component: Component, *types: str) -> list[Component]:
        """Return the components of the types to which ``component`` refers."""
        return self.related(component, "reference", "origin", "referenced", *types)

    def flanks(self, gear: Component) -> dict[str, Component]:
        """Return "left" and "right" -> flank of a cylindrical gear, without flanks that the file lacks."""
        return {
            side: flank
            for side in ("left", "right")
            for flank in self.related(gear, "flank", "gear", side, *FLANKS)
        }

    def gear_data(self, stage: Component, gear: Component) -> list[Component]:
        """Return the components with the data of a gear in a stage."""
        kind = "stage_gear_data"
        of_stage = self.related(stage, kind, "stage", kind, *GEAR_DATA)
        return [data for data in self.related(gear, kind, "gear", kind) if data in of_stage]

    def tools(self, gear: Component) -> list[Component]:
        """Return the rack-shaped tools of a gear: tools of the flanks (from REXS 1.3), tools of the gear."""
        step = ("manufacturing_step", "workpiece", "tool", "rack_shaped_tool")
        of_flanks = [tool for flank in self.flanks(gear).values() for tool in self.related(flank, *step)]
        of_gear = self.related(gear, "ordered_reference", "origin", "referenced", "rack_shaped_tool")
        return of_flanks + of_gear

    def neighbours(self, component: Component, *types: str) -> list[Component]:
        """Return the components of the types that share a relation with ``component``, each once."""
        shared = [refs for _, refs in self.relations if any(member == component.id for _, member in refs)]
        numbers = dict.fromkeys(number for refs in shared for _, number in refs)
        return [self.components[i] for i in numbers if self.components[i].type in types]


def model_of(document: Document, file: str) -> RexsModel:
    """Return the model of a tree. A tree with wrong form, ids or references is refused."""
    try:
        model = document["model"]
        components = [_component(c) for c in model["components"]]
        relations = [
            (_text(r.get("type")), tuple((_text(ref.get("role")), _id(ref["id"])) for ref in r["refs"]))
            for r in model["relations"]
        ]
        spectra = model.get("load_spectrum") or []
        spectra = spectra if isinstance(spectra, list) else [spectra]
        cases = [case for spectrum in spectra for case in spectrum.get("load_cases") or ()]
        load_cases = [(_id(c["id"]), tuple(map(_component, c["components"]))) for c in cases]
        head = {key: value for key, value in model.items() if isinstance(value, str)}
    except KeyError as error:
        raise broken(file, f"it has no {error} where REXS has one") from None
    except (ValueError, TypeError, AttributeError) as error:
        raise broken(file, f"it is not of the form of REXS: {str(error)[:120]}") from None
    table: dict[int, Component] = {}
    for component in components:
        if table.setdefault(component.id, component) is not component:
            raise broken(file, f"two components have the id {component.id}")
    of_relations = [number for _, refs in relations for _, number in refs]
    for number in [*of_relations, *(c.id for _, case in load_cases for c in case)]:
        if number not in table:
            raise broken(file, f"component {number} is referred to but does not exist")
    version, *program = (head.get(key, "") for key in ("version", "applicationId", "applicationVersion"))
    return RexsModel(file, version, " ".join(program).strip(), table, tuple(relations), tuple(load_cases))


def _component(node: dict[str, Any]) -> Component:
    attributes = {_text(a["id"]): _attribute(a) for a in node.get("attributes") or ()}
    return Component(_id(node["id"]), _text(node.get("type")), _text(node.get("name")), attributes)


def _attribute(node: dict[str, Any]) -> Attribute:
    value = next((node[key] for key in _SCALARS if key in node), None)
    if value is not None and not isinstance(value, (str, int, float, bool)):
        raise ValueError(f"attribute {node['id']!r} has a value that is no scalar")
    return Attribute(value, _text(node.get("unit")))


def _id(value: object) -> int:
    """Return an id as a whole number. In XML an id is text."""
    text = str(value)
    if isinstance(value, (str, int)) and re.fullmatch(r"-?[0-9]{1,19}", text):
        return int(text)
    raise ValueError(f"an id is {text[:40]!r} instead of a whole number")


def _text(value: object) -> str:
    if value is not None and not isinstance(value, str):
        raise ValueError(f"{str(value)[:40]!r} stands where text belongs")
    return value or ""


def broken(file: str, reason: str) -> ParameterError:
    """Return the refusal of a file that is not a REXS model."""
    return refuse("REXS file", shown(file), "a REXS model", f"The file is refused: {reason}.")


def si_from_rexs(value: float, unit: str, expected: str, where: str) -> float:
    """Convert a number of a file to SI. A unit that is unknown or has another dimension is refused.

    Parameters
    ----------
    value : number in the file
    unit : unit in the file; "" stands for ``expected``
    expected : unit in the REXS database
    where : place in the file, for the message
    """
    if expected == "kW":  # power has no unit among the parameters
        return 1e3 * value
    _, text = UNITS.get(unit or expected, ("", None))
    try:
        if text is not None:
            return to_si(f"{value!r} {text}" if text else value, UNITS[expected][0])
    except ValueError:
        pass
    raise refuse(where, f"{value!r} {shown(unit)}", f"a number in {expected}", "Export the file again.")


def rexs_from_si(si: float, unit: str) -> float:
    """Convert an SI number to a REXS unit, with the fifteen digits that REXS allows."""
    stated, text = UNITS[unit]
    one = to_stated(to_si(f"1 {text}" if text else 1.0, stated), stated)
    return float(f"{to_stated(si, stated) / one:.15g}")


def derived_number(si: float, stated: str) -> float:
    """Convert a computed SI number to the unit ``stated``, rounded to twelve digits.

    The number was computed from numbers of fifteen digits, so that the last digits are rounding.
    """
    return float(f"{to_stated(si, stated):.12g}")
