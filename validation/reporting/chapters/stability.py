"""Floquet stability at the operating point and over speed and damping."""

from __future__ import annotations

import numpy as np
from scipy.optimize import linear_sum_assignment

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
from validation.reporting.checks import check_table
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
        *_routes(results),
    ]
    return Content(tuple(blocks), _badge(results), {"stability_chart": chart})


def _routes(results: Results) -> tuple[Block, ...]:
    """The multipliers, beside those of the same states by a second route."""
    found, routes = results.multipliers, results.routes
    rows: Rows = []
    parts = (("mesh: q, x_p, x_g", found.feedback, "feedback"), ("bearings: y_p, y_g", found.oloa, "oloa"))
    for part, values, name in parts:
        # By size, and of two of one size in an order that rounding cannot change.
        ours = np.array(sorted(values, key=lambda v: (-round(abs(v), 9), -round(v.real, 9), -v.imag)))
        theirs = np.full(ours.size, np.nan + 0j)
        if not isinstance(routes, str):
            other = getattr(routes, name)
            nearest = linear_sum_assignment(np.abs(np.subtract.outer(ours, other)))[1]
            theirs = other[nearest]
        rows += [
            (part, *map(float, (a.real, a.imag, abs(a), b.real, b.imag, abs(a - b))))
            for a, b in zip(ours, theirs, strict=True)
        ]
    return (
        Text(
            "The multipliers are computed by two routes that share no code but the laws of the tooth pairs. "
            "In the first the compiled kernel of the chart propagates z'' + D z' + L z + w (v·z) + wd (v·z') "
            "= 0 by Taylor series, and those of the bearings have a closed form. In the second the multibody "
            "model at fidelity linear runs in exudyn from perturbed states over one mesh cycle."
        ),
        Table(
            "multipliers_table",
            "Multipliers at the operating point.",
            {
                "part": "states",
                "real": "real part",
                "imag": "imaginary part",
                "modulus": "modulus",
                "flow_real": "real part, multibody",
                "flow_imag": "imaginary part, multibody",
                "error": "distance",
            },
            tuple(rows),
            note="Where two multipliers nearly meet, a small error of the matrix moves them far apart. The "
            "verdict is therefore on the coefficients of their characteristic polynomial, and on the whole "
            "matrix.",
        ),
        Text(f"The second route cannot be computed: {routes}")
        if isinstance(routes, str)
        else check_table("routes", "The two routes compared.", routes.checks),
    )


def _badge(results: Results) -> Badge:
    """The verdict, which a second route must not contradict."""
    routes, verdict = results.routes, results.multipliers.verdict
    if isinstance(routes, str) or routes.agree:
        return Badge(verdict)
    return Badge("not confirmed", f"{verdict} by one route, not confirmed by the other")


def answer(results: Results) -> Answer:
    """Whether the periodic motion is stable at the operating point, and at which other speeds."""
    badge = Badge("stable") if words.confirmed_parting(results) else _badge(results)
    return Answer("Is the motion stable?", badge, words.stability(results))


CHAPTER = Chapter("stability", "Stability", write, answer, ("stability_chart",), seconds=3)
