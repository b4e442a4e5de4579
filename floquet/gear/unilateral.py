"""The gear pair whose teeth push and never pull, as a system that is linear between events.

Sources: docs/theory/orbits.md, "Gear pair".
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from floquet.gear.axes import GearVariation, operating_rpm
from floquet.gear.friction_over_speed import FrictionFamily, depends_on_speed, friction_families
from floquet.orbits.branch import Family
from floquet.orbits.system import Contact, ContactSystem
from lumped.model.bodies import bodies
from lumped.model.mesh_cycle import MeshCycle, mesh_cycle
from lumped.model.mesh_elements import mesh_elements
from lumped.model.periodic_system import periodic_system
from lumped.path_function import PathFunction, shifted
from lumped.path_of_contact import friction_path_function
from lumped.quasi_static.tooth_error import error_function
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray

_SPEEDS = 33


def unilateral_system(pair: AnyPair, friction: PathFunction | None = None) -> ContactSystem:
    """Return (q, x_p, x_g) of a gear pair with one unilateral contact for each tooth pair.

    A contact carries k (delta - e) + c (delta' - e') where the flanks overlap and that is positive, as the
    multibody effect ``contact_loss``. Relief is clearance e; static loads cut nothing. Friction acts with its
    nominal sign. In the loaded form the contact is the tangent at the static load, within the places where
    the static load reaches.

    The rigid rotation, r_bg theta_g, is the accumulated row; the parameter is the torque that holds the mean
    speed [N m]: T_g, or T_p where the brake torque is given.

    Parameters
    ----------
    pair : the gear pair
    friction : mu(xi) in place of that of the pair's law

    Raises
    ------
    ParameterError : a law refuses its parameters
    """
    pair = load_gear_pair(pair)
    cycle = _cycle(pair)
    if friction is not None:
        cycle = MeshCycle(cycle.geometry, replace(cycle.elements, friction=friction))
    base = periodic_system(pair, "feedback", cycle=cycle)
    s, g = base.structure, pair.geometry
    elements = cycle.elements
    phases = cycle.breaks / cycle.period
    middles = 0.5 * (phases[:-1] + phases[1:])
    start = phases[:-1] * g.base_pitch

    def law(function: PathFunction, offset: float) -> FloatArray:
        return _over_phase(function, offset + start, offset + g.base_pitch * middles, g.base_pitch)

    # Acceleration per unit load and per unit friction force, of (q, x_p, x_g) and of r_bg theta_g.
    rows = np.vstack([base.reduction, [0.0, g.base_radius_gear, 0.0, 0.0, 0.0, 0.0]]) / s.mass
    normal, arm = rows @ s.normal, rows @ s.friction_arm
    zeta, mass = pair.mesh.damping_ratio, bodies(pair).effective_mass
    contacts = []
    for offset in cycle.offsets:
        place = offset + g.base_pitch * middles
        k, c, e = (law(f, offset) for f in (elements.stiffness, elements.damping, elements.error))
        mu = law(elements.friction, offset)
        xi = np.stack([offset + start, np.full(start.size, g.base_pitch)], axis=1)
        acceleration = arm[:, 0, None] * mu[:, None, :]
        acceleration = np.pad(acceleration, ((0, 0), (0, 0), (0, 1)))
        acceleration[:, :, :-1] += arm[:, 1, None] * (mu * xi[:, :1])[:, None, :]
        acceleration[:, :, 1:] += arm[:, 1, None] * (mu * xi[:, 1:])[:, None, :]
        acceleration[:, :, 0] += normal
        sign: tuple[npt.ArrayLike, npt.ArrayLike] | None
        if zeta == 0.0:
            sign = (1.0, 0.0)
        elif pair.mesh.contact == "paper":  # k/c = c/(4 zeta^2 m_e)
            sign = (c / (4.0 * zeta**2 * mass), 1.0)
        else:
            sign = None
        contacts.append(
            Contact(
                direction=base.deflection,
                acceleration=acceleration,
                stiffness=k,
                damping=c,
                clearance=e,
                clearance_rate=None
                if elements.gap is None
                else g.base_pitch * law(elements.error_slope, offset),
                sign=sign,
                present=(place >= cycle.start) & (place <= cycle.end),
            )
        )
    given = pair.operating.brake_torque != "balanced"
    lift = np.linalg.pinv(base.reduction)
    torques = rows[:, :2] * [1.0, -1.0]
    known = (
        torques[:, 1] * float(pair.operating.brake_torque) if given else torques[:, 0] * base.pinion_torque
    )
    return ContactSystem(
        stiffness=rows @ np.diag(s.stiffness) @ lift,
        damping=rows @ np.diag(s.damping) @ lift,
        force=known,
        contacts=tuple(contacts),
        phases=phases,
        output=base.deflection,
        parameter_force=torques[:, 0 if given else 1],
    )


def unilateral_family(pair: AnyPair, slowest_rpm: float, fastest_rpm: float) -> Family:
    """Return the unilateral system over its period, for speeds of a range.

    Where friction depends on speed, its law is a weighted sum of two functions of the position wherever it
    can be (`floquet.gear.friction_over_speed`); then only the weights change. Elsewhere it is fitted anew.

    Parameters
    ----------
    pair : the gear pair
    slowest_rpm, fastest_rpm : speeds of the pinion [rpm]
    """
    pair = load_gear_pair(pair)
    if not depends_on_speed(pair):
        system = unilateral_system(pair)
        return Family(lambda period: system, constant=True)
    speeds = np.linspace(slowest_rpm, fastest_rpm, _SPEEDS)
    families = [_Parts(pair, family) for family in friction_families(GearVariation(pair), speeds)]
    cycle_at_1_rpm = pair.geometry.mesh_period * operating_rpm(pair)

    @lru_cache(maxsize=16)
    def at(period: float) -> ContactSystem:
        rpm = cycle_at_1_rpm / period
        for family in families:
            system = family.at(rpm)
            if system is not None:
                return system
        return unilateral_system(pair.with_({"operating.pinion_speed": rpm}))

    return Family(at, constant=False)


class _Parts:
    """The system of a family of speeds, as a sum of what is without friction and of its one or two parts."""

    def __init__(self, pair: GearPair, family: FrictionFamily) -> None:
        self.family = family
        there = pair.with_({"operating.pinion_speed": family.speed_rpm})
        mu = friction_path_function(there, interval=mesh_cycle(there).elements.stiffness.interval)
        steady = _signed(mu, pair.geometry.L_XP, family.level or 0.0)
        parts = [mu] if family.level is None else [_plus(mu, steady, -1.0), steady]
        # Zero times the law, so that all have the same pieces.
        self.without = unilateral_system(there, _plus(parts[0].scaled(0.0), steady, 0.0))
        systems = [self.without, *(unilateral_system(there, _plus(part, steady, 0.0)) for part in parts)]
        width = max(system.acceleration.shape[-1] for system in systems)
        rows = [_widened(system.acceleration, width) for system in systems]
        self.base, self.each = rows[0], [row - rows[0] for row in rows[1:]]

    def at(self, rpm: float) -> ContactSystem | None:
        """The system at a speed; None where the speed is not of the family."""
        factors = self.family.factors_at(np.array([rpm]))
        if factors is None:
            return None
        a = self.base
        for factor, part in zip(factors[0], self.each, strict=True):
            a = a + factor * part
        return self.without.with_acceleration(a)


def _widened(rows: FloatArray, width: int) -> FloatArray:
    return np.pad(rows, [(0, 0)] * (rows.ndim - 1) + [(0, width - rows.shape[-1])])


def _signed(like: PathFunction, pitch_point: float, level: float) -> PathFunction:
    """The level with the sign of xi - L_XP, on the pieces of a law."""
    function = like.split([pitch_point]).scaled(0.0)
    rows = function.coefficients.copy()
    rows[-1] = level * np.sign(0.5 * (function.breaks[:-1] + function.breaks[1:]) - pitch_point)
    return PathFunction(function.breaks, rows, like.switches)


def _plus(one: PathFunction, other: PathFunction, factor: float) -> PathFunction:
    """Return one + factor other."""
    breaks = np.union1d(one.breaks, other.breaks)
    one, other = one.split(breaks), other.split(breaks)
    rows = one.coefficients.copy()
    rows[-other.coefficients.shape[0] :] += factor * other.coefficients[-rows.shape[0] :]
    return PathFunction(one.breaks, rows, np.union1d(one.switches, other.switches))


def _cycle(pair: GearPair) -> MeshCycle:
    """The mesh cycle with clearance for relief; the linear model has the stiffness that statics leave."""
    if pair.mesh.contact == "loaded" or pair.mesh.relief == "ignored":
        return MeshCycle(pair.geometry, mesh_elements(pair))
    raw = mesh_elements(pair.with_(mesh__relief="ignored"))
    return MeshCycle(pair.geometry, replace(raw, error=error_function(pair)))


def _over_phase(function: PathFunction, start: FloatArray, inside: FloatArray, pitch: float) -> FloatArray:
    """Polynomials (P, D + 1) of the phase since the start of each piece, lowest power first; zero outside."""
    breaks, low, high = function.breaks, *function.interval
    piece = np.clip(np.searchsorted(breaks, inside, side="right") - 1, 0, breaks.size - 2)
    rows = shifted(function.coefficients[:, piece], start - breaks[piece])[::-1].T
    rows = np.where(((inside >= low) & (inside <= high))[:, None], rows, 0.0)
    return np.asarray(rows * pitch ** np.arange(rows.shape[1]), dtype=np.float64)
