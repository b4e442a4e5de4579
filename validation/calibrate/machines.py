"""The possible machines that records leave, with the error of the model in each of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lumped.typing import FloatArray
from validation.calibrate.discrepancy import DEVIATION
from validation.calibrate.mixture import Component
from validation.prediction.machines import ERRORS


@dataclass(frozen=True, eq=False)
class Machines:
    """Possible machines that the records leave. The first one is the best fit.

    Attributes
    ----------
    z : (machine, input) normal scores
    components : component of the mixture from which each machine was drawn
    numbers : page-1 numbers of each machine, without the error of the model
    shown : results of page 1 that the records show
    shape : shape of the tail of the importance weights; above 0.7 the machines are those of the linear data
    seed : seed of the draws
    """

    z: FloatArray
    components: Sequence[Component]
    numbers: Sequence[dict[str, float]]
    shown: frozenset[str]
    shape: float
    seed: int

    @cached_property
    def errors(self) -> dict[str, FloatArray]:
        """Result -> (machine,) error of the model, as a share of the result; 0 of the best fit.

        The error of each machine is normal with the level of its component, and for results that the records
        do not show at least with a level of the half-normal prior: they say nothing about it.
        """
        random = np.random.default_rng(self.seed + 1)
        levels = np.array([one.level for one in self.components])
        errors = {}
        for name in ERRORS:
            prior = DEVIATION * np.abs(random.standard_normal(levels.size))
            size = levels if name in self.shown else np.maximum(levels, prior)
            errors[name] = size * random.standard_normal(levels.size)
            errors[name][0] = 0.0
        return errors
