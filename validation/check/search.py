"""The search for explanations: trials of changed models, free parameters by Gauss-Newton, a beam of paths.

A path is a set of steps, each a cause with its value. All free parameters of a path are fitted together. A
trial that costs a motion is tried only once.

- Screening: a fixed value is one motion. A free parameter is some motions on a coarse grid; between them the
  residuals are taken as straight lines. The part of the residuals that the free parameters of the earlier
  steps can take up is left out.
- Refinement: the best of both kinds are fitted with all free parameters of their path.

Sources: docs/how_to/check_your_model.md, "Explanations".
"""

from __future__ import annotations

import itertools
import math
import time
import warnings
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize_scalar

from lumped.errors import SpurcheckError, typed_errors
from lumped.model.revolution_motion import Origin
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from validation.check.curve_orders import BIN, ChannelOrders
from validation.check.explanations.cause import Cause, Kind, Variant
from validation.check.explanations.design_inputs import has_relief
from validation.check.explanations.misreadings import causes_of_channels
from validation.check.explanations.physics import SAMPLES, Physics, motion_of
from validation.check.explanations.reading import Reading, read, steps_of
from validation.check.explanations.registry import EXPLANATIONS
from validation.check.mesh_frequency import SAME
from validation.check.misfit import Misfit, residual_of
from validation.check.motion_curves import MotionCurves
from validation.check.problem import Problem
from validation.check.steps import Step
from validation.check.two_steps import Effect, promising_pairs

#: A change of the equations that takes something else away counts as this much worse, for each such thing.
_SIDE_EFFECT = 1.25
#: Misfits below this share of the limit count as alike.
_ALIKE = 0.1
#: Step of the derivatives by a free parameter, on the scale of the search.
_DIFFERENCE = 0.01
#: Most Gauss-Newton steps, and the share of the misfit that a step must gain.
_STEPS = 6
_GAIN = 0.02
#: Candidates of each kind that are fitted with all free parameters of their path.
_REFINED = 6
#: A screened candidate must promise to lower the misfit to this share.
_PROMISES = 0.97
#: Causes of another mesh frequency. One of them is the first step where the frequency is another one.
OF_FREQUENCY = ("time axis", "speed of the curves")
#: A cause that may be one of another mesh frequency.
_MAY_BE_OF_FREQUENCY = "driving gear"
#: Steps that are tried behind a step that changes our motion: those that promise most by their effect alone.
_PROMISING = 30
#: Pairs of steps that are tried at once: those that promise most by the effects of both alone.
_PAIRS = 24
#: Intervals of the grid of a free parameter that are tried.
_INTERVALS = 2
#: Free parameters that are searched by Brent's method where Gauss-Newton steps leave a misfit above this,
#: and trials of each search.
_SEARCHED = 4
_STALLED = 0.02
_TRIALS = 14
#: A change from cycle to cycle above this share of the motion is no noise but a motion that fades.
_NOT_SETTLED = 0.01
#: Change of the misfit by fewer samples of our motion up to which the trials have these samples.
_THINNED = 0.02
#: Readings behind which every other cause is tried: those that leave the smallest misfit.
_HIDING_READINGS = 6
#: Readings that can hide every other cause.
HIDING = ("sign of a channel", "channels swapped", "time reversed")


class Trial(NamedTuple):
    """A changed model beside the curves.

    Attributes
    ----------
    motion : its motion
    misfit : its misfit
    residual : real numbers whose root sum square is the value of the misfit
    side_effects : number of things that changes of the equations took away beside: loaded contact, relief
    """

    motion: MotionCurves
    misfit: Misfit
    residual: FloatArray
    side_effects: int = 0

    @property
    def value(self) -> float:
        """The misfit."""
        return float(np.linalg.norm(self.residual))


@dataclass(frozen=True, eq=False)
class Path:
    """Steps from our model, with the trial of all of them together."""

    steps: tuple[Step, ...]
    trial: Trial

    @property
    def keys(self) -> frozenset[tuple[str, str]]:
        """Keys of the steps."""
        return frozenset(step.key for step in self.steps)

    @property
    def free(self) -> int:
        """Number of free parameters."""
        return sum(step.choice is None for step in self.steps)

    @property
    def vague(self) -> bool:
        """Whether many a cause has about the effect of the last step."""
        return bool(self.steps) and self.steps[-1].choice is not None and self.steps[-1].choice.vague

    def score(self, floor: float, limit: float = 0.0) -> float:
        """Return the misfit with the price of free parameters, of side effects and of mere descriptions.

        Misfits below ``floor``, and below a tenth of the limit, count as alike.
        """
        alike = np.hypot(floor, _ALIKE * limit)
        price = _SIDE_EFFECT**self.trial.side_effects * math.prod(step.price for step in self.steps)
        return float(np.hypot(self.trial.value, alike)) * price


#: Motions of changed models; None: the model has no motion.
Motions = dict[tuple[GearPair, Physics], MotionCurves | None]


class BudgetSpentError(Exception):
    """The processor time of the search is spent."""


@dataclass(eq=False)
class Search:
    """Trials of changed models within a budget.

    Attributes
    ----------
    problem : the curves and our motion
    budget : processor time [s]
    causes : causes that are tried; None: all of the registry, and the delay of each channel
    motions : motions of changed models; searches of several curves of one pair can share them
    most_motions : number of motions at which the search ends; None: the budget alone ends it
    runs : number of motions that were computed
    archive : keys of the steps -> best path with these steps
    """

    problem: Problem
    budget: float
    causes: tuple[Cause, ...] | None = None
    motions: Motions = field(default_factory=dict)
    most_motions: int | None = None
    runs: int = 0
    archive: dict[frozenset[tuple[str, str]], Path] = field(default_factory=dict)
    _trials: dict[tuple[tuple[str, str, float], ...], Trial | None] = field(default_factory=dict)
    _readings: dict[Reading, tuple[ChannelOrders, ...] | None] = field(default_factory=dict)
    _expanded: dict[frozenset[tuple[str, str]], list[Path]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Set the end of the budget, and the motion that is known."""
        if self.causes is None:
            self.causes = (*EXPLANATIONS.values(), *causes_of_channels(self.problem))
        self._tried_causes = self.causes
        self._start = time.process_time()
        self.run_until(1.0)
        self._samples, thin = self._least_samples()
        # With the samples of the trials, so that another reading of the curves has no advantage.
        self._know(thin)

    def _least_samples(self) -> tuple[int, MotionCurves]:
        """Samples in a mesh cycle of the trials, and our motion with these samples.

        The force of a damper jumps where teeth meet: at low speed its orders need more samples than others.
        """
        residual = residual_of(self.problem.misfit)
        for samples in (SAMPLES, 2 * SAMPLES):
            thin = self.problem.motion.thinned(samples)
            change = residual_of(self.problem.misfit_with(thin)) - residual
            if np.linalg.norm(change) < _THINNED:
                return samples, thin
        return 4 * SAMPLES, self.problem.motion

    def _know(self, motion: MotionCurves) -> None:
        """Take a motion as that of the model without changes."""
        start = Variant(self.problem.pair)
        self.motions[start.pair, start.physics] = motion

    def start(self) -> Path:
        """Return the path without steps."""
        trial = self.trial(())
        assert trial is not None  # its motion is that of the problem
        return Path((), trial)

    def trial(self, steps: Sequence[Step]) -> Trial | None:
        """Return the trial of steps; None: the changed model has no motion, or the pair refuses a change.

        Raises
        ------
        BudgetSpentError : the trial is new, and the budget is spent
        """
        key = tuple((*step.key, step.coordinate) for step in steps)
        if key not in self._trials:
            self._trials[key] = self._tried(steps)
        return self._trials[key]

    def _tried(self, steps: Sequence[Step]) -> Trial | None:
        """The trial of steps that were not tried before."""
        if steps and self.spent:
            raise BudgetSpentError
        try:
            variant = Variant(self.problem.pair)
            side_effects = 0
            for step in steps:
                if step.choice is None and not step.cause.applies(self.problem, variant):
                    return None  # a step before it was left out, or another one
                before, variant = variant, step.of(variant)
                side_effects += _side_effects(step.cause, before, variant)
        except SpurcheckError:
            return None
        motion = self._motion(variant.pair, variant.physics)
        if motion is None:
            return None
        for problem in self._problems_of(motion):
            reading = variant.reading
            theirs = self._theirs(reading) if problem is self.problem else _read(problem, reading)
            if theirs is None:
                continue
            try:
                misfit = problem.misfit_with(
                    motion,
                    theirs,
                    free_shift=reading.free_shift,
                    near_coarse=not reading.places,
                    steps=steps_of(problem, reading),
                )
            except SpurcheckError:
                continue
            residual = residual_of(misfit)
            if residual.size == self._size and np.isfinite(residual).all():
                return Trial(motion, misfit, residual, side_effects)
        return None

    def _motion(self, pair: GearPair, physics: Physics) -> MotionCurves | None:
        """Motion of a variant, computed once."""
        key = pair, physics
        if key not in self.motions:
            self.runs += 1
            try:
                with warnings.catch_warnings(), typed_errors():
                    warnings.simplefilter("ignore")
                    again = self.problem.curves.recurrence
                    self.motions[key] = motion_of(
                        pair, physics, again, settles=self._settles, samples=self._samples
                    )
            except SpurcheckError:
                self.motions[key] = None
        return self.motions[key]

    def _problems_of(self, motion: MotionCurves) -> Iterator[Problem]:
        """The problems by which a motion is judged, the best first.

        Channels of tooth pairs begin where contact of the motion begins, if their orders are as many then.
        """
        if self.problem.coarse_shift is not None and self._begins_elsewhere(motion):
            yield replace(self.problem, motion=motion)
        yield self.problem

    def _begins_elsewhere(self, motion: MotionCurves) -> bool:
        """Whether contact of a motion begins at another place than ours."""
        own = self.problem.motion
        same_path = motion.pair.geometry.L_XA == own.pair.geometry.L_XA
        return not same_path or abs(motion.life[0] - own.life[0]) > BIN

    @cached_property
    def _size(self) -> int:
        """Size of a residual."""
        return int(residual_of(self.problem.misfit).size)

    def _theirs(self, reading: Reading) -> tuple[ChannelOrders, ...] | None:
        """Their channels in a reading, computed once."""
        if reading not in self._readings:
            self._readings[reading] = _read(self.problem, reading)
        return self._readings[reading]

    def floor(self, limit: float) -> float:
        """Return the misfit below which a difference says nothing.

        This is the error of our motion, with that of the samples of the trials, the noise of the curves and a
        fiftieth of the limit.
        """
        error = self.problem.motion.plain.attributes.get("error_estimate", 0.0)
        thinned = self.start().trial.residual - residual_of(self.problem.misfit)
        squares = noise_of(self.problem) ** 2 + error**2 + float(thinned @ thinned)
        return float(np.sqrt(squares + (limit / 50.0) ** 2))

    def expand(self, path: Path) -> list[Path]:
        """Return the paths with one step more, each fitted; the misfit is smallest first.

        Where the budget ends the paths that were fitted are returned; ``spent`` then says so.
        """
        if path.keys not in self._expanded:
            self._expanded[path.keys] = []
            self._expanded[path.keys] = self._with_one_step_more(path)
        return self._expanded[path.keys]

    @property
    def _settles(self) -> bool:
        """Whether motions are looked for by runs that settle: only where that of the pair was found so."""
        return bool(self.problem.motion.plain.attributes.get("origin") == Origin.SETTLED.value)

    @property
    def spent(self) -> bool:
        """Whether the budget is spent."""
        enough = self.most_motions is not None and self.runs >= self.most_motions
        return enough or time.process_time() > self._end

    def run_until(self, share: float) -> None:
        """Set the end of the search to a share of the budget."""
        self._end = self._start + share * self.budget

    def conclude(self) -> None:
        """Let the few trials that tell a path have a motion each, although the budget is spent."""
        self._end = math.inf
        self.most_motions = None
        self._know(self.problem.motion)
        self._trials.clear()

    def _with_one_step_more(self, path: Path) -> list[Path]:
        screened = self._screened(path)
        promising = [one for rest, one in screened if rest < _PROMISES * path.trial.value]
        fixed = [one for one in promising if one.steps[-1].choice is not None]
        free = [one for one in promising if one.steps[-1].choice is None]
        result = [self.fitted(one) for one in (*fixed[:_REFINED], *free[:_REFINED])]
        result += fixed[_REFINED:]
        result.sort(key=lambda one: one.trial.value)
        if result and result[0].trial.value > _STALLED:
            stalled = [one for one in result if one.steps[-1].choice is None][:_SEARCHED]
            result += [self.fitted(self._searched(one)) for one in stalled]
        return self._archived([one for one in result if one.steps[-1].changes])

    def with_reading(self, path: Path) -> list[Path]:
        """Return paths with two steps more: another reading, and any other cause.

        A wrong sign, or two channels that are swapped, can hide every other cause. The motions are those of
        ``expand``, so that a reading costs little.
        """
        screened: list[tuple[float, Path]] = []
        try:
            readings = []
            for step in list(self._fixed_steps(path)):
                if step.cause.name in HIDING:
                    trial = self.trial((*path.steps, step))
                    if trial is not None:
                        readings.append(Path((*path.steps, step), trial))
            readings.sort(key=lambda one: one.trial.value)
            for one in readings[:_HIDING_READINGS]:
                screened += self._screened(one)
        except BudgetSpentError:
            pass
        screened.sort(key=lambda one: one[0])
        return self._archived([self.fitted(one) for _, one in screened[:_REFINED]])

    def with_two_steps(self, path: Path) -> list[Path]:
        """Return paths with two steps more, those that promise most by the effects of both steps alone.

        Two mistakes can hide each other: none of both then lowers the misfit by much alone.
        """
        found = []
        with suppress(BudgetSpentError):
            for one, other in promising_pairs(path.trial.residual, self._effects(path), _PAIRS):
                again = self._behind((*path.steps, one), other)
                trial = None if again is None else self.trial((*path.steps, one, again))
                if again is not None and trial is not None:
                    found.append(Path((*path.steps, one, again), trial))
        found.sort(key=lambda one: one.score(0.0))
        fitted = [self.fitted(one) for one in found[:_REFINED]]
        return self._archived([one for one in fitted if all(step.changes for step in one.steps)])

    def _behind(self, steps: Sequence[Step], step: Step) -> Step | None:
        """A step that was chosen alone, behind other steps; None: it does not apply there."""
        try:
            variant = Variant(self.problem.pair)
            for one in steps:
                variant = one.of(variant)
            if step.choice is None:
                return step if step.cause.applies(self.problem, variant) else None
            choices = step.cause.choices(self.problem, variant)
        except SpurcheckError:
            return None
        return next((Step(step.cause, one) for one in choices if one.label == step.choice.label), None)

    def _effects(self, path: Path) -> list[Effect]:
        """What each step that was tried behind a path does to the residual, without those that do nothing."""
        effects = []
        nothing = np.zeros_like(path.trial.residual)
        for step in self._fixed_steps(path):
            trial = self.trial((*path.steps, step))
            if trial is not None and step.choice is not None and not step.choice.vague:
                effects.append(Effect(step, trial.residual - path.trial.residual, nothing))
        for cause in self._free_causes(path):
            places = [(0.0, nothing)]
            for value in cause.grid:
                trial = self.trial((*path.steps, Step(cause, None, cause.coordinate(value))))
                if trial is not None:
                    places.append((cause.coordinate(value), trial.residual - path.trial.residual))
            places.sort(key=lambda place: place[0])
            for (x0, one), (x1, other) in itertools.pairwise(places):
                effects.append(Effect(Step(cause, None, x0), one, other - one, x1 - x0))
        return [one for one in effects if one.start.any() or one.along.any()]

    def _screened(self, path: Path) -> list[tuple[float, Path]]:
        """Paths with one step more, not fitted, and the misfit that each promises; the smallest first."""
        screened: list[tuple[float, Path]] = []
        try:
            taken_up = self._taken_up(path)
            candidates = self._promising(path, taken_up)
            for step in self._fixed_steps(path):
                if candidates is not None and step.key not in candidates:
                    continue
                trial = self.trial((*path.steps, step))
                if trial is not None:
                    rest = _without(trial.residual, taken_up)
                    screened.append((rest, Path((*path.steps, step), trial)))
            screened += self._screened_free(path, taken_up, candidates)
        except BudgetSpentError:
            pass
        return sorted(screened, key=lambda one: one[0])

    def _promising(self, path: Path, taken_up: FloatArray) -> set[tuple[str, str]] | None:
        """Keys of the steps that promise most behind a path, by what each does without the path.

        None: the path only reads the curves in another way, so that every step is tried.
        """
        base = tuple(
            step for step in path.steps if step.cause.kind is Kind.READING or self.of_frequency(step.cause)
        )
        if len(base) == len(path.steps):
            return None
        before = self.trial(base)
        if before is None:
            return None
        guesses: dict[tuple[str, str], float] = {}
        for step in itertools.chain(self._fixed_steps(path), self._grid_steps(path)):
            after = self.trial((*base, step))
            if after is None:
                continue
            moved = path.trial.residual + after.residual - before.residual
            guess = _between(path.trial.residual, moved, taken_up)[1]
            if step.choice is not None:
                guess = _without(moved, taken_up)
                if np.array_equal(after.residual, before.residual):
                    guess = -np.inf  # such as dampers that stay: they act behind another step alone
            guesses[step.key] = min(guess, guesses.get(step.key, np.inf))
        return set(sorted(guesses, key=lambda key: guesses[key])[:_PROMISING])

    def _grid_steps(self, path: Path) -> Iterator[Step]:
        """All places of the grids of free parameters that the path does not have."""
        for cause in self._free_causes(path):
            for value in cause.grid:
                yield Step(cause, None, cause.coordinate(value))

    def _free_causes(self, path: Path) -> Iterator[Cause]:
        """Causes with a free parameter that the path does not have, where the pair allows them."""
        variant = Variant(self.problem.pair)
        for step in path.steps:
            variant = step.of(variant)
        for cause in self._tried_causes:
            if cause.free and Step(cause, None).key not in path.keys and cause.applies(self.problem, variant):
                yield cause

    def _archived(self, paths: list[Path]) -> list[Path]:
        """The paths, the smallest misfit first, after they are put into the archive."""
        for one in paths:
            self._keep(one)
        return sorted(paths, key=lambda one: one.trial.value)

    def _keep(self, path: Path) -> None:
        before = self.archive.get(path.keys)
        if before is None or path.trial.value < before.trial.value:
            self.archive[path.keys] = path

    def _fixed_steps(self, path: Path) -> Iterator[Step]:
        """All fixed values that the path does not have; a cause of the pair has one value only."""
        variant = Variant(self.problem.pair)
        for step in path.steps:
            variant = step.of(variant)
        names = {step.cause.name for step in path.steps if step.cause.kind is not Kind.READING}
        for cause in self._tried_causes:
            if cause.free or cause.name in names or self._of_start(cause):
                continue
            try:
                choices = cause.choices(self.problem, variant)
            except SpurcheckError:
                continue
            for choice in choices:
                step = Step(cause, choice)
                if step.key not in path.keys:
                    yield step

    @property
    def other_frequency(self) -> bool:
        """Whether the curves have another mesh frequency than the pair."""
        return abs(self.problem.frequency.factor - 1.0) > SAME

    def of_frequency(self, cause: Cause) -> bool:
        """Whether a cause is one of another mesh frequency that the curves show."""
        return cause.name in OF_FREQUENCY or (cause.name == _MAY_BE_OF_FREQUENCY and self.other_frequency)

    def _of_start(self, cause: Cause) -> bool:
        """Whether a cause is tried only at the start: another mesh frequency that the curves show."""
        return self.of_frequency(cause) and self.problem.curves.abscissa == "time"

    def _screened_free(
        self, path: Path, taken_up: FloatArray, candidates: set[tuple[str, str]] | None
    ) -> Iterator[tuple[float, Path]]:
        """Best place of each free parameter between the trials of its grid, by straight residuals."""
        for cause in self._free_causes(path):
            step = Step(cause, None)
            if candidates is not None and step.key not in candidates:
                continue
            places = [(0.0, path.trial)]
            for value in cause.grid:
                coordinate = cause.coordinate(value)
                trial = self.trial((*path.steps, step._replace(coordinate=coordinate)))
                if trial is not None:
                    places.append((coordinate, trial))
            places.sort(key=lambda place: place[0])
            promised = []
            for (x0, one), (x1, other) in itertools.pairwise(places):
                share, rest = _between(one.residual, other.residual, taken_up)
                promised.append((rest, x0 + share * (x1 - x0)))
            for rest, coordinate in sorted(promised)[:_INTERVALS]:
                steps = (*path.steps, step._replace(coordinate=coordinate))
                trial = self.trial(steps)
                if trial is not None:
                    # Straight residuals promise too much where the motion is not straight between trials.
                    yield float(np.sqrt(rest * trial.value)), Path(steps, trial)

    def _taken_up(self, path: Path) -> FloatArray:
        """Orthonormal directions (n, p) of the residual that the free parameters of a path can change."""
        slopes = self._slopes(path)
        if not slopes.size:
            return np.zeros((path.trial.residual.size, 0))
        return np.asarray(np.linalg.qr(slopes)[0], dtype=np.float64)

    def _slopes(self, path: Path) -> FloatArray:
        """Derivatives (n, p) of the residual by the free parameters."""
        columns = []
        for number, step in enumerate(path.steps):
            if step.choice is None:
                moved = step._replace(coordinate=step.coordinate + _DIFFERENCE)
                trial = self.trial((*path.steps[:number], moved, *path.steps[number + 1 :]))
                if trial is None:
                    columns.append(np.zeros(path.trial.residual.size))
                else:
                    columns.append((trial.residual - path.trial.residual) / _DIFFERENCE)
        return np.stack(columns, axis=1) if columns else np.zeros((path.trial.residual.size, 0))

    def fitted(self, path: Path) -> Path:
        """Return a path with all free parameters fitted by Gauss-Newton steps, as far as the budget goes."""
        try:
            for _ in range(_STEPS if path.free else 0):
                better = self._gauss_newton(path)
                if better is None:
                    break
                gain = 1.0 - better.trial.value / path.trial.value
                path = better
                if gain < _GAIN:
                    break
        except BudgetSpentError:
            pass
        return path

    def searched_free(self, path: Path) -> Path:
        """Return a path with each free parameter searched by Brent's method, one after the other, and fitted.

        Gauss-Newton steps stall where the motion has jumps that move with a parameter.
        """
        for step in path.steps:
            if step.choice is None:
                turned = tuple(one for one in path.steps if one.key != step.key)
                here = next(one for one in path.steps if one.key == step.key)
                path = self.fitted(self._searched(Path((*turned, here), path.trial)))
        self._keep(path)
        return path

    def _searched(self, path: Path) -> Path:
        """The path with the free parameter of its last step by Brent's method, within a step of the grid."""
        *before, step = path.steps
        places = np.sort([0.0, *(step.cause.coordinate(value) for value in step.cause.grid)])
        reach = float(np.diff(places).min())
        best = path

        def value(coordinate: float) -> float:
            nonlocal best
            steps = (*before, step._replace(coordinate=float(coordinate)))
            trial = self.trial(steps)
            if trial is None:
                return 10.0 * path.trial.value
            if trial.value < best.trial.value:
                best = Path(steps, trial)
            return trial.value

        bounds = step.coordinate - reach, step.coordinate + reach
        with suppress(BudgetSpentError):
            minimize_scalar(value, bounds=bounds, method="bounded", options={"maxiter": _TRIALS})
        return best

    def _gauss_newton(self, path: Path) -> Path | None:
        """One Gauss-Newton step, shortened where it does not lower the misfit; None: no lower misfit."""
        slopes = self._slopes(path)
        solution = np.linalg.lstsq(slopes, path.trial.residual, rcond=1e-6)[0]
        change = np.asarray(-solution, dtype=np.float64)
        for share in (1.0, 0.4, 0.1):
            steps = _moved(path.steps, share * change)
            trial = self.trial(steps)
            if trial is not None and trial.value < path.trial.value:
                return Path(steps, trial)
        return None


def _side_effects(cause: Cause, before: Variant, after: Variant) -> int:
    """Number of things that a change of the equations takes away beside: loaded contact, relief that acts."""
    if cause.kind is not Kind.PHYSICS:
        return 0
    one, other = before.pair, after.pair
    relief = one.mesh.relief != other.mesh.relief and has_relief(one)
    return int(one.mesh.contact != other.mesh.contact) + int(relief)


def _moved(steps: Sequence[Step], change: FloatArray) -> tuple[Step, ...]:
    """Steps with changed free parameters, within the reach of each cause."""
    changes = iter(change)
    moved = []
    for step in steps:
        if step.choice is None:
            low, high = step.cause.reach
            coordinate = float(np.clip(step.coordinate + next(changes), low, high))
            step = step._replace(coordinate=coordinate)
        moved.append(step)
    return tuple(moved)


def _read(problem: Problem, reading: Reading) -> tuple[ChannelOrders, ...] | None:
    """Their channels in a reading; None: they cannot be read so."""
    try:
        return read(problem, reading)
    except SpurcheckError:
        return None


def noise_of(problem: Problem) -> float:
    """Return the misfit that the noise of the curves makes."""
    squares = [(row.channel.noise / row.scale) ** 2 for row in problem.misfit.channels]
    return float(np.sqrt(np.mean(squares)))


def _without(residual: FloatArray, taken_up: FloatArray) -> float:
    """Size of a residual without the directions that are taken up."""
    return float(np.linalg.norm(residual - taken_up @ (taken_up.T @ residual)))


def _between(one: FloatArray, other: FloatArray, taken_up: FloatArray) -> tuple[float, float]:
    """Share of the way from one residual to another with the smallest size, and this size."""
    start = one - taken_up @ (taken_up.T @ one)
    change = other - taken_up @ (taken_up.T @ other) - start
    square = float(change @ change)
    share = float(np.clip(-(start @ change) / square, 0.0, 1.0)) if square > 0.0 else 0.0
    return share, float(np.linalg.norm(start + share * change))


def without_step(path: Path, number: int) -> tuple[Step, ...]:
    """Return the steps of a path without one of them."""
    return (*path.steps[:number], *path.steps[number + 1 :])


__all__ = ["BudgetSpentError", "Motions", "Path", "Search", "Step", "Trial", "without_step"]
