"""Periodic motion with unilateral contact, in which stiffness and dampers follow the momentary load.

- Like teeth: `Shooting` closes one mesh cycle, or up to eight, by Broyden's method, from the linear motion.
  Where this gives no stable motion, a run settles, and Broyden's method closes the motion that the run comes
  to. Where no run settles, `lumped.model.neighbouring_motion` follows one from another torque or speed.
- Teeth that differ: a run settles until its start has faded (`settled_motion`).

With prescribed contact teeth push in fixed windows of the path.

Sources: docs/theory/teeth.md, "Motion"; docs/theory/validity.md, "Prediction".
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from lumped.errors import NumericalError, UnsettledError
from lumped.mesh.motion import CycleSpan, Run
from lumped.model.equations import COORDINATES
from lumped.model.mesh_cycle import MeshCycle
from lumped.model.momentary_load import (
    MomentaryRuns,
    mean_powers,
    momentary_tables,
    steps_of,
    without_drift,
)
from lumped.model.period_closure import Closed, close_period
from lumped.model.periodic_system import LTVSystem, Supports
from lumped.model.propagation import fastest_frequency
from lumped.model.revolution_motion import Origin, RevolutionMotion, Touch, resolves, swings_of_period
from lumped.model.solution import static_deflection
from lumped.model.static_cycle import StaticCycle
from lumped.model.steady import UNSTABLE, PeriodicSolution, periodic_solution
from lumped.model.tooth_laws import ToothLaws
from lumped.schema.pair import GearPair
from lumped.typing import BoolArray, FloatArray, IntArray, Progress, unheard

#: Largest angle of the fastest vibration in a step of the linear motion from which the search starts [rad].
_START_ANGLE = 2.0
#: Most steps of Broyden's method, with long integration steps, from the rough linear motion.
_FEW_STEPS = 6
#: Mismatch at the end of the period, over the size of the unknowns, that counts as closed; the same with
#: steps twice as long; and what still counts as closed where rounding allows no less.
_CLOSED = 1e-10
_NEARLY_CLOSED = 1e-5
_ACCEPTED = 1e-8
#: Change of an unknown, over its size, for derivatives by differences.
_DIFFERENCE = 1e-4
#: Size of the change of the torque over the torque.
_OF_TORQUE = 1e-3
#: Spectral radius below which a disturbance fades within a cycle: the states then need no derivatives.
_FADED = 1e-3
#: A motion belongs to the run that settles if both have the same peak to peak within this share.
_SAME_SWING = 0.3
#: Most mesh cycles of the first run that settles; each next run has twice as many. Most such runs.
_SETTLING = 400
_RUNS = 5
#: Most steps of a run that settles, beyond the first run: some seconds.
_MOST_STEPS = 5_000_000
#: Mesh cycles of the longest motion that is sought. A run is compared with itself over so many times as many.
_MOST_CYCLES = 8
_COMPARED = 8
#: Relative change after some cycles that counts as a repetition; the same where a disturbance fades within a
#: cycle: then rounding alone remains, which grows with the number of steps, 1e-5 at 60,000 steps.
_REPEATS = 1e-6
_REPEATS_OF_SLOW = 1e-4
#: Outputs in a cycle of a run that settles.
_OUTPUTS = 16
#: Angle of the fastest vibration between two outputs from which a peak to peak is taken [rad].
_OUTPUT_ANGLE = 1.5
#: Teeth that differ: share of a start that may remain when the record begins, most cycles for that, and
#: largest mismatch after the period, over the largest displacement, that counts as periodic.
_START_FADED = 1e-11
_MOST_SETTLING = 20_000
_CALLED_CLOSED = 1e-4


@dataclass(frozen=True, eq=False)
class Shooting:
    """The search for a periodic motion of like teeth: runs over mesh cycles from unknowns at their start.

    The unknowns (2m - 1,) are the state without the common rotation, and the torque that balances: the brake
    torque or, where the file gives the brake torque, the driving torque.

    Attributes
    ----------
    pair : gear pair with like teeth
    system : the "full" system of the pair
    laws : laws of the tooth pairs
    fine : runs with the steps of the motion
    coarse : runs with steps twice as long, for derivatives and for the error
    samples : outputs in a mesh cycle
    cycles : mesh cycles after which the motion shall repeat
    """

    pair: GearPair
    system: LTVSystem
    laws: ToothLaws
    fine: MomentaryRuns
    coarse: MomentaryRuns
    samples: int
    cycles: int = 1

    @classmethod
    def of(cls, pair: GearPair, samples: int, supports: Supports) -> Self:
        """Return the search for a motion that repeats with every mesh cycle."""
        laws = ToothLaws(pair)
        cycle = StaticCycle(laws) if laws.loaded else None
        return cls.of_laws(pair, LTVSystem.of(pair, "full", cycle=cycle, supports=supports), laws, samples)

    @classmethod
    def of_laws(cls, pair: GearPair, system: LTVSystem, laws: ToothLaws, samples: int) -> Self:
        """Return the search with a "full" system and laws that need not be those of the pair."""
        step = 1.0 / steps_of(system)
        fine = MomentaryRuns(pair, system, momentary_tables(laws, system, step, samples))
        outputs = samples // outputs_for_one(samples)
        coarse = MomentaryRuns(pair, system, momentary_tables(laws, system, 2.0 * step, outputs))
        return cls(pair, system, laws, fine, coarse, samples)

    @property
    def every(self) -> int:
        """Number of outputs of ``fine`` for one output of ``coarse``."""
        return outputs_for_one(self.samples)

    @property
    def to_relative(self) -> FloatArray:
        """Matrix (2m - 2, 2m) from states to states without the common rotation."""
        return self.system.supports.to_relative_states

    @property
    def from_relative(self) -> FloatArray:
        """Matrix (2m, 2m - 2) back to all states; the common rotation becomes 0."""
        return self.system.supports.from_relative_states

    @cached_property
    def to_mismatch(self) -> FloatArray:
        """Matrix (2m - 1, 2m) from changes of the states to the mismatch: the relative states, and the
        weighted rate of the common rotation.
        """
        weights = self.system.supports.common_weights
        return np.vstack([self.to_relative, np.append(np.zeros(weights.size), weights)])

    @cached_property
    def moves_no_tooth(self) -> BoolArray:
        """Which relative states (2m - 2,) move no tooth: the mesh does not feel their motion, and neither do
        the others. On springs they are the displacements off the line of action, and their rates.
        """
        free = self._free
        half = len(free) // 2
        of_mesh = np.tile(self.system.deflection @ self.system.supports.back != 0.0, 2)
        still = ~of_mesh
        for _ in range(half):
            # A state that acts on a state which moves the teeth moves the teeth itself.
            acts = (free[~still] != 0.0).any(axis=0)
            acts = np.tile(acts[:half] | acts[half:], 2)
            if not (still & acts).any():
                break
            still &= ~acts
        return still

    @property
    def _free(self) -> FloatArray:
        """Matrix (2m - 2, 2m - 2) of the relative states with the teeth apart."""
        return np.asarray(self.to_relative @ self.system.constant @ self.from_relative, dtype=np.float64)

    def torques(self, unknowns: FloatArray) -> tuple[float, float]:
        """Mean torques of drive and brake [N m] that belong to the unknowns."""
        operating = self.pair.operating
        if operating.brake_torque == "balanced":
            return operating.pinion_torque, float(unknowns[-1])
        return float(unknowns[-1]), float(operating.brake_torque)

    def unknowns(self, state: FloatArray, driving: float, brake: float) -> FloatArray:
        """Unknowns that belong to a state (2m,) and the torques of drive and brake [N m]."""
        balanced = self.pair.operating.brake_torque == "balanced"
        return np.append(self.to_relative @ state, brake if balanced else driving)

    def at_rest(self) -> FloatArray:
        """Unknowns that belong to the static deflection under the mean torques."""
        operating = self.pair.operating
        ratio = self.pair.gear.teeth / self.pair.pinion.teeth
        return self.unknowns(
            static_deflection(self.system), operating.pinion_torque, ratio * operating.pinion_torque
        )

    def run(
        self, unknowns: FloatArray, runs: MomentaryRuns, rate: float = 0.0, cycles: int = 0, recorded: int = 0
    ) -> tuple[FloatArray, Run]:
        """Run over mesh cycles from unknowns; returns the state (2m,) at the start and the run.

        Parameters
        ----------
        unknowns, runs : start, and the runs with their steps
        rate : rate of the common rotation at the start
        cycles : mesh cycles; 0: as many as the motion has
        recorded : number of the last mesh cycles that are recorded, which takes half as long again
        """
        state, torques = self._start(unknowns)
        if rate != 0.0:
            common = self.system.supports.common
            state[common.size :] += rate * common
        count = cycles or self.cycles
        return state, runs.run(0, count, recorded, state, torques)

    def _start(self, unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
        """State (2m,) at the start that belongs to unknowns, and the accelerations (2m,) by the torques."""
        driving, brake = self.torques(unknowns)
        torques = driving * self.system.torque_pinion + brake * self.system.torque_gear
        return self.from_relative @ unknowns[:-1], torques

    def mismatch(self, unknowns: FloatArray, runs: MomentaryRuns) -> tuple[FloatArray, Run]:
        """Change of state and weighted rate of the common rotation over the cycles; and the run."""
        state, period_run = self.run(unknowns, runs)
        return self.to_mismatch @ (period_run.end - state), period_run

    def scales(self, unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Sizes of the unknowns (2m - 1,), and sizes of the entries of the mismatch (2m - 1,)."""
        displacement, rate = np.abs(unknowns[:-1]).reshape(2, -1).max(axis=1)
        rate = max(rate, displacement / self.system.period)
        of_states = np.repeat([displacement, rate], unknowns.size // 2)
        support = self.system.supports
        sizes = np.append(of_states, _OF_TORQUE * abs(unknowns[-1]))
        return sizes, np.append(of_states, rate * float(support.common_weights @ support.common))

    def linear_derivatives(self, linear: PeriodicSolution, unknowns: FloatArray) -> FloatArray:
        """Derivatives of the mismatch by the unknowns, over their scales, by the linear motion's maps."""
        sizes, of_mismatch = self.scales(unknowns)
        phi, forced = linear.over_cycle
        torque = 2
        if self.pair.operating.brake_torque != "balanced":
            torque = 1
        by_state = (self.to_mismatch @ (phi - np.eye(phi.shape[0]))) @ self.from_relative
        by_torque = self.to_mismatch @ forced[:, torque]
        slopes = np.column_stack([by_state, by_torque])
        return np.asarray(slopes * sizes / of_mismatch[:, None], dtype=np.float64)

    def derivatives(self, unknowns: FloatArray) -> FloatArray:
        """Derivatives of the mismatch by the unknowns, both over their scales, by differences.

        The runs have steps twice as long.
        """
        unchanged = self.mismatch(unknowns, self.coarse)[0]
        return self._differences(unknowns, unchanged, np.arange(unknowns.size))

    def _differences(self, unknowns: FloatArray, unchanged: FloatArray, columns: IntArray) -> FloatArray:
        """Derivatives by some of the unknowns; ``unchanged`` is the mismatch of runs with long steps."""
        sizes, of_mismatch = self.scales(unknowns)
        changes = np.diag(_DIFFERENCE * sizes)[columns]
        starts = [self._start(unknowns + change) for change in changes]
        states, torques = (np.array(part) for part in zip(*starts, strict=True))
        ends = self.coarse.together(CycleSpan(0, self.cycles, 0), states, torques).end
        changed = np.array([self.to_mismatch @ change for change in ends - states])
        return np.asarray(((changed - unchanged) / _DIFFERENCE / of_mismatch).T, dtype=np.float64)

    def spectral_radius(self, unknowns: FloatArray, unchanged: FloatArray) -> float:
        """Largest modulus of the multipliers of the motion from some unknowns.

        Multipliers of states that move no tooth are those of free vibrations. The others follow from
        differences of runs with steps twice as long.

        Parameters
        ----------
        unknowns : that close the period
        unchanged : mismatch (2m - 1,) of the run with long steps from these unknowns
        """
        still = self.moves_no_tooth
        moving = np.flatnonzero(~still)
        slopes = self._differences(unknowns, unchanged, moving)[moving]
        multipliers = np.abs(np.linalg.eigvals(slopes + np.eye(moving.size)))
        growth = np.linalg.eigvals(self._free[np.ix_(still, still)]).real.max(initial=-np.inf)
        return max(float(multipliers.max()), math.exp(growth * self.cycles * self.system.period))

    def closed(
        self, unknowns: FloatArray, slopes: FloatArray, accepted: float = _ACCEPTED, most: int = 40
    ) -> Closed[Run]:
        """Close the period by Broyden's method, from unknowns and derivatives that may be rough.

        The first steps run with integration steps twice as long, the last ones with those of the motion.

        Parameters
        ----------
        unknowns, slopes : start, and derivatives of the mismatch by the unknowns, both over their scales
        accepted : largest mismatch of the result
        most : most steps of Broyden's method with the long integration steps

        Raises
        ------
        NumericalError : no unknowns close the period
        """
        sizes, of_mismatch = self.scales(unknowns)

        def over(runs: MomentaryRuns) -> Callable[[FloatArray], tuple[FloatArray, Run]]:
            def over_period(start: FloatArray) -> tuple[FloatArray, Run]:
                mismatch, period_run = self.mismatch(start, runs)
                return mismatch / of_mismatch, period_run

            return over_period

        rough = close_period(over(self.coarse), unknowns, sizes, slopes, closed=_NEARLY_CLOSED, most=most)
        if rough.mismatch > max(_NEARLY_CLOSED, accepted):
            raise NumericalError("No periodic motion that follows the momentary load is near this one.")
        fine = close_period(over(self.fine), rough.unknowns, sizes, rough.derivatives, closed=_CLOSED)
        if fine.mismatch > accepted:
            raise NumericalError("No periodic motion that follows the momentary load is near this one.")
        return fine

    def motion(self, closed: Closed[Run], radius: float = 1.0) -> RevolutionMotion:
        """Return the motion of unknowns that close the period.

        ``radius`` is the spectral radius of a motion close by. If a disturbance fades within a cycle there,
        it is taken; else the spectral radius is computed.
        """
        system = self.system
        support = self.system.supports
        m = support.common_weights.size
        weights = support.common_weights
        start, coarse = self.run(closed.unknowns, self.coarse, recorded=self.cycles)
        if radius >= _FADED:
            radius = self.spectral_radius(closed.unknowns, self.to_mismatch @ (coarse.end - start))
        # Powers are those of the mean speed: the run starts with a common rate whose mean vanishes.
        change = (closed.passed.end - start)[:m]
        rate = float(weights @ change) / float(weights @ support.common) / (self.cycles * system.period)
        final = self.run(closed.unknowns, self.fine, rate=-rate, recorded=self.cycles)[1]
        dte = final.states[:, :m] @ system.deflection
        coarse_dte = coarse.states[:, :m] @ system.deflection
        driving, brake = self.torques(closed.unknowns)
        time = np.arange(self.cycles * self.samples) / self.samples * system.period
        return RevolutionMotion(
            pair=self.pair,
            system=system,
            tables=self.fine.tables._replace(period=self.cycles),
            touch=Touch.WINDOWS if self.fine.tables.law.prescribed else Touch.MOMENTARY,
            time=time,
            states=without_drift(system, time, final.states, final.end, self.cycles * system.period),
            load=final.loads,
            pinion_torque=driving,
            brake_torque=brake,
            powers=mean_powers(final, self.cycles * system.period),
            closure=closed.mismatch,
            error=float(np.abs(coarse_dte - dte[:: self.every]).max() / np.abs(dte).max()),
            spectral_radius=radius,
            origin=Origin.LINEAR,
            resolved_peak_to_peak=self._resolved_peak_to_peak(closed.unknowns, -rate),
        )

    def close_by(self) -> RevolutionMotion | None:
        """Return the motion that few steps of Broyden's method reach from a rough linear motion, or None.

        Where few steps suffice, the exact linear motion leads to the same motion. Where contact is lost for
        long, motions coexist, and many steps may lead to any of them.
        """
        with suppress(NumericalError):
            linear = periodic_solution(
                self.system, np.zeros(1), estimate_error=False, step_angle=_START_ANGLE
            )
            start = self.unknowns(linear.states[0], linear.pinion_torque, linear.brake_torque)
            closed = self.closed(start, self.linear_derivatives(linear, start), most=_FEW_STEPS)
            return self.motion(closed, linear.spectral_radius)
        return None

    def with_fitted_laws(self) -> Shooting:
        """Return the same search with the fitted laws of the linear form, which its exact motion needs."""
        system = self.system
        return replace(self, system=replace(system, cycle=MeshCycle.of(system.pair)))

    def _resolved_peak_to_peak(self, unknowns: FloatArray, rate: float) -> dict[str, float]:
        """Peak to peak from a run with outputs that resolve the fastest vibration [m].

        Empty where the outputs of the motion resolve it.
        """
        system = self.system
        if resolves(system, self.samples):
            return {}
        outputs = _resolving_outputs(system, self.samples)
        tables = momentary_tables(self.laws, system, 1.0 / steps_of(system), outputs)
        runs = MomentaryRuns(self.pair, system, tables)
        states = self.run(unknowns, runs, rate=rate, recorded=self.cycles)[1].states
        return _swings_of_states(system, states, self.cycles)

    def near(self, start: FloatArray, linear: PeriodicSolution) -> tuple[Closed[Run] | None, float]:
        """Close the period near a linear motion; return the result, or None, and a spectral radius near
        there.

        First with the derivatives of the linear motion. Where contact is lost they may not lead to a motion;
        then with derivatives by differences.
        """
        with suppress(NumericalError):
            return self.closed(start, self.linear_derivatives(linear, start)), linear.spectral_radius
        with suppress(NumericalError):
            return self.closed(start, self.derivatives(start)), 1.0
        return None, 1.0

    def settled(
        self, unknowns: FloatArray, radius: float = 1.0, progress: Progress = unheard
    ) -> RevolutionMotion:
        """Return the stable motion, of at most eight mesh cycles, to which a run settles.

        Each run is compared with itself after 1 to 8 cycles. Broyden's method then looks for a stable motion
        close to the run, because settling takes long near a bifurcation.

        Parameters
        ----------
        unknowns : start of the first run
        radius : spectral radius of the linear motion. The smaller it is, the shorter is the first run: the
            mesh cycle of a slow pair has many steps, and its vibrations fade within the cycle
        progress : called with the finished share of the runs before each run

        Raises
        ------
        NumericalError : the run grows, or has not come to such a motion
        """
        first = _first_settling(radius)
        compared = min(_COMPARED * _MOST_CYCLES, _MOST_CYCLES + first)
        deflection = self.system.deflection
        m = deflection.size
        tables = momentary_tables(self.laws, self.system, 2.0 / steps_of(self.system), _OUTPUTS)
        runs = MomentaryRuns(self.pair, self.system, tables)
        counts = list(_settling_runs(first, steps_of(self.system) // 2))
        for number, settling_cycles in enumerate(counts):
            progress(sum(counts[:number]) / sum(counts), f"run over {settling_cycles} mesh cycles")
            cycles = settling_cycles + compared
            _, settling = self.run(unknowns, runs, cycles=cycles, recorded=compared)
            if not np.isfinite(settling.end).all():
                raise UnsettledError("The motion with unilateral contact grows without bound.")
            starts = np.vstack([settling.states[::_OUTPUTS], settling.end]) @ self.to_relative.T
            unknowns = np.append(starts[-1], unknowns[-1])
            sizes, _ = self.scales(unknowns)
            allowed = _REPEATS_OF_SLOW if radius < _FADED else _REPEATS
            repeated = (np.abs(starts[-2::-1] - starts[-1]) <= allowed * sizes[:-1]).all(axis=1)
            repeats = np.flatnonzero(repeated[:_MOST_CYCLES])[:1] + 1
            accepted = allowed if repeats.size else _ACCEPTED
            swing = float(np.ptp(settling.states[:, :m] @ deflection))
            if not repeats.size and radius < _FADED:
                continue  # settling is fast, so no motion nearby is waiting to be closed
            most = int(repeats[0]) if repeats.size else _MOST_CYCLES
            # A motion that repeats after n cycles may repeat after a divisor of n.
            for cycles in (n for n in range(1, most + 1) if not repeats.size or most % n == 0):
                with suppress(NumericalError):
                    of_cycles = replace(self, cycles=cycles)
                    slopes = of_cycles.derivatives(unknowns)
                    motion = of_cycles.motion(of_cycles.closed(unknowns, slopes, accepted))
                    swing_of_motion = float(np.ptp(motion.states[:, :m] @ deflection))
                    same = abs(swing_of_motion - swing) <= _SAME_SWING * swing
                    if motion.spectral_radius <= UNSTABLE and same:
                        return replace(motion, origin=Origin.SETTLED)
        raise UnsettledError(
            f"A run with unilateral contact has not come to a motion of at most {_MOST_CYCLES} mesh cycles: "
            "it beats, is chaotic, or is damped too little. Read its branches over speed: spurcheck response."
        )


def _first_settling(radius: float) -> int:
    """Mesh cycles of the first run that settles, of a pair whose linear motion has a spectral radius."""
    if not 0.0 < radius < 1.0:
        return 2 if radius == 0.0 else _SETTLING
    return min(_SETTLING, math.ceil(math.log(_START_FADED) / math.log(radius)) + 2)


def _settling_runs(first: int, steps: int) -> Iterator[int]:
    """Mesh cycles of each run that settles: twice as many each time, up to the longest one.

    ``steps`` is the number of steps in a mesh cycle.
    """
    cycles = first
    while cycles <= min(_SETTLING << (_RUNS - 1), max(first, _MOST_STEPS // steps)):
        yield cycles
        cycles *= 2


def outputs_for_one(samples: int) -> int:
    """Number of outputs of the fine runs for one output of the coarse runs: the least divisor up to 7."""
    return next((n for n in (2, 3, 5, 7) if samples % n == 0), samples)


def unilateral_motion(
    pair: GearPair,
    samples: int,
    supports: Supports = "springs",
    *,
    settles: bool = True,
    progress: Progress = unheard,
) -> RevolutionMotion:
    """Periodic motion of a pair with unilateral contact by momentary load, with the teeth of the pair.

    Like teeth: Broyden's method starts from the linear motion. If it finds no stable motion, the motion is
    the one to which a run from the linear motion settles. Teeth that differ: the motion to which a run from
    the motion of the twin with like teeth settles.

    Parameters
    ----------
    pair : a validated gear pair
    samples : outputs in a mesh cycle
    supports : as of ``periodic_system``
    settles : whether a run settles where Broyden's method finds no stable motion. If not, the unstable motion
        is returned
    progress : called with the finished fraction and what is being done

    Raises
    ------
    UnsettledError : runs come to no periodic motion (`unilateral_or_followed_motion` then asks neighbours)
    NumericalError : no such motion is found
    """
    if pair.healthy is not pair:
        return settled_motion(pair, samples, supports, progress=progress)
    return motion_of_shooting(Shooting.of(pair, samples, supports), settles=settles, progress=progress)


def motion_of_shooting(
    shooting: Shooting, *, settles: bool = True, progress: Progress = unheard
) -> RevolutionMotion:
    """Periodic motion of like teeth by ``shooting`` from its linear motion, see ``unilateral_motion``.

    Raises
    ------
    NumericalError : no such motion is found
    """
    if isinstance(shooting.system.cycle, StaticCycle):
        close = shooting.close_by()
        if close is not None and (close.spectral_radius <= UNSTABLE or not settles):
            return close
        shooting = shooting.with_fitted_laws()
    radius_of_linear = 1.0
    progress(0.0, "linear motion")
    try:
        linear = periodic_solution(shooting.system, np.zeros(1), estimate_error=False)
    except NumericalError:  # a multiplier at +1
        start = shooting.at_rest()
    else:
        radius_of_linear = linear.spectral_radius
        start = shooting.unknowns(linear.states[0], linear.pinion_torque, linear.brake_torque)
        progress(0.1, "motion near the linear one")
        near, radius = shooting.near(start, linear)
        if near is not None:
            progress(0.25, "stability")
            motion = shooting.motion(near, radius)
            if motion.spectral_radius <= UNSTABLE or not settles:
                return motion
    if not settles:
        raise NumericalError("No periodic motion that follows the momentary load is near the linear one.")
    return shooting.settled(
        start, radius_of_linear, lambda share, stage="", /: progress(0.3 + 0.7 * share, stage)
    )


def settled_motion(
    pair: GearPair,
    samples: int,
    supports: Supports = "springs",
    steps: int | None = None,
    progress: Progress = unheard,
) -> RevolutionMotion:
    """Periodic motion of a pair whose teeth differ, with unilateral contact.

    A run starts from the motion of the twin with like teeth. When the start has faded, one period is
    recorded. A first run with longer steps gives the brake torque, on which only the common rotation depends.

    Parameters
    ----------
    pair : a validated gear pair
    samples : outputs a mesh cycle
    supports : as of ``periodic_system``
    steps : least number of steps in a mesh cycle; by default the number that the fastest vibration needs
    progress : called with the finished fraction and what is being done
    """
    progress(0.0, "twin with like teeth")
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
        progress(0.1 if part > 1 else 0.3, "run with long steps" if part > 1 else "run")
        tables = momentary_tables(laws, system, part / steps, samples)
        torques = driving * system.torque_pinion + brake * system.torque_gear
        count = settling + tables.period
        runs = MomentaryRuns(pair, system, tables)
        start = state.copy()
        last_run = runs.run(-settling, count, tables.period, start, torques)
        states = last_run.states
        end = last_run.end
        if not np.isfinite(end).all():
            raise NumericalError("The motion grows without bound: take smaller deviations or more damping.")
        duration = tables.period * system.period
        drift = float(weights @ (end - states[0])[m:]) / duration
        if part > 1 and isinstance(twin, RevolutionMotion):
            # The torques of the twin balance with short steps. With long steps the twin drifts: only the
            # drift in addition belongs to the teeth that differ.
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
    powers = mean_powers(last_run, duration)
    # Sliding at nominal speed: without what a rate of the common rotation that is left adds.
    rates = system.gears[:2] @ (end - states[0])[:m] / duration
    powers["sliding"] -= float(driving * rates[0] - brake * rates[1])
    states = without_drift(system, time, states, end, duration)
    error /= float(np.abs(coarse).max())
    resolved: dict[str, float] = {}
    if not resolves(system, samples):
        outputs = _resolving_outputs(system, samples)
        finer = MomentaryRuns(pair, system, momentary_tables(laws, system, 1.0 / steps, outputs))
        again = finer.run(-settling, count, tables.period, start, torques)
        fine_time = np.arange(len(again.states)) / outputs * system.period
        settled = without_drift(system, fine_time, again.states, again.end, duration)
        resolved = _swings_of_states(system, settled, tables.period)
    return RevolutionMotion(
        *(pair, system, tables, touch, time, states, last_run.loads, driving, brake, powers, closed, error),
        twin.spectral_radius,
        Origin.SETTLED,
        resolved_peak_to_peak=resolved,
    )


def _resolving_outputs(system: LTVSystem, samples: int) -> int:
    """Outputs in a mesh cycle, a multiple of ``samples``, that resolve the fastest vibration."""
    angle = fastest_frequency(system) * system.period
    return samples * math.ceil(angle / (_OUTPUT_ANGLE * samples))


def _swings_of_states(system: LTVSystem, states: FloatArray, cycles: int) -> dict[str, float]:
    """Peak to peak of each variable of ``SWINGING`` of states (k, 2m) at equal steps over mesh cycles [m]."""
    z, rates = system.gear_motion(states)
    values = {"dte": z @ system.structure.deflection, "dte_dot": rates @ system.structure.deflection}
    for number, name in enumerate(COORDINATES):
        values |= {name: z[:, number], f"{name}_dot": rates[:, number]}
    time = np.arange(len(states)) / len(states) * cycles * system.period
    return swings_of_period(system, time, values, cycles)


def _drift_of_twin(twin: RevolutionMotion, step: float) -> float:
    """Weighted acceleration of the common rotation that like teeth get from long steps alone."""
    system = twin.system
    weights = twin.system.supports.common_weights
    tables = momentary_tables(ToothLaws(twin.pair), system, step, int(twin.tables.outputs.sum()))
    torques = twin.pinion_torque * system.torque_pinion + twin.brake_torque * system.torque_gear
    settling = _settling(twin.spectral_radius)
    runs = MomentaryRuns(twin.pair, system, tables)
    cycle = runs.run(-settling, settling + 1, 1, twin.states[0], torques)
    return float(weights @ (cycle.end - cycle.states[0])[weights.size :]) / system.period


def _settling(radius: float) -> int:
    """Mesh cycles until a start has faded, with the spectral radius of the motion."""
    if radius >= 1.0:
        raise NumericalError(
            f"The motion of the healthy twin is not stable (multiplier {radius:.6f}), so none settles: raise "
            "the damping or leave the speed."
        )
    cycles = math.ceil(math.log(_START_FADED) / math.log(radius)) + 2
    if cycles > _MOST_SETTLING:
        raise NumericalError(f"A start fades in {cycles} mesh cycles, too slowly: raise mesh.damping_ratio.")
    return cycles
