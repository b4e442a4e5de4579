"""Whether both programs agree: the sentence of page 1 and of the chapter on the second program."""

from __future__ import annotations

from typing import NamedTuple

from lumped.outcomes import Absent
from validation.cross_check.verdict import Verdict
from validation.cross_check.words import loss_difference, share
from validation.files.formatting import quantity
from validation.prediction.motion import QUANTITIES, Prediction
from validation.reporting.results import SHORT, Results

#: Numbers of page 1 by which both programs are compared.
_COMPARED = ("dte_peak_to_peak", "dynamic_factor", "tooth_load", "bearing_rms")


def second_program_words(results: Results) -> str:
    """Return the sentence on whether both programs agree, with the number of page 1 that differs most."""
    words = _agreement_words(results)
    return words if results.teeth is None else f"With like teeth, {words[0].lower()}{words[1:]}"


def _agreement_words(results: Results) -> str:
    check = results.check
    second = results.second
    absent = "Not checked: the second program does not run here; its chapter says why."
    if isinstance(check, Absent):
        return absent
    if check.verdict is Verdict.FAILS:
        return "No: a check of the program fails."
    if check.verdict is Verdict.NOT_CHECKED:
        return "The equations are; the second program has no motion to compare."
    if isinstance(second, Absent):
        return absent
    largest = _largest_difference(
        results.like, second, "" if results.pair.shafts is None else " on the shafts"
    )
    if check.verdict is Verdict.AGREES:
        return f"Yes: a second program agrees{results.in_place_of_shafts}. {largest}"
    if all(agreement.within for agreement in check.of("exact")):
        return f"Only the motion: a second program confirms it. {loss_difference(check)}"
    worst = check.worst("exact")
    lumped, second_program = (
        quantity(swing, worst.unit, 3) for swing in (worst.peak_to_peak, worst.peak_to_peak_multibody)
    )
    sizes = f"{lumped} here, {second_program} there, a difference of {share(worst.difference)}"
    if lumped == second_program:
        sizes = f"{lumped} in both, but momentary values differ by up to {share(worst.difference)} of that"
    return (
        f"In part{results.in_place_of_shafts}. A second program with exact contact does not confirm the "
        f"{worst.long_name}: {sizes}. {largest}"
    )


class _Compared(NamedTuple):
    """One number of page 1 by both programs."""

    prediction: float
    second: float

    @property
    def difference(self) -> float:
        """Difference of the second program as a share of the prediction; 0 for a prediction of 0."""
        return abs(self.second / self.prediction - 1.0) if self.prediction else 0.0


def _largest_difference(prediction: Prediction, second: Prediction, supports: str) -> str:
    """Sentence on the number of page 1 that differs most. ``supports``: " on the shafts", or nothing."""
    numbers = {name: _Compared(prediction.numbers[name], second.numbers[name]) for name in _COMPARED}
    name = max(numbers, key=lambda one: numbers[one].difference)
    number = numbers[name]
    unit, _ = QUANTITIES[name]
    values = f"{quantity(number.prediction, unit, 3)} here, {quantity(number.second, unit, 3)} there"
    return f"Of page 1 the {SHORT[name]} differs most, by {share(number.difference)}: {values}{supports}."
