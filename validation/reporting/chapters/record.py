"""A measured record beside the prediction: every channel, percent of the measured value, orders and phase."""

from __future__ import annotations

import math
from collections.abc import Sequence

from validation.measurements.record_comparison import ChannelComparison, Record, RecordComparison
from validation.plots.record import record_figure
from validation.plots.style import scaled
from validation.reporting.blocks import Badge, Block, Cell, Content, Picture, Table, Text
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results

_BADGES = {
    Record.CONFIRMS: Badge("ok", "confirms"),
    Record.CONTRADICTS: Badge("violated", "contradicts"),
    Record.TOO_UNCERTAIN: Badge("warning", "too uncertain"),
}
#: Orders of a channel in the table, the largest first.
_MOST = 6


def write(results: Results) -> Content | None:
    """Write the chapter; None without a record."""
    found = results.measured_error
    if found is None:
        return None
    blocks: list[Block] = []
    for unit in dict.fromkeys(one.unit for one in found.channels):
        alike = [one for one in found.channels if one.unit == unit]
        blocks += [_channels(alike, unit), _orders(alike, unit)]
    picture = "Both motions about their means, and their mesh orders; bars: 2 standard uncertainties."
    blocks.append(Picture("record", picture, found.figure_data, record_figure))
    blocks += [_uncertainties(found), Text(_scope(found))]
    return Content(f"{found.verdict.text} {found.words}", tuple(blocks))


def _scope(found: RecordComparison) -> str:
    mean = (
        "The prediction is periodic over one mesh cycle."
        if found.mesh_cycles == 1
        else f"The prediction repeats after {found.mesh_cycles} mesh cycles; their mean is compared."
    )
    return (
        f"{mean} Orders are those of the mesh: what differs from tooth to tooth is averaged out. "
        "Means are not compared: sensors of motion have no zero. All channels have the same shift in time, "
        f"{found.shift:.4f} mesh cycles."
    )


def _channels(alike: Sequence[ChannelComparison], unit: str) -> Table:
    peaks = [one.peak_to_peak for one in alike]
    factor, shown = scaled([[p.measured, p.predicted] for p in peaks], unit=unit)
    rows: tuple[tuple[Cell, ...], ...] = tuple(
        (
            one.name,
            one.words,
            _rounded(p.measured / factor),
            _rounded(p.predicted / factor),
            _rounded(p.percent),
            _rounded(100.0 * one.explained, 4),
            _BADGES[one.verdict],
        )
        for one, p in zip(alike, peaks, strict=True)
    )
    columns = {
        "channel": "channel",
        "quantity": "quantity",
        "measured": f"measured, peak to peak [{shown}]",
        "predicted": f"predicted [{shown}]",
        "percent": "predicted less measured [% of the measured]",
        "explained": "share of the measured motion that the prediction explains [%]",
        "verdict": "the record",
    }
    return Table(f"record_{_key(unit)}", "The prediction beside the record.", columns, rows)


def _orders(alike: Sequence[ChannelComparison], unit: str) -> Table:
    factor, shown = scaled([one.measured.amplitudes.max() for one in alike], unit=unit)
    rows: list[tuple[Cell, ...]] = []
    for one in alike:
        table = one.table()
        size = sorted(
            range(one.measured.orders.size), key=lambda j: -max(table["measured"][j], table["predicted"][j])
        )
        for j in sorted(size[:_MOST]):
            rows.append(
                (
                    one.name,
                    float(one.measured.orders[j]),
                    *(_rounded(float(table[name][j]) / factor) for name in _AMPLITUDES),
                    _rounded(math.degrees(float(table["phase_difference"][j]))),
                    _rounded(math.degrees(float(table["phase_deviation"][j])), 2),
                    "contradicts" if table["contradicts"][j] else "",
                )
            )
    columns = {"channel": "channel", "order": "mesh order"}
    columns |= {name: f"{words} [{shown}]" for name, words in _AMPLITUDES.items()}
    columns |= {
        "phase": "phase, predicted less measured [degrees]",
        "phase_deviation": "its u [degrees]",
        "note": "",
    }
    words = f"The {_MOST} largest mesh orders of each channel; u: standard uncertainty."
    return Table(f"record_orders_{_key(unit)}", words, columns, tuple(rows))


_AMPLITUDES = {
    "measured": "measured amplitude",
    "measured_deviation": "its u",
    "predicted": "predicted amplitude",
    "predicted_deviation": "its u",
}


def _uncertainties(found: RecordComparison) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for one in found.channels:
        p = one.peak_to_peak
        parts = (p.record, p.inputs, p.numerical, p.u_val)
        rows.append((one.name, _rounded(p.percent), *(_rounded(100.0 * u / p.measured) for u in parts)))
    columns = {
        "channel": "channel",
        "error": "error E = S − D [%]",
        "record": "u of the record's noise [%]",
        "inputs": "u of the inputs [%]",
        "numerics": "u of the numerics [%]",
        "u_val": "all three, u_val [%]",
    }
    inputs = "" if found.varied else " The inputs were not varied: a stated 12.5 % stands for them."
    words = (
        "Peak to peak in percent of the measured value D; S is the predicted one. The error of the model "
        f"lies within E ± 2 u_val (ASME V&V 20).{inputs}"
    )
    return Table("record_uncertainty", words, columns, tuple(rows))


def _rounded(value: float, digits: int = 3) -> float | None:
    if not math.isfinite(value):
        return None
    return float(f"{value:.{digits}g}")


def _key(unit: str) -> str:
    return {"m": "motions", "N": "forces"}[unit]


CHAPTER = Chapter("record", "The record", write, seconds=3.0)
