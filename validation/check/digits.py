"""Curves of a model that agree at every order, but whose samples scatter, as values of few digits do.

Sources: docs/how_to/check_your_model.md, "Explanations".
"""

from __future__ import annotations

import math

from validation.check.curve_orders import white_noise
from validation.check.explanations.misreadings import FEW_DIGITS
from validation.check.ladder import Explanation
from validation.check.problem import Problem
from validation.files.formatting import percent

#: Scatter over the rms of the motion that is worth a word, over the limit of the misfit.
_SCATTERS = 2.0


def few_digits(problem: Problem, limit: float) -> tuple[Explanation, ...]:
    """Return the explanation of curves of a model that agree and scatter; none: they do not scatter.

    A model has no noise. The scatter is that of third differences.
    """
    if problem.curves.role != "model":
        return ()
    shares = {}
    for row in problem.misfit.channels:
        channel = row.channel.channel
        size = row.channel.orders.size / math.sqrt(2.0)
        if channel.tooth_pair is None and size > 0.0:
            shares[channel.name] = white_noise(channel.values[problem.used(channel)]) / size
    names = [name for name, share in shares.items() if share > _SCATTERS * limit]
    if not names:
        return ()
    largest = max(shares[name] for name in names)
    sentence = (
        f"Compatible with few digits in {', '.join(names)}, as of angles in single precision: the samples "
        f"scatter by {percent(largest)} of the motion"
    )
    return (Explanation(FEW_DIGITS.name, ", ".join(names), problem.misfit.value, sentence),)
