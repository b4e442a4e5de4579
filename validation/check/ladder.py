"""The ladder of explanations: which named changes of our model bring it to the curves of another model.

Sources: docs/how_to/check_your_model.md, "Explanations".
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from validation.check.explanations.cause import Cause, Kind, Variant
from validation.check.explanations.registry import EXPLANATIONS
from validation.check.motion_curves import MotionCurves
from validation.check.problem import Problem
from validation.check.search import BudgetSpentError, Motions, Path, Search, Step, without_step

#: Paths that are followed at the same time, and most steps of a path.
_BEAM = 3
_MOST_STEPS = 4
#: Share of the budget in which paths grow. In the rest steps are exchanged and left out.
_OF_BEAM = 0.75
#: Share of the limit at which the search stops.
_ENOUGH = 0.2
#: Shares of the misfit by which a step must lower it: the first step; a later step that does not reach the
#: limit; below the limit, by a fixed value, and by a free parameter.
_LEAST_GAIN = 0.1
_GAIN_OF_LATER = 0.3
_GAIN_OF_FIXED = 0.5
_GAIN_OF_FREE = 0.75
#: A start from another mesh frequency is followed up to this many times the best misfit.
_FAR = 3.0
#: A path of the beam is followed up to this many times the score of the best one.
_NEAR_BEST = 1.6
#: Two steps at once that leave less than this share of the best single step need no other second step.
_MUCH = 0.25
#: A single step that leaves more than this share of the misfit says little.
_LITTLE = 0.5
#: Two motions are the same where they differ by this share of the misfit.
_SAME_MOTION = 0.05
#: Rounds in which steps are exchanged, and the share of the score that an exchange must reach.
_EXCHANGES = 1
_BETTER = 0.9
#: The cause that is told with the change of stiffness, mass or inertia that the dampers do not follow.
_DAMPERS_STAY = "dampers stay"
#: Alternatives are named up to this many times the misfit.
_WITHIN = 2.0
#: Single explanations that are named whatever they leave.
_ALONE = 3


@dataclass(frozen=True)
class Alternative:
    """An explanation that does about as well as the chosen one: the curves do not tell them apart.

    Attributes
    ----------
    name : name in the registry
    factor : value of the change: a factor, an angle, or the name of a choice
    misfit : misfit after this change in place of the chosen one [1]
    sentence : the explanation in words
    """

    name: str
    factor: float | str
    misfit: float
    sentence: str


@dataclass(frozen=True)
class Explanation:
    """One step of the ladder: a change that is compatible with the curves.

    Attributes
    ----------
    name : name in the registry
    factor : value of the change: a factor, an angle, or the name of a choice
    misfit : misfit after this step [1]
    sentence : the explanation in words: "compatible with ...", never "is"
    alternatives : explanations within a factor 2 of the misfit of this step, best first
    """

    name: str
    factor: float | str
    misfit: float
    sentence: str
    alternatives: tuple[Alternative, ...] = ()


@dataclass(frozen=True, eq=False)
class Ladder:
    """Steps from our model to the curves of the other model.

    Attributes
    ----------
    start : misfit before the first step
    steps : steps, in the order in which they were taken
    motion : our motion after the last step
    alone : the three best single explanations, each in place of all steps, best first
    runs : number of motions that were computed
    complete : whether the search ended by itself, not by its budget
    """

    start: float
    steps: tuple[Explanation, ...]
    motion: MotionCurves
    runs: int
    complete: bool
    alone: tuple[Alternative, ...] = ()

    @property
    def others_alone(self) -> tuple[Alternative, ...]:
        """The single explanations of ``alone`` that neither a step nor an alternative says."""
        said = {step.sentence for step in self.steps}
        said |= {other.sentence for step in self.steps for other in step.alternatives}
        return tuple(one for one in self.alone if one.sentence not in said)


def climb(
    problem: Problem,
    *,
    limit: float,
    budget: float,
    motions: Motions | None = None,
    most_motions: int | None = None,
    causes: Sequence[Cause] | None = None,
) -> Ladder:
    """Search the explanations of a misfit, with a beam of three paths.

    A step is accepted where it lowers the misfit by more than 10 % and by more than the error of the
    comparison. Below the limit a step must explain more: half of what is left by a fixed value, three
    quarters by a free parameter. The search stops at a fifth of the limit.

    Parameters
    ----------
    problem : the curves and our motion
    limit : misfit below which the curves agree
    budget : processor time of the search [s]
    motions : motions of changed models, which searches of several curves of one pair share; they are added to
    most_motions : number of motions at which the search ends; None: the budget alone ends it
    causes : causes that are tried; None: all of the registry, and the delay of each channel
    """
    search = Search(
        problem,
        budget,
        causes=None if causes is None else tuple(causes),
        motions={} if motions is None else motions,
        most_motions=most_motions,
    )
    floor = search.floor(limit)
    search.run_until(_OF_BEAM)
    best = _best_path(search, limit, floor)
    complete = not search.spent
    search.run_until(1.0)
    best = _exchanged(search, best, limit, floor)
    best = _pruned(search, best, limit, floor)
    complete = complete and not search.spent
    if problem.misfit.value <= limit and all(step.slight for step in best.steps):
        best = search.start()  # the place of a jump between two samples, no mistake
    search.conclude()
    if all(step.cause.kind is Kind.READING for step in best.steps):
        finest = search.trial(best.steps)  # of our motion with all its samples
        best = best if finest is None else Path(best.steps, finest)
    steps = tuple(_explanations(search, best, floor))
    alone = tuple(_alone(search, best, limit, floor)) if steps else ()
    return Ladder(problem.misfit.value, steps, best.trial.motion, search.runs, complete=complete, alone=alone)


def _best_path(search: Search, limit: float, floor: float) -> Path:
    """Path at which the beam ends."""
    beam = _starts(search, floor)
    best = beam[0]
    start = best
    enough = max(limit * _ENOUGH, floor)
    while best.trial.value > enough and len(best.steps) < _MOST_STEPS and not search.spent:
        candidates: list[Path] = []
        if len(best.steps) == len(start.steps) + 1:
            candidates += [one for one in search.with_two_steps(start) if _accepted(one, best, limit, floor)]
            if candidates and candidates[0].trial.value < max(_MUCH * best.trial.value, enough):
                beam = _distinct(candidates, floor, limit)
                best = beam[0]
                continue
        near = [path for path in beam if path.score(floor, limit) < _NEAR_BEST * beam[0].score(floor, limit)]
        for path in near:
            candidates += [one for one in search.expand(path) if _accepted(one, path, limit, floor)]
            if candidates and min(one.trial.value for one in candidates) <= enough:
                break
        beam = _distinct(candidates, floor, limit)
        if not beam or not _accepted(beam[0], best, limit, floor):
            little = best.trial.value > _LITTLE * search.problem.misfit.value
            if best.trial.value <= limit or len(best.steps) > 1 or not little:
                break
            # No single step says enough: a wrong sign may hide every other cause.
            joint = [one for one in search.with_reading(best) if _accepted(one, best, limit, floor)]
            if not best.steps:
                joint += [one for one in search.with_two_steps(best) if _accepted(one, best, limit, floor)]
            beam = _distinct([*beam, *joint], floor, limit)
            if not beam:
                break
        best = beam[0]
    return best


def _starts(search: Search, floor: float) -> list[Path]:
    """Paths from which the beam starts: our model, or the readings of another mesh frequency."""
    problem = search.problem
    start = search.start()
    variant = Variant(problem.pair)
    paths = []
    if search.other_frequency:
        for cause in EXPLANATIONS.values():
            if not search.of_frequency(cause):
                continue
            for choice in cause.choices(problem, variant):
                step = Step(cause, choice)
                with suppress(BudgetSpentError):
                    trial = search.trial((step,))
                    if trial is not None:
                        paths.append(Path((step,), trial))
                        search.archive[paths[-1].keys] = paths[-1]
    paths.sort(key=lambda path: path.score(floor))
    return [path for path in paths if path.score(floor) < _FAR * paths[0].score(floor)] or [start]


def _accepted(path: Path, before: Path, limit: float, floor: float) -> bool:
    """Whether a path lowers the misfit of the path before by enough."""
    if path.vague and path.trial.value > limit:
        return False
    gain = before.trial.value - path.trial.value
    share = _LEAST_GAIN if len(before.steps) == 0 or path.trial.value <= limit else _GAIN_OF_LATER
    if before.trial.value <= limit:
        share = _GAIN_OF_FIXED if path.free <= before.free else _GAIN_OF_FREE
    return gain > max(share * before.trial.value, floor)


def _distinct(paths: list[Path], floor: float, limit: float) -> list[Path]:
    """The best paths of a beam with motions that differ."""
    beam: list[Path] = []
    for path in sorted(paths, key=lambda one: one.score(floor, limit)):
        near = max(_SAME_MOTION * path.trial.value, floor)
        if all(np.linalg.norm(path.trial.residual - one.trial.residual) > near for one in beam):
            beam.append(path)
        if len(beam) == _BEAM:
            break
    return beam


def _exchanged(search: Search, best: Path, limit: float, floor: float) -> Path:
    """The path with each step exchanged for a better one, where there is one."""
    for _ in range(_EXCHANGES):
        better = best
        for number in range(len(best.steps)):
            parent = _refitted(search, without_step(best, number))
            if parent is None or search.of_frequency(best.steps[number].cause):
                continue
            for path in search.expand(parent):
                if path.vague and path.trial.value > limit:
                    continue
                if path.score(floor, limit) < _BETTER * better.score(floor, limit):
                    better = path
        if better is best:
            break
        best = better
    return best


def _pruned(search: Search, best: Path, limit: float, floor: float) -> Path:
    """The path without steps that are not needed."""
    number = 0
    while number < len(best.steps) and len(best.steps) > 1:
        shorter = _refitted(search, without_step(best, number))
        if shorter is not None and shorter.trial.value > best.trial.value:
            shorter = search.searched_free(shorter)
        kept_by_frequency = search.of_frequency(best.steps[number].cause)
        if shorter is None or kept_by_frequency or _accepted(best, shorter, limit, floor):
            number += 1
        else:
            best = shorter
            number = 0
    return best


def _refitted(search: Search, steps: tuple[Step, ...]) -> Path | None:
    """The path of these steps with its free parameters fitted; None: no motion, or no budget."""
    known = search.archive.get(frozenset(step.key for step in steps))
    if known is not None:
        return known
    try:
        trial = search.trial(steps)
    except BudgetSpentError:
        return None
    return None if trial is None else search.fitted(Path(steps, trial))


def _explanations(search: Search, best: Path, floor: float) -> list[Explanation]:
    """Steps of a path, the step that lowers the misfit most first, with their alternatives."""
    listed: list[Explanation] = []
    causes: list[Cause] = []
    rest = list(best.steps)
    before: tuple[Step, ...] = ()
    while rest:
        values = [_misfit_of(search, (*before, step)) for step in rest]
        first = [search.of_frequency(step.cause) for step in rest]
        number = int(np.argmax(first)) if any(first) else int(np.argmin(values))
        step = rest.pop(number)
        before = (*before, step)
        misfit = values[number] if rest else best.trial.value
        changed = [place for place, cause in enumerate(causes) if cause.kind is Kind.INPUT]
        if step.cause.name == _DAMPERS_STAY and changed:
            one = listed[changed[-1]]
            listed[changed[-1]] = replace(
                one, misfit=misfit, sentence=f"{one.sentence}, with dampers [N s/m] that stay as they are"
            )
            continue
        if step.slight and listed:
            # So small a change is no mistake. That the misfit follows it shows a motion that is sensitive.
            words = f"{listed[-1].sentence}, near a motion that the slightest change alters"
            listed[-1] = replace(listed[-1], misfit=misfit, sentence=words)
            continue
        listed.append(
            Explanation(
                name=step.cause.name,
                factor=step.label,
                misfit=misfit,
                sentence=step.sentence,
                alternatives=tuple(_alternatives(search, best, step, floor)),
            )
        )
        causes.append(step.cause)
    return listed


def _misfit_of(search: Search, steps: tuple[Step, ...]) -> float:
    """Misfit of steps as they are; infinite where it cannot be computed."""
    try:
        trial = search.trial(steps)
    except BudgetSpentError:
        trial = None
    return np.inf if trial is None else trial.value


def _alternatives(search: Search, best: Path, step: Step, floor: float) -> Iterator[Alternative]:
    """Explanations in place of a step within a factor 2 of the misfit, one for each name, best first."""
    others = best.keys - {step.key}
    most = _WITHIN * max(best.trial.value, floor)
    names = set()
    for keys, path in sorted(search.archive.items(), key=lambda item: item[1].trial.value):
        if len(keys) != len(best.keys) or not others <= keys or step.key in keys:
            continue
        other = next(one for one in path.steps if one.key not in others)
        if path.trial.value <= most and other.cause.name not in names:
            names.add(other.cause.name)
            yield Alternative(other.cause.name, other.label, path.trial.value, other.sentence)


def _alone(search: Search, best: Path, limit: float, floor: float) -> Iterator[Alternative]:
    """The best single explanations, one for each name, by the misfit with the price of each.

    A step of another mesh frequency stays, because each of them needs it.
    """
    kept = {step.key for step in best.steps if search.of_frequency(step.cause)}
    if len(kept) == len(best.steps):
        return
    names: set[str] = set()
    for keys, path in sorted(search.archive.items(), key=lambda item: item[1].score(floor, limit)):
        if len(keys) != len(kept) + 1 or not kept <= keys or len(names) == _ALONE:
            continue
        step = next(one for one in path.steps if one.key not in kept)
        if step.cause.name not in names and step.changes:
            names.add(step.cause.name)
            yield Alternative(step.cause.name, step.label, path.trial.value, step.sentence)
