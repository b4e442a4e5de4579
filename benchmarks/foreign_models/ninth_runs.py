"""How a model of the ninth set is recorded; its author's sound model beside it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from benchmarks.foreign_models.eighth_runs import Made as _Made
from benchmarks.foreign_models.eighth_runs import relieved
from benchmarks.foreign_models.model import STATES, Model, numbers_of, table_of
from benchmarks.foreign_models.ninth_pairs import PAIRS, TORSIONAL, UNILATERAL
from benchmarks.foreign_models.recipe import Curves, Recipe, Settings, chosen, labelled, started

#: Steps of a mesh cycle for the balance of the brake torque.
BALANCE = 2048

#: States at sample times from the start on the periodic motion, by a road of the author's own.
Road = Callable[[np.ndarray, np.ndarray, float, np.void, np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Made(_Made):
    """A wrong or sound model: what its author changed on the way from the drawing to the file."""

    unilateral: bool | None = None
    road: Road | None = None

    def recipe(self) -> Recipe:
        contact = self.pair in UNILATERAL if self.unilateral is None else self.unilateral
        return Recipe(
            self.parameters,
            replace(self.settings, channels=self.channels),
            unilateral=contact,
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

    @property
    def parameters(self) -> Mapping[str, Any]:
        return PAIRS[self.pair]

    def handed_in(self) -> Curves:
        """The curves that the author hands in."""
        recipe = self.recipe()
        if self.road is None:
            return recipe()
        model = recipe.user_model
        curves = by_road(model, recipe.settings, self.road)
        return chosen(self.curves(curves, model), recipe.settings)


def by_road(model: Model, settings: Settings, road: Road) -> Curves:
    """All curves of a motion under the balanced brake torque, integrated by the author's own road."""
    table = table_of(model)
    numbers = numbers_of(model, model.torque * model.line.base_radius_g / model.line.base_radius_p)
    numbers["phase"] = settings.phase
    start, _ = started(model, numbers, table, BALANCE)
    step = model.period / settings.samples
    times = np.arange(int(np.ceil(settings.cycles * settings.samples))) * step
    states = road(start, times, step, numbers, table)
    return labelled(times + settings.origin, states, times, numbers, table, model)


def at_rest() -> np.ndarray:
    """State without load."""
    return np.zeros(STATES)
