"""How a model of the tenth set is recorded; its author's sound model beside it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from benchmarks.foreign_models.eighth_runs import Made as _Made
from benchmarks.foreign_models.eighth_runs import relieved
from benchmarks.foreign_models.integrators import FIXED
from benchmarks.foreign_models.kernels import run_fixed
from benchmarks.foreign_models.model import STATES, Model, numbers_of, table_of
from benchmarks.foreign_models.recipe import (
    START_STEPS,
    Curves,
    Recipe,
    Settings,
    chosen,
    labelled,
    record,
    started,
)
from benchmarks.foreign_models.tenth_pairs import PAIRS, TORSIONAL, UNILATERAL


@dataclass(frozen=True)
class Made(_Made):
    """A wrong or sound model: what its author changed on the way from the drawing to the file.

    ``table`` changes the table of coefficients of the tooth pairs; ``from_rest``: the record starts with the
    load put on gears that stand still against each other.
    """

    table: Callable[[np.ndarray], np.ndarray] = lambda table: table
    from_rest: bool = False

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
        table = self.table(table_of(model))
        settings = recipe.settings
        curves = unsettled(model, settings, table) if self.from_rest else record(model, settings, table)
        return chosen(self.curves(curves, model), settings)


def unsettled(model: Model, settings: Settings, table: np.ndarray) -> Curves:
    """All curves from the instant at which the torques act on gears without load."""
    numbers = numbers_of(model, model.torque * model.line.base_radius_g / model.line.base_radius_p)
    numbers["phase"] = settings.phase
    started(model, numbers, table, START_STEPS)  # sets the brake torque
    step = model.period / settings.samples
    times = np.arange(int(np.ceil(settings.cycles * settings.samples))) * step
    method = FIXED[settings.method]
    states = run_fixed(method, np.zeros(STATES), 0.0, step, settings.substeps, times.size, numbers, table)
    return labelled(times + settings.origin, states, times, numbers, table, model)
