"""Tables and sentences of the chapter on a record: every channel in per cent, orders and phase.

The chapter imports this module where there is a record, because the module imports all of `validation.check`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from validation.check.record.channel import ChannelComparison, OrdersOfChannel, Record
from validation.check.record.comparison import RecordComparison
from validation.plots.record import record_figure
from validation.plots.style import scaled
from validation.reporting.blocks import Badge, Block, Column, Content, Picture, Table, Text, table_of
from validation.reporting.check_content import ladder_content
from validation.reporting.results import RecordExplanations

_BADGES = {
    Record.CONFIRMS: Badge("ok", "confirms"),
    Record.CONTRADICTS: Badge("violated", "contradicts"),
    Record.TOO_UNCERTAIN: Badge("warning", "too uncertain"),
}
#: Orders of a channel in the table, the largest first.
_MOST = 6


def record_content(comparison: RecordComparison, explained: RecordExplanations | None) -> Content:
    """Return the chapter on a record. ``explained`` None: no record contradicts the prediction."""
    blocks: list[Block] = []
    for unit in dict.fromkeys(channel.unit for channel in comparison.channels):
        channels = [channel for channel in comparison.channels if channel.unit == unit]
        blocks += [_channels_table(channels, unit), _orders_table(channels, unit)]
    picture = "Both motions about their means, and their mesh orders; bars: 2 standard uncertainties."
    blocks.append(Picture("record", picture, comparison.figure_data, record_figure))
    blocks += [_uncertainties_table(comparison), Text(_scope(comparison))]
    if explained is not None:
        content = ladder_content(explained.problem, explained.ladder, explained.limit)
        blocks += [Text(f"What would explain it: {content.result}"), *content.blocks]
    return Content(f"{comparison.verdict.text} {comparison.words}", tuple(blocks))


def _scope(comparison: RecordComparison) -> str:
    """Sentences on what the comparison covers."""
    mean = (
        "The prediction is periodic over one mesh cycle."
        if comparison.mesh_cycles == 1
        else f"The prediction repeats after {comparison.mesh_cycles} mesh cycles; their mean is compared."
    )
    return (
        f"{mean} Orders are those of the mesh: what differs from tooth to tooth is averaged out. "
        "Means are not compared: sensors of motion have no zero. All channels have the same shift in time, "
        f"{comparison.shift:.4f} mesh cycles."
    )


def _channels_table(channels: Sequence[ChannelComparison], unit: str) -> Table:
    """Channels with one SI unit. The headings name the unit, with one prefix for all rows."""
    peaks = [channel.peak_to_peak for channel in channels]
    factor, prefixed = scaled([[peak.measured, peak.predicted] for peak in peaks], unit=unit)
    percent = "predicted less measured [% of the measured]"
    explained = "share of the measured motion that the prediction explains [%]"
    return table_of(
        f"record_{_key(unit)}",
        "The prediction beside the record.",
        channels,
        (
            Column[ChannelComparison]("channel", "channel", lambda channel: channel.name),
            Column[ChannelComparison]("quantity", "quantity", lambda channel: channel.words),
            Column[ChannelComparison](
                "measured",
                f"measured, peak to peak [{prefixed}]",
                lambda channel: _rounded(channel.peak_to_peak.measured / factor),
            ),
            Column[ChannelComparison](
                "predicted",
                f"predicted [{prefixed}]",
                lambda channel: _rounded(channel.peak_to_peak.predicted / factor),
            ),
            Column[ChannelComparison](
                "percent", percent, lambda channel: _rounded(channel.peak_to_peak.percent)
            ),
            Column[ChannelComparison](
                "explained", explained, lambda channel: _rounded(100.0 * channel.explained, 4)
            ),
            Column[ChannelComparison]("verdict", "the record", lambda channel: _BADGES[channel.verdict]),
        ),
    )


class _Order(NamedTuple):
    """A row of the table of orders: place ``j`` of a mesh order in the table of a channel."""

    channel: str
    orders: OrdersOfChannel
    j: int


def _largest_orders(channel: ChannelComparison) -> list[_Order]:
    """The largest orders of a channel, measured or predicted, by order."""
    orders = channel.table()
    largest_first = sorted(
        range(orders.order.size), key=lambda j: -max(orders.measured[j], orders.predicted[j])
    )
    return [_Order(channel.name, orders, j) for j in sorted(largest_first[:_MOST])]


def _orders_table(channels: Sequence[ChannelComparison], unit: str) -> Table:
    """Orders of the channels with one SI unit. The headings name the unit, with one prefix for all rows."""
    factor, prefixed = scaled([channel.measured.amplitudes.max() for channel in channels], unit=unit)

    def amplitude(name: str, words: str) -> Column[_Order]:
        return Column(
            name,
            f"{words} [{prefixed}]",
            lambda row: _rounded(float(getattr(row.orders, name)[row.j]) / factor),
        )

    def degrees(name: str, heading: str, variable: str, digits: int) -> Column[_Order]:
        return Column(
            name,
            heading,
            lambda row: _rounded(math.degrees(float(getattr(row.orders, variable)[row.j])), digits),
        )

    return table_of(
        f"record_orders_{_key(unit)}",
        f"The {_MOST} largest mesh orders of each channel; u: standard uncertainty.",
        [row for channel in channels for row in _largest_orders(channel)],
        (
            Column[_Order]("channel", "channel", lambda row: row.channel),
            Column[_Order]("order", "mesh order", lambda row: float(row.orders.order[row.j])),
            amplitude("measured", "measured amplitude"),
            amplitude("measured_deviation", "its u"),
            amplitude("predicted", "predicted amplitude"),
            amplitude("predicted_deviation", "its u"),
            degrees("phase", "phase, predicted less measured [degrees]", "phase_difference", 3),
            degrees("phase_deviation", "its u [degrees]", "phase_deviation", 2),
            Column[_Order]("note", "", lambda row: "contradicts" if row.orders.contradicts[row.j] else ""),
        ),
    )


def _uncertainties_table(comparison: RecordComparison) -> Table:
    """Error and standard uncertainties of each peak to peak, in per cent of the measured value."""

    def percent(name: str, heading: str, uncertainty: str) -> Column[ChannelComparison]:
        return Column(
            name,
            heading,
            lambda channel: _rounded(
                100.0 * getattr(channel.peak_to_peak, uncertainty) / channel.peak_to_peak.measured
            ),
        )

    inputs = "" if comparison.varied else " The inputs were not varied: a stated 12.5 % stands for them."
    words = (
        "Peak to peak in percent of the measured value D; S is the predicted one. The error of the model "
        f"lies within E ± 2 u_val (ASME V&V 20).{inputs}"
    )
    return table_of(
        "record_uncertainty",
        words,
        comparison.channels,
        (
            Column[ChannelComparison]("channel", "channel", lambda channel: channel.name),
            Column[ChannelComparison](
                "error", "error E = S − D [%]", lambda channel: _rounded(channel.peak_to_peak.percent)
            ),
            percent("record", "u of the record's noise [%]", "record"),
            percent("inputs", "u of the inputs [%]", "inputs"),
            percent("numerics", "u of the numerics [%]", "numerical"),
            percent("u_val", "all three, u_val [%]", "u_val"),
        ),
    )


def _rounded(value: float, digits: int = 3) -> float | None:
    """Value rounded to some digits; None for a value that is not finite."""
    if not math.isfinite(value):
        return None
    return float(f"{value:.{digits}g}")


def _key(unit: str) -> str:
    """Word of the key of a table for channels with this SI unit."""
    return {"m": "motions", "N": "forces"}[unit]
