"""The exudyn model: two planar rigid bodies in bearings, one massless object that carries the tooth contacts.

Coordinates are deviations from the nominal rotation, q = (x_p, y_p, phi_p, x_g, y_g, phi_g). The contacts
add the nominal rotation, so the relative tolerance acts on the vibration. A frame that turns at constant
speed about the centre of mass of a body adds no inertia terms in the plane.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable
from dataclasses import dataclass

import exudyn as exu
import exudyn.itemInterface as items
import numpy as np

from lumped.typing import FloatArray
from multibody.contact.kernels import ContactStates, tooth_forces, tooth_forces_over
from multibody.contact.machine import Machine
from multibody.contact.records import CONTACTS_SIZE, WRENCH, Record, opened
from multibody.shafts.train import Train

# q = (x_p, y_p, phi_p, x_g, y_g, phi_g) out of (theta_p, theta_g, x_p, x_g, y_p, y_g): theta_p = -phi_p.
_ORDER = np.array([2, 4, 0, 3, 5, 1])
_SIGN = np.array([1.0, 1.0, -1.0, 1.0, 1.0, 1.0])
_BACK = np.argsort(_ORDER)


def from_lumped_state(state: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(q, v) of the multibody model, each (..., 6), from the 12 lumped states (..., 12)."""
    return state[..., _ORDER] * _SIGN, state[..., 6 + _ORDER] * _SIGN


def to_lumped_state(q: FloatArray, v: FloatArray) -> FloatArray:
    """The 12 lumped states (..., 12) from q and v, each (..., 6)."""
    return np.concatenate([(q * _SIGN)[..., _BACK], (v * _SIGN)[..., _BACK]], axis=-1)


class _Stop(Exception):
    """Leaves exudyn's solver from inside a user function."""


#: Calls in which the time must advance: some 80 steps, tried or taken.
_WATCHED = 600


@dataclass
class CallBudget:
    """Counts force evaluations, so no run can hang, and records why a run was stopped.

    limit : most calls in one interval
    calls, before : calls since the start, and calls before the present interval
    reason : empty, or the last problem ("not finite", "too many calls", "standstill")
    look : number of calls at the next look at the time
    seen, least : time of the last look, and least advance of the time until the next look [s]
    last : time of the last call [s]; NaN: the last force must be computed again
    """

    limit: int
    calls: int = 0
    before: int = 0
    reason: str = ""
    look: int = 0
    seen: float = -math.inf
    least: float = 0.0
    last: float = math.nan

    def __post_init__(self) -> None:
        self.look = self.limit

    def reset(self) -> None:
        """Allow ``limit`` more calls."""
        self.before = self.calls

    def watch(self, t: float, least: float) -> None:
        """Stop also if the time t [s] advances by less than ``least`` in some hundred calls."""
        self.reason = ""
        self.seen = t
        self.least = least
        self.last = math.nan
        self.look = min(self.calls + _WATCHED, self.before + self.limit)

    def check(self, t: float) -> None:
        """The look that is due at time t [s]; raises to leave exudyn's solver."""
        if self.calls > self.before + self.limit:
            self.reason = "too many calls"
        elif t - self.seen < self.least:
            self.reason = "standstill"
        else:
            return self.watch(t, self.least)
        raise _Stop


@dataclass(eq=False)
class ExudynModel:
    """An assembled exudyn system and the buffers of the user function.

    container : exudyn SystemContainer (must stay alive; also holds the renderer)
    sensors : numbers of the sensors that store coordinates and velocities at every step: of both gears, or of
        each shaft with its gear
    packed : numbers of the machine for compiled code, a copy that may be changed between runs
    """

    machine: Machine
    flags: int
    container: exu.SystemContainer
    system: exu.MainSystem
    sensors: tuple[tuple[int, ...], tuple[int, ...]]
    nodes: tuple[int, int]
    packed: FloatArray
    budget: CallBudget

    @property
    def record(self) -> Record:
        """The MACHINE record of ``packed``."""
        return opened(self.packed)


def build(machine: Machine, flags: int, call_limit: int) -> ExudynModel:
    """Assemble the exudyn system; ``call_limit`` is the most force evaluations of one interval."""
    container = exu.SystemContainer()
    system = container.AddSystem()
    geometry = machine.record.geometry
    ground = system.AddObject(items.ObjectGround())
    centres = (
        (float(geometry.centre_p_x), float(geometry.centre_p_y)),
        (float(geometry.centre_g_x), float(geometry.centre_g_y)),
    )
    # The pinion turns clockwise: its driving torque is -T_p. The brake acts against the gear: also negative.
    torques = (-machine.torque_pinion, -machine.torque_gear)
    bodies: tuple[int, ...] = ()
    if machine.train is None:
        nodes = tuple(_add_gear(system, ground, machine, i, centres[i], torques[i]) for i in range(2))
    else:
        nodes, bodies = _add_shafts(system, machine, machine.train, centres)
    packed = machine.packed.copy()
    budget = CallBudget(call_limit)
    mesh = system.AddObject(
        items.ObjectGenericODE2(
            nodeNumbers=list(nodes),
            massMatrix=np.zeros((6, 6)),
            forceUserFunction=_force_function(flags, packed, budget),
        )
    )
    position, velocity = (
        tuple(_sensor(system, int(body), kind) for body in bodies or (mesh,))
        for kind in (exu.OutputVariableType.Coordinates, exu.OutputVariableType.Coordinates_t)
    )
    system.Assemble()
    return ExudynModel(
        machine=machine,
        flags=flags,
        container=container,
        system=system,
        sensors=(position, velocity),
        nodes=(nodes[0], nodes[1]),
        packed=packed,
        budget=budget,
    )


def _sensor(system: exu.MainSystem, body: int, kind: exu.OutputVariableType) -> int:
    sensor = items.SensorBody(bodyNumber=body, outputVariableType=kind, storeInternal=True, writeToFile=False)
    return int(system.AddSensor(sensor))


def stored(model: ExudynModel) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Times (n,), coordinates and velocities (n, size) that the sensors stored in the last run."""
    positions, velocities = (
        [np.asarray(model.system.GetSensorStoredData(sensor)) for sensor in sensors]
        for sensors in model.sensors
    )
    times = positions[0][:, 0]
    train = model.machine.train
    if train is None:
        return times, positions[0][:, 1:], velocities[0][:, 1:]
    q, v = np.empty((2, times.size, train.size))
    for states, of_shafts in ((q, positions), (v, velocities)):
        for places, rows in zip(train.places, of_shafts, strict=True):
            states[:, places] = rows[:, 1:]
    return times, q, v


def _add_shafts(
    system: exu.MainSystem, machine: Machine, train: Train, centres: tuple[tuple[float, float], ...]
) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Add both shafts with gears, bearings and torques. Return the nodes of the gears, and the objects.

    The nodes of the gears are added first, so the coordinates of the system have the order of ``Train``.
    """
    nodes = tuple(
        int(system.AddNode(items.NodeRigidBody2D(referenceCoordinates=[*centre, 0.0]))) for centre in centres
    )
    objects = []
    for number, (node, shaft) in enumerate(zip(nodes, train.shafts, strict=True)):
        body_nodes = [node]
        further = shaft.size - 3
        if further:
            modal = items.NodeGenericODE2(
                numberOfODE2Coordinates=further,
                referenceCoordinates=[0.0] * further,
                initialCoordinates=[0.0] * further,
                initialCoordinates_t=[0.0] * further,
            )
            body_nodes.append(int(system.AddNode(modal)))
        body = items.ObjectGenericODE2(
            nodeNumbers=body_nodes,
            massMatrix=shaft.mass,
            stiffnessMatrix=shaft.stiffness,
            dampingMatrix=shaft.damping,
            **_load_of(machine, train, number),
        )
        objects.append(int(system.AddObject(body)))
    return nodes, tuple(objects)


def _load_of(machine: Machine, train: Train, number: int) -> dict[str, object]:
    """Force of motor or load on the shaft of the pinion (0) or the gear (1); a function where it ripples."""
    by_unit_torque = train.shafts[number].torque
    places = train.places[number]
    state = np.zeros((1, train.size))

    def force(_: object, t: float, _item: int, q: list[float], _rates: list[float]) -> FloatArray:
        state[0, places] = q
        return np.asarray(-machine.torques(np.array([t]), state)[0, number] * by_unit_torque)

    if machine.has_ripples:
        return {"forceUserFunction": force}
    return {"forceVector": force(None, 0.0, 0, [0.0] * places.size, [])}


def _add_gear(
    system: exu.MainSystem,
    ground: int,
    machine: Machine,
    number: int,
    centre: tuple[float, float],
    torque: float,
) -> int:
    """Add the pinion (0) or the gear (1): node, rigid body, bearing to ground, torque. Return the node."""
    node = system.AddNode(items.NodeRigidBody2D(referenceCoordinates=[*centre, 0.0]))
    system.AddObject(
        items.ObjectRigidBody2D(
            mass=float(machine.mass[number]), inertia=float(machine.inertia[number]), nodeNumber=node
        )
    )
    # Markers on nodes and coordinates cost exudyn half of what markers on bodies do.
    at_node = system.AddMarker(items.MarkerNodePosition(nodeNumber=node))
    at_ground = system.AddMarker(items.MarkerBodyPosition(bodyNumber=ground, localPosition=[*centre, 0.0]))
    system.AddObject(
        items.ObjectConnectorCartesianSpringDamper(
            markerNumbers=[at_ground, at_node],
            stiffness=[*machine.bearing_stiffness[number].tolist(), 0.0],
            damping=[*machine.bearing_damping[number].tolist(), 0.0],
        )
    )
    angle = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=2))
    system.AddLoad(items.LoadCoordinate(markerNumber=angle, load=torque))
    return int(node)


def _force_function(flags: int, packed: FloatArray, budget: CallBudget) -> Callable[..., list[float]]:
    """Return the user function of the contact object. The function writes into buffers of its own.

    exudyn calls the function some thousand times per mesh cycle. So both lists of exudyn are packed into one
    buffer, which is twice as fast as assignment to arrays. exudyn reads a list faster than an array.
    """
    buffer = bytearray(struct.calcsize("18d"))
    state = np.frombuffer(buffer).reshape(3, 6)
    wrench = state[WRENCH]
    contacts = np.empty(CONTACTS_SIZE)
    pack = struct.Struct("12d").pack_into
    as_list: Callable[[], list[float]] = wrench.tolist
    last_coordinates: list[float] = []
    last_rates = last_coordinates
    last_forces = last_coordinates

    def forces(
        _system: exu.MainSystem, t: float, _item: int, coordinates: list[float], rates: list[float]
    ) -> list[float]:
        nonlocal last_coordinates, last_rates, last_forces
        budget.calls += 1
        if budget.calls > budget.look:
            budget.check(t)
        # The last stage of a step is the first of the next.
        if t == budget.last and coordinates == last_coordinates and rates == last_rates:
            return last_forces
        budget.last = t
        last_coordinates = coordinates
        last_rates = rates
        pack(buffer, 0, *coordinates, *rates)
        if tooth_forces(t, state, packed, flags, contacts) < 0:
            budget.reason = "not finite"
            raise _Stop
        last_forces = as_list()
        return last_forces

    return forces


def contact_state(model: ExudynModel, times: FloatArray, q: FloatArray, v: FloatArray) -> ContactStates:
    """Evaluate the force core at n states (n, size), without exudyn."""
    return tooth_forces_over(times, q, v, model.packed, model.flags)


def accelerations(model: ExudynModel, times: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
    """Accelerations (n, size) from Newton's and Euler's laws at n states (n, size), without exudyn."""
    force = contact_state(model, times, q, v).wrenches
    train = model.machine.train
    if train is not None:
        on_train = -(q @ train.stiffness.T + v @ train.damping.T)
        on_train -= model.machine.torques(times, q) @ train.torques
        on_train[:, :6] += force
        return np.asarray(on_train @ train.inverse, dtype=np.float64)
    bodies = model.machine.bodies
    by_bearings = bodies["stiffness"] * q
    total = force + bodies["load"] - by_bearings - bodies["damping"] * v
    return np.asarray(total / bodies["inertia"], dtype=np.float64)
