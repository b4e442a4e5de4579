"""How sure the prediction is: what its inputs do, and the error budget."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from lumped.outcomes import Absent
from validation.files.formatting import span
from validation.plots.prediction import budget_figure
from validation.prediction.motion import QUANTITIES
from validation.reporting.blocks import Block, Cell, Content, Picture, Quantity, Table, Text
from validation.reporting.chapter import Chapter
from validation.reporting.facts import samples_words
from validation.reporting.results import Results


def write(results: Results) -> Content:
    """Write the chapter."""
    found = results.uncertainty
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
    if isinstance(found, Absent):
        blocks.append(Text("The inputs were not varied in this report."))
        return Content(result, tuple(blocks))
    blocks += [_ranges(found), inputs_table(found)]
    half = results.samples < results.effort.samples
    why = f" Half as many as else: a mesh cycle has {results.vibrations:.0f} vibrations." if half else ""
    lost = int(found.attrs["contact_lost"])
    unstable = int(found.attrs["unstable"])
    blocks.append(
        Text(
            f"Possible machines are scrambled Sobol points, seed {found.attrs['seed']}; "
            f"{samples_words(found)}. Contact is lost in {lost} of them, {unstable} are unstable.{why}"
        )
    )
    low, high = found["dte_peak_to_peak_percentile"].to_numpy()[[0, -1]]
    if not math.isfinite(low):
        words = samples_words(found)
        return Content(f"{words[0].upper()}{words[1:]}. {result}", tuple(blocks))
    result = (
        f"With its uncertain inputs the transmission error lies from {span(low, high, 'm')} (5 to 95 %). "
        f"{result}"
    )
    return Content(result, tuple(blocks))


def _budget_table(budget: xr.Dataset) -> Table:
    def shown(value: float, unit: str) -> Quantity | None:
        return Quantity(value, unit) if math.isfinite(value) else None

    rows = tuple(
        (
            name,
            shown(float(one["dte"]), "m"),
            float(one["share"]) if math.isfinite(float(one["share"])) else None,
            shown(float(one["tooth_force"]), "N"),
            shown(float(one["bearing_force"]), "N"),
            note,
        )
        for name, note, one in zip(
            budget.attrs["names"],
            budget.attrs["notes"],
            (budget.isel(row=k) for k in range(budget.sizes["row"])),
            strict=True,
        )
    )
    columns = {
        "error": "error",
        "dte": "transmission error",
        "share": "% of peak to peak",
        "tooth_force": "tooth load",
        "bearing_force": "bearing force, rms",
        "note": "",
    }
    return Table("error_budget", "Error budget of the prediction.", columns, rows)


def _ranges(found: xr.Dataset) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for name, (unit, words) in QUANTITIES.items():
        low, middle, high = found[f"{name}_percentile"].to_numpy()
        given = float(found.attrs[f"given_{name}"])
        share = 100.0 if name == "efficiency" else 1.0
        unit = "%" if name == "efficiency" else unit
        rows.append((words, *(Quantity(share * float(v), unit) for v in (given, low, middle, high))))
    columns = {"result": "result", "given": "as given", "low": "5 %", "middle": "50 %", "high": "95 %"}
    return Table("ranges", "Results with the uncertain inputs.", columns, tuple(rows))


def inputs_table(found: xr.Dataset) -> Table:
    """Each uncertain input with its range and what it does to the transmission error, the largest first."""
    name = "dte_peak_to_peak"
    swing, correlation = (found[f"{name}_{one}"].to_numpy() for one in ("swing", "rank_correlation"))
    order = np.argsort(-np.nan_to_num(np.ptp(swing, axis=1)), kind="stable")
    rows = tuple(
        (
            str(found["input"].to_numpy()[j]),
            range_words(str(found.attrs["written"][j])),
            Quantity(float(swing[j].min()), "m"),
            Quantity(float(swing[j].max()), "m"),
            round(float(correlation[j]), 2),
            str(found.attrs["reason"][j]),
        )
        for j in order
    )
    columns = {
        "field": "input",
        "spread": "range",
        "low": "smallest",
        "high": "largest",
        "correlation": "rank corr.",
        "reason": "why this range",
    }
    words = "The transmission error, peak to peak, with each uncertain input alone, the largest effect first."
    return Table("inputs_varied", words, columns, rows)


def range_words(written: str) -> str:
    """A range as the parameter file writes it, in the signs of print: "* 0.7 .. * 1.4" as "×0.7 to ×1.4"."""
    signs = {"+- ": "±", "* ": "×", "/ ": "÷", " .. ": " to ", "_": "\u00a0"}
    for sign, printed in signs.items():
        written = written.replace(sign, printed)
    return written


CHAPTER = Chapter("how_sure", "How sure", write, seconds=8.0)
