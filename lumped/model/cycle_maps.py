"""The linear form of teeth that differ: maps of mesh cycles about the own static state, and its motion.

Sources: docs/theory/teeth.md, "The linear form", "Stability".
"""

from __future__ import annotations

import math

import numpy as np

from lumped.compiler import in_threads
from lumped.errors import NumericalError
from lumped.gauss_legendre import gauss_tableau
from lumped.mesh.element import AT_REST, BY_APPROACH, BY_RATE, FORCE
from lumped.mesh.linear import STATE, LinearForm
from lumped.mesh.places import fill_linear_form, static_loads
from lumped.mesh.tables import MeshTables
from lumped.model.kernels import Propagated, chained, propagate, states_along
from lumped.model.momentary_load import without_drift
from lumped.model.periodic_system import LTVSystem, Supports
from lumped.model.propagation import distinct_lengths, fastest_frequency, padded, without_mesh
from lumped.model.revolution_motion import RevolutionMotion, Touch
from lumped.model.steady import balanced_start, periodic_solution
from lumped.model.swing import moments, swinging
from lumped.model.tooth_laws import ToothLaws, mesh_tables, torque_ripples
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray

#: Stages of the Gauss steps.
STAGES = 4
#: Largest angle of the fastest vibration in a step [rad]: order 8 errs by some 1e-5 of that vibration, less
#: than the touches of pairs inside steps do.
_STEP_ANGLE = 2.4
_LEAST_STEPS = 32
#: Steps are so much longer than asked for where they then end at every output.
_LONGER = 1.25
#: Mesh cycles that are worked on together.
_BLOCK = 64


def linear_steps(system: LTVSystem) -> int:
    """Steps in a mesh cycle that the fastest vibration asks for."""
    return max(_LEAST_STEPS, math.ceil(fastest_frequency(system) * system.period / _STEP_ANGLE))


class CycleSteps:
    """Gauss steps through every mesh cycle of the period, in blocks of cycles, a thread a block.

    ``system`` gives the coordinates, of any form; ``steps`` is the least number in a cycle, ``most`` ends
    the form after so many cycles.
    """

    def __init__(
        self, pair: GearPair, system: LTVSystem, samples: int, steps: int, most: int | None = None
    ) -> None:
        self.pair, self.system = pair, system
        self.laws = ToothLaws(pair)
        tableau = gauss_tableau(STAGES)
        steps = samples if samples <= steps <= _LONGER * samples else steps
        self.tables = mesh_tables(self.laws, 1.0 / steps, samples, tableau[2])
        if system.form == "full":
            self.tables = swinging(self.tables, system)
        self.lengths = np.diff(self.tables.edges) * system.period
        torques = np.stack([system.torque_pinion, system.torque_gear], axis=1)
        extra = padded(system, torques)
        first, which = distinct_lengths(system, self.lengths)
        lengths = self.lengths[first]
        m = len(system.coordinates)
        forces = np.vstack([system.per_load[0], moments(system), system.per_load[1:], system.per_apart])
        forces = np.vstack([forces, torques[m:].T])
        self.which, self.free = which[None], without_mesh(system, lengths, extra, tableau, forces)
        self.width = self.free.along.shape[1]
        count = self.tables.period if most is None else min(most, self.tables.period)
        self.cycles = [(first, min(_BLOCK, count - first)) for first in range(0, count, _BLOCK)]
        # At the stages; large arrays, for the system gives many small ones slowly.
        shape = (count, self.lengths.size, STAGES)
        self.form = LinearForm(np.empty((*shape, 3), FORCE), np.empty(shape, STATE))

    def part(self, first: int, count: int) -> LinearForm:
        """The form of so many cycles from one on."""
        return LinearForm(*(part[first : first + count] for part in self.form))

    def strength(self, first: int, form: LinearForm) -> FloatArray:
        """Strengths (cycles, steps, stages, 3, 8) of the forces in cycles from one on, for ``propagate``.

        The forces are N, its moments on both gears, F, F xi, that of tip corners, and both torques' ripples.
        """
        forces, states, tables = form.forces, form.states, self.tables
        found = np.zeros((*forces.shape, 8))
        normal = forces["normal"]
        found[..., 0] = normal
        found[..., 1], found[..., 2] = (
            normal * states[f"moment_{gear}"][..., None] for gear in ("pinion", "gear")
        )
        found[..., 3], found[..., 4] = forces["friction"], forces["friction_moment"]
        found[..., 5] = forces["separating"]
        phase = tables.edges[:-1, None] + tables.nodes * np.diff(tables.edges)[:, None]
        time = first + np.arange(len(forces))[:, None, None] + phase
        for ripple in torque_ripples(self.pair):
            turn = ripple["angle"] * np.mod(time, ripple["cycles"]) + ripple["start"]
            found[..., AT_REST, 6 + int(ripple["shaft"])] += ripple["amplitude"] * np.cos(turn)
        return found

    def along(self, columns: FloatArray, kept: int, strength: FloatArray) -> Propagated:
        """``propagate`` of a block of cycles."""
        deflection = np.ascontiguousarray(self.system.deflection)
        found: Propagated = propagate(columns, kept, strength, self.which, *self.free, deflection)
        return found

    def cycle_maps(self) -> FloatArray:
        """Affine map of each mesh cycle, (cycles, n, n + 3); fills ``form``.

        States that move no tooth, of which all cycles make the same, are followed once.
        """
        support, n = self.system.supports, 2 * len(self.system.coordinates)
        fed = len(support.coordinates("mesh").names)
        full, twice = self.system.form == "full", np.eye(2)
        to = np.kron(twice, (support.relative if full else np.eye(n // 2))[:fed])
        back = np.kron(twice, (support.back if full else np.eye(n // 2))[:, :fed])
        units = np.zeros((1, 2 * fed + 3, self.width))
        units[0, : 2 * fed, :n], units[0, 2 * fed :, n : n + 3] = back.T, np.eye(3)
        others = np.pad(np.eye(n) - (back @ to).T, ((0, 0), (0, self.width - n)))
        nothing = np.zeros((1, self.lengths.size, STAGES, 3, 8))
        still = self.along(others[None], 0, nothing).ends[0].T

        def maps(block: tuple[int, int]) -> FloatArray:
            first, count = block
            form = self.part(first, count)
            fill_linear_form(self.tables, first, form)
            strength = self.strength(first, form)
            ends = self.along(np.tile(units, (count, 1, 1)), 0, strength).ends.swapaxes(1, 2)
            return np.concatenate([ends[..., : 2 * fed] @ to + still, ends[..., 2 * fed :]], axis=2)

        return np.concatenate(in_threads(maps, self.cycles))


def linear_motion(
    pair: GearPair, samples: int, supports: Supports = "springs", steps: int | None = None
) -> RevolutionMotion:
    """Periodic motion of the linear form over the period of teeth that differ, by the maps of its cycles.

    Parameters as of ``push_motion``.
    """
    system = LTVSystem.of(pair.healthy, "full", supports=supports)
    twin = periodic_solution(system, np.zeros(1), estimate_error=False)
    steps = linear_steps(system) if steps is None else steps
    m, dte, relative = len(system.coordinates), system.deflection, system.supports.relative
    coarse = CycleSteps(pair, system, 1, -(-steps // 2), _BLOCK)
    form = CycleSteps(pair, system, samples, steps)
    cycles, weights = _closed(form)
    other = states_along(coarse.cycle_maps(), cycles[0], weights)
    error = np.abs((cycles[: len(other)] - other)[:, :m] @ dte).max() / np.abs(cycles[:, :m] @ dte).max()
    outer = swinging(mesh_tables(form.laws, 1.0, samples), system)
    states, load, powers = _inside(form, outer, cycles, weights)
    time = np.arange(states.shape[0]) / samples * system.period
    states = without_drift(system, time, states, 0.0)
    g, torque, brake = pair.geometry, system.pinion_torque + float(weights[1]), float(weights[2])
    # The first law gives what slides.
    lost = powers["tooth_dampers"] + powers["bearings"] - powers["rolling"]
    powers["sliding"] = torque * g.omega_pinion - brake * g.omega_gear - lost
    largest = np.abs(cycles[:, :m] @ relative.T).max()
    closure = float(np.abs(relative @ (cycles[-1] - cycles[0])[:m]).max() / largest)
    touch = Touch.TIED if form.tables.law.windows else Touch.LINEAR
    return RevolutionMotion(
        *(pair, system, outer, touch, time, states, load, torque, brake, powers, closure, float(error)),
        twin.spectral_radius,
    )


def _closed(form: CycleSteps) -> tuple[FloatArray, FloatArray]:
    """States at the starts of the cycles, (cycles + 1, n), and weights of the forcings, by the own maps."""
    system, support = form.system, form.system.supports
    maps = form.cycle_maps()
    whole, n = chained(maps, np.zeros(maps.shape[0], dtype=np.int64))[0], maps.shape[1]
    if not np.isfinite(whole).all():
        raise NumericalError("The motion grows without bound: take smaller deviations or more damping.")
    start, weights = balanced_start(system, whole[:, :n], whole[:, n : n + 3])
    # Rounding of the closing equations fades in a period, but that of the common rotation, which grows.
    moved, scale = (states_along(maps, start, weights)[-1] - start).reshape(2, n // 2), support.common_weights
    moved -= np.outer(moved @ scale, support.common) / (scale @ support.common)
    return states_along(maps, start + moved.ravel(), weights), weights


def _inside(
    form: CycleSteps, outer: MeshTables, cycles: FloatArray, weights: FloatArray
) -> tuple[FloatArray, FloatArray, dict[str, float]]:
    """States and loads (pairs, k) at the outputs, and mean powers that the motion inside steps tells [W]."""
    system, tables, dte, kept = form.system, form.tables, form.system.deflection, outer.outputs == 1
    m, gears, b = len(system.coordinates), system.gears, gauss_tableau(STAGES)[1]
    rates = np.vstack([gears[:2], gears[5] - gears[4]])
    g = form.pair.geometry

    def block_of(block: tuple[int, int]) -> tuple[FloatArray, FloatArray, FloatArray]:
        first, count = block
        part = form.part(first, count)
        start = np.zeros((count, 1, form.width))
        start[:, 0, : 2 * m], start[:, 0, 2 * m : 2 * m + weights.size] = (
            cycles[first : first + count],
            weights,
        )
        _, states, inside = form.along(start, 1, form.strength(first, part))
        states, inside = states[:, :, 0], inside[:, :, 0]
        delta, closing = np.moveaxis(inside.reshape(*inside.shape[:2], 2, b.size), 2, 0)

        def force(name: str) -> FloatArray:
            of = part.forces[name]
            return np.asarray(of[..., BY_APPROACH] * delta + of[..., BY_RATE] * closing + of[..., AT_REST])

        mesh = part.states
        taken = (mesh["damper_by_square"] * closing + mesh["damper_by_rate"]) * closing + mesh[
            "damper_at_rest"
        ]
        flat = np.vstack([states.reshape(-1, 2 * m), cycles[first + count]])[:, m:]
        turning = flat @ rates.T
        along = (turning[:-1, None] + tables.nodes[:, None] * np.diff(turning, axis=0)[:, None]).reshape(
            *delta.shape, 3
        )
        late = mesh["moment_pinion"] * (g.omega_pinion + along[..., 0])
        late += mesh["moment_gear"] * (g.omega_gear + along[..., 1])
        load, corners = force("normal"), force("separating") * along[..., 2]
        outside = np.sum(list(system.supports.powers(flat).values()), axis=0)
        lengths = np.tile(form.lengths, count)
        work = [
            float(((taken @ b) @ form.lengths).sum()),
            float((((load * (closing - late) - corners) @ b) @ form.lengths).sum()),
            0.5 * float(lengths @ (outside[1:] + outside[:-1])),
        ]
        at = states[:, tables.outputs == 1]
        loads = static_loads(outer, first, count)[1][:, kept]
        place, rate = (at[..., :m] @ dte)[..., None], (at[..., m:] @ dte)[..., None]
        carried = loads["by_approach"] * place + loads["by_rate"] * rate + loads["at_rest"]
        return at.reshape(-1, 2 * m), carried.reshape(-1, carried.shape[-1]).T, np.array(work)

    outputs, loads, work = zip(*in_threads(block_of, form.cycles), strict=True)
    duration = tables.period * system.period
    dampers, moved, supports = (float(value) for value in np.sum(work, axis=0) / duration)
    powers = {"tooth_dampers": dampers, "bearings": supports, "rolling": dampers - moved}
    return np.concatenate(outputs), np.concatenate(loads, axis=1), powers
