"""Tooth forces of the linear mesh: the equations of the lumped model, without an effect of finite motion.

Sources: docs/theory/multibody.md, "Two builds of one machine".
"""

from __future__ import annotations

import math
from typing import NamedTuple

from lumped.compiler import called
from lumped.typing import FloatArray
from multibody.contact import kinematics as kn
from multibody.contact.elements import relief_at, table_value, table_value_and_slope
from multibody.contact.friction import friction_of_nominal_motion
from multibody.contact.records import (
    COORDINATES,
    PHI_G,
    PHI_P,
    RATES,
    WRENCH,
    X_G,
    X_P,
    Y_G,
    Y_P,
    Record,
    contacts_of,
    machine_of,
    table_of,
    uncounted,
)


class LinearPair(NamedTuple):
    """Laws of one tooth pair at one place of the path of contact.

    stiffness, stiffness_slope : k [N/m], and its slope over xi [N/m^2]
    damping : c [N s/m]
    error, error_slope : error that stands for the gap [m], and its slope over xi
    gap_slope : slope of the gap itself over xi, by which the damper works
    tilt : sine of the angle between the normal at a tip corner and the line of action
    closing : share of the approach that closes the gap: a tip corner's contact also moves outside
    """

    stiffness: float
    stiffness_slope: float
    damping: float
    error: float
    error_slope: float
    gap_slope: float
    tilt: float
    closing: float


class LinearForce(NamedTuple):
    """Force of one tooth pair.

    normal, elastic : normal load, and normal load without the damper [N]
    friction : friction force [N]
    apart : force of a tip corner that pushes the gears apart [N]
    """

    normal: float
    elastic: float
    friction: float
    apart: float


@called
def tabulated_pair(packed: FloatArray, machine: Record, xi: float) -> LinearPair:
    """Laws of a pair with loaded contact, linear about the static state."""
    blocks = machine.blocks
    stiffness, stiffness_slope = table_value_and_slope(table_of(packed, blocks.stiffness), xi)
    error, error_slope = table_value_and_slope(table_of(packed, blocks.linear_error), xi)
    return LinearPair(
        stiffness,
        stiffness_slope,
        table_value(table_of(packed, blocks.linear_damping), xi),
        error,
        error_slope,
        table_value_and_slope(table_of(packed, blocks.linear_gap), xi)[1],
        table_value(table_of(packed, blocks.linear_tilt), xi),
        table_value(table_of(packed, blocks.linear_closing), xi),
    )


@called
def prescribed_pair(packed: FloatArray, machine: Record, xi: float) -> LinearPair:
    """Laws of a pair with prescribed contact: it touches from A to D, with its relief as error."""
    error, slope = relief_at(machine, xi, 0.0, 0.0)
    stiffness, stiffness_slope = table_value_and_slope(table_of(packed, machine.blocks.stiffness), xi)
    damping = machine.pair_law.damping * math.sqrt(max(stiffness, 0.0))
    return LinearPair(stiffness, stiffness_slope, damping, error, slope, slope, 0.0, 1.0)


@called
def add_linear_wrench(wrench: FloatArray, machine: Record, xi: float, force: LinearForce) -> None:
    """Add the force of a pair to the wrench of pinion and gear, with nominal arms."""
    geometry = machine.geometry
    wrench[X_P] -= force.normal
    wrench[Y_P] += force.friction - force.apart
    wrench[PHI_P] += geometry.radius_p * force.normal + xi * force.friction
    wrench[X_G] += force.normal
    wrench[Y_G] -= force.friction - force.apart
    wrench[PHI_G] += geometry.radius_g * force.normal + (geometry.L_XY - xi) * force.friction


@called
def linear_path_force(
    pair: LinearPair,
    compression: float,
    force: LinearForce,
    approach_rate: float,
    y_rate: float,
    speed: float,
) -> float:
    """Force along the path of contact [N]; ``y_rate`` is the rate of y_g - y_p, ``speed`` that of xi [m/s].

    The damper works on the gap itself, the spring on the error that stands for it with loaded contact.
    """
    damper = force.normal - force.elastic
    gap_rate = pair.closing * pair.gap_slope + (1.0 - pair.closing) * approach_rate / speed
    path = force.elastic * pair.error_slope + damper * gap_rate
    path -= 0.5 * pair.stiffness_slope * compression * compression
    return path - force.apart * y_rate / speed


@called
def first_position(t: float, machine: Record, start: float) -> float:
    """Position of the tooth pair next behind ``start`` on the path in the nominal motion at time t [m]."""
    geometry = machine.geometry
    rolling = machine.rolling
    pitch = geometry.pitch
    smooth_time = min(max(t, rolling.earliest), rolling.latest)
    advance = rolling.omega_p * geometry.radius_p * smooth_time
    advance -= pitch * math.floor(advance / pitch)
    first = geometry.L_XA + advance
    return float(first - pitch * math.floor((first - start) / pitch))


@uncounted
def linear_forces(
    t: float, state: FloatArray, packed: FloatArray, flags: int, flat_contacts: FloatArray
) -> int:
    """Forces on (x_p, y_p, phi_p, x_g, y_g, phi_g) in the lumped model; arguments as ``contact_forces``.

    Of the flags ``CONTACT_LOSS`` acts: a pair loads where its flanks overlap and push. No back sides.
    """
    machine = machine_of(packed)[0]
    geometry = machine.geometry
    rolling = machine.rolling
    contacts = contacts_of(flat_contacts)
    mu_table = table_of(packed, machine.blocks.friction)
    stiffness_table = table_of(packed, machine.blocks.stiffness)
    q = state[COORDINATES]
    v = state[RATES]
    wrench = state[WRENCH]
    wrench[:] = 0.0
    speed = rolling.omega_p * geometry.radius_p
    approach = q[X_P] - q[X_G] - geometry.radius_p * q[PHI_P] - geometry.radius_g * q[PHI_G]
    approach_rate = v[X_P] - v[X_G] - geometry.radius_p * v[PHI_P] - geometry.radius_g * v[PHI_G]
    loaded = machine.blocks.linear_damping.rows > 0
    start = stiffness_table[0, 0] if loaded else geometry.L_XA
    end = stiffness_table[stiffness_table.shape[0] - 1, 1] if loaded else geometry.L_XD
    count = 0
    xi = first_position(t, machine, start)
    while xi <= end:
        pair = tabulated_pair(packed, machine, xi) if loaded else prescribed_pair(packed, machine, xi)
        compression = approach - pair.error
        compression_rate = approach_rate - pair.gap_slope * speed
        stiffness = pair.stiffness
        damping = pair.damping
        normal = stiffness * compression + damping * compression_rate
        if flags & kn.CONTACT_LOSS and (compression <= 0.0 or normal < 0.0):
            stiffness = damping = normal = 0.0
        mu = friction_of_nominal_motion(machine, mu_table, xi)
        force = LinearForce(normal, stiffness * compression, mu * normal, pair.tilt * normal)
        add_linear_wrench(wrench, machine, xi, force)
        contact = contacts[count]
        contact.position = xi
        contact.load = normal
        contact.friction_force = force.friction
        contact.friction_coefficient = mu
        contact.stiffness = stiffness
        contact.damping = damping
        contact.flank = 1.0
        contact.compression = compression
        contact.compression_rate = pair.closing * compression_rate
        contact.approach_rate = approach_rate
        contact.sliding_velocity = nominal_sliding(machine, v, xi)
        contact.elastic_load = force.elastic
        contact.energy = 0.5 * stiffness * compression**2
        y_rate = v[Y_G] - v[Y_P]
        contact.path_force = linear_path_force(pair, compression, force, approach_rate, y_rate, speed)
        contact.path_rate = speed
        count += 1
        xi += geometry.pitch
    total = 0.0
    for i in range(wrench.size):
        total += wrench[i]
    return count if math.isfinite(total) else -1


@called
def nominal_sliding(machine: Record, v: FloatArray, xi: float) -> float:
    """Sliding velocity at xi with the rates v of the gears and nominal arms [m/s]."""
    rolling = machine.rolling
    gear_arm = machine.geometry.L_XY - xi
    by_rotation = (rolling.omega_p - v[PHI_P]) * xi - (rolling.omega_g + v[PHI_G]) * gear_arm
    return float(by_rotation - (v[Y_P] - v[Y_G]))
