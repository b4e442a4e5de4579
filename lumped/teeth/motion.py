"""Periodic motion of a pair whose teeth differ, over a revolution or the hunting period.

Sources: docs/theory/teeth.md, "Motion", "Brake torque".
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from lumped.errors import NumericalError, refuse
from lumped.labelling import Variable
from lumped.mesh.element import FORCE, Records
from lumped.mesh.linear import PAIR_LOAD, STATE, LinearForm, linear_cycles, linear_places
from lumped.mesh.motion import Body, Run, run_cycles
from lumped.mesh.tables import RIPPLES, MeshTables
from lumped.model.mesh_cycle import PairState
from lumped.model.periodic_system import LTVSystem, Supports
from lumped.model.propagation import fastest_frequency
from lumped.model.results import labelled, peak_to_peak, response
from lumped.model.steady import periodic_solution
from lumped.quasi_static.contacts import contact_of
from lumped.schema.pair import GearPair
from lumped.teeth.contact import Laws, tables, torque_ripples
from lumped.teeth.pairs import numbers
from lumped.typing import FloatArray, IntArray

if TYPE_CHECKING:
    import xarray as xr


class Touch(Enum):
    """How the teeth touch in a motion; the value is how a result says it."""

    TIED = "fixed windows of contact, teeth tied (linear)"
    WINDOWS = "fixed windows of contact, unilateral"
    MOMENTARY = "own gaps and tip corners, unilateral"
    LINEAR = "linear about the own static state of every pair"


#: Most and least outputs of a mesh cycle by default, and how many all cycles together are to have.
_MOST_SAMPLES, _LEAST_SAMPLES, _ALL_SAMPLES = 512, 32, 65536
#: Steps in a period of the fastest vibration, and least steps in a mesh cycle.
_STEPS, _LEAST_STEPS = 40, 128
#: What a start is to have faded to before it is recorded, and most cycles for that.
_FADED, _MOST_SETTLING = 1e-11, 20_000
#: Largest swing of the common rotation over the base pitch: the contact follows it to first order.
_MOST_SWING = 0.25
#: Largest mismatch after the period, over the largest displacement, that is called periodic.
_CLOSED = 1e-4
#: Steps to a kink inside a step of the linear form, whose error is that of the step there.
_FEW_ROUNDS = 3


@dataclass(frozen=True, eq=False)
class OwnMotion:
    """Periodic motion over ``period`` mesh cycles.

    Attributes
    ----------
    system : the "full" system of the healthy twin
    tables : the contact that was integrated
    touch : how the teeth touch
    time : (k,) [s]
    states : (k, n)
    load : (pairs, k) normal load of each place, of ``tables.ahead`` [N]
    pinion_torque, brake_torque : mean torques that hold the mean speed against moments [N m]
    powers : mean power of sliding, tooth dampers, supports, and of the gap that closes as the teeth roll [W]
    closure : mismatch of the state after the period, over the largest displacement
    error : difference of the dynamic transmission error to that of steps four times longer, over its
        largest value
    spectral_radius : of the healthy twin
    """

    pair: GearPair
    system: LTVSystem
    tables: MeshTables
    touch: Touch
    time: FloatArray
    states: FloatArray
    load: FloatArray
    pinion_torque: float
    brake_torque: float
    powers: dict[str, float]
    closure: float
    error: float
    spectral_radius: float

    @property
    def period(self) -> int:
        """Mesh cycles."""
        return self.tables.period

    def balance(self, conservative: bool) -> dict[str, float]:
        """Torques that hold the mean speed [N m] and efficiency, as of ``lumped.model.powers.balance``."""
        g, torque = self.pair.geometry, self.pinion_torque
        brake = self.brake_torque - (self.powers["rolling"] / g.omega_gear if conservative else 0.0)
        efficiency = brake * g.omega_gear / (torque * g.omega_pinion)
        return {"brake_torque": brake, "pinion_torque": torque, "mesh_efficiency": efficiency}

    @cached_property
    def number(self) -> IntArray:
        """Number of the pair in each place at each output, (pairs, k)."""
        cycle = np.arange(self.time.size) // self.tables.outputs.sum()
        return np.asarray(cycle - self.tables.ahead[:, None], dtype=np.int64)

    @cached_property
    def teeth(self) -> tuple[IntArray, IntArray]:
        """Teeth of pinion and gear in each place at each output, from 0, (pairs, k)."""
        return numbers(self.pair, self.number)

    @cached_property
    def pairs(self) -> PairState:
        """Coefficients of the pair in each place at each output; a pair that carries nothing has none."""
        own = self.tables
        step = np.resize(np.flatnonzero(own.outputs), self.time.size)
        pitch, touches = own.law.rolling_speed * own.duration, self.load != 0.0
        moved = 0.0 * self.time if own.law.windows else swing(own, self.time)
        pitches, phase = np.divmod(own.edges[step] + moved / pitch, 1.0)
        at = np.searchsorted(own.edges[1:-1], phase, side="right")
        place, when = np.nonzero(touches)
        place = np.clip(place - pitches[when].astype(np.int64), 0, own.ahead.size - 1)
        kind, way = own.kinds[self.teeth][touches], ((phase - own.edges[at]) * pitch)[when]
        laws, slopes = (table[kind, at[when], 0, place] for table in (own.laws, own.slopes))

        def of_pairs(name: str) -> FloatArray:
            found = np.zeros(touches.shape)
            found[touches] = laws[name] + slopes[name] * way
            return found

        k, c, mu, gap = (of_pairs(name) for name in ("stiffness", "damping", "friction", "gap"))
        return PairState(own.position[step, 0].T + moved, touches, k, c, mu, gap, np.zeros(gap.shape))


def steps_of(system: LTVSystem) -> int:
    """Steps in a mesh cycle that the fastest vibration asks for."""
    swings = fastest_frequency(system) * system.period / (2.0 * math.pi)
    return max(_LEAST_STEPS, math.ceil(_STEPS * swings))


def push_motion(
    pair: GearPair, samples: int, supports: Supports = "springs", steps: int | None = None
) -> OwnMotion:
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
    laws = Laws(pair)
    steps = steps_of(system) if steps is None else steps
    settling = _settling(twin.spectral_radius)
    state, driving, brake = twin.states[0].copy(), twin.pinion_torque, twin.brake_torque
    weights = system.supports.common_weights
    m = weights.size
    coarse = np.zeros(0)
    for part in (4, 1):
        own = swinging(tables(laws, part / steps, samples, (0.0, 0.5, 1.0)), system)
        torques = driving * system.torque_pinion + brake * system.torque_gear
        count = settling + own.period
        found = run(pair, own, system, -settling, count, own.period, state, torques)
        states, end = found.states, found.end
        if not np.isfinite(end).all():
            raise NumericalError("The motion grows without bound: take smaller deviations or more damping.")
        duration = own.period * system.period
        drift = float(weights @ (end - states[0])[m:]) / duration
        if pair.operating.brake_torque == "balanced":
            brake -= drift / float(weights @ system.torque_gear[m:])
        else:
            driving -= drift / float(weights @ system.torque_pinion[m:])
        # The common rotation has no mean rate of its own: nominal speed is mean speed.
        common = system.supports.common / float(weights @ system.supports.common)
        until = (settling + 0.5 * own.period) * system.period  # to the middle of the record
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
            f"After {own.period} mesh cycles the motion has not closed ({closed:.1e} of its size): it is "
            "unstable, not periodic over the period of the teeth, or damped too little."
        )
    powers = mean_powers(found, duration)
    # Sliding at nominal speed: without what a rate of the common rotation that is left adds.
    rates = system.gears[:2] @ (end - states[0])[:m] / duration
    powers["sliding"] -= float(driving * rates[0] - brake * rates[1])
    states = without_drift(system, time, states, drift)
    error /= float(np.abs(coarse).max())
    return OwnMotion(
        *(pair, system, own, touch, time, states, found.loads, driving, brake, powers, closed, error),
        twin.spectral_radius,
    )


def mean_powers(run: Run, duration: float) -> dict[str, float]:
    """Mean powers of what was recorded [W]; see ``OwnMotion.powers``."""
    names = ("sliding", "tooth_dampers", "supports", "teeth")
    powers = {name: float(run.work[name][0]) / duration for name in names}
    return powers | {"rolling": powers["tooth_dampers"] - powers.pop("teeth")}


def moments(system: LTVSystem) -> FloatArray:
    """Accelerations (2, m) of z per unit moment on pinion and gear."""
    return np.asarray((system.reduction[:, :2] / system.structure.mass[:2]).T, dtype=np.float64)


def swinging(own: MeshTables, system: LTVSystem) -> MeshTables:
    """Tables whose contact follows the common rotation as eccentric gears and ripples of torques swing it.

    ``system`` is the "full" one. F de/dphi = -F eps sin turns the free train by + sin/omega^2, A cos by -cos.
    """
    g, support = system.pair.geometry, system.supports
    theta = system.gears[:2] @ support.common / float(support.common_weights @ support.common)
    way = 0.5 * float(np.array([g.base_radius_pinion, g.base_radius_gear]) @ theta)
    turning = own.turning.copy()
    omega = 2.0 * math.pi / (turning["cycles"] * own.duration)
    by_moment = own.law.force * (moments(system) @ support.common_weights)
    torques = np.stack([system.torque_pinion, system.torque_gear])[:, support.common_weights.size :]
    by_torque = (torques @ support.common_weights)[turning["shaft"][RIPPLES:].astype(np.int64)]
    turning["swing"] = way * np.append(by_moment, by_torque) / omega**2
    swing, most = float(np.abs(turning["swing"] * turning["amplitude"]).sum()), _MOST_SWING * g.base_pitch
    if swing > most:
        raise refuse(
            "operating.pinion_speed",
            f"{g.omega_pinion * 30.0 / math.pi:.4g} rpm",
            "one at which eccentric gears and torque ripples swing the train by at most a quarter of a base "
            f"pitch, {most * 1e3:.3g} mm",
            f"Here it is {swing * 1e3:.3g} mm. Add the inertia of motor and load to pinion.inertia and "
            "gear.inertia.",
        )
    return own._replace(turning=turning)


def swing(own: MeshTables, time: FloatArray) -> FloatArray:
    """Common rotation that the contact follows, at times (k,) [m]; tables of ``swinging``."""
    moved = np.zeros(time.size)
    for shaft in own.turning:
        turn = 2.0 * np.pi * time / (own.duration * shaft["cycles"]) + shaft["start"]
        moved += shaft["amplitude"] * shaft["swing"] * np.sin(turn)
    return moved


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
    own: MeshTables,
    system: LTVSystem,
    start: int,
    cycles: int,
    recorded: int,
    state: FloatArray,
    torques: FloatArray,
) -> Run:
    """``run_cycles`` of a pair on its supports, from a state (2m,) at the start of a cycle."""
    ripples = torque_ripples(pair)
    found: Run = run_cycles(start, cycles, recorded, own, body_of(system, torques), ripples, state)
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
        supports=np.ascontiguousarray(_power_matrix(system)),
        turning=np.ascontiguousarray(rates[:2]),
        off_line=np.ascontiguousarray(rates[4] - rates[5]),
        speeds=np.array([g.omega_pinion, g.omega_gear]),
        line=g.L_XY,
    )


def _power_matrix(system: LTVSystem) -> FloatArray:
    """Matrix (m, m) whose form of the rates is the power that the supports take."""
    m = len(system.coordinates)
    unit = np.eye(m)
    single = sum(system.supports.powers(unit).values())
    both = sum(system.supports.powers((unit[:, None] + unit).reshape(-1, m)).values())
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


def linear_form_at(
    own: MeshTables, start: int, *where: ArrayLike, loads: bool = False
) -> tuple[LinearForm, Records]:
    """Linear form at cycles after ``start``, steps and places that go together (...), see ``linear_places``.

    Returned are FORCE (..., 3) and STATE (...), and PAIR_LOAD (..., pairs) where ``loads`` are asked for.
    """
    asked = np.stack(np.broadcast_arrays(*where), axis=-1).astype(float)
    shape, asked = asked.shape[:-1], asked.reshape(-1, 3)
    form = LinearForm(np.zeros((len(asked), 3), FORCE), np.zeros(len(asked), STATE))
    of_pairs = np.zeros((len(asked) if loads else 0, own.ahead.size), PAIR_LOAD)
    linear_places(start, own, asked, form, of_pairs)
    _all_carried(form)
    whole = LinearForm(form.forces.reshape(*shape, 3), form.states.reshape(shape))
    return whole, of_pairs.reshape(*shape, own.ahead.size) if loads else of_pairs


def _all_carried(form: LinearForm) -> None:
    if not np.isfinite(form.states["approach"]).all():
        raise NumericalError("At a position no tooth pair carries the load: check stiffness and deviations.")


def fill_linear_form(own: MeshTables, start: int, form: LinearForm) -> None:
    """Fill FORCE (cycles, steps, nodes, 3) and STATE (cycles, steps, nodes) of consecutive cycles."""
    nodes = np.arange(own.nodes.size, dtype=np.float64)
    linear_cycles(start, own, -1.0 - nodes, 2, _FEW_ROUNDS, form, True)
    _all_carried(form)


def static_loads(own: MeshTables, start: int, cycles: int) -> tuple[FloatArray, Records]:
    """Static approach (cycles, steps) [m] and PAIR_LOAD (cycles, steps, pairs) at the starts of the steps."""
    where = np.arange(cycles)[:, None], np.arange(own.edges.size - 1), -1.0
    form, loads = linear_form_at(own, start, *where, loads=True)
    return np.asarray(form.states["approach"], dtype=np.float64), loads


def default_samples(period: int) -> int:
    """Outputs a mesh cycle: fewer, the more cycles a period has; a power of two."""
    found: int = 2 ** int(math.log2(_ALL_SAMPLES / period))
    return min(max(found, _LEAST_SAMPLES), _MOST_SAMPLES)


def labelled_motion(motion: OwnMotion, attributes: dict[str, Any], *, periodic: bool = True) -> xr.Dataset:
    """A motion under the names of ``lumped.model.results.VARIABLES``, with the teeth of each pair.

    Not ``periodic``: a transient, about which the attributes of the periodic motion say nothing.
    """
    system = motion.system
    values = response(system, motion.time, motion.states, motion.load, motion.pairs)
    further: dict[str, Variable] = {
        f"{name}_tooth": (("pair", "time"), teeth + 1, "1", f"tooth of the {name}, counted from 1")
        for name, teeth in zip(("pinion", "gear"), motion.teeth, strict=True)
    }
    attributes = attributes | motion.balance(contact_of(motion.pair).conservative)
    attributes |= {
        "model": "lumped",
        "period_cycles": motion.period,
        "teeth": "as given",
        "touch": motion.touch.value,
        "spectral_radius": motion.spectral_radius,
    }
    if periodic:
        attributes |= _of_period(motion, values)
    run = labelled(motion.time, values, attributes, further)
    return system.supports.labelled(run, motion.states)


def _of_period(motion: OwnMotion, values: dict[str, FloatArray]) -> dict[str, float]:
    """Mean powers, errors and ranges of a motion that closes."""
    found = {
        "power_sliding": motion.powers["sliding"],
        "power_tooth_dampers": motion.powers["tooth_dampers"],
        "power_bearings": motion.powers["supports"],
        "power_energy_residual": 0.0 if contact_of(motion.pair).conservative else motion.powers["rolling"],
        "closure": motion.closure,
        "error_estimate": motion.error,
    }
    closed = np.append(motion.time, motion.period * motion.system.period)
    for name in ("dte", "x_p", "x_g", "y_p", "y_g"):
        one, rate = (np.append(values[key], values[key][0]) for key in (name, f"{name}_dot"))
        found[f"{name}_peak_to_peak"] = peak_to_peak(closed, one, rate)
    return found
