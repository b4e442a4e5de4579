"""The report's first lines: what may not be relied on, the prediction, and four verdicts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from validation.cross_check.comparison import CrossCheck
from validation.reporting.blocks import Badge
from validation.reporting.chapters.cross_check import NAMES
from validation.reporting.chapters.steady_state import separating_share
from validation.reporting.formatting import number, quantity
from validation.reporting.results import Results
from validation.validity.flag import worst_state


@dataclass(frozen=True)
class Answer:
    """One question a reader has, with its answer.

    Attributes
    ----------
    question : in plain words
    badge : the verdict
    text : the answer in a line
    chapter : key of the chapter that shows why
    """

    question: str
    badge: Badge
    text: str
    chapter: str


@dataclass(frozen=True)
class Summary:
    """Top of the report: a paragraph, and the answers it is made of."""

    sentence: str
    answers: tuple[Answer, ...]


def summarise(results: Results) -> Summary:
    """Put the results into one paragraph, what is wrong first, and four answers."""
    motion, pair, verdict = results.motion, results.pair, results.multipliers.verdict
    load = motion["normal_load"].to_numpy()[motion["contact"].to_numpy() > 0]
    span = quantity(float(np.ptp(motion["dte"].to_numpy())), "m", 3)
    efficiency = f"{100 * float(motion.attrs['mesh_efficiency']):.2f} %"
    predicted = (
        f"Transmission error {span} peak to peak, tooth loads up to "
        f"{number(float(load.max()) / results.static_load, 3)} times the static load, mesh efficiency "
        f"{efficiency}."
    )
    objections = _objections(results)
    if objections:
        predicted = f"Not to be relied on: {'; '.join(objections)}. {predicted}"
    says = "predicts" if not objections else "computes"
    sentence = (
        ("" if not objections else f"Do not rely on this prediction: {'; '.join(objections)}. ")
        + f"At {results.operating_rpm:.5g} rpm and {pair.operating.pinion_torque:.4g} N m the lumped model "
        f"{says} a transmission error of {span} peak to peak and a mesh efficiency of {efficiency}. "
        f"{_agreement(results.check)} The motion is {_stability(results)} {_validity(results)}"
    )
    return Summary(
        sentence,
        (
            Answer(
                "What does the model predict?",
                Badge("violated", "not reliable") if objections else Badge("prediction"),
                predicted,
                "steady_state",
            ),
            Answer(
                "Does the independent model agree?",
                Badge(results.check.verdict),
                f"{_same_equations(results.check)} {finite_motions(results.check)}",
                "cross_check",
            ),
            Answer(
                "Is the motion stable?",
                Badge(verdict),
                f"Largest multiplier {results.multipliers.spectral_radius:.4f} at the operating point; "
                f"stable {_stable_speeds(results)} at the given damping.",
                "stability",
            ),
            Answer(
                "Is the model valid here?",
                Badge(worst_state(results.flags)),
                f"{sum(f.state == 'ok' for f in results.flags)} of {len(results.flags)} checks pass. "
                + _validity(results),
                "validity",
            ),
        ),
    )


def _objections(results: Results) -> list[str]:
    """Why the prediction is none: what makes a motion that no pair would show."""
    verdict = results.multipliers.verdict
    found = [] if verdict == "stable" else [f"the periodic motion is {verdict}, so a pair would leave it"]
    found += [
        f"the assumption “{flag.name.lower()}” is violated"
        for flag in results.flags
        if flag.state == "violated" and flag.key != "stability"
    ]
    if results.check.verdict == "not confirmed":
        found.append("the independent multibody model does not confirm it")
    return found


def _stability(results: Results) -> str:
    verdict = results.multipliers.verdict
    here = "stable here and" if verdict == "stable" else f"{verdict} here and stable"
    return f"{here} {_stable_speeds(results)}."


def _stable_speeds(results: Results) -> str:
    low, high = results.margins.speed_range
    reach = f"at all speeds from {low:.0f} to {high:.0f} rpm"
    unstable = results.margins.unstable_here
    if not unstable.size:
        return reach
    ranges = ", ".join(f"{a:.5g} to {b:.5g} rpm" for a, b in unstable[:3])
    more = f" and {len(unstable) - 3} more ranges" if len(unstable) > 3 else ""
    return f"{reach} but {ranges}{more}"


def _validity(results: Results) -> str:
    """Which assumptions hold here, and over how much of the speed range teeth stay in contact."""
    raised = [flag for flag in results.flags if flag.state != "ok"]
    words = {"warning": "near a limit", "violated": "violated"}
    text = "The model's assumptions hold here"
    if raised:
        listed = (f"{flag.name.lower()} ({words[flag.state]})" for flag in raised)
        text = f"Of the model's assumptions, these are in question here: {', '.join(listed)}"
    share, (low, high) = separating_share(results), results.margins.speed_range
    if not share:
        return f"{text}."
    return (
        f"{text}; at {100 * share:.2g} % of the speeds from {low:.0f} to {high:.0f} rpm teeth would "
        "separate, and neither motion nor stability there is as computed."
    )


def _agreement(check: CrossCheck) -> str:
    if not all(a.within for a in check.of("linear")):
        return f"The independent multibody model does not confirm it. {_same_equations(check)}"
    confirms = {
        "confirmed": "confirms it",
        "bounded": "confirms the equations, but finite motions do more than the lumped motion accounts for",
        "not confirmed": "confirms the equations, but shows another motion",
    }[check.verdict]
    return f"The independent multibody model {confirms}. {finite_motions(check)}"


def _same_equations(check: CrossCheck) -> str:
    worst = check.worst("linear")
    verb = "agrees" if worst.within else "does not agree"
    return (
        f"With the same equations the multibody model {verb}: {NAMES[worst.quantity]} to "
        f"{number(worst.judged, 2)} of its peak to peak, tolerance {number(worst.tolerance.limit, 2)}."
    )


def finite_motions(check: CrossCheck) -> str:
    """How much the exact model differs: in the transmission error, and in whatever differs most.

    And how much of that follows from the lumped motion. Stated whatever the verdict is: a difference that is
    understood, and so within its tolerance, is still one.
    """
    exact = check.of("exact")
    # To the digits printed: the bodies of a 1:1 pair differ by rounding, and the first is named every time.
    largest = max(exact, key=lambda a: float(f"{a.relative_l2:.2g}"))
    dte = next((a for a in exact if a.quantity == "dte"), largest)
    most = ""
    if largest.quantity != dte.quantity:
        most = f" and {NAMES[largest.quantity]}, most of all, by {_percent(largest.relative_l2)}"
    worst = check.worst("exact")
    left, limit = _percent(worst.remainder_l2), _percent(worst.tolerance.limit)
    accounts = f"accounts for all but {left} (tolerance {limit})"
    if worst.remainder_l2 > 0.5 * worst.relative_l2:
        accounts = f"does not account for this ({left} left, tolerance {limit})"
    return (
        f"Its contact follows the actual motion, which changes the {NAMES[dte.quantity]} by "
        f"{_percent(dte.relative_l2)}{most} (rms of the change over rms of the motion); the lumped motion "
        f"alone {accounts}."
    )


def _percent(ratio: float) -> str:
    return quantity(100 * ratio, "%", 2)
