"""Stability of the motion at the operating point, over speed and over damping."""

from __future__ import annotations

from functools import partial

import numpy as np

from lumped.labelling import labelled_dataset
from validation.files.formatting import number
from validation.plots.maps import stability_map_figure
from validation.reporting.blocks import Content, Picture, quantities
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results


def write(results: Results) -> Content:
    """Write the chapter."""
    chart, here = results.chart, results.multipliers
    dims = ("speed_rpm", "damping_ratio")
    radius = chart["spectral_radius"].transpose(*dims).to_numpy()
    data = labelled_dataset(
        {
            "growth": (
                dims,
                np.log(np.maximum(radius, 1e-12)),
                "1",
                "growth of a disturbance per mesh cycle",
            ),
            "verdict": (dims, chart["verdict"].transpose(*dims).to_numpy(), "1", "1 stable, -1 unstable"),
        },
        {
            name: (chart[name].to_numpy(), chart[name].attrs["units"], chart[name].attrs["long_name"])
            for name in dims
        },
    )
    unstable = float((chart["verdict"] < 0).mean())
    line = results.stability_line["verdict"].to_numpy()
    low, high = (number(speed, 5) for speed in results.speeds)
    damping = results.pair.mesh.damping_ratio
    none = (
        "no speed" if not results.unstable_speeds.size else f"{100 * np.mean(line < 0):.2g} % of the speeds"
    )
    result = (
        f"At the operating point the linear motion is {here.verdict}; at the given damping {none} from {low} "
        f"to {high} rpm {'is' if none == 'no speed' else 'are'} unstable."
    )
    margin = results.nearest_hazard
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
        *([("nearest hazard", margin[0], "rpm", margin[1])] if margin is not None else []),
        ("unstable share of the chart", unstable, "1", "of speeds and dampings shown"),
    )
    return Content(
        result,
        (
            table,
            Picture(
                "stability_chart",
                "How fast a disturbance decays over speed and mesh damping. Red line: edge of instability. "
                "Circle: the operating point.",
                data,
                partial(stability_map_figure, point=(results.operating_rpm, damping)),
            ),
        ),
    )


CHAPTER = Chapter("stability", "Stability", write, seconds=1.5)
