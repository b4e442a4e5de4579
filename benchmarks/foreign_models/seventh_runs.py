"""Runs of the users of the seventh set, and how far what they hand in is from their sound model.

A run has one mistake in the drawing, line of action, model, coefficients, integration or curves; a sound
run has none.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from benchmarks.foreign_models.drawing import Drawing, Line, drawing_of, line_of_action
from benchmarks.foreign_models.integrators import FIXED
from benchmarks.foreign_models.kernels import rates, run_fixed
from benchmarks.foreign_models.model import STATES, TABLE, Model, model_of, numbers_of, table_of
from benchmarks.foreign_models.recipe import Curves, Settings, chosen, labelled, record, started

#: Steps of a mesh cycle in a sound run.
FINE = 4096
#: Trial shifts of a mesh cycle, and twice as many again around the best.
SHIFTS = 512

Motion = Callable[[Model, Settings, np.ndarray], Curves]


@dataclass(frozen=True)
class Case:
    """One record that a user hands in, the truth about it, and the file of his pair as a mapping.

    Attributes
    ----------
    number : in ``seventh_truths.md``; ``sound``: in the list of sound ones
    drawing, line, model, table, motion, curves : the mistake, in one of them
    """

    number: int
    name: str
    truth: str
    pair: Mapping[str, Any]
    settings: Settings
    drawing: Callable[[Drawing], Drawing] = field(default=lambda drawing: drawing)
    line: Callable[[Line], Line] = field(default=lambda line: line)
    model: Callable[[Model], Model] = field(default=lambda model: model)
    table: Callable[[Model, np.ndarray], np.ndarray] = field(default=lambda model, table: table)
    motion: Motion = record
    written: Callable[[Curves, Model], Curves] = field(default=lambda curves, model: curves)
    relief: bool = True
    sound: bool = False

    @property
    def unilateral(self) -> bool:
        """Whether the teeth of the sound model part."""
        return self.pair["name"] == "parting"

    @property
    def torsional(self) -> bool:
        """Whether the user models rotations alone."""
        return self.pair["name"] == "rig"

    @property
    def own_model(self) -> Model:
        drawing = self.drawing(drawing_of(self.pair))
        line = self.line(line_of_action(drawing))
        model = model_of(drawing, self.unilateral, self.torsional, line)
        if self.relief and self.pair["mesh"]["relief"] == "static":
            model = model.but(error=tip_relief(self.pair, line))
        return self.model(model)

    def curves(self) -> Curves:
        """Return "time" [s] and what the user hands in, by the names of the result datasets."""
        model = self.own_model
        table = self.table(model, touching(model, table_of(model)))
        curves = self.motion(model, self.settings, table)
        return chosen(self.written(curves, model), self.settings)

    @property
    def right(self) -> Case:
        """The case without its mistake."""
        return Case(self.number, self.name, "", self.pair, self.settings)

    @property
    def right_period(self) -> float:
        """Mesh period of the sound model [s]."""
        return self.right.own_model.period

    def sound_curves(self) -> Curves:
        """Whole mesh cycle of the sound model of the same user, all channels, from fine steps of RK4."""
        model = self.right.own_model.but(table=4 * TABLE)
        settings = Settings(samples=FINE, substeps=1, cycles=1, phase=0.0)
        return record(model, settings, touching(model, table_of(model)))


def tip_relief(pair: Mapping[str, Any], line: Line) -> Callable[[np.ndarray], np.ndarray]:
    """Material that is missing on the flanks in contact [m], over the distance from X."""
    bases = (line.base_radius_p, line.base_radius_g)
    rolls = (line.end, line.length - line.start)

    def error(xi: np.ndarray) -> np.ndarray:
        missing = np.zeros_like(xi)
        for name, base, tip, roll in zip(
            ("pinion", "gear"), bases, rolls, (xi, line.length - xi), strict=True
        ):
            relief = pair[name]["tip_relief"]
            begin = math.radians(relief["start_roll_angle"]) * base
            missing = missing + 1e-6 * relief["amount"] * np.clip((roll - begin) / (tip - begin), 0.0, None)
        return missing

    return error


def touching(model: Model, table: np.ndarray) -> np.ndarray:
    """Leave out pairs that do not touch under the mean load: the others deflect less than their gap."""
    force = model.torque / model.line.base_radius_p
    table = table.copy()
    on = table["stiffness"] > 0.0
    for _ in range(table.shape[0]):
        stiffness = np.where(on, table["stiffness"], 0.0)
        deflection = (force + (stiffness * table["error"]).sum(axis=0)) / stiffness.sum(axis=0)
        on &= table["error"] < deflection
    table["stiffness"] = np.where(on, table["stiffness"], 0.0)
    table["damping"] = np.where(on, table["damping"], 0.0)
    table["share"] = table["stiffness"] / table["stiffness"].sum(axis=0)
    return table


def by_steps(cycles: int, from_rest: bool = False) -> Motion:
    """Integrate with the fixed steps of the settings; the record starts after so many cycles.

    The run starts on the periodic motion of fine steps, or from rest without load in the mesh.
    """

    def motion(model: Model, settings: Settings, table: np.ndarray) -> Curves:
        numbers = numbers_of(model, model.torque * model.line.base_radius_g / model.line.base_radius_p)
        numbers["phase"] = settings.phase
        state, _ = started(model, numbers, table, FINE)
        if from_rest:
            state = np.zeros(STATES)
        step = model.period / settings.samples
        method, before = FIXED[settings.method], round(cycles * settings.samples)
        count = before + round(settings.cycles * settings.samples)
        states = run_fixed(method, state, 0.0, step, settings.substeps, count, numbers, table)[before:]
        times = np.arange(before, count) * step
        curves = labelled(times.copy(), states, times, numbers, table, model)
        curves["time"] = times + settings.origin
        return curves

    return motion


def by_total_rotations(cycles: int, rtol: float, atol: float) -> Motion:
    """Integrate the total angles and speeds with Dormand and Prince's 4(5), steps by its error estimate.

    The record starts after so many cycles. Deviations are the total rotations without the nominal ones.
    """

    def motion(model: Model, settings: Settings, table: np.ndarray) -> Curves:
        numbers = numbers_of(model, model.torque * model.line.base_radius_g / model.line.base_radius_p)
        numbers["phase"] = settings.phase
        start, _ = started(model, numbers, table, FINE)
        ratio = model.line.base_radius_p / model.line.base_radius_g
        nominal = np.zeros(STATES)
        nominal[:2] = model.speed, model.speed * ratio
        speeds = np.zeros(STATES)
        speeds[6:8] = nominal[:2]

        def function(time: float, state: np.ndarray) -> np.ndarray:
            out = np.empty(STATES)
            rates(time, state - nominal * time - speeds, numbers, table, out)
            result: np.ndarray = out + nominal
            return result

        step = model.period / settings.samples
        count = round(settings.cycles * settings.samples)
        times = np.arange(count) * step + cycles * model.period
        solution = solve_ivp(
            function, (0.0, times[-1]), start + speeds, "RK45", t_eval=times, rtol=rtol, atol=atol
        )
        states = solution.y.T - np.outer(times, nominal) - speeds
        curves = labelled(times.copy(), np.ascontiguousarray(states), times, numbers, table, model)
        curves["time"] = times + settings.origin
        return curves

    return motion


def without_the_loss(model: Model, settings: Settings, table: np.ndarray) -> Curves:
    """Integrate with the brake torque of gears without friction; both angles are written as they are."""
    brake = model.torque * model.line.base_radius_g / model.line.base_radius_p
    numbers = numbers_of(model, brake)
    numbers["phase"] = settings.phase
    state, _ = started(model, numbers, table, FINE)
    numbers["torque_g"] = brake
    step = model.period / settings.samples
    count = round(settings.cycles * settings.samples)
    states = run_fixed(0, state, 0.0, step, settings.substeps, count, numbers, table)
    times = np.arange(count) * step
    curves = labelled(times.copy(), states, times, numbers, table, model)
    curves["theta_p"], curves["theta_g"] = states[:, 0].copy(), states[:, 1].copy()
    curves["time"] = times + settings.origin
    return curves


@dataclass(frozen=True)
class Effect:
    """How far one channel is from the sound one.

    Attributes
    ----------
    wave : rms of the difference without the means, after the shift in time that fits all channels best, over
        the rms of the sound wave
    mean : difference of the means over the largest size of the sound curve; none for angles, whose constant
        is free
    """

    wave: float
    mean: float

    @property
    def size(self) -> float:
        """The larger of both."""
        return max(self.wave, self.mean)


def misfit(case: Case, curves: Curves | None = None) -> dict[str, Effect]:
    """Effect of a mistake on each channel that is handed in."""
    theirs = case.curves() if curves is None else curves
    right = case.sound_curves()
    period = case.right_period
    names = [name for name in theirs if name != "time"]
    sound = {name: right[name] for name in names}
    scale = {name: max(float(np.std(wave)), 1e-300) for name, wave in sound.items()}
    phase = theirs["time"] / period

    def at(name: str, shift: float) -> np.ndarray:
        return np.interp(
            (phase + shift) % 1.0, np.arange(FINE + 1) / FINE, np.r_[sound[name], sound[name][0]]
        )

    def waves(shift: float) -> dict[str, float]:
        off = {name: theirs[name] - at(name, shift) for name in names}
        return {name: float(np.std(one)) / scale[name] for name, one in off.items()}

    def total(shift: float) -> float:
        # A channel that is wrong altogether does not decide the shift.
        return sum(min(one, 0.5) ** 2 for one in waves(shift).values())

    best = min(np.arange(SHIFTS) / SHIFTS, key=total)
    for finer in (SHIFTS, 20 * SHIFTS, 400 * SHIFTS):
        best = min(best + np.arange(-20, 21) / (20 * finer), key=total)
    result = {}
    for name, wave in waves(float(best)).items():
        size = max(float(np.abs(sound[name]).max()), 1e-300)
        gap = 0.0 if name.startswith("theta") else abs(float(theirs[name].mean() - sound[name].mean())) / size
        result[name] = Effect(wave, gap)
    return result
