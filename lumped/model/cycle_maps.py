"""The linear form of teeth that differ: maps of mesh cycles about the own static state, and its motion.

The steps are long. What own teeth change is the difference of two motions by the same steps, that of the own
teeth and that of like teeth; it is added to the motion of like teeth, which short steps give. The error that
both have by the length of the steps cancels.

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
from lumped.model.kernels import FreeSteps, Propagated, chained, propagate, states_along
from lumped.model.period_closure import balanced_start
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
#: Largest angle of the fastest vibration in a step [rad]: order 8 errs by some 1e-5 of the change of that
#: vibration by own teeth, less than the touches of pairs inside steps do.
_STEP_ANGLE = 2.4
_LEAST_STEPS = 32
#: Steps are so much longer than asked for where they then end at every output.
_LONGER = 1.25
#: Mesh cycles that are worked on together, and those by which the error of the steps is estimated.
_BLOCK = 64
_ESTIMATED = 16
#: Forces of which ``CycleSteps.strength`` has the strengths: fields of FORCE, then, where gears are eccentric
#: or a torque has a ripple, the moments of N on both gears, and both torques.
NORMAL, FRICTION, FRICTION_MOMENT, SEPARATING = range(4)
MOMENT_PINION, MOMENT_GEAR, TORQUE_PINION, TORQUE_GEAR = range(4, 8)


def linear_steps(system: LTVSystem) -> int:
    """Steps in a mesh cycle that the fastest vibration asks for."""
    return max(_LEAST_STEPS, math.ceil(fastest_frequency(system) * system.period / _STEP_ANGLE))


class CycleSteps:
    """Gauss steps through every mesh cycle of the period, in blocks of cycles, a thread a block.

    ``system`` gives the coordinates, of any form; ``steps`` is the least number in a cycle, ``only`` the
    cycles of the form, where it is not that of the whole period. Steps end wherever a law of like teeth is
    not smooth, so that own teeth alone bring kinks inside steps.
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
        self.tables = mesh_tables(self.laws, 1.0 / steps, samples, tableau[2], ends)
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
        # At the stages; large arrays, for the system gives many small ones slowly.
        shape = (count, self.lengths.size, STAGES)
        self.form = LinearForm(np.empty((*shape, 3), FORCE), np.empty(shape, STATE))
        in_threads(lambda block: fill_linear_form(self.tables, block[0], self.part(*block)), self.cycles)

    def free_steps(self, *, with_rates: bool = False) -> FreeSteps:
        """``without_mesh`` for all forces of ``strength``."""
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
        """The same steps through the one mesh cycle of like teeth, by their laws."""
        system = self.system
        tables = self.tables
        low, high = tables.edges[:-1] * system.period, tables.edges[1:] * system.period
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
        """Tables whose steps start at the outputs, for loads there."""
        samples = int(self.tables.outputs.sum())
        return swinging(mesh_tables(self.laws, 1.0, samples), self.system)._replace(law=self.tables.law)

    def part(self, first: int, count: int) -> LinearForm:
        """The form of so many cycles from one on."""
        low = first - self.first
        return LinearForm(*(part[low : low + count] for part in self.form))

    def strength(self, first: int, form: LinearForm) -> FloatArray:
        """Strengths (cycles, steps, stages, 3, forces) in cycles from one on, for ``propagate``."""
        forces = form.forces
        states = form.states
        tables = self.tables
        of_mesh = forces.view(np.float64).reshape(*forces.shape, -1)
        if not self.turns:
            return of_mesh
        found = np.zeros((*forces.shape, 8))
        found[..., :MOMENT_PINION] = of_mesh
        found[..., MOMENT_PINION] = forces["normal"] * states["moment_pinion"][..., None]
        found[..., MOMENT_GEAR] = forces["normal"] * states["moment_gear"][..., None]
        phase = tables.edges[:-1, None] + tables.nodes * np.diff(tables.edges)[:, None]
        time = first + np.arange(len(forces))[:, None, None] + phase
        for ripple in torque_ripples(self.pair):
            turn = ripple["angle"] * np.mod(time, ripple["cycles"]) + ripple["start"]
            of_shaft = TORQUE_PINION + int(ripple["shaft"])
            found[..., AT_REST, of_shaft] += ripple["amplitude"] * np.cos(turn)
        return found

    def propagated(
        self, columns: FloatArray, recorded: int, strength: FloatArray, free: FreeSteps
    ) -> Propagated:
        """Take columns (cycles, columns, width) through a block of cycles; see ``propagate``."""
        deflection = np.ascontiguousarray(self.system.deflection)
        result: Propagated = propagate(columns, recorded, strength, self.length_of_step, free, deflection)
        return result

    def cycle_maps(self) -> FloatArray:
        """Affine map of each mesh cycle, (cycles, n, n + 3).

        States that move no tooth, of which all cycles make the same, are followed once.
        """
        support = self.system.supports
        n = 2 * len(self.system.coordinates)
        fed = len(support.coordinates("mesh").names)
        full = self.system.form == "full"
        twice = np.eye(2)
        to = np.kron(twice, (support.relative if full else np.eye(n // 2))[:fed])
        back = np.kron(twice, (support.back if full else np.eye(n // 2))[:, :fed])
        units = np.zeros((1, 2 * fed + 3, self.width))
        units[0, : 2 * fed, :n] = back.T
        units[0, 2 * fed :, n : n + 3] = np.eye(3)
        others = np.pad(np.eye(n) - (back @ to).T, ((0, 0), (0, self.width - n)))
        nothing = np.zeros((1, self.lengths.size, STAGES, 3, self.free.by_force.shape[2]))
        still = self.propagated(others[None], 0, nothing, self.free).ends[0].T

        def maps(block: tuple[int, int]) -> FloatArray:
            first, count = block
            strength = self.strength(first, self.part(first, count))
            ends = self.propagated(np.tile(units, (count, 1, 1)), 0, strength, self.free).ends.swapaxes(1, 2)
            return np.concatenate([ends[..., : 2 * fed] @ to + still, ends[..., 2 * fed :]], axis=2)

        return np.concatenate(in_threads(maps, self.cycles))


class SteppedMotion(NamedTuple):
    """Periodic motion by long steps.

    Attributes
    ----------
    cycles : (cycles + 1, n) states at the starts of the mesh cycles
    weights : (3,) of the forcings: the own one, and torques beyond that of pinion and gear [N m]
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
    """Periodic motion of the linear form over the period of teeth that differ, by the maps of its cycles.

    Parameters as of `lumped.model.unilateral_motion.settled_motion`.
    """
    system = LTVSystem.of(pair.healthy, "full", supports=supports)
    twin = periodic_solution(system, sample_times(system.period, samples), estimate_error=False)
    steps = linear_steps(system) if steps is None else steps
    m = len(system.coordinates)
    dte = system.deflection
    relative = system.supports.relative
    form = CycleSteps(pair, system, samples, steps)
    own = stepped_motion(form)
    like = stepped_motion(form.with_like_teeth())
    states = own.states + (twin.states - like.states[0])
    weights = own.weights + (twin.weights - like.weights)
    of_twin = mean_powers(twin).by_place
    powers = {name: own.powers[name] + (of_twin[name] - like.powers[name]) for name in own.powers}
    coarse = CycleSteps(pair, system, 1, -(-steps // 2), range(min(_ESTIMATED, form.tables.period)))
    other = states_along(coarse.cycle_maps(), own.cycles[0], own.weights)
    starts = own.cycles[:, :m]
    error = np.abs((starts[: len(other)] - other[:, :m]) @ dte).max() / np.abs(starts @ dte).max()
    outer = form.tables_of_outputs

    def loads(block: tuple[int, int]) -> tuple[FloatArray, FloatArray]:
        first, count = block
        return loads_of(form, outer, first, states[first : first + count])

    of_blocks, stiffness = zip(*in_threads(loads, form.cycles), strict=True)
    load = np.concatenate(of_blocks, axis=1)
    time = np.arange(load.shape[1]) / samples * system.period
    torque = system.pinion_torque + float(weights[1])
    brake = float(weights[2])
    largest = np.abs(starts @ relative.T).max()
    closure = float(np.abs(relative @ (starts[-1] - starts[0])).max() / largest)
    touch = Touch.TIED if form.tables.law.prescribed else Touch.LINEAR
    flat = states.reshape(-1, system.size)
    return RevolutionMotion(
        *(pair, system, outer, touch, time, flat, load, torque, brake, powers, closure, float(error)),
        twin.spectral_radius,
        stiffness=np.concatenate(stiffness),
        between=twin.between,
    )


def stepped_run(
    form: CycleSteps, first: int, count: int, state: FloatArray, weights: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """States (count, samples, n) at the outputs of so many mesh cycles from one on, and that at their end.

    ``state`` (n,) at the start; ``weights`` (3,) of the forcings, as of ``SteppedMotion``. After the cycles
    of the form its first one follows again.
    """
    kept = form.tables.outputs == 1
    known = sum(number for _, number in form.cycles)
    start = np.zeros((1, 1, form.width))
    found = []
    for cycle in range(first, first + count):
        start[0, 0, : state.size] = state
        start[0, 0, state.size : state.size + weights.size] = weights
        at = form.first + (cycle - form.first) % known
        ends, states, _ = form.propagated(start, 1, form.strength(at, form.part(at, 1)), form.free)
        found.append(states[0, kept, 0])
        state = ends[0, 0, : state.size]
    return np.stack(found), state


def stepped_motion(form: CycleSteps) -> SteppedMotion:
    """Periodic motion by the steps of a form alone."""
    cycles, weights = _closed(form)
    return SteppedMotion(cycles, weights, *_inside(form, cycles, weights))


def _closed(form: CycleSteps) -> tuple[FloatArray, FloatArray]:
    """States at the starts of the cycles, (cycles + 1, n), and weights of the forcings, by the own maps."""
    system = form.system
    support = form.system.supports
    maps = form.cycle_maps()
    whole = chained(maps, np.zeros(maps.shape[0], dtype=np.int64))[0]
    n = maps.shape[1]
    if not np.isfinite(whole).all():
        raise NumericalError("The motion grows without bound: take smaller deviations or more damping.")
    start, weights = balanced_start(system, whole[:, :n], whole[:, n : n + 3])
    # Rounding of the closing equations fades in a period, but that of the common rotation, which grows.
    moved = (states_along(maps, start, weights)[-1] - start).reshape(2, n // 2)
    scale = support.common_weights
    moved -= np.outer(moved @ scale, support.common) / (scale @ support.common)
    return states_along(maps, start + moved.ravel(), weights), weights


def _inside(form: CycleSteps, cycles: FloatArray, weights: FloatArray) -> tuple[FloatArray, dict[str, float]]:
    """States (cycles, samples, n) at the outputs, and mean powers [W] by the stages of the steps.

    Gauss steps keep the first law: over a period the powers of all forces at the stages, so weighted, cancel.
    """
    system = form.system
    tables = form.tables
    m = len(system.coordinates)
    weight = form.lengths[:, None] * gauss_tableau(STAGES)[1]
    places, (per_rate, nominal) = system.supports.places, _velocities(form)
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
        approach, closing = inside[:, :, 0, : 2 * STAGES].reshape(-1, 2, STAGES).swapaxes(0, 1).reshape(2, -1)
        rates = inside[:, :, 0, 2 * STAGES :].reshape(-1, m)
        times = np.tile(weight.ravel(), count)
        velocities = per_rate @ rates.T + nominal[:, None]
        work = np.empty(nominal.size)
        for force, parts in enumerate(strength.reshape(-1, 3, strength.shape[-1]).T[: nominal.size]):
            load = parts[BY_APPROACH] * approach + parts[BY_RATE] * closing + parts[AT_REST]
            work[force] = (load * velocities[force]) @ times
        mesh = part.states.reshape(-1)
        taken = (mesh["damper_by_square"] * closing + mesh["damper_by_rate"]) * closing
        dampers = float((taken + mesh["damper_at_rest"]) @ times)
        # Powers of the supports are quadratic: that of few rates with the same sum of squares and products.
        size, axes = np.linalg.eigh((rates.T * times) @ rates)
        outside = system.supports.powers((axes * np.sqrt(np.maximum(size, 0.0))).T)
        sliding = work[FRICTION] + work[FRICTION_MOMENT]
        taken_outside = [outside[place].sum() for place in places]
        of_block = [sliding, dampers, *taken_outside, dampers - (work.sum() - sliding)]
        return states[:, tables.outputs == 1, 0], np.array(of_block)

    outputs, work = zip(*in_threads(block_of, form.cycles), strict=True)
    duration = (len(cycles) - 1) * system.period
    names = ("sliding", "tooth_dampers", *places, "rolling")
    powers = dict(zip(names, (np.sum(work, axis=0) / duration).tolist(), strict=True))
    return np.concatenate(outputs), powers


def _velocities(form: CycleSteps) -> tuple[FloatArray, FloatArray]:
    """Velocity on which each force of the mesh works, per rate of the coordinates (forces, m), and nominal.

    Friction takes power by the sliding, (Omega_p + theta_p') xi - (Omega_g + theta_g') (L - xi)
    - (y_p' - y_g'). The other forces work on the vibration.
    """
    gears = form.system.gears
    g = form.pair.geometry
    off_line = gears[4] - gears[5]
    pinion = gears[0]
    gear = gears[1]
    per_rate = [form.system.deflection, -(g.L_XY * gear + off_line), pinion + gear, off_line]
    nominal = [0.0, -g.L_XY * g.omega_gear, g.omega_pinion + g.omega_gear, 0.0]
    if form.turns:
        per_rate += [-pinion, -gear]
        nominal += [-g.omega_pinion, -g.omega_gear]
    return np.stack(per_rate), np.array(nominal)


def loads_of(
    form: CycleSteps, outer: MeshTables, first: int, states: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Loads (pairs, k) [N], stiffness of the mesh (k,) [N/m] at states (k, n) at outputs from a cycle on."""
    m = len(form.system.coordinates)
    dte = form.system.deflection
    kept = outer.outputs == 1
    here = states.reshape(-1, int(kept.sum()), states.shape[-1])
    loads = static_loads(outer, first, len(here))[1][:, kept]
    approach = (here[..., :m] @ dte)[..., None]
    rate = (here[..., m:] @ dte)[..., None]
    carried = loads["by_approach"] * approach + loads["by_rate"] * rate + loads["at_rest"]
    carried = np.asarray(carried.reshape(-1, carried.shape[-1]).T, dtype=np.float64)
    return carried, np.asarray(loads["by_approach"].sum(axis=-1).ravel(), dtype=np.float64)
