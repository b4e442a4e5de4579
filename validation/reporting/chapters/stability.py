"""Stability of the motion at the operating point, over speed and over damping."""

from __future__ import annotations

import math

import numpy as np

from lumped.labelling import labelled_dataset
from validation.files.formatting import number
from validation.plots.stability import stability_figure
from validation.reporting.blocks import Content, Picture, quantities
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results


def write(results: Results) -> Content:
    """Write the chapter."""
    chart = results.chart
    here = results.multipliers
    low, high = (number(speed, 5) for speed in results.speeds)
    share = float(np.mean(results.stability_line < 0))
    some = "no speed" if share == 0.0 else f"{100 * share:.2g} % of the speeds"
    result = (
        f"At the operating point the linear motion is {here.verdict}; at the given damping {some} from {low} "
        f"to {high} rpm {'is' if some == 'no speed' else 'are'} unstable"
        f"{results.on_springs}."
    )
    margin = results.nearest_hazard
    damping = results.pair.mesh.damping_ratio
    edge = chart.attrs["nearest_edge_damping_ratio"]
    thinnest = chart.attrs["thinnest_width"]
    table = quantities(
        "stability",
        "Stability of the linear motion.",
        (
            "largest Floquet multiplier",
            here.spectral_radius,
            "1",
            f"error at most {here.error:.1e}: {here.verdict}",
        ),
        ("a disturbance is halved in", np.log(0.5) / np.log(here.spectral_radius), "1", "mesh cycles"),
        ("mesh damping ratio", damping, "1"),
        *(
            []
            if math.isnan(edge)
            else [("stability changes at", edge, "1", "mesh damping ratio, this speed")]
        ),
        *([("nearest hazard", margin.speed_rpm, "rpm", margin.words)] if margin is not None else []),
        ("unstable share of the chart", float((chart["verdict"] < 0).mean()), "1", "of speeds and dampings"),
        *([] if math.isnan(thinnest) else [("thinnest tongue", thinnest, "rpm", "at its widest")]),
    )
    words = (
        "How fast a disturbance grows or decays over speed and mesh damping. Black line: edge of "
        f"instability. {number(100 * float(chart['known'].mean()), 2)} % of the nodes are evaluated: the "
        "lowest damping and both sides of every edge. A region can only be missed that lies between "
        "evaluated nodes and does not reach the lowest damping. All nodes are in stability.nc."
    )
    at = {"speed_rpm": results.operating_rpm, "damping_ratio": damping}
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
        result, (table, Picture("stability_chart", words, regions, lambda _: stability_figure(chart, at)))
    )


CHAPTER = Chapter("stability", "Stability", write, seconds=1.5)
