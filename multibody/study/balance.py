"""Energy ledger of a multibody run: where the driving work goes.

The ledger is kept from contact records (loads, sliding and closing velocities), not from the forces that
moved the bodies, so a wrong wrench, sign or lever shows up as a residual.

Sources: docs/theory/multibody.md, "Overlap, wrench and contact point"; the power balance of rigid bodies.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from lumped.arguments import whole_number
from lumped.model.solution import Initial
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.typing import BoolArray, FloatArray
from multibody.contact import kernels as kn
from multibody.run.drive import Drive, DriveTables, value_and_integral
from multibody.run.integration import Segment
from multibody.run.model import ExudynModel, contact_state
from multibody.run.setup import MOST_CYCLES, Fidelity, prepare

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(4)
#: A step over less than this share of the mesh cycle leads across an event. So does one over less than the
#: second in which the number of contacts changes, where contact begins with a load: a jump that was not
#: foreseen, as where soft bearings move it far or friction holds the teeth, shrinks the step.
_HAIR, _SHRUNK = 1e-11, 1e-6


@dataclass(frozen=True)
class PowerBalance:
    """Work and energy over a run [J].

    Attributes
    ----------
    driving : work of the driving torque, and of the motor where a drive has one
    braking : work taken by the brake
    stored : increase of kinetic energy and of elastic energy in the bearings and the motor's spring
    coupling : dissipated in the damping of the motor's spring
    bearings : dissipated in the bearings
    friction : dissipated by sliding friction between the teeth
    mesh_damping : dissipated by the damping of the teeth
    mesh_elastic : increase of the elastic energy of the teeth
    mesh_jump : elastic energy that came with jumps of the stiffness and that no force paid for
    unpaid : work on the teeth that goes into no energy, because the contact force has no part along the
        path of contact; zero with the effect ``path_work``
    """

    driving: float
    braking: float
    stored: float
    coupling: float
    bearings: float
    friction: float
    mesh_damping: float
    mesh_elastic: float
    mesh_jump: float
    unpaid: float

    @property
    def mesh_stiffness(self) -> float:
        """Work that the contact forces do on the elastic teeth [J]."""
        return self.mesh_elastic - self.mesh_jump + self.unpaid

    @property
    def residual(self) -> float:
        """Driving work that is not accounted for [J]."""
        lost = self.coupling + self.bearings + self.friction + self.mesh_damping
        return self.driving - self.braking - self.stored - lost - self.mesh_stiffness


def power_balance(
    pair: AnyPair,
    cycles: int = 20,
    *,
    fidelity: Fidelity = "exact",
    initial: Initial | ArrayLike = "static",
    effects: Collection[str] | Mapping[str, bool] | None = None,
    rtol: float = 1e-8,
    friction_velocity: float | None = None,
    drive: Drive | None = None,
) -> PowerBalance:
    """Energy ledger of a run; arguments as ``multibody.simulate``.

    The powers are integrated over every step of the integrator by four-point Gauss quadrature on its dense
    output.
    """
    pair = load_gear_pair(pair)
    cycles = whole_number("cycles", cycles, 1, MOST_CYCLES)
    setup = prepare(pair, fidelity, initial, effects, rtol, friction_velocity, drive)
    work, stored, jumps = np.zeros(7), [0.0], [0.0]

    def energy(segment: Segment, t: FloatArray) -> FloatArray:
        _, contacts, counts = contact_state(setup.model, t, *segment.at(t))
        valid = np.arange(contacts.shape[1]) < counts[:, None]
        return np.asarray(np.where(valid, contacts[:, :, kn.ENERGY], 0.0).sum(axis=1))

    def leads_across(segment: Segment) -> BoolArray:
        steps = np.diff(segment.times) / setup.machine.period
        across, short = steps < _HAIR, np.flatnonzero(steps < _SHRUNK)
        before, after = (
            contact_state(setup.model, segment.times[j], segment.q[j], segment.v[j])[2]
            for j in (short, short + 1)
        )
        if not setup.model.flags & kn.TIP_CONTACT:
            across[short] |= before != after
        return np.asarray(across, dtype=np.bool_)

    def visit(number: int, segment: Segment) -> None:
        steps = np.diff(segment.times)[:, None]
        t = (segment.times[:-1, None] + 0.5 * steps * (1.0 + _NODES)).ravel()
        powers = _powers(setup.model, t, *segment.at(t))
        work[:] += (0.5 * steps * _WEIGHTS).ravel() @ powers
        hair = _HAIR * setup.machine.period
        across = np.flatnonzero(leads_across(segment))
        first_of, last_of = np.diff(across, prepend=-2) > 1, np.diff(across, append=segment.times.size) > 1
        before = np.maximum(segment.times[across[first_of]] - hair, segment.times[0])
        after = segment.times[across[last_of] + 1]
        jumps.append(float((energy(segment, after) - energy(segment, before)).sum()))
        first, last = energy(segment, segment.times[[0, -1]])
        jumps.append(float(first) - stored[-1] if number else 0.0)
        stored.extend([float(first)] if not number else [])
        stored.append(float(last))

    edges = setup.edges(cycles)
    start = _stored(setup.model, 0.0, setup.q, setup.v)
    q, v = setup.run(edges, visit)
    driving, braking, bearings, friction, damping, unpaid, coupling = (float(w) for w in work)
    return PowerBalance(
        driving=driving,
        braking=braking,
        stored=_stored(setup.model, float(edges[-1]), q, v) - start,
        coupling=coupling,
        bearings=bearings,
        friction=friction,
        mesh_damping=damping,
        mesh_elastic=stored[-1] - stored[1],
        mesh_jump=sum(jumps),
        unpaid=unpaid,
    )


def _speeds(model: ExudynModel, v: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Actual speeds of pinion and gear in their running senses [rad/s]."""
    p = model.machine.parameters
    return p[kn.OMEGA_P] - v[..., 2], p[kn.OMEGA_G] + v[..., 5]


def _twist(drive: DriveTables, t: float, q: FloatArray, v: FloatArray) -> tuple[float, float, float]:
    """Twist of the motor's spring and its rate, and the motor's speed beyond nominal [rad], [rad/s]."""
    speed, angle = value_and_integral(drive.motor, t)
    return float(drive.spring[2] + angle + q[2]), float(speed + v[2]), speed


def _stored(model: ExudynModel, t: float, q: FloatArray, v: FloatArray) -> float:
    m = model.machine
    omega_p, omega_g = _speeds(model, v)
    kinetic = m.mass[0] * (v[0] ** 2 + v[1] ** 2) + m.mass[1] * (v[3] ** 2 + v[4] ** 2)
    kinetic += float(m.inertia[0] * omega_p**2 + m.inertia[1] * omega_g**2)
    elastic = float(m.bearing_stiffness.ravel() @ q[[0, 1, 3, 4]] ** 2)
    if model.drive is not None:
        elastic += float(model.drive.spring[0]) * _twist(model.drive, t, q, v)[0] ** 2
    return float(0.5 * (kinetic + elastic))


def _powers(model: ExudynModel, t: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
    """Powers at n states, (n, 7) [W].

    Driving, braking, bearings, friction, mesh damping, unpaid, damping of the motor's spring.
    """
    m = model.machine
    omega_p, omega_g = _speeds(model, v)
    powers = np.zeros((t.size, 7))
    powers[:, 0], powers[:, 1] = m.torque_pinion * omega_p, m.torque_gear * omega_g
    powers[:, 2] = v[:, [0, 1, 3, 4]] ** 2 @ m.bearing_damping.ravel()
    _, contacts, counts = contact_state(model, t, q, v)
    contacts[np.arange(contacts.shape[1]) >= counts[:, None]] = 0.0
    c = np.moveaxis(contacts, -1, 0)
    powers[:, 3] = (c[kn.FRICTION_FORCE] * c[kn.SLIDE]).sum(axis=1)
    powers[:, 4] = ((c[kn.LOAD] - c[kn.ELASTIC]) * c[kn.OVERLAP_RATE]).sum(axis=1)
    if not model.flags & kn.PATH_WORK:
        powers[:, 5] = (c[kn.PATH] * c[kn.PATH_RATE]).sum(axis=1)
    if model.drive is not None:
        for i, at in enumerate(t):
            powers[i, [0, 1, 6]] += _drive_powers(model, model.drive, at, q[i], v[i])
    return powers


def _drive_powers(
    model: ExudynModel, drive: DriveTables, t: float, q: FloatArray, v: FloatArray
) -> tuple[float, float, float]:
    """What a drive adds to the driving and the braking power, and what its spring's damping takes [W]."""
    omega_p, omega_g = _speeds(model, v)
    twist, twist_rate, speed = _twist(drive, t, q, v)
    by_spring = float(drive.spring[0]) * twist + float(drive.spring[1]) * twist_rate
    if drive.spring[0] == 0.0:  # no motor: neither spring nor damping acts
        by_spring = twist_rate = 0.0
    motor_power = by_spring * (float(model.machine.parameters[kn.OMEGA_P]) + speed)
    driving = value_and_integral(drive.pinion, t)[0] * float(omega_p) + motor_power
    braking = value_and_integral(drive.gear, t)[0] * float(omega_g)
    return driving, braking, float(drive.spring[1]) * twist_rate**2
