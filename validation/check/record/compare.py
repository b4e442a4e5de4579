"""Compare a measured record with the prediction: fit both by mesh orders, bring them into one phase.

The motion of the record is its mesh orders, fitted to all samples: the fit averages out noise and
everything that differs from tooth to tooth. The motion of the prediction is the mean mesh cycle of its
period; where teeth differ, this is the average over all teeth. All channels have the same shift in time,
the shift with the best correlation. Means are not compared: encoders and accelerometers have no zero.

Terms: ASME V&V 20-2009, eqs. 1-5-2 to 1-5-5; docs/how_to/measured_data.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from lumped.errors import refuse
from lumped.fields.units import to_stated
from lumped.schema.pair import GearPair, stated_unit
from lumped.typing import BoolArray, ComplexArray, FloatArray
from validation.check.curve_orders import (
    BIN,
    coarse_shift,
    orders_of_channel,
    orders_of_motion,
    resolved_orders,
)
from validation.check.curves import Channel, Curves
from validation.check.mesh_frequency import mesh_frequency, nominal_cycles, shown_speed
from validation.check.motion_curves import MotionCurves
from validation.check.record.channel import (
    NOT_VARIED,
    SHARE,
    ChannelComparison,
    PeakToPeak,
    noise_factor,
)
from validation.check.record.comparison import RecordComparison
from validation.prediction.motion import Prediction
from validation.prediction.uncertainty import Varied
from validation.signals.complex_orders import ComplexOrders, channel_scale, common_shift

#: Most mesh orders of a record.
_ORDERS = 40
#: Largest difference of speed and torque between record and pair, as a share.
_SAME = 0.01


def compare_record(
    record: Curves,
    prediction: Prediction,
    *,
    numerical: float = 0.0,
    varied: Varied | None = None,
    shift: float | None = None,
) -> RecordComparison:
    """Compare every channel of a record with the prediction.

    Parameters
    ----------
    record : the record, at the speed and torque of the prediction's pair
    prediction : motion from ``validation.prediction.motion.predict``
    numerical : standard uncertainty of every predicted amplitude by the numerics, as a share of the amplitude
    varied : predictions with varied inputs, from ``sampled_predictions``; None: the inputs were not varied
    shift : mesh cycles from the moment when pair A was at A to the first sample of the record; default: the
        shift with the best correlation. All channels have the same shift

    Raises
    ------
    ParameterError : a record of another speed or torque, or of too few samples
    """
    check_record(record, prediction.pair)
    channels = sorted(record.channels, key=lambda channel: channel.quantity != "dte")  # the first leads
    motion = mean_motion(prediction, record.recurrence)
    factor = mesh_frequency(record, prediction.pair, mistakes=False).factor
    cycles = factor * nominal_cycles(record, prediction.pair)
    first_shift = coarse_shift(channels, cycles, motion) if shift is None else shift
    signals = _common_orders(motion, channels, cycles, first_shift)
    scales = [
        channel_scale(signal.measured.size, signal.predicted.size, _static_value(prediction, channel))
        for channel, signal in zip(channels, signals, strict=True)
    ]
    if shift is None:
        # With a channel of one tooth pair the coarse shift is right to a bin, else any shift is possible.
        near = (first_shift, 2.0 * BIN) if any(channel.tooth_pair for channel in channels) else None
        measured = [signal.measured for signal in signals]
        predicted = [signal.predicted for signal in signals]
        shift = common_shift(measured, predicted, scales, near=near)
    moves = None if varied is None else _moves(varied, channels, signals, scales, record.recurrence)
    compared = sum(signal.resolved.orders.size for signal in signals)
    comparisons = []
    for j, (channel, signal) in enumerate(zip(channels, signals, strict=True)):
        in_phase = signal.predicted.shifted(shift)
        move = None if moves is None else moves[j]
        comparisons.append(
            ChannelComparison(
                name=channel.name,
                quantity=channel.quantity,
                unit=channel.kind.unit,
                words=channel.kind.words,
                measured=signal.measured,
                predicted=in_phase,
                by_inputs=_covariance_by_inputs(in_phase, scales[j], move, shift),
                numerical=numerical,
                scale=scales[j],
                peak_to_peak=_peak_to_peak(signal.measured, in_phase, move, numerical),
                compared=compared,
                varied=varied is not None,
            )
        )
    return RecordComparison(
        record.name, tuple(comparisons), shift, varied is not None, prediction.mesh_cycles
    )


def check_record(record: Curves, pair: GearPair) -> None:
    """Refuse a record with another speed or torque than the pair, or with too few samples.

    The stated speed is compared, and the speed that the mesh orders of the samples show.
    """
    for name, recorded in (("pinion_speed", record.pinion_speed), ("pinion_torque", record.pinion_torque)):
        operating = float(getattr(pair.operating, name))
        if recorded is not None and abs(recorded / operating - 1.0) > _SAME:
            unit = str(stated_unit(f"operating.{name}"))
            theirs, ours = (f"{to_stated(one, unit):.5g} {unit}" for one in (recorded, operating))
            action = "Give the speed and the torque of the record to the pair."
            raise refuse(f"record.{name}", theirs, f"{ours} within 1 %", action)
    if resolved_orders(nominal_cycles(record, pair)) < 1:
        refused = f"{record.places.size} samples"
        raise refuse("data", refused, "several in each mesh cycle", "Sample faster, or longer.")
    shown = shown_speed(record, pair)
    if shown is not None:
        stated = to_stated(pair.operating.pinion_speed, "rpm")
        raise refuse(
            "record.pinion_speed", f"{stated:.5g} rpm",
            f"the speed of the samples, whose mesh orders are those of about {stated * shown:.4g} rpm",
            "Correct the speed in the description.",
        )  # fmt: skip


def mean_motion(prediction: Prediction, recurrence: int | None = None) -> MotionCurves:
    """Return the motion averaged over the mesh cycles of its period."""
    again = recurrence or prediction.pair.pinion.teeth
    return MotionCurves.of(prediction.pair, prediction.cycle, prediction.mesh_cycles, again).mean_cycle()


class _Signals(NamedTuple):
    """Complex orders of one channel.

    Attributes
    ----------
    resolved : all orders that the samples of the record resolve
    above_noise : (order,) whether an order of ``resolved`` is compared
    measured, predicted : compared orders of the record and of the prediction
    """

    resolved: ComplexOrders
    above_noise: BoolArray
    measured: ComplexOrders
    predicted: ComplexOrders


def _common_orders(
    motion: MotionCurves,
    channels: Sequence[Channel],
    cycles: FloatArray,
    shift: float,
) -> list[_Signals]:
    """Orders of record and prediction, channel by channel.

    ``motion``: predicted motion over the mesh cycle; ``cycles``: mesh cycle of each sample of the record.
    """
    orders = np.arange(1.0, resolved_orders(cycles, most=_ORDERS) + 1.0)
    resolved = [orders_of_channel(channel, cycles, orders, motion, shift, _ORDERS) for channel in channels]
    compared = sum(measured.orders.size for measured in resolved)
    signals = []
    for channel, measured in zip(channels, resolved, strict=True):
        predicted = orders_of_motion(motion, channel, measured)
        above_noise = _above_noise(measured, predicted, compared)
        signals.append(
            _Signals(measured, above_noise, measured.only(above_noise), predicted.only(above_noise))
        )
    return signals


def _above_noise(measured: ComplexOrders, predicted: ComplexOrders, compared: int) -> BoolArray:
    """(order,) whether an order is compared: the record or the prediction exceeds the noise of the record.

    Large predicted orders are compared too. All other orders of the record are noise, which would raise the
    peak to peak of the motion. ``compared``: number of orders of all channels.
    """
    noise = np.sqrt([np.trace(measured.block(j)) for j in range(measured.orders.size)])
    limit = noise_factor(compared) * noise
    large = predicted.amplitudes > SHARE * predicted.size
    above_noise = (measured.amplitudes > limit) | (predicted.amplitudes > limit) | large
    if not above_noise.any():  # of a channel that the prediction leaves at rest
        above_noise[measured.amplitudes.argmax()] = True
    return np.asarray(above_noise)


def _static_value(prediction: Prediction, channel: Channel) -> float:
    """Static value that bounds the scale of a channel from below: mesh force [N] or mean deflection [m]."""
    if channel.kind.unit == "N":
        return prediction.static_force
    return abs(float(prediction.cycle["dte"].mean()))


class _Move(NamedTuple):
    """Change of one channel with each sample of the inputs.

    Attributes
    ----------
    orders : (sample, order) change of the complex orders
    peak_to_peak : (sample,) change of the peak to peak
    """

    orders: ComplexArray
    peak_to_peak: FloatArray


def _moves(
    varied: Varied,
    channels: Sequence[Channel],
    signals: Sequence[_Signals],
    scales: Sequence[float],
    recurrence: int | None,
) -> list[_Move]:
    """Change of each channel with the inputs, less the change of the phase that all channels share."""

    def orders_of(prediction: Prediction) -> list[ComplexOrders]:
        motion = mean_motion(prediction, recurrence)
        return [
            orders_of_motion(motion, channel, signal.resolved).only(signal.above_noise)
            for channel, signal in zip(channels, signals, strict=True)
        ]

    nominal = orders_of(varied.given)
    samples = []
    for sample in map(orders_of, varied.samples):
        # Other inputs move the phase of all channels: a record does not tell it from its own phase.
        shift = common_shift(nominal, sample, scales, near=(0.0, 0.5))
        samples.append([orders.shifted(shift) for orders in sample])
    return [
        _Move(
            orders=np.array([sample[j].values - orders.values for sample in samples]),
            peak_to_peak=np.array([sample[j].peak_to_peak - orders.peak_to_peak for sample in samples]),
        )
        for j, orders in enumerate(nominal)
    ]


def _covariance_by_inputs(
    predicted: ComplexOrders, scale: float, move: _Move | None, shift: float
) -> FloatArray:
    """(order, 2, 2) covariance of real and imaginary parts by the inputs. ``move`` None: not varied."""
    if move is None:
        return np.tile((NOT_VARIED * scale) ** 2 * np.eye(2), (predicted.orders.size, 1, 1))
    in_phase = move.orders * np.exp(2j * np.pi * predicted.orders * shift)
    parts = np.stack([in_phase.real, in_phase.imag], axis=2)
    return np.asarray(np.einsum("smi,smj->mij", parts, parts) / len(parts))


def _peak_to_peak(
    measured: ComplexOrders, predicted: ComplexOrders, move: _Move | None, numerical: float
) -> PeakToPeak:
    """Both peaks to peak with their uncertainties. ``move`` None: the inputs were not varied."""
    swing = measured.peak_to_peak
    expected = predicted.peak_to_peak
    return PeakToPeak(
        measured=swing,
        predicted=expected,
        record=measured.peak_to_peak_deviation,
        inputs=NOT_VARIED * swing if move is None else _deviation(move.peak_to_peak),
        numerical=numerical * expected,
    )


def _deviation(changes: FloatArray) -> float:
    """Root mean square of changes about the nominal prediction, which need not be the mean of the samples."""
    return float(np.sqrt(np.mean(changes**2)))
