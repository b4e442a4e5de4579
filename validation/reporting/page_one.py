"""Page 1 of the report: the verdict, one number a row, actions, and the certainty of the numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import xarray as xr

from lumped.outcomes import Absent
from lumped.schema.posterior import FROM_RECORD
from validation.files.formatting import quantity
from validation.reporting.actions import Action, actions_of
from validation.reporting.facts import RANGES, Fact, facts_of, rpm, samples_matter
from validation.reporting.first_numbers import Number, numbers_of
from validation.reporting.results import Results
from validation.reporting.verdict import Verdict, verdict_of

_NOT_MODELLED = "Not modelled: helix; misalignment; housing and sound radiation."
#: Records that a sentence names.
_NAMED_RECORDS = 3
#: Sentence before ``_NOT_MODELLED`` for like teeth, and for unlike teeth.
_ALIKE = "The teeth are perfect: the parameter file states no tooth errors, so there are no sidebands."
#: The same for like teeth, where teeth of an assumed class are drawn.
_ASSUMED = (
    "The parameter file states no tooth errors: the results are those of perfect teeth, without sidebands. "
    "Only the row over all teeth and the ranges of forces have teeth of an assumed class."
)
_OWN = (
    "The numbers are those of the teeth with their errors. Of perfect teeth are the second program, the "
    "curves over speed, stability, and every range but that of the transmission error."
)


@dataclass(frozen=True)
class PageOne:
    """The contents of the first page, in their order.

    Attributes
    ----------
    title : teeth, module, width, speed, torque and power
    verdict, headline, reason : the verdict with its sentence, and the sentences below
    numbers : rows of the table
    actions : list "Do next"
    sure : list "How sure?"
    remark : sentence below the table; empty: there is none
    not_modelled : sentence on effects that the model does not have
    warnings : sentences on implausible values of the parameter file
    facts : facts that all sentences come from
    """

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

    @property
    def ranged(self) -> bool:
        """Whether any row has a range."""
        return any(row.range for row in self.numbers)


def page_one(results: Results) -> PageOne:
    """Return the contents of the first page."""
    facts = facts_of(results)
    verdict, headline, reason = verdict_of(results, facts)
    return PageOne(
        title=title(results),
        verdict=verdict,
        headline=headline,
        reason=reason,
        numbers=numbers_of(results, facts),
        actions=actions_of(results, verdict),
        sure=_how_sure(results, facts),
        remark=_remark(results),
        not_modelled=f"{_teeth(results)} {_NOT_MODELLED}",
        warnings=results.warnings,
        facts=tuple(facts.values()),
    )


def _teeth(results: Results) -> str:
    """Sentence on the teeth to which the results belong."""
    if results.teeth is not None:
        return _OWN
    return _ALIKE if results.assumed_teeth is None else _ASSUMED


def title(results: Results) -> str:
    """Return teeth, module, width, speed, torque and power of the pair."""
    pair = results.pair
    width = 1e3 * min(pair.pinion.face_width, pair.gear.face_width)
    torque = pair.operating.pinion_torque
    power = torque * pair.operating.pinion_speed
    return (
        f"{pair.name}: spur gears {pair.pinion.teeth}/{pair.gear.teeth}, "
        f"m {1e3 * pair.basic_rack.module:.4g}, b {width:.4g} mm, {rpm(results.operating_rpm)}, "
        f"{quantity(torque, 'N m')} ({quantity(power, 'W', 3)})"
    )


def _how_sure(results: Results, facts: Mapping[str, Fact]) -> tuple[str, ...]:
    """Sentences on the solution, the inputs and the measurement."""
    record = facts.get("record")
    inputs = facts["inputs"].claim
    claims = [facts["samples"].claim] if samples_matter(results) else []
    claims += [facts[key].claim for key in RANGES if key in facts]
    ranges = "".join(f" {claim[0].upper()}{claim[1:]}." for claim in claims)
    return (
        f"Solved right? {facts['second_program'].claim}.",
        f"Inputs: {inputs}.{ranges}",
        f"Compared with a measurement? {measurement_words(results, record)}.",
    )


def measurement_words(results: Results, record: Fact | None) -> str:
    """Return what the record beside the prediction says, and which records the inputs are fitted to."""
    pair = results.given
    if not pair.posterior:
        return "No" if record is None else record.claim
    known = [source for _, source in pair.sources if source.startswith(FROM_RECORD)]
    names = f": {_shortened(known[0].removeprefix(FROM_RECORD))}" if known else ""
    fitted = f"inputs and their ranges are fitted to records{names}"
    return f"Not beside this prediction; {fitted}" if record is None else f"{record.claim}; {fitted}"


def _shortened(names: str) -> str:
    """Names of records, each with its speed and torque in brackets; of many the first ones and a number."""
    parts = names.split("), ")
    more = len(parts) - _NAMED_RECORDS
    return names if more <= 1 else f"{'), '.join(parts[:_NAMED_RECORDS])}) and {more} more"


def _remark(results: Results) -> str:
    """Sentence on the linear model, or on forms of the model outside the range."""
    prediction = results.prediction
    linear = results.linear
    if prediction.contact_lost and not isinstance(linear, Absent):
        size = quantity(float(linear.attrs["dte_peak_to_peak"]), "m", 3)
        return f"The linear model would give {size}. It lets teeth pull, so it is not used here."
    return _beside_the_range(results)


def _beside_the_range(results: Results) -> str:
    """Sentence on the forms of the model whose transmission error is outside the range; else empty."""
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
