"""The prediction beside a measured record: every channel, every mesh order, amplitude and phase; one verdict.

The motion of the record is its mesh orders, fitted to all samples: noise, and what differs from tooth to
tooth, is averaged out. The motion of the prediction is the mean mesh cycle of its period, so of teeth that
differ it is the average over all of them. All channels are in one phase, the one with the best correlation.
Means are not compared: encoders and accelerometers have no zero.

In the terms of ASME V&V 20-2009, eqs. 1-5-2 to 1-5-5: D is a value of the record, S the same value of the
prediction, E = S - D, and u_val the root of the sum of the squares of their standard uncertainties by the
record's noise, by the inputs and by the numerics. The error of the model lies within E +- 2 u_val. Here D and
S are the peak to peak of a channel, and each of its complex orders. Limits: docs/how_to/measured_data.md.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cached_property

import numpy as np
import xarray as xr

from lumped.labelling import labelled_dataset
from lumped.typing import BoolArray, ComplexArray, FloatArray
from validation.files.formatting import quantity as printed
from validation.measurements.record import QUANTITIES, Channel, Measurement
from validation.measurements.record_orders import (
    BIN,
    check_record,
    coarse_shift,
    cycles_in_step,
    mean_mesh_cycle,
    measured_orders,
    predicted_orders,
)
from validation.prediction.motion import Prediction
from validation.prediction.uncertainty import Varied
from validation.signals.complex_orders import (
    ComplexOrders,
    channel_scale,
    common_shift,
    misfit,
)

#: Share of the measured value up to which a difference is no contradiction, whatever its uncertainty.
SHARE = 0.10
#: Share of the measured value beyond which 2 u of its noise says nothing of the prediction, and 2 u_val
#: explains nothing: a prediction 27 % off whose inputs leave 40 % is neither right nor wrong.
UNKNOWN = 0.25
#: Standard uncertainty by inputs that were not varied, share of the measured value.
NOT_VARIED = UNKNOWN / 2.0
_AT_LEAST = UNKNOWN * (1.0 - 1e-9)
#: Probability with which noise alone takes any of all orders beyond its limit.
_CHANCE = 0.05


class Record(Enum):
    """What a record says of the prediction; the value is the text that a reader gets."""

    CONFIRMS = "The record confirms the prediction."
    CONTRADICTS = "The record contradicts the prediction."
    TOO_UNCERTAIN = "The comparison is too uncertain to judge the prediction."

    @property
    def text(self) -> str:
        """The meaning, as a sentence."""
        return self.value


@dataclass(frozen=True)
class PeakToPeak:
    """Peak to peak of one channel: D and S of ASME V&V 20, in the unit of the channel.

    Attributes
    ----------
    measured, predicted : D of the record; S of the prediction, over the orders that the record shows
    record, inputs, numerical : standard uncertainties of D by its noise, of S by its inputs and its numerics;
        by inputs that were not varied a share ``NOT_VARIED`` of D
    """

    measured: float
    predicted: float
    record: float
    inputs: float
    numerical: float

    @property
    def error(self) -> float:
        """E = S - D."""
        return self.predicted - self.measured

    @property
    def u_val(self) -> float:
        """Standard uncertainty of E, the root of the sum of the squares of the three."""
        return math.hypot(self.record, self.inputs, self.numerical)

    @property
    def percent(self) -> float:
        """E over the measured value [%]."""
        return 100.0 * self.error / self.measured if self.measured else math.copysign(math.inf, self.error)


@dataclass(frozen=True, eq=False)
class ChannelComparison:
    """One channel of a record beside the prediction.

    Attributes
    ----------
    name, quantity, unit, words : of the record; its quantity, the SI unit of that, and its plain name
    measured, predicted : complex orders, both in the phase of the record
    by_inputs : (order, 2, 2) covariance of the predicted real and imaginary parts by the uncertain inputs;
        isotropic by ``NOT_VARIED`` where they were not varied
    numerical : standard uncertainty of each predicted amplitude by the numerics, over it
    scale : amplitude that the misfit is over, see ``channel_scale``
    peak_to_peak : of both
    compared : number of orders of all channels of the record
    varied : whether the inputs were varied
    """

    name: str
    quantity: str
    unit: str
    words: str
    measured: ComplexOrders
    predicted: ComplexOrders
    by_inputs: FloatArray
    numerical: float
    scale: float
    peak_to_peak: PeakToPeak
    compared: int
    varied: bool

    @property
    def differences(self) -> ComplexArray:
        """(order,) E of each complex order, S - D."""
        return self.predicted.values - self.measured.values

    @property
    def explained(self) -> float:
        """Share of the measured motion that the prediction explains, 1 - misfit^2, at least 0."""
        return max(1.0 - misfit([self.measured], [self.predicted], [self.scale]) ** 2, 0.0)

    @property
    def worst(self) -> int:
        """Place of the order with the largest difference."""
        return int(np.abs(self.differences).argmax())

    @cached_property
    def reach(self) -> FloatArray:
        """(order,) size of a difference that its uncertainty explains.

        Along the difference, in the complex plane: 2 u of inputs and numerics, and so many u of the noise
        that it takes any of all orders further in 5 of 100 records, sqrt(2 ln(orders/0.05)).
        """
        noise, model = self._along(self.differences)
        return np.sqrt((_noise_factor(self.compared) * noise) ** 2 + (2.0 * model) ** 2)

    @property
    def contradicted_orders(self) -> BoolArray:
        """(order,) whether the difference exceeds its uncertainty and a share ``SHARE`` of the motion."""
        return self._apart & (np.abs(self.differences) > self.reach)

    @property
    def contradicts_size(self) -> bool:
        """Whether the peak to peak differs by more than 2 u_val and ``SHARE``; not judged in much noise.

        Noise as large as the motion adds to its peak to peak more than a standard uncertainty tells.
        """
        p = self.peak_to_peak
        return not self.noisy and abs(p.error) > max(2.0 * p.u_val, self._least)

    @property
    def noisy(self) -> bool:
        """Whether the noise of the measured motion is above the share ``UNKNOWN`` of it."""
        noise = math.sqrt(max(float(np.trace(self.measured.covariance)), 0.0))
        swing = 2.0 * self.peak_to_peak.record
        return noise > UNKNOWN * self.measured.size or swing > UNKNOWN * self.peak_to_peak.measured

    @property
    def verdict(self) -> Record:
        """What this channel says alone."""
        if self.contradicts_size or self.contradicted_orders.any():
            return Record.CONTRADICTS
        p = self.peak_to_peak
        # Inputs that were not varied leave as much as UNKNOWN.
        vague = abs(p.error) > self._least and 2.0 * p.u_val >= _AT_LEAST * p.measured
        vague |= bool((self._apart & (self.reach >= _AT_LEAST * self.scale)).any())
        return Record.TOO_UNCERTAIN if self.noisy or vague else Record.CONFIRMS

    @property
    def _least(self) -> float:
        """Difference of peaks to peak up to which there is no contradiction."""
        return SHARE * max(self.peak_to_peak.measured, self.scale)

    @property
    def _apart(self) -> BoolArray:
        return np.asarray(np.abs(self.differences) > SHARE * self.scale)

    def _along(self, directions: ComplexArray) -> tuple[FloatArray, FloatArray]:
        """Standard uncertainty of each order along a complex direction: of the record, of the prediction."""
        unit = directions / np.where(np.abs(directions) > 0.0, np.abs(directions), 1.0)
        ways = np.stack([unit.real, unit.imag], axis=1)
        record = np.array([self.measured.block(j) for j in range(unit.size)])
        noise, model = (np.einsum("mi,mij,mj->m", ways, one, ways) for one in (record, self.by_inputs))
        numerics = (self.numerical * self.predicted.amplitudes) ** 2
        return np.sqrt(np.maximum(noise, 0.0)), np.sqrt(np.maximum(model, 0.0) + numerics)

    def table(self) -> dict[str, FloatArray]:
        """Columns over the orders: amplitudes and phase difference with their standard uncertainties.

        Phases are S less D [rad]; the uncertainty of an amplitude is along it, that of a phase across it. NaN
        is what the inputs would leave, where they were not varied.
        """
        ends = {"measured": self.measured.values, "predicted": self.predicted.values}
        found: dict[str, FloatArray] = {}
        across = np.zeros(self.measured.orders.size)
        for place, (name, values) in enumerate(ends.items()):
            size = np.maximum(np.abs(values), 1e-300)
            found[name] = np.abs(values)
            known = np.nan if place and not self.varied else 1.0
            found[f"{name}_deviation"] = self._along(values)[place] * known
            across = np.hypot(across, self._along(1j * values)[place] / size)
        found["phase_difference"] = np.angle(self.predicted.values * self.measured.values.conj())
        found["phase_deviation"] = np.minimum(across, math.pi) * (1.0 if self.varied else np.nan)
        found["contradicts"] = self.contradicted_orders.astype(np.float64)
        return found

    @property
    def label(self) -> str:
        """The channel with its plain name; of the transmission error that alone."""
        return "transmission error" if self.quantity == "dte" else f"{self.name} ({self.words})"

    @property
    def size_words(self) -> str:
        """Measured and predicted peak to peak, and how far they are apart."""
        p = self.peak_to_peak
        start = "" if self.quantity == "dte" else f"{self.label}: "
        sizes = (
            f"measured {printed(p.measured, self.unit, 3)}, predicted {printed(p.predicted, self.unit, 3)}"
        )
        known = f", known to ±{200.0 * p.u_val / p.measured:.0f} %" if p.measured > 0.0 else ""
        told = known if self.varied and self.verdict is Record.TOO_UNCERTAIN else ""
        text = f"{start}{sizes}: {_apart_words(p.percent)}{told}."
        return text[0].upper() + text[1:] if not start else text

    @property
    def shape_words(self) -> str:
        """The order that contradicts most and that another size alone does not explain; else empty."""
        m, s = self.measured.values, self.predicted.values
        alike = float((s.conj() @ m).real) / max(float(np.linalg.norm(s)) ** 2, 1e-300)
        rest = np.abs(max(alike, 0.0) * s - m) * self.contradicted_orders
        if self.contradicts_size and not (rest > SHARE * self.scale).any():
            return ""
        rest = rest if rest.any() else np.abs(self.differences) * self.contradicted_orders
        if not rest.any():
            return ""
        j = int(rest.argmax())
        order = f"Order {self.measured.orders[j]:g}"
        owner = "" if self.quantity == "dte" else f" of {self.label}"
        sizes = [printed(float(abs(one[j])), self.unit, 2) for one in (m, s)]
        if abs(abs(m[j]) - abs(s[j])) > 0.5 * abs(m[j] - s[j]):
            return f"{order}{owner} is {sizes[0]}, predicted {sizes[1]}."
        degrees = math.degrees(float(np.angle(m[j] * np.conj(s[j]))))
        if abs(degrees) > 150.0:
            return f"{order}{owner} has the opposite sign: {abs(degrees):.0f} degrees from the prediction."
        way = "leads" if degrees > 0.0 else "lags"
        return f"{order}{owner} {way} the prediction by {abs(degrees):.0f} degrees."


def _noise_factor(compared: int) -> float:
    """Standard deviations that noise exceeds in any of so many complex orders in 5 of 100 records."""
    return math.sqrt(2.0 * math.log(compared / _CHANCE))


def _apart_words(percent: float) -> str:
    if abs(percent) < 1.0:
        return "the same within 1 %"
    if percent > 900.0:
        return "more than 10 times the measured value"
    if percent > 200.0:
        return f"{percent / 100.0 + 1.0:.1f} times the measured value"
    digits = f"{abs(percent):.0f}" if abs(percent) >= 9.5 else f"{abs(percent):.1f}"
    return f"{digits} % too {'high' if percent > 0.0 else 'low'}"


@dataclass(frozen=True, eq=False)
class RecordComparison:
    """A record beside the prediction.

    Attributes
    ----------
    name : of the record
    channels : one for each channel of the record, the transmission error first where it is measured
    shift : since pair A was at A, at time 0 of the record [mesh cycles]
    varied : whether the inputs were varied
    mesh_cycles : number of the period of the prediction, whose mean mesh cycle is compared
    """

    name: str
    channels: tuple[ChannelComparison, ...]
    shift: float
    varied: bool
    mesh_cycles: int

    @property
    def leading(self) -> ChannelComparison:
        """The channel whose size is told first: the transmission error, else the first channel."""
        return self.channels[0]

    @property
    def peak_to_peak(self) -> PeakToPeak:
        """Of the leading channel."""
        return self.leading.peak_to_peak

    @property
    def measured(self) -> float:
        """D, the measured peak to peak of the leading channel, in its unit."""
        return self.peak_to_peak.measured

    @property
    def error(self) -> float:
        """E = S - D of the leading channel, in its unit."""
        return self.peak_to_peak.error

    @property
    def dte_error(self) -> float:
        """E of the peak to peak of the transmission error [m]; NaN where it was not measured."""
        return self.error if self.leading.quantity == "dte" else math.nan

    @property
    def uncertainty(self) -> float:
        """u_val of the leading channel, in its unit."""
        return self.peak_to_peak.u_val

    @property
    def explained(self) -> bool:
        """Whether E of the leading channel is within 2 u_val: it shows no error of the size of the motion."""
        return abs(self.error) <= 2.0 * self.uncertainty

    @property
    def verdict(self) -> Record:
        """One channel that contradicts is enough; else what the leading channel says."""
        if any(one.verdict is Record.CONTRADICTS for one in self.channels):
            return Record.CONTRADICTS
        return self.leading.verdict

    @property
    def words(self) -> str:
        """What was measured and predicted, what contradicts, and what the comparison cannot say.

        The channels that contradict come first where the leading one does not.
        """
        wrong = [one for one in self.channels if one.verdict is Record.CONTRADICTS]
        leading = [self.leading.size_words]
        parts = [one.size_words for one in wrong if one is not self.leading and one.contradicts_size]
        parts += [one.shape_words for one in wrong]
        parts = [*parts, *leading] if wrong and self.leading not in wrong else [*leading, *parts]
        if self.verdict is Record.TOO_UNCERTAIN and self.leading.noisy:
            parts.append("Its mesh orders hardly stand out of the noise: check its speed, or record longer.")
        vague = [one.label for one in self.channels if one.verdict is Record.TOO_UNCERTAIN]
        if 0 < len(vague) < len(self.channels):
            parts.append(f"Too uncertain to judge: {', '.join(vague)}.")
        apart = any(one.verdict is not Record.CONFIRMS for one in self.channels)
        if apart and not self.varied:
            parts.append("The inputs were not varied: they may explain some of it.")
        return " ".join(part for part in parts if part)

    @cached_property
    def table(self) -> xr.Dataset:
        """Over ``channel``: peaks to peak, percent, share explained, the worst order; SI units by channel."""
        rows = self.channels
        peaks = [one.peak_to_peak for one in rows]
        own = "SI, by channel"
        worst = [(one.table(), one.worst, one) for one in rows]
        columns: dict[str, tuple[list[object], str, str]] = {
            "quantity": ([one.quantity for one in rows], "1", "quantity"),
            "units": ([one.unit for one in rows], "1", "SI unit of the channel"),
            "measured": ([p.measured for p in peaks], own, "measured peak to peak"),
            "predicted": ([p.predicted for p in peaks], own, "predicted peak to peak"),
            "percent": ([p.percent for p in peaks], "%", "predicted less measured, of the measured value"),
            "u_record": ([p.record for p in peaks], own, "standard uncertainty by the record's noise"),
            "u_inputs": ([p.inputs for p in peaks], own, "standard uncertainty by the inputs"),
            "u_numerical": ([p.numerical for p in peaks], own, "standard uncertainty by the numerics"),
            "u_val": ([p.u_val for p in peaks], own, "standard uncertainty of the difference"),
            "explained": ([one.explained for one in rows], "1", "share of the measured motion explained"),
            "worst_order": (
                [float(one.measured.orders[j]) for _, j, one in worst], "1", "mesh order that differs most"
            ),
            "worst_measured": ([float(t["measured"][j]) for t, j, _ in worst], own, "its measured amplitude"),
            "worst_predicted": (
                [float(t["predicted"][j]) for t, j, _ in worst], own, "its predicted amplitude"
            ),
            "worst_phase": ([float(t["phase_difference"][j]) for t, j, _ in worst], "rad",
                            "its phase, predicted less measured"),
            "verdict": ([one.verdict.name for one in rows], "1", "verdict of the channel"),
        }  # fmt: skip
        return labelled_dataset(
            {name: ("channel", values, unit, text) for name, (values, unit, text) in columns.items()},
            {"channel": ([one.name for one in rows], "1", "channel")},
            {"record": self.name, "verdict": self.verdict.name, "words": self.words, "shift": self.shift},
        )

    @cached_property
    def orders(self) -> xr.Dataset:
        """Over ``channel`` and ``order``: both amplitudes, phase difference, their standard uncertainties.

        NaN where a channel has no such order: those of one tooth pair are parts of mesh orders.
        """
        order = np.unique(np.concatenate([one.measured.orders for one in self.channels]))
        names = {
            "measured": ("SI, by channel", "measured amplitude"),
            "measured_deviation": ("SI, by channel", "its standard uncertainty"),
            "predicted": ("SI, by channel", "predicted amplitude"),
            "predicted_deviation": ("SI, by channel", "its standard uncertainty"),
            "phase_difference": ("rad", "phase, predicted less measured"),
            "phase_deviation": ("rad", "its standard uncertainty"),
            "contradicts": ("1", "whether the difference contradicts the prediction"),
        }
        filled = {name: np.full((len(self.channels), order.size), np.nan) for name in names}
        for row, one in enumerate(self.channels):
            at = np.searchsorted(order, one.measured.orders)
            for name, values in one.table().items():
                filled[name][row, at] = values
        units = [one.unit for one in self.channels]
        return labelled_dataset(
            {name: (("channel", "order"), filled[name], *names[name]) for name in names}
            | {"units": ("channel", units, "1", "SI unit of the channel")},
            {
                "channel": ([one.name for one in self.channels], "1", "channel"),
                "order": (order, "1", "mesh order"),
            },
        )

    @cached_property
    def figure_data(self) -> xr.Dataset:
        """Both motions about their means over one mesh cycle, or those of one tooth pair, and ``orders``."""
        period = max(one.measured.period for one in self.channels)
        phase = np.arange(256 * period) / 256
        curves = [
            (one.measured.shifted(-self.shift).at(phase), one.predicted.shifted(-self.shift).at(phase))
            for one in self.channels
        ]
        measured, predicted = np.stack(curves, axis=1)
        dims = ("channel", "phase")
        unit = "SI, by channel"
        return labelled_dataset(
            {
                "measured_motion": (dims, measured, unit, "measured"),
                "predicted_motion": (dims, predicted, unit, "predicted"),
                "units": ("channel", [one.unit for one in self.channels], "1", "SI unit of the channel"),
                "apart": ("channel", [_apart_words(one.peak_to_peak.percent) for one in self.channels],
                          "1", "predicted peak to peak beside the measured one"),
            },
            {
                "channel": ([one.name for one in self.channels], "1", "channel"),
                "phase": (phase, "mesh cycles", "mesh cycles since the pair was at A"),
            },
        ).merge(self.orders.drop_vars("units"), combine_attrs="override")  # fmt: skip


def compare_record(
    measurement: Measurement,
    prediction: Prediction,
    *,
    numerical: float = 0.0,
    varied: Varied | None = None,
    shift: float | None = None,
) -> RecordComparison:
    """Compare every channel of a record with the prediction.

    Parameters
    ----------
    measurement : the record, at the speed and torque of the prediction's pair
    prediction : of ``validation.prediction.motion.predict``
    numerical : standard uncertainty of every predicted amplitude by the numerics, over it
    varied : predictions with varied inputs, of ``sampled_predictions``; None: the inputs were not varied
    shift : since pair A was at A, at time 0 of the record [mesh cycles]; default the one with the best
        correlation, the same for all channels

    Raises
    ------
    ParameterError : a record of another speed or torque, or of too few samples
    """
    check_record(measurement, prediction.pair)
    spec = measurement.spec
    channels = sorted(spec.channel, key=lambda one: one.quantity != "dte")  # the first leads
    curves = mean_mesh_cycle(prediction, spec.recurrence)
    cycles = cycles_in_step(measurement, prediction.pair)
    samples = measurement.channels
    at = coarse_shift(measurement, cycles, curves, channels) if shift is None else shift
    every = [measured_orders(samples[one.name], cycles, curves, one, at) for one in channels]
    expected = [predicted_orders(curves, own, one) for own, one in zip(channels, every, strict=True)]
    compared = sum(one.orders.size for one in every)
    seen = [_above_noise(*two, compared) for two in zip(every, expected, strict=True)]
    measured = [one.only(kept) for one, kept in zip(every, seen, strict=True)]
    predicted = [one.only(kept) for one, kept in zip(expected, seen, strict=True)]
    scales = [
        channel_scale(one.size, other.size, _static(prediction, own))
        for own, one, other in zip(channels, measured, predicted, strict=True)
    ]
    if shift is None:
        paired = any(one.pair for one in channels)
        near = (at, 2.0 * BIN) if paired else None
        at = common_shift(measured, predicted, scales, near=near)
    moved = _moved(varied, channels, every, seen, scales, spec.recurrence)
    found = []
    for j, own in enumerate(channels):
        here = predicted[j].shifted(at)
        scale = scales[j]
        swing = measured[j].peak_to_peak
        size = PeakToPeak(
            swing,
            here.peak_to_peak,
            measured[j].peak_to_peak_deviation,
            NOT_VARIED * swing if moved is None else _deviation(moved[j][1]),
            numerical * here.peak_to_peak,
        )
        by_inputs = np.tile((NOT_VARIED * scale) ** 2 * np.eye(2), (here.orders.size, 1, 1))
        if moved is not None:
            turned = moved[j][0] * np.exp(2j * np.pi * here.orders * at)
            parts = np.stack([turned.real, turned.imag], axis=2)
            by_inputs = np.einsum("smi,smj->mij", parts, parts) / len(parts)
        words = str(prediction.cycle[own.quantity].attrs.get("long_name", own.quantity))
        found.append(
            ChannelComparison(
                own.name, own.quantity, QUANTITIES[own.quantity][0], words, measured[j], here, by_inputs,
                numerical, scale, size, compared, varied is not None,
            )
        )  # fmt: skip
    return RecordComparison(spec.name, tuple(found), at, varied is not None, prediction.mesh_cycles)


def _above_noise(measured: ComplexOrders, predicted: ComplexOrders, compared: int) -> BoolArray:
    """Orders that the record or the prediction has beyond the record's noise, and the large predicted ones.

    The rest of the record is noise, whose peak to peak would add to that of the motion.
    """
    noise = np.sqrt([np.trace(measured.block(k)) for k in range(measured.orders.size)])
    limit = _noise_factor(compared) * noise
    large = predicted.amplitudes > SHARE * predicted.size
    kept = (measured.amplitudes > limit) | (predicted.amplitudes > limit) | large
    if not kept.any():  # of a channel that the prediction leaves at rest
        kept[measured.amplitudes.argmax()] = True
    return np.asarray(kept)


def _static(prediction: Prediction, own: Channel) -> float:
    """Static value that a channel's least scale is a share of: mesh force, or mean deflection."""
    if QUANTITIES[own.quantity][0] == "N":
        return prediction.static_force
    return abs(float(prediction.cycle["dte"].mean()))


def _moved(
    varied: Varied | None,
    channels: Sequence[Channel],
    every: Sequence[ComplexOrders],
    seen: Sequence[BoolArray],
    scales: Sequence[float],
    recurrence: int | None,
) -> list[tuple[ComplexArray, FloatArray]] | None:
    """Of each channel how far each sample of the inputs moves the orders, in phase, and the peak to peak."""
    if varied is None:
        return None

    def read(one: Prediction) -> list[ComplexOrders]:
        curves = mean_mesh_cycle(one, recurrence)
        rows = zip(channels, every, seen, strict=True)
        return [predicted_orders(curves, own, like).only(kept) for own, like, kept in rows]

    given = read(varied.given)
    rows = []
    for sample in map(read, varied.samples):
        # Moved inputs move the phase of all channels: a record does not tell it from its own.
        shift = common_shift(given, sample, scales, near=(0.0, 0.5))
        rows.append([one.shifted(shift) for one in sample])
    return [
        (
            np.array([row[j].values - own.values for row in rows]),
            np.array([row[j].peak_to_peak - own.peak_to_peak for row in rows]),
        )
        for j, own in enumerate(given)
    ]


def _deviation(differences: FloatArray) -> float:
    """Root mean square about the prediction with the inputs as given, which need not be their middle."""
    return float(np.sqrt(np.mean(differences**2)))
