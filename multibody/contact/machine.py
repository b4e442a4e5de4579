"""A gear pair turned into the plain numbers that a multibody model needs.

Only the stiffness of a tooth pair and how far it moves the next ones are taken from ``lumped``, and the
coefficient of a friction law that ``multibody.contact.friction`` does not have. Circles, path of contact,
tooth thickness, bodies, bearings, damping, relief and friction are derived here again from the fields of the
schema: nothing reads ``pair.geometry`` or ``lumped.bodies``, so that agreement of the two models is evidence
for both. Sources: ISO 21771 for the circles; solid discs, elementary.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
from scipy.optimize import brentq

from lumped.lubrication.viscosity import ISO_VG_MIDPOINT, viscosity_at_100
from lumped.model.mesh_cycle import MeshCycle
from lumped.path_function import PathFunction
from lumped.path_of_contact import friction_path_function, pair_stiffness
from lumped.path_of_contact.stiffness import contact_softening, cross_compliances
from lumped.quasi_static.contacts import contact_of
from lumped.schema.contact import Lubricant
from lumped.schema.gear import Gear
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from multibody.contact import friction as fr
from multibody.contact import kernels as kn
from multibody.contact.elements import stiffness_at
from multibody.contact.events import SLIDING, SWITCH, event_table
from multibody.contact.kinematics import DRIVE, MAX_PAIRS, Line, add_wrench, line_of_action, mesh_phase, wrap
from multibody.shafts.train import Train, train

Supports = Literal["springs", "shafts"]

#: Where shafts.max_frequency is not given, modes of shafts with their gears held are kept up to so many times
#: the fastest mode of the gears on springs, and to this order of the mesh frequency: the rest changes the
#: transmission error by some thousandths of its peak to peak (docs/theory/shafts.md).
_MESH_FREQUENCIES, _MESH_ORDERS = 4.0, 5.0


@dataclass(frozen=True, eq=False)
class Machine:
    """Two gears in bearings, SI.

    parameters : geometry, nominal motion and friction, in the order of ``kernels``; behind these the lumped
        model's friction coefficient as rows like ``table``, where the multibody model has no law of its own
    table : stiffness of a tooth pair as ``elements.stiffness_at`` reads it
    mass, inertia : (2,) pinion, gear
    bearing_stiffness, bearing_damping : (2, 2) rows pinion, gear; columns x, y
    torque_pinion, torque_gear : driving and braking torque, both positive
    pairs : slots of tooth pairs, floor(contact ratio) + 1; more where tip corners lengthen the contact
    ahead : whole pitches by which the pair of the first slot is ahead of the one that was at A
    period : mesh cycle
    switches : phases of the mesh cycle in [0, 1) at which the nominal element laws jump or have a kink
    events : (n, 2) what makes the contact force jump or bend in finite motion, see ``events.event_table``
    train : both shafts where these support the gears, whose bearing springs are then zero; else None
    """

    parameters: FloatArray
    table: FloatArray
    mass: FloatArray
    inertia: FloatArray
    bearing_stiffness: FloatArray
    bearing_damping: FloatArray
    torque_pinion: float
    torque_gear: float
    pairs: int
    ahead: int
    period: float
    switches: FloatArray
    events: FloatArray
    train: Train | None = None

    @property
    def size(self) -> int:
        """Number of coordinates; the first six are those of the gears."""
        return 6 if self.train is None else self.train.size

    @cached_property
    def overlap(self) -> FloatArray:
        """Row (6,) that reads the overlap of the driving flanks off small (x_p, y_p, phi_p, x_g, ...) [m]."""
        p = self.parameters
        return np.array([1.0, 0.0, -p[kn.RADIUS_P], -1.0, 0.0, -p[kn.RADIUS_G]])

    @cached_property
    def bodies(self) -> FloatArray:
        """Constant coefficients of the bodies' equations of motion, (4, 6).

        Rows: inertia, bearing stiffness, bearing damping, constant load of the coordinates (x_p, y_p, phi_p,
        x_g, y_g, phi_g). The pinion turns clockwise, so its driving torque is negative; the brake's acts
        against the gear.
        """
        rows = np.zeros((4, 2, 3))
        rows[0, :, :2], rows[0, :, 2] = self.mass[:, None], self.inertia
        rows[1, :, :2], rows[2, :, :2] = self.bearing_stiffness, self.bearing_damping
        rows[3, :, 2] = -self.torque_pinion, -self.torque_gear
        return rows.reshape(4, 6)

    @cached_property
    def vibrations_per_cycle(self) -> float:
        """Swings of the fastest natural mode in one mesh cycle, with every pair at its largest stiffness.

        The mesh acts along the nominal line of action, without friction and damping. On shafts dampers count,
        where they answer faster.
        """
        return self.rates[1] * self.period / (2.0 * np.pi)

    @cached_property
    def rates(self) -> tuple[float, float]:
        """Frequency of the fastest natural mode, and the largest rate that dampers make of it [rad/s]."""
        left, right = self.table[:, 0], self.table[:, 1]
        places = np.concatenate([left, 0.5 * (left + right), right])
        largest = max(abs(stiffness_at(self.table, xi)) for xi in places)
        mesh = self.pairs * largest * np.outer(self.overlap, self.overlap)
        if self.train is None:
            inertia, bearings, _, _ = self.bodies
            squares = np.linalg.eigvalsh((mesh + np.diag(bearings)) / np.sqrt(np.outer(inertia, inertia)))
            return float(np.sqrt(squares[-1])), float(np.sqrt(squares[-1]))
        return self.train.fastest(mesh)


def machine(
    pair: GearPair, flags: int = 0, supports: Supports = "springs", cycle: MeshCycle | None = None
) -> Machine:
    """Describe a gear pair for the multibody model, both torques being that of the pinion.

    With the flags ``TIP_CONTACT`` or ``CLEARANCE`` of ``kernels``, and where teeth of the linear mesh may
    lose contact, the stiffness holds wherever teeth touch; else relief takes it off where the lumped model
    sees no contact. ``cycle`` is the lumped mesh cycle, where it is known.
    """
    drawn, loaded = circles(pair), pair.mesh.contact == "loaded"
    parts = flags & kn.LINEAR and flags & kn.CONTACT_LOSS
    whole = loaded or parts or flags & (kn.TIP_CONTACT | kn.CLEARANCE)
    if cycle is None and (not whole or (loaded and flags & kn.LINEAR)):
        cycle = MeshCycle(pair.geometry, contact_of(pair).elements(pair))
    stiffness = pair_stiffness(pair) if whole or cycle is None else cycle.elements.stiffness
    r_p, r_g, pitch, l_xy = drawn.base_pinion, drawn.base_gear, drawn.pitch, drawn.tangent
    tip_p, tip_g = drawn.reach_pinion, drawn.reach_gear
    l_xa, l_xp = l_xy - tip_g, l_xy * r_p / (r_p + r_g)
    omega_p = pair.operating.pinion_speed
    p = np.zeros(kn.N_PARAMETERS)
    p[kn.RADIUS_P], p[kn.RADIUS_G], p[kn.PITCH] = r_p, r_g, pitch
    p[kn.TIP_P], p[kn.TIP_G] = tip_p, tip_g
    # At t = 0 the line of action is the x axis and one pair touches at A: rho_p = L_XA, rho_g = L_XY - L_XA,
    # so chi_g = pi - rho_g/r_bg, and the flanks are neither apart nor pressed.
    p[kn.CHI_P] = -l_xa / r_p
    # The other flank of the same tooth starts one base tooth thickness further on (see kinematics).
    p[kn.CHI_P_BACK] = p[kn.CHI_P] + math.pi + base_tooth_angle(pair, pair.pinion, r_p)
    chi_g = math.pi + base_tooth_angle(pair, pair.gear, r_g) - tip_g / r_g
    p[kn.APART_BACK] = r_p * p[kn.CHI_P_BACK] + r_g * chi_g - l_xy
    p[kn.CENTRE_PY], p[kn.CENTRE_GX], p[kn.CENTRE_GY] = -r_p, l_xy, r_g
    p[kn.L_XA], p[kn.L_XP], p[kn.L_XD], p[kn.L_XY] = l_xa, l_xp, tip_p, l_xy
    p[kn.OMEGA_P], p[kn.OMEGA_G] = omega_p, omega_p * r_p / r_g
    p[kn.T_LOW], p[kn.T_HIGH] = -math.inf, math.inf
    mass, inertia = masses(pair)
    p[kn.DAMPING] = 2.0 * pair.mesh.damping_ratio * math.sqrt(_mesh_mass(p, inertia))
    p[kn.SOFTENING] = contact_softening(pair)
    p[kn.NOMINAL_FORCE] = pair.operating.pinion_torque / r_p
    relieved = reliefs(pair, drawn)
    p[kn.RELIEFS] = len(relieved)
    p[kn.FIRST_RELIEF : kn.FIRST_RELIEF + kn.RELIEF_COLUMNS * len(relieved)] = np.ravel(relieved)
    for apart, moved in enumerate(cross_compliances(pair)[: MAX_PAIRS - 1]):
        first = kn.FIRST_COUPLED + kn.COUPLED_COLUMNS * apart
        p[first : first + kn.COUPLED_COLUMNS] = pack(moved)[0]
        p[kn.COUPLED] = apart + 1
    fill_friction(pair, p)
    friction = friction_switches(p)
    if p[kn.FRICTION + fr.LAW] == fr.TABLE:
        law = friction_path_function(pair, interval=contact_of(pair).elements(pair).stiffness.interval)
        p[kn.FRICTION + fr.COLUMNS] = law.coefficients.shape[0] + 2
        p = np.append(p, pack(law))
        friction = [(SLIDING, place) for place in law.switches.tolist()]
    starts = [at * r_p if which == 0.0 else l_xy - at * r_g for which, at, *_ in relieved]
    places = [place for _, place in friction]
    bearing_stiffness, bearing_damping = bearing_constants(pair, mass)
    table = pack(stiffness)
    switches = switch_phases([*stiffness.switches, *starts, *places], l_xa, tip_p, pitch)
    if loaded and flags & kn.LINEAR and cycle is not None:
        table, switches = _loaded_laws(cycle, p)
    found = Machine(
        parameters=p,
        table=table,
        mass=mass,
        inertia=inertia,
        bearing_stiffness=bearing_stiffness,
        bearing_damping=bearing_damping,
        torque_pinion=pair.operating.pinion_torque,
        torque_gear=pair.operating.pinion_torque,
        pairs=math.floor((tip_p - l_xa) / pitch) + 1,
        ahead=math.floor((tip_p - l_xa) / pitch),
        period=pitch / (omega_p * r_p),
        switches=switches,
        events=event_table(
            stiffness,
            starts,
            friction,
            pitch,
            corners=bool(flags & kn.TIP_CONTACT),
        ),
    )
    if supports == "springs":
        return found
    none = np.zeros((2, 2))
    shafts = train(pair, mass, inertia, (omega_p, float(p[kn.OMEGA_G])), _highest(found))
    return replace(found, bearing_stiffness=none, bearing_damping=none, train=shafts)


def _highest(machine: Machine) -> float:
    """Frequency up to which modes of shafts are kept: above the mesh's own, and its excitation's [Hz]."""
    fast = _MESH_FREQUENCIES * machine.vibrations_per_cycle
    return max(fast, _MESH_ORDERS) / machine.period


def _loaded_laws(cycle: MeshCycle, p: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Table of the lumped loaded contact's k, c, e and gap, one below the other, and its switches as phases.

    The linear mesh with loaded contact checks the equations alone: it reads the lumped element laws.
    """
    e = cycle.elements
    laws = [pack(law) for law in (e.stiffness, e.damping, e.error, e.error if e.gap is None else e.gap)]
    p[[kn.K_ROWS, kn.C_ROWS, kn.E_ROWS]] = [len(law) for law in laws[:3]]
    width = max(law.shape[1] for law in laws)
    # Coefficients stand behind both ends, highest power first: pad between them.
    rows = [np.insert(law, [2] * (width - law.shape[1]), 0.0, axis=1) for law in laws]
    return np.ascontiguousarray(np.concatenate(rows)), cycle.edges[:-1] / cycle.period


def _mesh_mass(p: FloatArray, inertia: FloatArray) -> float:
    """Mass that the rotations oppose to the mesh [kg], from the moments of a unit contact force."""
    wrench = np.zeros(6)
    line = Line(1.0, 0.0, float(p[kn.L_XY]), DRIVE, float(p[kn.RADIUS_P]), float(p[kn.RADIUS_G]))
    add_wrench(wrench, line, 1.0, 0.0, 0.0, 0.0)
    return float(1.0 / np.sum(wrench[[2, 5]] ** 2 / inertia))


def loaded_phase(machine: Machine, flags: int, q: FloatArray) -> Machine:
    """Turn the unloaded gears so that it is the loaded pair, in its static state q, that is at A at t = 0.

    Wind-up and bearing deflection move the contact along the path, by a constant in the mean. The rigid
    rotation of a free gear train is arbitrary, so that constant is no difference between models but a
    choice of the time origin; it is taken out.
    """
    p = machine.parameters.copy()
    along, off = (q[3] - q[0], q[4] - q[1]) if flags & kn.MOVING_LINE else (0.0, 0.0)
    phi_p, phi_g = (q[2], q[5]) if flags & kn.ROTATION_PHASE else (0.0, 0.0)
    _, _, grown, psi = line_of_action(along, off, p[kn.L_XY], p[kn.RADIUS_P] + p[kn.RADIUS_G], DRIVE)
    radii = (p[kn.RADIUS_P], p[kn.RADIUS_G])
    first, beyond = mesh_phase(
        psi, grown, phi_p, phi_g, 0.0, *radii, p[kn.PITCH], p[kn.CHI_P], p[kn.APART], DRIVE
    )
    moved = wrap(first - 0.5 * (grown + beyond) - p[kn.L_XA], p[kn.PITCH])
    # rho_p falls and rho_g grows by what the contact has moved; the overlap stays.
    p[[kn.CHI_P, kn.CHI_P_BACK]] += moved / radii[0]
    return replace(machine, parameters=p)


def pack(law: PathFunction) -> FloatArray:
    """A piecewise polynomial as rows (left, right, coefficients), for ``elements.stiffness_at``."""
    return np.ascontiguousarray(np.column_stack([law.breaks[:-1], law.breaks[1:], law.coefficients.T]))


def switch_phases(places: Sequence[float], l_xa: float, l_xd: float, pitch: float) -> FloatArray:
    """Phases of the nominal mesh cycle in [0, 1) where a pair meets a jump or a kink; 0 is always one."""
    ends_and_places = np.array([l_xa, l_xd, *places])
    phases = np.sort(np.mod((ends_and_places - l_xa) / pitch, 1.0))
    # Places that differ by rounding (or by a whole pitch) are one event.
    keep = np.diff(phases, prepend=-1.0) > 1e-11
    phases = phases[keep]
    return phases[phases < 1.0 - 1e-11]


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
    f[fr.PRESSURE_K], f[fr.PRESSURE_S] = (
        pair.lubricant.pressure_viscosity_k,
        pair.lubricant.pressure_viscosity_s,
    )
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
    """Where the coefficient of the nominal motion jumps or has a kink: (kind of ``events``, place [m]).

    The sign at the pitch point and the bounds of law II are met at a sliding velocity; law V changes over at
    a position, because the film hardly depends on sliding.
    """
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


def _iso_14179(p: FloatArray) -> float:
    """Mean coefficient of ISO/TR 14179-2, eta in mPa s, Ra in um: w/(v rho) is N/mm over m/s and mm there."""
    f, tangent = p[kn.FRICTION :], p[kn.L_XP]
    rolling = 2.0 * p[kn.OMEGA_P] * tangent
    radius = 1e3 * fr.reduced_radius(tangent, p[kn.L_XY] - tangent)
    ratio = 1e-3 * f[fr.NOMINAL_LOAD] / (rolling * radius)
    oil = (1e3 * f[fr.VISCOSITY]) ** -0.05 * (1e6 * f[fr.ROUGHNESS]) ** 0.25
    return float(0.048 * ratio**0.2 * oil)


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
            mu = [abs(kn.nominal_friction(q, q[kn.L_XP] + side * x)) for x in d]
            total += 0.5 * (high - low) * float(np.sum(_WEIGHTS * mu * d))
        total += _CLOSEST * abs(kn.nominal_friction(q, q[kn.L_XP] + side * _CLOSEST))
    return total / float(q[kn.L_XD] - q[kn.L_XA])


#: Largest operating pressure angle that is looked for [rad].
_STEEPEST = 1.4


@dataclass(frozen=True)
class Circles:
    """Circles and path of contact of a pair: base radii, base pitch, tip radii, centre distance [m]."""

    base_pinion: float
    base_gear: float
    pitch: float
    tip_pinion: float
    tip_gear: float
    centre_distance: float

    @property
    def reach_pinion(self) -> float:
        """Length on the pinion's base tangent from X to its tip circle: L_XD."""
        return math.sqrt(self.tip_pinion**2 - self.base_pinion**2)

    @property
    def reach_gear(self) -> float:
        """Length on the gear's base tangent from Y to its tip circle: L_XY - L_XA."""
        return math.sqrt(self.tip_gear**2 - self.base_gear**2)

    @property
    def tangent(self) -> float:
        """Length L_XY of the line of action between the base circles."""
        return math.sqrt(self.centre_distance**2 - (self.base_pinion + self.base_gear) ** 2)


def circles(pair: GearPair) -> Circles:
    """Circles of a pair."""
    rack = pair.basic_rack
    cosine = math.cos(rack.pressure_angle)
    r_p, r_g = (0.5 * rack.module * gear.teeth * cosine for gear in (pair.pinion, pair.gear))
    centre = pair.centre_distance
    return Circles(
        base_pinion=r_p,
        base_gear=r_g,
        pitch=math.pi * rack.module * cosine,
        tip_pinion=_tip_radius(pair, pair.pinion),
        tip_gear=_tip_radius(pair, pair.gear),
        centre_distance=_close_mesh(pair, r_p + r_g) if centre is None else centre,
    )


def masses(pair: GearPair) -> tuple[FloatArray, FloatArray]:
    """Masses [kg] and polar inertias [kg m^2] of pinion and gear, each (2,).

    Given values are taken; a body without is a disc of the reference diameter with the gear's own face width
    and bore, as the schema says.
    """
    bodies = [_disc(pair, gear) for gear in (pair.pinion, pair.gear)]
    return np.array([mass for mass, _ in bodies]), np.array([inertia for _, inertia in bodies])


def bearing_constants(pair: GearPair, mass: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Stiffness [N/m] and damping [N s/m] of the bearings, each (2, 2): rows pinion, gear; columns x, y.

    x is along the line of action and y off it; d = 2 zeta sqrt(k m) is the damping of one mass on one spring.
    """
    stiffness, damping = np.empty((2, 2)), np.empty((2, 2))
    for row, bearing in enumerate((pair.bearings.pinion, pair.bearings.gear)):
        stiffness[row] = bearing.loa_stiffness, bearing.oloa_stiffness
        ratio = np.array([bearing.loa_damping_ratio, bearing.oloa_damping_ratio])
        damping[row] = 2.0 * ratio * np.sqrt(stiffness[row] * mass[row])
    return stiffness, damping


def reliefs(pair: GearPair, drawn: Circles) -> list[tuple[float, float, float, float, float]]:
    """Reliefs that act: gear (0 pinion, 1 gear), roll angles of start and end [rad], amount [m], power.

    A tip relief ends at the tip, a root relief where the mate's tip touches last. Without
    ``mesh.relief = "static"`` none acts.
    """
    rows = []
    for which, gear, base, tip, mate in (
        (0.0, pair.pinion, drawn.base_pinion, drawn.reach_pinion, drawn.reach_gear),
        (1.0, pair.gear, drawn.base_gear, drawn.reach_gear, drawn.reach_pinion),
    ):
        for relief, end in ((gear.tip_relief, tip), (gear.root_relief, drawn.tangent - mate)):
            if pair.mesh.relief == "static" and relief is not None and relief.amount != 0.0:
                power = 1.0 if relief.shape == "linear" else 2.0
                rows.append((which, relief.start_roll_angle, end / base, relief.amount, power))
    return rows


def base_tooth_angle(pair: GearPair, gear: Gear, base: float) -> float:
    """Angle between both flanks of a tooth on the base circle, thinned by its share of the backlash [rad]."""
    rack = pair.basic_rack
    alpha = rack.pressure_angle
    at_reference = (0.5 * math.pi + 2.0 * gear.profile_shift * math.tan(alpha)) / (0.5 * gear.teeth)
    return at_reference + 2.0 * (math.tan(alpha) - alpha) - 0.5 * pair.mesh.backlash / base


def _tip_radius(pair: GearPair, gear: Gear) -> float:
    if gear.tip_diameter is not None:
        return gear.tip_diameter / 2.0
    module, addendum = pair.basic_rack.module, gear.addendum
    if addendum is None:
        addendum = (pair.basic_rack.addendum_coefficient + gear.profile_shift) * module
    return module * gear.teeth / 2.0 + addendum


def _close_mesh(pair: GearPair, base: float) -> float:
    """Centre distance at which the teeth, as the rack cuts them, mesh without backlash [m]."""
    alpha, teeth = pair.basic_rack.pressure_angle, pair.pinion.teeth + pair.gear.teeth
    shift = pair.pinion.profile_shift + pair.gear.profile_shift

    def gap(angle: float) -> float:
        grown = (math.tan(angle) - angle) - (math.tan(alpha) - alpha)
        return grown - 2.0 * shift / teeth * math.tan(alpha)

    if shift == 0.0:
        return base / math.cos(alpha)
    return base / math.cos(float(brentq(gap, 0.0, _STEEPEST, xtol=1e-15, rtol=1e-14)))


def _disc(pair: GearPair, gear: Gear) -> tuple[float, float]:
    outer, inner = pair.basic_rack.module * gear.teeth, gear.bore  # diameters
    mass = 0.25 * math.pi * (outer**2 - inner**2) * gear.face_width * gear.density
    inertia = math.pi / 32.0 * (outer**4 - inner**4) * gear.face_width * gear.density
    return (
        mass if gear.mass is None else gear.mass,
        inertia if gear.inertia is None else gear.inertia,
    )
