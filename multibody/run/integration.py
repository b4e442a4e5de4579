"""Time integration by exudyn's DOPRI5, interval by interval, with dense output.

At fidelity "linear" an interval ends where the nominal element laws switch. At "exact" an interval is a mesh
cycle, and events (``multibody.contact.events``) divide the cycle further: the integrator stops before an
event, a Taylor step leads across the event, and a few steps without exudyn follow (``bridge``). Between the
steps the state is a quintic Hermite polynomial. The error of the polynomial is of sixth order in the step, so
the error stays below the error of the integrator, which is of fifth order.

Source: J. R. Dormand and P. J. Prince, J. Comput. Appl. Math. 6 (1980) 19-26.
"""

from __future__ import annotations

import contextlib
import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import exudyn as exu
import numpy as np

from lumped.compiler import called, compiled
from lumped.errors import NumericalError
from lumped.typing import FloatArray
from multibody.contact.events import SLIDING, time_to_event
from multibody.contact.kernels import tooth_forces
from multibody.contact.records import CONTACTS_SIZE, COORDINATES, RATES, WRENCH, Records
from multibody.run.model import ExudynModel, accelerations, stored

#: Smallest step over the mesh cycle. With a larger floor the solver hangs where friction changes sign: the
#: step cannot shrink enough to be accepted, and the solver repeats the step for ever.
_STEP_FLOOR = 1e-14
_FIRST_STEP = 1e-4
#: A run stands still when some hundred force evaluations advance the time by less than this, over the mesh
#: cycle; at the call limit they advance it a thousand times as much.
_STANDSTILL = 1e-6
#: Most predictions of events in one interval. A mesh cycle needs some ten predictions. With friction that
#: sticks, events would follow each other without end.
_MOST_EVENTS = 64
#: A Taylor polynomial of second order foretells vibration over this share of a swing of the fastest mode.
_NEAR = 0.2
#: Further ahead the nominal speed tells the time of an event. Vibration shifts this time by less than this
#: share of a swing. The time at which sliding turns depends on rates, so vibration shifts that time by more.
_FAR = 0.04
_FAR_SLIDING = 0.15
#: Most steps that are taken without exudyn at a time.
_BRIDGED = 12
#: exudyn takes an interval as finished so long before its end [s].
_EXUDYN_END = 1e-10
#: Six stages: coefficients of the rates, last the time; then the result of fifth order less that of fourth.
_TABLEAU = np.array(
    [
        [1 / 5, 0, 0, 0, 0, 0, 1 / 5],
        [3 / 40, 9 / 40, 0, 0, 0, 0, 3 / 10],
        [44 / 45, -56 / 15, 32 / 9, 0, 0, 0, 4 / 5],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0, 0, 8 / 9],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0, 1.0],
        [35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84, 1.0],
        [71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40],
    ]
)
#: Column of the tableau with the times of the stages, and its row with the weights of the error.
_TIME = 6
_ERROR = 6
#: Stages of a step, the start of the step included, and the stage at the end of the step.
_STAGES = 7
_LAST_STAGE = 6
#: Row of the accelerations, beside ``COORDINATES`` and ``RATES``, in the states of ``bridge``.
_ACCELERATIONS = 2
#: Part of the next step that the error of this one allows, and by what a step may change.
_SAFETY = 0.9
_SHRINK = 0.2
_GROW = 5.0
#: The rest of an interval is bridged if the rest is no longer than so many ordinary steps.
_FEW = 3.0
#: A step this much smaller than an ordinary one is left to exudyn.
_LEAST = 1e-9


class Stages(NamedTuple):
    """Velocities and accelerations at the stages of one step, (7, 6) each; the start of the step is first."""

    velocity: FloatArray
    acceleration: FloatArray


class TeethAndBodies(NamedTuple):
    """What the accelerations of the gears on springs are computed from.

    packed : the numbers of the machine for compiled code
    flags : the finite-motion effects that act
    bodies : BODY (6,) inertia, bearing and load of each coordinate
    """

    packed: FloatArray
    flags: int
    bodies: Records


class StepRule(NamedTuple):
    """How a step is made and judged.

    rtol, atol : relative and absolute tolerance of the error of a step
    tableau : ``_TABLEAU``; as a constant the tableau would be compiled into unrolled loops
    """

    rtol: float
    atol: float
    tableau: FloatArray


class Bridged(NamedTuple):
    """Outcome of ``bridge``.

    rows : number of rows that are filled
    step : step to continue with [s]
    calls : number of force evaluations
    """

    rows: int
    step: float
    calls: int


class MotionState(NamedTuple):
    """State of the machine at one time: time [s], and coordinates, rates and accelerations (size,)."""

    time: float
    q: FloatArray
    v: FloatArray
    a: FloatArray


@called
def weighted(weights: FloatArray, rates: FloatArray, count: int, i: int) -> float:
    """Sum of the rates of coordinate i at the first stages, by their weights."""
    total = 0.0
    for k in range(count):
        total += weights[k] * rates[k, i]
    return total


@called
def stage_state(
    state: FloatArray, q: FloatArray, v: FloatArray, h: float, row: FloatArray, count: int, stages: Stages
) -> None:
    """Write coordinates and rates of a stage into ``state``.

    q, v : (6,) at the start of the step of length h [s]
    row, count : row of the tableau, and how many stages are known
    """
    for i in range(6):
        state[COORDINATES, i] = q[i] + h * weighted(row, stages.velocity, count, i)
        state[RATES, i] = v[i] + h * weighted(row, stages.acceleration, count, i)


@called
def set_rates(stages: Stages, stage: int, state: FloatArray, bodies: Records) -> None:
    """Write velocities and accelerations of a stage, by the wrench of the teeth and the bearings."""
    for i in range(6):
        body = bodies[i]
        place = state[COORDINATES, i]
        speed = state[RATES, i]
        force = state[WRENCH, i] + body.load - body.stiffness * place - body.damping * speed
        stages.velocity[stage, i] = speed
        stages.acceleration[stage, i] = force / body.inertia


@called
def copy_row(source: FloatArray, target: FloatArray) -> None:
    """Copy a row of six values. For an assignment of rows numba would compile the text of an error."""
    for i in range(6):
        target[i] = source[i]


@called
def step_error(stages: Stages, h: float, state: FloatArray, rule: StepRule) -> float:
    """Largest error of a step of length h [s] that ends in ``state``, over the error that is allowed."""
    row = rule.tableau[_ERROR]
    worst = 0.0
    for i in range(6):
        by_place = h * abs(weighted(row, stages.velocity, _STAGES, i))
        by_speed = h * abs(weighted(row, stages.acceleration, _STAGES, i))
        worst = max(worst, by_place / (rule.atol + rule.rtol * abs(state[COORDINATES, i])))
        worst = max(worst, by_speed / (rule.atol + rule.rtol * abs(state[RATES, i])))
    return worst


@called
def step_change(error: float) -> float:
    """Factor for the next step after a step with this error over the allowed one."""
    change = _SAFETY * error**-0.2 if error > 0.0 else _GROW
    return min(max(change, _SHRINK), _GROW)


@compiled
def bridge(
    stop: float,
    ordinary: float,
    times: FloatArray,
    states: FloatArray,
    model: TeethAndBodies,
    rule: StepRule,
) -> Bridged:
    """Steps of DOPRI5 from the first of the times until ``stop``, or until the steps are of ordinary length.

    To start exudyn's solver costs as much as three steps of the solver. Behind an event these steps find the
    step size.

    Parameters
    ----------
    stop : end of the last step [s]
    ordinary : step of exudyn where no event is near; the first step that is tried [s]
    times : (n,) ends of the steps [s]; the first is an input
    states : (3, n, 6) coordinates, rates and accelerations at the ends of the steps; the first is an input
    model : the machine
    rule : tolerances and tableau
    """
    state = np.empty((3, 6))
    contacts = np.empty(CONTACTS_SIZE)
    stages = Stages(np.empty((_STAGES, 6)), np.empty((_STAGES, 6)))
    step = ordinary
    rows = 1
    calls = 0
    while rows < times.size and times[rows - 1] < stop:
        start = rows - 1
        remaining = stop - times[start]
        if rows > 1 and step >= ordinary and remaining > _FEW * ordinary:
            break
        equal_steps = math.ceil(remaining / step)
        h = remaining / equal_steps
        q = states[COORDINATES, start]
        v = states[RATES, start]
        copy_row(v, stages.velocity[0])
        copy_row(states[_ACCELERATIONS, start], stages.acceleration[0])
        for stage in range(_LAST_STAGE):
            stage_state(state, q, v, h, rule.tableau[stage], stage + 1, stages)
            calls += 1
            t = times[start] + h * rule.tableau[stage, _TIME]
            if tooth_forces(t, state, model.packed, model.flags, contacts) < 0:
                return Bridged(rows, step, calls)
            set_rates(stages, stage + 1, state, model.bodies)
        copy_row(state[COORDINATES], states[COORDINATES, rows])
        copy_row(state[RATES], states[RATES, rows])
        copy_row(stages.acceleration[_LAST_STAGE], states[_ACCELERATIONS, rows])
        error = step_error(stages, h, state, rule)
        change = step_change(error)
        if error <= 1.0:
            times[rows] = stop if equal_steps == 1 else times[start] + h
            rows += 1
            # A step that was shortened tells little about a longer step.
            step = max(change * h, step) if change >= 1.0 else change * h
        else:
            step = min(change, 1.0) * h
            if not step > _LEAST * ordinary:
                break
    return Bridged(rows, step, calls)


@dataclass(frozen=True)
class Segment:
    """Accepted steps of one interval and their dense output: times (n,); q, v and a (n, size)."""

    times: FloatArray
    q: FloatArray
    v: FloatArray
    a: FloatArray

    def at(self, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Coordinates and velocities at times t (m,) inside the interval, each (m, size)."""
        if self.times.size == 1:
            return np.repeat(self.q, t.size, axis=0), np.repeat(self.v, t.size, axis=0)
        j = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, self.times.size - 2)
        h = (self.times[j + 1] - self.times[j])[:, None]
        s = (t - self.times[j])[:, None] / h
        # Coefficients of s^3, s^4, s^5 from the gap between the Taylor polynomial (q, v, a) and the next
        # step.
        start = self.q[j]
        speed = h * self.v[j]
        bend = h * h * self.a[j]
        gap = self.q[j + 1] - start - speed - 0.5 * bend
        gap_1 = h * self.v[j + 1] - speed - bend
        gap_2 = h * h * self.a[j + 1] - bend
        c3 = 10.0 * gap - 4.0 * gap_1 + 0.5 * gap_2
        c4 = -15.0 * gap + 7.0 * gap_1 - gap_2
        c5 = 6.0 * gap - 3.0 * gap_1 + 0.5 * gap_2
        q = start + s * (speed + s * (0.5 * bend + s * (c3 + s * (c4 + s * c5))))
        v = (speed + s * (bend + s * (3.0 * c3 + s * (4.0 * c4 + s * 5.0 * c5)))) / h
        return q, v

    @property
    def end(self) -> MotionState:
        """State at the last time."""
        return MotionState(float(self.times[-1]), self.q[-1], self.v[-1], self.a[-1])

    @classmethod
    def concatenated(cls, parts: list[Segment]) -> Segment:
        """Join the parts of one interval. Every part starts with the last row of the part before."""
        rows = [slice(None)] + [slice(1, None)] * (len(parts) - 1)
        return cls(
            *(
                np.concatenate([getattr(part, name)[row] for part, row in zip(parts, rows, strict=True)])
                for name in ("times", "q", "v", "a")
            )
        )


def settings(rtol: float, atol: float, period: float) -> exu.SimulationSettings:
    """Settings of the explicit integrator: no files, every step stored by the sensors."""
    s = exu.SimulationSettings()
    ti = s.timeIntegration
    ti.solverType = exu.DynamicSolverType.DOPRI5
    ti.automaticStepSize = True
    ti.relativeTolerance = rtol
    ti.absoluteTolerance = atol
    ti.minimumStepSize = _STEP_FLOOR * period
    ti.numberOfSteps = 1
    ti.verboseMode = 0
    ti.explicit.computeEndOfStepAccelerations = False
    s.solution.file.write = False
    s.solution.sensors.writePeriod = _STEP_FLOOR * period
    s.show.computationTime = False
    return s


def integrate(
    model: ExudynModel,
    q: FloatArray,
    v: FloatArray,
    edges: FloatArray,
    *,
    rtol: float,
    atol: float,
    clamp: bool,
    visit: Callable[[int, Segment], None],
) -> tuple[FloatArray, FloatArray]:
    """Integrate over consecutive intervals from the state (q, v). Return the state at the last edge.

    edges : (m + 1,) ends of the intervals [s]
    clamp : evaluate the nominal phase strictly inside each interval (the edges are switches)
    visit : called with the number and the segment of each interval
    Raises NumericalError : a force or a state is not finite, or the force was evaluated too often
    """
    s = settings(rtol, atol, model.machine.period)
    step = _FIRST_STEP * model.machine.period
    for number, (start, stop) in enumerate(itertools.pairwise(edges)):
        if clamp:
            keep_inside(model, start, stop)
        model.budget.reset()
        segment, step = _interval(model, s, q, v, float(start), float(stop), step, locate=not clamp)
        visit(number, segment)
        q = segment.q[-1]
        v = segment.v[-1]
    return q, v


def keep_inside(model: ExudynModel, start: float, stop: float) -> None:
    """Let the model evaluate the nominal phase strictly inside an interval between two switches."""
    margin = 1e-12 * model.machine.period
    rolling = model.record.rolling
    rolling.earliest = start + margin
    rolling.latest = stop - margin


def _interval(
    model: ExudynModel,
    s: exu.SimulationSettings,
    q: FloatArray,
    v: FloatArray,
    start: float,
    stop: float,
    step: float,
    locate: bool,
) -> tuple[Segment, float]:
    """Integrate over one interval, from event to event. Return the segment and a step size to continue with.

    locate : whether the interval is divided at events
    """
    m = model.machine
    parts = []
    gears = slice(0, 6)
    state = MotionState(start, q, v, accelerations(model, np.array([start]), q[None], v[None])[0])
    # Times in swings of the fastest mode. The error of a Taylor step of second order is the square of the
    # angle over which the fastest mode swings. So a step to an event this close errs by less than a tenth of
    # rtol.
    swing = m.period / max(m.vibrations_per_cycle, 1.0)
    close = max(0.05 * np.sqrt(s.timeIntegration.relativeTolerance) * swing, _EXUDYN_END)
    if not np.isfinite(state.a).all():
        model.budget.reason = "not finite"
        raise _failure(model, start, stop)
    after_event = False
    for _ in range(_MOST_EVENTS if locate else 0):
        t = state.time
        wait, kind = time_to_event(
            t,
            state.q[gears],
            state.v[gears],
            state.a[gears],
            model.packed,
            model.flags,
            m.events,
            _NEAR * swing,
        )
        if wait < close:
            beyond = t + wait + 1e-12 * m.period + 1e-15 * t
            if not beyond < stop:
                break
            part = _across(model, state, t + wait, beyond)
            after_event = True
        else:
            # Vibration may shift the event by the third order of the Taylor polynomial: stop so much earlier.
            ahead = wait / swing
            short = max(0.5 * ahead**3, 0.5 * close / swing)
            if ahead >= _NEAR:
                short = _FAR_SLIDING if kind == SLIDING else _FAR
            until = t + wait - swing * min(0.5 * ahead, short)
            if not until < stop:  # or no event at all
                break
            part, step = _steps_until(model, s, state, until, step, after_event=after_event)
            after_event = False
        parts.append(part)
        state = part.end
    part, step = _steps_until(model, s, state, stop, step, after_event=after_event)
    return Segment.concatenated([*parts, part]), step


def _steps_until(
    model: ExudynModel,
    s: exu.SimulationSettings,
    state: MotionState,
    stop: float,
    step: float,
    *,
    after_event: bool = False,
) -> tuple[Segment, float]:
    """Integrate from a state over a time without events. Return the segment and an ordinary step size [s].

    after_event : whether the state is just behind an event, where the step size is not known
    """
    parts = []
    first = step
    ti = s.timeIntegration
    if (after_event or stop - state.time <= _FEW * step) and model.machine.train is None:
        part, first = _bridged(model, s, state, stop, step)
        parts.append(part)
        state = part.end
    atol = ti.absoluteTolerance
    share = 1.0
    while state.time < stop:
        ti.absoluteTolerance = share * atol
        parts.append(_run(model, s, state, stop, first))
        step = first = _middle_step(parts[-1], step)
        state = parts[-1].end
        share = 1.5 - share  # after a standstill the tolerance is halved; after another it is the whole again
    ti.absoluteTolerance = atol
    return Segment.concatenated(parts), step


def _bridged(
    model: ExudynModel, s: exu.SimulationSettings, state: MotionState, stop: float, step: float
) -> tuple[Segment, float]:
    """Steps of ``bridge`` from a state, and the step size to continue with [s]."""
    ti = s.timeIntegration
    times = np.full(_BRIDGED + 1, state.time)
    states = np.empty((3, _BRIDGED + 1, 6))
    states[:, 0] = state.q, state.v, state.a
    machine = TeethAndBodies(model.packed, model.flags, model.machine.bodies)
    rule = StepRule(ti.relativeTolerance, ti.absoluteTolerance, _TABLEAU)
    bridged = bridge(stop, step, times, states, machine, rule)
    model.budget.calls += bridged.calls
    return Segment(times[: bridged.rows], *states[:, : bridged.rows]), bridged.step


def _middle_step(part: Segment, default: float) -> float:
    """Step size from the middle of a run, where neither the start nor the end of the run shortened a step."""
    middle = part.times.size // 2
    return float(part.times[middle] - part.times[middle - 1]) if part.times.size > 3 else default


def _across(model: ExudynModel, state: MotionState, event: float, beyond: float) -> Segment:
    """Taylor step from a state to an event, and just beyond the event, where the force is another."""
    times = np.array([state.time, event, beyond])
    h = (times - state.time)[:, None]
    states_q = state.q + h * (state.v + 0.5 * h * state.a)
    states_v = state.v + h * state.a
    states_a = np.repeat(state.a[None], 3, axis=0)
    states_a[-1:] = accelerations(model, times[-1:], states_q[-1:], states_v[-1:])
    return Segment(times, states_q, states_v, states_a)


def _run(
    model: ExudynModel,
    s: exu.SimulationSettings,
    state: MotionState,
    stop: float,
    step: float,
) -> Segment:
    """Run exudyn from a state until ``stop``, or until the run stands still.

    exudyn scales the error by atol + rtol max(x, x before) and does not take the absolute value of x. So at
    x = -atol/rtol no error is small enough, and the run stands still. The steps before are valid. With
    another atol the run stands still at another x.
    """
    start = state.time
    ti = s.timeIntegration
    system = model.system
    budget = model.budget
    budget.watch(start, _STANDSTILL * model.machine.period)
    ti.startTime = start
    ti.endTime = stop
    ti.initialStepSize = min(step, stop - start)
    system.systemData.SetODE2Coordinates(state.q.tolist(), configuration=exu.ConfigurationType.Initial)
    system.systemData.SetODE2Coordinates_t(state.v.tolist(), configuration=exu.ConfigurationType.Initial)
    try:
        with quiet():
            finished = system.SolveDynamic(s)
    except Exception as error:  # exudyn wraps whatever a user function raises in its own types
        if "KeyboardInterrupt" in str(error):  # Ctrl-C lands in the user function and is wrapped as well
            raise KeyboardInterrupt from None
        if budget.reason != "standstill":
            raise _failure(model, start, stop) from error
        finished = True
        stop = start
    if not finished:
        raise _failure(model, start, stop)
    times, states_q, states_v = stored(model)
    if not (np.isfinite(states_q).all() and np.isfinite(states_v).all()):
        budget.reason = "not finite"
        raise _failure(model, start, stop)
    keep = np.diff(times, prepend=-np.inf) > 0.0
    times = times[keep]
    states_q = states_q[keep]
    states_v = states_v[keep]
    states_a = accelerations(model, times, states_q, states_v)
    if times[-1] < stop:
        # exudyn takes an interval as finished up to 1e-10 s before its end. Without a step over this rest all
        # later times would be shifted. A Taylor step over the rest is exact to rounding.
        last = _across(model, Segment(times, states_q, states_v, states_a).end, stop, stop)
        times = np.append(times, stop)
        states_q = np.vstack([states_q, last.q[-1:]])
        states_v = np.vstack([states_v, last.v[-1:]])
        states_a = np.vstack([states_a, last.a[-1:]])
    return Segment(times, states_q, states_v, states_a)


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """Keep exudyn from writing to the console. The exception says why a run failed."""
    before = exu.config.printToConsole
    exu.config.printToConsole = False
    try:
        yield
    finally:
        exu.config.printToConsole = before


def _failure(model: ExudynModel, start: float, stop: float) -> NumericalError:
    calls = f"More than {model.budget.limit} force evaluations in one interval: the steps keep shrinking. "
    text = {
        "not finite": "A force or a state is not finite; check torque, stiffness and the initial state.",
        "too many calls": f"{calls}Loosen rtol, or smooth the friction at the pitch point "
        "(friction_velocity) or the engagement (mesh.stiffness.ramp_length).",
    }.get(model.budget.reason, "exudyn's integrator stopped; loosen rtol or shorten the run.")
    return NumericalError(f"Multibody run stopped between t = {start:.6g} and {stop:.6g} s. {text}")
