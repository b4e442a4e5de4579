"""Motion by momentary load: runs from any state, the steps of the run, and the mean powers that it records.

Sources: docs/theory/teeth.md, "Motion", "Brake torque"; docs/theory/validity.md, "Prediction".
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from lumped.errors import SlowPairError
from lumped.mesh.motion import WORK, Body, CycleSpan, Run, Runs, run_cycles
from lumped.mesh.records import CONTACT, Records
from lumped.mesh.tables import CyclePairs, MeshTables, cycle_pairs
from lumped.model.equations import Y_G, Y_P
from lumped.model.periodic_system import LTVSystem
from lumped.model.propagation import fastest_frequency
from lumped.model.swing import moments, swinging
from lumped.model.tooth_laws import ToothLaws, mesh_tables, torque_ripples
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray, IntArray

#: Steps in a period of the fastest vibration, and least steps in a mesh cycle. With 256 steps a motion with
#: contact loss errs by 0.1 %, because pairs touch inside steps.
_STEPS = 40
_LEAST_STEPS = 512
#: A mesh cycle with more steps than this gets fewer steps in each vibration, but not fewer than _FEWEST: a
#: slow pair damps vibrations within a small part of the cycle. Most steps in a mesh cycle: a run of one cycle
#: then takes a second.
_MANY_STEPS = 16_384
_FEWEST = 8
_MOST_STEPS = 65_536


def steps_of(system: LTVSystem) -> int:
    """Number of steps in a mesh cycle that the fastest vibration needs.

    SlowPairError where they are too many.
    """
    swings = fastest_frequency(system) * system.period / (2.0 * math.pi)
    if _FEWEST * swings > _MOST_STEPS:
        rpm = system.pair.operating.pinion_speed * 30.0 / math.pi
        least = rpm * _FEWEST * swings / _MOST_STEPS
        raise SlowPairError(
            f"At {rpm:.4g} rpm a mesh cycle lasts {swings:.0f} vibrations of the fastest mode, too many to "
            f"follow one by one: contact='unilateral' needs {least:.3g} rpm or more. "
            "Use contact='linear', or static_transmission_error: so slow a pair hardly vibrates."
        )
    return max(_LEAST_STEPS, math.ceil(min(_STEPS * swings, max(_MANY_STEPS, _FEWEST * swings))))


def momentary_tables(laws: ToothLaws, system: LTVSystem, step: float, outputs: int) -> MeshTables:
    """Tables for ``MomentaryRuns``: steps of at most ``step`` mesh cycles, ``outputs`` outputs in a cycle."""
    return swinging(mesh_tables(laws, step, outputs, (0.0, 0.5, 1.0)), system)


def mean_powers(run: Run, duration: float) -> dict[str, float]:
    """Mean powers in the recorded cycles of a run [W]; see ``RevolutionMotion.powers``."""
    names = ("sliding", "tooth_dampers", "bearings", "shafts", "teeth")
    powers = {name: float(run.work[name][0]) / duration for name in names}
    return powers | {"rolling": powers["tooth_dampers"] - powers.pop("teeth")}


def without_drift(
    system: LTVSystem, time: FloatArray, states: FloatArray, end: FloatArray, duration: float
) -> FloatArray:
    """States (k, 2m) of a period without the mean and without the drift of the common rotation.

    ``end`` (2m,) is the state after the period of ``duration`` [s].
    """
    support = system.supports
    m = len(system.coordinates)
    scale = float(support.common_weights @ support.common)

    def common(part: FloatArray) -> FloatArray:
        return np.asarray(part @ support.common_weights / scale, dtype=np.float64)

    acceleration = float(common(end[m:] - states[0, m:])) / duration
    slope = float(common(end[:m] - states[0, :m])) / duration - 0.5 * acceleration * duration
    line = slope * time + 0.5 * acceleration * time**2
    mean = float((common(states[:, :m]) - line).mean())
    states = states.copy()
    states[:, :m] -= np.outer(mean + line, support.common)
    states[:, m:] -= np.outer(slope + acceleration * time, support.common)
    return states


@dataclass(frozen=True, eq=False)
class MomentaryRuns:
    """Runs of a pair on its supports by momentary load, over tables of its mesh cycle.

    Attributes
    ----------
    pair : gear pair
    system : the "full" system of the pair with like teeth
    tables : tables of ``momentary_tables``
    """

    pair: GearPair
    system: LTVSystem
    tables: MeshTables

    @cached_property
    def ripples(self) -> Records:
        """RIPPLE of each harmonic of the torques."""
        return torque_ripples(self.pair)

    @cached_property
    def body(self) -> Body:
        """The gears on their supports, without torques."""
        return body_of(self.system)

    @cached_property
    def mesh(self) -> CyclePairs:
        """Memory for the tooth pairs of a mesh cycle."""
        return cycle_pairs(self.tables)

    def run(self, start: int, cycles: int, recorded: int, state: FloatArray, torques: FloatArray) -> Run:
        """Follow the motion from a state (2m,) over mesh cycles; arguments as of ``together``."""
        runs = self.together(CycleSpan(start, cycles, recorded), state[None], torques[None])
        return Run(runs.states[0], runs.loads[0], runs.end[0], runs.work)

    def together(self, span: CycleSpan, states: FloatArray, torques: FloatArray) -> Runs:
        """Follow the motions from some states over the same mesh cycles.

        Parameters
        ----------
        span : the mesh cycles
        states : (runs, 2m) states at the start
        torques : (runs, 2m) constant accelerations by the torques
        """
        # The loads of a run start from 0, so that no run depends on another one.
        contacts = np.zeros((len(states), self.tables.ahead.size), CONTACT)
        by_torque = np.ascontiguousarray(torques[:, len(self.system.coordinates) :])
        work = np.zeros(len(states), WORK)
        start = self.ripples, np.ascontiguousarray(states), by_torque
        result: Runs = run_cycles(span, self.tables, self.body, *start, self.mesh, contacts, work)
        return result


@lru_cache(maxsize=4)
def body_of(system: LTVSystem) -> Body:
    """The gears on their supports as numbers, without torques."""
    g = system.pair.geometry
    m = len(system.coordinates)
    rates = system.gears
    constant, states = non_zero_terms(system.constant[m:])
    per_normal, per_friction_force, per_friction_moment = np.ascontiguousarray(system.per_load)
    return Body(
        constant=constant,
        states=states,
        deflection=np.ascontiguousarray(system.deflection),
        per_normal=per_normal,
        per_friction_force=per_friction_force,
        per_friction_moment=per_friction_moment,
        per_separating=np.ascontiguousarray(system.per_apart),
        per_moment=np.ascontiguousarray(moments(system)),
        per_torque=np.stack([system.torque_pinion[m:], system.torque_gear[m:]]),
        bearings=_power_matrix(system, "bearings"),
        shafts=_power_matrix(system, "shafts"),
        turning=np.ascontiguousarray(rates[:2]),
        off_line=np.ascontiguousarray(rates[Y_P] - rates[Y_G]),
        speeds=np.array([g.omega_pinion, g.omega_gear]),
        line=g.L_XY,
    )


def non_zero_terms(matrix: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return the entries of each row that are not 0, and their columns; both (rows, most in a row).

    Rows with fewer such entries have zeros too. On springs two of twelve entries are left.
    """
    is_zero = matrix == 0.0
    most = matrix.shape[1] - int(is_zero.sum(axis=1).min())
    columns = np.ascontiguousarray(np.sort(np.argsort(is_zero, axis=1, kind="stable")[:, :most], axis=1))
    return np.take_along_axis(matrix, columns, axis=1), columns


def _power_matrix(system: LTVSystem, place: str) -> FloatArray:
    """Matrix (m, m) whose quadratic form of the rates is the power of a place of the supports, or (0, m)."""
    m = len(system.coordinates)
    if place not in system.supports.places:
        return np.zeros((0, m))
    unit = np.eye(m)
    single = system.supports.powers(unit)[place]
    both = system.supports.powers((unit[:, None] + unit).reshape(-1, m))[place]
    return np.asarray(0.5 * (np.reshape(both, (m, m)) - np.add.outer(single, single)), dtype=np.float64)
