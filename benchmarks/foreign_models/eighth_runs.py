"""The author's own sound model with relief, his records, and how far curves are apart; of the eighth set."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from benchmarks.foreign_models.differences import ORDERS, orders_of
from benchmarks.foreign_models.drawing import Drawing, Line, Wheel
from benchmarks.foreign_models.eighth_pairs import OFFICE, PAIRS
from benchmarks.foreign_models.laws import Law
from benchmarks.foreign_models.model import Model
from benchmarks.foreign_models.recipe import Curves, Recipe, Settings

#: Shares of a mesh cycle by which the sound record is shifted to fit.
SHIFTS = 512

#: Pairs whose loads are cut at zero by their author: late contact by relief, and teeth that part.
UNILATERAL = (*OFFICE, "winder")

#: Pairs that are modelled without bearings, which are nearly rigid in the file.
TORSIONAL = ("lathe",)


@dataclass(frozen=True)
class Relief:
    """Tip relief of one gear: power of its shape, amount [m], roll angles of start and tip [rad]."""

    power: int
    amount: float
    start: float
    end: float

    def at(self, roll: np.ndarray) -> np.ndarray:
        share = np.maximum((roll - self.start) / (self.end - self.start), 0.0)
        removed: np.ndarray = self.amount * share**self.power
        return removed


def relief_of(side: Mapping[str, Any], wheel: Wheel, base_radius: float) -> Relief | None:
    """Tip relief of a gear of the parameter file."""
    if "tip_relief" not in side:
        return None
    table = side["tip_relief"]
    tip = math.sqrt((wheel.tip_radius / base_radius) ** 2 - 1.0)
    power = 2 if table["shape"] == "parabolic" else 1
    return Relief(power, table["amount"] * 1e-6, math.radians(table["start_roll_angle"]), tip)


def reliefs(drawing: Drawing, line: Line) -> tuple[Relief | None, Relief | None]:
    """Tip reliefs of pinion and gear."""
    pair = drawing.parameters
    return (
        relief_of(pair["pinion"], drawing.pinion, line.base_radius_p),
        relief_of(pair["gear"], drawing.gear, line.base_radius_g),
    )


def gap_of(line: Line, pinion: Relief | None, gear: Relief | None) -> Law:
    """Gap of a tooth pair over the path of contact by the reliefs of both gears."""

    def law(xi: np.ndarray) -> np.ndarray:
        gap = np.zeros_like(xi)
        if pinion is not None:
            gap = gap + pinion.at(xi / line.base_radius_p)
        if gear is not None:
            gap = gap + gear.at((line.length - xi) / line.base_radius_g)
        return gap

    return law


def relieved(model: Model) -> Model:
    """The model with the tip reliefs of the drawing."""
    line = model.line
    return model.but(error=gap_of(line, *reliefs(model.drawing, line)))


@dataclass(frozen=True)
class Made:
    """A wrong or sound model: what its author changed on the way from the drawing to the file."""

    pair: str
    channels: tuple[str, ...]
    settings: Settings = field(default_factory=Settings)
    drawing: Callable[[Drawing], Drawing] = lambda drawing: drawing
    line: Callable[[Line], Line] = lambda line: line
    model: Callable[[Model], Model] = lambda model: model
    curves: Callable[[Curves, Model], Curves] = lambda curves, model: curves
    torsional: bool = False

    def recipe(self) -> Recipe:
        pair = PAIRS[self.pair]
        return Recipe(
            pair,
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
        settings = Settings("rk4", 2048, 2, cycles=4, phase=self.settings.phase, channels=self.channels)
        return Recipe(
            PAIRS[self.pair],
            settings,
            unilateral=self.pair in UNILATERAL,
            torsional=self.pair in TORSIONAL,
            model=lambda model: relieved(model).but(table=4 * model.table),
        )


class Effect(NamedTuple):
    """Of a channel: complex mesh orders from 1 up over those of the sound curve; mean over its size.

    The size is the larger of the sound curve's mean and swing from peak to peak. Both curves are expanded in
    orders of the sound model's mesh cycle, after the shift in time that fits all channels best, where more
    than 100 % counts as 100 %.
    """

    wave: float
    mean: float


def effects(curves: Curves, made: Made) -> dict[str, Effect]:
    """How far each channel is from that of the author's sound model."""
    twin = made.twin()
    sound = twin()
    period = twin.user_model.period
    turns = np.exp(2j * np.pi * np.outer(np.arange(SHIFTS) / SHIFTS, np.arange(ORDERS + 1)))
    mine = {name: orders_of(curves["time"], curves[name], period)[0] for name in made.channels}
    theirs = {name: orders_of(sound["time"], sound[name], period)[0] for name in made.channels}
    waves = {
        name: np.linalg.norm((mine[name] - theirs[name] * turns)[:, 1:], axis=1)
        / np.linalg.norm(theirs[name][1:])
        for name in made.channels
    }
    best = int(np.argmin(sum(np.minimum(wave, 1.0) for wave in waves.values())))
    result = {}
    for name in made.channels:
        size = max(abs(theirs[name][0]), float(np.ptp(sound[name])))
        mean = 0.0 if name.startswith("theta") else abs(mine[name][0] - theirs[name][0]) / size
        result[name] = Effect(float(waves[name][best]), float(mean))
    return result
