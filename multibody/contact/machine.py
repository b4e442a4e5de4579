"""A gear pair turned into the plain numbers that a multibody model needs.

Only the stiffness of a tooth pair and how far it moves the next ones are taken from ``lumped``, and the
coefficient of a friction law that
``multibody.contact.friction`` does not have. Circles, path of contact, tooth thickness,
bodies, bearings, damping, relief and friction are derived here again from the fields of the schema, so that
agreement of the two models is evidence for both (``multibody.SHARED`` lists what is not).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np

from lumped.lubrication.viscosity import ISO_VG_MIDPOINT, viscosity_at_100
from lumped.model.mesh_cycle import mesh_cycle
from lumped.path_function import PathFunction
from lumped.path_of_contact import friction_path_function, pair_stiffness
from lumped.quasi_static.contacts import mesh_elements
from lumped.schema.contact import Lubricant
from lumped.schema.gear import Gear
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray, IntArray
from multibody.contact import friction as fr
from multibody.contact import kernels as kn
from multibody.contact.drawing import base_tooth_angle, bearing_constants, circles, masses, reliefs
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
    mass, inertia : (2,) pinion, gear [kg], [kg m^2]
    bearing_stiffness, bearing_damping : (2, 2) rows pinion, gear; columns x, y [N/m], [N s/m]
    torque_pinion, torque_gear : driving and braking torque, both positive [N m]
    pairs : slots of tooth pairs, floor(contact ratio) + 1; more where tip corners lengthen the contact
    ahead : whole pitches by which the pair of the first slot is ahead of the one that was at A
    period : mesh cycle [s]
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
    def units(self) -> FloatArray:
        """(n,) a metre in each coordinate: 1, or the angle that moves the base circle by as much."""
        units = np.ones(self.size)
        for own, radius in zip(self.angles, self.parameters[[kn.RADIUS_P, kn.RADIUS_G]], strict=True):
            units[own] = 1.0 / radius
        return units

    @property
    def angles(self) -> tuple[IntArray, IntArray]:
        """Coordinates that are angles, about the pinion's and about the gear's axis."""
        return (np.array([2]), np.array([5])) if self.train is None else self.train.angles

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


def machine(pair: GearPair, flags: int = 0, supports: Supports = "springs") -> Machine:
    """Describe a gear pair for the multibody model, both torques being that of the pinion.

    pair : validated gear pair
    flags : effect switches of ``kernels``; with ``TIP_CONTACT`` or ``CLEARANCE``, and where teeth of the
        linear mesh may part, the stiffness holds wherever teeth touch; else relief takes it off where the
        lumped model sees no contact
    supports : "springs" of the pair's bearings, or "shafts"
    """
    drawn, loaded = circles(pair), pair.mesh.contact == "loaded"
    parts = flags & kn.LINEAR and flags & kn.CONTACT_LOSS
    whole = loaded or parts or flags & (kn.TIP_CONTACT | kn.CLEARANCE)
    stiffness = pair_stiffness(pair) if whole else mesh_elements(pair).stiffness
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
    p[kn.DAMPING] = 2.0 * pair.mesh.damping_ratio * math.sqrt(mesh_mass(p, inertia))
    p[kn.SOFTENING] = pair.mesh.stiffness.softening(pair)
    p[kn.NOMINAL_FORCE] = pair.operating.pinion_torque / r_p
    relieved = reliefs(pair, drawn)
    p[kn.RELIEFS] = len(relieved)
    p[kn.FIRST_RELIEF : kn.FIRST_RELIEF + kn.RELIEF_COLUMNS * len(relieved)] = np.ravel(relieved)
    for apart, moved in enumerate(pair.mesh.stiffness.neighbours(pair)[: MAX_PAIRS - 1]):
        first = kn.FIRST_COUPLED + kn.COUPLED_COLUMNS * apart
        p[first : first + kn.COUPLED_COLUMNS] = pack(moved)[0]
        p[kn.COUPLED] = apart + 1
    fill_friction(pair, p)
    friction = friction_switches(p)
    if p[kn.FRICTION + fr.LAW] == fr.TABLE:
        law = friction_path_function(pair)
        p[kn.FRICTION + fr.COLUMNS] = law.coefficients.shape[0] + 2
        p = np.append(p, pack(law))
        friction = [(SLIDING, place) for place in law.switches.tolist()]
    starts = [at * r_p if which == 0.0 else l_xy - at * r_g for which, at, *_ in relieved]
    places = [place for _, place in friction]
    bearing_stiffness, bearing_damping = bearing_constants(pair, mass)
    table = pack(stiffness)
    switches = switch_phases([*stiffness.switches, *starts, *places], l_xa, tip_p, pitch)
    if loaded and flags & kn.LINEAR:
        table, switches = _loaded_laws(pair, p)
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


def _loaded_laws(pair: GearPair, p: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Table of the lumped loaded contact's k, c, e and gap, one below the other, and its switches as phases.

    The linear mesh with loaded contact checks the equations alone: it reads the lumped element laws.
    """
    cycle = mesh_cycle(pair)
    e = cycle.elements
    laws = [pack(law) for law in (e.stiffness, e.damping, e.error, e.error if e.gap is None else e.gap)]
    p[[kn.K_ROWS, kn.C_ROWS, kn.E_ROWS]] = [len(law) for law in laws[:3]]
    width = max(law.shape[1] for law in laws)
    # Coefficients stand behind both ends, highest power first: pad between them.
    rows = [np.insert(law, [2] * (width - law.shape[1]), 0.0, axis=1) for law in laws]
    return np.ascontiguousarray(np.concatenate(rows)), cycle.edges[:-1] / cycle.period


def mesh_mass(p: FloatArray, inertia: FloatArray) -> float:
    """Mass that the rotations oppose to the mesh [kg], from the moments of a unit contact force.

    p : parameters whose base radii are set
    inertia : (2,) pinion, gear [kg m^2]
    """
    wrench = np.zeros(6)
    line = Line(1.0, 0.0, float(p[kn.L_XY]), DRIVE, float(p[kn.RADIUS_P]), float(p[kn.RADIUS_G]))
    add_wrench(wrench, line, 1.0, 0.0, 0.0, 0.0)
    return float(1.0 / np.sum(wrench[[2, 5]] ** 2 / inertia))


def loaded_phase(machine: Machine, flags: int, q: FloatArray) -> Machine:
    """Turn the unloaded gears so that it is the loaded pair that stands at A at t = 0.

    Wind-up and bearing deflection move the contact along the path, by a constant in the mean. The rigid
    rotation of a free gear train is arbitrary, so that constant is no difference between models but a
    choice of the time origin; it is taken out.

    machine : numbers whose flanks touch at A when unloaded
    flags : effect switches of the contact core: without moving contacts nothing is turned
    q : (6,) static state
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
    """Phases of the nominal mesh cycle in [0, 1) where a pair meets a jump or a kink; 0 is always one.

    places : of jumps and kinks on the path of contact [m]
    l_xa, l_xd, pitch : ends of the path, base pitch [m]
    """
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
    """Write a pair's friction parameters behind its geometry and speeds.

    p : (kernels.N_PARAMETERS,) parameters, whose path of contact, base radii and speeds are set
    """
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
    if law.coefficient is not None:
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

    p : parameters of the machine
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


#: Velocity over which tanh changes the sign of friction [m/s]. Halving it changes the transmission error at
#: 79.1 N m and 800 rpm of the 28/28 pair by some 1e-4 of its peak to peak.
SMALL_VELOCITY = 1e-4
#: A law is continuous at the pitch point if it jumps by less than this share of its largest value.
_CONTINUOUS = 1e-3
_BESIDE = 1e-9  # m
_PLACES = 101  # at which the largest coefficient is looked for


def friction_velocity(machine: Machine) -> tuple[float, str]:
    """Choose the velocity over which friction changes its sign [m/s], 0 for the sign function; and say why.

    At the pitch point sliding passes zero with a_s = (Omega_p + Omega_g) Omega_p r_bp. Friction that jumps
    accelerates it by up to a_f = mu N/m_s, with 1/m_s = 1/m_p + 1/m_g + X_p^2/J_p + X_g^2/J_g. Where less
    than a_f is left of a_s, friction can stick: sign() has no solution there. Vibration takes away at most
    Q = 1/(2 zeta) times a_f, so sign() is safe where a_s > (1 + Q) a_f.
    """
    if _beside_pitch_point(machine) <= _CONTINUOUS * _largest(machine):
        return 0.0, "sign(): the friction law is continuous at the pitch point"
    nominal, by_friction, needed = _accelerations(machine)
    share = nominal / by_friction
    numbers = f"sliding passes zero at {nominal:.3g} m/s^2, {share:.3g} times what friction can change"
    if nominal > needed * by_friction:
        return 0.0, f"sign(): {numbers}, more than the {needed:.3g} times that resonance could take away"
    return SMALL_VELOCITY, (
        f"tanh over {SMALL_VELOCITY * 1e3:g} mm/s: {numbers}, less than the {needed:.3g} times that "
        "resonance could take away, so friction may hold the teeth at zero sliding"
    )


def _accelerations(machine: Machine) -> tuple[float, float, float]:
    """Return a_s and a_f [m/s^2], and the 1 + Q that a_s/a_f must exceed, see above."""
    p = machine.parameters
    arm_p, arm_g = p[kn.L_XP], p[kn.L_XY] - p[kn.L_XP]
    mobility = float((1.0 / machine.mass).sum())
    mobility += arm_p**2 / machine.inertia[0] + arm_g**2 / machine.inertia[1]
    load = machine.torque_pinion / p[kn.RADIUS_P]
    by_friction = _beside_pitch_point(machine) * load * mobility
    nominal = (p[kn.OMEGA_P] + p[kn.OMEGA_G]) * p[kn.OMEGA_P] * p[kn.RADIUS_P]
    if machine.train is None:
        critical = 2.0 * np.sqrt(machine.bearing_stiffness[:, 1] * machine.mass)
        ratio = float((machine.bearing_damping[:, 1] / critical).min())  # of the less damped bearing
    else:
        ratio = machine.train.damping_ratio
    needed = 1.0 + (0.5 / ratio if ratio > 0.0 else np.inf)
    return float(nominal), float(by_friction), needed


def _largest(machine: Machine) -> float:
    """Largest friction coefficient on the path of contact."""
    p = machine.parameters
    return max(abs(kn.nominal_friction(p, xi)) for xi in np.linspace(p[kn.L_XA], p[kn.L_XD], _PLACES))


def _beside_pitch_point(machine: Machine) -> float:
    """Larger friction coefficient just before and after the pitch point."""
    place = float(machine.parameters[kn.L_XP])
    return max(abs(kn.nominal_friction(machine.parameters, place + side * _BESIDE)) for side in (-1.0, 1.0))
