"""A gear pair as the numbers that the multibody model needs.

Circles, tooth thickness, reliefs, masses, inertias and bearings are derived here from the fields of the
schema: nothing reads ``pair.geometry`` for them, so that the agreement of the two models is evidence for
both. ``lumped`` supplies the stiffness of a tooth pair, the softening of the stiffness by the load, and the
motion of a pair by the loads of its neighbours. ``lumped`` also supplies the coefficient of a friction law
for which ``multibody.contact.friction`` has no formula. A mesh with prescribed contact takes the stiffness
from the lumped mesh cycle, where relief ends contact. A linear mesh with loaded contact takes all its laws
and switches from the lumped mesh cycle. docs/contributing/decisions.md, section 1, lists what is shared.

Sources: ISO 21771 for the circles; solid discs, elementary.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np

from lumped.model.mesh_cycle import MeshCycle
from lumped.path_function import PathFunction
from lumped.path_of_contact import friction_path_function, pair_stiffness
from lumped.path_of_contact.stiffness import contact_softening, cross_compliances
from lumped.quasi_static.contacts import contact_of
from lumped.schema.gear import Gear
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from multibody.contact.elements import table_value
from multibody.contact.events import event_table
from multibody.contact.friction import TABLE, FrictionSwitch, fill_friction, friction_switches
from multibody.contact.kinematics import (
    CLEARANCE,
    CONTACT_LOSS,
    DRIVE,
    LINEAR,
    MOVING_LINE,
    ROTATION_PHASE,
    TIP_CONTACT,
    Line,
    Turn,
    add_wrench,
    line_of_action,
    mesh_phase,
    side_of,
    wrap,
)
from multibody.contact.records import (
    BODY,
    FAULT,
    LINEAR_BLOCKS,
    MACHINE_SIZE,
    MAX_PAIRS,
    PHI_G,
    PHI_P,
    RIPPLE,
    TOOTH,
    X_G,
    X_P,
    Y_G,
    Y_P,
    Record,
    Records,
    opened,
    opened_table,
    with_blocks,
)
from multibody.contact.tooth_pairs import ripple_torques
from multibody.gears.circles import Circles, Relieved, base_tooth_angle, circles, reliefs
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


class FastestRates(NamedTuple):
    """The fastest that the machine moves [rad/s].

    natural : frequency of the fastest mode, pairs at their largest stiffness
    damped : largest rate of a root with dampers
    """

    natural: float
    damped: float


@dataclass(frozen=True, eq=False)
class Machine:
    """Two gears in bearings, SI.

    packed : the numbers of ``multibody.contact.records`` in one flat array, for compiled code
    mass, inertia : (2,) pinion, gear
    bearing_stiffness, bearing_damping : (2, 2) rows pinion, gear; columns x, y
    torque_pinion, torque_gear : driving and braking torque, both positive
    pairs : slots of tooth pairs, floor(contact ratio) + 1; more where tip corners lengthen the contact
    ahead : whole pitches by which the pair of the first slot is ahead of the one that was at A
    period : mesh cycle
    switches : phases of the mesh cycle in [0, 1) at which the nominal element laws jump or have a kink
    events : EVENT (n,) of what makes the contact force jump or bend in finite motion
    train : both shafts where these support the gears, whose bearing springs are then zero; else None
    """

    packed: FloatArray
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
    events: Records
    train: Train | None = None

    @property
    def record(self) -> Record:
        """The MACHINE record of ``packed``; what is written into it is written there."""
        return opened(self.packed)

    @property
    def stiffness_table(self) -> FloatArray:
        """Stiffness of a tooth pair as ``elements.table_value`` reads it."""
        return np.asarray(opened_table(self.packed, self.record.blocks.stiffness))

    @property
    def base_radii(self) -> FloatArray:
        """Base radii of pinion and gear (2,) [m]."""
        geometry = self.record.geometry
        return np.array([geometry.radius_p, geometry.radius_g])

    @property
    def has_ripples(self) -> bool:
        """Whether the torques have ripples."""
        return bool(self.record.blocks.ripples.rows)

    @property
    def size(self) -> int:
        """Number of coordinates; the first six are those of the gears."""
        return 6 if self.train is None else self.train.size

    @cached_property
    def overlap(self) -> FloatArray:
        """Row (6,) that reads the overlap of the driving flanks off small (x_p, y_p, phi_p, x_g, ...) [m]."""
        radius_p, radius_g = self.base_radii
        return np.array([1.0, 0.0, -radius_p, -1.0, 0.0, -radius_g])

    def torques(self, t: FloatArray, q: FloatArray) -> FloatArray:
        """Driving and braking torque (n, 2), ripples at the actual angles of their rotors, at n states."""
        angles = np.zeros((t.size, 6))
        rotors = [PHI_P, PHI_G]
        angles[:, rotors] = q[:, rotors] if self.train is None else q @ self.train.torques.T
        torques = np.tile([self.torque_pinion, self.torque_gear], (t.size, 1))
        if self.has_ripples:
            torques += [ripple_torques(self.packed, t[i], angles[i]) for i in range(t.size)]
        return torques

    @cached_property
    def bodies(self) -> Records:
        """BODY (6,) of (x_p, y_p, phi_p, x_g, y_g, phi_g).

        The pinion turns clockwise, so its driving torque is negative; the brake's acts against the gear.
        """
        bodies = np.zeros(6, BODY)
        centres = [X_P, Y_P, X_G, Y_G]
        rotations = [PHI_P, PHI_G]
        bodies["inertia"][centres] = np.repeat(self.mass, 2)
        bodies["inertia"][rotations] = self.inertia
        bodies["stiffness"][centres] = self.bearing_stiffness.ravel()
        bodies["damping"][centres] = self.bearing_damping.ravel()
        bodies["load"][rotations] = -self.torque_pinion, -self.torque_gear
        return bodies

    @property
    def piece_ends(self) -> FloatArray:
        """Positions xi at which polynomials of the laws of the linear mesh meet or end [m]."""
        blocks = self.record.blocks
        laws = [opened_table(self.packed, blocks[name]) for name in ("stiffness", *LINEAR_BLOCKS)]
        return np.unique(np.concatenate([law[:, :2].ravel() for law in laws]))

    @cached_property
    def vibrations_per_cycle(self) -> float:
        """Swings of the fastest mode in one mesh cycle; on shafts of dampers where they are faster."""
        return self.rates.damped * self.period / (2.0 * np.pi)

    @cached_property
    def rates(self) -> FastestRates:
        """The fastest that the machine moves."""
        table = self.stiffness_table
        starts = table[:, 0]
        ends = table[:, 1]
        places = np.concatenate([starts, 0.5 * (starts + ends), ends])
        largest = max(abs(table_value(table, xi)) for xi in places)
        mesh = self.pairs * largest * np.outer(self.overlap, self.overlap)
        if self.train is None:
            inertia = self.bodies["inertia"]
            matrix = (mesh + np.diag(self.bodies["stiffness"])) / np.sqrt(np.outer(inertia, inertia))
            natural = float(np.sqrt(np.linalg.eigvalsh(matrix)[-1]))
            return FastestRates(natural, natural)
        return FastestRates(*self.train.fastest(mesh))


def machine(
    pair: GearPair, flags: int = 0, supports: Supports = "springs", cycle: MeshCycle | None = None
) -> Machine:
    """Describe a gear pair for the multibody model, both torques being that of the pinion.

    With the flags ``TIP_CONTACT`` or ``CLEARANCE`` of ``kinematics``, and where teeth of the linear mesh may
    lose contact, the stiffness holds wherever teeth touch; else relief takes it off where the lumped model
    sees no contact. ``cycle`` is the lumped mesh cycle, where it is known.
    """
    drawn = circles(pair)
    gears = drawn_gears(pair, drawn)
    mass, inertia = masses(pair)
    bearing_stiffness, bearing_damping = bearing_constants(pair, mass)
    loaded = pair.mesh.contact == "loaded"
    linear_loss = flags & LINEAR and flags & CONTACT_LOSS
    where_teeth_touch = loaded or linear_loss or flags & (TIP_CONTACT | CLEARANCE)
    if cycle is None and (not where_teeth_touch or (loaded and flags & LINEAR)):
        cycle = MeshCycle(pair.geometry, contact_of(pair).elements(pair))
    stiffness = pair_stiffness(pair) if where_teeth_touch or cycle is None else cycle.elements.stiffness

    packed = np.zeros(MACHINE_SIZE)
    record = opened(packed)
    _set_geometry(record.geometry, drawn)
    _set_rolling(pair, record, drawn)
    record.pair_law.damping = 2.0 * pair.mesh.damping_ratio * math.sqrt(_mesh_mass(drawn, inertia))
    record.pair_law.softening = contact_softening(pair)
    record.pair_law.nominal_force = pair.operating.pinion_torque / drawn.base_pinion
    _set_couplings(pair, record)
    relieved = reliefs(pair, drawn)
    for number, relief in enumerate(relieved):
        record["reliefs"][number] = relief
    record.relief_count = len(relieved)
    fill_friction(pair, packed)
    friction = friction_switches(packed)
    blocks: dict[str, FloatArray | Records] = {"stiffness": pack(stiffness)}
    if record.friction.law == TABLE:
        law = friction_path_function(pair, interval=contact_of(pair).elements(pair).stiffness.interval)
        blocks["friction"] = pack(law)
        friction = [FrictionSwitch(True, place) for place in law.switches.tolist()]
    blocks |= _own_blocks(pair, gears, record)

    starts = _bends(drawn, relieved, gears)
    places = [switch.place for switch in friction]
    switches = switch_phases([*stiffness.switches, *starts, *places], drawn.start, drawn.end, drawn.pitch)
    if loaded and flags & LINEAR and cycle is not None:
        blocks |= _loaded_laws(cycle)
        switches = cycle.edges[:-1] / cycle.period
    packed = with_blocks(packed, blocks)
    pitches = math.floor((drawn.end - drawn.start) / drawn.pitch)
    on_springs = Machine(
        packed=packed,
        mass=mass,
        inertia=inertia,
        bearing_stiffness=bearing_stiffness,
        bearing_damping=bearing_damping,
        torque_pinion=pair.operating.pinion_torque,
        torque_gear=pair.operating.pinion_torque,
        pairs=pitches + 1,
        ahead=pitches,
        period=drawn.pitch / (pair.operating.pinion_speed * drawn.base_pinion),
        switches=switches,
        events=event_table(stiffness, starts, friction, drawn.pitch, corners=bool(flags & TIP_CONTACT)),
    )
    return on_springs if supports == "springs" else _on_shafts(pair, on_springs)


def _on_shafts(pair: GearPair, on_springs: Machine) -> Machine:
    """The machine with its gears on shafts. Ripples act on motor and load, and not on the gears."""
    none = np.zeros((2, 2))
    rolling = on_springs.record.rolling
    speeds = (float(rolling.omega_p), float(rolling.omega_g))
    shafts = train(pair, on_springs.mass, on_springs.inertia, speeds, _highest(on_springs))
    packed = on_springs.packed.copy()
    opened(packed).ripples_on_gears = 0
    return replace(on_springs, packed=packed, bearing_stiffness=none, bearing_damping=none, train=shafts)


def _set_geometry(geometry: Record, drawn: Circles) -> None:
    """Write the GEOMETRY record. At t = 0 the line of action is the x axis, X at the origin."""
    r_p = drawn.base_pinion
    r_g = drawn.base_gear
    geometry.radius_p = r_p
    geometry.radius_g = r_g
    geometry.pitch = drawn.pitch
    geometry.tip_p = drawn.reach_pinion
    geometry.tip_g = drawn.reach_gear
    geometry.edge_p = drawn.edge_pinion
    geometry.edge_g = drawn.edge_gear
    geometry.L_XA = drawn.start
    geometry.L_XP = drawn.tangent * r_p / (r_p + r_g)
    geometry.L_XD = drawn.end
    geometry.L_XY = drawn.tangent
    geometry.centre_p_y = -r_p
    geometry.centre_g_x = drawn.tangent
    geometry.centre_g_y = r_g


def _set_rolling(pair: GearPair, record: Record, drawn: Circles) -> None:
    """Write the ROLLING record: speeds, and where the flanks stand at t = 0.

    Then one pair touches at A: rho_p = L_XA, rho_g = L_XY - L_XA, so chi_g = pi - rho_g/r_bg, and the flanks
    are neither apart nor pressed. The other flank of the same tooth starts one base tooth thickness further
    on.
    """
    rolling = record.rolling
    r_p = drawn.base_pinion
    r_g = drawn.base_gear
    omega_p = pair.operating.pinion_speed
    rolling.omega_p = omega_p
    rolling.omega_g = omega_p * r_p / r_g
    rolling.earliest = -math.inf
    rolling.latest = math.inf
    rolling.chi_drive = -drawn.start / r_p
    rolling.chi_coast = rolling.chi_drive + math.pi + base_tooth_angle(pair, 0, r_p)
    chi_g = math.pi + base_tooth_angle(pair, 1, r_g) - (drawn.tangent - drawn.start) / r_g
    rolling.apart_coast = r_p * rolling.chi_coast + r_g * chi_g - drawn.tangent


def _set_couplings(pair: GearPair, record: Record) -> None:
    """Write how far the load of a pair moves pairs 1, 2, ... pitches apart."""
    compliances = cross_compliances(pair)[: MAX_PAIRS - 1]
    for apart, compliance in enumerate(compliances):
        record["couplings"][apart] = pack(compliance)[0]
    record.coupling_count = len(compliances)


def _own_blocks(
    pair: GearPair, gears: Sequence[DrawnGear], record: Record
) -> dict[str, FloatArray | Records]:
    """Blocks of teeth that differ, and their mountings in the MACHINE record; none for like teeth."""
    if pair.healthy is pair:
        return {}
    record.own_teeth = 1
    record.ripples_on_gears = 1
    blocks: dict[str, FloatArray | Records] = {}
    for gear, name in zip(gears, ("teeth_p", "teeth_g"), strict=True):
        teeth = gear_teeth(pair, gear)
        record["mountings"][gear.number] = (teeth.eccentricity, teeth.angle, teeth.first)
        rows = np.zeros(teeth.gap.size, TOOTH)
        rows["error"] = teeth.gap
        rows["rise"] = teeth.rise
        rows["relief"] = teeth.relief
        blocks[name] = rows
    blocks["faults"] = np.array(own_faults(pair, gears), dtype=FAULT)
    blocks["ripples"] = np.array(own_ripples(pair, gears), dtype=RIPPLE)
    return blocks


def _bends(drawn: Circles, relieved: Sequence[Relieved], gears: Sequence[DrawnGear]) -> list[float]:
    """Positions xi at which a relief starts, or a fault of a tooth makes a law jump [m]."""
    lengths = [(relief.gear, relief.start * gears[relief.gear].base_radius) for relief in relieved]
    lengths += [
        (gear.number, place)
        for gear in gears
        for fault in gear.section.faults
        for place in fault_places(gear, fault)
    ]
    return [drawn.tangent - length if gear else length for gear, length in lengths]


def _highest(machine: Machine) -> float:
    """Frequency up to which modes of shafts are kept: above the mesh's own, and its excitation's [Hz]."""
    fast = _MESH_FREQUENCIES * machine.vibrations_per_cycle
    return max(fast, _MESH_ORDERS) / machine.period


def _loaded_laws(cycle: MeshCycle) -> dict[str, FloatArray | Records]:
    """Tables of the laws of the lumped loaded contact, by their blocks."""
    e = cycle.elements
    assert e.gap is not None
    assert e.tilt is not None
    assert e.closing is not None
    laws = (e.damping, e.error, e.gap, e.tilt, e.closing)
    tables: dict[str, FloatArray | Records] = {
        name: pack(law) for name, law in zip(LINEAR_BLOCKS, laws, strict=True)
    }
    return tables | {"stiffness": pack(e.stiffness)}


def _mesh_mass(drawn: Circles, inertia: FloatArray) -> float:
    """Mass that the rotations oppose to the mesh [kg], from the moments of a unit contact force."""
    wrench = np.zeros(6)
    line = Line(1.0, 0.0, drawn.tangent, DRIVE, drawn.base_pinion, drawn.base_gear)
    add_wrench(wrench, line, 1.0, 0.0, 0.0, 0.0)
    return float(1.0 / np.sum(wrench[[PHI_P, PHI_G]] ** 2 / inertia))


def loaded_phase(machine: Machine, flags: int, q: FloatArray) -> Machine:
    """Turn the unloaded gears so that it is the loaded pair, in its static state q, that is at A at t = 0.

    Wind-up and bearing deflection move the contact by a constant, which is a choice of the time origin.
    """
    packed = machine.packed.copy()
    record = opened(packed)
    side = side_of(record, DRIVE)
    along, off = (q[X_G] - q[X_P], q[Y_G] - q[Y_P]) if flags & MOVING_LINE else (0.0, 0.0)
    phi_p, phi_g = (q[PHI_P], q[PHI_G]) if flags & ROTATION_PHASE else (0.0, 0.0)
    base_sum = side.radius_p + side.radius_g
    _, _, grown, psi = line_of_action(along, off, float(record.geometry.L_XY), base_sum, DRIVE)
    first, excess = mesh_phase(side, Turn(psi, grown, phi_p, phi_g, 0.0))
    shift = wrap(first - 0.5 * (grown + excess) - record.geometry.L_XA, side.pitch)
    # rho_p falls and rho_g grows by the shift of the contact; the overlap stays.
    record.rolling.chi_drive += shift / side.radius_p
    record.rolling.chi_coast += shift / side.radius_p
    return replace(machine, packed=packed)


def pack(law: PathFunction) -> FloatArray:
    """A piecewise polynomial as rows (left, right, coefficients), for ``elements.table_value``."""
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
