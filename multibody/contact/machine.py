"""A gear pair turned into the plain numbers that a multibody model needs.

Only the stiffness of a tooth pair and how far it moves the next ones are taken from ``lumped``, and the
coefficient of a friction law that ``multibody.contact.friction`` does not have. Circles, tooth thickness,
reliefs, bodies and bearings are derived here again from the fields of the schema: nothing reads
``pair.geometry`` or ``lumped.bodies``, so that agreement of the two models is evidence for both. Sources: ISO
21771 for the circles; solid discs, elementary.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
from lumped.model.mesh_cycle import MeshCycle
from lumped.path_function import PathFunction
from lumped.path_of_contact import friction_path_function, pair_stiffness
from lumped.path_of_contact.stiffness import contact_softening, cross_compliances
from lumped.quasi_static.contacts import contact_of
from lumped.schema.gear import Gear
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from multibody.contact import friction as fr
from multibody.contact import kinematics as kn
from multibody.contact.elements import stiffness_at
from multibody.contact.events import event_table
from multibody.contact.kinematics import DRIVE, Line, add_wrench, line_of_action, mesh_phase, wrap
from multibody.gears.circles import base_tooth_angle, circles, reliefs
from multibody.gears.own_teeth import (
    DrawnGear,
    drawn_gears,
    fault_places,
    gear_teeth,
    own_faults,
    own_ripples,
)
from multibody.shafts.train import Train, train

Supports = Literal["springs", "shafts"]

#: Where shafts.max_frequency is not given, modes of shafts with their gears held are kept up to so many times
#: the fastest mode of the gears on springs, and to this order of the mesh frequency: the rest changes the
#: transmission error by some thousandths of its peak to peak (docs/theory/shafts.md).
_MESH_FREQUENCIES = 4.0
_MESH_ORDERS = 5.0


@dataclass(frozen=True, eq=False)
class Machine:
    """Two gears in bearings, SI.

    parameters : geometry, nominal motion and friction, in the order of ``kinematics``; behind these
        the lumped model's friction coefficient as rows like ``table``, where this model has no law of its own
    table : stiffness of a tooth pair as ``elements.stiffness_at`` reads it
    mass, inertia : (2,) pinion, gear
    bearing_stiffness, bearing_damping : (2, 2) rows pinion, gear; columns x, y
    torque_pinion, torque_gear : driving and braking torque, both positive
    pairs : slots of tooth pairs, floor(contact ratio) + 1; more where tip corners lengthen the contact
    ahead : whole pitches by which the pair of the first slot is ahead of the one that was at A
    period : mesh cycle
    switches : phases of the mesh cycle in [0, 1) at which the nominal element laws jump or have a kink
    events : (n, 2) what makes the contact force jump or bend in finite motion, see ``events.event_table``
    own : block of teeth that differ, as of ``own_block``; that in the parameters has no ripples on shafts
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
    own: FloatArray
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

    def torques(self, t: FloatArray, q: FloatArray) -> FloatArray:
        """Driving and braking torque (n, 2), ripples at the actual angles of their rotors, at n states."""
        p = self.parameters
        angles = np.zeros((t.size, 6))
        angles[:, [2, 5]] = q[:, [2, 5]] if self.train is None else q @ self.train.torques.T
        found = np.tile([self.torque_pinion, self.torque_gear], (t.size, 1))
        if self.own.size:
            speeds = p[kn.OMEGA_P], p[kn.OMEGA_G]
            found += [kn.ripple_torques(self.own, t[i], angles[i], *speeds) for i in range(t.size)]
        return found

    @cached_property
    def bodies(self) -> FloatArray:
        """Inertia, bearing stiffness and damping, load of (x_p, y_p, phi_p, x_g, y_g, phi_g), rows (4, 6).

        The pinion turns clockwise, so its driving torque is negative; the brake's acts against the gear.
        """
        rows = np.zeros((4, 2, 3))
        rows[0, :, :2] = self.mass[:, None]
        rows[0, :, 2] = self.inertia
        rows[1, :, :2] = self.bearing_stiffness
        rows[2, :, :2] = self.bearing_damping
        rows[3, :, 2] = -self.torque_pinion, -self.torque_gear
        return rows.reshape(4, 6)

    @cached_property
    def vibrations_per_cycle(self) -> float:
        """Swings of the fastest mode in one mesh cycle; on shafts of dampers where they are faster."""
        return self.rates[1] * self.period / (2.0 * np.pi)

    @cached_property
    def rates(self) -> tuple[float, float]:
        """Frequency of the fastest mode, pairs at largest stiffness; largest rate of dampers [rad/s]."""
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

    With the flags ``TIP_CONTACT`` or ``CLEARANCE`` of ``kinematics``, and where teeth of the linear mesh may
    lose contact, the stiffness holds wherever teeth touch; else relief takes it off where the lumped model
    sees no contact. ``cycle`` is the lumped mesh cycle, where it is known.
    """
    drawn, (mass, inertia) = circles(pair), masses(pair)
    bearing_stiffness, bearing_damping = bearing_constants(pair, mass)
    tooth_p = base_tooth_angle(pair, 0, drawn.base_pinion)
    tooth_g = base_tooth_angle(pair, 1, drawn.base_gear)
    relieved = reliefs(pair, drawn)
    loaded = pair.mesh.contact == "loaded"
    parts = flags & kn.LINEAR and flags & kn.CONTACT_LOSS
    whole = loaded or parts or flags & (kn.TIP_CONTACT | kn.CLEARANCE)
    if cycle is None and (not whole or (loaded and flags & kn.LINEAR)):
        cycle = MeshCycle(pair.geometry, contact_of(pair).elements(pair))
    stiffness = pair_stiffness(pair) if whole or cycle is None else cycle.elements.stiffness
    softening = contact_softening(pair)
    coupling = cross_compliances(pair)[: kn.MAX_PAIRS - 1]
    r_p = drawn.base_pinion
    r_g = drawn.base_gear
    pitch = drawn.pitch
    l_xy = drawn.tangent
    tip_p, tip_g = drawn.reach_pinion, drawn.reach_gear
    l_xa = drawn.start
    l_xd = drawn.end
    l_xp = l_xy * r_p / (r_p + r_g)
    omega_p = pair.operating.pinion_speed
    p = np.zeros(kn.N_PARAMETERS)
    p[kn.RADIUS_P] = r_p
    p[kn.RADIUS_G] = r_g
    p[kn.PITCH] = pitch
    p[kn.TIP_P] = tip_p
    p[kn.TIP_G] = tip_g
    p[kn.EDGE_P] = drawn.edge_pinion
    p[kn.EDGE_G] = drawn.edge_gear
    # At t = 0 the line of action is the x axis and one pair touches at A: rho_p = L_XA, rho_g = L_XY - L_XA,
    # so chi_g = pi - rho_g/r_bg, and the flanks are neither apart nor pressed.
    p[kn.CHI_P] = -l_xa / r_p
    # The other flank of the same tooth starts one base tooth thickness further on (see kinematics).
    p[kn.CHI_P_BACK] = p[kn.CHI_P] + math.pi + tooth_p
    chi_g = math.pi + tooth_g - (l_xy - l_xa) / r_g
    p[kn.APART_BACK] = r_p * p[kn.CHI_P_BACK] + r_g * chi_g - l_xy
    p[kn.CENTRE_PY] = -r_p
    p[kn.CENTRE_GX] = l_xy
    p[kn.CENTRE_GY] = r_g
    p[kn.L_XA] = l_xa
    p[kn.L_XP] = l_xp
    p[kn.L_XD] = l_xd
    p[kn.L_XY] = l_xy
    p[kn.OMEGA_P] = omega_p
    p[kn.OMEGA_G] = omega_p * r_p / r_g
    p[kn.T_LOW] = -math.inf
    p[kn.T_HIGH] = math.inf
    p[kn.DAMPING] = 2.0 * pair.mesh.damping_ratio * math.sqrt(_mesh_mass(p, inertia))
    p[kn.SOFTENING] = softening
    p[kn.NOMINAL_FORCE] = pair.operating.pinion_torque / r_p
    p[kn.RELIEFS] = len(relieved)
    p[kn.FIRST_RELIEF : kn.FIRST_RELIEF + kn.RELIEF_COLUMNS * len(relieved)] = np.ravel(relieved)
    for apart, moved in enumerate(coupling):
        first = kn.FIRST_COUPLED + kn.COUPLED_COLUMNS * apart
        p[first : first + kn.COUPLED_COLUMNS] = pack(moved)[0]
        p[kn.COUPLED] = apart + 1
    fr.fill_friction(pair, p)
    friction = fr.friction_switches(p)
    if p[kn.FRICTION + fr.LAW] == fr.TABLE:
        law = friction_path_function(pair, interval=contact_of(pair).elements(pair).stiffness.interval)
        p[kn.FRICTION + fr.COLUMNS] = law.coefficients.shape[0] + 2
        p = np.append(p, pack(law))
        friction = [(True, place) for place in law.switches.tolist()]
    gears = drawn_gears(pair, drawn)
    own = own_block(pair, gears)
    p[kn.OWN] = p.size if own.size else 0.0
    p = np.append(p, own)
    starts = [at * r_p if which == 0.0 else l_xy - at * r_g for which, at, *_ in relieved]
    for gear in gears:
        kinks = [place for fault in gear.section.faults for place in fault_places(gear, fault)]
        starts += [l_xy - place if gear.number else place for place in kinks]
    places = [place for _, place in friction]
    table = pack(stiffness)
    switches = switch_phases([*stiffness.switches, *starts, *places], l_xa, l_xd, pitch)
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
        pairs=math.floor((l_xd - l_xa) / pitch) + 1,
        ahead=math.floor((l_xd - l_xa) / pitch),
        period=pitch / (omega_p * r_p),
        switches=switches,
        events=event_table(stiffness, starts, friction, pitch, corners=bool(flags & kn.TIP_CONTACT)),
        own=own,
    )
    if supports == "springs":
        return found
    if own.size:  # ripples act on motor and load
        p[int(p[kn.OWN]) + kn.OWN_RIPPLES] = 0.0
    none = np.zeros((2, 2))
    shafts = train(pair, mass, inertia, (omega_p, float(p[kn.OMEGA_G])), _highest(found))
    return replace(found, bearing_stiffness=none, bearing_damping=none, train=shafts)


def own_block(pair: GearPair, gears: Sequence[DrawnGear]) -> FloatArray:
    """Teeth that differ, as numbers behind the parameters (see ``kinematics``); empty for like teeth."""
    if pair.healthy is pair:
        return np.zeros(0)
    teeth = [gear_teeth(pair, gear) for gear in gears]
    rows = [(one.eccentricity, one.angle, one.gap.size, one.first) for one in teeth]
    faults = [np.array(fault) for fault in own_faults(pair, gears)]
    ripples = own_ripples(pair, gears)
    lists = [one.gap for one in teeth] + [one.rise for one in teeth] + [one.relief for one in teeth]
    return np.concatenate([np.ravel(rows), [len(faults), len(ripples)], *lists, *faults, np.ravel(ripples)])


def _highest(machine: Machine) -> float:
    """Frequency up to which modes of shafts are kept: above the mesh's own, and its excitation's [Hz]."""
    fast = _MESH_FREQUENCIES * machine.vibrations_per_cycle
    return max(fast, _MESH_ORDERS) / machine.period


def _loaded_laws(cycle: MeshCycle, p: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Table of the lumped loaded contact's laws, one below the other, and its switches as phases."""
    e = cycle.elements
    assert e.gap is not None
    assert e.tilt is not None
    assert e.closing is not None
    laws = [pack(law) for law in (e.stiffness, e.damping, e.error, e.gap, e.tilt, e.closing)]
    p[[kn.K_ROWS, kn.C_ROWS, kn.E_ROWS, kn.GAP_ROWS, kn.TILT_ROWS]] = [len(law) for law in laws[:5]]
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

    Wind-up and bearing deflection move the contact by a constant, which is a choice of the time origin.
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
    stiffness = np.empty((2, 2))
    damping = np.empty((2, 2))
    for row, bearing in enumerate((pair.bearings.pinion, pair.bearings.gear)):
        stiffness[row] = bearing.loa_stiffness, bearing.oloa_stiffness
        ratio = np.array([bearing.loa_damping_ratio, bearing.oloa_damping_ratio])
        damping[row] = 2.0 * ratio * np.sqrt(stiffness[row] * mass[row])
    return stiffness, damping


def _disc(pair: GearPair, gear: Gear) -> tuple[float, float]:
    # diameters
    outer = pair.basic_rack.module * gear.teeth
    inner = gear.bore
    mass = 0.25 * math.pi * (outer**2 - inner**2) * gear.face_width * gear.density
    inertia = math.pi / 32.0 * (outer**4 - inner**4) * gear.face_width * gear.density
    return (mass if gear.mass is None else gear.mass), (inertia if gear.inertia is None else gear.inertia)
