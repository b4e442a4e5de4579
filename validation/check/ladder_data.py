"""The ladder of a check as a dataset, for its figure and its table."""

from __future__ import annotations

import xarray as xr

from lumped.labelling import labelled_dataset
from validation.check.ladder import Ladder
from validation.check.origin import origin
from validation.check.problem import Problem


def ladder_data(problem: Problem, ladder: Ladder, limit: float) -> xr.Dataset:
    """Return the misfit before the first and after each step of a ladder.

    Returns
    -------
    xarray.Dataset over ``step``: ``misfit`` [1]; ``sentence``, the explanation; ``alternatives``, sentences
    on what the curves do not tell apart from it. The attribute ``limit`` is the limit of the misfit
    """
    sentences = ["Our model as the parameter file says", *(step.sentence for step in ladder.steps)]
    misfits = [ladder.start, *(step.misfit for step in ladder.steps)]
    alternatives = [
        "",
        *("; ".join(other.sentence for other in step.alternatives) for step in ladder.steps),
    ]
    return labelled_dataset(
        {
            "misfit": ("step", misfits, "1", "misfit after the step"),
            "sentence": ("step", sentences, "1", "explanation"),
            "alternatives": ("step", alternatives, "1", "explanations that do about as well"),
        },
        {"step": (list(range(len(misfits))), "1", "step")},
        origin(problem.pair) | {"limit": limit},
    )
