"""What single teeth, eccentric gears and ripples of the torques do to one state of the machine.

Sources: docs/theory/multibody.md, "Teeth that differ, from the drawn flank"; docs/theory/teeth.md, "In the
multibody model".
"""

from __future__ import annotations

import math
from typing import NamedTuple

from lumped.compiler import called
from lumped.typing import FloatArray
from multibody.contact.records import (
    COORDINATES,
    PHI_G,
    PHI_P,
    RATES,
    Record,
    Records,
    expanded,
    faults_of,
    machine_of,
    ripples_of,
    teeth_of,
    uncounted,
)

#: Row behind those of a state in ``set_base_circle_motion``: ways of the base circles' centres from the axes.
WAYS = 2


class TurnedArcs(NamedTuple):
    """Arcs by which the base circles have turned [m].

    pinion : distance from X of the pinion flank of the pair that was at A at t = 0
    gear : distance from Y of the gear flank of this pair; the distance falls with time
    """

    pinion: float
    gear: float


class OwnTeeth(NamedTuple):
    """Records of the teeth: TOOTH of each tooth of pinion and gear, and FAULT of all faults."""

    pinion: Records
    gear: Records
    faults: Records


class TeethOfPair(NamedTuple):
    """Numbers of the two teeth of a pair, from 0."""

    pinion: int
    gear: int


class OwnPair(NamedTuple):
    """What its two teeth make of a pair.

    error, rise : material missing on both flanks [m], and its slope along the path of contact
    compliance, compliance_slope : that faults add [m/N], and its slope along the path of contact [1/N]
    tip_p, tip_g : where the flanks end, distances from X and Y [m]
    relief_p, relief_g : tip relief beyond that of the design [m]
    """

    error: float
    rise: float
    compliance: float
    compliance_slope: float
    tip_p: float
    tip_g: float
    relief_p: float
    relief_g: float


class FaultEffect(NamedTuple):
    """What a fault adds at a place of a flank: compliance [m/N], slope of the compliance [1/N], gap [m]."""

    compliance: float
    compliance_slope: float
    gap: float


@called
def set_base_circle_motion(machine: Record, t: float, state: FloatArray, motion: FloatArray) -> None:
    """Write rows of (x, y, phi) of pinion and gear: state of the base circles' centres, rates, and ways.

    ``state`` has in its first rows the coordinates and the rates of the gears, whose axes stand in bearings.
    The ways lead from the axes to the centres.
    """
    for j in range(6):
        motion[COORDINATES, j] = state[COORDINATES, j]
        motion[RATES, j] = state[RATES, j]
    for gear in range(2):
        mounting = machine.mountings[gear]
        nominal = machine.rolling.omega_g if gear else machine.rolling.omega_p
        sense = 1.0 - 2.0 * gear  # the pinion turns clockwise
        x = 3 * gear
        y = x + 1
        phi = x + 2
        rotation = nominal * t - sense * state[COORDINATES, phi]
        rate = nominal - sense * state[RATES, phi]
        angle = rotation + mounting.angle
        along = -sense * mounting.eccentricity * math.cos(angle)
        off = mounting.eccentricity * math.sin(angle)
        motion[WAYS, x] = along
        motion[WAYS, y] = off
        motion[COORDINATES, x] += along
        motion[COORDINATES, y] += off
        motion[RATES, x] += sense * off * rate
        motion[RATES, y] -= sense * along * rate


@called
def moments_about_axes(ways: FloatArray, wrench: FloatArray) -> None:
    """Make the moments about the base circles' centres those about the axes, ``ways`` (6,) from the axes."""
    for x in (0, 3):
        wrench[x + 2] += ways[x] * wrench[x + 1] - ways[x + 1] * wrench[x]


@uncounted
def ripple_torques(packed: FloatArray, t: float, q: FloatArray) -> tuple[float, float]:
    """What the ripples add to the driving and to the braking torque [N m].

    q : (6,) coordinates, in the places of phi_p and phi_g the actual angles of the rotors of both torques
    """
    machine = machine_of(packed)[0]
    ripples = ripples_of(packed, machine.blocks.ripples)
    driving = 0.0
    braking = 0.0
    for i in range(ripples.size):
        ripple = ripples[i]
        if ripple.gear == 1:
            rotation = machine.rolling.omega_g * t + q[PHI_G]
            braking += ripple.amplitude * math.cos(ripple.order * rotation + ripple.phase)
        else:
            rotation = machine.rolling.omega_p * t - q[PHI_P]  # the pinion turns clockwise
            driving += ripple.amplitude * math.cos(ripple.order * rotation + ripple.phase)
    return driving, braking


@expanded
def own_teeth_of(packed: FloatArray) -> OwnTeeth:
    """The records of all teeth."""
    blocks = machine_of(packed)[0].blocks
    return OwnTeeth(
        teeth_of(packed, blocks.teeth_p), teeth_of(packed, blocks.teeth_g), faults_of(packed, blocks.faults)
    )


@called
def turned_arcs(machine: Record, t: float, q: FloatArray) -> TurnedArcs:
    """Arcs of the base circles at time t and coordinates q (6,)."""
    geometry = machine.geometry
    rolling = machine.rolling
    pinion = geometry.L_XA + geometry.radius_p * (rolling.omega_p * t - q[PHI_P])
    gear = geometry.L_XY - geometry.L_XA - geometry.radius_g * (rolling.omega_g * t + q[PHI_G])
    return TurnedArcs(pinion, gear)


@uncounted
def teeth_of_pair(
    machine: Record, teeth: OwnTeeth, arcs: TurnedArcs, rho_p: float, rho_g: float
) -> TeethOfPair:
    """Numbers of the teeth with flanks at the distances rho_p and rho_g from X and Y.

    Pair 0 was at A at t = 0, and each pair behind it is one base pitch behind.
    """
    pitch = machine.geometry.pitch
    pitches_p = math.floor((arcs.pinion - rho_p) / pitch + 0.5)
    pitches_g = math.floor((rho_g - arcs.gear) / pitch + 0.5)
    pinion = (machine.mountings[0].first_tooth + pitches_p) % teeth.pinion.size
    gear = (machine.mountings[1].first_tooth + pitches_g) % teeth.gear.size
    return TeethOfPair(pinion, gear)


@called
def fault_effect(fault: Record, radius: float, place: float, sense: float) -> FaultEffect:
    """What a fault adds at a place of its flank [m]; ``sense`` is d(place)/d(xi), 0 beyond the flank.

    A crack bends the tooth about its root section, whose centre is r_b - u cos(rho/r_b - half tooth) off the
    line of action: the tangent's foot on the base circle is that angle off the tooth's centre line.
    """
    turn = place / radius - fault.half_tooth
    arm = radius - fault.root * math.cos(turn)
    compliance = fault.crack * arm * arm
    slope = sense * 2.0 * fault.crack * arm * fault.root * math.sin(turn) / radius
    if fault.spall_start <= place < fault.spall_end:
        return FaultEffect(compliance + fault.spall, slope, fault.pit)
    return FaultEffect(compliance, slope, 0.0)


@uncounted
def tooth_pair(machine: Record, teeth: OwnTeeth, pair: TeethOfPair, xi: float) -> OwnPair:
    """What two teeth make of their pair in contact at xi [m]."""
    geometry = machine.geometry
    pinion = teeth.pinion[pair.pinion]
    gear = teeth.gear[pair.gear]
    rise = pinion.rise - gear.rise
    inside = min(max(xi, geometry.L_XA), geometry.L_XD)
    error = pinion.error + gear.error + rise * (inside - geometry.L_XP)
    rise = rise if inside == xi else 0.0
    compliance = 0.0
    slope = 0.0
    tip_p = geometry.tip_p
    tip_g = geometry.tip_g
    for i in range(teeth.faults.size):
        fault = teeth.faults[i]
        if fault.tooth != (pair.gear if fault.gear == 1 else pair.pinion):
            continue
        if fault.gear == 1:
            tip_g = min(tip_g, fault.flank_end)
            radius = geometry.radius_g
            place = geometry.L_XY - xi
            sense = -1.0
        else:
            tip_p = min(tip_p, fault.flank_end)
            radius = geometry.radius_p
            place = xi
            sense = 1.0
        if place > fault.flank_end:
            sense = 0.0
            place = fault.flank_end
        effect = fault_effect(fault, radius, place, sense)
        compliance += effect.compliance
        slope += effect.compliance_slope
        error += effect.gap
    return OwnPair(error, rise, compliance, slope, tip_p, tip_g, pinion.relief, gear.relief)
