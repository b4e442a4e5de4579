"""The verdict of page 1, its headline and the reason, from the facts of the report."""

from __future__ import annotations

import math
from collections.abc import Mapping
from enum import Enum
from typing import NamedTuple

from floquet.gear.response import Jump
from validation.files.formatting import number, quantity
from validation.prediction.motion import Motion, Prediction
from validation.prediction.resonance import Resonance
from validation.reporting.facts import Fact, rpm, spread_words
from validation.reporting.relations import failed_checks
from validation.reporting.results import SHORT, Results

#: Absolute levels are usable where 5 % and 95 % of the samples lie within this share of the result.
ABSOLUTE = 0.10
#: A jump or an unstable speed nearer than this share of the operating speed counts as at it.
NEAR = 0.05
#: Sentence on the numbers of a pair without a motion with unilateral contact.
STANDS_IN = "The numbers are those of the linear motion, in which teeth may pull."
#: Numbers of page 1 that have a range.
RANGED = ("dte_peak_to_peak", "dynamic_factor", "tooth_load", "bearing_rms", "efficiency")


class Verdict(Enum):
    """Use of the prediction. The value is the title on page 1. The worst verdict is last."""

    ABSOLUTE = "Absolute levels usable"
    UNCERTAIN = "Levels uncertain"
    DO_NOT_RUN = "Do not run here"
    OUTSIDE = "Outside the model"
    CONTRADICTED = "A record contradicts the model"
    BROKEN = "Do not rely on this: a check of the program failed"

    @property
    def tone(self) -> str:
        """Class of the box on the page: good, fair or bad."""
        return {"ABSOLUTE": "good", "UNCERTAIN": "fair", "OUTSIDE": "fair"}.get(self.name, "bad")


class Judgement(NamedTuple):
    """The verdict with its headline, one sentence, and the reason, a few sentences."""

    verdict: Verdict
    headline: str
    reason: str


def verdict_of(results: Results, facts: Mapping[str, Fact]) -> Judgement:
    """Return the verdict on the results of a report, with headline and reason."""
    if broken := failed_checks(results):
        return Judgement(Verdict.BROKEN, f"{Verdict.BROKEN.value}.", f"Failed: {'; '.join(broken[:3])}.")
    if outside := results.outside:
        first, *others = (flag.detail for flag in outside)
        return Judgement(Verdict.OUTSIDE, f"{Verdict.OUTSIDE.value}: {first}.", "; ".join(others))
    if danger := _danger(results, facts):
        return Judgement(Verdict.DO_NOT_RUN, f"{Verdict.DO_NOT_RUN.value}: {danger.cause}.", danger.effect)
    record = results.measured_error
    if record is not None and record.contradicts:
        return Judgement(Verdict.CONTRADICTED, f"{Verdict.CONTRADICTED.value}.", record.words)
    if reason := results.prediction.reason:
        text = f"No motion with unilateral contact was found: {reason}"
        headline = f"{Verdict.UNCERTAIN.value}: the linear motion stands in."
        return Judgement(Verdict.UNCERTAIN, headline, f"{text} {STANDS_IN}")
    running = running_words(results, facts)
    doubt = _doubt(results, facts)
    confirmed = record is not None and record.confirms
    if doubt is not None:
        ranged = any(results.spread(name) is not None for name in RANGED)
        more = "; the range is that of every possible machine." if ranged else "."
        text = f"{running} A record confirms the prediction{more}" if confirmed else running
        return Judgement(Verdict.UNCERTAIN, f"{Verdict.UNCERTAIN.value}: {doubt}.", text)
    why = "A record confirms them." if confirmed else "Every input is known."
    return Judgement(Verdict.ABSOLUTE, f"{Verdict.ABSOLUTE.value}.", f"{running} {why}")


def _doubt(results: Results, facts: Mapping[str, Fact]) -> str | None:
    """Clause on why absolute levels are uncertain. None: absolute levels are usable."""
    every = {name: results.spread(name) for name in RANGED}
    spreads = {name: spread for name, spread in every.items() if spread is not None}
    record = results.measured_error
    assumed = results.inputs[1]
    if not spreads and "samples" in facts:
        return facts["samples"].claim
    if not spreads and results.varies:
        return f"{facts['inputs'].claim}, and they were not varied"
    widest = max(spreads, key=lambda name: _largest_end(spreads[name]), default="")
    if widest and _largest_end(spreads[widest]) > ABSOLUTE:
        claims = [facts["levels"].claim] if "levels" in facts else []  # a mesh that vibrates has them
        if widest != "dte_peak_to_peak":
            claims.append(f"{SHORT[widest]} {spread_words(spreads[widest])}")
        return ", ".join(claims)
    if record is not None and record.confirms:
        return None
    return f"{facts['inputs'].claim}, and no record confirms the prediction" if assumed else None


def _largest_end(spread: tuple[float, float]) -> float:
    """Distance of the further end of a range from the result."""
    low, high = spread
    return max(-low, high)


def running_words(results: Results, facts: Mapping[str, Fact]) -> str:
    """Return sentences on a pair without a hazard at its operating speed: smooth or on a resonance."""
    resonance = results.resonance
    if resonance is not None and resonance.near:
        out = way_out(resonance)
        out = f"; {out} it is half as strong" if out else ""
        runs = f"The pair runs on a resonance: {facts['resonance'].claim}{out}."
    else:
        runs = f"The pair runs smoothly: {facts['contact'].claim} and {facts['stable'].claim}."
    trouble = facts.get("trouble")
    if trouble is not None and trouble.value > 0.0:
        runs = f"{runs} But {trouble.claim}."
    return f"{runs} {searched_words(results, facts)}"


def way_out(resonance: Resonance) -> str:
    """Return the speeds off a resonance, "below 1390 rpm or above 1650 rpm"; empty: there is none."""
    speeds = [
        f"{side} {number(speed, 3)} rpm"
        for side, speed in (("below", resonance.below_rpm), ("above", resonance.above_rpm))
        if math.isfinite(speed)
    ]
    return " or ".join(speeds)


def searched_words(results: Results, facts: Mapping[str, Fact]) -> str:
    """Return sentences on unstable speeds and jumps over speed.

    Empty where page 1 has a row with the nearest hazard.
    """
    left_open = facts.get("jumps_left_open")
    rest = "" if left_open is None else f" {left_open.claim[0].upper()}{left_open.claim[1:]}."
    if results.nearest_hazard is not None:
        return rest.strip()
    unstable = facts["unstable_speeds"]
    jumps = facts["jumps"]
    if unstable.scope.speeds == jumps.scope.speeds:
        where = unstable.scope.speeds
        return f"{where[0].upper()}{where[1:]} {unstable.claim}, and {jumps.claim}{results.on_springs}.{rest}"
    first = f"{unstable.scope.speeds[0].upper()}{unstable.scope.speeds[1:]} {unstable.claim}"
    return f"{first}; {jumps.scope.speeds} {jumps.claim}{results.on_springs}.{rest}"


class _Danger(NamedTuple):
    """Why the pair must not run here: the cause, a clause, and the effect, sentences."""

    cause: str
    effect: str


def _danger(results: Results, facts: Mapping[str, Fact]) -> _Danger | None:
    """Why the pair must not run at the operating speed. None: the pair may run."""
    prediction = results.prediction
    hazard = results.nearest_hazard
    speed = results.operating_rpm
    near = hazard if hazard is not None and abs(hazard.speed_rpm / speed - 1.0) <= NEAR else None
    if results.teeth_apart:
        return _Danger(facts["contact"].claim, f"{_rises(prediction)} {_like_teeth(results)}")
    if prediction.roams:
        return _Danger("runs come to no motion that repeats", _roams(prediction))
    if results.contact_lost:
        place = ""
        if near is not None:
            apart = speed / near.speed_rpm - 1.0
            side = "above" if apart > 0.0 else "below"
            place = f", {100.0 * abs(apart):.0f} % {side} {near.noun}"
        others = f"{_other_motions(results)}." if results.other_motions else ""
        jumps = facts["jumps"].claim
        unsearched = "" if results.searched else f"{jumps[0].upper()}{jumps[1:]}."
        words = f"{_rises(prediction)} {others} {_jump_words(results)} {_roaming_words(results)} {unsearched}"
        return _Danger(f"{facts['contact'].claim}{place}", " ".join(words.split()))
    if not prediction.stable:
        return _Danger(facts["stable"].claim, "A small disturbance grows until contact is lost.")
    if results.other_motions:
        what = f"the pair can move in {len(results.other_motions) + 1} ways at this speed"
        words = f"{_other_motions(results)}. How the speed was reached decides. {_jump_words(results)}"
        return _Danger(what, words.strip())
    if near is not None:
        words = f"The operating speed is {rpm(speed)}. {_roaming_words(results)}"
        return _Danger(f"{near.words} at {rpm(near.speed_rpm)}", words.strip())
    return None


def _roams(prediction: Prediction) -> str:
    """Sentences on a pair whose runs do not settle: why, and whose the numbers are."""
    if prediction.motion is not Motion.FOLLOWED:
        return f"{prediction.reason} {STANDS_IN}"
    size = quantity(prediction.peak_to_peak, "m", 3)
    return (
        "A run from the linear motion beats or is chaotic. Beside it a stable motion was found from a "
        f"neighbouring torque or speed. All numbers are of this motion; its transmission error is {size}. "
        "Which of the two motions the pair comes to depends on how it reached the speed."
    )


def _rises(prediction: Prediction) -> str:
    return f"The mesh force falls to zero and rises to {prediction.dynamic_factor:.2g} times its mean."


def _like_teeth(results: Results) -> str:
    return f"Like teeth would {'lose it too' if results.like.contact_lost else 'keep it'}."


def _other_motions(results: Results) -> str:
    """Clause with the transmission errors of all stable motions here, the predicted motion first."""
    sizes = [results.like.peak_to_peak, *(one.peak_to_peak for one in results.other_motions)]
    first, *others = (quantity(size, "m", 3) for size in sizes)
    return (
        f"Stable are motions with a transmission error of {first}, as predicted, and {' and '.join(others)}"
    )


def _jump_words(results: Results) -> str:
    """Sentence on the nearest jump; empty: there is no jump."""
    if not results.jump_search.jumps:
        return ""
    jump: Jump = min(results.jump_search.jumps, key=lambda j: abs(j.speed_rpm - results.operating_rpm))
    direction = "up" if jump.rising else "down"
    if not math.isfinite(jump.dte_rms_after):
        return f"Running {direction}, the vibration grows without bound at {rpm(jump.speed_rpm)}."
    factor = jump.dte_rms_after / jump.dte_rms
    return f"Running {direction}, the vibration jumps at {rpm(jump.speed_rpm)} to {factor:.2g} times (rms)."


def _roaming_words(results: Results) -> str:
    """Sentences on beats and chaos near the operating speed; empty: there are none."""
    speed = results.operating_rpm
    near = (
        attractor
        for attractor in results.jump_search.attractors
        if attractor.low_rpm <= (1.0 + NEAR) * speed and attractor.high_rpm >= (1.0 - NEAR) * speed
    )
    return " ".join(f"{attractor.text}." for attractor in near)
