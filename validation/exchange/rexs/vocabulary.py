"""The part of the REXS vocabulary that spurcheck uses: component types, attributes, units, by version.

Each name was checked against the published REXS database of the versions that have it. Nothing outside this
table is read or written.
"""

from __future__ import annotations

from dataclasses import dataclass

from lumped.errors import refuse, shown
from lumped.fields.units import to_si, to_stated

#: Versions whose published database was checked, oldest first.
VERSIONS = ("1.4", "1.5", "1.6", "1.7", "2.0.0")
#: Versions that can be written. The XML form of 2.0.0 (with or without a namespace) could not be settled.
WRITTEN = VERSIONS[:-1]

BEARINGS = (
    "concept_bearing",
    "rolling_bearing_with_catalog_geometry",
    "rolling_bearing_with_detailed_geometry",
)
#: REXS unit -> (unit of ``lumped.fields.units``, the REXS unit as text for it).
UNITS = {
    "none": ("1", ""),
    "": ("1", ""),
    "mm": ("mm", "mm"),
    "mum": ("um", "um"),
    "deg": ("deg", "deg"),
    "°": ("deg", "deg"),
    "rad": ("deg", "rad"),
    "1 / min": ("rpm", "rpm"),
    "N m": ("N*m", "N*m"),
    "N / m": ("N/m", "N/m"),
    "N mm / rad": ("N*m/rad", "N*mm/rad"),
    "kg": ("kg", "kg"),
    "kg / dm^3": ("kg/m**3", "kg/dm**3"),
    "N / mm^2": ("GPa", "N/mm**2"),
    "MPa": ("GPa", "MPa"),
    "mm^2 / s": ("mm**2/s", "mm**2/s"),
    "C": ("degC", "degC"),
}

#: Value type -> names of attributes; all others are "floating_point".
_KINDS = {
    "integer": "number_of_gears gear_shift_index number_of_teeth",
    "reference_component": "reference_component_for_position",
    "floating_point_array": "support_vector u_axis_vector w_axis_vector",
    "boolean": "is_driving_gear defines_speed defines_torque transmits_torque",
    "enum": "loaded_tooth_flank shape_of_relief",
}
#: Names that ended with 1.7, and those that replaced them in 2.0.0.
_UNTIL_1_7 = (
    "reference_circle_diameter base_circle_diameter arithmetic_average_roughness_flank tip_radius_factor "
    "averaged_peak_to_valley_height_flank"
)
_SINCE_2 = (
    "reference_diameter_cylindrical_gear base_diameter arithmetic_mean_roughness_flank_iso_4287_1997 "
    "mean_peak_to_valley_roughness_flank_iso_4287_1997 tip_corner_radius_factor_reference_profile"
)
_PLACE = "support_vector u_axis_vector w_axis_vector"
#: Component types, with a comma between those that have the same; REXS unit; attributes.
_TABLE = (
    ("gear_unit", "none", "number_of_gears gear_shift_index reference_component_for_position"),
    ("gear_unit, cylindrical_gear, shaft", "mm", _PLACE),
    ("cylindrical_gear, shaft", "none", "reference_component_for_position"),
    ("cylindrical_gear, shaft", "1 / min", "rotational_speed"),
    ("gear_casing, cylindrical_stage", "C", "temperature_lubricant"),
    ("gear_casing, cylindrical_stage", "mm^2 / s", "operating_viscosity"),
    ("cylindrical_stage", "mm", "center_distance minimum_normal_backlash maximum_normal_backlash"),
    ("cylindrical_stage", "mm", "normal_base_pitch"),
    ("cylindrical_stage", "none", "radial_contact_ratio overlap_contact_ratio gear_ratio"),
    ("cylindrical_stage", "none", "sum_of_addendum_modification_coefficients"),
    ("cylindrical_gear", "none", "number_of_teeth"),
    ("cylindrical_gear", "deg", "helix_angle_reference_diameter"),
    ("cylindrical_gear", "mm", "normal_module face_width tip_diameter root_diameter inner_diameter"),
    ("cylindrical_gear", "mm", "reference_circle_diameter base_circle_diameter base_diameter"),
    ("cylindrical_gear", "mm", "reference_diameter_cylindrical_gear"),
    ("cylindrical_gear", "kg", "mass_of_component"),
    ("cylindrical_gear", "mum", "arithmetic_average_roughness_flank averaged_peak_to_valley_height_flank"),
    ("cylindrical_gear", "mum", "arithmetic_mean_roughness_flank_iso_4287_1997"),
    ("cylindrical_gear", "mum", "mean_peak_to_valley_roughness_flank_iso_4287_1997"),
    ("cylindrical_gear, shaft_section", "mm", "u_coordinate_on_shaft"),
    ("cylindrical_gear_flank", "deg", "normal_pressure_angle"),
    (
        "cylindrical_gear_flank",
        "none",
        "addendum_modification_coefficient addendum_coefficient_basic_profile",
    ),
    ("cylindrical_gear_flank", "mm", "addendum_modification"),
    ("cylindrical_stage_gear_data", "none", "is_driving_gear loaded_tooth_flank"),
    ("cylindrical_stage_gear_data", "N m", "torque"),
    ("cylindrical_stage_gear_data", "mm", "pitch_diameter"),
    ("cylindrical_stage_gear_data", "deg", "operating_pressure_angle_in_the_transverse_section"),
    ("shaft", "none", "defines_speed"),
    ("shaft_section", "mm", "length outer_diameter_begin outer_diameter_end"),
    ("shaft_section", "mm", "inner_diameter_begin inner_diameter_end"),
    (", ".join(BEARINGS), "mm", "u_coordinate_on_shaft_inner_side u_coordinate_on_shaft_outer_side"),
    (", ".join(BEARINGS), "N / m", "radial_stiffness"),
    (", ".join(BEARINGS), "N mm / rad", "bending_stiffness"),
    ("external_load", "N m", "torque_around_u_axis"),
    ("external_load", "kW", "power"),
    ("external_load", "none", "transmits_torque defines_torque"),
    ("lubricant", "mm^2 / s", "viscosity_at_40_degree_celsius viscosity_at_100_degree_celsius"),
    ("lubricant", "kg / dm^3", "density_at_15_degree_celsius"),
    ("material", "N / mm^2", "elastic_modulus"),  # the database of 2.0.0 calls the same unit MPa
    ("material", "none", "poisson_ratio"),
    ("material", "kg / dm^3", "density"),
    ("tip_relief, root_relief", "none", "shape_of_relief"),
    ("tip_relief", "mm", "tip_relief_depth tip_relief_datum_diameter tip_relief_evaluation_reference"),
    ("root_relief", "mm", "root_relief_depth root_relief_datum_diameter root_relief_evaluation_reference"),
    ("rack_shaped_tool", "mm", "normal_module"),
    ("rack_shaped_tool", "deg", "normal_pressure_angle"),
    ("rack_shaped_tool", "none", "addendum_coefficient_reference_profile tip_radius_factor"),
    ("rack_shaped_tool", "none", "tip_corner_radius_factor_reference_profile"),
    ("cylindrical_gear_manufacturing_settings", "none", ""),
)


@dataclass(frozen=True)
class Known:
    """One attribute of one component type: REXS unit, REXS value type, versions that have it."""

    unit: str
    kind: str
    versions: tuple[str, ...]


def _known(name: str, unit: str) -> Known:
    kind = next((kind for kind, names in _KINDS.items() if name in names.split()), "floating_point")
    old, new = name in _UNTIL_1_7.split(), name in _SINCE_2.split()
    return Known(unit, kind, WRITTEN if old else VERSIONS[-1:] if new else VERSIONS)


#: Component type -> attribute id -> what the database says about it.
ATTRIBUTES: dict[str, dict[str, Known]] = {}
for _types, _unit, _names in _TABLE:
    for _type in _types.split(", "):
        ATTRIBUTES.setdefault(_type, {}).update({name: _known(name, _unit) for name in _names.split()})

#: Flank modifications that spurcheck has no place for.
NOT_TAKEN = (
    "end_relief_datum_face", "end_relief_non_datum_face", "helix_crowning", "helix_deviation", "helix_slope",
    "profile_crowning", "profile_deviation", "profile_slope", "profile_twist", "topographical_modification",
    "triangular_root_relief", "triangular_tip_relief",
)  # fmt: skip


def si_from_rexs(value: float, unit: str, expected: str, where: str) -> float:
    """Convert a number of a REXS file to SI.

    Parameters
    ----------
    value, unit : as the file has them; without a unit that of the database holds
    expected : unit of the database
    where : component and attribute, for the message

    Raises
    ------
    ParameterError : a unit that is unknown or of another dimension
    """
    if expected == "kW":  # power has no unit among the parameters
        return 1e3 * value
    stated, _ = UNITS[expected]
    _, text = UNITS.get(unit or expected, ("", None))
    try:
        if text is not None:
            return to_si(f"{value!r} {text}" if text else value, stated)
    except ValueError:
        pass
    raise refuse(where, f"{value!r} {shown(unit)}", f"a number in {expected}", "Export the file again.")


def rexs_from_si(si: float, unit: str) -> float:
    """Convert an SI number to a REXS unit, with the fifteen digits that REXS allows."""
    stated, text = UNITS[unit]
    one = to_stated(to_si(f"1 {text}" if text else 1.0, stated), stated)
    return float(f"{to_stated(si, stated) / one:.15g}")


def derived_number(si: float, stated: str) -> float:
    """Write an SI number that was computed from printed ones: twelve digits in the field's unit.

    The inputs have fifteen digits at most; more than twelve of the result would show rounding.
    """
    return float(f"{to_stated(si, stated):.12g}")
