"""Periodic motion of a pair on shafts with the linear mesh: from the model's own matrices, without exudyn.

The force of the linear mesh depends on the overlap and on the rate of the overlap alone. The compiled forces
supply the wrench of the mesh. The free turn of the train is a double multiplier +1 of the 2n states, so one
torque is unknown.

Sources: docs/theory/shafts.md, "The machine"; DOP853 after E. Hairer, S. P. Norsett and G. Wanner, Solving
Ordinary Differential Equations I (1993), II.5.
"""

from __future__ import annotations

import itertools
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.integrate import DOP853, simpson

from lumped.errors import NumericalError
from lumped.typing import FloatArray
from multibody.contact.kernels import ContactStates, tooth_forces_over
from multibody.contact.kinematics import LINEAR
from multibody.contact.machine import Machine
from multibody.contact.records import opened

#: Angle by which the fastest mode turns in a step [rad]: the method of eighth order then errs by some 1e-9.
_STEP_ANGLE = 1.0
#: Phases of the mesh cycle closer than this are one.
_SAME_PHASE = 1e-10
#: The speed is on a stability boundary if the condition number of the equations is larger.
_WORST_CONDITION = 1e13
#: Stages of DOP853.
_STAGES = 12
_A, _B, _C = (np.asarray(x, dtype=float) for x in (DOP853.A, DOP853.B, DOP853.C))


@dataclass(frozen=True, eq=False)
class LinearMotion:
    """Periodic motion with the linear mesh.

    state : (2n,) coordinates and velocities at t = 0
    torque_pinion, torque_gear : driving and braking torque that hold the mean speed [N m]
    transition, by_torque : (2n, 2n) map of the states over one mesh cycle; (2n,) change by a unit of brake
    """

    state: FloatArray
    torque_pinion: float
    torque_gear: float
    transition: FloatArray
    by_torque: FloatArray


def linear_motion(machine: Machine, brake: float | None) -> LinearMotion:
    """Find the periodic motion.

    brake : braking torque, where the driving torque is unknown; None: the driving torque is the machine's,
        and the braking torque is unknown
    Raises NumericalError : the speed is on a stability boundary
    """
    train = machine.train
    assert train is not None
    n = train.size
    start = np.zeros((2 * n, 2 * n + 3))
    start[:, : 2 * n] = np.eye(2 * n)
    _, _, end = deque(_propagated(machine, start, np.eye(3)), maxlen=1)[0]
    transition = end[:, : 2 * n]
    forced = end[:, 2 * n :]
    # Columns: the mesh and the machine's driving torque, a unit of driving torque more, a unit of brake.
    more_drive = 1
    unit_brake = 2
    by_brake = forced[:, unit_brake]
    unknown = unit_brake if brake is None else more_drive
    weights = np.array([1.0, 0.0, 0.0 if brake is None else brake])
    scale = state_scale(machine, 1.0)
    turn = train.mass @ train.free_turn
    matrix = bordered(transition, forced[:, unknown], turn, scale, machine.torque_pinion)
    size = np.linalg.norm(matrix, axis=0)
    condition = float(np.linalg.cond(matrix / size))
    if not condition < _WORST_CONDITION:
        rpm = float(machine.record.rolling.omega_p) * 30.0 / np.pi
        raise NumericalError(
            f"No periodic motion at {rpm:.6g} rpm (condition {condition:.1e}): a multiplier is at +1. "
            "Change the speed slightly or add damping."
        )
    solution = np.linalg.solve(matrix / size, np.append(forced @ weights / scale, 0.0)) / size
    state = solution[:-1] * scale
    weights[unknown] = solution[-1] * machine.torque_pinion
    torque = machine.torque_pinion + weights[more_drive]
    return LinearMotion(state, float(torque), float(weights[unit_brake]), transition, by_brake)


def state_scale(machine: Machine, deflection: float) -> FloatArray:
    """Sizes of the states in a vibration of one swing a mesh cycle, with a deflection [m] as amplitude.

    On shafts: the 2n states of the train. On springs: the lumped states; the first two are angles.
    """
    radii = machine.base_radii
    lengths = np.full(machine.size, deflection)
    places = machine.train.angles if machine.train else (np.array([0]), np.array([1]))
    for angles, radius in zip(places, radii, strict=True):
        lengths[angles] *= 1.0 / radius  # the angle that moves the base circle by the deflection
    return np.concatenate([lengths, lengths * 2.0 * np.pi / machine.period])


def bordered(
    transition: FloatArray, by_torque: FloatArray, turn: FloatArray, scale: FloatArray, torque: float
) -> FloatArray:
    """Scaled matrix of a periodic motion: identity less map, bordered by a torque and by the free turn.

    The last unknown is a torque over ``torque``. The last equation sets the free turn to zero.
    """
    n = turn.size
    matrix = np.zeros((scale.size + 1, scale.size + 1))
    matrix[:-1, :-1] = (np.eye(scale.size) - transition) * scale / scale[:, None]
    matrix[:-1, -1] = -by_torque * torque / scale
    row = turn * scale[:n]
    matrix[-1, :n] = row / np.abs(row).max()
    return matrix


def energy_residual(machine: Machine, motion: LinearMotion) -> float:
    """Losses by sliding, tooth dampers, bearings, shafts and couplings less the power that is missing [W]."""
    train = machine.train
    rolling = machine.record.rolling
    assert train is not None
    n = train.size
    lost = 0.0
    weights = np.array([[1.0], [motion.torque_pinion - machine.torque_pinion], [motion.torque_gear]])
    run = _propagated(machine, motion.state[:, None], weights, _STEP_ANGLE / 4.0)
    for (low, high), steps in itertools.groupby(run, key=lambda step: step[0]):
        rows = list(steps)
        times = np.array([time for _, time, _ in rows])
        states = np.array([state[:, 0] for _, _, state in rows])
        q = states[:, :n]
        v = states[:, n:]
        contacts = _contacts(machine, times, q, v, low, high).contacts
        powers = contacts["friction_force"] * contacts["sliding_velocity"]
        powers += (contacts["load"] - contacts["elastic_load"]) * contacts["compression_rate"]
        shafts = np.einsum("ti,ij,tj->t", v, train.damping, v)  # gyroscopic terms take no power
        lost += float(simpson(powers.sum(axis=1) + shafts, times)) / machine.period
    return lost - float(motion.torque_pinion * rolling.omega_p - motion.torque_gear * rolling.omega_g)


def _propagated(
    machine: Machine, start: FloatArray, forcing: FloatArray, angle: float = _STEP_ANGLE
) -> Iterator[tuple[tuple[float, float], float, FloatArray]]:
    """Integrate over one mesh cycle. Yield the smooth interval, the time and the states (2n, m) of each step.

    Every smooth interval also yields the states at the start of the interval.

    start : (2n, m) states at the start of the mesh cycle
    forcing : (3, k) weights of the three forcings in the last k columns of ``start``
    angle : largest angle by which the fastest mode turns in a step [rad]
    """
    train = machine.train
    period = machine.period
    assert train is not None
    n = train.size
    k = forcing.shape[1]
    fastest = 2.0 * np.pi * machine.vibrations_per_cycle / period
    springs = train.inverse @ train.stiffness
    dampers = train.inverse @ train.damping
    by_wrench = train.inverse[:, :6]
    row = machine.overlap
    torques = -(train.inverse @ train.torques.T)
    edges = _smooth(machine) * period
    state = start
    for low, high in itertools.pairwise(edges):
        steps = int(np.ceil((high - low) * fastest / angle))
        h = (high - low) / steps
        times = low + h * (np.arange(steps)[:, None] + _C[:_STAGES]).ravel()
        by_overlap, by_rate, constant = (
            (x @ by_wrench.T).reshape(steps, _STAGES, n) for x in mesh_wrench(machine, times, low, high)
        )
        rates = np.empty((_STAGES, *start.shape))
        yield (float(low), float(high)), float(low), state
        for step in range(steps):
            for stage in range(_STAGES):
                y = state + h * np.tensordot(_A[stage, :stage], rates[:stage], 1) if stage else state
                q = y[:n]
                v = y[n:]
                force = -(springs @ q) - dampers @ v
                force += np.outer(by_overlap[step, stage], row @ q[:6])
                force += np.outer(by_rate[step, stage], row @ v[:6])
                of_machine = constant[step, stage] + torques[:, 0] * machine.torque_pinion
                force[:, -k:] += np.stack([of_machine, torques[:, 0], torques[:, 1]], axis=1) @ forcing
                rates[stage, :n] = v
                rates[stage, n:] = force
            state = state + h * np.tensordot(_B, rates, 1)
            yield (float(low), float(high)), float(low + (step + 1) * h), state


def _smooth(machine: Machine) -> FloatArray:
    """Ends of the smooth parts of the mesh cycle as phases: switches, and where polynomials of a law meet."""
    geometry = machine.record.geometry
    joints = np.mod((machine.piece_ends - geometry.L_XA) / geometry.pitch, 1.0)
    phases = np.sort(np.concatenate([machine.switches, joints, [1.0]]))
    return np.asarray(phases[np.diff(phases, prepend=-1.0) > _SAME_PHASE])


def mesh_wrench(
    machine: Machine, times: FloatArray, low: float, high: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Wrenches of the linear mesh, (k, 6) each: per unit overlap, per unit rate of the overlap, without both.

    The times (k,) lie in the smooth interval from ``low`` to ``high`` [s].
    """
    zero = np.zeros((times.size, 6))
    unit = np.zeros((times.size, 6))
    unit[:, 0] = 1.0
    states = ((unit, zero), (zero, unit), (zero, zero))
    by_overlap, by_rate, constant = (_contacts(machine, times, q, v, low, high).wrenches for q, v in states)
    return by_overlap - constant, by_rate - constant, constant


def _contacts(
    machine: Machine, times: FloatArray, q: FloatArray, v: FloatArray, low: float, high: float
) -> ContactStates:
    """Contacts of the linear mesh inside a smooth interval from ``low`` to ``high`` [s]."""
    packed = machine.packed.copy()
    rolling = opened(packed).rolling
    margin = 1e-12 * machine.period
    rolling.earliest = low + margin
    rolling.latest = high - margin
    return tooth_forces_over(times, q, v, packed, LINEAR)
