"""How sure the prediction is: effect of the uncertain inputs, and the error budget."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import xarray as xr

from lumped.outcomes import Absent
from validation.files.formatting import span
from validation.plots.prediction import budget_figure
from validation.prediction.motion import QUANTITIES
from validation.reporting.blocks import Block, Column, Content, Picture, Quantity, Table, Text, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.facts import of_assumed_teeth, samples_words
from validation.reporting.results import Results


def write(results: Results) -> Content:
    """Write the chapter."""
    samples = results.uncertainty
    budget = results.budget
    blocks: list[Block] = [_budget_table(budget)]
    blocks.append(
        Picture(
            "error_budget",
            "The errors of the prediction, over its peak to peak. Red: the largest that no poorer form has.",
            budget,
            budget_figure,
        )
    )
    result = f"The largest error of the prediction is “{budget.attrs['largest_name']}”."
    if isinstance(samples, Absent):
        blocks.append(Text("The inputs were not varied in this report."))
        return Content(result, tuple(blocks))
    blocks += [_ranges_table(samples), inputs_table(samples)]
    half = results.samples < results.effort.samples
    why = f" Half as many as else: a mesh cycle has {results.vibrations:.0f} vibrations." if half else ""
    lost = int(samples.attrs["contact_lost"])
    unstable = int(samples.attrs["unstable"])
    blocks.append(
        Text(
            f"Possible machines are scrambled Sobol points, seed {samples.attrs['seed']}; "
            f"{samples_words(samples)}. Contact is lost in {lost} of them, {unstable} are unstable.{why}"
        )
    )
    drawn = of_assumed_teeth(results)
    if drawn is not None:
        blocks.append(Text(f"On page 1: {drawn.claim}. The table of results above has perfect teeth."))
    low, high = samples["dte_peak_to_peak_percentile"].to_numpy()[[0, -1]]
    if not math.isfinite(low):
        words = samples_words(samples)
        return Content(f"{words[0].upper()}{words[1:]}. {result}", tuple(blocks))
    result = (
        f"With its uncertain inputs the transmission error lies from {span(low, high, 'm')} (5 to 95 %). "
        f"{result}"
    )
    return Content(result, tuple(blocks))


def _budget_table(budget: xr.Dataset) -> Table:
    """Every error of the prediction, row by row. An error that was not computed is an empty cell."""
    names = budget.attrs["names"]
    notes = budget.attrs["notes"]

    def value(error: str, row: int) -> float | None:
        size = float(budget[error][row])
        return size if math.isfinite(size) else None

    return table_of(
        "error_budget",
        "Error budget of the prediction.",
        range(budget.sizes["row"]),
        (
            Column[int]("error", "error", lambda row: names[row]),
            Column[int]("dte", "transmission error", lambda row: value("dte", row), "m"),
            Column[int]("share", "% of peak to peak", lambda row: value("share", row)),
            Column[int]("tooth_force", "tooth load", lambda row: value("tooth_force", row), "N"),
            Column[int]("bearing_force", "bearing force, rms", lambda row: value("bearing_force", row), "N"),
            Column[int]("note", "", lambda row: notes[row]),
        ),
    )


class _Range(NamedTuple):
    """A row of the table of ranges: a result as given, and 5, 50 and 95 % of the samples."""

    words: str
    given: Quantity
    low: Quantity
    middle: Quantity
    high: Quantity


def _range(samples: xr.Dataset, name: str) -> _Range:
    """Range of one result. An efficiency is in per cent."""
    unit, words = QUANTITIES[name]
    low, middle, high = samples[f"{name}_percentile"].to_numpy()
    nominal = float(samples.attrs[f"given_{name}"])
    factor = 100.0 if name == "efficiency" else 1.0
    unit = "%" if name == "efficiency" else unit
    return _Range(words, *(Quantity(factor * float(value), unit) for value in (nominal, low, middle, high)))


def _ranges_table(samples: xr.Dataset) -> Table:
    return table_of(
        "ranges",
        "Results with the uncertain inputs.",
        [_range(samples, name) for name in QUANTITIES],
        (
            Column[_Range]("result", "result", lambda result: result.words),
            Column[_Range]("given", "as given", lambda result: result.given),
            Column[_Range]("low", "5 %", lambda result: result.low),
            Column[_Range]("middle", "50 %", lambda result: result.middle),
            Column[_Range]("high", "95 %", lambda result: result.high),
        ),
    )


def inputs_table(samples: xr.Dataset) -> Table:
    """Return the table of the uncertain inputs, the input with the largest effect first."""
    name = "dte_peak_to_peak"
    fields = samples["input"].to_numpy()
    swing = samples[f"{name}_swing"].to_numpy()
    correlation = samples[f"{name}_rank_correlation"].to_numpy()
    written = samples.attrs["written"]
    reasons = samples.attrs["reason"]
    largest_first = np.argsort(-np.nan_to_num(np.ptp(swing, axis=1)), kind="stable")
    return table_of(
        "inputs_varied",
        "The transmission error, peak to peak, with each uncertain input alone, the largest effect first.",
        map(int, largest_first),
        (
            Column[int]("field", "input", lambda j: str(fields[j])),
            Column[int]("spread", "range", lambda j: range_words(str(written[j]))),
            Column[int]("low", "smallest", lambda j: float(swing[j].min()), "m"),
            Column[int]("high", "largest", lambda j: float(swing[j].max()), "m"),
            Column[int]("correlation", "rank corr.", lambda j: round(float(correlation[j]), 2)),
            Column[int]("reason", "why this range", lambda j: str(reasons[j])),
        ),
    )


def range_words(written: str) -> str:
    """Return a range of the parameter file in the signs of print: "* 0.7 .. * 1.4" as "×0.7 to ×1.4"."""
    signs = {"+- ": "±", "* ": "×", "/ ": "÷", " .. ": " to ", "_": "\u00a0"}
    for sign, printed in signs.items():
        written = written.replace(sign, printed)
    return written


CHAPTER = Chapter("how_sure", "How sure", write, seconds=8.0)
