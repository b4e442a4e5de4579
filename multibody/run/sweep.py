"""Sweep the pinion speed up or down, each speed started from where the last one ended.

A separating gear pair has more than one steady motion at the same speed; which one a machine shows depends
on where it came from. A sweep that carries the state on finds both branches and the jumps between them.

Sources: Kahraman and Blankenship 1997 for the experiment; docs/theory/multibody.md.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from lumped.arguments import whole_number
from lumped.labelling import labelled_dataset
from lumped.model.extremes import cycle_peak_to_peak
from lumped.model.results import provenance
from lumped.model.sweep import running_speeds
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.typing import FloatArray, Progress
from multibody.run.records import to_lumped_state
from multibody.run.setup import MOST_CYCLES, Fidelity, prepare
from multibody.run.simulation import record

if TYPE_CHECKING:
    import xarray as xr


_VARIABLES = {
    "dte_rms": ("m", "root mean square of the transmission error about its mean"),
    "dte_peak_to_peak": ("m", "peak to peak of the transmission error"),
    "overlap_min": ("m", "smallest overlap of the driving flanks; negative: the teeth separate"),
    "separated": ("1", "share of time in which no driving flanks touch"),
    "back_side": ("1", "share of time in which the back sides touch"),
    "unsettled": ("1", "change of the root mean square from the first to the second half, relative"),
}


def speed_sweep(
    pair: AnyPair,
    speeds_rpm: Iterable[float],
    *,
    settle: int = 80,
    cycles: int = 20,
    samples_per_cycle: int = 128,
    fidelity: Fidelity = "exact",
    effects: Collection[str] | Mapping[str, bool] | None = None,
    rtol: float = 1e-7,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Response over speed with the state carried from one speed to the next, in the order given.

    Parameters
    ----------
    pair : a validated gear pair; its speed is replaced
    speeds_rpm : pinion speeds in the order of the sweep, rising or falling [rpm]
    settle : mesh cycles run at every speed before the response is taken
    cycles : mesh cycles over which it is taken
    samples_per_cycle : output times per mesh cycle
    fidelity, effects, rtol : as ``multibody.simulate``
    progress : called with the finished fraction

    Returns
    -------
    xarray.Dataset over ``speed`` [rpm], in the order of the sweep. ``unsettled`` says where ``settle`` was
    too short, as near the boundary of stability, or where the motion beats.

    Raises
    ------
    ParameterError, NumericalError : as ``multibody.simulate``
    """
    pair = load_gear_pair(pair)
    speeds = running_speeds(speeds_rpm)
    settle = whole_number("settle", settle, 0, MOST_CYCLES)
    cycles = whole_number("cycles", cycles, 1, MOST_CYCLES)
    table = {name: np.full(speeds.size, np.nan) for name in _VARIABLES}
    state: FloatArray | None = None
    for j, rpm in enumerate(speeds):
        at = pair.with_({"operating.pinion_speed": float(rpm)})
        initial = "periodic" if state is None else state
        setup = prepare(at, fidelity, initial, effects, rtol)
        run, q, v = record(setup, settle + cycles, samples_per_cycle, first_cycle=settle)
        # Whole cycles end at the phase they started with, so the deviations carry over as they are.
        state = to_lumped_state(q, v)
        # The last sample is the first of a next cycle: means over whole cycles are without it.
        dte, overlap = run["dte"].to_numpy()[:-1], run["overlap"].to_numpy()[:-1]
        table["dte_rms"][j], table["dte_peak_to_peak"][j] = np.std(dte), cycle_peak_to_peak(run, "dte")
        table["overlap_min"][j], table["separated"][j] = overlap.min(), np.mean(overlap <= 0.0)
        table["back_side"][j] = np.mean(run["normal_load_back"].to_numpy()[:, :-1].sum(0) > 0.0)
        halves = [np.std(half) for half in np.split(dte, [cycles // 2 * samples_per_cycle]) if half.size]
        table["unsettled"][j] = abs(halves[-1] - halves[0]) / np.std(dte)
        if progress is not None:
            progress((j + 1) / speeds.size)
    return labelled_dataset(
        {name: ("speed", values, *_VARIABLES[name]) for name, values in table.items()},
        {"speed": (speeds, "rpm", "pinion speed")},
        provenance(pair, fidelity=fidelity, settle=settle, cycles=cycles, rtol=rtol),
    )
