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

import numpy as np

from lumped.compiler import compiled
from lumped.lubrication.viscosity import ISO_VG_MIDPOINT, viscosity_at_100
from lumped.schema.contact import Lubricant
from lumped.schema.gear import Gear
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from multibody.contact import kinematics as kn
from multibody.contact.elements import stiffness_at
from multibody.contact.kinematics import N_FRICTION

# Places in the vector of friction parameters, all SI.
(
    LAW,  # one of the codes below
    MEAN,  # mu_avg of laws I and IV, or the mean coefficient of ISO/TR 14179-2 [-]
    SHARPNESS,  # Phi of law IV [1/m]
    MAXIMUM,  # upper bound of law II [-]
    BOUNDARY, MIXED,  # film parameters below which law V takes IV, and II [-]
    NOMINAL_LOAD,  # w_n, full static load per face width [N/m]
    FACE_WIDTH,  # [m]
    MODULUS,  # E' [Pa]
    VISCOSITY,  # eta [Pa s]
    PRESSURE_K, PRESSURE_S,  # alpha = k eta^s [mm^2/N], eta in mPa s
    ROUGHNESS,  # S, mean of both Ra [m]
    COMPOSITE_ROUGHNESS,  # R_comp [m]
    FILM_LENGTH,  # L_x [m]
    SLOWEST,  # sliding velocity below which law II is held constant [m/s]
    SLOWEST_ROLLING,  # sum of the rolling velocities below which the laws are held [m/s]
    COLUMNS,  # of the lumped model's table, with the code TABLE
) = range(N_FRICTION)  # fmt: skip

#: Codes of the laws, by their names in parameter files.
LAWS = {
    "none": 0.0,
    "coulomb": 1.0,
    "benedict_kelley": 2.0,
    "xu_kahraman": 3.0,
    "smoothed_coulomb": 4.0,
    "composite": 5.0,
    "iso_14179": 1.0,  # one coefficient over the path, as law I
}
#: Code of every other law.
TABLE = 6.0
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


@compiled
def hertz_pressure(f: FloatArray, radius: float, w: float) -> float:
    """Largest pressure of a line contact [Pa], equation (16): sqrt(w E'/(2 pi rho))."""
    return math.sqrt(w * f[MODULUS] / (2.0 * math.pi * radius))


@compiled
def film_parameter(f: FloatArray, rolling: float, radius: float, w: float) -> float:
    """Film parameter Lambda, equation (21): Dowson and Toyoda's central film over the filtered roughness."""
    if w <= 0.0:
        return math.inf
    modulus = f[MODULUS]
    alpha = 1e-6 * f[PRESSURE_K] * (1e3 * f[VISCOSITY]) ** f[PRESSURE_S]  # mm^2/N -> 1/Pa
    material = alpha * modulus
    speed = f[VISCOSITY] * rolling / (2.0 * modulus * radius)
    thickness = 3.06 * material**0.56 * speed**0.69 * (w / (modulus * radius)) ** -0.10 * radius
    band = 2.0 * math.sqrt(8.0 * w * radius / (math.pi * modulus))
    return float(thickness / f[COMPOSITE_ROUGHNESS] * math.sqrt(f[FILM_LENGTH] / band))


@compiled
def benedict_kelley(f: FloatArray, sliding: float, rolling: float, w: float) -> float:
    """Law II before its bounds, equation (14); w in N/mm, eta in mPa s, S in um there; v_s >= ``SLOWEST``."""
    if w <= 0.0:
        return 0.0
    slow = max(sliding, f[SLOWEST])
    number = 29700.0 * (1e-3 * w) / (1e3 * f[VISCOSITY] * slow * rolling * rolling)
    return float(0.0127 * 1.13 / (1.13 - 1e6 * f[ROUGHNESS]) * math.log10(number))


@compiled
def xu_kahraman(f: FloatArray, sliding: float, rolling: float, radius: float, w: float) -> float:
    """Law III, equation (18); p_h in GPa, V_e = v_e/2 in m/s, eta in mPa s, R in m, S in um there."""
    if w <= 0.0 or sliding == 0.0:
        return 0.0
    pressure = 1e-9 * hertz_pressure(f, radius, w)
    eta = 1e3 * f[VISCOSITY]
    slide_to_roll = 2.0 * sliding / rolling
    shear = slide_to_roll * pressure * math.log10(eta)
    exponent = -8.916465 - 0.354068 * shear + 2.812084 * math.exp(-shear)
    exponent += 0.620305 * math.exp(1e6 * f[ROUGHNESS])
    exponent += 1.03303 * math.log(pressure) + 1.036077 * math.log(slide_to_roll)
    exponent += -0.100601 * math.log(0.5 * rolling) + 0.752755 * math.log(eta) - 0.390958 * math.log(radius)
    return math.exp(exponent)


@compiled
def smoothed_coulomb(f: FloatArray, distance: float) -> float:
    """Magnitude of law IV at a distance from the pitch point [m], equation (19)."""
    s = f[SHARPNESS] * abs(distance)
    return float(2.0 * f[MEAN] / math.pi * (math.atan(s) + s / (1.0 + s * s)))


@compiled
def reduced_radius(rho_p: float, rho_g: float) -> float:
    """Reduced radius of curvature [m], equation (15); above 0 also past a base circle, without involute."""
    least = 1e-6 * (rho_p + rho_g)
    return max(rho_p, least) * max(rho_g, least) / (rho_p + rho_g)


@compiled
def branch(f: FloatArray, sliding: float, rolling: float, rho_p: float, rho_g: float, w: float) -> int:
    """Which formula is in force: a number that changes where the coefficient jumps or has a kink."""
    law = int(f[LAW])
    rolling = max(rolling, sliding, f[SLOWEST_ROLLING])
    if law == _V:
        film = film_parameter(f, rolling, reduced_radius(rho_p, rho_g), w)
        law = _IV if film < f[BOUNDARY] else _II if film < f[MIXED] else _III
    if law == _II:
        mu = benedict_kelley(f, sliding, rolling, w)
        return AT_ZERO if mu <= 0.0 else AT_MAXIMUM if mu >= f[MAXIMUM] or sliding < f[SLOWEST] else law
    return law


@compiled
def magnitude(
    f: FloatArray, sliding: float, rolling: float, rho_p: float, rho_g: float, distance: float, w: float
) -> float:
    """Size of the friction coefficient at one contact: v_s >= 0, v_e [m/s], rho_p, rho_g [m], w [N/m].

    ``distance`` is law IV's argument: from the pitch point to where the nominal motion slides as fast [m].
    """
    law = int(f[LAW])
    if law == _NONE:
        return 0.0
    if law == _I:
        return float(f[MEAN])
    if law == _IV:
        return smoothed_coulomb(f, distance)
    # The laws know surfaces that roll, and the same way, so v_e >= v_s; beyond, they are held. Teeth that
    # vibration brings to rest would have any slide-to-roll ratio.
    rolling = max(rolling, sliding, f[SLOWEST_ROLLING])
    radius = reduced_radius(rho_p, rho_g)
    if law == _V:
        film = film_parameter(f, rolling, radius, w)
        law = _IV if film < f[BOUNDARY] else _II if film < f[MIXED] else _III
    if law == _II:
        return float(min(max(benedict_kelley(f, sliding, rolling, w), 0.0), f[MAXIMUM]))
    if law == _III:
        return xu_kahraman(f, sliding, rolling, radius, w)
    return smoothed_coulomb(f, distance)


@compiled
def friction_size(
    p: FloatArray, slide: float, rolling: float, rho_p: float, rho_g: float, distance: float, load: float
) -> float:
    """Size of the friction coefficient by ``magnitude``, without a formula by the lumped table."""
    f = p[kn.FRICTION :]
    if f[LAW] == TABLE:
        end = int(p[kn.OWN]) if p[kn.OWN] > 0.0 else p.size
        table = p[kn.N_PARAMETERS : end].reshape((-1, int(f[COLUMNS])))
        return abs(stiffness_at(table, p[kn.L_XP] + distance))
    return float(magnitude(f, slide, rolling, rho_p, rho_g, distance, load))


@compiled
def at_edge(p: FloatArray, xi: float) -> float:
    """Position at which the law is evaluated: that of the edge of an undercut for a contact beyond it [m]."""
    if p[kn.EDGE_P] > 0.0:
        xi = max(xi, p[kn.EDGE_P])
    if p[kn.EDGE_G] > 0.0:
        xi = min(xi, p[kn.L_XY] - p[kn.EDGE_G])
    return xi


@compiled
def nominal_friction(p: FloatArray, xi: float) -> float:
    """Signed friction coefficient of the nominal motion at xi, under the full static load w_n."""
    f = p[kn.FRICTION :]
    xi = at_edge(p, xi)
    distance = xi - p[kn.L_XP]
    sliding = (p[kn.OMEGA_P] + p[kn.OMEGA_G]) * abs(distance)
    rho_g = p[kn.L_XY] - xi
    rolling = p[kn.OMEGA_P] * xi + p[kn.OMEGA_G] * rho_g
    mu = friction_size(p, sliding, rolling, xi, rho_g, distance, f[NOMINAL_LOAD])
    return math.copysign(mu, distance) if distance != 0.0 else 0.0


@compiled
def signed_friction(
    p: FloatArray,
    flags: int,
    flank: float,
    xi: float,
    slide: float,
    rolling: float,
    rho_p: float,
    rho_g: float,
    normal: float,
) -> float:
    """Friction coefficient with the sign of the sliding velocity, by the law at this contact.

    Without the effects of the actual sliding velocity and the momentary load it slides and rolls as in the
    nominal motion at xi and carries w_n. ``rolling`` is the sum of both rolling velocities [m/s].
    """
    f = p[kn.FRICTION :]
    load = max(normal, 0.0) / f[FACE_WIDTH] if flags & kn.FRICTION_LOAD else f[NOMINAL_LOAD]
    speeds = p[kn.OMEGA_P] + p[kn.OMEGA_G]
    if not flags & kn.SLIDING:
        rho_p = at_edge(p, xi)
        slide = flank * speeds * (rho_p - p[kn.L_XP])
        rho_g = p[kn.L_XY] - rho_p
        rolling = p[kn.OMEGA_P] * rho_p + p[kn.OMEGA_G] * rho_g
    if slide == 0.0:
        return 0.0
    mu = friction_size(p, abs(slide), rolling, rho_p, rho_g, slide / speeds, load)
    if flags & kn.SLIDING and p[kn.V_REG] > 0.0:
        return mu * math.tanh(slide / p[kn.V_REG])
    return math.copysign(mu, slide)


def fill_friction(pair: GearPair, p: FloatArray) -> None:
    """Write a pair's friction parameters behind its geometry and speeds."""
    friction = pair.friction
    f = p[kn.FRICTION :]
    width = min(pair.pinion.face_width, pair.gear.face_width)
    roughness = (pair.pinion.roughness, pair.gear.roughness)
    composite = friction.composite_roughness
    f[SHARPNESS] = friction.sharpness
    f[MAXIMUM] = friction.maximum
    f[BOUNDARY], f[MIXED], _ = friction.thresholds
    # The load of the paper's laws: the whole torque on one face width (docs/theory/friction.md).
    f[NOMINAL_LOAD] = pair.operating.pinion_torque / p[kn.RADIUS_P] / width
    f[FACE_WIDTH] = width
    f[MODULUS] = 2.0 / (_yielding(pair.pinion) + _yielding(pair.gear))
    f[VISCOSITY] = viscosity(pair.lubricant)
    f[PRESSURE_K] = pair.lubricant.pressure_viscosity_k
    f[PRESSURE_S] = pair.lubricant.pressure_viscosity_s
    f[ROUGHNESS] = sum(roughness) / 2.0
    f[COMPOSITE_ROUGHNESS] = math.sqrt(sum(r * r for r in roughness)) if composite is None else composite
    f[FILM_LENGTH] = friction.film_length
    f[SLOWEST] = _CLOSEST * (p[kn.OMEGA_P] + p[kn.OMEGA_G])
    f[SLOWEST_ROLLING] = _ROLLING * 2.0 * p[kn.OMEGA_P] * p[kn.L_XP]
    name = friction.law  # the field is called so in parameter files
    if name == "iso_14179":
        f[MEAN] = _iso_14179(p)
    elif friction.coefficient is not None:
        f[MEAN] = friction.coefficient
    elif name in ("coulomb", "smoothed_coulomb", "composite"):
        f[MEAN] = _mean_of_law_two(p)
    f[LAW] = LAWS.get(name, TABLE)


def _iso_14179(p: FloatArray) -> float:
    """Mean coefficient of ISO/TR 14179-2, eta in mPa s, Ra in um: w/(v rho) is N/mm over m/s and mm there."""
    f = p[kn.FRICTION :]
    tangent = p[kn.L_XP]
    rolling = 2.0 * p[kn.OMEGA_P] * tangent
    radius = 1e3 * reduced_radius(tangent, p[kn.L_XY] - tangent)
    ratio = 1e-3 * f[NOMINAL_LOAD] / (rolling * radius)
    oil = (1e3 * f[VISCOSITY]) ** -0.05 * (1e6 * f[ROUGHNESS]) ** 0.25
    return float(0.048 * ratio**0.2 * oil)


def viscosity(lubricant: Lubricant) -> float:
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


def friction_switches(p: FloatArray) -> list[tuple[bool, float]]:
    """Where the nominal motion's coefficient jumps or has a kink: places [m].

    The first entry says whether it does so at the sliding velocity of this place, which vibration moves, or
    at the place itself, as law V.
    """
    found: list[tuple[bool, float]] = []
    if _branch(p, p[kn.L_XP] + 0.5 * _CLOSEST) not in (LAWS["none"], LAWS["smoothed_coulomb"]):
        found.append((True, float(p[kn.L_XP])))
    for side, reach in ((-1.0, p[kn.L_XP] - p[kn.L_XA]), (1.0, p[kn.L_XD] - p[kn.L_XP])):

        def at(distance: float, side: float = side) -> int:
            return _branch(p, p[kn.L_XP] + side * distance)

        steps = np.geomspace(0.5 * _CLOSEST, reach * (1.0 - 1e-12), _SEARCHED)
        branches = np.array([at(distance) for distance in steps.tolist()])
        for step in np.flatnonzero(np.diff(branches)):
            low, high = steps[step : step + 2].tolist()
            while (before := at(low)) != at(high):
                low = _change(at, low, high, before)
                moves = before in _LAW_TWO and at(low) in _LAW_TWO
                found.append((moves, float(p[kn.L_XP] + side * low)))
    return found


def _branch(p: FloatArray, xi: float) -> int:
    rho_g = p[kn.L_XY] - xi
    rolling = p[kn.OMEGA_P] * xi + p[kn.OMEGA_G] * rho_g
    sliding = (p[kn.OMEGA_P] + p[kn.OMEGA_G]) * abs(xi - p[kn.L_XP])
    f = p[kn.FRICTION :]
    return int(branch(f, sliding, rolling, xi, rho_g, f[NOMINAL_LOAD]))


def _change(at: Callable[[float], int], low: float, high: float, start: int) -> float:
    """The first place above a change of branch between two places."""
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if at(middle) == start:
            low = middle
        else:
            high = middle
    return high


def _yielding(gear: Gear) -> float:
    return (1.0 - gear.poisson_ratio**2) / gear.youngs_modulus


def _mean_of_law_two(p: FloatArray) -> float:
    """Mean of law II's size over the path of contact: mu_avg of laws I and IV, as in the paper."""
    q = p.copy()
    q[kn.FRICTION + LAW] = LAWS["benedict_kelley"]
    kinks = [place for _, place in friction_switches(q)]
    total = 0.0
    for side, reach in ((-1.0, q[kn.L_XP] - q[kn.L_XA]), (1.0, q[kn.L_XD] - q[kn.L_XP])):
        ends = [d for d in (side * (place - q[kn.L_XP]) for place in kinks) if _CLOSEST < d < reach]
        # Over u = ln(distance) the logarithm of law II is all but a straight line.
        edges = np.log(sorted([_CLOSEST, reach, *ends, *np.geomspace(_CLOSEST, reach, 16)[1:-1]]))
        for low, high in itertools.pairwise(edges.tolist()):
            d = np.exp(0.5 * (low + high) + 0.5 * (high - low) * _NODES)
            mu = [abs(nominal_friction(q, q[kn.L_XP] + side * x)) for x in d]
            total += 0.5 * (high - low) * float(np.sum(_WEIGHTS * mu * d))
        total += _CLOSEST * abs(nominal_friction(q, q[kn.L_XP] + side * _CLOSEST))
    return total / float(q[kn.L_XD] - q[kn.L_XA])
