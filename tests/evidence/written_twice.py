"""What the lumped and the multibody model each work out from the drawing, side by side before any motion.

The cross-check compares motions; here the numbers that enter them are compared, for every friction law, so
that a difference has a name. Both models read the stiffness of a pair, its softening by load and the
coupling of neighbours; loaded contact solves the static mesh with them. Here that mesh is solved with the
exact contact's kinematics, corner gaps and shared loads, and what is common to both by other means.

Sources: docs/theory/contact_energy.md.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from scipy.optimize import brentq

from lumped import GearPair, bodies
from lumped.compiler import compiled
from lumped.errors import ParameterError
from lumped.friction.registry import FRICTIONAL
from lumped.gear_geometry.geometry import Wheel
from lumped.mesh.damper import FULL_DAMPING
from lumped.path_of_contact import friction_path_function, pair_stiffness
from lumped.quasi_static.contacts import mesh_elements
from lumped.quasi_static.tooth_error import relief_error
from lumped.stiffness.foundation import LOCAL_RATIO
from lumped.typing import FloatArray
from multibody.contact import kinematics as kn
from multibody.contact.elements import contact_law, gradual, relief_at, shared_loads, table_value
from multibody.contact.friction import nominal_friction
from multibody.contact.kernels import set_couplings
from multibody.contact.kinematics import DRIVE, Line, add_gradient, corners_at
from multibody.contact.machine import Machine, machine, masses
from multibody.contact.records import MAX_PAIRS, PAIR, Records, machine_of
from multibody.gears.circles import circles
from multibody.run.effects import effect_flags
from tests.evidence.check import Check, rows

_OWN = "the same from the drawing by the multibody model"
_PLACES = 101
_FEW = 31
#: Change of a compression for a tangent, over the approach.
_STEP = 1e-4
#: Of the ring: harmonics, nodes over the radius, nodes over a foot.
_HARMONICS = 400
_RADII = 48
_FOOT = 40


def written_twice(pair: GearPair) -> Iterator[Check]:
    """Geometry, bodies, damping, relief, every friction law and the static mesh, from both models."""
    yield _geometry(pair)
    yield _bodies(pair)
    yield from _damping(pair)
    yield _laws(pair)
    yield from _relief(pair)
    yield from _loaded(pair)


def _geometry(pair: GearPair) -> Check:
    g = pair.geometry
    c = circles(pair)
    both = c.base_pinion + c.base_gear
    omega = pair.operating.pinion_speed
    start = c.start
    end = c.end
    both_ways = [
        (g.base_radius_pinion, c.base_pinion), (g.base_radius_gear, c.base_gear),
        (g.tip_radius_pinion, c.tip_pinion), (g.tip_radius_gear, c.tip_gear), (g.base_pitch, c.pitch),
        (g.centre_distance, c.centre_distance), (g.L_XY, c.tangent), (g.L_XA, start), (g.L_XB, end - c.pitch),
        (g.L_XP, c.tangent * c.base_pinion / both), (g.L_XC, start + c.pitch), (g.L_XD, end),
        (g.contact_ratio, (end - start) / c.pitch), (g.pairs, math.floor((end - start) / c.pitch) + 1),
        (g.omega_gear, omega * pair.pinion.teeth / pair.gear.teeth),
        (g.mesh_period, 2.0 * math.pi / (omega * pair.pinion.teeth)),
        (g.face_width, min(pair.pinion.face_width, pair.gear.face_width)),
    ]  # fmt: skip
    return rows("circles, path of contact, speeds", _OWN, 1e-9, both_ways)


def _bodies(pair: GearPair) -> Check:
    b = bodies(pair)
    (mass, inertia) = masses(pair)
    c = circles(pair)
    multibody_effective_mass = 1.0 / (c.base_pinion**2 / inertia[0] + c.base_gear**2 / inertia[1])
    lumped_values = [b.mass_pinion, b.mass_gear, b.inertia_pinion, b.inertia_gear, b.effective_mass]
    return rows(
        "masses and inertias",
        _OWN,
        1e-12,
        list(zip(lumped_values, [*mass, *inertia, multibody_effective_mass], strict=True)),
    )


def _inside(pair: GearPair) -> FloatArray:
    g = pair.geometry
    return np.linspace(g.L_XA, g.L_XD, _PLACES + 2)[1:-1]


def _damping(pair: GearPair) -> Iterator[Check]:
    """Of prescribed contact; that of loaded contact belongs to its static mesh."""
    if pair.mesh.contact == "loaded":
        return
    elements = mesh_elements(pair)
    xi = _inside(pair)
    p = machine(pair).record
    multibody_damping = p.pair_law.damping * np.sqrt(np.maximum(elements.stiffness(xi), 0.0))
    scale = max(float(np.abs(multibody_damping).max()), 1e-300)
    lumped_damping = elements.damping(xi)
    yield rows(
        "damping of a tooth pair",
        _OWN,
        1e-6,
        np.stack([lumped_damping, multibody_damping], axis=1) / scale + 1.0,
    )


def _laws(pair: GearPair) -> Check:
    """Largest difference of a friction coefficient, over its largest value."""
    worst = 0.0
    xi = _inside(pair)
    for name in FRICTIONAL:
        try:
            law = friction_path_function(pair, name)
            packed = machine(pair.with_(friction__law=name)).packed
        except ParameterError:  # a law that this pair does not allow
            continue
        multibody_law = np.array([nominal_friction(packed, x) for x in xi])
        differences = np.abs(law(xi) - multibody_law)
        # Where a law jumps, rounding of the place decides; such a place is left out.
        differences[np.abs(xi[:, None] - np.append(law.switches, 0.0)).min(axis=1) < 1e-9] = 0.0
        worst = max(worst, float(differences.max() / max(np.abs(multibody_law).max(), 1e-300)))
    # Laws near the pitch point vary fast; polynomials are fitted to 1e-10.
    return Check(
        "every friction law over the path of contact", f"{_OWN}; over its largest value", worst, 1e-8
    )


def _relief(pair: GearPair) -> Iterator[Check]:
    reliefs = [r for gear in (pair.pinion, pair.gear) for r in (gear.tip_relief, gear.root_relief) if r]
    if not reliefs:
        return
    xi = _inside(pair)
    p = machine(pair.with_({"mesh.relief": "static"})).record
    multibody = np.array([relief_at(p, x, 0.0, 0.0)[0] for x in xi])
    scale = float(sum(r.amount for r in reliefs))
    yield rows(
        "relief of both flanks",
        _OWN,
        1e-9,
        np.stack([relief_error(pair, xi), multibody], axis=1) / scale + 1.0,
    )


def _loaded(pair: GearPair) -> Iterator[Check]:
    """Static mesh, softening and neighbours of a pair, as far as it has them."""
    if pair.mesh.contact == "loaded":
        yield _static_mesh(pair)
    if pair.mesh.stiffness.model == "energy":
        softening = pair.mesh.stiffness.softening(pair)
        if softening > 0.0:
            yield _softening(pair, softening)
        if pair.mesh.stiffness.neighbours(pair):
            yield _neighbours(pair)


@compiled
def _set_loads(count: int, pairs: Records, packed: FloatArray) -> None:
    """Write the couplings and the loads of pairs of the multibody model, PAIR records."""
    machine_record = machine_of(packed)[0]
    set_couplings(count, pairs, machine_record)
    shared_loads(count, pairs, contact_law(machine_record, kn.CONTACT_LAW))


@dataclass(frozen=True)
class _Equilibrium:
    """A pair in the static mesh: approach [m], load [N], tangent [N/m], damping [N s/m], compression [m].

    ``tilt`` is the force of a unit load that pushes the pinion away from the gear, off the line of action.
    """

    approach: float
    load: float
    tangent: float
    damping: float
    pressed: float
    tilt: float


@dataclass(frozen=True, eq=False)
class _Mesh:
    """The exact contact's mesh under the mean load, the gears held square to the nominal line of action."""

    machine: Machine

    @cached_property
    def force(self) -> float:
        return float(self.machine.torque_pinion / self.machine.record.geometry.radius_p)

    @cached_property
    def longer(self) -> float:
        return float(self.force * (1.0 / self.machine.bearing_stiffness[:, 0]).sum())

    def pressed(self, places: FloatArray, delta: float) -> tuple[FloatArray, FloatArray]:
        """Approach less relief and corner gaps of pairs at places (pairs,) [m], and their tilt."""
        p = self.machine.record
        half = 0.5 * (delta + self.longer)
        length = float(p.geometry.L_XY + self.longer)
        line = Line(1.0, 0.0, length, DRIVE, float(p.geometry.radius_p), float(p.geometry.radius_g))
        approaches = np.empty(places.size)
        tilt = np.empty(places.size)
        for i, xi in enumerate(places):
            arms = xi + half, p.geometry.L_XY - xi + half
            corners = corners_at(
                line, *arms, (p.geometry.tip_p, p.geometry.tip_g), (p.geometry.edge_p, p.geometry.edge_g)
            )
            relief, _ = relief_at(p, min(max(xi, p.geometry.L_XA), p.geometry.L_XD), 0.0, 0.0)
            approaches[i] = delta - relief - corners.gap
            wrench = np.zeros(6)
            add_gradient(wrench, line, corners.by_p, corners.by_g, corners.by_length)
            tilt[i] = -wrench[1]
        return approaches, tilt

    def loads(self, places: FloatArray, pressed: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Loads of pairs, and compressions of the pairs without the part that neighbours take.

        The pair that is farthest behind comes first.
        """
        stiffness = np.array([table_value(self.machine.stiffness_table, xi) for xi in places])
        pairs = np.zeros(places.size, PAIR)
        pairs["position"] = places
        pairs["compression"] = pressed
        pairs["stiffness"] = stiffness
        _set_loads(places.size, pairs, self.machine.packed)
        loads = pairs["elastic_load"].copy()
        return loads, pressed - pairs["couplings"][:, : places.size] @ loads

    def at(self, xi: float) -> _Equilibrium:
        """The pair at xi in equilibrium."""
        p = self.machine.record
        reach = 0.4 * self.machine.record.geometry.pitch
        places = xi + p.geometry.pitch * np.arange(-4, 5)
        near = (places > p.geometry.L_XA - reach) & (places < p.geometry.L_XD + reach)
        # Records of pairs have room for MAX_PAIRS: of more, those furthest outside the path carry nothing.
        outside = np.maximum(p.geometry.L_XA - places, places - p.geometry.L_XD)
        near &= np.argsort(np.argsort(outside)) < MAX_PAIRS
        index_of_pair = int(np.flatnonzero(near & (places == xi))[0] - np.flatnonzero(near)[0])
        places = places[near]

        def missing(delta: float) -> float:
            return float(self.loads(places, self.pressed(places, delta)[0])[0].sum() - self.force)

        delta = float(brentq(missing, 0.0, 1e-3, xtol=1e-17, rtol=1e-14))
        pressed, tilt = self.pressed(places, delta)
        loads, compressions = self.loads(places, pressed)
        more, less = (self.loads(places, pressed + s * _STEP * delta)[0] for s in (1.0, -1.0))
        share = gradual(float(loads[index_of_pair]) / (FULL_DAMPING * self.force))
        # The contact moves outside with the approach: a corner closes by less than that.
        ahead, behind = (
            self.pressed(places, delta + s * _STEP * delta)[0][index_of_pair] for s in (1.0, -1.0)
        )
        closing = (ahead - behind) / (2.0 * _STEP * delta)
        damping = (
            p.pair_law.damping * np.sqrt(table_value(self.machine.stiffness_table, xi)) * share * closing
        )
        tangent = (more - less)[index_of_pair] / (2.0 * _STEP * delta)
        values = (loads[index_of_pair], tangent, damping, compressions[index_of_pair], tilt[index_of_pair])
        return _Equilibrium(delta, *(float(value) for value in values))


def _static_mesh(pair: GearPair) -> Check:
    mesh = _Mesh(machine(pair, effect_flags(None, "loaded")))
    elements = mesh_elements(pair)
    low, high = elements.stiffness.interval
    # Close to both ends a pair takes up its first load, and with it its damper.
    near = np.array([0.002, 0.004])
    shares = np.concatenate([near, (np.arange(_FEW) + 0.5) / _FEW, 1.0 - near[::-1]])
    places = low + (high - low) * shares
    places = places[np.abs(places[:, None] - elements.stiffness.switches).min(axis=1) > 1e-5 * (high - low)]
    # At the end of a ramp neither load nor tangent is left.
    places = places[elements.stiffness(places) > 1e-6 * float(elements.stiffness(places).max())]
    equilibria = [mesh.at(float(xi)) for xi in places]
    multibody_laws = {
        "stiffness": np.array([one.tangent for one in equilibria]),
        "error": np.array([one.approach - one.load / one.tangent for one in equilibria]),
        "damping": np.array([one.damping for one in equilibria]),
        "tilt": np.array([one.tilt for one in equilibria]),
    }
    delta = equilibria[0].approach
    found_rows = []
    for name, values in multibody_laws.items():
        scale = delta if name == "error" else max(float(values.max()), 1e-300)
        found_rows.append(np.stack([getattr(elements, name)(places), values], axis=1) / scale + 1.0)
    # Contact begins and ends where nothing is left of a pair's compression.
    ends = [mesh.at(xi).pressed for xi in (low, high)]
    found_rows.append(np.array([(1.0 + one / delta, 1.0) for one in ends]))
    exact = (
        "the static mesh by kinematics, corner gaps and shared loads of the exact contact; over the largest"
    )
    return rows("static mesh", exact, 1e-6, np.concatenate(found_rows))  # laws: 1e-8


def _softening(pair: GearPair, softening: float) -> Check:
    """From the curves at two torques: 1/k(T) = 1/k(T_0) - D ln(T/T_0)."""
    torque = pair.operating.pinion_torque
    places = np.linspace(*pair_stiffness(pair).interval, 5)[1:-1]
    twice = pair.with_({"operating.pinion_torque": 2.0 * torque})
    softening_of_curves = (1.0 / pair_stiffness(pair)(places) - 1.0 / pair_stiffness(twice)(places)) / np.log(
        2.0
    )
    exact = "stiffness curves at two torques"  # fitted to 1e-10, of which the softening is a hundredth
    both = np.stack([np.full(places.size, softening), softening_of_curves], axis=1)
    return rows("softening of a pair by load, Hertz", exact, 1e-6, both)


def _neighbours(pair: GearPair) -> Check:
    """From the ring solved by collocation over the radius, tractions and motions summed over the feet."""
    g = pair.geometry
    both = []
    for apart, function in enumerate(pair.mesh.stiffness.neighbours(pair), 1):
        low, high = function.interval
        places = low + (high - low) * np.array([0.3, 0.8])
        total = np.zeros(places.size)
        near = (
            places,
            g.L_XY - places - apart * g.base_pitch,
        )  # contact lengths of the tooth nearer its root
        for wheel, gear, lengths in zip(pair.wheels, (pair.pinion, pair.gear), near, strict=True):
            angle = 2.0 * np.pi * apart / wheel.tooth.teeth
            feet = _feet(wheel.tooth.root_half_angle, angle, gear.poisson_ratio)
            root, tip = (_foot_loads(wheel, lengths + s * g.base_pitch) for s in (0, apart))
            total += np.sum(tip * (feet @ root), axis=0) / gear.youngs_modulus / g.face_width
        both.append(np.stack([function(places), total], axis=1))
    # 400 orders of a series whose terms fall as their third power.
    return rows("motion by the load of a neighbour", "ring by collocation", 2e-3, np.concatenate(both))


def _foot_loads(wheel: Wheel, length: FloatArray) -> FloatArray:
    """Force across and along the centre line, and couple, that balance a unit load, (3, n); root radius 1."""
    tooth = wheel.tooth
    angle = length / tooth.base_radius - tooth.base_half_angle
    half = tooth.root_half_angle
    moment = -tooth.base_radius / tooth.root_radius  # about the centre of the gear
    across = -np.cos(angle)
    return np.stack([across, -np.sin(angle), moment - across * np.sin(half) / half])


def _feet(half: float, apart: float, poisson: float) -> FloatArray:
    """Motions of a foot (rows) by unit loads at one ``apart`` behind it (columns); E, radius and width 1."""
    x, weight = np.polynomial.legendre.leggauss(_FOOT)
    x = half * x
    weight = half * weight
    # Radial and tangential traction of unit loads: across, along, and a couple of forces along.
    couple = np.sin(x) / (half - np.sin(half) * np.cos(half))
    radial = np.array([np.sin(x) / (2 * half), np.cos(x) / (2 * half), -couple * np.cos(x)]) * weight
    across = np.array([np.cos(x) / (2 * half), -np.sin(x) / (2 * half), couple * np.sin(x)]) * weight
    motions = np.zeros((3, 3))
    for n, ring in enumerate(_rings(poisson)):
        share = 1.0 / np.pi if n else 0.5 / np.pi
        even = share * np.array([radial @ np.cos(n * x), across @ np.sin(n * x)])
        odd = share * np.array([radial @ np.sin(n * x), -across @ np.cos(n * x)])
        (up, turn) = ring @ even
        (up_odd, turn_odd) = ring @ odd
        there = n * (x + apart)
        displacement = np.outer(np.cos(there), up) + np.outer(np.sin(there), up_odd)
        rotation = np.outer(np.sin(there), turn) - np.outer(np.cos(there), turn_odd)
        motions += radial @ displacement + across @ rotation
    return motions


@lru_cache(maxsize=4)
def _rings(poisson: float) -> FloatArray:
    """Radial and tangential motion of the rim by tractions of order n = 0, 1, ... on it; (n, 2, 2).

    Equilibrium of plane stress in polar coordinates by Chebyshev collocation over ln(r); u_r and the radial
    traction go with cos(n x), u_t and the tangential one with sin(n x). The twist, n = 0, is left out.
    """
    m = _RADII
    node = np.cos(np.pi * np.arange(m) / (m - 1))  # 1 at the rim
    c = np.where((np.arange(m) == 0) | (np.arange(m) == m - 1), 2.0, 1.0) * (-1.0) ** np.arange(m)
    d = np.outer(c, 1.0 / c) / (node[:, None] - node + np.eye(m))
    d = (d - np.diag(d.sum(axis=1))) * 2.0 / np.log(LOCAL_RATIO)
    one = np.eye(m)
    zero = np.zeros((m, m))
    plane = 1.0 / (1.0 - poisson**2)
    shear = 0.5 / (1.0 + poisson)
    compliances = np.zeros((_HARMONICS + 1, 2, 2))
    for n in range(_HARMONICS + 1):
        hoop = np.hstack([one, n * one])  # r times the strains, of (u_r, u_t)
        stretch = np.hstack([d, zero])
        slip = np.hstack([-n * one, d - one])
        radial = plane * (stretch + poisson * hoop)
        around = plane * (hoop + poisson * stretch)
        tangential = shear * slip
        # r^2 times equilibrium, with r d/dr(s/r) = (d - 1) s of s, r times a stress.
        rows = np.vstack([d @ radial + n * tangential - around, d @ tangential - n * around + tangential])
        rows[0] = radial[0]
        rows[m] = tangential[0]
        rows[m - 1], rows[2 * m - 1] = np.eye(2 * m)[[m - 1, 2 * m - 1]]
        right = np.zeros((2 * m, 2))
        right[0, 0] = right[m, 1] = 1.0
        compliances[n] = np.linalg.solve(rows, right)[[0, m]]
    compliances[0, :, 1] = compliances[0, 1] = 0.0
    return compliances
