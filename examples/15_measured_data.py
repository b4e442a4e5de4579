"""
Which friction coefficient do my measurements show?
===================================================

A record of normal and friction forces is aligned by mesh phase and laid over the prediction; the coefficient
comes with a confidence interval. The record is computed, with 2 % noise, so that the truth is known; yours
is a CSV file beside a small TOML file.
"""

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

import lumped
from validation.measurements import Evaluation, Measurement, MeasurementSpec, Prediction, evaluate, predict

TRUE_MU = 0.04


@dataclass
class Result:
    """The evaluated record and the coefficient that made it."""

    evaluation: Evaluation
    truth: float = TRUE_MU


def measured(truth: Prediction) -> Measurement:
    """Forces of one gauged tooth pair over six revolutions, from 0.37 mesh cycles after its start on."""
    cycles = np.arange(0.0, 6 * 28, 1 / 100.3)
    rng = np.random.default_rng(4)
    channels = {}
    entries = []
    for name in ("normal_load", "friction_force"):
        force = truth.value(name, 0.37 + cycles, "A")
        entries.append({"name": name, "column": name, "quantity": name, "unit": "N", "pair": "A"})
        entries[-1]["noise"] = noise = 0.02 * float(np.abs(force).max())
        channels[name] = force + noise * rng.standard_normal(cycles.size)
    spec = MeasurementSpec(
        name="tooth forces", source="computed", pinion_speed="800 rpm", pinion_torque="79.1 N*m",
        abscissa={"kind": "time", "column": "t", "unit": "s"}, channel=entries,
    )  # fmt: skip
    times = cycles * truth.geometry.mesh_period
    noises = {one.name: one.noise for one in spec.channel}
    return Measurement(spec, times, channels, noises)


def compute() -> Result:
    """Identify a constant coefficient of the 28/28 pair at 79.1 N m, 800 rpm, predicted with mu = 0.08."""
    operating = {"operating.pinion_torque": 79.1, "operating.pinion_speed": 800.0, "friction.law": "coulomb"}
    pair = lumped.load_gear_pair("nasa_28_28").with_(operating)
    truth = predict(pair.with_(friction__coefficient=TRUE_MU))
    return Result(evaluate(measured(truth), pair.with_(friction__coefficient=0.08), identify=["mu"]))


def draw(result: Result) -> Figure:
    """Measured friction force as points, predicted one as a line."""
    (identified,) = result.evaluation.found
    band = result.evaluation.points.sel(channel="friction_force")
    figure = Figure(figsize=(7, 4), layout="constrained")
    axes = figure.add_subplot()
    axes.plot(band["phase"], band["measured"], ".", label="measured")
    axes.plot(band["phase"], band["predicted"], "-", label="predicted, mu 0.08")
    axes.set(xlabel="mesh cycles since start of contact [-]", ylabel="friction force [N]")
    axes.set_title(identified.text.split(" (")[0])
    axes.legend()
    return figure


if __name__ == "__main__":
    draw(compute()).savefig("measured_data.png", dpi=150)
