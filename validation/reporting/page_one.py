"""Page 1 of the report: one verdict, one number a row, what to do next, how sure, three figures."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from lumped.outcomes import Absent
from validation.files.formatting import quantity, read_table, span
from validation.prediction.inputs import kind_of
from validation.prediction.motion import QUANTITIES, Prediction
from validation.reporting.facts import (
    RANGES,
    Fact,
    amplified_words,
    facts,
    rpm,
    samples_matter,
    spread_words,
)
from validation.reporting.results import Results
from validation.reporting.verdict import Verdict, verdict_of, way_out

#: An input counts whose swing is at least this share of the result.
_COUNTS = 0.05
_MOST_ACTIONS = 3
#: A result is in the middle of its range whose share of samples below it lies between these.
_MIDDLE = (0.2, 0.8)
#: Kind of an input -> what to do about it.
_ADVICE = read_table("validation.reporting", "advice.toml")
_NOT_MODELLED = "Not modelled: helix; misalignment; housing and sound radiation."
#: Before it, of a pair whose teeth are alike, and of one whose teeth differ.
_ALIKE = "All teeth are taken as alike: no pitch errors, no sidebands."
_OWN = (
    "Numbers are those of the teeth as given; ranges but that of the transmission error, the second program, "
    "curves over speed and stability are of like teeth and stand in their chapters."
)


@dataclass(frozen=True)
class Number:
    """One row of the table of page 1: the result in SI, 5 and 95 % of the samples, by the second program.

    NaN is what was not computed; the unit is "1" for a ratio, "rpm" for a distance of speeds. ``median`` of
    the samples, where the result is far from it. ``scope``: over what the row was computed.
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
        """Digits that the range supports: two where it is wider than 5 % to each side, else three."""
        if self.key == "trouble":  # a share of some hundred samples
            return 2
        wide = math.isfinite(self.low) and self.high - self.low > 0.1 * abs(self.value)
        return 2 if wide else 3

    @property
    def shown(self) -> str:
        """The result as printed."""
        return _printed(self.value, self.unit, self.digits)

    @property
    def range(self) -> str:
        """The range as printed, with its ends relative to the result; empty where there is none."""
        if not math.isfinite(self.low) or not self.value:
            return ""
        if self.unit == "%":  # a share of one, which has per cents of its own
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
        """What stands in small letters below the label."""
        if not math.isfinite(self.median):
            return self.note
        middle = f"median of the possible machines {_printed(self.median, self.unit, self.digits)}"
        return f"{self.note}; {middle}" if self.note else middle


@dataclass(frozen=True)
class Action:
    """One thing to do: what, the field or command, and what it gains."""

    text: str
    command: str
    gain: str


@dataclass(frozen=True)
class PageOne:
    """What the first page says, in its order, and the facts that it says it from."""

    title: str
    verdict: Verdict
    headline: str
    reason: str
    numbers: tuple[Number, ...]
    actions: tuple[Action, ...]
    sure: tuple[str, ...]
    remark: str
    not_modelled: str
    warnings: tuple[str, ...]
    facts: tuple[Fact, ...]


def page_one(results: Results) -> PageOne:
    """Return what the first page says of a pair."""
    known = facts(results)
    verdict, headline, reason = verdict_of(results, known)
    return PageOne(
        title=title(results),
        verdict=verdict,
        headline=headline,
        reason=reason,
        numbers=rows(results, known),
        actions=_actions(results, verdict),
        sure=_sure(results, known),
        remark=_remark(results),
        not_modelled=f"{_ALIKE if results.teeth is None else _OWN} {_NOT_MODELLED}",
        warnings=results.warnings,
        facts=tuple(known.values()),
    )


def title(results: Results) -> str:
    """Teeth, module, width, speed, torque and power of the pair."""
    pair = results.pair
    width = 1e3 * min(pair.pinion.face_width, pair.gear.face_width)
    torque = pair.operating.pinion_torque
    power = torque * pair.operating.pinion_speed
    return (
        f"{pair.name}: spur gears {pair.pinion.teeth}/{pair.gear.teeth}, "
        f"m {1e3 * pair.basic_rack.module:.4g}, b {width:.4g} mm, {rpm(results.operating_rpm)}, "
        f"{quantity(torque, 'N m')} ({quantity(power, 'W', 3)})"
    )


#: Key of a number of the prediction -> its words on page 1.
_ROWS = {
    "dte_peak_to_peak": "Transmission error, peak to peak",
    "dynamic_factor": "Dynamic factor: largest mesh force / static",
    "tooth_load": "Largest load on one tooth / static mesh force",
    "bearing_rms": "Dynamic force on the pinion bearings, rms",
    "efficiency": "Mesh efficiency",
}


def rows(results: Results, known: dict[str, Fact]) -> tuple[Number, ...]:
    """The rows of the table: result, range of the samples, second program."""
    prediction = results.prediction
    second = results.second
    notes = {"bearing_rms": _orders(results) if prediction.bearing_rms else ""} | _as_given(results)
    found = [_row(results, key, known["contact"], notes.get(key, "")) for key in _ROWS]
    if prediction.contact_lost:  # the bearing force gives way
        of_second = math.nan
        if results.teeth is None and not isinstance(second, Absent):  # it has like teeth
            of_second = second.least_force
        words = "Smallest mesh force / static", prediction.least_force, "1"
        scope = known["contact"].scope.words
        found[3] = Number("least_force", *words, second=of_second, note="0 is contact loss", scope=scope)
    found += [_resonance_row(results, known["resonance"]), _hazard_row(results, known["jumps"])]
    trouble = known.get("trouble")
    if trouble is not None and trouble.value > 0.0:
        label = "Possible machines that lose contact or are unstable"
        note = trouble.claim
        scope = trouble.scope.words
        found.append(Number("trouble", label, trouble.value, "%", note=note, scope=scope))
    return tuple(found)


def _resonance_row(results: Results, fact: Fact) -> Number:
    found = results.resonance
    note = fact.claim
    if found is not None:
        out = way_out(found)
        parts = note, amplified_words(found), f"half as strong {out}" if out else ""
        note = "; ".join(one for one in parts if one)
    return Number("resonance", "Distance to the nearest resonance", fact.value, "rpm", note=note,
                  scope=fact.scope.words)  # fmt: skip


def _hazard_row(results: Results, fact: Fact) -> Number:
    hazard = results.nearest_hazard
    own = results.operating_rpm
    searched = results.searched
    far = math.nan
    label = "Distance to the nearest unstable speed, jump or chaos"
    if hazard is not None:
        far = hazard.speed_rpm - own
        note = f"{hazard.words} at {rpm(hazard.speed_rpm)}"
    else:
        note = "jumps were not searched to the end" if searched is None else f"none found {fact.scope.speeds}"
    return Number("hazard", label, far, "rpm", note=note + results.on_springs, scope=fact.scope.words)


def first_numbers(prediction: Prediction) -> tuple[Number, ...]:
    """The numbers of page 1 that the prediction alone gives."""
    return tuple(Number(key, label, prediction.numbers[key], _unit(key)) for key, label in _ROWS.items())


def _unit(key: str) -> str:
    return "%" if key == "efficiency" else QUANTITIES[key][0]


def _row(results: Results, key: str, fact: Fact, note: str) -> Number:
    value = results.prediction.numbers[key]
    second = results.second
    of_second = math.nan
    if results.teeth is None and not isinstance(second, Absent):  # it has like teeth
        of_second = second.numbers[key]
    row = Number(key, _ROWS[key], value, _unit(key), second=of_second, note=note, scope=fact.scope.words)
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
    """The two largest orders of the bearing force, with their frequencies."""
    amplitude = results.prediction.bearing_orders
    frequency = results.pair.geometry.mesh_frequency
    loudest = sorted(np.argsort(-amplitude)[:2] + 1)
    orders = " and ".join(str(order) for order in loudest)
    hertz = " and ".join(quantity(order * frequency, "Hz", 2) for order in loudest)
    forces = " and ".join(quantity(float(amplitude[order - 1]), "N", 2) for order in loudest)
    return f"largest orders {orders} × mesh ({hertz}): {forces}"


def _as_given(results: Results) -> dict[str, str]:
    """Of teeth that differ: over how many mesh cycles the numbers are, and what like teeth would have."""
    teeth = results.teeth
    like = results.like.numbers
    if teeth is None:
        return {}
    notes = {
        key: f"like teeth {_printed(like[key], _unit(key), 3)}" for key in ("dynamic_factor", "tooth_load")
    }
    swing = _printed(like["dte_peak_to_peak"], "m", 3)
    return notes | {"dte_peak_to_peak": f"over {teeth.period} mesh cycles; like teeth {swing}"}


def _actions(results: Results, verdict: Verdict) -> tuple[Action, ...]:
    found: list[Action] = []
    if verdict is Verdict.BROKEN:
        return (Action("Report this failure with the parameter file", "report.json", ""),)
    if verdict is Verdict.OUTSIDE:
        found = [Action(flag.action.removesuffix("."), "", "") for flag in results.outside]
    if verdict is Verdict.CONTRADICTED:
        what = "See which channel and which order the record contradicts"
        found = [Action(what, "chapter “The record”", "")]
    if verdict is Verdict.DO_NOT_RUN:
        hazard = results.nearest_hazard
        if hazard is not None and hazard.kind == "jump":
            found.append(Action(f"Do not pass {rpm(hazard.speed_rpm)} at this torque", "", ""))
        if results.teeth_apart:
            found.append(Action("Take teeth of a better tolerance class, more torque or less speed", "", ""))
        command = f"spurcheck response {results.name} --map"
        found.append(Action("See where the pair can jump, over speed and torque", command, ""))
        found.append(Action("Try tip relief for this torque", "--set pinion.tip_relief.amount=...", ""))
    resonance = results.resonance
    runs = verdict in (Verdict.ABSOLUTE, Verdict.UNCERTAIN)
    if runs and resonance is not None and resonance.near and (words := way_out(resonance)):
        found.append(Action(f"Move the speed off the resonance, {words}", "", ""))
    found += _left_open(results) + _further_samples(results)
    return (*found, *advice_on_inputs(results))[:_MOST_ACTIONS]


def _left_open(results: Results) -> list[Action]:
    """The search for jumps that goes on where the report left it, the nearest speeds first."""
    own = results.operating_rpm
    left = sorted(results.jump_search.open, key=lambda ends: min(abs(end - own) for end in ends))
    return [
        Action(
            f"Search for jumps from {low:.0f} to {high:.0f} rpm",
            f"spurcheck response {results.name} --range {low:.0f}..{high:.0f}",
            "",
        )
        for low, high in left[:1]
    ]


def _further_samples(results: Results) -> list[Action]:
    """The samples that go on where the time of the report ended them."""
    found = results.uncertainty
    if not isinstance(found, xr.Dataset) or found.attrs["taken"] == found.attrs["asked"]:
        return []
    command = f"spurcheck uncertainty {results.name} --samples {found.attrs['asked']}"
    return [Action("Take all possible machines into the range", command, "")]


def advice_on_inputs(results: Results) -> list[Action]:
    """What to do about the inputs that move the result most, one action a kind of input."""
    found = results.uncertainty
    if isinstance(found, Absent):
        vary = Action("Vary the assumed inputs", f"spurcheck uncertainty {results.name}", "")
        return [vary] if results.varies else []
    given = results.like.peak_to_peak
    swing = found["dte_peak_to_peak_swing"].to_numpy()
    actions: dict[str, Action] = {}
    for j in np.argsort(-np.nan_to_num(np.ptp(swing, axis=1))):
        low, high = swing[j].min(), swing[j].max()
        if not high - low > _COUNTS * given:  # NaN: it was not moved alone
            break
        field = str(found["input"].to_numpy()[j])
        kind = kind_of(field)
        advice = _ADVICE.get(kind, {"text": "Narrow the range of this input", "command": field})
        if kind not in actions:
            gain = f"it moves the transmission error from {span(low, high, 'm')}"
            actions[kind] = Action(advice["text"], advice["command"].format(field=field), gain)
    return list(actions.values())


def _sure(results: Results, known: dict[str, Fact]) -> tuple[str, ...]:
    record = known.get("record")
    inputs = known["inputs"].claim
    claims = [known["samples"].claim] if samples_matter(results) else []
    claims += [known[key].claim for key in RANGES if key in known]
    ranges = "".join(f" {claim[0].upper()}{claim[1:]}." for claim in claims)
    return (
        f"Solved right? {known['second_program'].claim}.",
        f"Inputs: {inputs}.{ranges}",
        f"Compared with a measurement? {'No' if record is None else record.claim}.",
    )


def _remark(results: Results) -> str:
    prediction = results.prediction
    linear = results.linear
    if prediction.contact_lost and not isinstance(linear, Absent):
        size = quantity(float(linear.attrs["dte_peak_to_peak"]), "m", 3)
        return f"The linear model would give {size}. It lets teeth pull, so it is not used here."
    return _beside_the_range(results)


def _beside_the_range(results: Results) -> str:
    """Forms of the model by which the transmission error is outside its range; empty where none is."""
    spread = results.spread("dte_peak_to_peak")
    if spread is None or results.teeth is not None:
        return ""
    low, high = (results.like.peak_to_peak * (1.0 + end) for end in spread)
    budget: xr.Dataset = results.budget
    outside = [
        f"{form}, {quantity(float(value), 'm', 3)}"
        for form, value in zip(budget.attrs["forms"], budget["result"].to_numpy(), strict=True)
        if form and math.isfinite(value) and not low <= value <= high
    ]
    return f"Outside this range of the transmission error: {'; '.join(outside)}." if outside else ""


def _printed(value: float, unit: str, digits: int) -> str:
    if not math.isfinite(value):
        return "none"
    if unit == "rpm":
        return f"{value:+.0f} rpm".replace("-", "\u2212")
    if unit == "%":
        return f"{100.0 * value:.{max(digits - 2, 0) + 1}f} %"
    return quantity(value, unit, digits, measured=True)
