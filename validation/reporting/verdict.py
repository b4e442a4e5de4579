"""The verdict of page 1: one of six, its headline, and the reason, from the facts of the report."""

from __future__ import annotations

import math
from collections.abc import Mapping
from enum import Enum

from floquet.gear.response import Jump
from validation.files.formatting import number, quantity
from validation.measurements.channel_comparison import Record
from validation.prediction.motion import Prediction
from validation.prediction.resonance import Resonance
from validation.reporting.facts import Fact, rpm, spread_words
from validation.reporting.results import SHORT, Results, failed_checks

#: Largest distance of 5 and of 95 % from the result, over it, of numbers for absolute levels.
ABSOLUTE = 0.10
#: A jump or an unstable speed nearer than this share of the operating speed counts as at it.
NEAR = 0.05
#: Numbers of page 1 that have a range.
RANGED = ("dte_peak_to_peak", "dynamic_factor", "tooth_load", "bearing_rms", "efficiency")


class Verdict(Enum):
    """What the prediction may be used for; the value is the title that the reader gets. The worst is last."""

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


def verdict_of(results: Results, facts: Mapping[str, Fact]) -> tuple[Verdict, str, str]:
    """Return the verdict, its headline, and the reason in a sentence or a few."""
    if broken := failed_checks(results):
        return Verdict.BROKEN, f"{Verdict.BROKEN.value}.", f"Failed: {'; '.join(broken[:3])}."
    if outside := results.outside:
        first, *others = (flag.detail for flag in outside)
        return Verdict.OUTSIDE, f"{Verdict.OUTSIDE.value}: {first}.", "; ".join(others)
    if hazard := _hazard(results, facts):
        return Verdict.DO_NOT_RUN, f"{Verdict.DO_NOT_RUN.value}: {hazard[0]}.", hazard[1]
    record = results.measured_error
    if record is not None and record.verdict is Record.CONTRADICTS:
        return Verdict.CONTRADICTED, f"{Verdict.CONTRADICTED.value}.", record.words
    if reason := results.prediction.reason:
        text = f"No motion with unilateral contact was found: {reason}"
        headline = f"{Verdict.UNCERTAIN.value}: the linear motion stands in."
        return Verdict.UNCERTAIN, headline, f"{text} The numbers are those of the linear motion."
    calm = smooth(results, facts)
    doubt = _doubt(results, facts)
    confirmed = record is not None and record.verdict is Record.CONFIRMS
    if doubt is not None:
        ranged = any(results.spread(name) is not None for name in RANGED)
        more = "; the range is that of every possible machine." if ranged else "."
        text = f"{calm} A record confirms the prediction{more}" if confirmed else calm
        return Verdict.UNCERTAIN, f"{Verdict.UNCERTAIN.value}: {doubt}.", text
    why = "A record confirms them." if confirmed else "Every input is known."
    return Verdict.ABSOLUTE, f"{Verdict.ABSOLUTE.value}.", f"{calm} {why}"


def _doubt(results: Results, facts: Mapping[str, Fact]) -> str | None:
    """Why absolute levels are uncertain; None where they are not."""
    spreads = {name: results.spread(name) for name in RANGED}
    known = {name: spread for name, spread in spreads.items() if spread is not None}
    record = results.measured_error
    assumed = results.inputs[1]
    if not known and "samples" in facts:
        return facts["samples"].claim
    if not known and results.varies:
        return f"{facts['inputs'].claim}, and they were not varied"
    widest = max(known, key=lambda name: max(-known[name][0], known[name][1]), default="")
    if widest and max(-known[widest][0], known[widest][1]) > ABSOLUTE:
        claims = [facts["levels"].claim] if "levels" in facts else []  # a mesh that vibrates has them
        if widest != "dte_peak_to_peak":
            claims.append(f"{SHORT[widest]} {spread_words(known[widest])}")
        return ", ".join(claims)
    if record is not None and record.verdict is Record.CONFIRMS:
        return None
    return f"{facts['inputs'].claim}, and no record confirms the prediction" if assumed else None


def smooth(results: Results, facts: Mapping[str, Fact]) -> str:
    """How a pair runs that has no hazard at its operating speed, and where hazards were searched."""
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
    """The speeds that leave a resonance, "below 1390 rpm or above 1650 rpm"; empty where none was found."""
    ways = [
        f"{side} {number(speed, 3)} rpm"
        for side, speed in (("below", resonance.below_rpm), ("above", resonance.above_rpm))
        if math.isfinite(speed)
    ]
    return " or ".join(ways)


def searched_words(results: Results, facts: Mapping[str, Fact]) -> str:
    """What was found over speed, and over which speeds; empty where the row of the nearest hazard says it."""
    left = facts.get("jumps_left_open")
    rest = "" if left is None else f" {left.claim[0].upper()}{left.claim[1:]}."
    if results.nearest_hazard is not None:
        return rest.strip()
    unstable = facts["unstable_speeds"]
    jumps = facts["jumps"]
    if unstable.scope.speeds == jumps.scope.speeds:
        where = unstable.scope.speeds
        return f"{where[0].upper()}{where[1:]} {unstable.claim}, and {jumps.claim}{results.on_springs}.{rest}"
    first = f"{unstable.scope.speeds[0].upper()}{unstable.scope.speeds[1:]} {unstable.claim}"
    return f"{first}; {jumps.scope.speeds} {jumps.claim}{results.on_springs}.{rest}"


def _hazard(results: Results, facts: Mapping[str, Fact]) -> tuple[str, str] | None:
    """Why the pair must not run here, and what happens; None where it may."""
    prediction = results.prediction
    hazard = results.nearest_hazard
    own = results.operating_rpm
    near = hazard if hazard is not None and abs(hazard.speed_rpm / own - 1.0) <= NEAR else None
    if results.teeth_apart:
        return facts["contact"].claim, f"{_rises(prediction)} {_like_teeth(results)}"
    if results.contact_lost:
        place = ""
        if near is not None:
            apart = own / near.speed_rpm - 1.0
            side = "above" if apart > 0.0 else "below"
            place = f", {100.0 * abs(apart):.0f} % {side} {near.noun}"
        others = f"{_other_motions(results)}." if results.other_motions else ""
        open_here = (
            "" if results.searched else f"{facts['jumps'].claim[0].upper()}{facts['jumps'].claim[1:]}."
        )
        words = f"{_rises(prediction)} {others} {_jump_words(results)} {_roaming_words(results)} {open_here}"
        return f"{facts['contact'].claim}{place}", " ".join(words.split())
    if not prediction.stable:
        return facts["stable"].claim, "A small disturbance grows until contact is lost."
    if results.other_motions:
        what = f"the pair can move in {len(results.other_motions) + 1} ways at this speed"
        words = f"{_other_motions(results)}. How the speed was reached decides. {_jump_words(results)}"
        return what, words.strip()
    if near is not None:
        words = f"The operating speed is {rpm(own)}. {_roaming_words(results)}"
        return f"{near.words} at {rpm(near.speed_rpm)}", words.strip()
    return None


def _rises(prediction: Prediction) -> str:
    return f"The mesh force falls to zero and rises to {prediction.dynamic_factor:.2g} times the static one."


def _like_teeth(results: Results) -> str:
    return f"Like teeth would {'lose it too' if results.like.contact_lost else 'keep it'}."


def _other_motions(results: Results) -> str:
    """The transmission errors of all stable motions at the operating speed, the predicted one first."""
    sizes = [results.like.peak_to_peak, *(one.peak_to_peak for one in results.other_motions)]
    first, *others = (quantity(size, "m", 3) for size in sizes)
    return (
        f"Stable are motions with a transmission error of {first}, as predicted, and {' and '.join(others)}"
    )


def _jump_words(results: Results) -> str:
    """What happens at the nearest jump; empty where there is none."""
    if not results.jump_search.jumps:
        return ""
    jump: Jump = min(results.jump_search.jumps, key=lambda j: abs(j.speed_rpm - results.operating_rpm))
    way = "up" if jump.rising else "down"
    if not math.isfinite(jump.dte_rms_after):
        return f"Running {way}, the vibration grows without bound at {rpm(jump.speed_rpm)}."
    factor = jump.dte_rms_after / jump.dte_rms
    return f"Running {way}, the vibration jumps at {rpm(jump.speed_rpm)} to {factor:.2g} times (rms)."


def _roaming_words(results: Results) -> str:
    """Beats or chaos about the operating speed; empty where there are none."""
    own = results.operating_rpm
    near = (
        one
        for one in results.jump_search.attractors
        if one.low_rpm <= (1.0 + NEAR) * own and one.high_rpm >= (1.0 - NEAR) * own
    )
    return " ".join(f"{one.text}." for one in near)
