"""One record of the sixth set: the user's model, his integrator, and what he hands in.

The model with relief is a variant of its own: an unloaded error of the teeth, and contact where the static
load closes the gap.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from benchmarks.foreign_models.differences import orders_of
from benchmarks.foreign_models.drawing import Drawing, Line, drawing_of, line_of_action
from benchmarks.foreign_models.laws import Law
from benchmarks.foreign_models.model import Model, model_of
from benchmarks.foreign_models.recipe import Curves, Settings, chosen, record
from benchmarks.foreign_models.sixth_pairs import SIXTH_PAIRS, Pair

#: Steps of a mesh cycle in the sound model.
FINE = 4096
#: Neighbours of a tooth pair that may touch beside it.
NEIGHBOURS = np.arange(-3, 4)
#: Shares of a mesh cycle by which the sound record is shifted to fit.
SHIFTS = 512

Hook = Callable[[Any], Any]


def unchanged(value: Any) -> Any:
    return value


def relief_of(drawing: Drawing, line: Line) -> Law:
    """Material that tip relief removes, normal to the flank [m]; zero without relief."""

    def one(name: str, base: float, last: float, travel: np.ndarray) -> np.ndarray:
        relief = drawing.parameters[name].get("tip_relief")
        if relief is None:
            return np.zeros_like(travel)
        first = base * math.radians(relief["start_roll_angle"])
        share = np.asarray(np.maximum((travel - first) / (last - first), 0.0))
        return 1e-6 * float(relief["amount"]) * share

    def error(xi: np.ndarray) -> np.ndarray:
        of_pinion = one("pinion", line.base_radius_p, line.end, xi)
        of_gear = one("gear", line.base_radius_g, line.length - line.start, line.length - xi)
        total: np.ndarray = of_pinion + of_gear
        return total

    return error


def touching(model: Model, error: Law, xi: np.ndarray) -> np.ndarray:
    """Whether the tooth pair at xi carries load at rest."""
    line = model.line
    places = xi[..., None] + NEIGHBOURS * line.base_pitch
    on = (places >= line.start) & (places <= line.end)
    stiffness = np.where(on, model.stiffness(places), 0.0)
    gap = error(places)
    for _ in range(NEIGHBOURS.size):
        force = model.torque / line.base_radius_p + (stiffness * gap).sum(axis=-1)
        deflection = force / np.maximum(stiffness.sum(axis=-1), 1.0)
        stiffness = np.where(gap < deflection[..., None], stiffness, 0.0)
    result: np.ndarray = error(xi) < deflection
    return result


def relieved(model: Model) -> Model:
    """Model with the relief of the drawing, and contact where the teeth carry load at rest."""
    error = relief_of(model.drawing, model.line)
    perfect = model.stiffness
    return model.but(error=error, stiffness=lambda xi: perfect(xi) * touching(model, error, xi))


def modelled(
    pair: Mapping[str, Any],
    unilateral: bool = False,
    torsional: bool = False,
    drawing: Hook = unchanged,
    line: Hook = unchanged,
) -> Model:
    """Build the model of a pair, with relief where the file has it."""
    numbers: Drawing = drawing(drawing_of(pair))
    model = model_of(numbers, unilateral, torsional, line(line_of_action(numbers)))
    return relieved(model) if pair["mesh"]["relief"] == "static" else model


def recorded(model: Model, settings: Settings, table: np.ndarray | None = None) -> Curves:
    """All curves of the motion.

    Gears that only turn get no displacement: the start of the motion leaves one that does not vary, which the
    rotation of the pinion takes over.
    """
    curves = record(model, settings, table)
    if not model.torsional:
        return curves
    radius = model.others.get("base_p", model.line.base_radius_p)
    still = {name: np.zeros_like(curves[name]) for name in ("x_p", "x_g", "y_p", "y_g")}
    return curves | still | {"theta_p": curves["theta_p"] + (curves["x_p"] - curves["x_g"]) / radius}


@dataclass(frozen=True)
class SixthCase:
    """A record that a user hands in. ``line``, ``model`` and others make the mistake; a sound user has none.

    Attributes
    ----------
    name : of the case
    truth : what is wrong, in a sentence
    on : name of the pair
    settings : integrator, samples and channels of the record
    runs : how model and settings become curves
    exported : what the user does to his curves before he writes them
    """

    name: str
    truth: str
    on: str
    settings: Settings
    unilateral: bool = False
    torsional: bool = False
    drawing: Hook = unchanged
    line: Hook = unchanged
    model: Hook = unchanged
    numerics: Hook = unchanged
    runs: Callable[[Model, Settings], Curves] = recorded
    exported: Callable[[Curves, Model], Curves] = field(default=lambda curves, model: curves)
    user_unilateral: bool | None = None
    user_torsional: bool | None = None

    @property
    def pair(self) -> Pair:
        """Parameter file as a mapping."""
        return SIXTH_PAIRS[self.on]

    @property
    def user_model(self) -> Model:
        """The user's model, with its mistake."""
        unilateral = self.unilateral if self.user_unilateral is None else self.user_unilateral
        torsional = self.torsional if self.user_torsional is None else self.user_torsional
        model: Model = self.model(modelled(self.pair, unilateral, torsional, self.drawing, self.line))
        return model

    def curves(self) -> Curves:
        """Return what the user hands in: time and channels."""
        settings: Settings = self.numerics(self.settings)
        model = self.user_model
        # Beyond its ends a parabola falls below zero, whose root the table leaves out.
        with np.errstate(invalid="ignore"):
            return chosen(self.exported(self.runs(model, settings), model), settings)

    def sound(self) -> Curves:
        """The same channels without mistake and noise, by Runge-Kutta steps of 1/4096 of a cycle or less."""
        model = modelled(self.pair, self.unilateral, self.torsional)
        substeps = -(-FINE // int(self.settings.samples))
        settings = replace(self.settings, method="rk4", substeps=substeps, settle=0, noise=0.0)
        with np.errstate(invalid="ignore"):
            return chosen(recorded(model.but(table=4 * model.table), settings), settings)


class Misfit(NamedTuple):
    """How far a channel is from the sound model of the same author.

    Attributes
    ----------
    as_timed : complex mesh orders 1 to 40 over those of the sound channel; both start at the same phase
    shifted : the same after the shift in time that fits most channels best
    mean : difference of the means over the rms of the sound channel
    """

    as_timed: float
    shifted: float
    mean: float


def misfits(case: SixthCase) -> dict[str, Misfit]:
    """Return channel -> how far it is from the sound model of the same author."""
    mine, sound = case.curves(), case.sound()
    period = modelled(case.pair).period
    names = [name for name in mine if name != "time"]
    theirs = {name: orders_of(sound["time"], sound[name], period) for name in names}
    ours = {name: orders_of(mine["time"], mine[name], period) for name in names}
    turns = np.exp(2j * np.pi * np.outer(np.arange(SHIFTS) / SHIFTS, np.arange(1, 41)))
    size = {name: max(float(np.linalg.norm(theirs[name][:, 1:])), 1e-300) for name in names}
    off = {
        name: np.array([np.linalg.norm(ours[name][:, 1:] - theirs[name][:, 1:] * turn) for turn in turns])
        / size[name]
        for name in names
    }
    best = int(np.argmin(sum(np.minimum(values, 1.0) for values in off.values())))
    result: dict[str, Misfit] = {}
    for name in names:
        mean = abs(float(np.mean(mine[name]) - np.mean(sound[name])))
        rms = max(float(np.sqrt(np.mean(sound[name] ** 2))), 1e-300)
        result[name] = Misfit(float(off[name][0]), float(off[name][best]), mean / rms)
    return result
