"""Motion by momentary load: a run from any state, and the periodic motion to which it settles.

Sources: docs/theory/teeth.md, "Motion", "Brake torque".
"""

from __future__ import annotations

import math

import numpy as np

from lumped.errors import NumericalError
from lumped.mesh.motion import WORK, Body, Run, run_cycles
from lumped.mesh.tables import MeshTables, cycle_pairs
from lumped.model.periodic_system import LTVSystem, Supports
from lumped.model.propagation import fastest_frequency
from lumped.model.revolution_motion import Origin, RevolutionMotion, Touch
from lumped.model.steady import periodic_solution
from lumped.model.swing import moments, swinging
from lumped.model.tooth_laws import ToothLaws, mesh_tables, torque_ripples
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray

#: Steps in a period of the fastest vibration, and least steps in a mesh cycle: where a pair touches inside a
#: step, 256 cost 0.1 % of a motion with contact loss.
_STEPS, _LEAST_STEPS = 40, 512
#: Where a mesh cycle has so many steps, each vibration gets fewer, but no fewer than these: a slow pair has
#: damped them within a small part of the cycle. Most steps in a mesh cycle: a second for each of its passes.
_MANY_STEPS, _FEWEST, _MOST_STEPS = 16_384, 8, 65_536
#: What a start is to have faded to before it is recorded, and most cycles for that.
_FADED, _MOST_SETTLING = 1e-11, 20_000
#: Largest mismatch after the period, over the largest displacement, that is called periodic.
_CLOSED = 1e-4


def steps_of(system: LTVSystem) -> int:
    """Steps in a mesh cycle, by the fastest vibration; a NumericalError says that they are too many."""
    swings = fastest_frequency(system) * system.period / (2.0 * math.pi)
    if _FEWEST * swings > _MOST_STEPS:
        rpm = system.pair.operating.pinion_speed * 30.0 / math.pi
        least = rpm * _FEWEST * swings / _MOST_STEPS
        raise NumericalError(
            f"At {rpm:.4g} rpm a mesh cycle lasts {swings:.0f} vibrations of the fastest mode, too many to "
            f"follow one by one: contact='unilateral' needs {least:.3g} rpm or more. "
            "Use contact='linear', or static_transmission_error: so slow a pair hardly vibrates."
        )
    return max(_LEAST_STEPS, math.ceil(min(_STEPS * swings, max(_MANY_STEPS, _FEWEST * swings))))


def momentary_tables(laws: ToothLaws, system: LTVSystem, step: float, outputs: int) -> MeshTables:
    """Tables for ``run``: steps of at most so many mesh cycles, and so many outputs in each."""
    return swinging(mesh_tables(laws, step, outputs, (0.0, 0.5, 1.0)), system)


def settled_motion(
    pair: GearPair, samples: int, supports: Supports = "springs", steps: int | None = None
) -> RevolutionMotion:
    """Periodic motion of a pair whose teeth differ, with unilateral contact.

    Started from the motion of the healthy twin, it is followed until the start has faded, then recorded
    over one period. A first run with coarser steps gives the brake torque, which the common rotation alone
    feels.

    Parameters
    ----------
    pair : a validated gear pair
    samples : outputs a mesh cycle
    supports : as of ``periodic_system``
    steps : least number of steps in a mesh cycle; by default by the fastest vibration
    """
    touch = Touch.MOMENTARY if pair.mesh.contact == "loaded" else Touch.WINDOWS
    system = LTVSystem.of(pair.healthy, "full", supports=supports)
    twin = periodic_solution(system, np.zeros(1), estimate_error=False)
    laws = ToothLaws(pair)
    steps = steps_of(system) if steps is None else steps
    settling = _settling(twin.spectral_radius)
    state, driving, brake = twin.states[0].copy(), twin.pinion_torque, twin.brake_torque
    weights = system.supports.common_weights
    m = weights.size
    coarse = np.zeros(0)
    for part in (4, 1):
        tables = momentary_tables(laws, system, part / steps, samples)
        torques = driving * system.torque_pinion + brake * system.torque_gear
        count = settling + tables.period
        found = run(pair, tables, system, -settling, count, tables.period, state, torques)
        states, end = found.states, found.end
        if not np.isfinite(end).all():
            raise NumericalError("The motion grows without bound: take smaller deviations or more damping.")
        duration = tables.period * system.period
        drift = float(weights @ (end - states[0])[m:]) / duration
        if pair.operating.brake_torque == "balanced":
            brake -= drift / float(weights @ system.torque_gear[m:])
        else:
            driving -= drift / float(weights @ system.torque_pinion[m:])
        # The common rotation has no mean rate of its own: nominal speed is mean speed.
        common = system.supports.common / float(weights @ system.supports.common)
        until = (settling + 0.5 * tables.period) * system.period  # to the middle of the record
        state[m:] -= (float(weights @ (end - states[0])[:m]) / duration - drift * until) * common
        dte = states[:, :m] @ system.deflection
        error, coarse = float(np.abs(dte - coarse).max() if coarse.size else np.inf), dte
    time = (np.arange(states.shape[0]) / samples) * system.period
    relative = system.supports.relative
    closure = relative @ (end - states[0])[:m]
    largest = float(np.abs(states[:, :m] @ relative.T).max())
    closed = float(np.abs(closure).max()) / largest
    if closed > _CLOSED:
        raise NumericalError(
            f"After {tables.period} mesh cycles the motion has not closed ({closed:.1e} of its size): it is "
            "unstable, not periodic over the period of the teeth, or damped too little."
        )
    powers = mean_powers(found, duration)
    # Sliding at nominal speed: without what a rate of the common rotation that is left adds.
    rates = system.gears[:2] @ (end - states[0])[:m] / duration
    powers["sliding"] -= float(driving * rates[0] - brake * rates[1])
    states = without_drift(system, time, states, drift)
    error /= float(np.abs(coarse).max())
    return RevolutionMotion(
        *(pair, system, tables, touch, time, states, found.loads, driving, brake, powers, closed, error),
        twin.spectral_radius,
        Origin.SETTLED,
    )


def mean_powers(run: Run, duration: float) -> dict[str, float]:
    """Mean powers of what was recorded [W]; see ``RevolutionMotion.powers``."""
    names = ("sliding", "tooth_dampers", "bearings", "shafts", "teeth")
    powers = {name: float(run.work[name][0]) / duration for name in names}
    return powers | {"rolling": powers["tooth_dampers"] - powers.pop("teeth")}


def without_drift(system: LTVSystem, time: FloatArray, states: FloatArray, drift: float) -> FloatArray:
    """States without the acceleration of the common rotation that steps leave, its mean rate and mean."""
    support, m = system.supports, len(system.coordinates)
    scale = float(support.common_weights @ support.common)
    common = states[:, :m] @ support.common_weights / scale
    rate = states[:, m:] @ support.common_weights / scale
    acceleration = drift / scale
    slope = rate.mean() - acceleration * time.mean()
    states = states.copy()
    line = slope * time + 0.5 * acceleration * time**2
    states[:, :m] -= np.outer((common - line).mean() + line, support.common)
    states[:, m:] -= np.outer(slope + acceleration * time, support.common)
    return states


def run(
    pair: GearPair,
    tables: MeshTables,
    system: LTVSystem,
    start: int,
    cycles: int,
    recorded: int,
    state: FloatArray,
    torques: FloatArray,
) -> Run:
    """``run_cycles`` of a pair on its supports, from a state (2m,) at the start of a cycle."""
    ripples, mesh, work = torque_ripples(pair), cycle_pairs(tables), np.zeros(1, WORK)
    found: Run = run_cycles(
        start, cycles, recorded, tables, body_of(system, torques), ripples, state, mesh, work
    )
    return found


def body_of(system: LTVSystem, torques: FloatArray) -> Body:
    """The gears on their supports as numbers, under constant torques (2m,) of acceleration."""
    g, m, rates = system.pair.geometry, len(system.coordinates), system.gears
    per_normal, per_friction, per_friction_moment = np.ascontiguousarray(system.per_load)
    return Body(
        constant=np.ascontiguousarray(system.constant[m:]),
        torque=np.ascontiguousarray(torques[m:]),
        deflection=np.ascontiguousarray(system.deflection),
        per_normal=per_normal,
        per_friction=per_friction,
        per_friction_moment=per_friction_moment,
        per_separating=np.ascontiguousarray(system.per_apart),
        per_moment=np.ascontiguousarray(moments(system)),
        per_torque=np.stack([system.torque_pinion[m:], system.torque_gear[m:]]),
        bearings=_power_matrix(system, "bearings"),
        shafts=_power_matrix(system, "shafts"),
        turning=np.ascontiguousarray(rates[:2]),
        off_line=np.ascontiguousarray(rates[4] - rates[5]),
        speeds=np.array([g.omega_pinion, g.omega_gear]),
        line=g.L_XY,
    )


def _power_matrix(system: LTVSystem, place: str) -> FloatArray:
    """Matrix (m, m) whose form of the rates is the power that a place of the supports takes, or (0, m)."""
    m = len(system.coordinates)
    if place not in system.supports.places:
        return np.zeros((0, m))
    unit = np.eye(m)
    single = system.supports.powers(unit)[place]
    both = system.supports.powers((unit[:, None] + unit).reshape(-1, m))[place]
    return np.asarray(0.5 * (np.reshape(both, (m, m)) - np.add.outer(single, single)), dtype=np.float64)


def _settling(radius: float) -> int:
    """Mesh cycles until a start has faded."""
    if radius >= 1.0:
        raise NumericalError(
            f"The motion of the healthy twin is not stable (multiplier {radius:.6f}), so none settles: raise "
            "the damping or leave the speed."
        )
    found = math.ceil(math.log(_FADED) / math.log(radius)) + 2
    if found > _MOST_SETTLING:
        raise NumericalError(f"A start fades in {found} mesh cycles, too slowly: raise mesh.damping_ratio.")
    return found
