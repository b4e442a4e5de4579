"""Misfit of another model's curves and a motion of ours: one number, and one row for each channel.

    e^2 = mean over channels of SUM |U_m - V_m exp(2 pi i m s)|^2 / scale^2 + ((mean U - mean V)/static)^2

U_m are the complex orders of the other model, V_m those of our motion, s the one shift in time of all
channels. ``scale`` is the amplitude of the larger of both motions, so that e is 0 for equal motions, about 1
where one motion is zero, and never explodes where one model leaves a channel at rest. The expected square of
white noise on the samples is taken from |U_m - V_m|^2; what repeats with every cycle is no noise.

Sources: docs/how_to/check_your_model.md, "Misfit".
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from validation.check.curve_orders import BIN, ChannelOrders, orders_of_motion
from validation.check.motion_curves import MotionCurves
from validation.check.quantities import Quantity
from validation.signals.complex_orders import LEAST, ComplexOrders, common_shift

#: Default limit of the misfit of curves that agree.
LIMIT = 0.05
#: A mean below this share of our mean is a mean that an exporter or a sensor removed. The mean of a record
#: that is no whole number of cycles is not quite that of a cycle.
_REMOVED = 0.05
#: A mean of ours below this share of the static value says nothing about removed means.
_SMALL = 2e-3


class ChannelMisfit(NamedTuple):
    """One channel of the other model beside our motion, both in the phase of the other model.

    Attributes
    ----------
    channel : the channel with its orders
    ours : orders of our motion
    scale : amplitude by which the differences of the orders are divided, in the unit of the channel
    static : value by which the difference of the means is divided, in the unit of the channel
    compares_mean : whether the means are compared
    """

    channel: ChannelOrders
    ours: ComplexOrders
    scale: float
    static: float
    compares_mean: bool

    @property
    def motion(self) -> float:
        """Misfit of the orders above 0, without what the noise of the samples adds in the mean."""
        difference = float(np.linalg.norm(self.channel.orders.values - self.ours.values))
        return math.sqrt(max(difference**2 - self.channel.noise**2, 0.0)) / self.scale

    @property
    def mean(self) -> float:
        """Difference of the means over the static value; 0 where the means are not compared."""
        if not self.compares_mean:
            return 0.0
        return abs(self.channel.orders.mean - self.ours.mean) / self.static

    @property
    def total(self) -> float:
        """Misfit of motion and mean together."""
        return math.hypot(self.motion, self.mean)


@dataclass(frozen=True, eq=False)
class Misfit:
    """The curves of another model beside a motion of ours.

    Attributes
    ----------
    channels : misfit of each channel
    shift : mesh cycles from the moment when pair A was at A to mesh cycle 0 of the curves
    """

    channels: tuple[ChannelMisfit, ...]
    shift: float

    @property
    def value(self) -> float:
        """e: root of the mean of the squares over all channels. All tooth pairs count as one channel."""
        squares: dict[str, list[float]] = {}
        for channel in self.channels:
            one = channel.channel.channel
            squares.setdefault(one.quantity if one.tooth_pair else one.name, []).append(channel.total**2)
        return float(np.sqrt(np.mean([np.mean(of_channel) for of_channel in squares.values()])))


def misfit_of(
    theirs: Sequence[ChannelOrders],
    motion: MotionCurves,
    *,
    shift: float | None = None,
    near: float | None = None,
    means: bool = True,
) -> Misfit:
    """Return the misfit of curves and a motion.

    Parameters
    ----------
    theirs : channels of the other model with their orders
    motion : motion of ours
    shift : known shift [mesh cycles]; None: the shift with the smallest misfit
    near : the shift is searched within two bins of this one, for channels of tooth pairs; None: over the
        whole period
    means : whether the means of the channels are compared: sensors have no zero
    """
    ours = [one.recorded(orders_of_motion(motion, one.channel, one.orders)) for one in theirs]
    statics = [static_value(one.channel.kind, motion) for one in theirs]
    scales = [
        max(one.orders.size, other.size, LEAST * static)
        for one, other, static in zip(theirs, ours, statics, strict=True)
    ]
    if shift is None:
        reach = None if near is None else (near, 2.0 * BIN)
        shift = common_shift([one.orders for one in theirs], ours, scales, near=reach)
    channels = [
        ChannelMisfit(
            channel=one,
            ours=other.shifted(shift),
            scale=scale,
            static=static,
            compares_mean=(
                means
                and one.channel.kind.has_mean
                and not one.offset
                and not mean_is_removed(one, other, static)
            ),
        )
        for one, other, scale, static in zip(theirs, ours, scales, statics, strict=True)
    ]
    return Misfit(tuple(channels), shift)


def residual_of(misfit: Misfit) -> FloatArray:
    """Return the residual, whose root sum square is the value of the misfit."""
    groups = [_group(row) for row in misfit.channels]
    parts = []
    for row, group in zip(misfit.channels, groups, strict=True):
        difference = (row.channel.orders.values - row.ours.values) / row.scale
        mean = (row.channel.orders.mean - row.ours.mean) / row.static if row.compares_mean else 0.0
        part = np.concatenate([difference.real, difference.imag, [mean]])
        parts.append(part / np.sqrt(len(set(groups)) * groups.count(group)))
    return np.asarray(np.concatenate(parts), dtype=np.float64)


def _group(row: ChannelMisfit) -> str:
    """Channels that count as one: all tooth pairs of a quantity; else the channel alone."""
    one = row.channel.channel
    return f"pairs: {one.quantity}" if one.tooth_pair else one.name


def mean_is_removed(theirs: ChannelOrders, ours: ComplexOrders, static: float) -> bool:
    """Return whether the mean of a channel was removed by an export or a sensor: ours is not 0, theirs is."""
    return _SMALL * static < abs(ours.mean) and abs(theirs.orders.mean) < _REMOVED * abs(ours.mean)


def static_value(quantity: Quantity, motion: MotionCurves) -> float:
    """Return the static value of a quantity: mesh force, mean deflection, or torque, always above 0.

    A rate has the static value times the mesh frequency [rad/s], an acceleration its square.
    """
    pair = motion.pair
    g = pair.geometry
    force = pair.operating.pinion_torque / g.base_radius_pinion
    rate = (2.0 * math.pi / g.mesh_period) ** quantity.derivative
    base_unit = quantity.unit.partition("/s")[0]
    if base_unit == "N*m":
        torque = pair.operating.pinion_torque
        return torque if quantity.name.endswith("_p") else torque * g.base_radius_gear / g.base_radius_pinion
    if base_unit == "N":
        return force
    if base_unit == "N/m":
        return float(np.mean(motion.samples("mesh_stiffness")))
    deflection = deflection_of(pair, motion)
    if base_unit == "rad":
        radius = g.base_radius_pinion if "_p" in quantity.name else g.base_radius_gear
        return rate * deflection / radius
    return rate * deflection


def deflection_of(pair: GearPair, motion: MotionCurves) -> float:
    """Return the mean transmission error of our motion [m], at least the static force over the stiffness."""
    force = pair.operating.pinion_torque / pair.geometry.base_radius_pinion
    stiffness = float(np.mean(motion.samples("mesh_stiffness")))
    return max(abs(float(np.mean(motion.samples("dte")))), force / max(stiffness, 1e-300))


def largest_differences(channel: ChannelMisfit, most: int = 3) -> FloatArray:
    """Return the orders that differ most, the largest difference first."""
    difference = np.abs(channel.channel.orders.values - channel.ours.values)
    return np.asarray(channel.channel.orders.orders[np.argsort(-difference)][:most], dtype=np.float64)
