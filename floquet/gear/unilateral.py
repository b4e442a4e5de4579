"""The gear pair with unilateral contact, as a system that is linear between events.

Sources: docs/theory/orbits.md, "Gear pair".
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

import numpy as np
import numpy.typing as npt

from floquet.gear.axes import (
    FrictionFamily,
    GearVariation,
    depends_on_speed,
    friction_families,
    operating_rpm,
)
from floquet.orbits.branch import Family
from floquet.orbits.system import Contact, ContactSystem
from lumped.model.mesh_cycle import MeshCycle
from lumped.model.periodic_system import LTVSystem
from lumped.path_function import PathFunction, shifted
from lumped.path_of_contact import friction_path_function
from lumped.quasi_static.contacts import contact_of
from lumped.schema.bodies import bodies_of
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray

ContactForm = Literal["mesh", "elastic", "back_side"]

_SPEEDS = 33
#: Shortest piece of a law, as part of a cycle.
_SAME = 1e-13


def unilateral_system(
    pair: GearPair, cycle: MeshCycle | None = None, form: ContactForm = "mesh"
) -> ContactSystem:
    """Return a gear pair on springs with one unilateral contact for each tooth pair.

    A contact carries k (delta - e) + c (delta' - e') where the flanks overlap and this force is positive.
    Relief is clearance e. Friction acts with the nominal sign. Loaded contact has the tangent at the static
    load, within the reach of this tangent. The rigid rotation, r_bg theta_g, is the accumulated row. The
    parameter is the torque that holds the mean speed [N m]: T_g, or T_p where the brake torque is given.

    ``form`` is "mesh", (q, x_p, x_g), whose motion decides the motion of y; "elastic",
    (q, x_p, x_g, y_p, y_g); or "back_side", where back sides touch after the backlash, with the laws of the
    driving flanks. ``cycle`` replaces the element laws of ``contact_cycle``.
    """
    cycle = cycle or contact_cycle(pair)
    base = LTVSystem.of(pair, "mesh" if form == "mesh" else "elastic", cycle=cycle, supports="springs")
    s = base.structure
    g = pair.geometry
    # Acceleration per unit generalised force, of the coordinates and of r_bg theta_g.
    rows = np.vstack([base.reduction, [0.0, g.base_radius_gear, 0.0, 0.0, 0.0, 0.0]]) / s.mass
    phases = cycle.breaks / cycle.period
    acting = rows @ s.normal, rows @ s.friction_arm, rows @ s.apart
    flanks = [_Flank(*acting, base.deflection, 0.0, cycle.offsets, 1.0)]
    if form == "back_side":
        coast = _coast_flank(pair, cycle, rows)
        passes = np.mod((coast.offsets[0] - g.L_XA) / g.base_pitch - cycle.break_phases, 1.0)
        passes = np.sort(passes[(passes > _SAME) & (passes < 1.0 - _SAME)])
        phases = np.union1d(phases, passes)
        phases = phases[np.append(True, np.diff(phases) > _SAME)]
        flanks.append(coast)
    brake = pair.operating.brake_torque
    balanced = brake == "balanced"
    torques = rows[:, :2] * [1.0, -1.0]
    m = len(base.coordinates)
    # No bearing acts on the rotation.
    bearings = np.pad(-base.constant[m:], ((0, 1), (0, 0)))
    return ContactSystem(
        stiffness=bearings[:, :m],
        damping=bearings[:, m:],
        force=torques[:, 0] * base.pinion_torque if balanced else torques[:, 1] * float(brake),
        contacts=tuple(
            _contact(pair, cycle, phases, flank, offset) for flank in flanks for offset in flank.offsets
        ),
        phases=phases,
        output=base.deflection,
        parameter_force=torques[:, 1 if balanced else 0],
    )


@dataclass(frozen=True)
class _Flank:
    """One side of the teeth.

    Attributes
    ----------
    normal : (n,) acceleration per unit load
    arm : (n, 2) acceleration per unit friction force, arm[:, 0] + arm[:, 1] xi
    apart : (n,) acceleration per unit force of a tip corner off the flank's line of action
    direction : (m,) the overlap is direction . z - clearance - e
    clearance : [m]
    offsets : (I,) places xi at t = 0 of all pairs that can touch in the cycle [m]
    way : +1 where contacts run from A to D, -1 from D to A
    """

    normal: FloatArray
    arm: FloatArray
    apart: FloatArray
    direction: FloatArray
    clearance: float
    offsets: FloatArray
    way: float


def _coast_flank(pair: GearPair, cycle: MeshCycle, rows: FloatArray) -> _Flank:
    """The back sides of the teeth.

    The line of action of the back sides is the mirror image of the line of action of the driving flanks. The
    mirror is the line of centres.
    """
    g = pair.geometry
    r_p = g.base_radius_pinion
    r_g = g.base_radius_gear
    # The line of action makes the angle pi - 2 alpha_w with that of the driving flanks.
    angle = np.pi - 2.0 * g.operating_pressure_angle
    x = np.cos(angle)
    y = np.sin(angle)
    normal = np.array([r_p, -r_g, -x, x, -y, y])
    arm = np.array([[0.0, 1.0], [-g.L_XY, 1.0], [y, 0.0], [-y, 0.0], [-x, 0.0], [x, 0.0]])
    thickness = 2.0 * r_p * pair.wheels[0].tooth.base_half_angle
    thickness -= 0.5 * pair.mesh.backlash
    place = thickness + 2.0 * r_p * g.operating_pressure_angle - g.L_XA + 0.5 * g.normal_backlash
    pitch = g.base_pitch
    first = np.ceil((cycle.start - place) / pitch)
    last = np.floor((cycle.end + pitch - place) / pitch)
    return _Flank(
        rows @ normal,
        rows @ arm,
        rows @ np.array([0.0, 0.0, -y, y, x, -x]),
        np.array([-1.0, x, -x, y, -y]),
        g.normal_backlash,
        place + np.arange(first, last + 1) * pitch,
        -1.0,
    )


def _contact(pair: GearPair, cycle: MeshCycle, phases: FloatArray, flank: _Flank, offset: float) -> Contact:
    """One tooth pair, whose element laws are polynomials of the phase."""
    elements = cycle.elements
    pitch = flank.way * pair.geometry.base_pitch
    start = offset + pitch * phases[:-1]
    inside = offset + 0.5 * pitch * (phases[:-1] + phases[1:])

    def law(function: PathFunction) -> FloatArray:
        return _over_phase(function, start, inside, pitch)

    k, c, e = (law(f) for f in (elements.stiffness, elements.damping, elements.error))
    mu = flank.way * law(elements.friction)  # back sides slide in the opposite direction
    rate = None if elements.gap is None else pitch * law(elements.error_slope)
    e[:, 0] += flank.clearance
    xi = np.stack([start, np.full(start.size, pitch)], axis=1)
    # No corner of "mesh" acts on y.
    tilt = law(elements.tilt) if elements.tilt is not None and flank.apart.any() else np.zeros((1, 1))
    width = mu.shape[1]
    acceleration = _widened(flank.arm[:, 0, None] * mu[:, None, :], max(width + 1, tilt.shape[1]))
    acceleration[:, :, :width] += flank.arm[:, 1, None] * (mu * xi[:, :1])[:, None, :]
    acceleration[:, :, 1 : width + 1] += flank.arm[:, 1, None] * (mu * xi[:, 1:])[:, None, :]
    acceleration[:, :, : tilt.shape[1]] += flank.apart[:, None] * tilt[:, None, :]
    acceleration[:, :, 0] += flank.normal
    zeta = pair.mesh.damping_ratio
    sign: tuple[npt.ArrayLike, npt.ArrayLike] | None = None
    if zeta == 0.0:
        sign = (1.0, 0.0)
    elif contact_of(pair).root_damping:  # k/c = c/(4 zeta^2 m_e)
        sign = (c / (4.0 * zeta**2 * bodies_of(pair).effective_mass), 1.0)
    return Contact(
        direction=flank.direction,
        acceleration=acceleration,
        stiffness=k,
        damping=c,
        clearance=e,
        clearance_rate=rate,
        sign=sign,
        present=(inside >= cycle.start) & (inside <= cycle.end),
    )


def unilateral_family(
    pair: GearPair, slowest_rpm: float, fastest_rpm: float, form: ContactForm = "mesh"
) -> Family:
    """Return the unilateral system over its period, for speeds of a range.

    A friction law that depends on speed is a weighted sum of two functions of the position, for all speeds
    for which this form exists (`friction_families`): only the weights change over these speeds. At other
    speeds the law is fitted anew.
    """
    if not depends_on_speed(pair):
        system = unilateral_system(pair, form=form)
        return Family(lambda period: system, constant=True)
    speeds = np.linspace(slowest_rpm, fastest_rpm, _SPEEDS)
    variation = GearVariation(pair, supports="springs")
    families = [_Parts(pair, family, form) for family in friction_families(variation, speeds)]
    cycle_at_1_rpm = pair.geometry.mesh_period * operating_rpm(pair)

    @lru_cache(maxsize=16)
    def at(period: float) -> ContactSystem:
        rpm = cycle_at_1_rpm / period
        for family in families:
            system = family.at(rpm)
            if system is not None:
                return system
        return unilateral_system(pair.with_({"operating.pinion_speed": rpm}), form=form)

    return Family(at, constant=False)


class _Parts:
    """The system of a family of speeds: a system without friction plus parts of the friction law."""

    def __init__(self, pair: GearPair, family: FrictionFamily, form: ContactForm) -> None:
        self.family = family
        there = pair.with_({"operating.pinion_speed": family.speed_rpm})
        mu = friction_path_function(there, interval=MeshCycle.of(there).elements.stiffness.interval)
        steady = _signed(mu, pair.geometry.L_XP, family.level or 0.0)
        parts = [mu] if family.level is None else [_plus(mu, steady, -1.0), steady]
        # Zero times the law, so that all parts have the same pieces.
        cycle = contact_cycle(there)

        def system(mu: PathFunction) -> ContactSystem:
            elements = replace(cycle.elements, friction=_plus(mu, steady, 0.0))
            return unilateral_system(there, MeshCycle(cycle.geometry, elements), form)

        self.without = system(parts[0].scaled(0.0))
        systems = [self.without, *map(system, parts)]
        width = max(system.acceleration.shape[-1] for system in systems)
        rows = [_widened(system.acceleration, width) for system in systems]
        self.base = rows[0]
        self.each = [row - rows[0] for row in rows[1:]]

    def at(self, rpm: float) -> ContactSystem | None:
        """The system at a speed; None: the family does not have the speed."""
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
    breaks = like.split([pitch_point]).breaks
    sign = np.sign(0.5 * (breaks[:-1] + breaks[1:]) - pitch_point)
    return PathFunction(breaks, level * sign[None], like.switches)


def _plus(one: PathFunction, other: PathFunction, factor: float) -> PathFunction:
    """Return one + factor other."""
    breaks = np.union1d(one.breaks, other.breaks)
    one = one.split(breaks)
    other = other.split(breaks)
    rows = one.coefficients.copy()
    rows[-other.coefficients.shape[0] :] += factor * other.coefficients[-rows.shape[0] :]
    return PathFunction(one.breaks, rows, np.union1d(one.switches, other.switches))


def contact_cycle(pair: GearPair) -> MeshCycle:
    """The mesh cycle of unilateral contact, where relief is a clearance.

    In the linear model relief changes the stiffness instead, as statics give it.
    """
    return MeshCycle(pair.geometry, contact_of(pair).unilateral_elements(pair))


def _over_phase(function: PathFunction, start: FloatArray, inside: FloatArray, pitch: float) -> FloatArray:
    """Polynomials (P, D + 1) of the phase since the start of each piece, lowest power first.

    A piece outside the interval of the function is zero.
    """
    breaks = function.breaks
    low, high = function.interval
    piece = np.clip(np.searchsorted(breaks, inside, side="right") - 1, 0, breaks.size - 2)
    rows = shifted(function.coefficients[:, piece], start - breaks[piece])[::-1].T
    rows = np.where(((inside >= low) & (inside <= high))[:, None], rows, 0.0)
    return np.asarray(rows * pitch ** np.arange(rows.shape[1]), dtype=np.float64)
