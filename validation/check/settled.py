"""The settled part of another model's curves: has the motion reached its period?

Sources: docs/how_to/check_your_model.md, "Settled".
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from lumped.typing import BoolArray, FloatArray
from validation.check.curve_orders import noise_in_orders, without_ramp
from validation.check.curves import Channel, Curves
from validation.signals.complex_orders import complex_orders

#: Orders by which two blocks of cycles are compared.
_ORDERS = 6
#: Samples for each fitted number of a block.
_PER_NUMBER = 4
#: A change above this many standard deviations of the noise is no noise.
_NOISE = 4.0
#: Most cycles that are compared: more cycles only take time.
_MOST_CYCLES = 64


class Settled(NamedTuple):
    """How far a motion has settled.

    Attributes
    ----------
    change : change of the orders between the last two blocks of cycles, over the motion; 0 below the noise;
        NaN: the curves are too short to tell
    used : (k,) samples that are compared: the last half of the curves, in whole cycles
    cycles : number of whole periods of the curves
    compared : number of periods that are compared
    transient : as ``change``, between the first block and the last one
    """

    change: float
    used: BoolArray
    cycles: int
    compared: int
    transient: float = np.nan


def settled(curves: Curves, cycles: FloatArray, period: int) -> Settled:
    """Return how far a motion has settled, and which samples are compared.

    Parameters
    ----------
    curves : the curves
    cycles : (k,) mesh cycles of their samples, from 0 on
    period : mesh cycles in the period of the motion
    """
    whole = _whole_cycles(cycles) // period
    if curves.role == "measurement" or whole < 2:
        return Settled(np.nan, np.ones(cycles.size, dtype=bool), whole, whole)
    per_cycle = cycles.size / max(float(np.ptp(cycles)), 1e-300)
    enough = int(np.ceil(_PER_NUMBER * (2 * _ORDERS + 1) / per_cycle))
    block = period * -(-enough // period)
    change = transient = np.nan
    channels = [channel for channel in curves.channels if channel.tooth_pair is None]
    if 2 * block <= whole * period and channels:
        first = whole * period // block
        change, transient = (
            float(np.sqrt(np.mean([_change(channel, cycles, block, earlier) ** 2 for channel in channels])))
            for earlier in (2, first)
        )
    last = period * min(max(whole // 2, 1), max(_MOST_CYCLES // period, 1))
    return Settled(change, cycles > cycles[-1] - last + 1e-9, whole, last // period, transient)


def _whole_cycles(cycles: FloatArray) -> int:
    """Number of whole cycles that the samples span; a last sample short of the end by a step counts."""
    step = float(np.median(np.diff(cycles)))
    return int(np.floor(float(np.ptp(cycles)) + 1.01 * step))


def _change(channel: Channel, cycles: FloatArray, block: int, earlier: int) -> float:
    """Change of the orders of a channel from a block of cycles, counted from the end, to the last one."""
    end = cycles[-1]
    values = without_ramp(cycles, channel.values) if channel.kind.is_rotation else channel.values
    orders = np.arange(1.0, _ORDERS + 1.0)
    fits = []
    for number in (earlier, 1):
        inside = (cycles > end - number * block + 1e-9) & (cycles <= end - (number - 1) * block + 1e-9)
        fits.append(complex_orders(cycles[inside], values[inside], orders))
    before, after = fits
    size = max(before.size, after.size)
    if size <= 0.0:
        return 0.0
    last = values[cycles > end - block + 1e-9]
    noise = np.sqrt(2.0) * noise_in_orders(last, _ORDERS)
    difference = float(np.linalg.norm(after.values - before.values))
    return difference / size if difference > _NOISE * noise else 0.0
