"""How a model of the eleventh set is recorded; its author's sound model beside it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from benchmarks.foreign_models.eighth_runs import Made as _Made
from benchmarks.foreign_models.eighth_runs import relieved
from benchmarks.foreign_models.eleventh_pairs import PAIRS, TORSIONAL, UNILATERAL
from benchmarks.foreign_models.model import table_of
from benchmarks.foreign_models.recipe import Curves, Recipe, Settings, chosen, record


@dataclass(frozen=True)
class Made(_Made):
    """A wrong or sound model: what its author changed on the way from the drawing to the file.

    ``table`` changes the table of coefficients of the tooth pairs.
    """

    table: Callable[[np.ndarray], np.ndarray] = lambda table: table

    @property
    def parameters(self) -> Mapping[str, Any]:
        return PAIRS[self.pair]

    def recipe(self) -> Recipe:
        return Recipe(
            self.parameters,
            replace(self.settings, channels=self.channels),
            unilateral=self.pair in UNILATERAL,
            torsional=self.torsional or self.pair in TORSIONAL,
            drawing=self.drawing,
            line=self.line,
            model=lambda model: self.model(relieved(model)),
            curves=self.curves,
        )

    def twin(self) -> Recipe:
        """The sound model of the same author: RK4 on 4096 steps of a cycle, from the same instant on."""
        return Recipe(
            self.parameters,
            Settings("rk4", 2048, 2, cycles=4, phase=self.settings.phase, channels=self.channels),
            unilateral=self.pair in UNILATERAL,
            torsional=self.pair in TORSIONAL,
            model=lambda model: relieved(model).but(table=4 * model.table),
        )

    def handed_in(self) -> Curves:
        """The curves that the author hands in."""
        recipe = self.recipe()
        model = recipe.user_model
        curves = record(model, recipe.settings, self.table(table_of(model)))
        return chosen(self.curves(curves, model), recipe.settings)
