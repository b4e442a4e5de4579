"""Facts: the claims of a report about the pair, each with value, scope and computing function.

Page 1, the terminal and report.json take their sentences from here. Without a computation there is no
claim: the fact then says, over the same scope, that the computation is missing.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import xarray as xr

from lumped.outcomes import Absent
from validation.files.formatting import number, quantity, span
from validation.prediction.assumed_teeth import LEAST_MACHINES, has_range, revolution_range
from validation.prediction.motion import Motion
from validation.prediction.resonance import Resonance
from validation.prediction.uncertainty import LEAST_BAND, least_samples
from validation.reporting.results import SHORT, Results
from validation.reporting.second_program_words import second_program_words

#: Keys of the facts on ranges; page 1 says each of them. All but "assumed_teeth" are about ranges whose
#: computation the time limit ended.
RANGES = ("range_over_speed", "range_of_teeth", "assumed_teeth", "range_beside_record")


@dataclass(frozen=True)
class Scope:
    """What a claim was computed for.

    Attributes
    ----------
    speeds_rpm : lowest and highest pinion speed [rpm]; both are the operating speed for a claim on that speed
    motion : name of the motion
    supports : "springs" or "shafts"
    teeth : "alike" or "as given"
    inputs : "as given", or the number of samples
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
        """The scope in one line."""
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
    value : number of the claim; NaN for a claim without a number
    unit : unit of the value, SI or "rpm"
    scope : what the claim was computed for
    computed_by : name of the function that computed the claim
    """

    key: str
    claim: str
    value: float
    unit: str
    scope: Scope
    computed_by: str


def rpm(speed: float) -> str:
    """Return a speed as the page prints the speed."""
    return f"{number(speed, 5)} rpm"


def percent(share: float) -> str:
    """Return a share in per cent with two significant digits, and all digits before the point."""
    return number(100.0 * share, 2)


def facts_of(results: Results) -> dict[str, Fact]:
    """Return every fact of a report by its key. Results that are missing are computed."""
    facts = (
        _contact(results),
        _stable(results),
        instability(results),
        _jumps(results),
        _left_open(results),
        _resonance(results),
        _samples(results),
        _range_over_speed(results),
        _range_of_teeth(results),
        of_assumed_teeth(results),
        _range_beside_a_record(results),
        _trouble(results),
        _levels(results),
        _second_program(results),
        _record(results),
        _inputs(results),
    )
    return {fact.key: fact for fact in facts if fact is not None}


def _scope(results: Results, **changes: str) -> Scope:
    """Scope of the prediction at the operating point, with changes of single entries."""
    speed = results.operating_rpm
    words = {
        "motion": results.prediction.motion.text,
        "supports": "springs" if results.pair.shafts is None else "shafts",
        "teeth": "alike" if results.teeth is None else "as given",
        "inputs": "as given",
        "effort": results.effort.name,
    }
    return Scope((speed, speed), **(words | changes))


def _over(results: Results, speeds: tuple[float, float], motion: str) -> Scope:
    """Scope of a result over speed, which is on springs and with like teeth."""
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


def instability(results: Results) -> Fact:
    """Unstable speeds in the stability chart at the damping of the pair."""
    share = float((results.stability_line < 0).mean())
    nearest = results.unstable_rpm
    claim = "no speed is unstable" if math.isnan(nearest) else f"{rpm(nearest)} is unstable"
    if share > 0.0:
        claim = f"{percent(share)} % of the speeds are unstable"
    scope = _over(results, results.speeds, "linear motion")
    return Fact("unstable_speeds", claim, share, "1", scope, "stability_chart")


def proof_words(results: Results) -> str:
    """Return a clause on the speeds at which the linear motion is proven stable, and on what is left."""
    proven = results.proven_stability
    low, high = proven.stable_rpm
    not_searched = f"unstable zones narrower than {number(results.chart_step, 3)} rpm were not searched"
    if low == high:
        return not_searched
    words = f"the linear motion is proven stable from {number(low, 5)} to {rpm(high)}"
    if proven.widest_undecided:
        words += f", but for zones narrower than {number(proven.widest_undecided, 2)} rpm"
    return words if proven.complete else f"{words}; beyond, {not_searched}"


def _jumps(results: Results) -> Fact:
    """Jumps, beats and chaos in the widest range of speed whose search is complete."""
    search = results.jump_search
    searched = results.searched
    motion = "motions with unilateral contact"
    if searched is None:
        speed = results.operating_rpm
        scope = _over(results, (speed, speed), motion)
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
    """Ranges of speed whose search the time limit ended. None: the search is complete."""
    left_open = results.jump_search.open
    if not left_open:
        return None
    ranges = " and ".join(f"from {number(low, 5)} to {rpm(high)}" for low, high in left_open)
    claim = f"jumps {ranges} were not searched to the end"
    scope = _over(results, (left_open[0][0], left_open[-1][1]), "motions with unilateral contact")
    return Fact("jumps_left_open", claim, float(len(left_open)), "1", scope, "search_jumps")


def _resonance(results: Results) -> Fact:
    resonance = results.resonance
    scope = replace(_scope(results, motion="mesh orders 1 to 10", teeth="alike"), speeds_rpm=results.speeds)
    if resonance is None:
        return Fact("resonance", "no mesh order resonates", math.nan, "rpm", scope, "nearest_resonance")
    distance = resonance.speed_rpm - results.operating_rpm
    return Fact("resonance", resonance_words(resonance), distance, "rpm", scope, "nearest_resonance")


def resonance_words(resonance: Resonance) -> str:
    """Return the distance to a resonance in words: "order 3 is 0.4 % above the mesh mode (1870 Hz)"."""
    side = "above" if resonance.apart > 0.0 else "below"
    size = number(100.0 * abs(resonance.apart), 2)
    mode = f"{resonance.mode} ({resonance.frequency:.0f} Hz)"
    return f"order {resonance.order} is {size} % {side} the {mode}"


def amplified_words(resonance: Resonance) -> str:
    """Return the amplified force at the speed of a resonance: the dynamic factor, or the bearing force."""
    if resonance.place == "mesh force":
        factor = resonance.dynamic_factor
        return f"dynamic factor there {factor:.3g}" if math.isfinite(factor) else ""
    return f"{resonance.place} there {quantity(resonance.force, 'N', 2)} at this order"


def samples_words(samples: xr.Dataset) -> str:
    """Return a clause: the number of samples of a range, and what the time limit left out."""
    taken = samples.attrs["taken"]
    requested = samples.attrs["asked"]
    seconds = samples.attrs["seconds"]
    count = int(samples.sizes["sample"])
    refused = samples.attrs["refused"]
    linear = samples.attrs["linear"]
    machines = f"{taken} of {requested}" if taken < requested else f"{taken}"
    parts = [f"the range is from {machines} possible machines"]
    least = least_samples(requested)
    if count < least:
        parts = [f"there is no range: it needs {least} possible machines, and {machines} were computed"]
    parts[0] += f", of which {refused} have no motion and are left out" if refused else ""
    parts += [f"in {linear} of {count} the linear motion stands in"] if linear else []
    if taken < requested:
        parts += [f"the time of {number(seconds, 3)} s was used up"]
        inputs = int(samples.sizes["input"])
        alone = samples.attrs["alone"]
        parts += [f"{alone} of {inputs} inputs were moved alone"] if alone < inputs else []
    return "; ".join(parts)


def sampled_words(what: str, counts: Mapping[str, Any], seconds: float) -> str:
    """Return a clause on a range whose computation the time limit ended. ``what``: name of the range."""
    machines = f"{counts['taken']} of {counts['asked']}"
    end = f"the time of {number(seconds, 3)} s was used up"
    least = least_samples(counts["asked"], LEAST_BAND)
    if counts["samples"] < least:
        return f"there is no {what}: it needs {least} possible machines, and {machines} were computed; {end}"
    return f"the {what} is from {machines} possible machines; {end}"


def _samples(results: Results) -> Fact | None:
    """Number of samples of the ranges of page 1. None: the inputs are not varied."""
    samples = results.uncertainty
    if not isinstance(samples, xr.Dataset):
        return None
    count = int(samples.sizes["sample"])
    scope = _scope(results, teeth="alike", inputs=f"{count} samples")
    return Fact("samples", samples_words(samples), float(count), "1", scope, "uncertainty")


def samples_matter(results: Results) -> bool:
    """Return whether page 1 must say the number of samples: some of the requested samples are missing."""
    samples = results.uncertainty
    if not isinstance(samples, xr.Dataset):
        return False
    counts = samples.attrs
    return bool(counts["taken"] < counts["asked"] or counts["refused"] or counts["linear"])


def _cut(
    key: str, what: str, counts: Mapping[str, Any], scope: Scope, results: Results, by: str
) -> Fact | None:
    """Fact on a range whose computation the time limit ended. None: all samples were computed."""
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


def of_assumed_teeth(results: Results) -> Fact | None:
    """Fact on the transmission error over all teeth, drawn of an assumed class. None: none are drawn."""
    teeth = results.assumed_teeth
    if teeth is None:
        return None
    middle = revolution_range(teeth)[1] if has_range(teeth) else math.nan
    words = drawn_teeth(teeth)
    scope = _scope(results, motion=Motion.UNILATERAL.text, teeth=words.partition(" with teeth ")[2],
                   inputs=f"{teeth.attrs['inputs']}, {teeth.attrs['samples']} samples")  # fmt: skip
    widens = results.spread("dynamic_factor") is not None
    claim = assumed_teeth_words(teeth, results.effort.drawn_seconds, widens=widens)
    return Fact("assumed_teeth", claim, middle, "m", scope, "assumed_teeth")


def drawn_teeth(teeth: xr.Dataset) -> str:
    """Return the machines in words: "8 machines with teeth drawn of class 6, assumed"."""
    counts = teeth.attrs
    machines = f"{counts['samples']} of {counts['asked']}"
    if counts["samples"] == counts["asked"]:
        machines = str(counts["samples"])
    return f"{machines} machines with teeth drawn of class {counts['tolerance_class']}, assumed"


def assumed_teeth_words(teeth: xr.Dataset, seconds: float, *, widens: bool) -> str:
    """Return a clause on machines with teeth drawn of an assumed class.

    ``seconds``: their time limit [s]. ``widens``: whether page 1 has ranges that they widen.
    """
    counts = teeth.attrs
    machines = drawn_teeth(teeth)
    refused = counts["taken"] - counts["samples"]
    if has_range(teeth):
        low, _, high = revolution_range(teeth)
        parts = [f"{machines}, have a transmission error of {span(low, high, 'm', 2)} over all teeth"]
        if widens:
            parts[0] += ", and widen the ranges of dynamic factor, tooth load and bearing force"
    else:
        parts = [f"there is no range of teeth: it needs {LEAST_MACHINES} machines, and there are {machines}"]
    parts += [f"{refused} without a motion left out"] if refused else []
    lost = counts["contact_lost"]
    parts += [f"{lost} of {counts['samples']} lose contact"] if lost else []
    if counts["taken"] < counts["asked"]:
        parts += [f"the time of {number(seconds, 3)} s was used up"]
    return "; ".join(parts)


def _range_beside_a_record(results: Results) -> Fact | None:
    varied = results.record_samples
    if varied is None:
        return None
    counts = {"samples": len(varied.samples), "taken": varied.taken, "asked": varied.asked}
    scope = _scope(results, teeth="alike")
    what = "range beside the record"
    return _cut("range_beside_record", what, counts, scope, results, "sampled_predictions")


def _trouble(results: Results) -> Fact | None:
    """Share of the samples that lose contact or are unstable. None: there are no samples."""
    samples = results.uncertainty
    if not isinstance(samples, xr.Dataset) or not samples.sizes["sample"]:
        return None
    count = int(samples.sizes["sample"])
    lost = int(samples.attrs["contact_lost"])
    unstable = int(samples.attrs["unstable"])
    either = int(samples.attrs["lost_or_unstable"])
    parts = [f"{lost} of {count} possible machines lose contact"] if lost else []
    parts += [f"{unstable} of {count} are unstable"] if unstable else []
    claim = " and ".join(parts) or f"none of {count} possible machines loses contact or is unstable"
    scope = _scope(results, teeth="alike", inputs=f"{count} samples")
    return Fact("trouble", claim, either / count, "1", scope, "uncertainty")


def _levels(results: Results) -> Fact | None:
    """Range of the transmission error with the uncertain inputs. None: there are too few samples."""
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
    """Return a range relative to the result: "−20/+180 %"."""
    low, high = (f"{'+' if end > 0.0 else ''}{percent(end)}" for end in spread)
    return f"{low}/{high} %"


def _second_program(results: Results) -> Fact:
    check = results.check
    worst = math.nan
    if not isinstance(check, Absent) and check.of("exact"):
        worst = check.worst("exact").difference
    scope = _scope(results, motion="motion of the second program", teeth="alike")
    return Fact(
        "second_program", second_program_words(results).removesuffix("."), worst, "1", scope, "crosscheck"
    )


def _record(results: Results) -> Fact | None:
    measured = results.measured_error
    if measured is None:
        return None
    claim = f"{measured.verdict.text} {measured.words}".removesuffix(".")
    return Fact("record", claim, measured.dte_error, "m", _scope(results), "compare_record")


def _inputs(results: Results) -> Fact:
    known_count, assumed = results.inputs
    claim = f"{assumed} of {known_count + assumed} inputs are assumed"
    return Fact("inputs", claim, float(assumed), "1", _scope(results), "given_and_assumed")
