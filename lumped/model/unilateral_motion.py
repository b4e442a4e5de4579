"""Periodic motion with unilateral contact that follows the momentary load: near the linear one, or settled.

Of like teeth `Shooting` closes one mesh cycle, or up to eight, by Broyden's method; of teeth that differ a
run settles. With prescribed contact teeth push in its fixed windows.

Sources: docs/theory/teeth.md, "Motion"; docs/theory/validity.md, "Prediction".
"""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from lumped.errors import NumericalError
from lumped.mesh.motion import Run
from lumped.mesh.tables import MeshTables
from lumped.model.closing import Closed, close_period
from lumped.model.momentary_load import (
    mean_powers,
    momentary_tables,
    run,
    steps_of,
    without_drift,
)
from lumped.model.periodic_system import LTVSystem, Supports
from lumped.model.revolution_motion import Origin, RevolutionMotion, Touch
from lumped.model.solution import static_deflection
from lumped.model.steady import UNSTABLE, PeriodicSolution, periodic_solution
from lumped.model.tooth_laws import ToothLaws
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray

#: What may be left at the end of the period, over the size of the unknowns; with steps twice as long; and
#: what is taken for closed where rounding lets no less be reached.
_CLOSED = 1e-10
_NEARLY_CLOSED = 1e-5
_ACCEPTED = 1e-8
#: Differences for derivatives, over the size of each unknown.
_DIFFERENCE = 1e-4
#: Size of the change of the torque over the torque.
_OF_TORQUE = 1e-3
#: A disturbance of which less is left after a cycle has no derivatives of its own: the torque alone has.
_FADED = 1e-3
#: A motion found has a peak to peak within this share of that of the run which settles to it.
_NEAR = 0.3
#: Mesh cycles of the first run to settle, of which each next one has twice as many; how many runs; mesh
#: cycles of the longest motion that is looked for, and at how many times as many a run is looked at.
_SETTLING = 400
_RUNS = 5
_MOST_CYCLES = 8
_LOOKED = 8
#: Relative change after so many cycles that is called a repetition; outputs in a cycle of such a run.
_REPEATS = 1e-6
_OUTPUTS = 16
#: Of teeth that differ: what a start is to have faded to before it is recorded, most cycles for that, and the
#: largest mismatch after the period, over the largest displacement, that is called periodic.
_START_FADED = 1e-11
_MOST_SETTLING = 20_000
_CALLED_CLOSED = 1e-4


@dataclass(frozen=True, eq=False)
class Shooting:
    """Mesh cycles of like teeth from unknowns at their start.

    Unknowns (2m - 1,) are the state without the common rotation and the torque that balances: of the brake,
    or of the drive where the brake torque is given.

    Attributes
    ----------
    pair : teeth alike
    system : the "full" one
    laws : of the tooth pairs
    samples : outputs in a mesh cycle
    cycles : mesh cycles after which the motion is to repeat
    """

    pair: GearPair
    system: LTVSystem
    laws: ToothLaws
    samples: int
    cycles: int = 1

    @classmethod
    def of(cls, pair: GearPair, samples: int, supports: Supports) -> Self:
        """Of one mesh cycle of a pair on its supports."""
        return cls(pair, LTVSystem.of(pair, "full", supports=supports), ToothLaws(pair), samples)

    @cached_property
    def step(self) -> float:
        """Largest step in mesh cycles."""
        return 1.0 / steps_of(self.system)

    def tables_of(self, step: float, outputs: int) -> MeshTables:
        """Tables of the contact over the mesh cycles."""
        return momentary_tables(self.laws, self.system, step, outputs)._replace(period=self.cycles)

    @cached_property
    def every(self) -> int:
        """Outputs of ``tables`` to one of ``coarse``."""
        return next((n for n in (2, 3, 5, 7) if self.samples % n == 0), self.samples)

    @cached_property
    def tables(self) -> MeshTables:
        """With the steps of the motion."""
        return self.tables_of(self.step, self.samples)

    @cached_property
    def coarse(self) -> MeshTables:
        """With steps twice as long, for derivatives and the error."""
        return self.tables_of(2.0 * self.step, self.samples // self.every)

    @cached_property
    def both(self) -> tuple[FloatArray, FloatArray]:
        """Matrices to states without the common rotation, and back."""
        support = self.system.supports
        twice = np.eye(2)
        to, back = (np.kron(twice, one) for one in (support.relative, support.back))
        return np.asarray(to, dtype=np.float64), np.asarray(back, dtype=np.float64)

    def torques(self, unknowns: FloatArray) -> tuple[float, float]:
        """Mean torques of drive and brake [N m]."""
        operating = self.pair.operating
        if operating.brake_torque == "balanced":
            return operating.pinion_torque, float(unknowns[-1])
        return float(unknowns[-1]), float(operating.brake_torque)

    def unknowns(self, state: FloatArray, driving: float, brake: float) -> FloatArray:
        """Unknowns of a state (2m,) under torques."""
        balanced = self.pair.operating.brake_torque == "balanced"
        return np.append(self.both[0] @ state, brake if balanced else driving)

    def at_rest(self) -> FloatArray:
        """Unknowns of the static deflection under the mean torques."""
        operating = self.pair.operating
        ratio = self.pair.gear.teeth / self.pair.pinion.teeth
        return self.unknowns(
            static_deflection(self.system), operating.pinion_torque, ratio * operating.pinion_torque
        )

    def run(
        self, unknowns: FloatArray, tables: MeshTables, rate: float = 0.0, cycles: int = 0, recorded: int = 0
    ) -> tuple[FloatArray, Run]:
        """First state (2m,), with a rate of the common rotation, and the run over the mesh cycles."""
        system = self.system
        driving, brake = self.torques(unknowns)
        torques = driving * system.torque_pinion + brake * system.torque_gear
        common = system.supports.common
        state = self.both[1] @ unknowns[:-1] + np.append(np.zeros(common.size), rate * common)
        count = cycles or self.cycles
        return state, run(self.pair, tables, system, 0, count, recorded or count, state, torques)

    def left(self, unknowns: FloatArray, tables: MeshTables) -> tuple[FloatArray, Run]:
        """What is left after the cycles: of the state, and of the rate of the common rotation."""
        state, found = self.run(unknowns, tables)
        moved = found.end - state
        weights = self.system.supports.common_weights
        return np.append(self.both[0] @ moved, weights @ moved[weights.size :]), found

    def scales(self, unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Sizes of the unknowns, and of what is left."""
        way, rate = np.abs(unknowns[:-1]).reshape(2, -1).max(axis=1)
        rate = max(rate, way / self.system.period)
        of_states = np.repeat([way, rate], unknowns.size // 2)
        support = self.system.supports
        sizes = np.append(of_states, _OF_TORQUE * abs(unknowns[-1]))
        return sizes, np.append(of_states, rate * float(support.common_weights @ support.common))

    def linear_derivatives(self, linear: PeriodicSolution, unknowns: FloatArray) -> FloatArray:
        """Of what is left by the unknowns, both over their scales, by the maps of the linear motion."""
        (sizes, of_left), (to, back) = self.scales(unknowns), self.both
        phi, forced = linear.over_cycle
        weights = self.system.supports.common_weights
        torque = 2
        if self.pair.operating.brake_torque != "balanced":
            torque = 1
        left = np.vstack([to, np.append(np.zeros(weights.size), weights)])
        slopes = np.column_stack([(left @ (phi - np.eye(phi.shape[0]))) @ back, left @ forced[:, torque]])
        return np.asarray(slopes * sizes / of_left[:, None], dtype=np.float64)

    def derivatives(self, unknowns: FloatArray, all_states: bool = True) -> FloatArray:
        """Of what is left by the unknowns, both over their scales, by steps twice as long."""
        sizes, of_left = self.scales(unknowns)
        about = self.left(unknowns, self.coarse)[0]
        slopes = -np.eye(unknowns.size)
        for j in range(0 if all_states else unknowns.size - 1, unknowns.size):
            moved = unknowns + _DIFFERENCE * sizes * (np.arange(unknowns.size) == j)
            slopes[:, j] = (self.left(moved, self.coarse)[0] - about) / _DIFFERENCE / of_left
        return slopes

    def closed(self, unknowns: FloatArray, slopes: FloatArray) -> Closed[Run]:
        """Unknowns near these that close the period, found from derivatives that may be rough.

        Raises
        ------
        NumericalError : there are none
        """
        sizes, of_left = self.scales(unknowns)

        def over(tables: MeshTables) -> Callable[[FloatArray], tuple[FloatArray, Run]]:
            def over_period(one: FloatArray) -> tuple[FloatArray, Run]:
                left, found = self.left(one, tables)
                return left / of_left, found

            return over_period

        # Half of the way by steps twice as long.
        near = close_period(over(self.coarse), unknowns, sizes, slopes, closed=_NEARLY_CLOSED)
        if near.left > _NEARLY_CLOSED:
            raise NumericalError("No periodic motion that follows the momentary load is near this one.")
        found = close_period(over(self.tables), near.unknowns, sizes, near.derivatives, closed=_CLOSED)
        if found.left > _ACCEPTED:
            raise NumericalError("No periodic motion that follows the momentary load is near this one.")
        return found

    def motion(self, found: Closed[Run], radius: float = 1.0) -> RevolutionMotion:
        """The motion from unknowns that close the period; ``radius`` is that of a motion near by."""
        system = self.system
        support = self.system.supports
        m = support.common_weights.size
        weights = support.common_weights
        if radius >= _FADED:
            slopes = self.derivatives(found.unknowns)[:-1, :-1]
            radius = float(np.abs(np.linalg.eigvals(slopes + np.eye(2 * m - 2))).max())
        # Powers are those of the mean speed: from a common rate whose mean vanishes.
        way = found.passed.end[:m] - found.passed.states[0, :m]
        rate = float(weights @ way) / float(weights @ support.common) / (self.cycles * system.period)
        whole = self.run(found.unknowns, self.tables, rate=-rate)[1]
        dte = whole.states[:, :m] @ system.deflection
        other = self.run(found.unknowns, self.coarse)[1].states[:, :m] @ system.deflection
        driving, brake = self.torques(found.unknowns)
        time = np.arange(self.cycles * self.samples) / self.samples * system.period
        return RevolutionMotion(
            pair=self.pair,
            system=system,
            tables=self.tables,
            touch=Touch.WINDOWS if self.tables.law.prescribed else Touch.MOMENTARY,
            time=time,
            states=without_drift(system, time, whole.states, whole.end, self.cycles * system.period),
            load=whole.loads,
            pinion_torque=driving,
            brake_torque=brake,
            powers=mean_powers(whole, self.cycles * system.period),
            closure=found.left,
            error=float(np.abs(other - dte[:: self.every]).max() / np.abs(dte).max()),
            spectral_radius=radius,
            origin=Origin.LINEAR,
        )

    def near(self, start: FloatArray, linear: PeriodicSolution) -> tuple[Closed[Run] | None, float]:
        """Unknowns that close the period near a linear motion, and a spectral radius that holds there.

        Derivatives are those of the linear motion; where contact is lost they do not lead there, and others,
        by differences, may.
        """
        with suppress(NumericalError):
            return self.closed(start, self.linear_derivatives(linear, start)), linear.spectral_radius
        with suppress(NumericalError):
            return self.closed(start, self.derivatives(start)), 1.0
        return None, 1.0

    def settled(self, unknowns: FloatArray) -> RevolutionMotion:
        """The stable motion of at most so many mesh cycles to which a run settles.

        First the run is compared with itself, then Broyden's method looks for a stable motion near it, since
        near a bifurcation settling takes long.

        Raises
        ------
        NumericalError : the run grows, or has not come to such a motion
        """
        looked = _LOOKED * _MOST_CYCLES
        deflection = self.system.deflection
        m = deflection.size
        tables = self.tables_of(2.0 * self.step, _OUTPUTS)
        for turn in range(_RUNS):
            _, found = self.run(unknowns, tables, cycles=(_SETTLING << turn) + looked, recorded=looked)
            if not np.isfinite(found.end).all():
                raise NumericalError("The motion with unilateral contact grows without bound.")
            starts = np.vstack([found.states[::_OUTPUTS], found.end]) @ self.both[0].T
            unknowns = np.append(starts[-1], unknowns[-1])
            sizes, _ = self.scales(unknowns)
            moved = (np.abs(starts[-2::-1] - starts[-1]) <= _REPEATS * sizes[:-1]).all(axis=1)
            repeats = np.flatnonzero(moved[:_MOST_CYCLES])[:1] + 1
            swing = float(np.ptp(found.states[:, :m] @ deflection))
            for cycles in repeats if repeats.size else range(1, _MOST_CYCLES + 1):
                with suppress(NumericalError):
                    of_cycles = replace(self, cycles=int(cycles))
                    motion = of_cycles.motion(of_cycles.closed(unknowns, of_cycles.derivatives(unknowns)))
                    own = float(np.ptp(motion.states[:, :m] @ deflection))
                    if motion.spectral_radius <= UNSTABLE and abs(own - swing) <= _NEAR * swing:
                        return replace(motion, origin=Origin.SETTLED)
        raise NumericalError(
            f"A run with unilateral contact has not come to a motion of at most {_MOST_CYCLES} mesh cycles: "
            "it beats, is chaotic, or is damped too little. Read its branches over speed: spurcheck response."
        )


def unilateral_motion(
    pair: GearPair, samples: int, supports: Supports = "springs", *, settles: bool = True
) -> RevolutionMotion:
    """Periodic motion of a pair as given, with contact that follows the momentary load and only pushes.

    Of like teeth it is the one that Broyden's method finds from the linear motion, if it is stable, else the
    one to which a run from there settles. Teeth that differ have the one to which a run from the motion of
    their twin settles.

    Parameters
    ----------
    pair : a validated gear pair
    samples : outputs in a mesh cycle
    supports : as of ``periodic_system``
    settles : whether to run where Broyden's method finds no stable motion; else what it finds is returned

    Raises
    ------
    NumericalError : no such motion is found
    """
    if pair.healthy is not pair:
        return settled_motion(pair, samples, supports)
    shooting = Shooting.of(pair, samples, supports)
    try:
        linear = periodic_solution(shooting.system, np.zeros(1), estimate_error=False)
    except NumericalError:  # a multiplier at +1
        start = shooting.at_rest()
    else:
        start = shooting.unknowns(linear.states[0], linear.pinion_torque, linear.brake_torque)
        near, radius = shooting.near(start, linear)
        if near is not None:
            found = shooting.motion(near, radius)
            if found.spectral_radius <= UNSTABLE or not settles:
                return found
    if not settles:
        raise NumericalError("No periodic motion that follows the momentary load is near the linear one.")
    return shooting.settled(start)


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
    try:
        twin: RevolutionMotion | PeriodicSolution = unilateral_motion(
            pair.healthy, samples, supports, settles=False
        )
    except NumericalError:
        twin = periodic_solution(system, np.zeros(1), estimate_error=False)
    laws = ToothLaws(pair)
    steps = steps_of(system) if steps is None else steps
    settling = _settling(twin.spectral_radius)
    state = twin.states[0].copy()
    driving = twin.pinion_torque
    brake = twin.brake_torque
    weights = system.supports.common_weights
    m = weights.size
    coarse = np.zeros(0)
    for part in (4, 1):
        tables = momentary_tables(laws, system, part / steps, samples)
        torques = driving * system.torque_pinion + brake * system.torque_gear
        count = settling + tables.period
        found = run(pair, tables, system, -settling, count, tables.period, state, torques)
        states = found.states
        end = found.end
        if not np.isfinite(end).all():
            raise NumericalError("The motion grows without bound: take smaller deviations or more damping.")
        duration = tables.period * system.period
        drift = float(weights @ (end - states[0])[m:]) / duration
        if part > 1 and isinstance(twin, RevolutionMotion):
            # The twin balances with the shorter steps already: the drift of its own by these is theirs.
            drift -= _drift_of_twin(twin, part / steps)
        if pair.operating.brake_torque == "balanced":
            brake -= drift / float(weights @ system.torque_gear[m:])
        else:
            driving -= drift / float(weights @ system.torque_pinion[m:])
        # The common rotation has no mean rate of its own: nominal speed is mean speed.
        common = system.supports.common / float(weights @ system.supports.common)
        until = (settling + 0.5 * tables.period) * system.period  # to the middle of the record
        state[m:] -= (float(weights @ (end - states[0])[:m]) / duration - drift * until) * common
        dte = states[:, :m] @ system.deflection
        error = float(np.abs(dte - coarse).max() if coarse.size else np.inf)
        coarse = dte
    time = (np.arange(states.shape[0]) / samples) * system.period
    relative = system.supports.relative
    closure = relative @ (end - states[0])[:m]
    largest = float(np.abs(states[:, :m] @ relative.T).max())
    closed = float(np.abs(closure).max()) / largest
    if closed > _CALLED_CLOSED:
        raise NumericalError(
            f"After {tables.period} mesh cycles the motion has not closed ({closed:.1e} of its size): it is "
            "unstable, not periodic over the period of the teeth, or damped too little."
        )
    powers = mean_powers(found, duration)
    # Sliding at nominal speed: without what a rate of the common rotation that is left adds.
    rates = system.gears[:2] @ (end - states[0])[:m] / duration
    powers["sliding"] -= float(driving * rates[0] - brake * rates[1])
    states = without_drift(system, time, states, end, duration)
    error /= float(np.abs(coarse).max())
    return RevolutionMotion(
        *(pair, system, tables, touch, time, states, found.loads, driving, brake, powers, closed, error),
        twin.spectral_radius,
        Origin.SETTLED,
    )


def _drift_of_twin(twin: RevolutionMotion, step: float) -> float:
    """Weighted rate per time that the common rotation of like teeth gains by long steps."""
    system = twin.system
    weights = twin.system.supports.common_weights
    tables = momentary_tables(ToothLaws(twin.pair), system, step, int(twin.tables.outputs.sum()))
    torques = twin.pinion_torque * system.torque_pinion + twin.brake_torque * system.torque_gear
    settling = _settling(twin.spectral_radius)
    found = run(twin.pair, tables, system, -settling, settling + 1, 1, twin.states[0], torques)
    return float(weights @ (found.end - found.states[0])[weights.size :]) / system.period


def _settling(radius: float) -> int:
    """Mesh cycles until a start has faded."""
    if radius >= 1.0:
        raise NumericalError(
            f"The motion of the healthy twin is not stable (multiplier {radius:.6f}), so none settles: raise "
            "the damping or leave the speed."
        )
    found = math.ceil(math.log(_START_FADED) / math.log(radius)) + 2
    if found > _MOST_SETTLING:
        raise NumericalError(f"A start fades in {found} mesh cycles, too slowly: raise mesh.damping_ratio.")
    return found
