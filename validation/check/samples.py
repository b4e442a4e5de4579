"""Samples of another model's curves beside our motion at the same times: sizes, and what no order shows.

Sources: docs/how_to/check_your_model.md, "What is compared".
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from lumped.typing import FloatArray
from validation.check.curve_orders import white_noise, without_ramp
from validation.check.curves import Channel
from validation.check.misfit import ChannelMisfit
from validation.check.problem import Problem
from validation.signals.complex_orders import complex_orders


class PeaksToPeak(NamedTuple):
    """Largest less smallest value of a channel, in the SI unit of the channel.

    Attributes
    ----------
    theirs : of the other model
    ours : of our motion
    """

    theirs: float
    ours: float


class Samples(NamedTuple):
    """Samples (k,) of a channel of the whole mesh, in the SI unit of the channel.

    Attributes
    ----------
    cycles : mesh cycles of the samples
    theirs : values of the other model
    ours : values of our motion at the same times
    """

    cycles: FloatArray
    theirs: FloatArray
    ours: FloatArray


def samples_of(problem: Problem, channel: Channel) -> Samples:
    """Return the compared samples of a channel; rotations without their constant speed and drift."""
    used = problem.used(channel)
    cycles = problem.cycles[used]
    ours = problem.motion.at(channel.quantity, cycles + problem.misfit.shift, channel.tooth_pair)
    theirs = channel.values[used]
    if channel.kind.is_rotation:
        theirs, ours = without_ramp(cycles, theirs), without_ramp(cycles, ours)
    return Samples(cycles, theirs, ours)


def peaks_to_peak(problem: Problem, row: ChannelMisfit) -> PeaksToPeak:
    """Return the peaks to peak of a channel in both models.

    Curves of a model: of the samples, both at the same times. A record has noise, and the largest sample
    grows with the number of samples: there the peaks to peak are those of the compared orders.
    """
    if problem.curves.role == "measurement":
        return PeaksToPeak(row.channel.orders.peak_to_peak, row.ours.peak_to_peak)
    samples = samples_of(problem, row.channel.channel)
    return PeaksToPeak(float(np.ptp(samples.theirs)), float(np.ptp(samples.ours)))


def difference_at_no_order(
    problem: Problem, row: ChannelMisfit, half: int | None = None, *, typical: bool = False
) -> float:
    """Return the difference of both motions that lies at none of the compared orders, over the motion.

    The difference of the samples is fitted by the compared orders; what the fit leaves, less white noise,
    stands over the amplitude of the motion, as the misfit does. 0 for a channel of a tooth pair, whose orders
    are those of its engagement. ``half`` takes what is left of the first (0) or last (1) half of the samples.
    ``typical`` takes the median of the squares, not their mean: jumps at few samples then count for nothing.
    """
    channel = row.channel.channel
    if channel.tooth_pair is not None:
        return 0.0
    samples = samples_of(problem, channel)
    difference = samples.theirs - samples.ours
    orders = row.channel.orders
    fitted = complex_orders(samples.cycles, difference, orders.orders, period=orders.period)
    rest = difference - fitted.mean - fitted.at(samples.cycles)
    if half is not None:
        rest = np.array_split(rest, 2)[half]
    average = np.median if typical else np.mean
    # A wave of amplitude a has the mean square a^2/2.
    square = 2.0 * (float(average(rest**2)) - white_noise(samples.theirs) ** 2)
    return float(np.sqrt(max(square, 0.0))) / row.scale
