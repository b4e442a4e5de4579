"""Floquet stability at the operating point and over speed and damping."""

from __future__ import annotations

import numpy as np

from floquet.gear.axes import chart_axes
from floquet.gear.chart import stability_chart
from validation.plots.stability import multipliers_figure, stability_figure
from validation.reporting import words
from validation.reporting.blocks import (
    Answer,
    Badge,
    Block,
    Content,
    Picture,
    Quantity,
    Rows,
    Table,
    Text,
    facts,
)
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results


def write(results: Results) -> Content:
    """Write the chapter."""
    pair, found, m = results.pair, results.multipliers, results.margins
    effort = results.effort
    chart = stability_chart(
        pair,
        chart_axes(pair, effort.chart_speeds, effort.chart_dampings),
        rtol=effort.chart_rtol,
        store="radius",
        progress=results.stage("stability chart"),
    )
    here = chart.sel(damping_ratio=pair.mesh.damping_ratio, method="nearest")
    speeds, dampings = chart["speed_rpm"].to_numpy(), chart["damping_ratio"].to_numpy()
    radii = here["spectral_radius"].to_numpy()
    margins = facts(
        "margins",
        ("verdict", "verdict at the operating point", Badge(found.verdict)),
        ("spectral_radius", "largest multiplier", found.spectral_radius, "", "stable below 1"),
        ("error", "bound on its error", found.error, "", found.certificate),
        (
            "decay",
            "margin 1 - spectral radius",
            1.0 - found.spectral_radius,
            "",
            "share of a disturbance that dies per mesh cycle",
        ),
        (
            "liouville_residual",
            "Liouville residual",
            found.liouville_residual,
            "",
            "det M = exp ∫ tr A dt holds to this",
        ),
        (
            "stable_speeds",
            "stable speeds at this damping",
            int((here["verdict"].to_numpy() == 1).sum()),
            "",
            f"of {speeds.size} in the chart",
        ),
        (
            "largest_radius",
            "largest multiplier over speed",
            float(radii.max()),
            "",
            f"at {speeds[np.argmax(radii)]:.5g} rpm",
        ),
        (
            "nearest_unstable_speed",
            "nearest unstable speed at this damping",
            "none in the range" if m.nearest_unstable is None else Quantity(m.nearest_unstable, "rpm"),
        ),
        (
            "critical_damping",
            "mesh damping ratio that makes every speed stable",
            m.critical_damping if m.tongues else "none needed",
            "",
            f"this pair has {pair.mesh.damping_ratio:g}",
        ),
        ("step_speed", "chart step, speed", float(np.diff(speeds).max()), "rpm"),
        ("step_damping", "chart step, damping ratio", float(np.diff(dampings).max())),
    )
    blocks: list[Block] = [
        margins,
        Picture(
            "stability_chart",
            "Spectral radius over pinion speed and mesh damping ratio, all else as given. Orange with a "
            "black edge: unstable, named by mode pair and order. Every node carries an error bound "
            f"({chart.attrs['certificate']}).",
            lambda: stability_figure(
                chart, {"speed_rpm": m.rpm, "damping_ratio": pair.mesh.damping_ratio}, m.tongues
            ),
        ),
        Text(
            "The chart decides at its nodes; a tongue narrower than its step can lie between them. The "
            "distances above, and the next chapter, come from tongues traced by root finding, whatever the "
            "step."
        ),
        Picture(
            "multipliers",
            "Floquet multipliers at the operating point: inside the unit circle a disturbance dies. The "
            "free rotation of the pair is a double multiplier at +1 by nature and is taken out.",
            lambda: multipliers_figure(found),
        ),
        _multipliers(results),
    ]
    return Content(tuple(blocks), Badge(found.verdict), {"stability_chart": chart})


def _multipliers(results: Results) -> Table:
    """Every multiplier, by size; of two of one size in an order that rounding cannot change."""
    found = results.multipliers
    rows: Rows = []
    for part, values in (("mesh: q, x_p, x_g", found.feedback), ("bearings: y_p, y_g", found.oloa)):
        ordered = sorted(values, key=lambda v: (-round(abs(v), 9), -round(v.real, 9), -v.imag))
        rows += [(part, float(v.real), float(v.imag), float(abs(v))) for v in ordered]
    return Table(
        "multipliers_table",
        "Multipliers at the operating point.",
        {"part": "states", "real": "real part", "imag": "imaginary part", "modulus": "modulus"},
        tuple(rows),
    )


def answer(results: Results) -> Answer:
    """Whether the periodic motion is stable at the operating point, and at which other speeds."""
    badge = Badge("stable" if words.confirmed_contact_loss(results) else results.multipliers.verdict)
    return Answer("Is the motion stable?", badge, words.stability(results))


CHAPTER = Chapter("stability", "Stability", write, answer, ("stability_chart",), seconds=3)
