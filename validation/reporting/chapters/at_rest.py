"""The pair at rest under its torque: written where no motion can be computed."""

from __future__ import annotations

from functools import partial

import numpy as np
import xarray as xr

from lumped.labelling import labelled_dataset
from lumped.model.averaged import Mode
from validation.files.formatting import quantity
from validation.plots.axes import cycle_figure
from validation.prediction.resonance import mode_name
from validation.prediction.static import StaticPair
from validation.reporting.blocks import Block, Column, Content, Picture, Table, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results


def write(results: Results) -> Content | None:
    """Write the chapter. None: there is a motion."""
    if results.without_motion is None:
        return None
    static = results.static
    blocks: list[Block] = []
    if static.sharing is not None:
        curve = static_curve(static.sharing)
        blocks.append(
            Picture(
                "static_transmission_error",
                "Static transmission error over a mesh cycle, with perfect teeth.",
                curve,
                partial(cycle_figure, names=["transmission_error"], text="static transmission error"),
            )
        )
    if static.modes:
        blocks.append(_modes_table(static))
    return Content(f"No motion could be computed. {results.without_motion}", tuple(blocks))


def static_curve(sharing: xr.Dataset) -> xr.Dataset:
    """Return the static transmission error over the mesh cycle, at the torque of the pair."""
    curve = sharing["transmission_error"].isel(torque=0).to_numpy()
    phase = np.append(sharing["phase"].to_numpy(), 1.0)
    text = "static transmission error"
    return labelled_dataset(
        {"transmission_error": ("cycle", np.append(curve, curve[0]), "m", text)},
        {"cycle": (phase, "mesh cycles", "time")},
    )


def _modes_table(static: StaticPair) -> Table:
    torque = quantity(static.largest_torque, "N m", 3)
    return table_of(
        "modes_at_rest",
        f"Natural frequencies of the pair with its mean mesh stiffness, under {torque}.",
        static.modes,
        (
            Column[Mode]("mode", "mode", mode_name),
            Column[Mode]("frequency", "natural frequency", lambda mode: mode.natural_frequency, "Hz"),
            Column[Mode]("damping", "damping ratio", lambda mode: mode.damping_ratio, "1"),
            Column[Mode]("speed", "speed of mesh order 1", lambda mode: mode.resonant_speed, "rpm"),
        ),
    )


CHAPTER = Chapter("at_rest", "At rest", write, seconds=0.1, needs_motion=False)
