"""Mesh orders of a record, and of the prediction at the same orders.

A channel of one tooth pair is taken over the mesh cycles of each engagement, one for each place of a tooth
pair in the motion. The orders of such a channel are therefore fractions of mesh orders.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from lumped.errors import refuse
from lumped.fields.units import to_stated
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray, IntArray
from validation.measurements.comparison import Prediction as Curves
from validation.measurements.comparison import mesh_cycles
from validation.measurements.record import PAIR_LABELS, QUANTITIES, Channel, Measurement
from validation.prediction.motion import Prediction
from validation.signals.complex_orders import ComplexOrders, complex_orders, orders_of_period

#: Most mesh orders of a record.
_ORDERS = 40
#: Most mesh orders for each different phase of the samples.
_PER_PHASE = 0.3
#: Number of phases of a mesh cycle that count as different.
_DIFFERENT = 1000
#: Least samples for each fitted number.
_PER_NUMBER = 4
#: Largest difference of speed and torque between record and pair, as a share.
_SAME = 0.01
#: Samples of the prediction in a mesh cycle.
_SAMPLES = 512
#: Largest difference between the mesh frequency of the samples and that of the stated speed, as a share.
_OFF = 0.005
#: Mesh orders by which the mesh frequency is found.
_FIRST = 6
#: Trials in a wave of the last of these orders.
_TRIALS = 4.0
#: Mesh cycles of the first search; later searches take four times as many each.
_SHORT = 64.0
#: Another speed is searched within this share of the stated speed.
_FAR = 0.05
#: The orders must carry this share more at another frequency than at the stated frequency.
_BETTER = 1e-3
#: Mesh cycles in a bin of the search for the coarse shift.
BIN = 1.0 / 32.0


def check_record(measurement: Measurement, pair: GearPair) -> None:
    """Refuse a record with another speed or torque than the pair, or with too few samples.

    The stated speed is compared, and the speed that the mesh orders of the samples show.
    """
    spec = measurement.spec
    for name, recorded in (("pinion_speed", spec.pinion_speed), ("pinion_torque", spec.pinion_torque)):
        operating = float(getattr(pair.operating, name))
        if abs(recorded / operating - 1.0) > _SAME:
            action = "Give the speed and the torque of the record to the pair."
            raise refuse(f"measurement.{name}", f"{recorded:.5g}", f"{operating:.5g} within 1 %, SI", action)
    if _resolved(mesh_cycles(measurement, pair)) < 1:
        refused = f"{measurement.abscissa.size} samples"
        raise refuse("data", refused, "several in each mesh cycle", "Sample faster, or longer.")
    _refuse_other_speed(measurement, pair)


def cycles_in_step(measurement: Measurement, pair: GearPair) -> FloatArray:
    """Return the mesh cycles (k,) of the samples, at the mesh frequency of the samples.

    A speed that is stated 0.1 % too high makes the orders average out over 500 mesh cycles. The mesh
    frequency is therefore the frequency within 0.5 % of the stated speed at which the first mesh orders of
    all channels carry most. If the stated speed explains the samples as well, the frequency of the stated
    speed is taken.
    """
    carried = _Carried.of(measurement, pair)
    cycles = mesh_cycles(measurement, pair)
    if carried is None or carried.reach * _OFF * _TRIALS < 0.5:
        return cycles
    factor = 1.0
    width = _OFF
    length = min(_SHORT, carried.reach)
    while True:
        factor, width = carried.strongest(factor, width, length)
        if length >= carried.reach:
            break
        length = min(4.0 * length, carried.reach)
    fine = minimize_scalar(
        lambda one: -carried(float(one), carried.reach), bounds=(factor - width, factor + width),
        method="bounded", options={"xatol": 1e-3 * width},
    )  # fmt: skip
    better = -float(fine.fun) > (1.0 + _BETTER) * carried(1.0, carried.reach)
    return cycles * float(fine.x) if better else cycles


def _refuse_other_speed(measurement: Measurement, pair: GearPair) -> None:
    """Refuse a record whose motion is mostly at the mesh orders of another speed."""
    carried = _Carried.of(measurement, pair)
    if carried is None:
        return
    length = min(_SHORT, carried.reach)
    other, _ = carried.strongest(1.0, _FAR, length)
    near, _ = carried.strongest(1.0, _OFF, length)
    most = carried(other, length)
    if most > 0.5 and most > 4.0 * carried(near, length):
        stated = to_stated(measurement.spec.pinion_speed, "rpm")
        raise refuse(
            "measurement.pinion_speed", f"{stated:.5g} rpm",
            f"the speed of the samples, whose mesh orders are those of about {stated * other:.4g} rpm",
            "Correct the speed in the description.",
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class _Carried:
    """Share of the variation that the first mesh orders carry, over a factor on the mesh frequency."""

    cycles: FloatArray
    values: FloatArray
    orders: IntArray

    @classmethod
    def of(cls, measurement: Measurement, pair: GearPair) -> _Carried | None:
        """Return the share for the channels that belong to no tooth pair. None: there is no such channel."""
        cycles = mesh_cycles(measurement, pair)
        values = [measurement.channels[one.name] for one in measurement.spec.channel if one.pair is None]
        if not values:
            return None
        return cls(cycles - cycles[0], np.stack(values), np.arange(1, min(_FIRST, _resolved(cycles)) + 1))

    @property
    def reach(self) -> float:
        """Mesh cycles of the record."""
        return float(self.cycles[-1])

    def __call__(self, factor: float, length: float) -> float:
        """Return the mean share of all channels over the first ``length`` mesh cycles."""
        count = int(np.searchsorted(self.cycles, length, side="right"))
        part = self.values[:, :count] - self.values[:, :count].mean(axis=1, keepdims=True)
        power = np.maximum(np.sum(part**2, axis=1), 1e-300)
        first = np.exp(-2j * np.pi * factor * self.cycles[:count])
        power_of_orders = sum(np.abs(part @ first**m) ** 2 for m in self.orders)
        return float(np.mean(2.0 * power_of_orders / (count * power)))

    def strongest(self, about: float, width: float, length: float) -> tuple[float, float]:
        """Return the factor with the largest share, within ``about`` +- ``width``; then the step."""
        step = 1.0 / (_TRIALS * float(self.orders[-1]) * length)
        trials = about + step * np.arange(-np.floor(width / step), np.floor(width / step) + 1)
        return float(trials[int(np.argmax([self(float(one), length) for one in trials]))]), step


def mean_mesh_cycle(prediction: Prediction, recurrence: int | None = None) -> Curves:
    """Return the motion averaged over the mesh cycles of its period."""
    count = prediction.mesh_cycles
    cycle = prediction.cycle
    size = cycle.sizes["time"] // count
    names = [name for name in QUANTITIES if name in cycle]
    first = cycle[[*names, "position"]].isel(time=slice(0, size))
    for name in names:
        values = cycle[name].to_numpy()[..., : count * size]
        first[name] = first[name].copy(data=values.reshape(*values.shape[:-1], count, size).mean(axis=-2))
    return Curves(prediction.pair, first, recurrence or prediction.pair.pinion.teeth)


def _resolved(cycles: FloatArray, period: int = 1) -> int:
    """Number of mesh orders that the samples resolve. ``period``: mesh cycles in a period of the signal."""
    # Samples that are no whole number in a mesh cycle fill in its phases.
    phases = np.unique(np.round(_DIFFERENT * cycles) % _DIFFERENT).size
    enough = (cycles.size / _PER_NUMBER - 1.0) / (2 * period)
    return int(max(min(_ORDERS, _PER_PHASE * phases, enough), 0.0))


def measured_orders(
    values: FloatArray, cycles: FloatArray, curves: Curves, channel: Channel, shift: float
) -> ComplexOrders:
    """Return the orders of a channel, of one tooth pair over as many mesh cycles as pairs are in contact."""
    if channel.pair is None:
        return complex_orders(cycles, values, np.arange(1, _resolved(cycles) + 1))
    period = curves.ahead.size
    first = int(curves.ahead.min())
    if curves.recurrence < period:
        action = "Count the mesh cycles until the same labelled pair is in contact again."
        raise refuse("measurement.recurrence", curves.recurrence, f">= {period}", action)
    since = curves.since(cycles + shift, channel.pair)
    inside = since < first + period
    most = _resolved(cycles[inside], period)
    if most < 1:
        allowed = f"a record in which pair {channel.pair} is in contact for many samples"
        refused = f"{np.count_nonzero(inside)} samples in contact"
        raise refuse(f"channel.{channel.name}", refused, allowed, "Record longer; check pair and recurrence.")
    passed = cycles[inside] + shift - PAIR_LABELS.index(channel.pair) - first
    engagement = np.floor(passed / curves.recurrence).astype(np.int64)
    # Less the shift, so that one shift puts the prediction in the phase of every channel.
    orders = np.arange(1, most * period + 1) / period
    return complex_orders(since[inside] - shift, values[inside], orders, period=period, blocks=engagement)


def predicted_orders(curves: Curves, channel: Channel, like: ComplexOrders) -> ComplexOrders:
    """Return the orders of the prediction at the orders ``like`` of a measured channel."""
    phases = np.arange(_SAMPLES * like.period) / _SAMPLES
    label = None if channel.pair is None else PAIR_LABELS[0]  # all labels have the same life
    if label is not None:  # the end of the period is before A
        phases -= like.period * (phases >= int(curves.ahead.min()) + like.period)
    values = curves.value(channel.quantity, phases, label)
    return orders_of_period(values, round(like.orders.size / like.period), like.period)


def coarse_shift(
    measurement: Measurement, cycles: FloatArray, curves: Curves, channels: Sequence[Channel]
) -> float:
    """Return the shift with the best correlation, to a bin; 0 for a record without tooth pairs."""
    if all(one.pair is None for one in channels):
        return 0.0
    count = round(curves.recurrence / BIN)
    index = np.floor(np.mod(cycles, curves.recurrence) / BIN)
    index = index.astype(np.int64) % count
    filled = np.maximum(np.bincount(index, minlength=count), 1)
    total = np.zeros(count)
    middles = (np.arange(count) + 0.5) * BIN
    for one in channels:
        values = measurement.channels[one.name]
        mean = np.bincount(index, weights=values - values.mean(), minlength=count) / filled
        model = curves.value(one.quantity, middles, one.pair)
        model = model - model.mean()
        size = float(np.linalg.norm(mean) * np.linalg.norm(model))
        if size > 0.0:
            total += np.fft.irfft(np.fft.rfft(mean).conj() * np.fft.rfft(model), count) / size
    return float(total.argmax()) * BIN
