"""Page 1 of the report: one verdict, six numbers, what to do next, how sure, three figures."""

from __future__ import annotations

import fnmatch
import math
from dataclasses import dataclass
from enum import Enum

import numpy as np
import xarray as xr

from floquet.gear.response import ResponseBranches
from lumped.outcomes import Absent
from validation.files.formatting import number, quantity, read_table
from validation.prediction.inputs import uncertain_inputs
from validation.prediction.motion import QUANTITIES, Prediction
from validation.reporting.first_figures import plain_name
from validation.reporting.results import Results, failed_checks

#: Largest half range of the transmission error, over its median, of a prediction for absolute levels.
ABSOLUTE = 0.10
#: A jump or an unstable speed nearer than this share of the operating speed counts as at it.
NEAR = 0.05
#: An input counts whose swing is at least this share of the result.
_COUNTS = 0.05
_MOST_ACTIONS = 3
#: A result this close to an end of the range is printed as that end.
_ROUNDING = 0.005
#: First words of a hazard -> the hazard as a noun.
_KINDS = {"jump": "a jump", "beats": "beats", "chaos": "chaos", "periodic": "another motion"}
_ADVICE = read_table("validation.reporting", "advice.toml")["advice"]
_NOT_MODELLED = "Not modelled: helix; misalignment; housing and sound radiation."
#: Before it, of a pair whose teeth are alike, and of one whose teeth differ.
_ALIKE = "All teeth are taken as alike: no pitch errors, no sidebands."
_OWN = (
    "Numbers are those of the teeth as given; ranges but that of the transmission error, the second program, "
    "curves over speed and stability are of like teeth and stand in their chapters."
)


class Verdict(Enum):
    """What the prediction may be used for; the value is the title that the reader gets."""

    ABSOLUTE = "Usable for absolute levels."
    COMPARE = "Usable to compare variants. Not yet usable for absolute levels."
    DO_NOT_RUN = "Do not run here"
    OUTSIDE = "Outside the model"
    BROKEN = "Do not rely on this: a check of the program failed."

    @property
    def tone(self) -> str:
        """Class of the box on the page: good, fair or bad."""
        return {"ABSOLUTE": "good", "COMPARE": "fair", "OUTSIDE": "fair"}.get(self.name, "bad")


@dataclass(frozen=True)
class Number:
    """One row of the table of page 1: the result in SI, 5 and 95 % of the samples, by the second program.

    NaN is what was not computed; the unit is "1" for a ratio, "rpm" for a distance of speeds.
    """

    key: str
    label: str
    value: float
    unit: str
    low: float = math.nan
    high: float = math.nan
    second: float = math.nan
    note: str = ""

    @property
    def digits(self) -> int:
        """Digits that the range supports: two where it is wider than 5 % to each side, else three."""
        wide = math.isfinite(self.low) and self.high - self.low > 0.1 * abs(self.value)
        return 2 if wide else 3

    @property
    def shown(self) -> str:
        """The result as printed."""
        return _printed(self.value, self.unit, self.digits)

    @property
    def range(self) -> str:
        """The range as printed; empty where there is none."""
        if not math.isfinite(self.low):
            return ""
        low, high = (_printed(end, self.unit, self.digits) for end in (self.low, self.high))
        number, _, unit = low.partition("\u00a0")
        return f"{number if high.endswith(unit) else low} to {high}"

    @property
    def second_shown(self) -> str:
        """The second program's result as printed."""
        return _printed(self.second, self.unit, 3) if math.isfinite(self.second) else "not computed"


@dataclass(frozen=True)
class Action:
    """One thing to do: what, the field or command, and what it gains."""

    text: str
    command: str
    gain: str


@dataclass(frozen=True)
class PageOne:
    """What the first page says, in its order."""

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


def page_one(results: Results) -> PageOne:
    """Return what the first page says of a pair."""
    verdict, headline, reason = _verdict(results)
    return PageOne(
        title=title(results),
        verdict=verdict,
        headline=headline,
        reason=reason,
        numbers=six_numbers(results),
        actions=_actions(results, verdict),
        sure=_sure(results),
        remark=_remark(results),
        not_modelled=f"{_ALIKE if results.teeth is None else _OWN} {_NOT_MODELLED}",
        warnings=results.warnings,
    )


def title(results: Results) -> str:
    """Teeth, module, width, speed, torque and power of the pair."""
    pair = results.pair
    width = 1e3 * min(pair.pinion.face_width, pair.gear.face_width)
    power = pair.operating.pinion_torque * pair.operating.pinion_speed
    return (
        f"{pair.name}: spur gears {pair.pinion.teeth}/{pair.gear.teeth}, "
        f"m {1e3 * pair.basic_rack.module:.4g}, b {width:.4g} mm, {_rpm(results.operating_rpm)}, "
        f"{pair.operating.pinion_torque:.4g} N m ({quantity(power, 'W', 3)})"
    )


def six_numbers(results: Results) -> tuple[Number, ...]:
    """The rows of the table: result, range of the samples, second program."""
    prediction, second = results.prediction, results.second
    notes = {"bearing_rms": _orders(results)} | _as_given(results)
    rows = [_row(results, key, note=notes.get(key, "")) for key in _ROWS]
    if prediction.contact_lost:  # six rows: the bearing force gives way
        of_second = math.nan
        if results.teeth is None and not isinstance(second, Absent):  # it has like teeth
            of_second = second.least_force
        words = "Smallest mesh force / static", prediction.least_force, "1"
        rows[3] = Number("least_force", *words, second=of_second, note="0 is contact loss")
    hazard, own = results.nearest_hazard, results.operating_rpm
    low, high = (_rpm(speed) for speed in results.speeds)
    far, note = math.nan, f"none from {low} to {high}"
    if hazard is not None:
        far, note = hazard[0] - own, f"{hazard[1]} at {_rpm(hazard[0])}"
    label = "Distance to the nearest unstable speed, jump or chaos"
    return (*rows, Number("hazard", label, far, "rpm", note=note + results.on_springs))


#: Key of a number of the prediction -> its words on page 1.
_ROWS = {
    "dte_peak_to_peak": "Transmission error, peak to peak",
    "dynamic_factor": "Dynamic factor: largest mesh force / static",
    "tooth_load": "Largest load on one tooth / static mesh force",
    "bearing_rms": "Dynamic force on the pinion bearings, rms",
    "efficiency": "Mesh efficiency",
}


def first_numbers(prediction: Prediction) -> tuple[Number, ...]:
    """The numbers of page 1 that the prediction alone gives."""
    return tuple(Number(key, label, prediction.numbers[key], _unit(key)) for key, label in _ROWS.items())


def _unit(key: str) -> str:
    return "%" if key == "efficiency" else QUANTITIES[key][0]


def _row(results: Results, key: str, note: str = "") -> Number:
    prediction, second, found = results.prediction, results.second, results.uncertainty
    low = high = of_second = math.nan
    if results.teeth is not None:  # samples and second program are of like teeth
        if key == "dte_peak_to_peak" and results.teeth_band is not None:
            low, high = results.teeth_band[:, 0].tolist()
    else:
        if isinstance(found, xr.Dataset):
            low, high = (float(end) for end in found[f"{key}_percentile"].to_numpy()[[0, -1]])
        of_second = math.nan if isinstance(second, Absent) else second.numbers[key]
    return Number(key, _ROWS[key], prediction.numbers[key], _unit(key), low, high, of_second, note)


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
    teeth, like = results.teeth, results.like.numbers
    if teeth is None:
        return {}
    notes = {
        key: f"like teeth {_printed(like[key], _unit(key), 3)}" for key in ("dynamic_factor", "tooth_load")
    }
    swing = _printed(like["dte_peak_to_peak"], "m", 3)
    return notes | {"dte_peak_to_peak": f"over {teeth.period} mesh cycles; like teeth {swing}"}


def _verdict(results: Results) -> tuple[Verdict, str, str]:
    if broken := failed_checks(results):
        return Verdict.BROKEN, Verdict.BROKEN.value, f"Failed: {'; '.join(broken[:3])}."
    prediction = results.prediction
    if outside := results.outside:
        first, *others = (flag.detail for flag in outside)
        return Verdict.OUTSIDE, f"{Verdict.OUTSIDE.value}: {first}.", "; ".join(others)
    if reason := _hazard(results, prediction):
        return Verdict.DO_NOT_RUN, f"{Verdict.DO_NOT_RUN.value}: {reason[0]}.", reason[1]
    if prediction.reason:
        text = f"No motion with unilateral contact was found: {prediction.reason}"
        return Verdict.COMPARE, Verdict.COMPARE.value, f"{text} The numbers are those of the linear motion."
    calm = _calm(results)
    found = results.uncertainty
    given, assumed, word = results.inputs
    inputs = f"{assumed} of {given + assumed} inputs are {word}"
    half = 0.0
    if results.teeth_band is not None:
        low, high = results.teeth_band[:, 0]
        half = (high - low) / (high + low)
    elif isinstance(found, xr.Dataset):
        low, middle, high = found["dte_peak_to_peak_percentile"].to_numpy()
        half = 0.5 * (high - low) / middle
    elif assumed or uncertain_inputs(results.pair):
        return Verdict.COMPARE, Verdict.COMPARE.value, f"{calm} But {inputs}, and they were not varied."
    measured = results.measured_error
    if measured is not None and not measured.explained and abs(measured.error) > ABSOLUTE * measured.measured:
        text = f"{calm} But the record differs by {100 * abs(measured.error) / measured.measured:.0f} %"
        return Verdict.COMPARE, Verdict.COMPARE.value, f"{text}, more than inputs and noise explain."
    if half <= ABSOLUTE:
        text = "a record confirms it" if measured is not None else "no measurement confirms it"
        text = f"{calm} The inputs leave {100 * half:.0f} %; {text}."
        return Verdict.ABSOLUTE, Verdict.ABSOLUTE.value, text
    return (
        Verdict.COMPARE,
        Verdict.COMPARE.value,
        f"{calm} But {inputs}, and they move the transmission error by ±{100 * half:.0f} %.",
    )


def _hazard(results: Results, prediction: Prediction) -> tuple[str, str] | None:
    """Why the pair must not run here, and what happens; None where it may."""
    hazard = results.nearest_hazard
    near = hazard is not None and abs(hazard[0] / results.operating_rpm - 1.0) <= NEAR
    what = f"{hazard[1]} at {_rpm(hazard[0])}" if near and hazard else ""
    if results.teeth_apart:
        what = f"the teeth lose contact, at {results.teeth_apart} pairs of teeth that meet"
        return what, f"{_rises(prediction)} {_like_teeth(results)}"
    if results.contact_lost:
        apart = 0.0 if hazard is None else 100.0 * (results.operating_rpm / hazard[0] - 1.0)
        side = "above" if apart > 0.0 else "below"
        kind = "" if hazard is None else _KINDS.get(hazard[1].split()[0].strip(","), "an unstable speed")
        place = f", {abs(apart):.0f} % {side} {kind}" if near else ""
        others = f"{_other_motions(results)}." if results.other_motions else ""
        words = f"{_rises(prediction)} {others} {_jump_words(results)} {_attractor_words(results)}"
        return f"the teeth lose contact{place}", " ".join(words.split())
    if not prediction.stable:
        return "the motion is unstable", "A small disturbance grows until contact is lost."
    if results.other_motions:
        what = f"the pair can move in {len(results.other_motions) + 1} ways at this speed"
        return (
            what,
            f"{_other_motions(results)}. How the speed was reached decides. {_jump_words(results)}".strip(),
        )
    if near:
        return (
            what,
            f"The operating speed is {_rpm(results.operating_rpm)}. {_attractor_words(results)}".strip(),
        )
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
    if not isinstance(results.branches, ResponseBranches) or not results.branches.jumps:
        return ""
    jump = min(results.branches.jumps, key=lambda j: abs(j.speed_rpm - results.operating_rpm))
    way = "up" if jump.rising else "down"
    if not math.isfinite(jump.dte_rms_after):
        return f"Running {way}, the vibration grows without bound at {_rpm(jump.speed_rpm)}."
    factor = jump.dte_rms_after / jump.dte_rms
    return f"Running {way}, the vibration jumps at {_rpm(jump.speed_rpm)} to {factor:.2g} times (rms)."


def _attractor_words(results: Results) -> str:
    """Beats or chaos about the operating speed; empty where there are none."""
    own, branches = results.operating_rpm, results.branches
    found = branches.attractors if isinstance(branches, ResponseBranches) else ()
    near = (one for one in found if one.low_rpm <= (1.0 + NEAR) * own and one.high_rpm >= (1.0 - NEAR) * own)
    return " ".join(f"{one.text}." for one in near)


def _calm(results: Results) -> str:
    low, high = (_rpm(speed) for speed in results.speeds)
    if results.nearest_hazard is None:
        return f"The pair runs smoothly: contact is kept, and no speed from {low} to {high} is unstable."
    return "The pair runs smoothly at this speed: contact is kept and the motion is stable."


def _actions(results: Results, verdict: Verdict) -> tuple[Action, ...]:
    found: list[Action] = []
    if verdict is Verdict.BROKEN:
        return (Action("Report this failure with the parameter file", "report.json", ""),)
    if verdict is Verdict.OUTSIDE:
        found = [Action(flag.action.removesuffix("."), "", "") for flag in results.outside]
    if verdict is Verdict.DO_NOT_RUN:
        hazard = results.nearest_hazard
        if hazard is not None and "jump" in hazard[1]:
            found.append(Action(f"Do not pass {_rpm(hazard[0])} at this torque", "", ""))
        if results.teeth_apart:
            found.append(Action("Take teeth of a better tolerance class, more torque or less speed", "", ""))
        found.append(
            Action(
                "See where the pair can jump, over speed and torque",
                f"spurcheck response {results.name} --map",
                "",
            )
        )
        found.append(Action("Try tip relief for this torque", "--set pinion.tip_relief.amount=...", ""))
    return (*found, *advice_on_inputs(results))[:_MOST_ACTIONS]


def advice_on_inputs(results: Results) -> list[Action]:
    """What to do about the inputs that move the result most, one action a kind of input."""
    found = results.uncertainty
    if isinstance(found, Absent):
        vary = Action("Vary the assumed inputs", f"spurcheck uncertainty {results.name}", "")
        return [vary] if uncertain_inputs(results.pair) else []
    given = results.like.peak_to_peak
    swing = found["dte_peak_to_peak_swing"].to_numpy()
    actions: dict[str, Action] = {}
    for j in np.argsort(-np.nan_to_num(np.ptp(swing, axis=1))):
        low, high = swing[j].min(), swing[j].max()
        if high - low < _COUNTS * given:
            break
        field = str(found["input"].to_numpy()[j])
        advice = next((one for one in _ADVICE if fnmatch.fnmatchcase(field, one["field"])), None)
        if advice is not None and results.pair.mesh.stiffness.model in advice.get("unless_model", ()):
            continue  # the pair has it already
        if advice is not None and advice["text"] not in actions:
            gain = f"it moves the transmission error from {quantity(low, 'm', 2)} to {quantity(high, 'm', 2)}"
            actions[advice["text"]] = Action(advice["text"], advice["command"], gain)
    return list(actions.values())


def _sure(results: Results) -> tuple[str, ...]:
    given, assumed, word = results.inputs
    measured, compared = results.measured_error, "no"
    if measured is not None:
        error, size = quantity(measured.error, "m", 2), quantity(2.0 * measured.uncertainty, "m", 2)
        compared = f"yes, the prediction less the record is {error}, known to ±{size}"
    return (
        f"Solved right? {results.second_words}",
        f"Inputs: {given} given, {assumed} {word}.",
        f"Compared with a measurement? {compared[0].upper()}{compared[1:]}.",
    )


def _remark(results: Results) -> str:
    prediction, linear = results.prediction, results.linear
    if prediction.contact_lost and not isinstance(linear, Absent):
        size = quantity(float(linear.attrs["dte_peak_to_peak"]), "m", 3)
        return f"The linear model would give {size}. It lets teeth pull, so it is not used here."
    return _beyond_the_range(results)


def _beyond_the_range(results: Results) -> str:
    """Why a result as given lies outside the range of the samples; empty where none does."""
    found = results.uncertainty
    if isinstance(found, Absent):
        return ""
    for key, label in _ROWS.items():
        given, ends = results.like.numbers[key], found[f"{key}_percentile"].to_numpy()[[0, -1]]
        if ends[0] * (1.0 - _ROUNDING) <= given <= ends[1] * (1.0 + _ROUNDING):
            continue
        swing = np.nan_to_num(found[f"{key}_swing"].to_numpy(), nan=given)
        # The input that, at its ends, takes the result furthest back into the range.
        back = (swing - given).max(axis=1) if given < ends[0] else (given - swing).max(axis=1)
        name = plain_name(str(found["input"].to_numpy()[int(np.argmax(back))]))
        side = "below" if given < ends[0] else "above"
        return (
            f"As given, “{label}” lies {side} the range of the samples: what is assumed for the {name} "
            "stands at the end of its range."
        )
    return ""


def _rpm(speed: float) -> str:
    return f"{number(speed, 5)} rpm"


def _printed(value: float, unit: str, digits: int) -> str:
    if not math.isfinite(value):
        return "none"
    if unit == "rpm":
        return f"{value:+.0f} rpm".replace("-", "\u2212")
    if unit == "%":
        return f"{100.0 * value:.{max(digits - 2, 0) + 1}f} %"
    return quantity(value, unit, digits, measured=True)
