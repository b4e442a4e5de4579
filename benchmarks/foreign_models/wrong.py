"""Records with one mistake, as students, consultants and programs make them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from benchmarks.foreign_models.drawing import Drawing
from benchmarks.foreign_models.model import Model
from benchmarks.foreign_models.pairs import PAIRS
from benchmarks.foreign_models.recipe import Curves, Recipe, Settings

FULL = (
    "dte",
    "x_p",
    "y_p",
    "bearing_force_x_p",
    "bearing_force_y_p",
    "bearing_force_x_g",
    "bearing_force_y_g",
)
LOADS = ("dte", "x_p", "x_g", "mesh_force")
USUAL = ("dte", "bearing_force_x_p", "bearing_force_y_p")
DISPLACED = ("x_p", "y_p", "x_g", "y_g", "dte")


@dataclass(frozen=True)
class Mistake:
    """One mistake: where it is made. A change that is None is none."""

    words: str
    drawing: Callable[[Drawing], Drawing] | None = None
    model: Callable[[Model], Model] | None = None
    numerics: Callable[[Settings], Settings] | None = None
    curves: Callable[[Curves, Model], Curves] | None = None
    torsional: bool | None = None
    unilateral: bool | None = None


@dataclass(frozen=True)
class Wrong:
    """A record with one mistake or two."""

    name: str
    pair: Mapping[str, Any]
    channels: tuple[str, ...]
    mistakes: tuple[Mistake, ...]
    settings: Settings = Settings()
    torsional: bool = False
    unilateral: bool = False

    def recipe(self, mistakes: tuple[Mistake, ...] | None = None) -> Recipe:
        """Recipe with these mistakes, or all."""
        chosen = self.mistakes if mistakes is None else mistakes
        torsional, unilateral = self.torsional, self.unilateral
        for one in chosen:
            torsional = torsional if one.torsional is None else one.torsional
            unilateral = unilateral if one.unilateral is None else one.unilateral
        settings = replace(self.settings, channels=self.channels)
        return Recipe(
            self.pair,
            settings,
            unilateral,
            torsional,
            Drawings(chosen),
            Models(chosen),
            Numerics(chosen),
            Written(chosen),
        )


@dataclass(frozen=True)
class Drawings:
    mistakes: tuple[Mistake, ...]

    def __call__(self, drawing: Drawing) -> Drawing:
        for one in self.mistakes:
            drawing = one.drawing(drawing) if one.drawing else drawing
        return drawing


@dataclass(frozen=True)
class Models:
    mistakes: tuple[Mistake, ...]

    def __call__(self, model: Model) -> Model:
        for one in self.mistakes:
            model = one.model(model) if one.model else model
        return model


@dataclass(frozen=True)
class Numerics:
    mistakes: tuple[Mistake, ...]

    def __call__(self, settings: Settings) -> Settings:
        for one in self.mistakes:
            settings = one.numerics(settings) if one.numerics else settings
        return settings


@dataclass(frozen=True)
class Written:
    mistakes: tuple[Mistake, ...]

    def __call__(self, curves: Curves, model: Model) -> Curves:
        for one in self.mistakes:
            curves = one.curves(curves, model) if one.curves else curves
        return curves


def stiffer(factor: float) -> Callable[[Model], Model]:
    def change(model: Model) -> Model:
        law = model.stiffness
        return model.but(stiffness=lambda xi: factor * law(xi))

    return change


def sign(**signs: float) -> Callable[[Model], Model]:
    return lambda model: model.but(signs=model.signs | signs)


def mesh_damping(factor: float) -> Callable[[Drawing], Drawing]:
    return lambda drawing: replace(drawing, mesh_damping=factor * drawing.mesh_damping)


def bearing_stiffness(factor: float, *where: str) -> Callable[[Model], Model]:
    def change(model: Model) -> Model:
        values = {name: model.bearing_stiffness[name] * factor for name in where}
        return model.but(bearing_stiffness=model.bearing_stiffness | values)

    return change


WRONG: list[Wrong] = [
    Wrong(
        "stiffness_15_percent_high",
        PAIRS["nasa"],
        USUAL,
        (Mistake("the stiffness of the tooth pairs is 15 % too large", model=stiffer(1.15)),),
    ),
    Wrong(
        "moment_of_friction_on_pinion_reversed",
        PAIRS["art_energy"],
        FULL,
        (
            Mistake(
                "the moment of friction on the pinion has the wrong sign (the paper's equation 1)",
                model=sign(moment_sign_p=-1.0),
            ),
        ),
    ),
    Wrong(
        "mesh_damping_ten_times",
        PAIRS["rack_25"],
        LOADS,
        (Mistake("the damping of the mesh is 10 times too small", drawing=mesh_damping(0.1)),),
    ),
    Wrong(
        "bearings_per_millimetre",
        PAIRS["hcr"],
        DISPLACED,
        (
            Mistake(
                "the bearing stiffness along the line of action of the gear is 10 times too small",
                model=bearing_stiffness(0.1, "xg"),
            ),
        ),
    ),
    Wrong(
        "inertia_of_diameter_not_radius",
        PAIRS["fzg_xk"],
        ("dte",),
        (
            Mistake(
                "the moment of inertia of both gears was computed with m r^2 instead of m r^2/2",
                model=lambda model: model.but(
                    inertia_p=2.0 * model.inertia_p, inertia_g=2.0 * model.inertia_g
                ),
            ),
        ),
    ),
]
