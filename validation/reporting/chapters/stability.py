"""Floquet stability at the operating point and over speed and damping."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from validation import plots
from validation.reporting.blocks import (
    Badge,
    Block,
    Cell,
    Chapter,
    Column,
    Fact,
    Facts,
    Picture,
    Quantity,
    Table,
    Text,
)
from validation.reporting.results import Results


@dataclass(frozen=True)
class Margins:
    """Distances to instability, as far as the nodes of a chart resolve them.

    Attributes
    ----------
    decay : 1 - spectral radius at the operating point: share of a disturbance that dies per mesh cycle
    nearest_rpm : nearest unstable speed at the operating damping [rpm]; None: no node is unstable
    critical_damping : largest mesh damping ratio with an unstable speed in the range; None: not even zero
    stable_speeds, speeds : nodes at the operating damping that are stable, and all
    largest_radius, largest_radius_rpm : largest spectral radius at the operating damping, and its speed
    """

    decay: float
    nearest_rpm: float | None
    critical_damping: float | None
    stable_speeds: int
    speeds: int
    largest_radius: float
    largest_radius_rpm: float


def margins(chart: xr.Dataset, rpm: float, damping: float) -> Margins:
    """Read the margins of an operating point that is a node of a chart over speed_rpm and damping_ratio."""
    at_damping = chart.sel(damping_ratio=damping, method="nearest")
    stable = at_damping["verdict"].to_numpy() == 1
    speeds = chart["speed_rpm"].to_numpy()
    radius = at_damping["spectral_radius"].to_numpy()
    unstable = speeds[~stable]
    by_damping = (chart["verdict"] != 1).any("speed_rpm").to_numpy()
    critical = chart["damping_ratio"].to_numpy()[by_damping]
    here = chart.sel(speed_rpm=rpm, damping_ratio=damping, method="nearest")
    return Margins(
        decay=1.0 - float(here["spectral_radius"]),
        nearest_rpm=float(unstable[np.argmin(np.abs(unstable - rpm))]) if unstable.size else None,
        critical_damping=float(critical.max()) if critical.size else None,
        stable_speeds=int(stable.sum()),
        speeds=int(speeds.size),
        largest_radius=float(radius.max()),
        largest_radius_rpm=float(speeds[int(np.argmax(radius))]),
    )


def stability(results: Results) -> Chapter:
    """Write the chapter."""
    chart, found, pair = results.chart, results.multipliers, results.pair
    m = margins(chart, results.operating_rpm, pair.mesh.damping_ratio)
    speeds, dampings = chart["speed_rpm"].to_numpy(), chart["damping_ratio"].to_numpy()
    facts = Facts(
        "margins",
        (
            Fact("verdict", "verdict at the operating point", Badge(found.verdict)),
            Fact("spectral_radius", "largest multiplier", found.spectral_radius, "stable below 1"),
            Fact("error", "bound on its error", found.error),
            Fact(
                "decay",
                "margin 1 - spectral radius",
                m.decay,
                "share of a disturbance that dies per mesh cycle",
            ),
            Fact(
                "liouville_residual",
                "Liouville residual",
                found.liouville_residual,
                "det M = exp ∫ tr A dt holds to this",
            ),
            Fact(
                "stable_speeds",
                "stable speeds at this damping",
                m.stable_speeds,
                f"of {m.speeds} in the chart",
            ),
            Fact(
                "largest_radius",
                "largest multiplier over speed",
                m.largest_radius,
                f"at {m.largest_radius_rpm:.5g} rpm",
            ),
            Fact(
                "nearest_unstable_speed",
                "nearest unstable speed at this damping",
                "none in the range" if m.nearest_rpm is None else Quantity(m.nearest_rpm, "rpm"),
            ),
            Fact(
                "critical_damping",
                "largest mesh damping ratio with an unstable speed",
                "none, not even 0" if m.critical_damping is None else m.critical_damping,
                f"this pair has {pair.mesh.damping_ratio:g}",
            ),
            Fact("step_speed", "chart step, speed", Quantity(float(np.diff(speeds).max()), "rpm")),
            Fact("step_damping", "chart step, damping ratio", float(np.diff(dampings).max())),
        ),
    )
    rows: list[tuple[Cell, ...]] = [
        (part, float(value.real), float(value.imag), float(abs(value)))
        for part, values in (("mesh: q, x_p, x_g", found.feedback), ("bearings: y_p, y_g", found.oloa))
        for value in values
    ]
    blocks: list[Block] = [
        facts,
        Picture(
            "stability_chart",
            "Spectral radius over pinion speed and mesh damping ratio, all else as given. Orange with a "
            "black edge: unstable. Every node carries an error bound.",
            lambda: plots.stability_figure(
                chart, "speed_rpm", "damping_ratio", (results.operating_rpm, pair.mesh.damping_ratio)
            ),
        ),
        Text(
            "The chart decides at its nodes. An instability tongue narrower than the chart's step can lie "
            "between them; tongues that narrow usually grow slowly and vanish with little damping."
        ),
        Picture(
            "multipliers",
            "Floquet multipliers at the operating point: inside the unit circle a disturbance dies. The "
            "free rotation of the pair is a double multiplier at +1 by nature and is taken out.",
            lambda: plots.multipliers_figure(found),
        ),
        Table(
            "multipliers_table",
            "Multipliers at the operating point.",
            (
                Column("part", "states"),
                Column("real", "real part"),
                Column("imag", "imaginary part"),
                Column("modulus", "modulus"),
            ),
            tuple(rows),
        ),
    ]
    return Chapter("stability", "Stability", tuple(blocks), Badge(found.verdict))
