"""The friction of one contact in the multibody model: published laws, their parameters, where they switch.

Written from the printed laws (docs/theory/friction.md), with conversions of its own from SI and without a
line or a table of ``lumped.friction``: a wrong unit or factor on either side shows as a difference. A law
that is not written here has the code ``TABLE``: the contact reads the lumped model's mu(xi).

v_s is the sliding velocity, v_e the sum of the rolling velocities, w the load per face width.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from lumped.compiler import called
from lumped.lubrication.viscosity import ISO_VG_MIDPOINT, viscosity_at_100
from lumped.schema.contact import Lubricant
from lumped.schema.gear import Gear
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from multibody.contact.elements import table_value
from multibody.contact.kinematics import FRICTION_LOAD, SLIDING
from multibody.contact.records import Record, machine_of, opened, table_of, uncounted

#: Codes of the laws, by their names in parameter files.
LAWS = {
    "none": 0,
    "coulomb": 1,
    "benedict_kelley": 2,
    "xu_kahraman": 3,
    "smoothed_coulomb": 4,
    "composite": 5,
    "iso_14179": 1,  # one coefficient over the path, as law I
}
#: Code of every other law.
TABLE = 6
_NONE, _I, _II, _III, _IV, _V = range(6)

#: Branches of law II, as ``branch`` tells them beside the codes of the laws: at its two bounds.
AT_MAXIMUM = 20
AT_ZERO = 21
#: Distance from the pitch point within which law II is held [m]. A position is known to some 2e-18 m, so any
#: closer the logarithm of the sliding velocity would be rounding noise.
_CLOSEST = 1e-8
#: Share of the nominal rolling velocities at the pitch point below which vibration changes no law any more.
_ROLLING = 0.1
#: Places on either side of the pitch point, at distances that grow geometrically, between which a law
#: switches at most once per branch, and halvings until such a place is known to rounding.
_SEARCHED = 400
_HALVINGS = 60
#: Branches of law II.
_LAW_TWO = (AT_ZERO, AT_MAXIMUM, _II)
#: Gauss-Legendre rule of the mean coefficient.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(20)


@uncounted
def hertz_pressure(f: Record, radius: float, w: float) -> float:
    """Largest pressure of a line contact [Pa], equation (16): sqrt(w E'/(2 pi rho))."""
    return math.sqrt(w * f.modulus / (2.0 * math.pi * radius))


@uncounted
def film_parameter(f: Record, rolling: float, radius: float, w: float) -> float:
    """Film parameter Lambda, equation (21): Dowson and Toyoda's central film over the filtered roughness."""
    if w <= 0.0:
        return math.inf
    modulus = f.modulus
    alpha = 1e-6 * f.pressure_k * (1e3 * f.viscosity) ** f.pressure_s  # mm^2/N -> 1/Pa
    material = alpha * modulus
    speed = f.viscosity * rolling / (2.0 * modulus * radius)
    thickness = 3.06 * material**0.56 * speed**0.69 * (w / (modulus * radius)) ** -0.10 * radius
    band = 2.0 * math.sqrt(8.0 * w * radius / (math.pi * modulus))
    return float(thickness / f.composite_roughness * math.sqrt(f.film_length / band))


@uncounted
def benedict_kelley(f: Record, sliding: float, rolling: float, w: float) -> float:
    """Law II before its bounds, equation (14); w in N/mm, eta in mPa s, S in um there; v_s >= ``slowest``."""
    if w <= 0.0:
        return 0.0
    slow = max(sliding, f.slowest)
    number = 29700.0 * (1e-3 * w) / (1e3 * f.viscosity * slow * rolling * rolling)
    return float(0.0127 * 1.13 / (1.13 - 1e6 * f.roughness) * math.log10(number))


@uncounted
def xu_kahraman(f: Record, sliding: float, rolling: float, radius: float, w: float) -> float:
    """Law III, equation (18); p_h in GPa, V_e = v_e/2 in m/s, eta in mPa s, R in m, S in um there."""
    if w <= 0.0 or sliding == 0.0:
        return 0.0
    pressure = 1e-9 * hertz_pressure(f, radius, w)
    eta = 1e3 * f.viscosity
    slide_to_roll = 2.0 * sliding / rolling
    shear = slide_to_roll * pressure * math.log10(eta)
    exponent = -8.916465 - 0.354068 * shear + 2.812084 * math.exp(-shear)
    exponent += 0.620305 * math.exp(1e6 * f.roughness)
    exponent += 1.03303 * math.log(pressure) + 1.036077 * math.log(slide_to_roll)
    exponent += -0.100601 * math.log(0.5 * rolling) + 0.752755 * math.log(eta) - 0.390958 * math.log(radius)
    return math.exp(exponent)


@uncounted
def smoothed_coulomb(f: Record, distance: float) -> float:
    """Magnitude of law IV at a distance from the pitch point [m], equation (19)."""
    s = f.sharpness * abs(distance)
    return float(2.0 * f.mean / math.pi * (math.atan(s) + s / (1.0 + s * s)))


@uncounted
def reduced_radius(rho_p: float, rho_g: float) -> float:
    """Reduced radius of curvature [m], equation (15); above 0 also past a base circle, without involute."""
    least = 1e-6 * (rho_p + rho_g)
    return max(rho_p, least) * max(rho_g, least) / (rho_p + rho_g)


@called
def branch(f: Record, sliding: float, rolling: float, rho_p: float, rho_g: float, w: float) -> int:
    """Which formula is in force: a number that changes where the coefficient jumps or has a kink."""
    law = f.law
    rolling = max(rolling, sliding, f.slowest_rolling)
    if law == _V:
        film = film_parameter(f, rolling, reduced_radius(rho_p, rho_g), w)
        law = _IV if film < f.boundary else _II if film < f.mixed else _III
    if law == _II:
        mu = benedict_kelley(f, sliding, rolling, w)
        return AT_ZERO if mu <= 0.0 else AT_MAXIMUM if mu >= f.maximum or sliding < f.slowest else law
    return int(law)


@called
def magnitude(
    f: Record, sliding: float, rolling: float, rho_p: float, rho_g: float, distance: float, w: float
) -> float:
    """Size of the friction coefficient at one contact: v_s >= 0, v_e [m/s], rho_p, rho_g [m], w [N/m].

    ``distance`` is law IV's argument: from the pitch point to where the nominal motion slides as fast [m].
    """
    law = f.law
    if law == _NONE:
        return 0.0
    if law == _I:
        return float(f.mean)
    if law == _IV:
        return smoothed_coulomb(f, distance)
    # The laws know surfaces that roll, and the same way, so v_e >= v_s; beyond, they are held. Teeth that
    # vibration brings to rest would have any slide-to-roll ratio.
    rolling = max(rolling, sliding, f.slowest_rolling)
    radius = reduced_radius(rho_p, rho_g)
    if law == _V:
        film = film_parameter(f, rolling, radius, w)
        law = _IV if film < f.boundary else _II if film < f.mixed else _III
    if law == _II:
        return float(min(max(benedict_kelley(f, sliding, rolling, w), 0.0), f.maximum))
    if law == _III:
        return xu_kahraman(f, sliding, rolling, radius, w)
    return smoothed_coulomb(f, distance)


class SurfaceMotion(NamedTuple):
    """How both surfaces move at one contact.

    sliding : sliding velocity [m/s]
    rolling : sum of both rolling velocities [m/s]
    rho_p, rho_g : radii of curvature, the distances from X and Y [m]
    """

    sliding: float
    rolling: float
    rho_p: float
    rho_g: float


@called
def friction_size(
    machine: Record, table: FloatArray, surface: SurfaceMotion, distance: float, load: float
) -> float:
    """Size of the friction coefficient: ``magnitude`` times the factor on mu.

    A law without a formula is read from the lumped ``table``, which has the factor. ``distance`` is as in
    ``magnitude`` but with its sign, ``load`` is the load per face width [N/m].
    """
    if machine.friction.law == TABLE:
        return abs(table_value(table, machine.geometry.L_XP + distance))
    sliding = abs(surface.sliding)
    mu = magnitude(machine.friction, sliding, surface.rolling, surface.rho_p, surface.rho_g, distance, load)
    return float(machine.friction.factor * mu)


@called
def at_edge(machine: Record, xi: float) -> float:
    """Position at which a law is evaluated [m]: xi, or the edge of an undercut where xi lies beyond it."""
    geometry = machine.geometry
    if geometry.edge_p > 0.0:
        xi = max(xi, geometry.edge_p)
    if geometry.edge_g > 0.0:
        xi = min(xi, geometry.L_XY - geometry.edge_g)
    return xi


@called
def nominal_surface(machine: Record, xi: float) -> SurfaceMotion:
    """Motion of the surfaces in the nominal motion with the contact at xi; the sliding without its sign."""
    rolling = machine.rolling
    rho_g = machine.geometry.L_XY - xi
    sliding = (rolling.omega_p + rolling.omega_g) * abs(xi - machine.geometry.L_XP)
    return SurfaceMotion(sliding, rolling.omega_p * xi + rolling.omega_g * rho_g, xi, rho_g)


@called
def friction_of_nominal_motion(machine: Record, table: FloatArray, xi: float) -> float:
    """Signed friction coefficient of the nominal motion at xi, under the full static load w_n."""
    xi = at_edge(machine, xi)
    distance = xi - machine.geometry.L_XP
    surface = nominal_surface(machine, xi)
    mu = friction_size(machine, table, surface, distance, machine.friction.nominal_load)
    return math.copysign(mu, distance) if distance != 0.0 else 0.0


@uncounted
def nominal_friction(packed: FloatArray, xi: float) -> float:
    """``friction_of_nominal_motion`` of a packed machine."""
    machine = machine_of(packed)[0]
    return float(friction_of_nominal_motion(machine, table_of(packed, machine.blocks.friction), xi))


@uncounted
def nominal_branch(packed: FloatArray, xi: float) -> int:
    """``branch`` of the nominal motion of a packed machine at xi."""
    machine = machine_of(packed)[0]
    surface = nominal_surface(machine, xi)
    f = machine.friction
    return branch(f, surface.sliding, surface.rolling, surface.rho_p, surface.rho_g, f.nominal_load)


@uncounted
def signed_friction(
    machine: Record,
    table: FloatArray,
    flags: int,
    flank: float,
    xi: float,
    surface: SurfaceMotion,
    normal: float,
) -> float:
    """Friction coefficient with the sign of the sliding velocity, by the law at this contact.

    Without the effects of the actual sliding velocity and the momentary load the contact slides and rolls as
    in the nominal motion at xi and carries w_n.
    """
    friction = machine.friction
    load = max(normal, 0.0) / friction.face_width if flags & FRICTION_LOAD else friction.nominal_load
    speeds = machine.rolling.omega_p + machine.rolling.omega_g
    if not flags & SLIDING:
        place = at_edge(machine, xi)
        sliding = flank * speeds * (place - machine.geometry.L_XP)
        nominal = nominal_surface(machine, place)
        surface = SurfaceMotion(sliding, nominal.rolling, place, nominal.rho_g)
    if surface.sliding == 0.0:
        return 0.0
    mu = friction_size(machine, table, surface, surface.sliding / speeds, load)
    if flags & SLIDING and friction.reversal_velocity > 0.0:
        return mu * math.tanh(surface.sliding / friction.reversal_velocity)
    return math.copysign(mu, surface.sliding)


def fill_friction(pair: GearPair, packed: FloatArray) -> None:
    """Write a pair's friction parameters into a packed machine that has its geometry and speeds."""
    section = pair.friction
    machine = opened(packed)
    geometry = machine.geometry
    rolling = machine.rolling
    f = machine.friction
    width = min(pair.pinion.face_width, pair.gear.face_width)
    roughness = (pair.pinion.roughness, pair.gear.roughness)
    composite = section.composite_roughness
    f.factor = 1.0  # for the mean of law II, which is without the factor
    f.sharpness = section.sharpness
    f.maximum = section.maximum
    f.boundary, f.mixed, _ = section.thresholds
    # The load of the paper's laws: the whole torque on one face width (docs/theory/friction.md).
    f.nominal_load = pair.operating.pinion_torque / geometry.radius_p / width
    f.face_width = width
    f.modulus = 2.0 / (_yielding(pair.pinion) + _yielding(pair.gear))
    f.viscosity = dynamic_viscosity(pair.lubricant)
    f.pressure_k = pair.lubricant.pressure_viscosity_k
    f.pressure_s = pair.lubricant.pressure_viscosity_s
    f.roughness = sum(roughness) / 2.0
    f.composite_roughness = math.sqrt(sum(r * r for r in roughness)) if composite is None else composite
    f.film_length = section.film_length
    f.slowest = _CLOSEST * (rolling.omega_p + rolling.omega_g)
    f.slowest_rolling = _ROLLING * 2.0 * rolling.omega_p * geometry.L_XP
    name = section.law
    if name == "iso_14179":
        f.mean = _iso_14179(machine)
    elif section.coefficient is not None:
        f.mean = section.coefficient
    elif name in ("coulomb", "smoothed_coulomb", "composite"):
        f.mean = _mean_of_law_two(packed)
    f.law = LAWS.get(name, TABLE)
    f.factor = _factor_on_mu(pair)


def _factor_on_mu(pair: GearPair) -> float:
    """Factor on the coefficient of every law by the fields of the file, without ``lumped``.

    No field is such a factor yet. The lumped model has its factors in ``lumped.schema.friction.FACTORS``.
    """
    return 1.0


def _iso_14179(machine: Record) -> float:
    """Mean coefficient of ISO/TR 14179-2, eta in mPa s, Ra in um: w/(v rho) is N/mm over m/s and mm there."""
    f = machine.friction
    tangent = machine.geometry.L_XP
    rolling = 2.0 * machine.rolling.omega_p * tangent
    radius = 1e3 * reduced_radius(tangent, machine.geometry.L_XY - tangent)
    ratio = 1e-3 * f.nominal_load / (rolling * radius)
    oil = (1e3 * f.viscosity) ** -0.05 * (1e6 * f.roughness) ** 0.25
    return float(0.048 * ratio**0.2 * oil)


def dynamic_viscosity(lubricant: Lubricant) -> float:
    """Dynamic viscosity [Pa s]: as given, or by Walther's law (ASTM D341) times the density (ASTM D1250).

    The viscosity of a grade at 100 degC is read from ``lumped`` (the tables of ASTM D2270).
    """
    law = lubricant.viscosity_law
    if law is None:
        assert lubricant.viscosity is not None  # the schema asks for exactly one of them
        return lubricant.viscosity
    if law.iso_vg is not None:
        at_40 = ISO_VG_MIDPOINT[law.iso_vg]
        at_100 = viscosity_at_100(at_40, law.viscosity_index)
    else:
        assert law.kinematic_viscosity_40 is not None  # the schema asks for the grade or for both
        assert law.kinematic_viscosity_100 is not None
        at_40 = 1e6 * law.kinematic_viscosity_40
        at_100 = 1e6 * law.kinematic_viscosity_100
    low, high = (math.log10(math.log10(nu + 0.7)) for nu in (at_40, at_100))
    kelvin = law.temperature
    share = math.log10(kelvin / 313.15) / math.log10(373.15 / 313.15)
    kinematic = 1e-6 * (10.0 ** (10.0 ** (low + share * (high - low))) - 0.7)
    expanded = 0.6278 / law.density * (kelvin - 288.15)
    return float(kinematic * law.density * math.exp(-expanded * (1.0 + 0.8 * expanded)))


class FrictionSwitch(NamedTuple):
    """A jump or kink of the coefficient of friction.

    moves : whether the jump is at a sliding velocity, so that vibration moves the jump; else the jump is at a
        place
    place : position xi of the jump in the nominal motion [m]
    """

    moves: bool
    place: float


def friction_switches(packed: FloatArray) -> list[FrictionSwitch]:
    """Where the nominal motion's coefficient jumps or has a kink."""
    geometry = opened(packed).geometry
    pitch_point = float(geometry.L_XP)
    switches: list[FrictionSwitch] = []
    if nominal_branch(packed, pitch_point + 0.5 * _CLOSEST) not in (LAWS["none"], LAWS["smoothed_coulomb"]):
        switches.append(FrictionSwitch(True, pitch_point))
    for side, reach in ((-1.0, pitch_point - geometry.L_XA), (1.0, geometry.L_XD - pitch_point)):

        def branch_at(distance: float, side: float = side) -> int:
            return int(nominal_branch(packed, pitch_point + side * distance))

        steps = np.geomspace(0.5 * _CLOSEST, reach * (1.0 - 1e-12), _SEARCHED)
        branches = np.array([branch_at(distance) for distance in steps.tolist()])
        for step in np.flatnonzero(np.diff(branches)):
            low, high = steps[step : step + 2].tolist()
            while (before := branch_at(low)) != branch_at(high):
                low = _change(branch_at, low, high, before)
                moves = before in _LAW_TWO and branch_at(low) in _LAW_TWO
                switches.append(FrictionSwitch(moves, pitch_point + side * low))
    return switches


def _change(branch_at: Callable[[float], int], low: float, high: float, start: int) -> float:
    """The first place above a change of branch between two places."""
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if branch_at(middle) == start:
            low = middle
        else:
            high = middle
    return high


def _yielding(gear: Gear) -> float:
    return (1.0 - gear.poisson_ratio**2) / gear.youngs_modulus


def _mean_of_law_two(packed: FloatArray) -> float:
    """Mean of law II's size over the path of contact: mu_avg of laws I and IV, as in the paper."""
    packed = packed.copy()
    opened(packed).friction.law = LAWS["benedict_kelley"]
    geometry = opened(packed).geometry
    pitch_point = float(geometry.L_XP)
    kinks = [switch.place for switch in friction_switches(packed)]
    total = 0.0
    for side, reach in ((-1.0, pitch_point - geometry.L_XA), (1.0, geometry.L_XD - pitch_point)):
        ends = [d for d in (side * (place - pitch_point) for place in kinks) if _CLOSEST < d < reach]
        # Over u = ln(distance) the logarithm of law II is all but a straight line.
        edges = np.log(sorted([_CLOSEST, reach, *ends, *np.geomspace(_CLOSEST, reach, 16)[1:-1]]))
        for low, high in itertools.pairwise(edges.tolist()):
            d = np.exp(0.5 * (low + high) + 0.5 * (high - low) * _NODES)
            mu = [abs(nominal_friction(packed, pitch_point + side * x)) for x in d]
            total += 0.5 * (high - low) * float(np.sum(_WEIGHTS * mu * d))
        total += _CLOSEST * abs(nominal_friction(packed, pitch_point + side * _CLOSEST))
    return total / float(geometry.L_XD - geometry.L_XA)
