"""Margins of stability: distance to the nearest tongue in speed and in damping."""

from __future__ import annotations

from functools import partial

from floquet.gear.tongues import ORDERS
from validation.plots.stability import tongues_figure
from validation.reporting.blocks import Block, Content, Picture, Quantity, Text, facts, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results


def write(results: Results) -> Content:
    """Write the chapter."""
    m = results.margins
    low, high = m.speed_range
    reach = f"{low:.5g} to {high:.5g} rpm"
    nearest, above = m.nearest, m.above
    distances = facts(
        "distances",
        (
            "speed_margin",
            "nearest unstable speed at this damping",
            "none in the range" if m.speed_margin is None else Quantity(m.speed_margin, "rpm"),
            "",
            f"distance from {m.rpm:.5g} rpm; range {reach}",
        ),
        (
            "nearest_tongue",
            "nearest tongue without mesh damping",
            "none in the range" if nearest is None else nearest.label.replace("w", "ω"),
            "",
            "" if nearest is None else f"{nearest.lower:.5g} to {nearest.upper:.5g} rpm",
        ),
        (
            "nearest_tongue_distance",
            "distance to it",
            None if nearest is None else Quantity(nearest.distance(m.rpm), "rpm"),
        ),
        (
            "tongue_above",
            "next tongue above the range, without mesh damping",
            "none" if above is None else above.label.replace("w", "ω"),
            "",
            ""
            if above is None
            else f"{above.lower:.5g} to {above.upper:.5g} rpm, closed by a mesh damping "
            f"ratio of {above.critical_damping:.3g}",
        ),
        (
            "critical_damping",
            "mesh damping ratio that closes every tongue of the range",
            m.critical_damping,
            "",
            f"this pair has {m.damping:g}",
        ),
        (
            "damping_margin",
            "margin in mesh damping ratio over the range",
            m.damping - m.critical_damping,
            "",
            "negative: some speed of the range is unstable",
        ),
        (
            "damping_at_speed",
            "mesh damping ratio above which this speed is stable",
            0.0 if m.damping_at_speed is None else m.damping_at_speed,
            "",
            "stable even without" if m.damping_at_speed is None else "",
        ),
        (
            "friction_coefficient",
            "friction coefficient held",
            m.friction_coefficient,
            "",
            "mean of the law over the path of contact",
        ),
        (
            "law_difference",
            "largest effect of that on a multiplier",
            m.law_difference,
            "",
            "law against constant coefficient, in the middle of every tongue without mesh damping",
        ),
    )
    blocks: list[Block] = [
        Text(
            "A tongue is a range of speeds in which the periodic change of stiffness feeds a vibration: the "
            "mesh frequency is near (ω_i ± ω_j)/k. The search over speed is seeded with every such line up "
            f"to k = {ORDERS}, so thin tongues are met. Edges, and the damping that closes a tongue, are "
            "roots of the largest multiplier minus one, not nodes of a chart. Bearings are damped as given; "
            "mesh damping is varied."
        ),
        distances,
    ]
    if m.tongues:
        blocks += [
            Picture(
                "tongues",
                "Tongues over pinion speed and mesh damping ratio (orange: unstable). Circle: operating "
                "point; dashed: its damping. Narrow neighbours are labelled in the table only.",
                partial(tongues_figure, m),
            ),
            table_of(
                "tongues_table",
                "Every tongue without mesh damping, and the mesh damping that closes it.",
                m.tongues,
                {
                    "label": ("mesh frequency", lambda t: t.label.replace("w", "ω")),
                    "lower": ("from", lambda t: Quantity(t.lower, "rpm")),
                    "upper": ("to", lambda t: Quantity(t.upper, "rpm")),
                    "radius": ("largest multiplier", lambda t: t.radius),
                    "critical_damping": ("closed by damping", lambda t: t.critical_damping),
                    "tip_speed": ("closes at", lambda t: Quantity(t.tip_speed, "rpm")),
                    "damping_margin": ("margin in damping", lambda t: m.damping - t.critical_damping),
                    "distance": ("distance in speed", lambda t: Quantity(t.distance(m.rpm), "rpm")),
                },
            ),
        ]
    else:
        blocks.append(Text(f"Even without mesh damping no speed from {reach} is unstable."))
    return Content(tuple(blocks))


CHAPTER = Chapter("stability_margins", "Stability margins", write, front=("distances", "tongues_table"))
