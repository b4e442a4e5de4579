"""Curves of another model folded over the mesh phase, beside our motion: means in bins, and scatter."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import xarray as xr

from lumped.errors import NumericalError
from lumped.labelling import labelled_dataset
from lumped.typing import FloatArray
from validation.check.curve_orders import without_ramp
from validation.check.curves import Channel
from validation.check.origin import origin
from validation.check.problem import Problem

#: Unit attribute of a variable whose channels differ in their unit.
_BY_CHANNEL = "SI, by channel"


def overlay(problem: Problem, *, bins: int = 64) -> xr.Dataset:
    """Return their values and ours in bins of phase, over one mesh cycle or one engagement.

    Where teeth differ, the scatter of a bin contains the difference from tooth to tooth. Means that an
    export removed are put back: their mean is then ours.

    Parameters
    ----------
    problem : the curves and our motion
    bins : number of bins

    Returns
    -------
    xarray.Dataset over ``channel`` and ``bin``: ``phase`` [mesh cycles], ``theirs``, ``ours``, ``scatter``
    (standard deviation of theirs less ours), ``samples``; each channel in the SI unit ``units``. Empty bins
    are NaN. ``relative_rms`` (channel): rms of theirs less ours over our peak to peak

    Raises
    ------
    NumericalError : no sample of a tooth pair is in contact
    """
    misfits = {row.channel.channel.name: row for row in problem.misfit.channels}
    channels = tuple(row.channel.channel for row in problem.misfit.channels)
    rows = [
        _binned(_samples(problem, channel, misfits[channel.name].compares_mean), bins) for channel in channels
    ]
    dims = ("channel", "bin")
    columns = {
        "phase": ("mesh cycles", "middle of the bin, mesh cycles since A"),
        "theirs": (_BY_CHANNEL, "mean of their values"),
        "ours": (_BY_CHANNEL, "mean of our values"),
        "scatter": (_BY_CHANNEL, "standard deviation of theirs less ours in the bin"),
        "samples": ("1", "samples in the bin"),
    }
    return labelled_dataset(
        {
            name: (dims, np.stack([getattr(row, name) for row in rows]), unit, words)
            for name, (unit, words) in columns.items()
        }
        | {
            "relative_rms": ("channel", [row.relative_rms for row in rows], "1", "rms over our peak to peak"),
            "units": ("channel", [channel.kind.unit for channel in channels], "1", "SI unit of the channel"),
        },
        {"channel": ([channel.name for channel in channels], "1", "channel")},
        origin(problem.pair) | {"theirs": problem.curves.name, "role": problem.curves.role},
    )


class _Samples(NamedTuple):
    """Samples (k,) of one channel: mesh cycles since A, their values, ours; then the length of the phase."""

    phase: FloatArray
    theirs: FloatArray
    ours: FloatArray
    reach: float


class _Bins(NamedTuple):
    """A channel in bins (b,), see ``overlay``."""

    phase: FloatArray
    theirs: FloatArray
    ours: FloatArray
    scatter: FloatArray
    samples: FloatArray
    relative_rms: float


def _samples(problem: Problem, channel: Channel, with_mean: bool) -> _Samples:
    """Settled samples of one channel; for a channel of one tooth pair only the samples in contact."""
    used = problem.used(channel)
    cycles = problem.cycles[used] + problem.misfit.shift
    motion = problem.motion.mean_cycle()
    theirs = channel.values[used]
    if channel.kind.is_rotation:
        theirs = without_ramp(problem.cycles[used], theirs)
    phase = np.mod(cycles, 1.0)
    inside = np.ones(cycles.shape, dtype=bool)
    reach = 1.0
    if channel.tooth_pair is not None:
        phase = motion.age(cycles, channel.tooth_pair)
        reach = problem.pair.geometry.contact_ratio
        inside = (phase >= 0.0) & (phase < reach)
        if not inside.any():
            raise NumericalError(f"No sample of {channel.name} is in contact: check its tooth pair.")
    ours = motion.at(channel.quantity, cycles, channel.tooth_pair)
    if not with_mean and channel.tooth_pair is None:
        theirs = theirs - theirs.mean() + ours.mean()
    return _Samples(phase[inside], theirs[inside], ours[inside], reach)


def _binned(samples: _Samples, bins: int) -> _Bins:
    """Means and scatter of samples in bins of phase."""
    place = np.minimum((samples.phase / samples.reach * bins).astype(np.int64), bins - 1)
    count = np.bincount(place, minlength=bins)
    difference = samples.theirs - samples.ours

    def mean(values: FloatArray) -> FloatArray:
        with np.errstate(invalid="ignore"):  # an empty bin has no mean
            return np.asarray(np.bincount(place, weights=values, minlength=bins) / count)

    variance = (mean(difference**2) - mean(difference) ** 2) * count / np.maximum(count - 1, 1)
    span = float(np.ptp(samples.ours))
    rms = float(np.sqrt(np.mean(difference**2)))
    return _Bins(
        phase=(np.arange(bins) + 0.5) * samples.reach / bins,
        theirs=mean(samples.theirs),
        ours=mean(samples.ours),
        scatter=np.sqrt(np.maximum(variance, 0.0)),
        samples=count.astype(np.float64),
        relative_rms=rms / span if span > 0.0 else np.nan,
    )


def figure_data(problem: Problem, *, bins: int = 64) -> xr.Dataset:
    """Return ``overlay`` with the amplitudes of the orders and the misfit of each channel.

    Returns
    -------
    xarray.Dataset over ``channel``, ``bin`` and ``order``: the variables of ``overlay``; ``their_orders`` and
    ``our_orders``, amplitudes in the SI unit of the channel, NaN without such an order; ``misfit``
    """
    data = overlay(problem, bins=bins)
    rows = problem.misfit.channels
    order = np.unique(np.concatenate([row.ours.orders for row in rows]))
    dims = ("channel", "order")
    amplitudes = {key: np.full((len(rows), order.size), np.nan) for key in ("their_orders", "our_orders")}
    for number, row in enumerate(rows):
        places = np.searchsorted(order, row.ours.orders)
        amplitudes["their_orders"][number, places] = row.channel.orders.amplitudes
        amplitudes["our_orders"][number, places] = row.ours.amplitudes
    orders = labelled_dataset(
        {
            "their_orders": (dims, amplitudes["their_orders"], _BY_CHANNEL, "their amplitudes"),
            "our_orders": (dims, amplitudes["our_orders"], _BY_CHANNEL, "our amplitudes"),
            "misfit": ("channel", [row.total for row in rows], "1", "misfit of the channel"),
        },
        {
            "channel": (data["channel"].to_numpy(), "1", "channel"),
            "order": (order, "1", "mesh order"),
        },
    )
    return data.merge(orders, combine_attrs="override")
