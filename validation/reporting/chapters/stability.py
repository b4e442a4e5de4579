"""Stability of the motion at the operating point, over speed and over damping."""

from __future__ import annotations

import math

import numpy as np

from lumped.labelling import labelled_dataset
from validation.files.formatting import number
from validation.plots.stability import stability_figure
from validation.reporting.blocks import Content, NamedNumber, Picture, Table, named_numbers
from validation.reporting.chapter import Chapter
from validation.reporting.facts import proof_words, rpm
from validation.reporting.results import Results


def write(results: Results) -> Content:
    """Write the chapter."""
    chart = results.chart
    multipliers = results.multipliers
    low, high = (number(speed, 5) for speed in results.speeds)
    share = float(np.mean(results.stability_line < 0))
    some = f"no speed from {low} to {high} rpm is unstable"
    if share > 0.0:
        some = f"{100 * share:.2g} % of the speeds from {low} to {high} rpm are unstable"
    elif not math.isnan(results.unstable_rpm):
        some = f"{rpm(results.unstable_rpm)} is unstable"
    proof = proof_words(results)
    result = (
        f"At the operating point the linear motion is {multipliers.verdict_words}; at the given damping "
        f"{some}{results.on_springs}. {proof[0].upper()}{proof[1:]}."
    )
    damping = results.pair.mesh.damping_ratio
    words = (
        "How fast a disturbance grows or decays over speed and mesh damping. Black line: edge of "
        f"instability. {number(100 * float(chart['known'].mean()), 2)} % of the nodes are evaluated: the "
        "lowest damping and both sides of every edge. An unstable region that is narrower than the grid may "
        "be missed. All nodes are in stability.nc."
    )
    operating_point = {"speed_rpm": results.operating_rpm, "damping_ratio": damping}
    regions = labelled_dataset(
        {
            str(name).removeprefix("region_"): (
                "region",
                values.to_numpy(),
                values.attrs["units"],
                values.attrs["long_name"],
            )
            for name, values in chart.data_vars.items()
            if values.dims == ("region",)
        },
        {"region": (chart["region_label"].to_numpy(), "1", "label, w: natural frequencies")},
    )
    return Content(
        result,
        (
            _stability_table(results),
            Picture("stability_chart", words, regions, lambda _: stability_figure(chart, operating_point)),
        ),
    )


def _stability_table(results: Results) -> Table:
    chart = results.chart
    multipliers = results.multipliers
    radius = multipliers.spectral_radius
    error = f"error at most {multipliers.error:.1e}: {multipliers.verdict_words}"
    numbers = [NamedNumber("largest Floquet multiplier", radius, "1", error)]
    if not multipliers.neutral:  # else no disturbance dies out
        cycles = np.log(0.5) / np.log(radius)
        numbers.append(NamedNumber("a disturbance is halved in", cycles, "1", "mesh cycles"))
    numbers.append(NamedNumber("mesh damping ratio", results.pair.mesh.damping_ratio, "1"))
    edge = chart.attrs["nearest_edge_damping_ratio"]
    if not math.isnan(edge):
        numbers.append(NamedNumber("stability changes at", edge, "1", "mesh damping ratio, this speed"))
    hazard = results.nearest_hazard
    if hazard is not None:
        numbers.append(NamedNumber("nearest hazard", hazard.speed_rpm, "rpm", hazard.words))
    unstable = float((chart["verdict"] < 0).mean())
    numbers.append(NamedNumber("unstable share of the chart", unstable, "1", "of speeds and dampings"))
    thinnest = chart.attrs["thinnest_width"]
    if not math.isnan(thinnest):
        numbers.append(NamedNumber("thinnest tongue", thinnest, "rpm", "at its widest"))
    return named_numbers("stability", "Stability of the linear motion.", numbers)


CHAPTER = Chapter("stability", "Stability", write, seconds=1.5)
