"""Periodic motion and stability of the multibody model: perturbed states over one mesh cycle.

The map of 12 states has a double multiplier +1, the rigid rotation of the free gear train. Stability is
judged by the 10 states of the relative form (q, x_p, x_g, y_p, y_g and rates, q = r_bp theta_p - r_bg
theta_g). A perturbation of these states leaves the rigid rotation J_p theta_p/r_bp + J_g theta_g/r_bg fixed.

Sources: docs/theory/multibody.md, "Stability".
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, get_args

import numpy as np
from numpy.typing import ArrayLike

from lumped.arguments import one_of, whole_number
from lumped.display.result import DisplayedResult
from lumped.errors import NumericalError
from lumped.model.period_closure import close_period
from lumped.model.periodic_system import Supports, on_springs, supports_of
from lumped.model.propagation import step_maps
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.typing import ComplexArray, FloatArray
from multibody.contact.machine import Machine
from multibody.run.integration import Segment, keep_inside
from multibody.run.linear_motion import bordered, state_scale
from multibody.run.model import build, from_lumped_state, to_lumped_state
from multibody.run.powers import Powers, work
from multibody.run.setup import Fidelity, Setup, prepare
from multibody.run.simulation import record

if TYPE_CHECKING:
    import xarray as xr


#: Relative tolerance of the runs from which the map is computed, where the caller does not give one.
_RTOL = {"linear": 1e-9, "exact": 1e-10}
#: Perturbation over the static deflection. At "linear" the size does not matter, and is large. At "exact"
#: central differences err by the square of the perturbation times the nonlinearity, and by rtol over the
#: perturbation.
_STEP = {"linear": 1.0, "exact": 1e-3}
#: Mismatch over one cycle, relative to the scale of each state: the iteration stops at this multiple of
#: rtol ...
_CLOSED = 10.0
#: ... and accepts a mismatch below this where the mismatch stops falling before.
_ACCEPTED = 1e-5
#: Steps without a smaller mismatch before the iteration is given up, and most steps.
_PATIENCE = 8
_ITERATIONS = 40
#: Column of the lumped forcings, after the errors of the teeth and the driving torque.
_BY_BRAKE = 2


@dataclass(frozen=True, eq=False, repr=False)
class FlowMap(DisplayedResult):
    """Periodic motion and its linearised map over one mesh cycle.

    Attributes
    ----------
    matrix : (10, 10) map of (q, x_p, x_g, y_p, y_g and rates)
    full : (12, 12) map of the lumped states (theta_p, theta_g, x_p, x_g, y_p, y_g and rates)
    state : (12,) state of the motion at t = 0
    brake_torque : torque that balances the motion [N m]
    closure : largest change of a state over one cycle, relative to the scale of the state
    read, lift : (10, 12) from lumped states to relative states; (12, 10) from perturbations of the relative
        states to perturbations of the lumped states, with the rigid rotation fixed
    """

    matrix: FloatArray
    full: FloatArray
    read: FloatArray
    lift: FloatArray
    state: FloatArray
    brake_torque: float
    closure: float

    @property
    def multipliers(self) -> ComplexArray:
        """Characteristic multipliers of the relative form, largest modulus first."""
        values = np.linalg.eigvals(self.matrix).astype(np.complex128)
        return values[np.argsort(-np.abs(values), kind="stable")]

    @property
    def spectral_radius(self) -> float:
        """Largest modulus of a multiplier: above 1 the motion is unstable."""
        return float(np.abs(self.multipliers[0]))


def monodromy(
    pair: AnyPair,
    *,
    fidelity: Fidelity = "exact",
    effects: Collection[str] | Mapping[str, bool] | None = None,
    rtol: float | None = None,
    supports: Supports | None = None,
) -> FlowMap:
    """Monodromy matrix by perturbed runs over one mesh cycle, about the model's own periodic motion.

    Parameters
    ----------
    pair : a validated gear pair
    fidelity, effects : as ``multibody.simulate``
    rtol : relative tolerance of the runs; default 1e-9, at fidelity "exact" 1e-10. The error of the map is
        some times rtol; at "exact" some times rtol over 1e-3
    supports : "springs", the only supports of this function; needed for a pair with shafts

    Raises
    ------
    NumericalError : no periodic motion is found near the lumped motion
    """
    pair = on_springs(load_gear_pair(pair), supports, "multibody.monodromy")
    one_of("fidelity", fidelity, get_args(Fidelity))
    tolerance = _RTOL[fidelity] if rtol is None else rtol
    setup = prepare(pair, fidelity, "periodic", effects, tolerance, supports="springs")
    orbit = find_orbit(setup)
    end = orbit.flow(orbit.state) if fidelity == "linear" else None
    scale = state_scale(orbit.machine, setup.deflection)
    full = _differences(orbit.flow, orbit.state, scale * _STEP[fidelity], end)
    read, lift = _relative(orbit.machine)
    brake = orbit.machine.torque_gear
    return FlowMap(read @ full @ lift, full, read, lift, orbit.state, brake, orbit.closure)


@dataclass(frozen=True, eq=False)
class Orbit:
    """A motion that closes after one mesh cycle.

    state : (12,) lumped states at t = 0; on shafts (2n,) coordinates and velocities
    machine : numbers of the pair, with the brake torque that balances this motion
    flow : flow map of the motion
    closure : largest change of a state over the flow map, relative to the scale of the state
    derivatives : derivatives of the mismatch after the cycles, as ``close_period`` returns them. A search
        for a motion nearby may start from these derivatives
    """

    state: FloatArray
    machine: Machine
    flow: Flow
    closure: float
    derivatives: FloatArray


def find_orbit(
    setup: Setup, cycles: int = 1, *, near_lumped: bool = True, near: Orbit | None = None
) -> Orbit:
    """Periodic motion near the initial state of ``setup``, with the brake torque as unknown.

    ``close_period`` starts from the monodromy matrix of the lumped model. On shafts the search starts from
    the matrix of the multibody model with the linear mesh.

    near_lumped : False where the lumped model has no motion nearby; then differences supply the matrix
    near : motion of the pair with other effects, from which the search starts
    Raises NumericalError : the iteration does not close the cycle
    """
    machine = setup.machine
    scale = state_scale(setup.machine, setup.deflection)
    if near is None:
        state = _packed(machine, setup.q, setup.v)
        derivatives = -_first_matrix(setup, state, scale, cycles, near_lumped)
    else:
        state = near.state
        derivatives = near.derivatives
        machine = replace(machine, torque_gear=near.machine.torque_gear)
    torque = machine.torque_gear

    def over_cycles(unknowns: FloatArray) -> tuple[FloatArray, Flow]:
        """Mismatch of the state after the cycles. The free rotation is not changed."""
        flow = Flow(setup, replace(machine, torque_gear=float(unknowns[-1])), cycles)
        return np.append((flow(unknowns[:-1]) - unknowns[:-1]) / scale, 0.0), flow

    best = close_period(
        over_cycles,
        np.append(state, torque),
        np.append(scale, torque),
        derivatives,
        closed=_CLOSED * setup.rtol,
        most=_ITERATIONS,
        patience=_PATIENCE,
    )
    if not best.mismatch < _ACCEPTED:
        raise NumericalError(
            f"No periodic multibody motion near the {'lumped one' if near_lumped else 'start'} (mismatch "
            f"{best.mismatch:.1e}): the pair may separate or sit on a stability boundary. Change the speed "
            "or the torque, or run multibody.simulate."
        )
    flow = best.passed
    machine = replace(machine, torque_gear=float(best.unknowns[-1]))
    return Orbit(best.unknowns[:-1], machine, flow, best.mismatch, best.derivatives)


def _first_matrix(
    setup: Setup, state: FloatArray, scale: FloatArray, cycles: int, near_lumped: bool
) -> FloatArray:
    """Matrix of the first step to a periodic motion, from the state of ``setup``; see ``find_orbit``."""
    machine = setup.machine
    if near_lumped and setup.motion is not None:
        transition = setup.motion.transition
        by_torque = setup.motion.by_torque
    elif near_lumped:
        system = setup.system
        maps = step_maps(system, np.stack([system.torque_pinion, system.torque_gear], axis=1))
        transition, forced = maps.over_all
        by_torque = forced[:, _BY_BRAKE]
    else:
        # Central differences: with one-sided differences Newton's method does not find motions far above the
        # resonances, where contact is lost.
        flow = Flow(setup, machine, cycles)
        end = flow(state)
        transition = _differences(flow, state, scale * _STEP["exact"])
        more = replace(machine, torque_gear=machine.torque_gear * (1.0 + _STEP["exact"]))
        by_torque = (Flow(setup, more, cycles)(state) - end) / (more.torque_gear - machine.torque_gear)
    if machine.train is None:
        turn = machine.inertia / machine.base_radii
    else:
        turn = machine.train.mass @ machine.train.free_turn
    return bordered(transition, by_torque, turn, scale, machine.torque_gear)


def steady_state(
    pair: AnyPair,
    *,
    fidelity: Fidelity = "exact",
    samples_per_cycle: int = 512,
    initial: ArrayLike | None = None,
    cycles: int = 1,
    effects: Collection[str] | Mapping[str, bool] | None = None,
    rtol: float = 1e-9,
    friction_velocity: float | None = None,
    supports: Supports | None = None,
) -> xr.Dataset:
    """Periodic motion, stable or not, without settling: the counterpart of ``lumped.steady_state``.

    Parameters
    ----------
    pair : a validated gear pair
    fidelity, effects, rtol, friction_velocity, supports : as ``multibody.simulate``
    samples_per_cycle : output times in [0, T_m)
    initial : 12 states near which the motion is looked for, as ``lumped.simulate`` takes them. None: the
        states of the lumped motion, on shafts of the motion with the linear mesh. With contact loss several
        motions may exist
    cycles : mesh cycles after which the motion repeats, 1 to 64

    Returns
    -------
    xarray.Dataset as of ``multibody.simulate`` over these cycles; the attribute ``brake_torque`` holds the
    mean speed of this model, ``power_sliding``, ``power_tooth_dampers``, ``power_bearings`` and on shafts
    ``power_shafts`` are its mean losses [W], ``mesh_efficiency`` one less all losses over the input,
    ``power_energy_residual`` what no torque balances [W], ``closure`` the relative mismatch after the cycles

    Raises
    ------
    NumericalError : no periodic motion is found near the start
    """
    pair = load_gear_pair(pair)
    cycles = whole_number("cycles", cycles, 1, 64)
    start = "periodic" if initial is None else initial
    supports = supports_of(pair, supports)
    setup = prepare(pair, fidelity, start, effects, rtol, friction_velocity, supports)
    orbit = find_orbit(setup, cycles, near_lumped=initial is None and cycles == 1)
    return cycles_of(orbit, samples_per_cycle, cycles)


def cycles_of(orbit: Orbit, samples_per_cycle: int, cycles: int = 1) -> xr.Dataset:
    """What ``steady_state`` returns of an orbit."""
    q, v = _unpacked(orbit.machine, orbit.state)
    setup = replace(orbit.flow.setup, q=q, v=v)
    run, _, _ = record(setup, cycles, samples_per_cycle, run=orbit.flow.again)
    mean = mean_powers(orbit, cycles)
    places = ("sliding", "tooth_dampers", "bearings", *(() if orbit.machine.train is None else ("shafts",)))
    run.attrs |= {f"power_{place}": float(getattr(mean, place)) for place in places} | {
        "power_energy_residual": float(mean.energy_residual),
        "brake_torque": orbit.machine.torque_gear,
        "mesh_efficiency": float(1.0 - mean.lost / mean.driving),
        "closure": orbit.closure,
    }
    return run.isel(time=slice(None, -1))


def mean_powers(orbit: Orbit, cycles: int) -> Powers:
    """Mean powers of an orbit over the mesh cycles [W], from the segments of the run."""
    totals = np.zeros(len(Powers._fields))

    def visit(_: int, segment: Segment) -> None:
        totals[:] += work(orbit.flow.setup.model, segment)

    edges = orbit.flow.setup.edges(cycles)
    orbit.flow.again(edges, visit)
    return Powers(*(totals / (edges[-1] - edges[0])))


class Flow:
    """State as in ``Orbit`` -> state after whole mesh cycles."""

    def __init__(self, setup: Setup, machine: Machine, cycles: int = 1) -> None:
        model = build(machine, setup.model.flags, setup.model.budget.limit)
        self.setup = replace(setup, model=model)
        self.edges = setup.edges(cycles)
        self.segments: list[Segment] = []

    def __call__(self, state: FloatArray) -> FloatArray:
        machine = self.setup.machine
        q, v = _unpacked(machine, state)
        self.segments = []
        end = replace(self.setup, q=q, v=v).run(self.edges, lambda _, segment: self.segments.append(segment))
        return _packed(machine, *end)

    def again(
        self, edges: FloatArray, visit: Callable[[int, Segment], None]
    ) -> tuple[FloatArray, FloatArray]:
        """Visit the intervals of the last run once more, as ``Setup.run`` would."""
        for number, (segment, (start, stop)) in enumerate(
            zip(self.segments, itertools.pairwise(edges), strict=True)
        ):
            if self.setup.position_is_nominal:
                keep_inside(self.setup.model, float(start), float(stop))
            visit(number, segment)
        return self.segments[-1].q[-1], self.segments[-1].v[-1]


def _packed(machine: Machine, q: FloatArray, v: FloatArray) -> FloatArray:
    """State as in ``Orbit`` of coordinates and velocities."""
    return to_lumped_state(q, v) if machine.train is None else np.concatenate([q, v])


def _unpacked(machine: Machine, state: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Coordinates and velocities of a state as in ``Orbit``."""
    return (
        from_lumped_state(state) if machine.train is None else (state[: machine.size], state[machine.size :])
    )


def _differences(
    flow: Flow, state: FloatArray, steps: FloatArray, end: FloatArray | None = None
) -> FloatArray:
    """Columns of the map: differences to the state ``end`` after the cycles; None: central differences."""
    columns = []
    for i, h in enumerate(steps):
        ahead = state.copy()
        behind = state.copy()
        ahead[i] += h
        behind[i] -= h
        change = (flow(ahead) - flow(behind)) / 2.0 if end is None else flow(ahead) - end
        columns.append(change / h)
    return np.stack(columns, axis=1)


def _relative(machine: Machine) -> tuple[FloatArray, FloatArray]:
    """Matrices ``read`` (10, 12) and ``lift`` (12, 10) of ``FlowMap``."""
    radii = machine.base_radii * (1.0, -1.0)
    by_inertia = radii / machine.inertia
    down = np.zeros((5, 6))
    up = np.zeros((6, 5))
    down[0, :2] = radii
    up[:2, 0] = by_inertia / (radii @ by_inertia)
    down[1:, 2:] = up[2:, 1:] = np.eye(4)
    two = np.eye(2)
    return np.asarray(np.kron(two, down), dtype=float), np.asarray(np.kron(two, up), dtype=float)
