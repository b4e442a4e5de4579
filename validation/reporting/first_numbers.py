"""The rows of the table on page 1: the result, the range of the samples, and the second program."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from lumped.outcomes import Absent
from validation.files.formatting import quantity, span
from validation.prediction.assumed_teeth import has_range, revolution_range
from validation.prediction.motion import QUANTITIES, Prediction
from validation.reporting.facts import (
    Fact,
    amplified_words,
    drawn_teeth,
    proof_words,
    rpm,
    spread_words,
)
from validation.reporting.results import Results
from validation.reporting.verdict import way_out

#: A result is in the middle of its range where the share of the samples below the result is between these.
_MIDDLE = (0.2, 0.8)


@dataclass(frozen=True)
class Number:
    """One row of the table of page 1. A number that was not computed is NaN.

    Attributes
    ----------
    key : name in report.json
    label : words of the row
    value : result
    unit : SI unit of the result; "1" for a ratio, "%" for a share that is printed in per cent, "rpm" for a
        distance of speeds
    low, high : 5 % and 95 % of the samples
    second : result of the second program
    note : words below the label
    median : median of the samples, where the result is far from the median
    scope : what the row was computed for
    """

    key: str
    label: str
    value: float
    unit: str
    low: float = math.nan
    high: float = math.nan
    second: float = math.nan
    note: str = ""
    median: float = math.nan
    scope: str = ""

    @property
    def digits(self) -> int:
        """Printed digits: two where the range is wider than 5 % to each side, else three."""
        if self.key == "trouble":  # a share of some hundred samples
            return 2
        uncertain = math.isfinite(self.low) and self.high - self.low > 0.1 * abs(self.value)
        return 2 if uncertain else 3

    @property
    def shown(self) -> str:
        """The result as printed."""
        return _printed(self.value, self.unit, self.digits)

    @property
    def range(self) -> str:
        """The range as printed, with both ends relative to the result; empty: there is no range."""
        if not math.isfinite(self.low) or not self.value:
            return ""
        if self.unit == "%":  # relative ends would be per cent of per cent
            low, high = (_printed(end, "%", self.digits) for end in (self.low, self.high))
            return f"{low.removesuffix(' %')} to {high}".replace(" %", "\u00a0%")
        ends = span(self.low, self.high, self.unit, self.digits)
        return f"{ends} ({spread_words((self.low / self.value - 1.0, self.high / self.value - 1.0))})"

    @property
    def second_shown(self) -> str:
        """The second program's result as printed."""
        return _printed(self.second, self.unit, 3) if math.isfinite(self.second) else "not computed"

    @property
    def notes(self) -> str:
        """Words in small letters below the label."""
        if not math.isfinite(self.median):
            return self.note
        middle = f"median of the possible machines {_printed(self.median, self.unit, self.digits)}"
        return f"{self.note}; {middle}" if self.note else middle


#: Number of the prediction -> label on page 1.
_LABELS = {
    "dte_peak_to_peak": "Transmission error, peak to peak",
    "dynamic_factor": "Dynamic factor: largest mesh force / mean",
    "tooth_load": "Largest load on one tooth / mean mesh force",
    "bearing_rms": "Dynamic force on the pinion bearings, rms",
    "efficiency": "Mesh efficiency",
}


def numbers_of(results: Results, facts: Mapping[str, Fact]) -> tuple[Number, ...]:
    """Return the rows of the table of page 1."""
    prediction = results.prediction
    notes = {"bearing_rms": _orders(results) if prediction.bearing_rms else ""} | _as_given(results)
    rows = {key: _row(results, key, facts["contact"], notes.get(key, "")) for key in _LABELS}
    if prediction.contact_lost:  # the smallest mesh force takes the place of the bearing force
        rows["bearing_rms"] = _least_force_row(results, facts["contact"])
    numbers = [*rows.values()]
    numbers[1:1] = _revolution_row(results, facts.get("assumed_teeth"))
    numbers += [_resonance_row(results, facts["resonance"]), _hazard_row(results, facts["jumps"])]
    trouble = facts.get("trouble")
    if trouble is not None and trouble.value > 0.0:
        label = "Possible machines that lose contact or are unstable"
        note = trouble.claim
        scope = trouble.scope.words
        numbers.append(Number("trouble", label, trouble.value, "%", note=note, scope=scope))
    return tuple(numbers)


def _revolution_row(results: Results, fact: Fact | None) -> list[Number]:
    """Transmission error over all teeth of an assumed class. Empty: no range. ``fact``: on these teeth."""
    teeth = results.assumed_teeth
    if teeth is None or fact is None or not has_range(teeth):
        return []
    low, middle, high = revolution_range(teeth)
    label = f"Transmission error over all teeth, class {teeth.attrs['tolerance_class']} assumed"
    note = f"{drawn_teeth(teeth)}; {teeth.attrs['period']} mesh cycles; the result is the median"
    return [Number("assumed_teeth", label, middle, "m", low, high, note=note, scope=fact.scope.words)]


def _least_force_row(results: Results, fact: Fact) -> Number:
    """Smallest mesh force. The second program has like teeth: its force stands beside like teeth only."""
    second = results.second
    second_force = math.nan
    if results.teeth is None and not isinstance(second, Absent):
        second_force = second.least_force
    return Number(
        "least_force",
        "Smallest mesh force / mean",
        results.prediction.least_force,
        "1",
        second=second_force,
        note="0 is contact loss",
        scope=fact.scope.words,
    )


def _resonance_row(results: Results, fact: Fact) -> Number:
    """Distance to the nearest resonance. ``fact``: the fact on the resonance."""
    resonance = results.resonance
    note = fact.claim
    if resonance is not None:
        speeds = way_out(resonance)
        parts = note, amplified_words(resonance), f"half as strong {speeds}" if speeds else ""
        note = "; ".join(part for part in parts if part)
    return Number("resonance", "Distance to the nearest resonance", fact.value, "rpm", note=note,
                  scope=fact.scope.words)  # fmt: skip


def _hazard_row(results: Results, fact: Fact) -> Number:
    """Distance to the nearest hazard. ``fact``: the fact on jumps."""
    hazard = results.nearest_hazard
    searched = results.searched
    distance = math.nan
    label = "Distance to the nearest unstable speed, jump or chaos"
    if hazard is not None:
        distance = hazard.speed_rpm - results.operating_rpm
        note = f"{hazard.words} at {rpm(hazard.speed_rpm)}"
    else:
        note = "jumps were not searched to the end" if searched is None else f"none found {fact.scope.speeds}"
    note = f"{note}; {proof_words(results)}{results.on_springs}"
    return Number("hazard", label, distance, "rpm", note=note, scope=fact.scope.words)


def first_numbers(prediction: Prediction) -> tuple[Number, ...]:
    """Return the numbers of page 1 that need the prediction alone."""
    return tuple(Number(key, label, prediction.numbers[key], _unit(key)) for key, label in _LABELS.items())


def _unit(key: str) -> str:
    return "%" if key == "efficiency" else QUANTITIES[key][0]


def _row(results: Results, key: str, fact: Fact, note: str) -> Number:
    """One number of the prediction. The second program has like teeth and stands beside like teeth only."""
    value = results.prediction.numbers[key]
    second = results.second
    second_value = math.nan
    if results.teeth is None and not isinstance(second, Absent):
        second_value = second.numbers[key]
    row = Number(key, _LABELS[key], value, _unit(key), second=second_value, note=note, scope=fact.scope.words)
    spread = results.spread(key)
    if spread is None:
        return row
    low, high = (value * (1.0 + end) for end in spread)
    rank = results.rank(key)
    median = math.nan
    if math.isfinite(rank) and not _MIDDLE[0] <= rank <= _MIDDLE[1]:
        median = float(results.uncertainty[f"{key}_percentile"][1])  # type: ignore[index]
    return replace(row, low=low, high=high, median=median)


def _orders(results: Results) -> str:
    """Words on the two largest orders of the bearing force, with their frequencies."""
    amplitude = results.prediction.bearing_orders
    frequency = results.pair.geometry.mesh_frequency
    loudest = sorted(np.argsort(-amplitude)[:2] + 1)
    orders = " and ".join(str(order) for order in loudest)
    hertz = " and ".join(quantity(order * frequency, "Hz", 2) for order in loudest)
    forces = " and ".join(quantity(float(amplitude[order - 1]), "N", 2) for order in loudest)
    return f"largest orders {orders} × mesh ({hertz}): {forces}"


def _as_given(results: Results) -> dict[str, str]:
    """Notes on unlike teeth: the period of the motion, and the numbers of like teeth."""
    teeth = results.teeth
    like = results.like.numbers
    if teeth is None:
        return {}
    notes = {
        key: f"like teeth {_printed(like[key], _unit(key), 3)}" for key in ("dynamic_factor", "tooth_load")
    }
    swing = _printed(like["dte_peak_to_peak"], "m", 3)
    return notes | {"dte_peak_to_peak": f"over {teeth.period} mesh cycles; like teeth {swing}"}


def _printed(value: float, unit: str, digits: int) -> str:
    """A number as page 1 prints the number; "none" for a number that is not finite."""
    if not math.isfinite(value):
        return "none"
    if unit == "rpm":
        return f"{value:+.0f} rpm".replace("-", "\u2212")
    if unit == "%":
        return f"{100.0 * value:.{max(digits - 2, 0) + 1}f} %"
    return quantity(value, unit, digits, measured=True)
