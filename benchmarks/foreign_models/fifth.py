"""The fifth set: forty models with one mistake each and four sound ones; the truths are in fifth_truths.md.

python -m benchmarks.foreign_models.fifth [numbers]

prints for each case how far its channels are from the sound, fine run of the same pair: change of the
peak to peak, and in shape, the complex mesh orders 1 to 40 at the best shift in
time. For the sound run it prints how far its orders are from ``spurcheck.predict``.
"""

from __future__ import annotations

import re
import sys
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import spurcheck
from benchmarks.foreign_models import fifth_mistakes as m
from benchmarks.foreign_models.cases import Case
from benchmarks.foreign_models.differences import ORDERS, SHIFTS, orders_of
from benchmarks.foreign_models.drawing import Drawing, drawing_of, line_of_action
from benchmarks.foreign_models.fifth_kernels import run_open
from benchmarks.foreign_models.fifth_pairs import LOSES_CONTACT, TORSIONAL, Pair, at
from benchmarks.foreign_models.kernels import run_fixed
from benchmarks.foreign_models.model import STATES, TABLE, Model, model_of, numbers_of, table_of
from benchmarks.foreign_models.recipe import (
    Curves,
    Settings,
    chosen,
    labelled,
    record,
    settled,
    started,
    without_drift,
)

TE = ("dte",)
X = ("x_p", "x_g")
Y = ("y_p", "y_g")
ANGLES = ("theta_p", "theta_g")
FORCES_X = ("bearing_force_x_p", "bearing_force_x_g")
FORCES_Y = ("bearing_force_y_p", "bearing_force_y_g")
TEETH = ("normal_load", "friction_force")
MESH = ("mesh_force",)
DISPLACEMENTS = (*ANGLES, *X, *Y)

#: Mesh cycles from rest to the periodic motion where no shooting finds it, of RK4 with small steps.
LONG = 600
#: Mesh cycles that the user waits who does not wait for the periodic motion.
WAITED = 4


@dataclass(frozen=True)
class Fifth:
    """One user: a call makes his record.

    A mistake changes one of the drawing, the model, the table of coefficients, the way he integrates and the
    exported curves; ``run`` integrates other equations.
    """

    pair_name: str
    channels: tuple[str, ...]
    changes: Mapping[str, Any] = field(default_factory=dict)
    settings: Settings = Settings()  # noqa: RUF009 - frozen
    drawing: Callable[[Drawing], Drawing] | None = None
    model: Callable[[Model], Model] | None = None
    table: Callable[[np.ndarray], np.ndarray] | None = None
    curves: Callable[[Curves, Model], Curves] | None = None
    run: Callable[[Model, Settings], Curves] | None = None
    numerics: Mapping[str, Any] = field(default_factory=dict)
    touching: bool = False

    @property
    def pair(self) -> Pair:
        return at(self.pair_name, self.changes)

    def built(self, wrong: bool, table: int = TABLE) -> Model:
        """Return the model of the user, with or without the mistake."""
        drawing = drawing_of(self.pair)
        if wrong and self.drawing is not None:
            drawing = self.drawing(drawing)
        line = line_of_action(drawing)
        unilateral = self.pair_name in LOSES_CONTACT and not self.touching
        model = model_of(drawing, unilateral, self.pair_name in TORSIONAL, line).but(table=table)
        if self.pair["mesh"]["relief"] == "static":
            model = model.but(error=m.relief_error(drawing, line))
        return self.model(model) if wrong and self.model is not None else model

    def __call__(self) -> Curves:
        model = self.built(wrong=True)
        settings = replace(self.settings, channels=self.channels, **self.numerics)
        table = table_of(model)
        if self.table is not None:
            table = self.table(table)
        curves = record(model, settings, table) if self.run is None else self.run(model, settings)
        if self.curves is not None:
            curves = self.curves(curves, model)
        return chosen(curves, settings)

    def sound(self, phase: float) -> tuple[Curves, float]:
        """Return the record without mistake and noise, 4096 steps of RK4 a cycle, and its period [s]."""
        model = self.built(wrong=False, table=4 * TABLE)
        settings = Settings(samples=512, substeps=8, cycles=2, phase=phase, channels=self.channels)
        return chosen(record(model, settings), settings), model.period


def with_open_damper(model: Model, settings: Settings) -> Curves:
    """The record of the user whose damper acts on across the gap, after a long run from rest."""
    table = table_of(model)
    numbers = numbers_of(model, model.torque * model.line.base_radius_g / model.line.base_radius_p)
    step = model.period / settings.samples
    count = int(settings.cycles * settings.samples)
    start = settled(numbers, table, replace(settings, settle=1), step)
    before = LONG * int(settings.samples)
    states, force = run_open(start, step, settings.substeps, before + count, numbers, table)
    times = np.arange(count) * step
    curves = labelled(times, states[before:], times, numbers, table, model)
    without_drift(curves, model)
    return curves | {"mesh_force": force[before:], "time": times + settings.origin}


def from_rest(model: Model, settings: Settings) -> Curves:
    """The record of the user who applies the torque at once to gears at rest and waits four mesh cycles."""
    table = table_of(model)
    numbers = numbers_of(model, model.torque * model.line.base_radius_g / model.line.base_radius_p)
    numbers["phase"] = settings.phase
    steps = int(settings.samples) * settings.substeps
    started(model, numbers, table, steps)
    step, count = model.period / settings.samples, int(settings.cycles * settings.samples)
    before = WAITED * int(settings.samples)
    states = run_fixed(0, np.zeros(STATES), 0.0, step, settings.substeps, before + count, numbers, table)
    times = np.arange(count) * step
    return labelled(times + settings.origin, states[before:], times, numbers, table, model)


def _run(samples: float, cycles: float, phase: float = 0.0, **more: Any) -> Settings:
    return Settings(samples=samples, cycles=cycles, phase=phase, **more)


WRONG: tuple[Fifth, ...] = (
    # Inputs and geometry
    Fifth("fan", TE, settings=_run(400, 4, 0.2), model=m.width_of_the_pinion),
    Fifth("fan", (*TE, *FORCES_X, *FORCES_Y), settings=_run(512, 3), drawing=m.shifts_exchanged),
    Fifth("overdrive", (*TE, *MESH), settings=_run(360, 5, 0.4), drawing=m.reference_centre_distance),
    Fifth("overdrive", DISPLACEMENTS, settings=_run(400, 4, 0.1), drawing=m.tips_without_shift),
    Fifth("pump", (*TE, *TEETH), settings=_run(512, 3, 0.7), drawing=m.tips_not_shortened),
    Fifth("servo", (*TE, *X), settings=_run(320, 6), drawing=m.twenty_degrees),
    Fifth("fan", (*TE, *ANGLES), settings=_run(400, 4, 0.5), model=m.inertia_as_gd2),
    Fifth("bronze", (*TE, *FORCES_X), settings=_run(500, 3, 0.3), drawing=m.torque_of_the_gear_shaft),
    Fifth("spindle", (*TE, *MESH), settings=_run(256, 6), drawing=m.speed_of_the_gear_shaft),
    Fifth("inverse", (*X, *Y), settings=_run(400, 4, 0.6), drawing=m.bearings_doubled),
    Fifth("bronze", TE, settings=_run(450, 4), drawing=m.wheel_of_steel),
    Fifth("efficiency_rig", (*TE, *Y), settings=_run(400, 4, 0.8), drawing=m.rz_for_ra),
    Fifth("inverse", (*TE, *FORCES_Y), settings=_run(512, 3, 0.1), drawing=m.kinematic_viscosity),
    Fifth("relieved", (*TE, *MESH), settings=_run(400, 4), model=m.relief_of_the_pinion_alone),
    # Physics
    Fifth("test_rig", (*TE, *MESH), settings=_run(400, 5, 0.2), model=m.mean_mesh_stiffness_for_a_pair),
    Fifth("mill", (*TE, *FORCES_X, *FORCES_Y), settings=_run(600, 3), table=m.friction_of_half_the_force),
    Fifth("long_teeth", (*TE, *TEETH), settings=_run(400, 4, 0.3), table=m.two_pairs_at_most),
    Fifth("pump", (*TE, *X, *Y), settings=_run(480, 4), model=m.reversal_in_the_middle),
    Fifth("test_rig", (*TE, *ANGLES), settings=_run(400, 4, 0.9), model=m.mass_of_translation),
    Fifth("fan", (*FORCES_X, *FORCES_Y), settings=_run(400, 4, 0.4), model=m.structural_bearing_damping),
    Fifth(
        "overdrive",
        (*TE, *X),
        settings=_run(400, 4, 0.2),
        model=m.no_bearing_deflection_in_the_mesh,
        curves=m.without_bearing_deflection,
    ),
    Fifth("light", (*TE, *MESH), settings=_run(512, 4), run=with_open_damper),
    Fifth("spindle", (*TE, *MESH), settings=_run(300, 5, 0.5), model=m.gear_at_constant_speed),
    Fifth("servo", (*TE, *MESH), settings=_run(400, 4, 0.1), model=m.impact_exponent),
    Fifth("relieved", (*TE, *TEETH), settings=_run(400, 3, 0.6), model=m.tanh_of_sliding),
    Fifth("efficiency_rig", (*Y, *TE), settings=_run(400, 4), model=m.mean_of_rolling_velocities),
    Fifth("mill", (*TE, *MESH, *X), settings=_run(500, 3, 0.3), model=m.peak_at_the_pitch_point),
    # Numerics, conventions, export
    Fifth(
        "light",
        TE,
        changes={"mesh__damping_ratio": 0.08, "operating__pinion_speed": 5200.0},
        settings=_run(512, 6),
        numerics={"method": "backward_euler", "samples": 48, "substeps": 1, "settle": 200},
        touching=True,
    ),
    Fifth("fan", (*TE, *X), settings=_run(400, 5), run=from_rest),
    Fifth(
        "bronze",
        (*TE, *X),
        settings=_run(400, 4, 0.7),
        model=lambda model: model.but(total=m.three_harmonics),
    ),
    Fifth(
        "long_teeth",
        (*TE, *FORCES_X),
        settings=_run(400, 4),
        model=lambda model: model.but(total=m.ten_points),
    ),
    Fifth("servo", (*TE, *Y), settings=_run(400, 4, 0.4), model=m.stiffness_from_the_pitch_point),
    Fifth("test_rig", (*TE, *MESH), settings=_run(512, 4, 0.6), curves=m.at_the_pitch_radius),
    Fifth("fan", (*X, *Y, *FORCES_X, *FORCES_Y), settings=_run(400, 4), curves=m.on_the_housing),
    Fifth("spindle", (*TE, *FORCES_X), settings=_run(36, 8, substeps=64), curves=m.microseconds),
    Fifth("pump", (*TE, *MESH), settings=_run(400, 4), curves=m.low_pass),
    Fifth("inverse", (*TE, *X, *Y), settings=_run(400, 4, 0.3), curves=m.frame_of_the_housing),
    Fifth(
        "relieved",
        (*TE, *DISPLACEMENTS),
        settings=_run(400, 4, 0.2),
        curves=m.gear_angle_in_the_sense_of_the_pinion,
    ),
    Fifth("mill", (*TE, *X, *Y), settings=_run(500, 3), curves=m.without_bearing_deflection),
    Fifth("long_teeth", (*TE, *X), settings=_run(400, 4, 0.8), curves=m.single_precision),
)

SOUND: tuple[Fifth, ...] = (
    Fifth("servo", (*TE, *FORCES_X, *FORCES_Y), settings=_run(353, 3.4, 0.37, substeps=6, origin=0.2)),
    Fifth("long_teeth", (*DISPLACEMENTS, *TE), settings=_run(800, 3, 0.6, method="newmark", substeps=2)),
    Fifth("light", (*TE, *MESH, *X), settings=_run(640, 5, noise=0.005, seed=5)),
    Fifth("relieved", (*MESH, *TE, *TEETH), settings=_run(1024, 4, 0.15, method="heun", substeps=8)),
)


@cache
def truths() -> dict[int, str]:
    """Return the sentences of fifth_truths.md by number."""
    text = (Path(__file__).parent / "fifth_truths.md").read_text(encoding="utf-8")
    return {int(number): words for number, words in re.findall(r"^(\d+)\. (.*)$", text, re.MULTILINE)}


def judging(kind: str | None = None) -> list[Case]:
    """Return the cases of the fifth set, of a kind ("sound" or "wrong") or all."""
    wrong = [
        Case(f"fifth {n:02d}", "wrong", (truths()[n],), one.pair, one) for n, one in enumerate(WRONG, start=1)
    ]
    sound = [Case(f"fifth sound {n}", "sound", (), one.pair, one) for n, one in enumerate(SOUND, start=1)]
    return [case for case in (*sound, *wrong) if kind in (None, case.kind)]


class Off(NamedTuple):
    """Change of the peak to peak, and of the shape, of a channel over a reference."""

    peak_to_peak: float
    shape: float


def off(
    record: Mapping[str, Any], reference: Mapping[str, Any], names: tuple[str, ...], period: float
) -> dict[str, Off]:
    """Return how far the channels of a record are from a reference of this period [s]."""
    mine = {name: orders_of(record["time"], record[name], period)[:, 1:] for name in names}
    theirs = {name: orders_of(reference["time"], reference[name], period)[:, 1:] for name in names}
    turns = np.exp(2j * np.pi * np.outer(np.arange(SHIFTS) / SHIFTS, np.arange(1, ORDERS + 1)))
    sizes = {name: np.linalg.norm(theirs[name]) for name in names}
    far = {
        name: np.array([np.linalg.norm(mine[name] - theirs[name] * turn) for turn in turns]) / sizes[name]
        for name in names
    }
    best = int(np.argmin(sum(values**2 for values in far.values())))
    swings = {name: np.ptp(reference[name], axis=-1).max() for name in names}
    return {
        name: Off(float(np.ptp(record[name], axis=-1).max() / swings[name] - 1.0), float(far[name][best]))
        for name in names
    }


def predicted(pair: Pair, names: tuple[str, ...]) -> Curves:
    """Return the channels of ``spurcheck.predict``."""
    cycle = spurcheck.predict(pair).cycle
    curves = {"time": cycle["time"].to_numpy()}
    for name in names:
        values = cycle["normal_load"].sum("pair") if name == "mesh_force" else cycle[name]
        curves[name] = values.transpose(..., "time").to_numpy()
    return curves


def main(arguments: list[str]) -> None:
    """Print how far each case is from its sound run, and the sound run from the prediction [%]."""
    warnings.simplefilter("ignore")
    print("| case | pair | sound run to prediction | case to sound run: peak to peak, shape |")
    print("|---|---|---|---|")
    chosen_cases = [case for case in judging() if not arguments or case.name.split()[-1] in arguments]
    for case in chosen_cases:
        one = case.curves
        assert isinstance(one, Fifth)
        sound, period = one.sound(0.0)
        agreed = off(sound, predicted(one.pair, one.channels), one.channels, period)
        sound, _ = one.sound(one.settings.phase)
        channel, worst = max(agreed.items(), key=lambda item: item[1].shape)
        cells = ", ".join(
            f"{name} {100 * far.peak_to_peak:+.0f}, {100 * far.shape:.0f}"
            for name, far in off(one(), sound, one.channels, period).items()
        )
        print(f"| {case.name} | {one.pair_name} | {channel} {100 * worst.shape:.2f} | {cells} |", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
