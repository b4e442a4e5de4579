"""The explanation of curves by too long steps of a simple integrator.

Sources: docs/how_to/check_your_model.md, "Explanations".
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from validation.check.explanations.cause import Cause, Choice, Kind, Variant
from validation.check.explanations.fields import on_springs
from validation.check.explanations.step_schemes import Scheme
from validation.check.problem import Problem

_WORDS: dict[Scheme, str] = {
    "implicit Euler": "implicit (backward) Euler steps",
    "explicit Euler": "explicit Euler steps",
    "semi-implicit Euler": "semi-implicit Euler steps (displacements by the new rates)",
    "Runge-Kutta": "steps of the Runge-Kutta method of fourth order",
    "trapezoidal rule": "steps of the trapezoidal rule, as of Newmark's method",
}
#: Steps between two samples of the curves, and fewest steps in a mesh cycle.
_BETWEEN_SAMPLES = (1, 2, 4)
_FEWEST = 16
#: Most steps in a mesh cycle: a scheme without damping of its own differs little with more.
_MOST: dict[Scheme, int] = {
    "implicit Euler": 2000,
    "explicit Euler": 2000,
    "semi-implicit Euler": 200,
    "trapezoidal rule": 200,
    "Runge-Kutta": 100,
}


def _schemes(problem: Problem, variant: Variant) -> list[Choice]:
    """Steps of each scheme, so long that they end at samples of the curves."""
    prescribed = variant.pair.mesh.contact == "prescribed" and variant.pair.healthy is variant.pair
    model = problem.curves.role == "model" and not variant.physics.scheme
    if not (prescribed and model and on_springs(problem, variant)):
        return []
    return list(_choices(problem))


def _choices(problem: Problem) -> Iterator[Choice]:
    of_samples = (problem.cycles.size - 1) / max(float(np.ptp(problem.cycles)), 1e-300)
    for scheme, words in _WORDS.items():
        for between in _BETWEEN_SAMPLES:
            steps = round(between * of_samples)
            if _FEWEST <= steps <= _MOST[scheme]:
                text = f"{words}, {steps} in a mesh cycle"
                yield Choice(f"{scheme}, {steps} a cycle", text, _with(scheme, steps))


def _with(scheme: Scheme, steps: int) -> Callable[[Variant], Variant]:
    return lambda variant: variant.with_physics(scheme=scheme, steps=steps)


#: Steps of an integrator that are too long.
LONG_STEPS = Cause(
    name="long steps",
    kind=Kind.PHYSICS,
    meaning="too long steps of a simple integrator, one or some of them from sample to sample",
    span="implicit, explicit, semi-implicit Euler, trapezoidal rule, Runge-Kutta; 1, 2, 4 steps a sample",
    choices=_schemes,
)
