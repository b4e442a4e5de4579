"""
Which friction coefficient do my measurements show?
===================================================

A record of normal and friction forces is aligned by mesh phase and laid over the prediction; the coefficient
comes with a confidence interval. The record is synthetic, with 2 % noise, so that the truth is known; yours
is a CSV file beside a small TOML file, see ``spurcheck measurement --help``.
"""

from dataclasses import dataclass

from matplotlib.figure import Figure

import lumped
from validation.measurements import Evaluation, evaluate, predict, synthetic_measurement

TRUE_MU = 0.04


@dataclass
class Result:
    """The evaluated record and the coefficient that made it."""

    evaluation: Evaluation
    truth: float = TRUE_MU


def compute() -> Result:
    """Identify a constant coefficient of the 28/28 pair at 79.1 N m, 800 rpm, predicted with mu = 0.08."""
    operating = {"operating.pinion_torque": 79.1, "operating.pinion_speed": 800.0, "friction.law": "coulomb"}
    pair = lumped.load_gear_pair("nasa_28_28").with_(operating)
    truth = predict(pair.with_(friction__coefficient=TRUE_MU))
    record = synthetic_measurement(truth, seed=4, engagements=6, start=0.37)
    return Result(evaluate(record, pair.with_(friction__coefficient=0.08), identify=["mu"]))


def draw(result: Result) -> Figure:
    """Measured friction forces of both tooth pairs as points, predicted ones as lines."""
    points, (found,) = result.evaluation.points, result.evaluation.found
    figure = Figure(figsize=(7, 4), layout="constrained")
    axes = figure.add_subplot()
    for name, colour in (("friction_A", "tab:blue"), ("friction_B", "tab:orange")):
        band = points.sel(channel=name)
        axes.plot(band["phase"], band["measured"], ".", color=colour, label=f"{name[-1]} measured")
        axes.plot(band["phase"], band["predicted"], "-", color=colour, label=f"{name[-1]} predicted, mu 0.08")
    axes.set(
        xlabel="mesh cycles since start of contact [-]",
        ylabel="friction force [N]",
        title=found.text.split(" (")[0],
    )
    axes.legend()
    return figure


if __name__ == "__main__":
    draw(compute()).savefig("measured_data.png", dpi=150)
