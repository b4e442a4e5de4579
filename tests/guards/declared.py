"""Ranges of the numbers of a parameter file, each with its reason; and the guards that they are."""

from __future__ import annotations

import copy
import operator
import re
from collections.abc import Callable, Iterator
from typing import Any, get_args, get_origin

from lumped import GearPair, ParameterError, load_gear_pair
from lumped.fields.refusals import models_in
from lumped.fields.units import Quantity
from lumped.schema.bearings import ROLLING
from tests.guards.guard import GEARS
from tests.unlike_pairs import unlike_pair

_LENGTH = "a length that exists"
_SIZE = "from what can be drawn to the largest gears and shafts that are made, with a decade of room"
_PART = "a share of a whole"
_NONE = "nothing may be negative of what can be absent"
_DAMPING = "a share of critical damping; nothing vibrates above 1, bearings may be strong dampers"
_ELASTIC = "from rubber to the stiffest that is known, diamond at 1050 GPa"
_POISSON = "isotropic bodies that do not grow thicker under tension; 0.5 is incompressible, and divides by 0"
_DENSE = "from foam to osmium at 22 590 kg/m^3"
_SPRING = "from a hair to rigid beside any tooth"
_TURN = "one turn"
_FLANK = "less than a millimetre: more is another flank"
_ROLL = "half a turn of the gear: further no flank reaches"
_DRIVES = "the pinion drives, in its positive sense"
_TORQUE = "from a watch to beyond any drive"

#: Field of a parameter file -> its range in the unit of the file, and why there.
DECLARED: dict[str, tuple[str, str]] = {
    "basic_rack.module": ("> 0 mm and <= 100 mm", _SIZE),
    "basic_rack.pressure_angle": (">= 10 deg and <= 35 deg", "racks in use have 14.5 to 28 degrees"),
    "basic_rack.addendum_coefficient": ("> 0 and <= 2", "ISO 53: 1; long teeth have up to 1.5"),
    "basic_rack.dedendum_coefficient": ("> 0 and <= 2.5", "ISO 53: 1.25; the mate's addendum and clearance"),
    "basic_rack.fillet_radius_coefficient": (">= 0 and <= 0.6", "ISO 53: 0.38; a full radius has 0.47"),
    "{gear}.face_width": (">= 0.01 mm and <= 2000 mm", _SIZE),
    "{gear}.tip_alteration": (
        ">= -100 mm and <= 100 mm",
        "beyond, it is no alteration of a gear of module 100 mm",
    ),
    "{gear}.profile_shift": (">= -1.5 and <= 2", "beyond, the tooth lies outside any blank"),
    "{gear}.addendum": ("> 0 mm", _LENGTH),
    "{gear}.tip_diameter": ("> 0 mm", _LENGTH),
    "{gear}.bore": (">= 0 mm", _NONE),
    "{gear}.mass": (">= 1e-09 kg and <= 1e+07 kg", _SIZE),
    "{gear}.inertia": (">= 1e-15 kg*m**2 and <= 1e+09 kg*m**2", _SIZE),
    "{gear}.density": (">= 10 kg/m**3 and <= 30000 kg/m**3", _DENSE),
    "{gear}.youngs_modulus": (">= 1e-06 GPa and <= 2000 GPa", _ELASTIC),
    "{gear}.poisson_ratio": (">= 0 and < 0.5", _POISSON),
    "{gear}.roughness": (">= 0 um and <= 50 um", "a rough casting"),
    "{gear}.tip_relief.amount": (">= 0 um and <= 1000 um", _FLANK),
    "{gear}.tip_relief.start_roll_angle": ("> 0 deg and <= 180 deg", _ROLL),
    "{gear}.tip_relief.start_diameter": ("> 0 mm", _LENGTH),
    "{gear}.tip_relief.length": ("> 0 mm", _LENGTH),
    "{gear}.root_relief.amount": (">= 0 um and <= 1000 um", _FLANK),
    "{gear}.root_relief.start_roll_angle": ("> 0 deg and <= 180 deg", _ROLL),
    "{gear}.root_relief.start_diameter": ("> 0 mm", _LENGTH),
    "{gear}.root_relief.length": ("> 0 mm", _LENGTH),
    "{gear}.mounting.eccentricity": (">= 0 um and <= 1000 um", _FLANK),
    "{gear}.mounting.phase": (">= 0 deg and <= 360 deg", _TURN),
    "{gear}.deviations.index": (">= -1000 um and <= 1000 um", _FLANK),
    "{gear}.deviations.profile_slope": (">= -1000 um and <= 1000 um", _FLANK),
    "{gear}.deviations.tip_relief": (">= -1000 um and <= 1000 um", _FLANK),
    "{gear}.faults.0.depth": ("> 0 mm and <= 100 mm", _SIZE),
    "{gear}.faults.0.angle": ("> 0 deg and <= 90 deg", "between the centre line and square to it"),
    "{gear}.faults.0.start_roll_angle": (">= 0 deg and <= 180 deg", _ROLL),
    "{gear}.faults.0.end_roll_angle": (">= 0 deg and <= 180 deg", _ROLL),
    "{gear}.faults.0.width": ("> 0 mm", _LENGTH),
    "{gear}.faults.0.pit_depth": (">= 0 um and <= 1000 um", _FLANK),
    "{gear}.faults.0.roll_angle": (">= 0 deg and <= 180 deg", _ROLL),
    "centre_distance": ("> 0 mm", _LENGTH),
    "bearings.{gear}.loa_stiffness": (">= 1e-06 N/m and <= 1e+30 N/m", _SPRING),
    "bearings.{gear}.oloa_stiffness": (">= 1e-06 N/m and <= 1e+30 N/m", _SPRING),
    "bearings.{gear}.size": (">= 0.01 mm and <= 1000 mm", _SIZE),
    "bearings.{gear}.contact_angle": (
        ">= 0 deg and <= 60 deg",
        "radial and angular contact bearings; thrust bearings hold no gear",
    ),
    "bearings.{gear}.stiffness_factor": (">= 0.001 and <= 1000", "more is another bearing"),
    "bearings.{gear}.loa_damping_ratio": (">= 0 and <= 2", _DAMPING),
    "bearings.{gear}.oloa_damping_ratio": (">= 0 and <= 2", _DAMPING),
    "shafts.damping_ratio": (">= 0 and <= 1", _DAMPING),
    "shafts.max_frequency": (">= 1 Hz and <= 1e+07 Hz", "from below any mode to above what beams describe"),
    "shafts.{gear}.segments.0.length": (">= 0.01 mm and <= 20000 mm", _SIZE),
    "shafts.{gear}.segments.0.diameter": (">= 0.1 mm and <= 5000 mm", _SIZE),
    "shafts.{gear}.segments.0.bore": (">= 0 mm", _NONE),
    "shafts.{gear}.gear_position": (">= 0 mm and <= 100000 mm", _SIZE),
    "shafts.{gear}.bearings.0.position": (">= 0 mm and <= 100000 mm", _SIZE),
    "shafts.{gear}.bearings.0.loa_stiffness": (">= 1e-06 N/m and <= 1e+13 N/m", _SPRING),
    "shafts.{gear}.bearings.0.oloa_stiffness": (">= 1e-06 N/m and <= 1e+13 N/m", _SPRING),
    "shafts.{gear}.bearings.0.loa_damping": (">= 0 N*s/m and <= 1e+15 N*s/m", _NONE),
    "shafts.{gear}.bearings.0.oloa_damping": (">= 0 N*s/m and <= 1e+15 N*s/m", _NONE),
    "shafts.{gear}.bearings.0.tilt_stiffness": (">= 0 N*m/rad and <= 1e+12 N*m/rad", _NONE),
    "shafts.{gear}.youngs_modulus": (">= 0.001 GPa and <= 2000 GPa", _ELASTIC),
    "shafts.{gear}.poisson_ratio": (">= 0 and < 0.5", _POISSON),
    "shafts.{gear}.density": (">= 10 kg/m**3 and <= 30000 kg/m**3", _DENSE),
    **{f"shafts.{end}.position": (">= 0 mm and <= 100000 mm", _SIZE) for end in ("motor", "load")},
    **{
        f"shafts.{end}.inertia": (">= 1e-12 kg*m**2 and <= 1e+09 kg*m**2", _SIZE) for end in ("motor", "load")
    },
    **{
        f"shafts.{end}.coupling_stiffness": (">= 1e-06 N*m/rad and <= 1e+12 N*m/rad", _SPRING)
        for end in ("motor", "load")
    },
    **{
        f"shafts.{end}.coupling_damping": (">= 0 N*m*s/rad and <= 1e+12 N*m*s/rad", _NONE)
        for end in ("motor", "load")
    },
    "mesh.stiffness.pair_stiffness": (">= 1e-06 N/m and <= 1e+12 N/m", _SPRING),
    "mesh.stiffness.peak": (">= 1e-06 N/m and <= 1e+12 N/m", _SPRING),
    "mesh.stiffness.end_ratio": ("> 0 and <= 1", _PART),
    "mesh.stiffness.ramp_length": (">= 0 mm", _NONE),
    "mesh.stiffness_factor": (">= 0.1 and <= 10", "a decade either way: more is another stiffness"),
    "mesh.damping_ratio": (">= 0 and <= 1", _DAMPING),
    "mesh.backlash": (">= 0 mm", _NONE),
    "lubricant.viscosity": (">= 1e-09 mPa*s and <= 100000 mPa*s", "from a gas to grease"),
    "lubricant.viscosity_law.viscosity_index": (
        ">= 0 and <= 400",
        "ASTM D2270: 0 and more; best oils near 400",
    ),
    "lubricant.viscosity_law.kinematic_viscosity_40": (
        ">= 2 mm**2/s and <= 20000 mm**2/s",
        "Walther's law with the constant 0.7 holds from 2 mm^2/s on (ASTM D341)",
    ),
    "lubricant.viscosity_law.kinematic_viscosity_100": (
        ">= 1 mm**2/s and <= 2000 mm**2/s",
        "the thinnest of 40 degC at 100 degC",
    ),
    "lubricant.viscosity_law.density": (">= 500 kg/m**3 and <= 1500 kg/m**3", "of liquids without metal"),
    "lubricant.viscosity_law.temperature": (">= -40 degC and <= 200 degC", "between pour and flash point"),
    "lubricant.pressure_viscosity_k": ("> 0", "oil thickens under pressure"),
    "lubricant.pressure_viscosity_s": (">= 0 and <= 1", "AGMA 925-A03: 0.1 to 0.2; not above proportional"),
    "friction.coefficient": (">= 0 and <= 1", "friction of teeth never exceeds the normal load"),
    "friction.sharpness": ("> 0 1/mm", "at 0 there is no law"),
    "friction.maximum": ("> 0 and <= 1", "friction of teeth never exceeds the normal load"),
    "friction.composite_roughness": ("> 0 um", "the film parameter divides by it"),
    "friction.film_length": ("> 0 mm", _LENGTH),
    "friction.table.speed": ("> 0 rpm", _DRIVES),
    "friction.table.unit_load": ("> 0 N/mm", "without load there is no coefficient"),
    "operating.pinion_speed": ("> 0 rpm and <= 200000 rpm", _DRIVES),
    "operating.pinion_torque": (">= 1e-09 N*m and <= 1e+09 N*m", _TORQUE),
    "operating.pinion_power": ("> 0 kW and <= 1e+10 kW", "beyond any drive"),
    "operating.brake_torque": ("> 0 N*m and <= 1e+09 N*m or 'balanced'", _TORQUE),
    "operating.speed_range": ("> 0 rpm and <= 200000 rpm", _DRIVES),
    "operating.torque_ripple.0.amplitude": (">= 0 N*m and <= 1e+09 N*m", _TORQUE),
    "operating.torque_ripple.0.phase": (">= 0 deg and <= 360 deg", _TURN),
}

#: The same for whole numbers.
WHOLE: dict[str, tuple[int, int, str]] = {
    "{gear}.teeth": (5, 1000, "with fewer no rack leaves an involute in contact"),
    "{gear}.deviations.tolerance_class": (1, 11, "ISO 1328-1:2013"),
    "{gear}.deviations.seed": (0, 2**53, "whole numbers that a float holds, as TOML readers may take it"),
    "{gear}.faults.0.tooth": (1, 1000, "teeth are counted from 1"),
    "bearings.{gear}.number": (4, 200, "fewer do not centre a ring; slewing rings have hundreds"),
    "bearings.{gear}.bearings": (1, 12, "as many as a shaft may have"),
    "operating.torque_ripple.0.order": (1, 1000, "periods a turn"),
    "mesh.first_teeth": (1, 1000, "teeth are counted from 1"),
}

_FAULTS = (
    {"kind": "crack", "tooth": 1, "depth": 0.1, "angle": 70},
    {"kind": "spall", "tooth": 1, "start_roll_angle": 18, "end_roll_angle": 22, "width": 2, "pit_depth": 9},
    {"kind": "chip", "tooth": 1, "roll_angle": 27},
)
_MODELS = {"pair_stiffness": "rectangular", "peak": "parabolic", "end_ratio": "parabolic"}
_BOUND = re.compile(r"(>=|<=|>|<) ([-+.\de]+)")
_HOLDS = {">": operator.gt, ">=": operator.ge, "<": operator.lt, "<=": operator.le}


def with_field(pair: GearPair, path: str, value: object) -> dict[str, Any]:
    """Data of the pair on shafts with a field set, in a section that is made where it has none."""
    data: Any = copy.deepcopy(pair.to_mapping())
    *parents, leaf = path.split(".")
    section = parents[-1] if parents else ""
    if section in ("tip_relief", "root_relief"):
        start = {} if leaf in ("start_diameter", "length") else {"start_roll_angle": 24.0}
        data[parents[0]][section] = {"amount": 23.0, **start}
    elif section == "mounting":
        data[parents[0]][section] = {}
    elif section == "deviations":
        data[parents[0]][section] = {} if leaf != "seed" else {"tolerance_class": 6}
    elif parents[1:2] == ["faults"]:
        data[parents[0]]["faults"] = [dict(next(one for one in _FAULTS if leaf in one))]
    elif section == "viscosity_law":
        grade = {"kinematic_viscosity_40": 32.0, "kinematic_viscosity_100": 5.4}
        if leaf == "viscosity_index":
            grade = {"iso_vg": 100}
        data["lubricant"] = {"viscosity_law": grade | {"temperature": 60.0}}
    elif section == "stiffness":
        data["mesh"]["stiffness"] = {"model": _MODELS.get(leaf, "energy")}
    elif parents[:1] == ["bearings"] and leaf in ROLLING:
        data["bearings"][section] = {"type": "ball", "number": 9, "size": 7.9}
    elif section == "table":
        data["friction"]["table"] = {"points": [1, 2, 3, 4], "coefficient": [0.05] * 4}
    elif parents[1:2] == ["torque_ripple"]:
        data["operating"]["torque_ripple"] = [{"shaft": "pinion", "order": 1, "amplitude": 1.0}]
    if leaf == "pinion_power":
        del data["operating"]["pinion_torque"]
    if leaf in ("tooth", "first_teeth"):
        data["pinion"]["teeth"] = data["gear"]["teeth"] = 1000  # so that the gear has the tooth
    node = data
    for part in parents:
        node = node[int(part) if isinstance(node, list) else part]
    if leaf == "speed_range":
        value = [value, 2e5] if value < 1e5 else [1e3, value]  # type: ignore[operator]
    elif leaf == "first_teeth":
        value = [value, value]
    elif section == "deviations" and leaf not in ("tolerance_class", "seed"):
        value = [0.0] * (data[parents[0]]["teeth"] - 1) + [value]
    node[leaf] = value
    return data


def refused(path: str, value: object) -> list[str]:
    """Ranges and values that are refused of a field with this value."""
    try:
        load_gear_pair(with_field(unlike_pair("contact_ratio_2_3_on_shafts"), path, value))
    except ParameterError as error:
        return [problem.allowed for problem in error.problems if problem.field == path]
    return []


def numbers(path: str, text: str) -> Iterator[str]:
    """Complaints about a field: a value at, just inside or just outside a bound that is judged otherwise."""
    for sign, bound in _BOUND.findall(text):
        limit = float(bound)
        # Differences of a part in 1e9; about 0 the least that a unit factor of 1e-9 leaves a number.
        step = 1e-9 * abs(limit) or 1e-250
        for value in (limit - step, limit, limit + step):
            found = [allowed for allowed in refused(path, value) if text in allowed]
            if bool(found) == _HOLDS[sign](value, limit):
                yield f"{path} = {value!r}: {'refused' if found else 'taken'}, allowed {text}"


def whole_numbers(path: str, low: int, high: int) -> Iterator[str]:
    """Complaints about a field of a whole number."""
    for value in (low - 1, low, high, high + 1):
        found = refused(path, value)
        if bool(found) == (low <= value <= high):
            yield f"{path} = {value}: {'refused' if found else 'taken'}, allowed {low} to {high}"


def complaints() -> dict[str, Callable[[], list[str]]]:
    """Field of a parameter file -> its complaints about values around each of its limits."""
    every: dict[str, Callable[[], list[str]]] = {}
    for pattern, (text, _) in DECLARED.items():
        for path in {pattern.format(gear=gear): None for gear in GEARS}:
            every[path] = lambda path=path, text=text: list(numbers(path, text))
    for pattern, (low, high, _) in WHOLE.items():
        for path in {pattern.format(gear=gear): None for gear in GEARS}:
            every[path] = lambda path=path, low=low, high=high: list(whole_numbers(path, low, high))
    return every


def fields(model: Any = GearPair, prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Every field of the schema with a number, through unions and lists, with its description."""
    for name, info in model.model_fields.items():
        is_quantity = any(isinstance(one, Quantity) for one in info.metadata)
        bounded = "Ge(" in repr(info.metadata) or "Ge(" in repr(info.annotation)
        if is_quantity or bounded:
            yield f"{prefix}{name}", info
        entry = "0." if get_origin(info.annotation) is tuple and get_args(info.annotation) else ""
        for inner in models_in(info.annotation):
            yield from fields(inner, f"{prefix}{name}.{entry}")
