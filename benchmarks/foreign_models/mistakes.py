"""A mistake: what the user did, and the change of his drawing, model, settings or curves that does it.

The functions make mistakes that users make on more than one pair.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from benchmarks.foreign_models.drawing import Drawing, Line
from benchmarks.foreign_models.laws import Law
from benchmarks.foreign_models.model import Model
from benchmarks.foreign_models.recipe import Curves, Recipe, Settings


@dataclass(frozen=True)
class Mistake:
    """One mistake, in plain words, and where it is made. A change that is None is none."""

    words: str
    drawing: Callable[[Drawing], Drawing] | None = None
    line: Callable[[Line], Line] | None = None
    model: Callable[[Model], Model] | None = None
    numerics: Callable[[Settings], Settings] | None = None
    curves: Callable[[Curves, Model], Curves] | None = None
    torsional: bool | None = None
    unilateral: bool | None = None


@dataclass(frozen=True)
class Chain:
    """The changes of one kind of several mistakes, one after the other."""

    kind: str
    mistakes: tuple[Mistake, ...]

    def __call__(self, value: Any, *others: Any) -> Any:
        for one in self.mistakes:
            change = getattr(one, self.kind)
            value = value if change is None else change(value, *others)
        return value


@dataclass(frozen=True)
class Wrong:
    """A record with one mistake or two: pair, channels, and what is sound in it."""

    name: str
    pair: Mapping[str, Any]
    channels: tuple[str, ...]
    mistakes: tuple[Mistake, ...]
    unilateral: bool = False
    torsional: bool = False
    settings: Settings | None = None

    def recipe(self, mistakes: tuple[Mistake, ...] | None = None) -> Recipe:
        """Recipe with these mistakes; None: with all."""
        made = self.mistakes if mistakes is None else mistakes
        torsional, unilateral = self.torsional, self.unilateral
        for one in made:
            torsional = torsional if one.torsional is None else one.torsional
            unilateral = unilateral if one.unilateral is None else one.unilateral
        return Recipe(
            self.pair,
            replace(self.settings or usual_settings(self.name), channels=self.channels),
            unilateral,
            torsional,
            drawing=Chain("drawing", made),
            line=Chain("line", made),
            model=Chain("model", made),
            numerics=Chain("numerics", made),
            curves=Chain("curves", made),
            sound_unilateral=self.unilateral,
            sound_torsional=self.torsional,
        )


def usual_settings(name: str) -> Settings:
    """Settings of a user, who differs from name to name."""
    number = sum(map(ord, name))
    return Settings(
        method=("rk4", "heun", "newmark")[number % 3],
        samples=(512, 400, 311.7, 288, 640)[number % 5],
        substeps=(4, 5, 7, 8, 4)[number % 5],
        cycles=4 + number % 7 + 0.3 * (number % 2),
        phase=(0.0, 0.21, 0.5, 0.74)[number % 4],
        origin=(0.0, 0.05, 1.3)[number // 3 % 3],
        noise=0.01 if number % 6 == 0 else 0.0,
        seed=number,
    )


# --- stiffness -------------------------------------------------------------------------------------------


def scaled_stiffness(factor: float) -> Callable[[Model], Model]:
    """Stiffness of all tooth pairs times a factor."""

    def change(model: Model) -> Model:
        law = model.stiffness
        return model.but(stiffness=lambda xi: factor * law(xi))

    return change


def other_stiffness(law_of: Callable[[Model], Law]) -> Callable[[Model], Model]:
    return lambda model: model.but(stiffness=law_of(model))


def mirrored_stiffness(model: Model) -> Law:
    """Stiffness read from the other end of the path of contact."""
    law, ends = model.stiffness, model.line.start + model.line.end
    return lambda xi: law(ends - xi)


def mean_of_cycle(phase: np.ndarray, total: np.ndarray) -> np.ndarray:
    """Factor that makes the stiffness of the whole mesh its mean."""
    return total.mean() / total


def first_harmonic(phase: np.ndarray, total: np.ndarray) -> np.ndarray:
    """Factor that leaves the mean and the first harmonic of the stiffness of the whole mesh."""
    wave = np.fft.rfft(total)
    wave[2:] = 0.0
    return np.fft.irfft(wave, total.size) / total


def coarse_samples(count: int) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """Factor that leaves straight lines between so many samples of a mesh cycle."""

    def factor(phase: np.ndarray, total: np.ndarray) -> np.ndarray:
        places = np.arange(count + 1) / count
        values = total[(np.arange(count + 1) * total.size // count) % total.size]
        return np.interp(phase, places, values) / total

    return factor


def whole_mesh(shape: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> Callable[[Model], Model]:
    return lambda model: model.but(total=shape)


# --- damping, masses, bearings ---------------------------------------------------------------------------


def mesh_damping(factor: float) -> Callable[[Drawing], Drawing]:
    return lambda drawing: replace(drawing, mesh_damping=factor * drawing.mesh_damping)


def bearing_stiffness(factor: float, *where: str) -> Callable[[Model], Model]:
    def change(model: Model) -> Model:
        values = {name: factor * model.bearing_stiffness[name] for name in where}
        return model.but(bearing_stiffness=model.bearing_stiffness | values)

    return change


def bearing_damping(factor: float) -> Callable[[Model], Model]:
    return lambda model: model.but(
        bearing_damping={name: factor * value for name, value in model.bearing_damping.items()}
    )


def exchanged_bearings(pairs: Mapping[str, str]) -> Callable[[Model], Model]:
    """Bearings take the values of others: name -> name of the other."""

    def change(model: Model) -> Model:
        stiffness = {one: model.bearing_stiffness[other] for one, other in pairs.items()}
        damping = {one: model.bearing_damping[other] for one, other in pairs.items()}
        return model.but(bearing_stiffness=stiffness, bearing_damping=damping)

    return change


ALONG_AND_ACROSS = {"xp": "yp", "yp": "xp", "xg": "yg", "yg": "xg"}
PINION_AND_GEAR = {"xp": "xg", "xg": "xp", "yp": "yg", "yg": "yp"}


def inertia(pinion: float, gear: float) -> Callable[[Model], Model]:
    return lambda model: model.but(
        inertia_p=pinion * model.inertia_p, inertia_g=gear * model.inertia_g, damping=damping_of(model)
    )


def damping_of(model: Model) -> Callable[[Model, np.ndarray], np.ndarray]:
    """Dampers keep the values of a model: the mistake is in the inertia alone."""
    return lambda other, xi: model.damping(model, xi)


# --- signs, arms, friction -------------------------------------------------------------------------------


def sign(**signs: float) -> Callable[[Model], Model]:
    """Factors of terms of the equations."""
    return lambda model: model.but(signs=model.signs | signs)


def other(**numbers: float) -> Callable[[Model], Model]:
    """Other numbers of the equations."""
    return lambda model: model.but(others=model.others | numbers)


def other_friction(change: Callable[[Model, Law], Law]) -> Callable[[Model], Model]:
    return lambda model: model.but(friction=change(model, model.friction))


def scaled_friction(factor: float) -> Callable[[Model], Model]:
    return other_friction(lambda model, law: lambda xi: factor * law(xi))


def friction_settings(**changes: Any) -> Callable[[Drawing], Drawing]:
    return lambda drawing: replace(drawing, friction={**drawing.friction, **changes})


# --- operating point, geometry ---------------------------------------------------------------------------


def scaled_torque(factor: float) -> Callable[[Drawing], Drawing]:
    return lambda drawing: replace(drawing, torque=factor * drawing.torque)


def scaled_speed(factor: float) -> Callable[[Drawing], Drawing]:
    return lambda drawing: replace(drawing, speed=factor * drawing.speed)


def without_shifts(drawing: Drawing) -> Drawing:
    """Gears without profile shift at their reference centre distance."""
    addendum = drawing.module * drawing.parameters["basic_rack"].get("addendum_coefficient", 1.0)

    def plain(wheel: Any) -> Any:
        return replace(wheel, shift=0.0, tip_radius=0.5 * drawing.module * wheel.teeth + addendum)

    teeth = drawing.pinion.teeth + drawing.gear.teeth
    return replace(
        drawing,
        pinion=plain(drawing.pinion),
        gear=plain(drawing.gear),
        centre_distance=0.5 * drawing.module * teeth,
    )


def standard_tips(drawing: Drawing) -> Drawing:
    """Tips of a standard addendum of one module."""

    def plain(wheel: Any) -> Any:
        return replace(wheel, tip_radius=drawing.module * (0.5 * wheel.teeth + wheel.shift + 1.0))

    return replace(drawing, pinion=plain(drawing.pinion), gear=plain(drawing.gear))


def other_module(module: float) -> Callable[[Drawing], Drawing]:
    """Another module; centre distance and tips follow from the same coefficients."""

    def change(drawing: Drawing) -> Drawing:
        factor = module / drawing.module
        return replace(
            drawing,
            module=module,
            centre_distance=factor * drawing.centre_distance,
            pinion=replace(drawing.pinion, tip_radius=factor * drawing.pinion.tip_radius),
            gear=replace(drawing.gear, tip_radius=factor * drawing.gear.tip_radius),
        )

    return change


def other_pressure_angle(degrees: float) -> Callable[[Drawing], Drawing]:
    return lambda drawing: replace(drawing, pressure_angle=math.radians(degrees))


# --- what the user writes --------------------------------------------------------------------------------


def scaled(factor: float, *names: str) -> Callable[[Curves, Model], Curves]:
    """Channels times a factor: a unit or a sign."""
    return lambda curves, model: curves | {name: factor * curves[name] for name in names}


def renamed(names: Mapping[str, str], factor: float = 1.0) -> Callable[[Curves, Model], Curves]:
    """Channels that hold another one: name -> the one that is written, times a factor."""
    return lambda curves, model: curves | {one: factor * curves[two] for one, two in names.items()}


def stretched_time(factor: float) -> Callable[[Curves, Model], Curves]:
    return lambda curves, model: curves | {"time": factor * curves["time"]}


def low_pass(share: float) -> Callable[[Curves, Model], Curves]:
    """A filter of first order, run forwards, whose corner is a share of the mesh frequency."""

    def change(curves: Curves, model: Model) -> Curves:
        times = curves["time"]
        weight = 1.0 - math.exp(-2.0 * math.pi * share * (times[1] - times[0]) / model.period)
        result: Curves = {"time": times}
        for name, values in curves.items():
            if name == "time":
                continue
            smooth = np.array(values)
            state = values.mean(axis=-1)
            for n in range(times.size):
                state = state + weight * (values[..., n] - state)
                smooth[..., n] = state
            result[name] = smooth
        return result

    return change


def few_samples(per_cycle: int) -> Callable[[Curves, Model], Curves]:
    """Curves stored at few samples of a cycle and joined by straight lines."""

    def change(curves: Curves, model: Model) -> Curves:
        times = curves["time"]
        stored = np.arange(times[0], times[-1], model.period / per_cycle)
        result: Curves = {"time": times}
        for name, values in curves.items():
            if name != "time" and values.ndim == 1:
                result[name] = np.interp(times, stored, np.interp(stored, times, values))
        return result

    return change


def with_numerics(**changes: Any) -> Callable[[Settings], Settings]:
    return lambda settings: replace(settings, **changes)
