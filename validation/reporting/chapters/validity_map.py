"""Validity of the lumped model over speed and torque."""

from __future__ import annotations

from functools import partial

import numpy as np
import xarray as xr

from floquet.gear.axes import operating_rpm, with_point
from lumped import GearPair
from lumped.lubrication.film import REGIMES
from lumped.model.steady import UNSTABLE
from lumped.typing import BoolArray, FloatArray
from validation.plots.validity_map import validity_map_figure
from validation.reporting.blocks import Content, Picture, Quantity, Text, facts, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.results import Effort, Results
from validation.validity.flags import LOAD_NOISE, REVERSAL_LIMITS
from validation.validity.map import STATES, speed_spans
from validation.validity.map import validity_map as compute_map


def write(results: Results) -> Content:
    """Write the chapter."""
    pair = results.pair
    axes = map_axes(pair, results.speeds, results.effort)
    data = compute_map(pair, *axes, progress=results.stage("validity over speed and torque"))
    state, regime = data["state"].to_numpy(), data["regime"].to_numpy()
    limit = REVERSAL_LIMITS[0]

    def share(where: BoolArray | xr.DataArray) -> float:
        return float(np.mean(where))

    shares = facts(
        "shares",
        ("valid", "valid", share(state == 0), "", "share of the points"),
        ("contact_lost", "contact lost", share(data["lowest_load"] < -LOAD_NOISE)),
        (
            "sliding_reversed",
            "sliding reversed off the pitch point",
            share(data["reversal"] > limit),
            "",
            f"by more than {100 * limit:g} % of a base pitch",
        ),
        ("unstable", "unstable motion", share(data["spectral_radius"] > UNSTABLE)),
        ("no_motion", "no periodic motion", share(state == STATES.index("no periodic motion"))),
        *((f"regime_{k}", f"film: {name}", share(regime == k)) for k, name in enumerate(REGIMES)),
    )
    torque, speed = data["torque"].to_numpy(), data["speed"].to_numpy()
    here = int(np.argmin(np.abs(torque - pair.operating.pinion_torque)))
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
        shares,
        table_of(
            "valid_speeds",
            "Speeds at which contact and sliding are as the model assumes and the motion is stable, at "
            "three torques.",
            sorted({0, here, torque.size - 1}),
            {
                "torque": ("pinion torque", lambda row: Quantity(float(torque[row]), "N m")),
                "share": ("share of the speeds", lambda row: share(state[row] == 0)),
                "speeds": ("pinion speeds", lambda row: _valid(speed, state[row] == 0)),
            },
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


def _valid(speed: FloatArray, valid: BoolArray) -> str:
    return ", ".join(f"{span} rpm" for span in speed_spans(speed, valid)) or "nowhere"


CHAPTER = Chapter("validity_map", "Validity over speed and torque", write, front=("validity_map",), seconds=4)
