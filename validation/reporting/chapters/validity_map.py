"""Validity of the lumped model over speed and torque."""

from __future__ import annotations

from functools import partial

import numpy as np

from floquet.gear.axes import operating_rpm, with_point
from lumped import GearPair
from lumped.model.steady import UNSTABLE
from lumped.typing import BoolArray, FloatArray
from validation.plots.validity_map import validity_map_figure
from validation.reporting.blocks import Content, Fact, Facts, Picture, Quantity, Rows, Table, Text
from validation.reporting.chapter import Chapter
from validation.reporting.results import Effort, Results
from validation.validity.flags import LOAD_NOISE, REVERSAL_LIMITS
from validation.validity.map import REGIMES, STATES
from validation.validity.map import validity_map as compute_map


def write(results: Results) -> Content:
    """Write the chapter."""
    pair = results.pair
    axes = map_axes(pair, results.speeds, results.effort)
    data = compute_map(pair, *axes, progress=results.stage("validity over speed and torque"))
    state, regime = data["state"].to_numpy(), data["regime"].to_numpy()
    lowest, reversal = data["lowest_load"].to_numpy(), data["reversal"].to_numpy()
    with np.errstate(invalid="ignore"):
        shares = (
            Fact("valid", "valid", float(np.mean(state == 0)), "share of the points"),
            Fact("contact_lost", "contact lost", float(np.mean(lowest < -LOAD_NOISE))),
            Fact(
                "sliding_reversed",
                "sliding reversed off the pitch point",
                float(np.mean(reversal > REVERSAL_LIMITS[0])),
                f"by more than {100 * REVERSAL_LIMITS[0]:g} % of a base pitch",
            ),
            Fact(
                "unstable",
                "unstable motion",
                float(np.mean(data["spectral_radius"].to_numpy() > UNSTABLE)),
            ),
            Fact(
                "no_motion", "no periodic motion", float(np.mean(state == STATES.index("no periodic motion")))
            ),
            *(
                Fact(f"regime_{k}", f"film: {name}", float(np.mean(regime == k)))
                for k, name in enumerate(REGIMES)
            ),
        )
    torque, speed = data["torque"].to_numpy(), data["speed"].to_numpy()
    here = int(np.argmin(np.abs(torque - pair.operating.pinion_torque)))
    rows: Rows = []
    for row in sorted({0, here, torque.size - 1}):
        spans = _spans(speed, state[row] == 0)
        share = float(np.mean(state[row] == 0))
        rows.append((Quantity(float(torque[row]), "N m"), share, spans or "nowhere"))
    blocks = (
        Text(
            f"The checks of the chapter before, at {speed.size} speeds and {torque.size} torques, all else "
            "as given. The equations are linear: without relief and errors of the teeth, contact loss "
            "depends on speed alone. Film and sliding depend on both."
        ),
        Picture(
            "validity_map",
            "Where the lumped model holds, over pinion speed and torque. Left: do the teeth stay in contact? "
            "Middle: does sliding keep its direction away from the pitch point? Right: lubrication regime at "
            "the thinnest place of the path of contact. Circle: operating point; crosses on the left: the "
            "motion is unstable.",
            partial(validity_map_figure, data, (results.operating_rpm, pair.operating.pinion_torque)),
        ),
        Facts("shares", shares),
        Table(
            "valid_speeds",
            "Speeds at which contact and sliding are as the model assumes and the motion is stable, at "
            "three torques.",
            {
                "torque": "pinion torque",
                "share": "share of the speeds",
                "speeds": "pinion speeds",
            },
            tuple(rows),
            note=f"Between neighbouring points, {speed[1] - speed[0]:.4g} rpm apart, the state may change "
            "unseen.",
        ),
    )
    return Content(blocks, data={"validity_map": data})


def map_axes(pair: GearPair, speeds: tuple[float, float], effort: Effort) -> tuple[FloatArray, FloatArray]:
    """Speeds [rpm] and torques [N m] of the map; the operating point is a node."""
    torque = pair.operating.pinion_torque
    return (
        with_point(np.linspace(*speeds, effort.map_speeds), operating_rpm(pair)),
        with_point(torque * np.geomspace(0.2, 4.0, effort.map_torques), torque),
    )


def _spans(
    speed: FloatArray,
    good: BoolArray,
) -> str:
    """Runs of good speeds in words."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], good.astype(int), [0]])))
    parts = []
    for first, end in zip(edges[::2], edges[1::2], strict=True):
        low, high = speed[first], speed[end - 1]
        parts.append(f"{low:.5g} rpm" if low == high else f"{low:.5g} to {high:.5g} rpm")
    return ", ".join(parts)


CHAPTER = Chapter("validity_map", "Validity over speed and torque", write, seconds=4)
