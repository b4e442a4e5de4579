"""A measured record beside the prediction: the verdict over all channels, sentences, tables and curves.

The comparison is made in `comparing`; one channel is judged in `channel_comparison`. Terms: ASME V&V 20-2009,
eqs. 1-5-2 to 1-5-5.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import xarray as xr

from lumped.labelling import labelled_dataset
from validation.check.record.channel import ChannelComparison, PeakToPeak, Record, apart_words

#: Unit attribute of a variable whose channels differ in their unit: each channel is in its SI unit, which the
#: variable ``units`` of the dataset names.
_BY_CHANNEL = "SI, by channel"


@dataclass(frozen=True, eq=False)
class RecordComparison:
    """A record beside the prediction. Each channel is in its SI unit.

    Attributes
    ----------
    name : name of the record
    channels : comparison of each channel, the transmission error first where it is measured
    shift : mesh cycles from the moment when pair A was at A to the first sample of the record
    varied : whether the inputs were varied
    mesh_cycles : mesh cycles in the period of the prediction; their mean is compared
    """

    name: str
    channels: tuple[ChannelComparison, ...]
    shift: float
    varied: bool
    mesh_cycles: int

    @property
    def leading(self) -> ChannelComparison:
        """The channel of the first sentence: the transmission error, else the first channel."""
        return self.channels[0]

    @property
    def peak_to_peak(self) -> PeakToPeak:
        """Peak to peak of the leading channel."""
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
        """E of the peak to peak of the transmission error [m]; NaN: the record has no such channel."""
        return self.error if self.leading.quantity == "dte" else math.nan

    @property
    def uncertainty(self) -> float:
        """u_val of the leading channel, in its unit."""
        return self.peak_to_peak.u_val

    @property
    def explained(self) -> bool:
        """Whether E of the leading channel is within 2 u_val: the size of the motion shows no error."""
        return abs(self.error) <= 2.0 * self.uncertainty

    @property
    def verdict(self) -> Record:
        """CONTRADICTS if any channel contradicts, else the verdict of the leading channel."""
        if any(one.verdict is Record.CONTRADICTS for one in self.channels):
            return Record.CONTRADICTS
        return self.leading.verdict

    @property
    def confirms(self) -> bool:
        """Whether the record confirms the prediction."""
        return self.verdict is Record.CONFIRMS

    @property
    def contradicts(self) -> bool:
        """Whether the record contradicts the prediction."""
        return self.verdict is Record.CONTRADICTS

    @property
    def words(self) -> str:
        """Sentences: measured and predicted sizes, contradictions, and limits of the comparison.

        The contradictions come first where the leading channel does not contradict.
        """
        wrong = [channel for channel in self.channels if channel.verdict is Record.CONTRADICTS]
        leading = [self.leading.size_words]
        parts = [
            channel.size_words
            for channel in wrong
            if channel is not self.leading and channel.contradicts_size
        ]
        parts += [channel.shape_words for channel in wrong]
        parts = [*parts, *leading] if wrong and self.leading not in wrong else [*leading, *parts]
        if self.verdict is Record.TOO_UNCERTAIN and self.leading.noisy:
            parts.append("Its mesh orders hardly stand out of the noise: check its speed, or record longer.")
        vague = [channel.label for channel in self.channels if channel.verdict is Record.TOO_UNCERTAIN]
        if 0 < len(vague) < len(self.channels):
            parts.append(f"Too uncertain to judge: {', '.join(vague)}.")
        apart = any(channel.verdict is not Record.CONFIRMS for channel in self.channels)
        if apart and not self.varied:
            parts.append("The inputs were not varied: they may explain some of it.")
        return " ".join(part for part in parts if part)

    @cached_property
    def table(self) -> xr.Dataset:
        """Dataset over ``channel``: peaks to peak, share explained, and the order that differs most."""
        channels = self.channels
        peaks = [channel.peak_to_peak for channel in channels]
        orders = [channel.table() for channel in channels]
        worst = [channel.worst for channel in channels]

        def of_worst(name: str) -> list[object]:
            """Values (channel,) of a column of the orders, at the order that differs most."""
            return [float(getattr(table, name)[j]) for table, j in zip(orders, worst, strict=True)]

        columns: dict[str, tuple[list[object], str, str]] = {
            "quantity": ([channel.quantity for channel in channels], "1", "quantity"),
            "units": ([channel.unit for channel in channels], "1", "SI unit of the channel"),
            "measured": ([peak.measured for peak in peaks], _BY_CHANNEL, "measured peak to peak"),
            "predicted": ([peak.predicted for peak in peaks], _BY_CHANNEL, "predicted peak to peak"),
            "percent": (
                [peak.percent for peak in peaks], "%", "predicted less measured, of the measured value"
            ),
            "u_record": (
                [peak.record for peak in peaks], _BY_CHANNEL, "standard uncertainty by the record's noise"
            ),
            "u_inputs": ([peak.inputs for peak in peaks], _BY_CHANNEL, "standard uncertainty by the inputs"),
            "u_numerical": (
                [peak.numerical for peak in peaks], _BY_CHANNEL, "standard uncertainty by the numerics"
            ),
            "u_val": ([peak.u_val for peak in peaks], _BY_CHANNEL, "standard uncertainty of the difference"),
            "explained": (
                [channel.explained for channel in channels], "1", "share of the measured motion explained"
            ),
            "worst_order": (of_worst("order"), "1", "mesh order that differs most"),
            "worst_measured": (of_worst("measured"), _BY_CHANNEL, "its measured amplitude"),
            "worst_predicted": (of_worst("predicted"), _BY_CHANNEL, "its predicted amplitude"),
            "worst_phase": (of_worst("phase_difference"), "rad", "its phase, predicted less measured"),
            "verdict": ([channel.verdict.name for channel in channels], "1", "verdict of the channel"),
        }  # fmt: skip
        return labelled_dataset(
            {name: ("channel", values, unit, text) for name, (values, unit, text) in columns.items()},
            {"channel": ([channel.name for channel in channels], "1", "channel")},
            {"record": self.name, "verdict": self.verdict.name, "words": self.words, "shift": self.shift},
        )

    @cached_property
    def orders(self) -> xr.Dataset:
        """Dataset over ``channel`` and ``order``: amplitudes and phase difference with uncertainties.

        NaN: the channel has no such order. The orders of one tooth pair are fractions of mesh orders.
        """
        order = np.unique(np.concatenate([channel.measured.orders for channel in self.channels]))
        names = {
            "measured": (_BY_CHANNEL, "measured amplitude"),
            "measured_deviation": (_BY_CHANNEL, "its standard uncertainty"),
            "predicted": (_BY_CHANNEL, "predicted amplitude"),
            "predicted_deviation": (_BY_CHANNEL, "its standard uncertainty"),
            "phase_difference": ("rad", "phase, predicted less measured"),
            "phase_deviation": ("rad", "its standard uncertainty"),
            "contradicts": ("1", "whether the difference contradicts the prediction"),
        }
        filled = {name: np.full((len(self.channels), order.size), np.nan) for name in names}
        for row, channel in enumerate(self.channels):
            table = channel.table()
            columns = np.searchsorted(order, table.order)
            for name, values in filled.items():
                values[row, columns] = getattr(table, name)
        units = [channel.unit for channel in self.channels]
        return labelled_dataset(
            {name: (("channel", "order"), filled[name], *names[name]) for name in names}
            | {"units": ("channel", units, "1", "SI unit of the channel")},
            {
                "channel": ([channel.name for channel in self.channels], "1", "channel"),
                "order": (order, "1", "mesh order"),
            },
        )

    @cached_property
    def figure_data(self) -> xr.Dataset:
        """Dataset of the figure: both motions less their means over a period, and ``orders``.

        The period is one mesh cycle; for a channel of one tooth pair the mesh cycles of its engagement.
        """
        period = max(channel.measured.period for channel in self.channels)
        phase = np.arange(256 * period) / 256
        units = [channel.unit for channel in self.channels]
        differences = [apart_words(channel.peak_to_peak.percent) for channel in self.channels]
        measured = np.stack([channel.measured.shifted(-self.shift).at(phase) for channel in self.channels])
        predicted = np.stack([channel.predicted.shifted(-self.shift).at(phase) for channel in self.channels])
        dims = ("channel", "phase")
        return labelled_dataset(
            {
                "measured_motion": (dims, measured, _BY_CHANNEL, "measured"),
                "predicted_motion": (dims, predicted, _BY_CHANNEL, "predicted"),
                "units": ("channel", units, "1", "SI unit of the channel"),
                "apart": ("channel", differences, "1", "predicted peak to peak beside the measured one"),
            },
            {
                "channel": ([channel.name for channel in self.channels], "1", "channel"),
                "phase": (phase, "mesh cycles", "mesh cycles since the pair was at A"),
            },
        ).merge(self.orders.drop_vars("units"), combine_attrs="override")  # fmt: skip
