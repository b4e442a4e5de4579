"""Assumptions and limitations: what the numbers rest on, with what this report found about each."""

from __future__ import annotations

import numpy as np

from validation.reporting.blocks import Badge, Content, Rows, Table, Text
from validation.reporting.chapter import Chapter
from validation.reporting.formatting import number
from validation.reporting.results import Results
from validation.reporting.sources import is_assumed, sources
from validation.validity.flags import Flag


def write(results: Results) -> Content:
    """Write the chapter."""
    table = Table(
        "assumptions",
        "What the lumped model assumes, and what this report found about it at the operating point.",
        {
            "assumption": "assumption",
            "consequence": "where it fails",
            "found": "found here",
            "state": "state",
        },
        tuple(_rows(results)),
    )
    supports = "shafts and housing beyond the bearing stiffness given"
    if results.pair.shafts is not None:
        supports = "housing; shafts in all chapters but one"
    outside = Text(
        "Not covered by any model of this report:",
        (
            "What tilt, misalignment and crowning do to the load across the face width.",
            f"Elastic blanks, {supports}; rotating imbalance.",
            "Differences from tooth to tooth, and so everything slower than the mesh frequency: shaft "
            "orders, hunting tooth.",
            "Heat: the oil's viscosity is one value; wear, scuffing and strength are not computed.",
            "The friction law is empirical. Models that agree with each other share it, so their agreement "
            "says nothing about it; a measured record does (spurcheck measurement).",
        ),
    )
    stated = sources(results.pair).values()
    assumed = sum(map(is_assumed, stated))
    text = Text(
        "Frame: x runs along the line of action, y off it; pair 0 is the tooth pair "
        "ahead; at time zero the newest pair enters contact at A. "
        f"Verification asks whether the equations are solved right; validation, whether they are the right "
        f"equations, and only measurements decide that. {assumed} of {len(stated)} parameter values of this "
        "pair are assumed: no conclusion is firmer than these. This report "
        "does not vary them; a study says how far they move a result (spurcheck sweep)."
    )
    return Content((text, table, outside))


def _rows(results: Results) -> Rows:
    flags = {flag.key: flag for flag in results.flags}
    rows: Rows = []

    def of_flag(key: str, assumption: str) -> None:
        flag: Flag | None = flags.get(key)
        if flag is not None:
            rows.append((assumption, flag.meaning, flag.detail, Badge(flag.state)))

    of_flag("contact_loss", "Teeth in contact stay in contact.")
    of_flag("sliding_reversal", "Sliding has the direction of the nominal rotation.")
    of_flag("torque_balance", "The torques balance friction, so the mean speed is constant.")
    of_flag("supports", "Four springs hold the gears as their shafts do.")
    of_flag("film_parameter", "The friction law suits the lubrication regime.")
    of_flag("friction_law_range", "The friction law is used inside the range of its fit.")
    of_flag("stiffness_range", "The tooth stiffness is used inside the range of its fit.")
    exact = results.check.of("exact")
    largest = max(exact, key=lambda a: a.difference)
    rows.append(
        (
            "Vibration does not move the contact: position, lever and line of action are nominal.",
            "Differences grow with torque; entry and exit of teeth shift with deflection.",
            f"multibody model with finite motions differs by up to {number(100 * largest.difference, 2)} % "
            f"of the peak to peak, in {largest.quantity}",
            Badge(results.check.verdict.word),
        )
    )
    stiffness = results.pair.mesh.stiffness.model
    factor = float(np.nanmax(results.motion["normal_load"].to_numpy())) / results.static_load
    rows.append(
        (
            "The stiffness of a tooth pair depends on its position alone, not on its load.",
            "Hertzian contact stiffens with load; light loads are softer.",
            f"model “{stiffness}”; loads swing up to {number(factor, 3)} times the static load",
            Badge("prediction", "by assumption"),
        )
    )
    margins = results.margins
    tongues = "the range has no tongue"
    if margins.tongues:
        tongues = f"every tongue of the range closes at {number(margins.critical_damping, 3)}"
    rows.append(
        (
            "Damping in the mesh is viscous, a constant ratio.",
            "The ratio sets peaks at resonance and the width of tongues.",
            f"ratio {results.pair.mesh.damping_ratio:g}; {tongues}",
            Badge("ok" if results.pair.mesh.damping_ratio >= margins.critical_damping else "warning"),
        )
    )
    return rows


CHAPTER = Chapter("limitations", "Assumptions and limitations", write)
