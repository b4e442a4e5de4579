"""The linear motion of teeth that differ: maps of mesh cycles about the static state of each pair.

The steps are long. Two motions are computed with the same long steps: one with the teeth of the pair, one
with like teeth. Their difference is added to the motion of like teeth by short steps. Both motions have the
same error by the length of the steps, so this error cancels.

Sources: docs/theory/teeth.md, "The linear form", "Stability".
"""

from __future__ import annotations

import copy
import math
from functools import cached_property
from typing import NamedTuple

import numpy as np

from lumped.compiler import in_threads
from lumped.errors import NumericalError
from lumped.gauss_legendre import gauss_tableau
from lumped.mesh.linear import STATE, LinearForm
from lumped.mesh.places import fill_linear_form, static_loads
from lumped.mesh.records import AT_REST, BY_APPROACH, BY_RATE, EXACT, FORCE
from lumped.mesh.tables import MeshTables
from lumped.model.equations import THETA_G, THETA_P, Y_G, Y_P
from lumped.model.kernels import FreeSteps, Propagated, chained, propagate, states_along
from lumped.model.period_closure import BRAKE_TORQUE, MORE_PINION_TORQUE, balanced_start
from lumped.model.periodic_system import LTVSystem, Supports
from lumped.model.powers import mean_powers
from lumped.model.propagation import distinct_lengths, fastest_frequency, padded, without_mesh
from lumped.model.revolution_motion import RevolutionMotion, Touch
from lumped.model.steady import periodic_solution, sample_times
from lumped.model.swing import moments, swinging
from lumped.model.tooth_laws import ToothLaws, mesh_tables, torque_ripples
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray

#: Stages of the Gauss steps.
STAGES = 4
#: Largest angle of the fastest vibration in a step [rad]. Order 8 then errs by some 1e-5 of what the
#: deviations change in this vibration, less than the kinks of pairs that touch inside steps.
_STEP_ANGLE = 2.4
_LEAST_STEPS = 32
#: Steps may be longer than the largest step by this factor where they then end at every output.
_LONGER = 1.25
#: Mesh cycles of a block, which one thread computes; mesh cycles from which the error of the steps is
#: estimated.
_BLOCK = 64
_ESTIMATED = 16
#: Forces of ``CycleSteps.strength``: the fields of FORCE and, where gears are eccentric or a torque has a
#: ripple, the moments of N on both gears and both torques.
NORMAL, FRICTION, FRICTION_MOMENT, SEPARATING = range(4)
MOMENT_PINION, MOMENT_GEAR, TORQUE_PINION, TORQUE_GEAR = range(4, 8)


def linear_steps(system: LTVSystem) -> int:
    """Number of steps in a mesh cycle that the fastest vibration needs."""
    return max(_LEAST_STEPS, math.ceil(fastest_frequency(system) * system.period / _STEP_ANGLE))


class CycleSteps:
    """The linear form at the Gauss steps of the mesh cycles, in blocks of cycles; one thread computes one
    block.

    Steps end wherever a law of like teeth is not smooth. Only the deviations bring kinks inside steps.

    Parameters
    ----------
    pair : gear pair with teeth that differ
    system : coordinates, of any form
    samples : outputs in a mesh cycle
    steps : least number of steps in a mesh cycle
    only : mesh cycles; by default those of the whole period
    """

    def __init__(
        self, pair: GearPair, system: LTVSystem, samples: int, steps: int, only: range | None = None
    ) -> None:
        self.pair = pair
        self.system = system
        self.laws = ToothLaws(pair)
        tableau = gauss_tableau(STAGES)
        steps = samples if samples <= steps <= _LONGER * samples else steps
        ends = system.cycle.bends / system.period
        self.tables = mesh_tables(self.laws, 1.0 / steps, samples, tableau.c, ends)
        if system.form == "full":
            self.tables = swinging(self.tables, system)
        self.tables = self.tables._replace(law=self.tables.law._replace(converged=EXACT))
        self.lengths = np.diff(self.tables.edges) * system.period
        self.turns = bool(self.tables.turning["amplitude"].any())
        first, length_of_step = distinct_lengths(system, self.lengths)
        self.length_of_step = length_of_step[None]
        self.distinct_lengths = self.lengths[first]
        self.free = self.free_steps()
        self.width = self.free.along.shape[1]
        numbers = range(self.tables.period) if only is None else only
        self.first = numbers.start
        count = len(numbers)
        self.cycles = [(first, min(_BLOCK, numbers.stop - first)) for first in numbers[::_BLOCK]]
        # Large arrays at all stages: the operating system gives many small ones slowly.
        shape = (count, self.lengths.size, STAGES)
        self.form = LinearForm(np.empty((*shape, 3), FORCE), np.empty(shape, STATE))
        in_threads(lambda block: fill_linear_form(self.tables, block[0], self.part(*block)), self.cycles)

    def free_steps(self, *, with_rates: bool = False) -> FreeSteps:
        """Return the steps without the mesh, for all forces of ``strength``."""
        system = self.system
        m = len(self.system.coordinates)
        torques = np.stack([system.torque_pinion, system.torque_gear], axis=1)
        forces = system.directions
        if self.turns:
            forces = np.vstack([forces, moments(system), torques[m:].T])
        extra = padded(system, torques)
        tableau = gauss_tableau(STAGES)
        return without_mesh(system, self.distinct_lengths, extra, tableau, forces, with_rates=with_rates)

    def with_like_teeth(self) -> CycleSteps:
        """Return the same steps through the mesh cycle of like teeth, whose form follows from their laws."""
        system = self.system
        tables = self.tables
        low = tables.edges[:-1] * system.period
        high = tables.edges[1:] * system.period
        segment = np.searchsorted(system.cycle.edges, 0.5 * (low + high)) - 1
        times = low[:, None] + (high - low)[:, None] * tables.nodes
        forces, pairs = system.mesh_forces(times.ravel(), np.repeat(segment, STAGES))
        states = np.zeros(times.size, STATE)
        power = pairs.damper_power
        states["damper_by_square"] = power.by_square
        states["damper_by_rate"] = power.by_rate
        states["damper_at_rest"] = power.at_rest
        like = copy.copy(self)
        like.pair = self.pair.healthy
        like.first = 0
        like.cycles = [(0, 1)]
        like.form = LinearForm(forces.reshape(1, *times.shape, 3), states.reshape(1, *times.shape))
        return like

    @cached_property
    def tables_of_outputs(self) -> MeshTables:
        """Tables whose steps start at the outputs, from which the loads at the outputs are computed."""
        samples = int(self.tables.outputs.sum())
        return swinging(mesh_tables(self.laws, 1.0, samples), self.system)._replace(law=self.tables.law)

    def part(self, first: int, count: int) -> LinearForm:
        """Return the linear form of ``count`` mesh cycles from the cycle ``first`` on."""
        low = first - self.first
        return LinearForm(*(part[low : low + count] for part in self.form))

    def strength(self, first: int, form: LinearForm) -> FloatArray:
        """Strengths (cycles, steps, stages, 3, forces) of the mesh cycles from ``first`` on."""
        forces = form.forces
        states = form.states
        tables = self.tables
        of_mesh = forces.view(np.float64).reshape(*forces.shape, -1)
        if not self.turns:
            return of_mesh
        strength = np.zeros((*forces.shape, 8))
        strength[..., :MOMENT_PINION] = of_mesh
        strength[..., MOMENT_PINION] = forces["normal"] * states["moment_pinion"][..., None]
        strength[..., MOMENT_GEAR] = forces["normal"] * states["moment_gear"][..., None]
        phase = tables.edges[:-1, None] + tables.nodes * np.diff(tables.edges)[:, None]
        time = first + np.arange(len(forces))[:, None, None] + phase
        for ripple in torque_ripples(self.pair):
            turn = ripple["angle"] * np.mod(time, ripple["cycles"]) + ripple["start"]
            of_shaft = TORQUE_PINION + int(ripple["shaft"])
            strength[..., AT_REST, of_shaft] += ripple["amplitude"] * np.cos(turn)
        return strength

    def propagated(
        self, columns: FloatArray, recorded: int, strength: FloatArray, free: FreeSteps
    ) -> Propagated:
        """Take columns (cycles, columns, width) through a block of cycles; see ``propagate``."""
        deflection = np.ascontiguousarray(self.system.deflection)
        result: Propagated = propagate(columns, recorded, strength, self.length_of_step, free, deflection)
        return result

    def cycle_maps(self) -> FloatArray:
        """Affine map of each mesh cycle, (cycles, n, n + 3).

        States that move no tooth have the same map in all cycles: they are propagated once.
        """
        support = self.system.supports
        n = 2 * len(self.system.coordinates)
        moving = len(support.coordinates("mesh").names)
        full = self.system.form == "full"
        twice = np.eye(2)
        to_moving = np.kron(twice, (support.relative if full else np.eye(n // 2))[:moving])
        from_moving = np.kron(twice, (support.back if full else np.eye(n // 2))[:, :moving])
        units = np.zeros((1, 2 * moving + 3, self.width))
        units[0, : 2 * moving, :n] = from_moving.T
        units[0, 2 * moving :, n : n + 3] = np.eye(3)
        others = np.pad(np.eye(n) - (from_moving @ to_moving).T, ((0, 0), (0, self.width - n)))
        nothing = np.zeros((1, self.lengths.size, STAGES, 3, self.free.by_force.shape[2]))
        still = self.propagated(others[None], 0, nothing, self.free).ends[0].T

        def maps(block: tuple[int, int]) -> FloatArray:
            first, count = block
            strength = self.strength(first, self.part(first, count))
            ends = self.propagated(np.tile(units, (count, 1, 1)), 0, strength, self.free).ends.swapaxes(1, 2)
            return np.concatenate(
                [ends[..., : 2 * moving] @ to_moving + still, ends[..., 2 * moving :]], axis=2
            )

        return np.concatenate(in_threads(maps, self.cycles))


class SteppedMotion(NamedTuple):
    """Periodic motion by long steps.

    Attributes
    ----------
    cycles : (cycles + 1, n) states at the starts of the mesh cycles
    weights : (3,) weights of the forcings, as of ``balanced_start``
    states : (cycles, samples, n) at the outputs
    powers : mean powers [W]: "sliding", "tooth_dampers", each place of the supports, "rolling"
    """

    cycles: FloatArray
    weights: FloatArray
    states: FloatArray
    powers: dict[str, float]


def linear_motion(
    pair: GearPair, samples: int, supports: Supports = "springs", steps: int | None = None
) -> RevolutionMotion:
    """Linear periodic motion over the period of teeth that differ, by the maps of the mesh cycles.

    Parameters as of `lumped.model.unilateral_motion.settled_motion`.
    """
    system = LTVSystem.of(pair.healthy, "full", supports=supports)
    twin = periodic_solution(system, sample_times(system.period, samples), estimate_error=False)
    steps = linear_steps(system) if steps is None else steps
    m = len(system.coordinates)
    dte = system.deflection
    relative = system.supports.relative
    form = CycleSteps(pair, system, samples, steps)
    with_own = stepped_motion(form)
    like = stepped_motion(form.with_like_teeth())
    states = with_own.states + (twin.states - like.states[0])
    weights = with_own.weights + (twin.weights - like.weights)
    of_twin = mean_powers(twin).by_place
    powers = {name: with_own.powers[name] + (of_twin[name] - like.powers[name]) for name in with_own.powers}
    coarse = CycleSteps(pair, system, 1, -(-steps // 2), range(min(_ESTIMATED, form.tables.period)))
    other = states_along(coarse.cycle_maps(), with_own.cycles[0], with_own.weights)
    starts = with_own.cycles[:, :m]
    error = np.abs((starts[: len(other)] - other[:, :m]) @ dte).max() / np.abs(starts @ dte).max()
    outer = form.tables_of_outputs

    def loads(block: tuple[int, int]) -> tuple[FloatArray, FloatArray]:
        first, count = block
        return loads_of(form, outer, first, states[first : first + count])

    of_blocks, stiffness = zip(*in_threads(loads, form.cycles), strict=True)
    load = np.concatenate(of_blocks, axis=1)
    time = np.arange(load.shape[1]) / samples * system.period
    torque = system.pinion_torque + float(weights[MORE_PINION_TORQUE])
    brake = float(weights[BRAKE_TORQUE])
    largest = np.abs(starts @ relative.T).max()
    closure = float(np.abs(relative @ (starts[-1] - starts[0])).max() / largest)
    touch = Touch.TIED if form.tables.law.prescribed else Touch.LINEAR
    at_outputs = states.reshape(-1, system.size)
    return RevolutionMotion(
        *(pair, system, outer, touch, time, at_outputs, load, torque, brake, powers, closure, float(error)),
        twin.spectral_radius,
        stiffness=np.concatenate(stiffness),
        between=twin.between,
    )


def stepped_run(
    form: CycleSteps, first: int, count: int, state: FloatArray, weights: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """States (count, samples, n) at the outputs of mesh cycles, and the state (n,) at the end.

    After the last cycle of the form the first one follows again.

    Parameters
    ----------
    first, count : the first mesh cycle and the number of cycles
    state : (n,) at the start
    weights : (3,) of the forcings, as of ``SteppedMotion``
    """
    outputs = form.tables.outputs == 1
    period = sum(number for _, number in form.cycles)
    start = np.zeros((1, 1, form.width))
    at_outputs = []
    for cycle in range(first, first + count):
        start[0, 0, : state.size] = state
        start[0, 0, state.size : state.size + weights.size] = weights
        form_cycle = form.first + (cycle - form.first) % period
        ends, states, _ = form.propagated(
            start, 1, form.strength(form_cycle, form.part(form_cycle, 1)), form.free
        )
        at_outputs.append(states[0, outputs, 0])
        state = ends[0, 0, : state.size]
    return np.stack(at_outputs), state


def stepped_motion(form: CycleSteps) -> SteppedMotion:
    """Periodic motion by long steps alone, with their error."""
    cycles, weights = _closed(form)
    return SteppedMotion(cycles, weights, *_inside(form, cycles, weights))


def _closed(form: CycleSteps) -> tuple[FloatArray, FloatArray]:
    """Close the period; return states at the cycles' starts (cycles + 1, n) and weights (3,)."""
    system = form.system
    support = form.system.supports
    maps = form.cycle_maps()
    over_period = chained(maps, np.zeros(maps.shape[0], dtype=np.int64))[0]
    n = maps.shape[1]
    if not np.isfinite(over_period).all():
        raise NumericalError("The motion grows without bound: take smaller deviations or more damping.")
    start, weights = balanced_start(system, over_period[:, :n], over_period[:, n : n + 3])
    # The rounding error of the start fades within a period, except in the common rotation: it is taken off.
    change = (states_along(maps, start, weights)[-1] - start).reshape(2, n // 2)
    scale = support.common_weights
    change -= np.outer(change @ scale, support.common) / (scale @ support.common)
    return states_along(maps, start + change.ravel(), weights), weights


def _inside(form: CycleSteps, cycles: FloatArray, weights: FloatArray) -> tuple[FloatArray, dict[str, float]]:
    """States (cycles, samples, n) at the outputs, and mean powers [W] by the stages of the steps.

    Gauss steps keep the first law: with the weights of the steps, the powers of all forces cancel over a
    period.
    """
    system = form.system
    tables = form.tables
    m = len(system.coordinates)
    weight = form.lengths[:, None] * gauss_tableau(STAGES).b
    places = system.supports.places
    per_rate, nominal = working_velocities(form)
    free = form.free_steps(with_rates=True)

    def block_of(block: tuple[int, int]) -> tuple[FloatArray, FloatArray]:
        first, count = block
        part = form.part(first, count)
        start = np.zeros((count, 1, form.width))
        start[:, 0, : 2 * m] = cycles[first : first + count]
        start[:, 0, 2 * m : 2 * m + weights.size] = weights
        strength = form.strength(first, part)
        _, states, inside = form.propagated(start, 1, strength, free)
        # One-dimensional: numpy takes rows of four numbers slowly.
        approach, approach_rate = (
            inside[:, :, 0, : 2 * STAGES].reshape(-1, 2, STAGES).swapaxes(0, 1).reshape(2, -1)
        )
        rates = inside[:, :, 0, 2 * STAGES :].reshape(-1, m)
        times = np.tile(weight.ravel(), count)
        velocities = per_rate @ rates.T + nominal[:, None]
        work = np.empty(nominal.size)
        for force, parts in enumerate(strength.reshape(-1, 3, strength.shape[-1]).T[: nominal.size]):
            load = parts[BY_APPROACH] * approach + parts[BY_RATE] * approach_rate + parts[AT_REST]
            work[force] = (load * velocities[force]) @ times
        mesh = part.states.reshape(-1)
        by_motion = (mesh["damper_by_square"] * approach_rate + mesh["damper_by_rate"]) * approach_rate
        dampers = float((by_motion + mesh["damper_at_rest"]) @ times)
        # Powers of the supports are quadratic: that of few rates with the same sum of squares and products.
        size, axes = np.linalg.eigh((rates.T * times) @ rates)
        outside = system.supports.powers((axes * np.sqrt(np.maximum(size, 0.0))).T)
        sliding = work[FRICTION] + work[FRICTION_MOMENT]
        of_supports = [outside[place].sum() for place in places]
        of_block = [sliding, dampers, *of_supports, dampers - (work.sum() - sliding)]
        return states[:, tables.outputs == 1, 0], np.array(of_block)

    outputs, work = zip(*in_threads(block_of, form.cycles), strict=True)
    duration = (len(cycles) - 1) * system.period
    names = ("sliding", "tooth_dampers", *places, "rolling")
    powers = dict(zip(names, (np.sum(work, axis=0) / duration).tolist(), strict=True))
    return np.concatenate(outputs), powers


def working_velocities(form: CycleSteps) -> tuple[FloatArray, FloatArray]:
    """Velocity on which each force of the mesh works: per rate of the coordinates (forces, m), and nominal
    (forces,).

    Friction takes power by the sliding, (Omega_p + theta_p') xi - (Omega_g + theta_g') (L - xi)
    - (y_p' - y_g'). The other forces work on the vibration.
    """
    gears = form.system.gears
    g = form.pair.geometry
    off_line = gears[Y_P] - gears[Y_G]
    pinion = gears[THETA_P]
    gear = gears[THETA_G]
    per_rate = [form.system.deflection, -(g.L_XY * gear + off_line), pinion + gear, off_line]
    nominal = [0.0, -g.L_XY * g.omega_gear, g.omega_pinion + g.omega_gear, 0.0]
    if form.turns:
        per_rate += [-pinion, -gear]
        nominal += [-g.omega_pinion, -g.omega_gear]
    return np.stack(per_rate), np.array(nominal)


def loads_of(
    form: CycleSteps, outer: MeshTables, first: int, states: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Loads (pairs, k) [N] and stiffness of the mesh (k,) [N/m] at outputs.

    Parameters
    ----------
    outer : tables whose steps start at the outputs
    first : mesh cycle of the first output
    states : (k, n) at the outputs
    """
    m = len(form.system.coordinates)
    dte = form.system.deflection
    outputs = outer.outputs == 1
    by_cycle = states.reshape(-1, int(outputs.sum()), states.shape[-1])
    loads = static_loads(outer, first, len(by_cycle))[1][:, outputs]
    approach = (by_cycle[..., :m] @ dte)[..., None]
    rate = (by_cycle[..., m:] @ dte)[..., None]
    carried = loads["by_approach"] * approach + loads["by_rate"] * rate + loads["at_rest"]
    carried = np.asarray(carried.reshape(-1, carried.shape[-1]).T, dtype=np.float64)
    return carried, np.asarray(loads["by_approach"].sum(axis=-1).ravel(), dtype=np.float64)
