"""What a report claims of a pair: each claim with its value, the scope it was computed over, and by what.

Page 1, the terminal and report.json take their sentences from here. What was not computed is not claimed: a
fact then says so, over the same scope.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import xarray as xr

from lumped.outcomes import Absent
from validation.files.formatting import number, quantity
from validation.prediction.resonance import Resonance
from validation.prediction.uncertainty import LEAST_BAND, least_samples
from validation.reporting.results import SHORT, Results

#: Keys of what the time left open of ranges that few samples give; page 1 says each that is there.
RANGES = ("range_over_speed", "range_of_teeth", "range_beside_record")


@dataclass(frozen=True)
class Scope:
    """Over what a claim was computed.

    Attributes
    ----------
    speeds_rpm : lowest and highest pinion speed [rpm]; twice the operating speed where it is of that one
    motion : which motion it is about
    supports : "springs" or "shafts"
    teeth : "alike" or "as given"
    inputs : "as given", or how many samples of them
    effort : "quick report" or "full report"
    """

    speeds_rpm: tuple[float, float]
    motion: str
    supports: str
    teeth: str
    inputs: str
    effort: str

    @property
    def speeds(self) -> str:
        """The speeds as a phrase: "at 1450 rpm" or "from 145 to 2900 rpm"."""
        low, high = self.speeds_rpm
        return f"at {rpm(low)}" if low == high else f"from {number(low, 5)} to {rpm(high)}"

    @property
    def words(self) -> str:
        """The whole scope in one line."""
        return (
            f"{self.speeds}; {self.motion}; {self.supports}; teeth {self.teeth}; inputs {self.inputs}; "
            f"{self.effort}"
        )


@dataclass(frozen=True)
class Fact:
    """One claim.

    Attributes
    ----------
    key : name in report.json
    claim : the claim as a clause, without a full stop
    value, unit : the number that it is about, in SI or rpm; NaN where it has none
    scope : over what it was computed
    computed_by : the function that computed it
    """

    key: str
    claim: str
    value: float
    unit: str
    scope: Scope
    computed_by: str


def rpm(speed: float) -> str:
    """A speed as it is printed."""
    return f"{number(speed, 5)} rpm"


def percent(share: float) -> str:
    """A share in per cent, with its sign where it is negative: two digits, all before the point."""
    return number(100.0 * share, 2)


def facts(results: Results) -> dict[str, Fact]:
    """Return every claim of a report by its key; those of what was computed already cost nothing."""
    found = (
        _contact(results),
        _stable(results),
        _instability(results),
        _jumps(results),
        _left_open(results),
        _resonance(results),
        _samples(results),
        _range_over_speed(results),
        _range_of_teeth(results),
        _range_beside_a_record(results),
        _trouble(results),
        _levels(results),
        _second_program(results),
        _record(results),
        _inputs(results),
    )
    return {one.key: one for one in found if one is not None}


def _scope(results: Results, **changes: str) -> Scope:
    """The scope of the prediction at the operating point, with changes."""
    own = results.operating_rpm
    words = {
        "motion": results.prediction.motion.text,
        "supports": "springs" if results.pair.shafts is None else "shafts",
        "teeth": "alike" if results.teeth is None else "as given",
        "inputs": "as given",
        "effort": results.effort.name,
    }
    return Scope((own, own), **(words | changes))


def _over(results: Results, speeds: tuple[float, float], motion: str) -> Scope:
    """The scope of what is computed over speed: on springs, with like teeth."""
    scope = _scope(results, motion=motion, supports="springs", teeth="alike")
    return replace(scope, speeds_rpm=speeds)


def _contact(results: Results) -> Fact:
    prediction = results.prediction
    if results.teeth_apart:
        claim = f"the teeth lose contact, at {results.teeth_apart} pairs of teeth that meet"
    else:
        claim = "the teeth lose contact" if prediction.contact_lost else "contact is kept"
    return Fact("contact", claim, prediction.least_force, "1", _scope(results), "predict")


def _stable(results: Results) -> Fact:
    stable = results.prediction.stable
    claim = "the motion is stable" if stable else "the motion is unstable"
    return Fact("stable", claim, float(stable), "1", _scope(results, teeth="alike"), "predict")


def _instability(results: Results) -> Fact:
    """What the chart says over speed at the given damping."""
    share = float((results.stability_line < 0).mean())
    claim = "no speed is unstable" if share == 0.0 else f"{percent(share)} % of the speeds are unstable"
    scope = _over(results, results.speeds, "linear motion")
    return Fact("unstable_speeds", claim, share, "1", scope, "stability_chart")


def _jumps(results: Results) -> Fact:
    """What the search beyond contact loss says over the widest range that it went through."""
    search = results.jump_search
    searched = results.searched
    motion = "motions with unilateral contact"
    if searched is None:
        own = results.operating_rpm
        scope = _over(results, (own, own), motion)
        claim = "jumps were not searched to the end about this speed"
        return Fact("jumps", claim, math.nan, "1", scope, "search_jumps")
    low, high = searched
    inside = [one for one in search.jumps if low <= one.speed_rpm <= high]
    jumps = f"{len(inside)} jump{'' if len(inside) == 1 else 's'}" if inside else ""
    roaming = " and ".join(sorted({one.kind for one in results.roaming if low <= one.speed_rpm <= high}))
    claim = "no jump, beats or chaos was found"
    if inside or roaming:
        claim = f"{' and '.join(one for one in (jumps, roaming) if one)} found"
    elif not search.windows:
        claim = "contact is kept, and no jump was found"
    scope = _over(results, searched, motion)
    return Fact("jumps", claim, float(len(inside)), "1", scope, "search_jumps")


def _left_open(results: Results) -> Fact | None:
    """The speeds whose search the budget did not finish."""
    left = results.jump_search.open
    if not left:
        return None
    ranges = " and ".join(f"from {number(low, 5)} to {rpm(high)}" for low, high in left)
    claim = f"jumps {ranges} were not searched to the end"
    scope = _over(results, (left[0][0], left[-1][1]), "motions with unilateral contact")
    return Fact("jumps_left_open", claim, float(len(left)), "1", scope, "search_jumps")


def _resonance(results: Results) -> Fact:
    found = results.resonance
    scope = replace(_scope(results, motion="mesh orders 1 to 10", teeth="alike"), speeds_rpm=results.speeds)
    if found is None:
        return Fact("resonance", "no mesh order resonates", math.nan, "rpm", scope, "nearest_resonance")
    distance = found.speed_rpm - results.operating_rpm
    return Fact("resonance", resonance_words(found), distance, "rpm", scope, "nearest_resonance")


def resonance_words(found: Resonance) -> str:
    """Where the operating speed lies beside a resonance: "order 3 is 0.4 % above the mesh mode (1870 Hz)"."""
    side = "above" if found.apart > 0.0 else "below"
    size = number(100.0 * abs(found.apart), 2)
    return f"order {found.order} is {size} % {side} the {found.mode} ({found.frequency:.0f} Hz)"


def amplified_words(found: Resonance) -> str:
    """What a resonance amplifies, at its speed: the dynamic factor, or the force on the bearings."""
    if found.place == "mesh force":
        factor = found.dynamic_factor
        return f"dynamic factor there {factor:.3g}" if math.isfinite(factor) else ""
    return f"{found.place} there {quantity(found.force, 'N', 2)} at this order"


def samples_words(found: xr.Dataset) -> str:
    """From how many possible machines a range is, and what the time left open: a clause."""
    taken, asked, used = (found.attrs[name] for name in ("taken", "asked", "seconds"))
    kept = int(found.sizes["sample"])
    refused = found.attrs["refused"]
    linear = found.attrs["linear"]
    of = f"{taken} of {asked}" if taken < asked else f"{taken}"
    parts = [f"the range is from {of} possible machines"]
    if kept < least_samples(asked):
        parts = [
            f"there is no range: it needs {least_samples(asked)} possible machines, and {of} were computed"
        ]
    parts[0] += f", of which {refused} have no motion and are left out" if refused else ""
    parts += [f"in {linear} of {kept} the linear motion stands in"] if linear else []
    if taken < asked:
        parts += [f"the time of {number(used, 3)} s was used up"]
        inputs = int(found.sizes["input"])
        alone = found.attrs["alone"]
        parts += [f"{alone} of {inputs} inputs were moved alone"] if alone < inputs else []
    return "; ".join(parts)


def sampled_words(what: str, counts: Mapping[str, Any], seconds: float) -> str:
    """What the time left open of a range that few samples give: a clause."""
    of = f"{counts['taken']} of {counts['asked']}"
    end = f"the time of {number(seconds, 3)} s was used up"
    least = least_samples(counts["asked"], LEAST_BAND)
    if counts["samples"] < least:
        return f"there is no {what}: it needs {least} possible machines, and {of} were computed; {end}"
    return f"the {what} is from {of} possible machines; {end}"


def _samples(results: Results) -> Fact | None:
    """From how many samples the ranges of page 1 are."""
    found = results.uncertainty
    if not isinstance(found, xr.Dataset):
        return None
    count = int(found.sizes["sample"])
    scope = _scope(results, teeth="alike", inputs=f"{count} samples")
    return Fact("samples", samples_words(found), float(count), "1", scope, "uncertainty")


def samples_matter(results: Results) -> bool:
    """Whether page 1 has to say from how many samples a range is: not from all that were asked for."""
    found = results.uncertainty
    if not isinstance(found, xr.Dataset):
        return False
    own = found.attrs
    return bool(own["taken"] < own["asked"] or own["refused"] or own["linear"])


def _cut(
    key: str, what: str, counts: Mapping[str, Any], scope: Scope, results: Results, by: str
) -> Fact | None:
    """What the time left open of a range that few samples give; None where nothing is."""
    if counts["taken"] == counts["asked"]:
        return None
    scope = replace(scope, inputs=f"{counts['samples']} samples")
    words = sampled_words(what, counts, results.effort.band_seconds)
    return Fact(key, words, float(counts["samples"]), "1", scope, by)


def _range_over_speed(results: Results) -> Fact | None:
    band = results.band
    if isinstance(band, Absent):
        return None
    scope = _over(results, results.speeds, "linear motion")
    return _cut("range_over_speed", "range over speed", band.attrs, scope, results, "speed_band")


def _range_of_teeth(results: Results) -> Fact | None:
    band = results.teeth_band
    if band is None:
        return None
    scope = _scope(results, motion="linear motion")
    return _cut("range_of_teeth", "range of teeth that differ", band.attrs, scope, results, "teeth_band")


def _range_beside_a_record(results: Results) -> Fact | None:
    varied = results.record_samples
    if varied is None:
        return None
    counts = {"samples": len(varied.samples), "taken": varied.taken, "asked": varied.asked}
    scope = _scope(results, teeth="alike")
    what = "range beside the record"
    return _cut("range_beside_record", what, counts, scope, results, "sampled_predictions")


def _trouble(results: Results) -> Fact | None:
    """The share of the samples that lose contact or are unstable."""
    found = results.uncertainty
    if not isinstance(found, xr.Dataset) or not found.sizes["sample"]:
        return None
    count = int(found.sizes["sample"])
    lost = int(found.attrs["contact_lost"])
    unstable, either = (int(found.attrs[name]) for name in ("unstable", "lost_or_unstable"))
    parts = [f"{lost} of {count} possible machines lose contact"] if lost else []
    parts += [f"{unstable} of {count} are unstable"] if unstable else []
    claim = " and ".join(parts) or f"none of {count} possible machines loses contact or is unstable"
    scope = _scope(results, teeth="alike", inputs=f"{count} samples")
    return Fact("trouble", claim, either / count, "1", scope, "uncertainty")


def _levels(results: Results) -> Fact | None:
    """How far the inputs move the transmission error."""
    spread = results.spread("dte_peak_to_peak")
    if spread is None:
        return None
    text = f"{SHORT['dte_peak_to_peak']} {spread_words(spread)}"
    count = results.uncertainty.sizes["sample"] if isinstance(results.uncertainty, xr.Dataset) else 0
    if results.teeth_band is not None:
        count = results.teeth_band.attrs["samples"]
    scope = _scope(results, inputs=f"{count} samples")
    return Fact("levels", text, max(-spread[0], spread[1]), "1", scope, "uncertainty")


def spread_words(spread: tuple[float, float]) -> str:
    """A range relative to its result: "−20/+180 %"."""
    low, high = (f"{'+' if end > 0.0 else ''}{percent(end)}" for end in spread)
    return f"{low}/{high} %"


def _second_program(results: Results) -> Fact:
    check = results.check
    worst = math.nan
    if not isinstance(check, Absent) and check.of("exact"):
        worst = check.worst("exact").difference
    scope = _scope(results, motion="motion of the second program", teeth="alike")
    return Fact("second_program", results.second_words.removesuffix("."), worst, "1", scope, "crosscheck")


def _record(results: Results) -> Fact | None:
    measured = results.measured_error
    if measured is None:
        return None
    claim = f"{measured.verdict.text} {measured.words}".removesuffix(".")
    return Fact("record", claim, measured.dte_error, "m", _scope(results), "compare_record")


def _inputs(results: Results) -> Fact:
    known, assumed = results.inputs
    claim = f"{assumed} of {known + assumed} inputs are assumed"
    return Fact("inputs", claim, float(assumed), "1", _scope(results), "given_and_assumed")
