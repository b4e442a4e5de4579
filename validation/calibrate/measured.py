"""Records as data of a fit: of curves complex mesh orders of each channel, with the noise of each order.

Sources: docs/how_to/calibrate.md, "What is compared".
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from scipy.linalg import block_diag

from lumped.errors import ParameterError, SpurcheckError, refuse
from lumped.fields.units import to_stated
from lumped.schema.pair import GearPair
from lumped.typing import ComplexArray, FloatArray
from validation.calibrate.data import LEFT_OVER, Data, Loading, Unexplained
from validation.calibrate.values_at_speed import values_at_speeds
from validation.check.curve_orders import (
    BIN,
    coarse_shift,
    orders_of_channel,
    orders_of_motion,
    resolved_orders,
)
from validation.check.curves import Channel, Curves, ValuesOverSpeed
from validation.check.mesh_frequency import mesh_frequency, nominal_cycles
from validation.check.reading.reader import read
from validation.check.record.channel import UNKNOWN, noise_factor
from validation.check.record.compare import check_record, mean_motion
from validation.files.formatting import quantity as printed
from validation.prediction.motion import Prediction, predicted
from validation.signals.complex_orders import ComplexOrders, common_shift
from validation.signals.fitted import Fitted

#: Highest mesh order that is fitted. All orders that the samples resolve are computed, so that higher orders
#: do not count as noise.
ORDERS = 6
_RESOLVED = 40
#: Standard uncertainty of each part of an order by the numerics and by the speed of the record, as a share of
#: the largest order of the channel.
_FLOOR = 2e-3
#: Least number of mesh cycles of a record.
_CYCLES = 8
#: Samples in a mesh cycle of a motion: 16 for each of the fitted orders.
SAMPLES = 128
#: Records of the same channels whose orders differ by less than this share are the same record.
_SAME = 1e-9

Argument = TypeVar("Argument")
Result = TypeVar("Result")


@dataclass(frozen=True, eq=False)
class MeasuredChannel:
    """One channel of a record.

    Attributes
    ----------
    channel : the channel with its samples
    orders : complex orders up to mesh order ``ORDERS``, in the phase of the record, with the noise
    scale : amplitude of the largest order, in the unit of the channel
    """

    channel: Channel
    orders: ComplexOrders
    scale: float

    @property
    def key(self) -> tuple[str, str | None]:
        """What the channel measures: the same in every record."""
        return self.channel.quantity, self.channel.tooth_pair

    @property
    def noise(self) -> FloatArray:
        """(2 k, 2 k) covariance of the real parts, then the imaginary parts, by noise and numerics."""
        count = 2 * self.orders.orders.size
        return self.orders.covariance + (_FLOOR * self.scale) ** 2 * np.eye(count)


@dataclass(frozen=True, eq=False)
class Measured:
    """A record of curves as data of a fit.

    Attributes
    ----------
    name : name of the record
    pair : the pair at the speed and torque of the record
    channels : channels of the record
    recurrence : mesh cycles until the same teeth meet again; None: not stated
    near : centre and reach of the possible shifts [mesh cycles]; None: all shifts
    """

    name: str
    pair: GearPair
    channels: tuple[MeasuredChannel, ...]
    recurrence: int | None
    near: tuple[float, float] | None

    @property
    def words(self) -> str:
        """Name, speed and torque."""
        operating = self.pair.operating
        rpm = to_stated(operating.pinion_speed, "rpm")
        return f"{self.name} ({rpm:.5g} rpm, {operating.pinion_torque:.4g} N m)"

    @property
    def values(self) -> FloatArray:
        """(n,) data: for each channel the real parts, then the imaginary parts."""
        return np.concatenate([parts_of(one.orders.values) for one in self.channels])

    @property
    def quantities(self) -> frozenset[str]:
        """Quantities of the channels."""
        return frozenset(one.key[0] for one in self.channels)

    @property
    def noise(self) -> FloatArray:
        """(n, n) covariance of the data by noise and numerics."""
        return np.asarray(block_diag(*(one.noise for one in self.channels)))

    @property
    def scales(self) -> FloatArray:
        """(n,) largest order of the channel of each number."""
        return np.concatenate([np.full(2 * one.orders.orders.size, one.scale) for one in self.channels])

    @property
    def samples(self) -> int:
        """Samples in a mesh cycle: 16 for each of the fitted orders."""
        return SAMPLES

    @property
    def shifts(self) -> int:
        """One: the shift in time."""
        return 1

    @property
    def noise_shares(self) -> list[float]:
        """Standard deviation of the noise of an order of each channel over its largest order."""
        return [
            float(np.sqrt(np.trace(one.orders.covariance) / (2.0 * one.orders.orders.size)) / one.scale)
            for one in self.channels
        ]

    @property
    def loadings(self) -> list[Loading]:
        """An error of each complex order, in its phase; see ``validation.calibrate.discrepancy``."""
        found = []
        start = 0
        for channel in self.channels:
            count = channel.orders.orders.size
            for j, (order, value) in enumerate(
                zip(channel.orders.orders, channel.orders.values, strict=True)
            ):
                size = np.sqrt(0.5 * (channel.scale**2 + abs(value) ** 2))
                turn = size * (value / abs(value) if abs(value) > 0.0 else 1.0)
                factors = np.array([[turn.real, -turn.imag], [turn.imag, turn.real]])
                quantity, tooth_pair = channel.key
                key = (quantity, tooth_pair or "", f"order {order:g}")
                found.append(Loading(key, (start + j, start + j + count), factors))
            start += 2 * count
        return found

    def predicted(self, prediction: Prediction) -> tuple[FloatArray, FloatArray]:
        """Return the data (n,) that a prediction gives in the phase of the record, and their slope.

        The slope (n, 1) is the change by the shift, for each mesh cycle.
        """
        motion = mean_motion(prediction, self.recurrence)
        ours = [orders_of_motion(motion, one.channel, one.orders) for one in self.channels]
        measured = [one.orders for one in self.channels]
        scales = [one.scale for one in self.channels]
        shift = common_shift(measured, ours, scales, near=self.near)
        shifted = [one.values * np.exp(2j * np.pi * one.orders * shift) for one in ours]
        slopes = [2j * np.pi * one.orders * values for one, values in zip(ours, shifted, strict=True)]
        return (
            np.concatenate([parts_of(values) for values in shifted]),
            np.concatenate([parts_of(values) for values in slopes])[:, None],
        )

    def fitted(self, fitted: FloatArray) -> Fitted:
        """Return the amplitudes of the first channel beside fitted data (n,)."""
        channel = self.channels[0]
        orders = channel.orders
        size = orders.orders.size
        noise = np.sqrt([float(np.trace(orders.block(j))) / 2.0 for j in range(size)])
        ours = np.hypot(fitted[:size], fitted[size : 2 * size])
        kind = channel.channel.kind
        return Fitted(orders.orders, orders.amplitudes, noise, ours, kind.words, kind.unit, "mesh order")

    def unexplained(self, fitted: FloatArray, count: int) -> Iterator[Unexplained]:
        """Orders, out of ``count``, in which fitted data (n,) miss the record by more than its noise."""
        start = 0
        for channel in self.channels:
            orders = channel.orders
            size = orders.orders.size
            ours = fitted[start : start + size] + 1j * fitted[start + size : start + 2 * size]
            start += 2 * size
            for j, measured in enumerate(orders.values):
                rest = float(abs(ours[j] - measured))
                noise = float(np.sqrt(np.trace(orders.block(j))))
                if not rest > max(noise_factor(count) * noise, LEFT_OVER * channel.scale):
                    continue
                amplitudes = float(abs(measured)), float(abs(ours[j]))
                sizes = [printed(one, channel.channel.kind.unit, 3) for one in amplitudes]
                place = f"order {orders.orders[j]:g}"
                words = (
                    f"{self.name}, {channel.channel.name}: {place} is {sizes[0]}, with the best inputs "
                    f"{sizes[1]}; {100.0 * rest / channel.scale:.0f} % of the largest order is left over."
                )
                yield Unexplained(
                    self.name, channel.channel.name, place, *amplitudes, rest / channel.scale, words
                )


def parts_of(values: ComplexArray) -> FloatArray:
    """Return (2 k,) real parts, then imaginary parts."""
    return np.concatenate([values.real, values.imag])


def measured_records(pair: GearPair, records: Sequence[Any]) -> tuple[Data, ...]:
    """Return records as data of a fit; values over speed are one record for each speed.

    Parameters
    ----------
    pair : the gear pair; speed and torque of each record replace those of the pair
    records : what ``validation.check.reading.reader.read`` reads

    Raises
    ------
    ParameterError : a record that cannot be used: no curves, too few mesh cycles, another speed than stated,
        more noise than motion, the same record twice
    """
    sources = [
        str(one) if isinstance(one, (str, Path)) else f"record {number}"
        for number, one in enumerate(records, 1)
    ]
    named = [_in_source(source, _read, pair, one) for source, one in zip(sources, records, strict=True)]
    names = [one.name for one in named]
    found: list[Data] = []
    for number, (source, record) in enumerate(zip(sources, named, strict=True), 1):
        name = record.name
        if names.count(name) > 1:
            record = replace(record, name=f"{name}, record {number}")
        parts = _in_source(source, _data, pair, record)
        if any(_equal(one, other) for one in parts for other in found):
            action = "Name each record once: twice the same values are no more knowledge."
            raise refuse("records", f"{name} twice", "records that differ", action)
        found += parts
    return tuple(found)


def _in_source(
    source: str, run: Callable[[GearPair, Argument], Result], pair: GearPair, record: Argument
) -> Result:
    """Run a function of pair and record; a refusal names the source of the record."""
    try:
        return run(pair, record)
    except ParameterError as error:
        raise ParameterError(list(error.problems), error.source or source) from None


def _data(pair: GearPair, record: Curves | ValuesOverSpeed) -> list[Data]:
    """A record as data: one part for each speed of a sweep."""
    if isinstance(record, ValuesOverSpeed):
        return list(values_at_speeds(pair, record))
    return [_measured(pair, record)]


def _equal(one: Data, other: Data) -> bool:
    """Whether two records are the same numbers at the same speed."""
    a, b = one.values, other.values
    if a.shape != b.shape or one.pair.operating != other.pair.operating:
        return False
    return bool(np.linalg.norm(a - b) <= _SAME * np.linalg.norm(a))


def _read(pair: GearPair, record: Any) -> Curves | ValuesOverSpeed:
    return record if isinstance(record, (Curves, ValuesOverSpeed)) else read(record, pair)


def _measured(pair: GearPair, curves: Curves) -> Measured:
    if not curves.channels:
        raise refuse("record", "no channel", "at least one curve", "Name the columns of the curves.")
    at = curves.at(pair).healthy
    check_record(curves, at)
    repeats = float(np.ptp(nominal_cycles(curves, at)))
    if repeats < _CYCLES - 1:
        allowed = f"at least {_CYCLES} mesh cycles, whose scatter shows the noise"
        raise refuse("record", f"{repeats:.3g} mesh cycles", allowed, "Record longer.")
    cycles = mesh_frequency(curves, at, mistakes=False).factor * nominal_cycles(curves, at)
    try:
        motion = mean_motion(predicted(at), curves.recurrence)
    except ParameterError:
        raise
    except SpurcheckError as error:
        action = f"Leave the record out. ({error})"
        raise refuse(
            "record", curves.name, "a speed and torque at which the pair has a motion", action
        ) from None
    shift = coarse_shift(curves.channels, cycles, motion)
    labelled = any(channel.tooth_pair for channel in curves.channels)
    orders = np.arange(1.0, resolved_orders(cycles, most=_RESOLVED) + 1.0)
    channels = []
    for channel in curves.channels:
        every = orders_of_channel(channel, cycles, orders, motion, shift, _RESOLVED)
        fitted = every.only(every.orders <= ORDERS)
        scale = float(fitted.amplitudes.max())
        noise = float(np.sqrt(max(np.trace(fitted.covariance), 0.0)))
        if not noise <= UNKNOWN * fitted.size or scale <= 0.0:
            share = (
                f"noise of {100.0 * noise / fitted.size:.0f} % of its motion" if scale > 0.0 else "no motion"
            )
            action = (
                "Check the speed and the numbers of teeth: the motion must repeat with the mesh cycles of "
                "this pair. Else record longer."
            )
            raise refuse(f"channel {channel.name}", share, f"at most {100.0 * UNKNOWN:.0f} %", action)
        channels.append(MeasuredChannel(channel, fitted, scale))
    near = (shift, 2.0 * BIN) if labelled else None
    return Measured(curves.name, at, tuple(channels), curves.recurrence, near)
