"""The friction laws of a gear pair as numbers, and where the coefficient of the nominal motion switches."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable

import numpy as np

from lumped.lubrication.viscosity import ISO_VG_MIDPOINT, viscosity_at_100
from lumped.schema.contact import Lubricant
from lumped.schema.gear import Gear
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from multibody.contact import friction as fr
from multibody.contact import layout as kn
from multibody.contact.events import SLIDING, SWITCH
from multibody.contact.kernels import nominal_friction

#: Distance from the pitch point within which law II is held [m]. A position is known to some 2e-18 m, so any
#: closer the logarithm of the sliding velocity would be rounding noise.
_CLOSEST = 1e-8
#: Share of the nominal rolling velocities at the pitch point below which vibration changes no law any more.
_ROLLING = 0.1
#: Places on either side of the pitch point, at distances that grow geometrically, between which a law
#: switches at most once per branch, and halvings until such a place is known to rounding.
_SEARCHED, _HALVINGS = 400, 60
#: Branches of law II.
_LAW_TWO = (fr.AT_ZERO, fr.AT_MAXIMUM, int(fr.LAWS["benedict_kelley"]))
#: Gauss-Legendre rule of the mean coefficient.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(20)


def fill_friction(pair: GearPair, p: FloatArray) -> None:
    """Write a pair's friction parameters behind its geometry and speeds."""
    law, f = pair.friction, p[kn.FRICTION :]
    width = min(pair.pinion.face_width, pair.gear.face_width)
    roughness = (pair.pinion.roughness, pair.gear.roughness)
    composite = law.composite_roughness
    f[fr.SHARPNESS], f[fr.MAXIMUM] = law.sharpness, law.maximum
    f[fr.BOUNDARY], f[fr.MIXED], _ = law.thresholds
    # The load of the paper's laws: the whole torque on one face width (docs/theory/friction.md).
    f[fr.NOMINAL_LOAD] = pair.operating.pinion_torque / p[kn.RADIUS_P] / width
    f[fr.FACE_WIDTH] = width
    f[fr.MODULUS] = 2.0 / (_yielding(pair.pinion) + _yielding(pair.gear))
    f[fr.VISCOSITY] = viscosity(pair.lubricant)
    f[fr.PRESSURE_K] = pair.lubricant.pressure_viscosity_k
    f[fr.PRESSURE_S] = pair.lubricant.pressure_viscosity_s
    f[fr.ROUGHNESS] = sum(roughness) / 2.0
    f[fr.COMPOSITE_ROUGHNESS] = math.sqrt(sum(r * r for r in roughness)) if composite is None else composite
    f[fr.FILM_LENGTH] = law.film_length
    f[fr.SLOWEST] = _CLOSEST * (p[kn.OMEGA_P] + p[kn.OMEGA_G])
    f[fr.SLOWEST_ROLLING] = _ROLLING * 2.0 * p[kn.OMEGA_P] * p[kn.L_XP]
    name = law.law
    if name == "iso_14179":
        f[fr.MEAN] = _iso_14179(p)
    elif law.coefficient is not None:
        f[fr.MEAN] = law.coefficient
    elif name in ("coulomb", "smoothed_coulomb", "composite"):
        f[fr.MEAN] = _mean_of_law_two(p)
    f[fr.LAW] = fr.LAWS.get(name, fr.TABLE)


def _iso_14179(p: FloatArray) -> float:
    """Mean coefficient of ISO/TR 14179-2, eta in mPa s, Ra in um: w/(v rho) is N/mm over m/s and mm there."""
    f, tangent = p[kn.FRICTION :], p[kn.L_XP]
    rolling = 2.0 * p[kn.OMEGA_P] * tangent
    radius = 1e3 * fr.reduced_radius(tangent, p[kn.L_XY] - tangent)
    ratio = 1e-3 * f[fr.NOMINAL_LOAD] / (rolling * radius)
    oil = (1e3 * f[fr.VISCOSITY]) ** -0.05 * (1e6 * f[fr.ROUGHNESS]) ** 0.25
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
        at_40, at_100 = 1e6 * law.kinematic_viscosity_40, 1e6 * law.kinematic_viscosity_100
    low, high = (math.log10(math.log10(nu + 0.7)) for nu in (at_40, at_100))
    kelvin = law.temperature
    share = math.log10(kelvin / 313.15) / math.log10(373.15 / 313.15)
    kinematic = 1e-6 * (10.0 ** (10.0 ** (low + share * (high - low))) - 0.7)
    expanded = 0.6278 / law.density * (kelvin - 288.15)
    return float(kinematic * law.density * math.exp(-expanded * (1.0 + 0.8 * expanded)))


def friction_switches(p: FloatArray) -> list[tuple[float, float]]:
    """Where the nominal motion's coefficient jumps or has a kink, law V at a position: (kind, place [m])."""
    found: list[tuple[float, float]] = []
    if _branch(p, p[kn.L_XP] + 0.5 * _CLOSEST) not in (fr.LAWS["none"], fr.LAWS["smoothed_coulomb"]):
        found.append((SLIDING, float(p[kn.L_XP])))
    for side, reach in ((-1.0, p[kn.L_XP] - p[kn.L_XA]), (1.0, p[kn.L_XD] - p[kn.L_XP])):

        def at(distance: float, side: float = side) -> int:
            return _branch(p, p[kn.L_XP] + side * distance)

        steps = np.geomspace(0.5 * _CLOSEST, reach * (1.0 - 1e-12), _SEARCHED)
        branches = np.array([at(distance) for distance in steps.tolist()])
        for step in np.flatnonzero(np.diff(branches)):
            low, high = steps[step : step + 2].tolist()
            while (before := at(low)) != at(high):
                low = _change(at, low, high, before)
                kind = SLIDING if before in _LAW_TWO and at(low) in _LAW_TWO else SWITCH
                found.append((kind, float(p[kn.L_XP] + side * low)))
    return found


def _branch(p: FloatArray, xi: float) -> int:
    rho_g = p[kn.L_XY] - xi
    rolling = p[kn.OMEGA_P] * xi + p[kn.OMEGA_G] * rho_g
    sliding = (p[kn.OMEGA_P] + p[kn.OMEGA_G]) * abs(xi - p[kn.L_XP])
    f = p[kn.FRICTION :]
    return int(fr.branch(f, sliding, rolling, xi, rho_g, f[fr.NOMINAL_LOAD]))


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
    q[kn.FRICTION + fr.LAW] = fr.LAWS["benedict_kelley"]
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
