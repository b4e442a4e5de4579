"""The part of the REXS vocabulary that spurcheck uses: component types, attributes, units, by version.

Each line was checked against the published REXS database of the versions it names. Nothing outside this table
is read or written, apart from attributes named ``custom_...``, which REXS leaves to each program.
"""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal
from typing import Literal

from lumped.errors import refuse, shown
from lumped.fields.units import to_si, to_stated

Kind = Literal[
    "floating_point", "integer", "boolean", "enum", "string", "reference_component", "floating_point_array"
]

#: Versions whose published database was checked, oldest first.
VERSIONS = ("1.4", "1.5", "1.6", "1.7", "2.0.0")
#: Versions that can be written. The XML form of 2.0.0 (with or without a namespace) could not be settled.
WRITTEN = ("1.4", "1.5", "1.6", "1.7")

#: REXS unit -> (unit of ``lumped.fields.units``, the same as text for it, how many of it make one stated
#: unit).
UNITS: dict[str, tuple[str, str, Decimal]] = {
    "none": ("1", "", Decimal(1)),
    "": ("1", "", Decimal(1)),
    "mm": ("mm", "mm", Decimal(1)),
    "mum": ("um", "um", Decimal(1)),
    "deg": ("deg", "deg", Decimal(1)),
    "°": ("deg", "deg", Decimal(1)),
    "rad": ("deg", "rad", Decimal("0.0174532925199432957692")),
    "1 / min": ("rpm", "rpm", Decimal(1)),
    "N m": ("N*m", "N*m", Decimal(1)),
    "N / m": ("N/m", "N/m", Decimal(1)),
    "N mm / rad": ("N*m/rad", "N*mm/rad", Decimal("1e3")),
    "kg": ("kg", "kg", Decimal(1)),
    "kg / dm^3": ("kg/m**3", "kg/dm**3", Decimal("1e-3")),
    "N / mm^2": ("GPa", "N/mm**2", Decimal("1e3")),
    "MPa": ("GPa", "MPa", Decimal("1e3")),
    "mm^2 / s": ("mm**2/s", "mm**2/s", Decimal(1)),
    "C": ("degC", "degC", Decimal(1)),
}


@dataclass(frozen=True)
class Known:
    """One attribute of one component type.

    Attributes
    ----------
    unit : REXS unit
    kind : REXS value type
    since, until : first and last version that has it
    """

    unit: str = "none"
    kind: Kind = "floating_point"
    since: str = "1.4"
    until: str = "2.0.0"

    def of(self, version: str) -> bool:
        """Whether a version has the attribute."""
        return VERSIONS.index(self.since) <= VERSIONS.index(version) <= VERSIONS.index(self.until)


_MM, _DEG, _SPEED, _TORQUE = Known("mm"), Known("deg"), Known("1 / min"), Known("N m")
_FLAG, _COUNT = Known(kind="boolean"), Known(kind="integer")
_PLACE = {
    "reference_component_for_position": Known(kind="reference_component"),
    "support_vector": Known("mm", "floating_point_array"),
    "u_axis_vector": Known("mm", "floating_point_array"),
    "w_axis_vector": Known("mm", "floating_point_array"),
}
_BEARING = {
    "u_coordinate_on_shaft_inner_side": _MM,
    "u_coordinate_on_shaft_outer_side": _MM,
    "radial_stiffness": Known("N / m"),
    "bending_stiffness": Known("N mm / rad"),
}
#: Component type -> attribute id -> what the database says about it.
ATTRIBUTES: dict[str, dict[str, Known]] = {
    "gear_unit": {"number_of_gears": _COUNT, "gear_shift_index": _COUNT, **_PLACE},
    "gear_casing": {"temperature_lubricant": Known("C"), "operating_viscosity": Known("mm^2 / s")},
    "cylindrical_stage": {
        "center_distance": _MM,
        "minimum_normal_backlash": _MM,
        "maximum_normal_backlash": _MM,
        "normal_base_pitch": _MM,
        "radial_contact_ratio": Known(),
        "overlap_contact_ratio": Known(),
        "gear_ratio": Known(),
        "sum_of_addendum_modification_coefficients": Known(),
        "temperature_lubricant": Known("C"),
        "operating_viscosity": Known("mm^2 / s"),
    },
    "cylindrical_gear": {
        "number_of_teeth": _COUNT,
        "normal_module": _MM,
        "helix_angle_reference_diameter": _DEG,
        "face_width": _MM,
        "u_coordinate_on_shaft": _MM,
        "tip_diameter": _MM,
        "root_diameter": _MM,
        "inner_diameter": _MM,
        "reference_circle_diameter": Known("mm", until="1.7"),
        "base_circle_diameter": Known("mm", until="1.7"),
        "reference_diameter_cylindrical_gear": Known("mm", since="2.0.0"),
        "base_diameter": Known("mm", since="2.0.0"),
        "mass_of_component": Known("kg"),
        "arithmetic_average_roughness_flank": Known("mum", until="1.7"),
        "averaged_peak_to_valley_height_flank": Known("mum", until="1.7"),
        "arithmetic_mean_roughness_flank_iso_4287_1997": Known("mum", since="2.0.0"),
        "mean_peak_to_valley_roughness_flank_iso_4287_1997": Known("mum", since="2.0.0"),
        "rotational_speed": _SPEED,
        **_PLACE,
    },
    "cylindrical_gear_flank": {
        "normal_pressure_angle": _DEG,
        "addendum_modification_coefficient": Known(),
        "addendum_modification": _MM,
        "addendum_coefficient_basic_profile": Known(),
    },
    "cylindrical_stage_gear_data": {
        "is_driving_gear": _FLAG,
        "loaded_tooth_flank": Known(kind="enum"),
        "torque": _TORQUE,
        "pitch_diameter": _MM,
        "operating_pressure_angle_in_the_transverse_section": _DEG,
    },
    "shaft": {"rotational_speed": _SPEED, "defines_speed": _FLAG, **_PLACE},
    "shaft_section": {
        "u_coordinate_on_shaft": _MM,
        "length": _MM,
        "outer_diameter_begin": _MM,
        "outer_diameter_end": _MM,
        "inner_diameter_begin": _MM,
        "inner_diameter_end": _MM,
    },
    "concept_bearing": _BEARING,
    "rolling_bearing_with_catalog_geometry": _BEARING,
    "rolling_bearing_with_detailed_geometry": _BEARING,
    "external_load": {
        "torque_around_u_axis": _TORQUE,
        "power": Known("kW"),
        "transmits_torque": _FLAG,
        "defines_torque": _FLAG,
    },
    "lubricant": {
        "viscosity_at_40_degree_celsius": Known("mm^2 / s"),
        "viscosity_at_100_degree_celsius": Known("mm^2 / s"),
        "density_at_15_degree_celsius": Known("kg / dm^3"),
    },
    "material": {
        "elastic_modulus": Known("N / mm^2"),  # the database of 2.0.0 calls the same unit MPa
        "poisson_ratio": Known(),
        "density": Known("kg / dm^3"),
    },
    "tip_relief": {
        "shape_of_relief": Known(kind="enum"),
        "tip_relief_depth": _MM,
        "tip_relief_datum_diameter": _MM,
        "tip_relief_evaluation_reference": _MM,
    },
    "root_relief": {
        "shape_of_relief": Known(kind="enum"),
        "root_relief_depth": _MM,
        "root_relief_datum_diameter": _MM,
        "root_relief_evaluation_reference": _MM,
    },
    "rack_shaped_tool": {
        "normal_module": _MM,
        "normal_pressure_angle": _DEG,
        "addendum_coefficient_reference_profile": Known(),
        "tip_radius_factor": Known(until="1.7"),
        "tip_corner_radius_factor_reference_profile": Known(since="2.0.0"),
    },
    "cylindrical_gear_manufacturing_settings": {},
}

#: Flank modifications that spurcheck has no place for.
NOT_TAKEN = (
    "end_relief_datum_face",
    "end_relief_non_datum_face",
    "helix_crowning",
    "helix_deviation",
    "helix_slope",
    "profile_crowning",
    "profile_deviation",
    "profile_slope",
    "profile_twist",
    "topographical_modification",
    "triangular_root_relief",
    "triangular_tip_relief",
)


def si_from_rexs(value: float, unit: str, expected: str, where: str) -> float:
    """Convert a number of a REXS file to SI.

    Parameters
    ----------
    value : number in the file
    unit : unit in the file; where it is left out, the unit that the database fixes
    expected : unit of the database
    where : component and attribute, for the message

    Raises
    ------
    ParameterError : a unit that is unknown or of another dimension
    """
    stated, _, _ = UNITS[expected]
    _, text, _ = UNITS.get(unit or expected, ("", None, Decimal(1)))
    if text is not None:
        try:
            return to_si(f"{value!r} {text}" if text else value, stated)
        except ValueError:
            pass
    raise refuse(where, f"{value!r} {shown(unit)}", f"a number in {expected}", "Export the file again.")


def derived_number(si: float, stated: str) -> float:
    """Write an SI number that was computed from printed ones: twelve digits in the field's unit.

    The inputs have fifteen digits at most; more than twelve of the result would show rounding.
    """
    return float(f"{to_stated(si, stated):.12g}")


def rexs_from_si(si: float, unit: str) -> float:
    """Convert an SI number to a REXS unit."""
    stated, _, factor = UNITS[unit]
    return float(Decimal(repr(to_stated(si, stated))) * factor)
