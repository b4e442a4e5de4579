"""One record of the user: his model, his integrator, what he writes to the file, and the mistake in it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from benchmarks.foreign_models.drawing import Drawing, Line, drawing_of, line_of_action
from benchmarks.foreign_models.integrators import (
    FIXED,
    harmonic_balance,
    periodic_start,
    run_exponentials,
    run_scipy,
)
from benchmarks.foreign_models.kernels import run_fixed, tooth_loads
from benchmarks.foreign_models.model import (
    DISPLACEMENTS,
    STATES,
    Model,
    model_of,
    numbers_of,
    table_of,
)

Curves = dict[str, np.ndarray]

#: Steps of a mesh cycle for a periodic start, where those of the record do not end with the cycle.
START_STEPS = 4096


@dataclass(frozen=True)
class Settings:
    """How the user integrates and what he writes.

    Attributes
    ----------
    method : one of ``FIXED`` or ``SCIPY``, "exponentials" or "harmonic_balance"
    samples : of a mesh cycle in the record; need not be whole
    substeps : of the integrator between two samples
    cycles : mesh cycles in the record
    phase : of the mesh cycle at the start of the record
    origin : time at the start of the record [s]
    settle : mesh cycles from rest before the record; 0: the record starts on the periodic motion
    noise : standard deviation over that of the channel without its mean
    """

    method: str = "rk4"
    samples: float = 512
    substeps: int = 4
    cycles: float = 4
    phase: float = 0.0
    origin: float = 0.0
    settle: int = 0
    noise: float = 0.0
    seed: int = 0
    rtol: float = 1e-6
    orders: int = 60
    channels: tuple[str, ...] = ("dte",)


@dataclass(frozen=True)
class Recipe:
    """A call makes the record. A mistake changes the drawing, line, model, settings or curves."""

    pair: Mapping[str, Any]
    settings: Settings
    unilateral: bool = False
    torsional: bool = False
    drawing: Callable[[Drawing], Drawing] = field(default=lambda drawing: drawing)
    line: Callable[[Line], Line] = field(default=lambda line: line)
    model: Callable[[Model], Model] = field(default=lambda model: model)
    numerics: Callable[[Settings], Settings] = field(default=lambda settings: settings)
    curves: Callable[[Curves, Model], Curves] = field(default=lambda curves, model: curves)
    sound_unilateral: bool | None = None
    sound_torsional: bool | None = None

    @property
    def user_model(self) -> Model:
        drawing = self.drawing(drawing_of(self.pair))
        line = self.line(line_of_action(drawing))
        return self.model(model_of(drawing, self.unilateral, self.torsional, line))

    def __call__(self) -> Curves:
        model = self.user_model
        settings = self.numerics(self.settings)
        curves = self.curves(record(model, settings), model)
        return chosen(curves, settings)

    @property
    def sound(self) -> Recipe:
        """The record without mistake, noise or coarse steps: RK4 on 4096 steps of a cycle."""
        fine = -(-4096 // int(self.settings.samples))
        settings = replace(self.settings, method="rk4", substeps=fine, settle=0, noise=0.0)
        unilateral = self.unilateral if self.sound_unilateral is None else self.sound_unilateral
        torsional = self.torsional if self.sound_torsional is None else self.sound_torsional
        return Recipe(self.pair, settings, unilateral, torsional, model=finer)


def finer(model: Model) -> Model:
    return model.but(table=4 * model.table)


def record(model: Model, settings: Settings, table: np.ndarray | None = None) -> Curves:
    """All curves of the motion, at the sample times; ``table`` by default that of the model."""
    table = table_of(model) if table is None else table
    ratio = model.line.base_radius_g / model.line.base_radius_p
    numbers = numbers_of(model, model.torque * ratio)
    numbers["phase"] = settings.phase
    step = model.period / settings.samples
    count = int(np.ceil(settings.cycles * settings.samples))
    times = np.arange(count) * step
    whole = float(settings.samples).is_integer() and settings.method in FIXED
    steps = int(settings.samples * settings.substeps) if whole else START_STEPS
    start, _ = started(model, numbers, table, steps)
    if settings.settle:
        start = settled(numbers, table, settings, step)
    states = integrated(settings, start, times, step, numbers, table)
    return labelled(times + settings.origin, states, times, numbers, table, model)


def started(model: Model, numbers: np.void, table: np.ndarray, steps: int) -> tuple[np.ndarray, float]:
    """State on the periodic motion; that of teeth that only push is sought from that of teeth that pull."""
    guess = np.zeros(STATES)
    if model.unilateral:
        numbers["unilateral"] = 0.0
        guess, _ = periodic_start(numbers, table, steps, guess, model.balanced)
        numbers["unilateral"] = 1.0
        run = run_fixed(0, guess, 0.0, float(numbers["period"]), steps, 60, numbers, table)
        drift = run[-1, 0] - run[-2, 0]
        guess = (
            run[-1] - np.r_[run[-1, 0], run[-1, 0] / (numbers["base_g"] / numbers["base_p"]), np.zeros(10)]
        )
        speed = drift / float(numbers["period"])
        guess[6] -= speed
        guess[7] -= speed * numbers["base_p"] / numbers["base_g"]
    return periodic_start(numbers, table, steps, guess, model.balanced)


def settled(numbers: np.void, table: np.ndarray, settings: Settings, step: float) -> np.ndarray:
    """Return the state after so many cycles from a mesh that is wound up by the mean load."""
    start = np.zeros(STATES)
    force = float(numbers["torque_p"]) / float(numbers["base_p"])
    start[0] = force / float(table["stiffness"].sum(axis=0).mean()) / float(numbers["base_p"])
    if numbers["rigid"] == 0.0:
        start[2], start[3] = -force / float(numbers["stiffness_xp"]), force / float(numbers["stiffness_xg"])
        start[0] += (start[3] - start[2]) / float(numbers["base_p"])
    method = FIXED.get(settings.method, 0)
    samples = round(settings.settle * settings.samples) + 1
    run = run_fixed(method, start, 0.0, step, settings.substeps, samples, numbers, table)
    whole = round(settings.samples)
    end: np.ndarray = run[-1]
    # The user holds the mean speed: what is left of the start's common rotation is taken out.
    speed = (end[0] - run[-1 - whole, 0]) / float(numbers["period"])
    end = end.copy()
    end[6] -= speed
    end[7] -= speed * float(numbers["base_p"]) / float(numbers["base_g"])
    return end


def integrated(
    settings: Settings, start: np.ndarray, times: np.ndarray, step: float, numbers: np.void, table: np.ndarray
) -> np.ndarray:
    """States at the sample times by the method of the settings."""
    if settings.method in FIXED:
        method = FIXED[settings.method]
        result: np.ndarray = run_fixed(
            method, start, 0.0, step, settings.substeps, times.size, numbers, table
        )
        return result
    if settings.method == "exponentials":
        return run_exponentials(start, times, int(settings.samples), numbers, table)
    if settings.method == "harmonic_balance":
        return harmonic_balance(times, settings.orders, numbers, table)
    return run_scipy(settings.method, start, times, numbers, table, settings.rtol)


def labelled(
    labels: np.ndarray,
    states: np.ndarray,
    times: np.ndarray,
    numbers: np.void,
    table: np.ndarray,
    model: Model,
) -> Curves:
    """All channels by the names of the result datasets."""
    curves: Curves = {"time": labels}
    for index, name in enumerate(DISPLACEMENTS):
        curves[name] = states[:, index].copy()
        curves[f"{name}_dot"] = states[:, 6 + index].copy()
    without_drift(curves, model)
    line = model.line
    turned = line.base_radius_p * curves["theta_p"] - line.base_radius_g * curves["theta_g"]
    curves["dte"] = turned + states[:, 2] - states[:, 3]
    normal = np.zeros((table.shape[0], times.size))
    friction = np.zeros_like(normal)
    tooth_loads(times, states, numbers, table, normal, friction)
    curves["normal_load"] = normal
    curves["friction_force"] = friction
    curves["mesh_force"] = normal.sum(axis=0)
    for end in ("p", "g"):
        for along in ("x", "y"):
            spring = float(numbers[f"stiffness_{along}{end}"]) * curves[f"{along}_{end}"]
            damper = float(numbers[f"damping_{along}{end}"]) * curves[f"{along}_{end}_dot"]
            curves[f"bearing_force_{along}_{end}"] = -spring - damper
    return curves


def without_drift(curves: Curves, model: Model) -> None:
    """Take the common rotation at constant speed out of both angles: the user holds the mean speed."""
    times = curves["time"]
    cycle = round(model.period / (times[1] - times[0]))
    if times.size < 2 * cycle:
        return
    first, last = curves["theta_p"][:cycle].mean(), curves["theta_p"][-cycle:].mean()
    speed = (last - first) / (times[-1] - times[cycle - 1])
    curves["theta_p"] -= speed * (times - times[0])
    ratio = model.line.base_radius_p / model.line.base_radius_g
    curves["theta_g"] -= ratio * speed * (times - times[0])


def chosen(curves: Curves, settings: Settings) -> Curves:
    """Time and the channels of the settings, in their order, with noise."""
    random = np.random.default_rng(settings.seed)
    result: Curves = {"time": curves["time"]}
    for name in settings.channels:
        values = curves[name]
        swing = np.std(values, axis=-1, keepdims=True)
        result[name] = values + settings.noise * swing * random.standard_normal(values.shape)
    return result
