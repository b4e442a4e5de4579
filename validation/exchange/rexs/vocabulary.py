"""The part of the REXS vocabulary that spurcheck uses: attributes, their units and versions.

Each name was checked against the published REXS database of the versions that have it. It has one unit and
one value type in all components. Nothing outside this table is read or written.
"""

from __future__ import annotations

from lumped.errors import refuse, shown
from lumped.fields.units import to_si, to_stated

#: Versions whose published database was checked, oldest first.
VERSIONS = ("1.4", "1.5", "1.6", "1.7", "2.0.0")
#: Versions that can be written. The XML form of 2.0.0 (with or without a namespace) could not be settled.
WRITTEN = VERSIONS[:-1]
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
    "tip_corner_radius_factor_reference_profile",
    ("floating_point", "mm"): "center_distance minimum_normal_backlash maximum_normal_backlash normal_module "
    "face_width tip_diameter root_diameter inner_diameter addendum_modification tip_relief_depth "
    "root_relief_depth tip_relief_datum_diameter tip_relief_evaluation_reference root_relief_datum_diameter "
    "root_relief_evaluation_reference",
    ("floating_point", "mum"): "arithmetic_average_roughness_flank averaged_peak_to_valley_height_flank "
    "arithmetic_mean_roughness_flank_iso_4287_1997 mean_peak_to_valley_roughness_flank_iso_4287_1997",
    ("floating_point", "deg"): "helix_angle_reference_diameter normal_pressure_angle",
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


def si_from_rexs(value: float, unit: str, expected: str, where: str) -> float:
    """Convert a number of a file to SI; refuse a unit that is unknown or of another dimension.

    ``unit`` is that of the file, "" for that of the database, ``expected``; ``where`` is for the message.
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
    """Write an SI number that was computed from numbers of fifteen digits: twelve, in the field's unit."""
    return float(f"{to_stated(si, stated):.12g}")
