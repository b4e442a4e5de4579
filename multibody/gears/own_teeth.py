"""What makes single teeth of a gear differ: errors, eccentricity and faults; further ripples of the torques.

Formulas of this package read everything from the schema, from one starting point: the angle at which each
flank is drawn on the gear. ``lumped.schema.tooth_errors`` starts from errors along the line of action
instead, so a wrong sign, phase or number in one of the two shows as a difference of the models. Only the
deviations that a random seed draws out of a tolerance class, and the root section of a crack, come from
``lumped``.

Sources: docs/theory/multibody.md, "Teeth that differ, from the drawn flank".
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from lumped.errors import refuse
from lumped.faults.base import ToothFault
from lumped.faults.chip import Chip
from lumped.faults.crack import Crack, root_section
from lumped.faults.spall import Spall
from lumped.schema.gear import Gear
from lumped.schema.pair import GearPair
from lumped.schema.teeth import Deviations
from lumped.schema.tolerances import drawn_index
from lumped.typing import FloatArray
from multibody.gears.circles import Circles, base_tooth_angle

#: Direction in which the teeth of a gear are counted: +1 counter-clockwise, -1 clockwise. Teeth are counted
#: in the order in which they come into mesh, so against the rotation: the pinion turns clockwise.
COUNT_DIRECTION = {"pinion": 1.0, "gear": -1.0}


@dataclass(frozen=True)
class DrawnGear:
    """One gear as it is drawn, SI.

    Attributes
    ----------
    name : "pinion" or "gear"
    number : 0 for the pinion, 1 for the gear
    section : the gear's section of the parameter file
    reference_radius, base_radius : radii of the reference circle and of the base circle
    tip : length on the base tangent at which the flank ends at the tip
    start : length on the base tangent at which contact on this flank is nearest to the base circle
    to_pitch_point : distance along the path of contact from A to the pitch point
    """

    name: str
    number: int
    section: Gear
    reference_radius: float
    base_radius: float
    tip: float
    start: float
    to_pitch_point: float


@dataclass(frozen=True, eq=False)
class GearTeeth:
    """The teeth of one gear in the order of mesh, from tooth 1 on, SI.

    Attributes
    ----------
    gap : (z,) material that is missing on each flank, along the line of action
    rise : (z,) slope of the missing material over the length on the base tangent, zero at the pitch point
    relief : (z,) tip relief beyond the relief of the design
    eccentricity : distance of the base circle's centre from the axis
    angle : the gap by the eccentricity is eccentricity * cos(rotation since t = 0 + angle)
    first : tooth at A at t = 0, counted from 0
    """

    gap: FloatArray
    rise: FloatArray
    relief: FloatArray
    eccentricity: float
    angle: float
    first: int


class OwnRipple(NamedTuple):
    """A harmonic of the torque of one shaft: amplitude * cos(order * rotation since t = 0 + phase).

    gear : 0: the ripple acts on the pinion's shaft, and the rotation is the pinion's; 1: on the gear's shaft
    order : periods in a turn
    amplitude : [N m]
    phase : [rad]
    """

    gear: int
    order: int
    amplitude: float
    phase: float


class OwnFault(NamedTuple):
    """A fault of one tooth. Lengths are on the base tangent of the gear that has the fault [m].

    gear, tooth : 0 pinion or 1 gear; tooth counted from 0
    crack : compliance of the crack over the square of the arm of the load [1/(N m)]
    root : place of the root section on the tooth's centre line [m]
    half_tooth : half the angle of the tooth on the base circle [rad]
    spall_start, spall_end : both ends of a spall
    spall : compliance that the spall adds between its ends [m/N]
    pit : depth of a spall over the whole face width
    flank_end : where the flank ends
    """

    gear: int
    tooth: int
    crack: float
    root: float
    half_tooth: float
    spall_start: float
    spall_end: float
    spall: float
    pit: float
    flank_end: float


def drawn_gears(pair: GearPair, drawn: Circles) -> tuple[DrawnGear, DrawnGear]:
    """Both gears with the lengths for the errors of the teeth."""
    module = pair.basic_rack.module
    share = drawn.base_pinion / (drawn.base_pinion + drawn.base_gear)
    to_pitch_point = share * drawn.tangent - drawn.start
    pinion = DrawnGear(
        name="pinion",
        number=0,
        section=pair.pinion,
        reference_radius=0.5 * module * pair.pinion.teeth,
        base_radius=drawn.base_pinion,
        tip=drawn.reach_pinion,
        start=drawn.start,
        to_pitch_point=to_pitch_point,
    )
    gear = DrawnGear(
        name="gear",
        number=1,
        section=pair.gear,
        reference_radius=0.5 * module * pair.gear.teeth,
        base_radius=drawn.base_gear,
        tip=drawn.reach_gear,
        start=drawn.tangent - drawn.end,
        to_pitch_point=to_pitch_point,
    )
    return pinion, gear


def gear_teeth(pair: GearPair, gear: DrawnGear) -> GearTeeth:
    """The teeth of one gear."""
    deviations = gear.section.deviations
    gap = gap_of_drawn_flanks(gear, index_deviations(pair, gear))
    eccentricity, angle = mounted_eccentricity(gear)
    if deviations is not None and deviations.first_order == "eccentricity":
        cosine, sine = first_harmonic(gap)
        gap = gap - harmonic_at_teeth(cosine, sine, gap.size)
        eccentricity, angle = turning_eccentricity(gear, cosine, sine)
    first = first_tooth(pair, gear)
    rotated = rotation_since_first_tooth(pair, gear)
    return GearTeeth(
        gap=gap,
        rise=rise_of_slopes(gear, in_order_of_mesh(deviations, "profile_slope", gear.section.teeth)),
        relief=in_order_of_mesh(deviations, "tip_relief", gear.section.teeth),
        eccentricity=eccentricity,
        angle=angle + rotated,
        first=first,
    )


def first_tooth(pair: GearPair, gear: DrawnGear) -> int:
    """Tooth of the pair that is at A at t = 0, counted from 0."""
    return 0 if pair.mesh.first_teeth is None else pair.mesh.first_teeth[gear.number] - 1


def rotation_since_first_tooth(pair: GearPair, gear: DrawnGear) -> float:
    """Angle that the gear has turned at t = 0 since tooth 1 was at A [rad]."""
    return first_tooth(pair, gear) * 2.0 * math.pi / gear.section.teeth


def in_order_of_mesh(deviations: Deviations | None, field: str, teeth: int) -> FloatArray:
    """Sort a list with one value for each tooth into the order in which the teeth come into mesh.

    Tooth 1 is tooth 1 in both numberings. Where the file numbers against the order, tooth j
    of the file comes into mesh j - 1 places before tooth 1.
    """
    values = None if deviations is None else getattr(deviations, field)
    ordered = np.zeros(teeth)
    if values is None:
        return ordered
    assert deviations is not None
    direction = -1 if deviations.counted == "against" else 1
    for number, value in enumerate(values):
        ordered[direction * number % teeth] = value
    return ordered


def index_deviations(pair: GearPair, gear: DrawnGear) -> FloatArray:
    """Displacement of each flank along the reference circle, in the direction of the count of mesh [m]."""
    deviations = gear.section.deviations
    teeth = gear.section.teeth
    if deviations is not None and deviations.tolerance_class is not None:
        return drawn_index(teeth, pair.basic_rack.module, deviations.tolerance_class, deviations.seed)
    displacement = in_order_of_mesh(deviations, "index", teeth)
    if deviations is not None and deviations.counted == "against":
        return -displacement  # positive is further along the numbers of the file
    return displacement


def gap_of_drawn_flanks(gear: DrawnGear, displacement: FloatArray) -> FloatArray:
    """Gap along the line of action by displacements of the flanks along the reference circle [m].

    A displacement draws the flank of the tooth at an angle that is larger, counter-clockwise, by
    direction of the count * displacement / reference radius. The overlap of two flanks is
    -r_bp chi_p - r_bg (chi_g - pi) - L_XY, chi the angles of both flanks: a flank that is drawn further
    counter-clockwise, of either gear, leaves a gap of its base radius times that angle.
    """
    counter_clockwise = COUNT_DIRECTION[gear.name] * displacement / gear.reference_radius
    return np.asarray(gear.base_radius * counter_clockwise)


def rise_of_slopes(gear: DrawnGear, slope_deviations: FloatArray) -> FloatArray:
    """Slope of the gap over the length on the base tangent [-].

    A positive profile slope deviation is material at the tip: from the start of contact to the tip the flank
    gains the deviation, and the gap falls by it.
    """
    return np.asarray(-slope_deviations / (gear.tip - gear.start))


def first_harmonic(gap: FloatArray) -> tuple[float, float]:
    """Coefficients a, b of the harmonic a cos(tau) + b sin(tau), tau = 2 pi n/z at tooth n [m].

    The harmonic is the least squares fit to the list.
    """
    tau = 2.0 * math.pi * np.arange(gap.size) / gap.size
    return 2.0 * float(gap @ np.cos(tau)) / gap.size, 2.0 * float(gap @ np.sin(tau)) / gap.size


def harmonic_at_teeth(cosine: float, sine: float, teeth: int) -> FloatArray:
    """The first harmonic at each tooth [m]."""
    tau = 2.0 * math.pi * np.arange(teeth) / teeth
    return np.asarray(cosine * np.cos(tau) + sine * np.sin(tau))


def turning_eccentricity(gear: DrawnGear, cosine: float, sine: float) -> tuple[float, float]:
    """Eccentricity [m] and its angle when tooth 1 is at A [rad] that the first harmonic of a list stands for.

    Tooth n is measured where it touches at the pitch point. The gear turns by sigma = to_pitch_point/r_b
    from the place where tooth 1 is at A to the place where tooth 1 is at the pitch point, and from there by
    tau = 2 pi n/z until tooth n is at the pitch point. So for every tau
    eccentricity * cos(tau + sigma + angle) = a cos(tau) + b sin(tau), which is
    eccentricity * cos(sigma + angle) = a and eccentricity * sin(sigma + angle) = -b.
    """
    sigma = gear.to_pitch_point / gear.base_radius
    return math.hypot(cosine, sine), math.atan2(-sine, cosine) - sigma


def mounted_eccentricity(gear: DrawnGear) -> tuple[float, float]:
    """Eccentricity [m] and its angle when tooth 1 is at A [rad] of the section ``mounting``."""
    mounting = gear.section.mounting
    return (0.0, 0.0) if mounting is None else (float(mounting.eccentricity), float(mounting.phase))


def own_ripples(pair: GearPair, gears: Sequence[DrawnGear]) -> list[OwnRipple]:
    """Ripples of both torques. Each ripple counts the rotation of its shaft, from tooth 1 at A on."""
    ripples = []
    for entry in pair.operating.torque_ripple:
        gear = gears[0] if entry.shaft == "pinion" else gears[1]
        phase = entry.phase + entry.order * rotation_since_first_tooth(pair, gear)
        ripples.append(OwnRipple(gear.number, entry.order, float(entry.amplitude), float(phase)))
    return ripples


def own_faults(pair: GearPair, gears: Sequence[DrawnGear]) -> list[OwnFault]:
    """Faults of the teeth of both gears."""
    return [own_fault(pair, gear, fault) for gear in gears for fault in gear.section.faults]


def own_fault(pair: GearPair, gear: DrawnGear, fault: ToothFault) -> OwnFault:
    """One fault. ``lumped.faults`` supplies the root section of a crack, but not the arm of the load."""
    sound = OwnFault(
        gear=gear.number,
        tooth=fault.tooth - 1,
        crack=0.0,
        root=0.0,
        half_tooth=0.0,
        spall_start=0.0,
        spall_end=0.0,
        spall=0.0,
        pit=0.0,
        flank_end=gear.tip,
    )
    if isinstance(fault, Crack):
        centre, half = root_section(pair.wheels[gear.number].tooth)
        return sound._replace(
            crack=crack_compliance(fault, gear.section.youngs_modulus, face_width(pair), half),
            root=centre,
            half_tooth=0.5 * base_tooth_angle(pair, gear.number, gear.base_radius),
        )
    if isinstance(fault, Spall):
        start, end = fault_places(gear, fault)
        spall = sound._replace(spall_start=start, spall_end=end)
        width = face_width(pair)
        if fault.width is None or fault.width >= width:
            return spall._replace(pit=float(fault.pit_depth))
        return spall._replace(spall=hertz_compliance(pair) * (width / (width - fault.width) - 1.0))
    if isinstance(fault, Chip):
        return sound._replace(flank_end=min(gear.tip, fault.roll_angle * gear.base_radius))
    raise refuse("faults", fault.kind, "crack, spall, chip in the multibody model", "Leave it out.")


def fault_places(gear: DrawnGear, fault: ToothFault) -> tuple[float, ...]:
    """Lengths on the base tangent at which a fault makes the stiffness or the gap jump [m]."""
    if isinstance(fault, Spall):
        return fault.start_roll_angle * gear.base_radius, fault.end_roll_angle * gear.base_radius
    return ()


def crack_compliance(fault: Crack, modulus: float, width: float, half: float) -> float:
    """Rotation of a strip with an edge crack by a moment [1/(N m)]; ``half`` is half its thickness [m]."""
    x = fault.depth * math.sin(fault.angle) / (2.0 * half)
    strip = x**2 / (1.0 - x) ** 2 * (5.93 - 19.69 * x + 37.14 * x**2 - 35.84 * x**3 + 13.12 * x**4)
    return float(6.0 * strip / (modulus * width * half**2))


def face_width(pair: GearPair) -> float:
    """Face width in contact, that of the narrower gear [m]."""
    return float(min(pair.pinion.face_width, pair.gear.face_width))


def hertz_compliance(pair: GearPair) -> float:
    """Linear compliance of the contact over the whole face width, 4/(pi E' b) [m/N]."""
    yielding = sum((1.0 - gear.poisson_ratio**2) / gear.youngs_modulus for gear in (pair.pinion, pair.gear))
    return float(2.0 * yielding / (math.pi * face_width(pair)))
