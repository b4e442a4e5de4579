"""Records as data of a fit: complex mesh orders of each channel, with the noise of each order.

Sources: docs/how_to/calibrate.md, "What is compared".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from lumped.errors import ParameterError, SpurcheckError, refuse
from lumped.fields.units import to_stated
from lumped.schema.pair import GearPair
from lumped.typing import ComplexArray, FloatArray
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
from validation.check.record.channel import UNKNOWN
from validation.check.record.compare import check_record, mean_motion
from validation.prediction.motion import Prediction, predicted
from validation.signals.complex_orders import ComplexOrders, common_shift

#: Highest mesh order that is fitted. All orders that the samples resolve are computed, so that higher orders
#: do not count as noise.
ORDERS = 6
_RESOLVED = 40
#: Standard uncertainty of each part of an order by the numerics and by the speed of the record, as a share of
#: the largest order of the channel.
_FLOOR = 2e-3
#: Least number of mesh cycles of a record.
_CYCLES = 8
#: Records of the same channels whose orders differ by less than this share are the same record.
_SAME = 1e-9


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
    """A record as data of a fit.

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

    def predicted(self, prediction: Prediction) -> tuple[FloatArray, FloatArray]:
        """Return the data that a prediction gives in the phase of the record, and their slope by the shift.

        Both are (n,), as ``values``. The slope is the change for each mesh cycle.
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
            np.concatenate([parts_of(values) for values in slopes]),
        )


def parts_of(values: ComplexArray) -> FloatArray:
    """Return (2 k,) real parts, then imaginary parts."""
    return np.concatenate([values.real, values.imag])


def measured_records(pair: GearPair, records: Sequence[Any]) -> tuple[Measured, ...]:
    """Return records as data of a fit.

    Parameters
    ----------
    pair : the gear pair; speed and torque of each record replace those of the pair
    records : what ``validation.check.reading.reader.read`` reads

    Raises
    ------
    ParameterError : a record that cannot be used: no curves, too few mesh cycles, another speed than stated,
        more noise than motion, the same record twice
    """
    found: list[Measured] = []
    for number, record in enumerate(records, 1):
        name = str(record) if isinstance(record, (str, Path)) else f"record {number}"
        try:
            one = _measured(pair, record)
        except ParameterError as error:
            raise ParameterError(list(error.problems), error.source or name) from None
        for other in found:
            if _equal(one, other):
                action = "Name each record once: twice the same values are no more knowledge."
                raise refuse("records", f"{one.name} twice", "records that differ", action)
        found.append(one)
    names = [one.name for one in found]
    return tuple(
        one if names.count(one.name) == 1 else _renamed(one, number) for number, one in enumerate(found, 1)
    )


def _renamed(one: Measured, number: int) -> Measured:
    return Measured(f"{one.name}, record {number}", one.pair, one.channels, one.recurrence, one.near)


def _equal(one: Measured, other: Measured) -> bool:
    a, b = one.values, other.values
    return a.shape == b.shape and bool(np.linalg.norm(a - b) <= _SAME * np.linalg.norm(a))


def _measured(pair: GearPair, record: Any) -> Measured:
    curves = record if isinstance(record, (Curves, ValuesOverSpeed)) else read(record, pair)
    if isinstance(curves, ValuesOverSpeed):
        action = "Give curves over time, one record for each speed."
        raise refuse("record", "values over speed", "curves over time or mesh cycles", action)
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
