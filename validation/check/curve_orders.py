"""Complex mesh orders of another model's curves, and of a motion of ours at the same orders.

A channel of one tooth pair is taken over the mesh cycles of each engagement, one for each place of a tooth
pair in the motion. The orders of such a channel are therefore fractions of mesh orders. Teeth that differ
have the orders of both shafts too.

Sources: docs/how_to/check_your_model.md, "Orders".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from lumped.errors import ParameterError, refuse
from lumped.schema.pair import GearPair
from lumped.typing import ComplexArray, FloatArray
from validation.check.curves import Channel
from validation.check.motion_curves import MotionCurves
from validation.check.quantities import PAIR_LABELS
from validation.signals.complex_orders import ComplexOrders, complex_orders, orders_of_period

#: Most mesh orders that are compared.
MESH_ORDERS = 12
#: Orders of each shaft, and of the sidebands of each mesh order, for teeth that differ.
_SHAFT_ORDERS = 3
#: Most mesh orders for each different phase of the samples.
_PER_PHASE = 0.3
#: Number of phases of a mesh cycle that count as different.
_DIFFERENT = 1000
#: Least samples for each fitted number.
_PER_NUMBER = 4
#: Samples of a motion in a mesh cycle for the orders of a tooth pair.
_SAMPLES = 512
#: An order times the period that is this close to a whole number is whole.
_WHOLE = 1e-6
#: Mesh cycles from which on a line and the mesh orders are told apart.
_LINE_AND_ORDERS = 1.5
#: Parts of a mesh cycle, and the share of the parts of an engagement that the samples of a pair must show.
_PLACES = 16
_SEEN = 0.95
#: Mesh cycles in a bin of the search for the coarse shift.
BIN = 1.0 / 32.0


class ChannelOrders(NamedTuple):
    """A channel of another model by its complex orders.

    Attributes
    ----------
    channel : the channel
    orders : its orders
    noise : root of the expected square that white noise of the samples adds to all orders, in the unit of
        the channel
    gains : (m,) by which a filter of the recording multiplies our orders; None: no filter
    offset : whether the values have another zero, so that the mean says nothing
    """

    channel: Channel
    orders: ComplexOrders
    noise: float = 0.0
    gains: ComplexArray | None = None
    offset: bool = False

    def recorded(self, ours: ComplexOrders) -> ComplexOrders:
        """Return orders of ours through the filter of the recording."""
        return ours if self.gains is None else replace(ours, values=ours.values * self.gains)


def resolved_orders(cycles: FloatArray, period: int = 1, most: int = MESH_ORDERS) -> int:
    """Return the number of mesh orders that samples at these mesh cycles resolve.

    Parameters
    ----------
    cycles : (k,) mesh cycles of the samples
    period : mesh cycles in a period of the signal
    most : largest number
    """
    # Samples that are no whole number in a mesh cycle fill in its phases.
    phases = np.unique(np.round(_DIFFERENT * cycles) % _DIFFERENT).size
    enough = (cycles.size / _PER_NUMBER - 1.0) / (2 * period)
    return int(max(min(most, _PER_PHASE * phases, enough), 0.0))


def compared_orders(
    pair: GearPair, cycles: FloatArray, mesh_cycles: int, most: int = MESH_ORDERS
) -> FloatArray:
    """Return the orders (m,) at which curves of the whole mesh are compared, in mesh orders.

    Parameters
    ----------
    pair : the gear pair
    cycles : (k,) mesh cycles of the samples
    mesh_cycles : mesh cycles in the period of our motion; the orders are whole numbers over ``mesh_cycles``
    most : largest mesh order

    Raises
    ------
    ParameterError : the samples do not resolve a single mesh order
    """
    count = resolved_orders(cycles, most=most)
    if count < 1:
        allowed = "several samples in each mesh cycle"
        raise refuse("theirs", f"{cycles.size} samples", allowed, "Sample faster, or longer.")
    orders = np.arange(1.0, count + 1.0)
    if pair.healthy is pair or mesh_cycles == 1:
        return orders
    extra = [
        mesh_order + sign * number / teeth
        for teeth in (pair.pinion.teeth, pair.gear.teeth)
        # Half a turn more than one turn tells a shaft order from the mean.
        if np.ptp(cycles) >= 1.5 * teeth
        for mesh_order in range(count + 1)
        for number in range(1, _SHAFT_ORDERS + 1)
        for sign in (-1, 1)
        if mesh_order + sign * number / teeth > 0.0
    ]
    # Orders of both shafts that are equal count once.
    every = np.round(np.concatenate([orders, extra]) * mesh_cycles) / mesh_cycles
    return np.unique(every)


def orders_of_channel(
    channel: Channel,
    cycles: FloatArray,
    orders: FloatArray,
    motion: MotionCurves,
    shift: float,
    most_orders: int = MESH_ORDERS,
) -> ComplexOrders:
    """Return the complex orders of a channel.

    Parameters
    ----------
    channel : the channel
    cycles : (k,) mesh cycles of its samples
    orders : (m,) to fit for a channel of the whole mesh
    motion : motion of ours, which says when a tooth pair is in contact
    shift : mesh cycles from the moment when pair A was at A to mesh cycle 0 of the samples; only a channel of
        a tooth pair depends on it
    most_orders : largest mesh order of a channel of a tooth pair

    Raises
    ------
    ParameterError : too few samples, or a tooth pair that the samples never show in contact
    """
    if channel.tooth_pair is None:
        period = motion.mesh_cycles if orders.size and (orders % 1.0).any() else 1
        values = without_ramp(cycles, channel.values) if channel.kind.is_rotation else channel.values
        return complex_orders(cycles, values, orders, period=period)
    period = motion.ahead.size
    first = int(motion.ahead.min())
    if motion.recurrence < period:
        action = "Count the mesh cycles until the same labelled pair is in contact again."
        raise refuse("recurrence", motion.recurrence, f">= {period}", action)
    since = motion.age(cycles + shift, channel.tooth_pair)
    # The shift is known to a bin: what seems to be a bin before the first contact may be the first contact.
    since = np.where(since >= motion.recurrence + first - BIN, since - motion.recurrence, since)
    inside = since < first - BIN + period
    most = resolved_orders(cycles[inside], period, most_orders)
    if most < 1:
        allowed = f"curves in which pair {channel.tooth_pair} is in contact for many samples"
        refused = f"{np.count_nonzero(inside)} samples in contact"
        raise refuse(f"channel {channel.name}", refused, allowed, "Give more; check pair and recurrence.")
    passed = cycles[inside] + shift - PAIR_LABELS.index(channel.tooth_pair) - first + BIN
    engagement = np.floor(passed / motion.recurrence).astype(np.int64)
    while True:
        # Less the shift, so that one shift puts our motion in the phase of every channel.
        fractions = np.arange(1, most * period + 1) / period
        try:
            return complex_orders(
                since[inside] - shift, channel.values[inside], fractions, period=period, blocks=engagement
            )
        except ParameterError:  # the samples leave out a part of the engagement
            if most == 1:
                raise
            most = most // 2


def shows_contact(channel: Channel, cycles: FloatArray, motion: MotionCurves, shift: float) -> bool:
    """Return whether the samples of a channel show its tooth pair in contact from end to end.

    Arguments as of ``orders_of_channel``. A channel of the whole mesh always does.
    """
    if channel.tooth_pair is None:
        return True
    first = int(motion.ahead.min())
    since = motion.age(cycles + shift, channel.tooth_pair) - first
    places = np.unique(np.floor(_PLACES * since[since < motion.ahead.size]).astype(np.int64))
    return bool(places.size >= _SEEN * _PLACES * motion.ahead.size)


def orders_of_motion(motion: MotionCurves, channel: Channel, like: ComplexOrders) -> ComplexOrders:
    """Return the orders of a motion of ours at the orders ``like`` of a channel.

    An order that the motion does not have, such as a shaft order of like teeth, is 0.
    """
    if channel.tooth_pair is None:
        every = motion.orders(channel.quantity, int(np.ceil(like.orders.max())))
        places = like.orders * motion.mesh_cycles
        index = np.round(places).astype(np.int64) - 1
        has = (np.abs(places - np.round(places)) < _WHOLE) & (index >= 0) & (index < every.orders.size)
        amplitudes = np.zeros(like.orders.size, dtype=np.complex128)
        amplitudes[has] = every.values[index[has]]
        none = np.zeros((2 * amplitudes.size, 2 * amplitudes.size))
        return ComplexOrders(like.orders, amplitudes, every.mean, none, like.period)
    phases = np.arange(_SAMPLES * like.period) / _SAMPLES
    label = PAIR_LABELS[0]  # all labels have the same life
    # The end of the period is before A.
    phases -= like.period * (phases >= int(motion.ahead.min()) + like.period)
    values = motion.at(channel.quantity, phases, label)
    return orders_of_period(values, round(like.orders.size / like.period), like.period)


def white_noise(values: FloatArray) -> float:
    """Return the standard deviation of white noise on a smooth curve, by its third differences.

    The median is blind to the few samples at jumps. A third difference of white noise has 20 times its
    variance, and the median of the size of a normal number is 0.6745 of its standard deviation.
    """
    differences = np.abs(np.diff(values, 3))
    return float(np.median(differences)) / (0.6745 * np.sqrt(20.0)) if differences.size else 0.0


def noise_in_orders(values: FloatArray, orders: int) -> float:
    """Return the root of the expected square of white noise in a number of complex orders of samples (k,).

    A complex amplitude of k samples with white noise has the variance 4 noise^2/k.
    """
    return white_noise(values) * float(np.sqrt(4.0 * orders / values.size))


def coarse_shift(channels: Sequence[Channel], cycles: FloatArray, motion: MotionCurves) -> float:
    """Return the shift with the best correlation, to a bin; 0 for channels without tooth pairs."""
    if all(channel.tooth_pair is None for channel in channels):
        return 0.0
    count = round(motion.recurrence / BIN)
    index = np.floor(np.mod(cycles, motion.recurrence) / BIN).astype(np.int64) % count
    filled = np.maximum(np.bincount(index, minlength=count), 1)
    total = np.zeros(count)
    middles = (np.arange(count) + 0.5) * BIN
    for channel in channels:
        mean = np.bincount(index, weights=channel.values - channel.values.mean(), minlength=count) / filled
        model = motion.at(channel.quantity, middles, channel.tooth_pair)
        model = model - model.mean()
        size = float(np.linalg.norm(mean) * np.linalg.norm(model))
        if size > 0.0:
            total += np.fft.irfft(np.fft.rfft(mean).conj() * np.fft.rfft(model), count) / size
    return float(total.argmax()) * BIN


def without_ramp(cycles: FloatArray, values: FloatArray) -> FloatArray:
    """Return the values of a rotation less its constant speed and its drift.

    Curves of about one mesh cycle cannot tell a line from the orders: there the line joins both ends, if the
    line is most of the curve.
    """
    reach = max(float(np.ptp(cycles)), 1e-300)
    if reach >= _LINE_AND_ORDERS:
        middle = cycles - cycles.mean()
        parabola = np.stack([middle, middle**2], axis=1)
        return np.asarray(values - parabola @ _rotation(cycles, values))
    rise = (values[-1] - values[0]) / reach
    line = rise * (cycles - cycles[0])
    return np.asarray(values - line) if abs(rise) * reach > float(np.ptp(values - line)) else values


def uniform_rate(cycles: FloatArray, values: FloatArray) -> float:
    """Return the constant speed of a rotation [rad per mesh cycle]."""
    reach = float(np.ptp(cycles))
    if reach >= _LINE_AND_ORDERS:
        return float(_rotation(cycles, values)[0])
    return float(values[-1] - values[0]) / max(reach, 1e-300)


def drift(cycles: FloatArray, values: FloatArray) -> float:
    """Return how far a rotation leaves its constant speed at both ends of the curves [rad].

    Torques that do not balance make it drift. 0 for curves of about one mesh cycle.
    """
    reach = float(np.ptp(cycles))
    if reach < _LINE_AND_ORDERS:
        return 0.0
    return abs(float(_rotation(cycles, values)[1])) * (0.5 * reach) ** 2


def rate_of_drift(cycles: FloatArray, values: FloatArray) -> float:
    """Return half of the constant acceleration of a rotation [rad per square mesh cycle]."""
    return float(_rotation(cycles, values)[1])


def _rotation(cycles: FloatArray, values: FloatArray) -> FloatArray:
    """Coefficients (2,) of the line and the parabola about the middle of a rotation.

    They are fitted together with the mesh orders: alone they would bend to the vibration.
    """
    orders = np.arange(1.0, max(resolved_orders(cycles), 1) + 1.0)
    angle = 2.0 * np.pi * np.multiply.outer(cycles, orders)
    middle = cycles - cycles.mean()
    parabola = np.stack([np.ones(cycles.size), middle, middle**2], axis=1)
    columns = np.hstack([parabola, np.cos(angle), np.sin(angle)])
    fit = np.linalg.lstsq(columns, values - values.mean(), rcond=None)[0]
    return np.asarray(fit[1:3], dtype=np.float64)
