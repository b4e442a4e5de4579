"""Periodic motions with contact forces that no record of ``lumped`` says: other forces when teeth part.

Fixed steps of the classical Runge-Kutta method run over a mesh cycle; Broyden's method closes it. The
unknowns are the twelve states and the brake torque that holds the mean speed. Steps end where a law of a
tooth pair jumps or bends.

Sources: docs/how_to/check_your_model.md, "Explanations"; docs/theory/equations.md for the equations; the
exponent of the contact force as in the impact functions of multibody programs.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, Literal, NamedTuple

import numpy as np
import xarray as xr

from lumped.compiler import called, compiled
from lumped.errors import NumericalError
from lumped.model.mesh_cycle import PairState
from lumped.model.period_closure import close_period
from lumped.model.periodic_system import LTVSystem
from lumped.model.propagation import fastest_frequency
from lumped.model.results import dataset
from lumped.model.steady import UNSTABLE, periodic_solution, relative_spectral_radius, sample_times
from lumped.typing import FloatArray
from validation.check.explanations.friction_courses import static_friction

ContactForce = Literal[
    "",
    "no rate of the errors",
    "damper across the gap",
    "sum of the pairs",
    "exponent 1.5",
    "exponent 1.5 of one pair",
    "exponent 1.5 in millimetres",
    "exponent 10/9",
    "exponent 2.2",
    "friction by the static load",
    "friction by the static load in equal shares",
]
#: Contact forces of unilateral teeth whose friction follows a load that does not vibrate.
OF_STATIC_LOAD: tuple[ContactForce, ContactForce] = (
    "friction by the static load",
    "friction by the static load in equal shares",
)
#: Exponents of the contact force.
EXPONENTS: Mapping[ContactForce, float] = MappingProxyType(
    {
        "exponent 1.5": 1.5,
        "exponent 1.5 of one pair": 1.5,
        "exponent 1.5 in millimetres": 1.5,
        "exponent 10/9": 10.0 / 9.0,
        "exponent 2.2": 2.2,
    }
)
#: Kinds of the contact force in the kernel.
_UNILATERAL, _OPEN_DAMPER, _OF_SUM, _GIVEN_FRICTION = range(4)
_KINDS: Mapping[ContactForce, int] = MappingProxyType(
    {
        "damper across the gap": _OPEN_DAMPER,
        "sum of the pairs": _OF_SUM,
        **dict.fromkeys(OF_STATIC_LOAD, _GIVEN_FRICTION),
    }
)
#: Columns of a table of tooth pairs. Where friction is given, its force stands for the coefficient.
_K, _C, _MU, _E, _E_RATE, _XI = range(6)
#: Largest angle of the fastest frequency in a step [rad], fewest and most steps in a mesh cycle.
_STEP_ANGLE = 0.5
_FEWEST = 500
_MOST = 12_000
#: Mesh cycles that run before the search, first and once more where it fails; derivatives that are computed
#: anew, steps of Broyden's method from each; what closes.
_SETTLING = (10, 200)
_NEWTON = 4
_BROYDEN = 12
_CLOSED = 1e-7
_DIFFERENCE = 1e-5
#: A compression below this share of the reference deflection is none.
_STATES = 12


class _Cycle(NamedTuple):
    """A mesh cycle in steps.

    Attributes
    ----------
    lengths : (n,) steps [s]
    recorded : (n,) number of the output at the start of the step; -1: none
    table : (n, 3, pairs, 6) stiffness, damper, friction, error and its rate, position at both ends and in the
        middle of each step
    """

    lengths: FloatArray
    recorded: np.ndarray[Any, np.dtype[np.int64]]
    table: FloatArray


@called
def pair_load(kind: int, exponent: float, reference: float, x: float, v: float, k: float, c: float) -> float:
    """Load of a tooth pair with the compression x and its rate v, before a sum is cut [N].

    k d (x/d)^n with the exponent n and the reference deflection d, and the damper c v.
    """
    if kind == _OF_SUM:
        return k * x + c * v
    spring = 0.0
    if x > 0.0:
        spring = k * x if exponent == 1.0 else k * reference * (x / reference) ** exponent
    if kind == _OPEN_DAMPER:
        return spring + c * v
    return max(spring + c * v, 0.0) if x > 0.0 else 0.0


@called
def write_loads(
    kind: int, exponent: float, reference: float, approach: float, rate: float, pairs: FloatArray,
    loads: FloatArray,
) -> None:  # fmt: skip
    """Write the load of each tooth pair (pairs,) [N]."""
    total = 0.0
    for i in range(pairs.shape[0]):
        loads[i] = 0.0
        if pairs[i, _K] > 0.0:
            loads[i] = pair_load(
                kind,
                exponent,
                reference,
                approach - pairs[i, _E],
                rate - pairs[i, _E_RATE],
                pairs[i, _K],
                pairs[i, _C],
            )
            total += loads[i]
    if kind == _OF_SUM and total < 0.0:
        for i in range(pairs.shape[0]):
            loads[i] = 0.0


@called
def write_rates(
    state: FloatArray, force: FloatArray, laws: FloatArray, kind: int, exponent: float, reference: float,
    pairs: FloatArray, loads: FloatArray, rates: FloatArray,
) -> None:  # fmt: skip
    """Write the rates (12,) of a state, and the loads of the tooth pairs.

    ``laws`` has the rows mass, damping, stiffness, deflection, normal, and both rows of the friction arms;
    ``force`` (6,) the torques.
    """
    approach = 0.0
    rate = 0.0
    for j in range(6):
        approach += laws[3, j] * state[j]
        rate += laws[3, j] * state[6 + j]
    write_loads(kind, exponent, reference, approach, rate, pairs, loads)
    normal = 0.0
    friction = 0.0
    moment = 0.0
    for i in range(pairs.shape[0]):
        normal += loads[i]
        of_pair = pairs[i, _MU] if kind == _GIVEN_FRICTION else pairs[i, _MU] * loads[i]
        friction += of_pair
        moment += of_pair * pairs[i, _XI]
    for j in range(6):
        rates[j] = state[6 + j]
        total = force[j] + laws[4, j] * normal + laws[5, j] * friction + laws[6, j] * moment
        total -= laws[1, j] * state[6 + j] + laws[2, j] * state[j]
        rates[6 + j] = total / laws[0, j]


@compiled
def run_cycles(
    state: FloatArray,
    force: FloatArray,
    laws: FloatArray,
    kind: int,
    exponent: float,
    reference: float,
    lengths: FloatArray,
    recorded: np.ndarray[Any, np.dtype[np.int64]],
    table: FloatArray,
    cycles: int,
    states: FloatArray,
    loads: FloatArray,
) -> None:
    """Take a state (12,) through mesh cycles in place; write states and loads at the outputs of the last."""
    pairs = table.shape[2]
    of_pairs = np.empty(pairs)
    trial = np.empty(12)
    k1 = np.empty(12)
    k2 = np.empty(12)
    k3 = np.empty(12)
    k4 = np.empty(12)
    for _ in range(cycles):
        for step in range(lengths.size):
            h = lengths[step]
            write_rates(state, force, laws, kind, exponent, reference, table[step, 0], of_pairs, k1)
            if recorded[step] >= 0:
                for j in range(12):
                    states[recorded[step], j] = state[j]
                for i in range(pairs):
                    loads[i, recorded[step]] = of_pairs[i]
            for j in range(12):
                trial[j] = state[j] + 0.5 * h * k1[j]
            write_rates(trial, force, laws, kind, exponent, reference, table[step, 1], of_pairs, k2)
            for j in range(12):
                trial[j] = state[j] + 0.5 * h * k2[j]
            write_rates(trial, force, laws, kind, exponent, reference, table[step, 1], of_pairs, k3)
            for j in range(12):
                trial[j] = state[j] + h * k3[j]
            write_rates(trial, force, laws, kind, exponent, reference, table[step, 2], of_pairs, k4)
            for j in range(12):
                state[j] += h / 6.0 * (k1[j] + 2.0 * (k2[j] + k3[j]) + k4[j])


class _Runs:
    """Runs over the mesh cycle of a system with another contact force."""

    def __init__(self, system: LTVSystem, contact: ContactForce, samples: int) -> None:
        self.system = system
        self.samples = samples
        s = system.structure
        self.laws = np.stack([s.mass, s.damping, s.stiffness, s.deflection, s.normal, *s.friction_arm.T])
        self.kind = _KINDS.get(contact, _UNILATERAL)
        self.exponent = EXPONENTS.get(contact, 1.0)
        force = system.pinion_torque / system.pair.geometry.base_radius_pinion
        self.deflection = force / system.cycle.mean_stiffness
        low, high = system.cycle.elements.stiffness.interval
        middle = float(system.cycle.elements.stiffness(np.array([0.5 * (low + high)]))[0])
        references = {"exponent 1.5 of one pair": force / middle, "exponent 1.5 in millimetres": 1e-3}
        self.reference = references.get(contact, self.deflection)
        self.equal = contact == OF_STATIC_LOAD[1]
        self.cycle = self._cycle(with_rate=contact != "no rate of the errors")

    def friction_of(self, pairs: PairState) -> FloatArray:
        """What the friction of each pair is made of (pairs, k): its coefficient, or its force [N]."""
        if self.kind != _GIVEN_FRICTION:
            return pairs.friction
        return static_friction(self.system, pairs, equal=self.equal)

    def _cycle(self, *, with_rate: bool) -> _Cycle:
        """The mesh cycle in steps that end at outputs and wherever a law of a pair jumps or bends."""
        cycle = self.system.cycle
        longest = cycle.period / _FEWEST
        fastest = fastest_frequency(self.system)
        if fastest > 0.0:
            longest = min(longest, _STEP_ANGLE / fastest)
        if cycle.period / longest > _MOST:
            raise NumericalError("Bearings are too stiff for runs with another contact force.")
        outputs = np.arange(self.samples + 1) * (cycle.period / self.samples)
        inner = cycle.bends
        near = 1e-9 * cycle.period
        inner = inner[np.abs(inner[:, None] - outputs).min(axis=1, initial=np.inf) > near]
        marks = np.sort(np.concatenate([outputs, inner]))
        marks = marks[np.diff(marks, prepend=-1.0) > near]
        parts = np.maximum(1, np.ceil(np.diff(marks) / longest)).astype(np.int64)
        number = np.arange(parts.sum()) - np.repeat(np.cumsum(parts) - parts, parts)
        edges = np.append(
            np.repeat(marks[:-1], parts) + np.repeat(np.diff(marks) / parts, parts) * number, marks[-1]
        )
        lengths = np.diff(edges)
        recorded = np.full(lengths.size, -1, dtype=np.int64)
        recorded[np.searchsorted(edges, outputs[:-1] - near)] = np.arange(self.samples)
        inside = np.array([1e-6, 0.5, 1.0 - 1e-6])
        times = (edges[:-1, None] + inside * lengths[:, None]).ravel()
        pairs = cycle.sample(times)
        columns = (
            pairs.stiffness,
            pairs.damping,
            self.friction_of(pairs),
            pairs.error,
            pairs.error_rate,
            pairs.position,
        )
        table = np.stack(columns, axis=-1)
        if not with_rate:
            table[..., _E_RATE] = 0.0
        count = pairs.stiffness.shape[0]
        by_step = table.transpose(1, 0, 2).reshape(lengths.size, 3, count, len(columns))
        return _Cycle(lengths, recorded, np.ascontiguousarray(by_step))

    def over(
        self, state: FloatArray, brake: float, cycles: int = 1
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """State after mesh cycles, states (k, 12) and loads (pairs, k) at the outputs of the last cycle."""
        states = np.empty((self.samples, _STATES))
        loads = np.empty((self.cycle.table.shape[2], self.samples))
        force = np.zeros(6)
        force[0] = self.system.pinion_torque
        force[1] = -brake
        end = state.copy()
        law = self.kind, self.exponent, self.reference
        run_cycles(end, force, self.laws, *law, *self.cycle, cycles, states, loads)
        return end, states, loads


def contact_motion(
    system: LTVSystem, contact: ContactForce, attributes: Mapping[str, Any], samples: int
) -> xr.Dataset:
    """Return the periodic motion of like teeth on springs with another contact force.

    Parameters
    ----------
    system : the "full" system, whose laws of tooth pairs are those of the motion
    contact : the contact force
    attributes : of the dataset
    samples : samples in the mesh cycle

    Raises
    ------
    NumericalError : no stable periodic motion was found
    """
    if system.pair.operating.brake_torque != "balanced":
        raise NumericalError("Another contact force needs a brake torque that balances.")
    runs = _Runs(system, contact, samples)
    start = periodic_solution(system, np.zeros(1), estimate_error=False)
    state, brake = start.states[0].copy(), start.brake_torque
    if not np.isfinite(state).all():
        raise NumericalError("The linear motion is not finite.")
    for cycles in _SETTLING:
        state = _without_common(system, runs.over(state, brake, cycles)[0])
        closed = _closed(runs, state, brake)
        if closed is not None:
            state, brake, radius = closed
            if radius > UNSTABLE:
                raise NumericalError("The motion with another contact force is unstable.")
            return _labelled(runs, state, brake, attributes)
    raise NumericalError("No motion with another contact force was found.")


def _without_common(system: LTVSystem, state: FloatArray) -> FloatArray:
    """The state without common rotation and its rate."""
    supports = system.supports
    return np.asarray(supports.from_relative_states @ (supports.to_relative_states @ state))


def _closed(runs: _Runs, state: FloatArray, brake: float) -> tuple[FloatArray, float, float] | None:
    """State, brake torque and spectral radius of the motion that closes, by Broyden's method; None: none.

    The last equation holds the common rotation at 0.
    """
    system = runs.system
    weights = np.append(system.supports.common_weights, np.zeros(6))
    weights = weights / np.abs(weights).max()
    omega = 2.0 * math.pi / system.period
    lengths = np.append(1.0 / np.abs(system.structure.deflection[:2]), np.ones(4)) * runs.deflection
    scale = np.concatenate([lengths, lengths * omega, [abs(brake)]])
    unknowns = np.append(state, brake) / scale

    def mismatch(x: FloatArray) -> tuple[FloatArray, None]:
        values = x * scale
        end, _, _ = runs.over(values[:_STATES], values[_STATES])
        closes = weights @ values[:_STATES] / lengths[0]
        return np.append((end - values[:_STATES]) / scale[:_STATES], closes), None

    def slopes_at(x: FloatArray) -> FloatArray:
        here, _ = mismatch(x)
        moved = x + _DIFFERENCE * np.eye(_STATES + 1)
        return np.stack([(mismatch(one)[0] - here) / _DIFFERENCE for one in moved], axis=1)

    for _ in range(_NEWTON):
        slopes = slopes_at(unknowns)
        if not np.isfinite(slopes).all():
            return None
        closed = close_period(
            mismatch, unknowns, np.ones(_STATES + 1), slopes, closed=_CLOSED, most=_BROYDEN, patience=3
        )
        unknowns = closed.unknowns
        if closed.mismatch <= _CLOSED:
            phi = slopes_at(unknowns)[:_STATES, :_STATES] + np.eye(_STATES)
            phi = scale[:_STATES, None] * phi / scale[:_STATES]
            found = unknowns * scale
            return found[:_STATES], float(found[_STATES]), relative_spectral_radius(system, phi)
    return None


def _labelled(runs: _Runs, state: FloatArray, brake: float, attributes: Mapping[str, Any]) -> xr.Dataset:
    """The motion as a dataset, with the loads of its contact force."""
    system = runs.system
    _, states, loads = runs.over(state, brake)
    times = sample_times(system.period, runs.samples)
    torques = {"pinion_torque": system.pinion_torque, "brake_torque": brake}
    motion = dataset(system, times, states, dict(attributes) | torques)
    friction = motion["mu"].to_numpy() * loads
    if runs.kind == _GIVEN_FRICTION:
        friction = runs.friction_of(system.cycle.sample(times))
    for name, values in (("normal_load", loads), ("friction_force", friction)):
        motion[name] = motion[name].copy(data=values)
    return motion
