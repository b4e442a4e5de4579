"""The report's first lines: one sentence and four verdicts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from validation.comparison import CrossCheck
from validation.reporting.blocks import Badge
from validation.reporting.chapters.cross_check import NAMES
from validation.reporting.formatting import number, quantity
from validation.reporting.results import Results
from validation.validity import worst_state


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
    """Top of the report: one sentence, and the answers it is made of."""

    sentence: str
    answers: tuple[Answer, ...]


def summarise(results: Results) -> Summary:
    """Put the results into one sentence and four answers."""
    motion = results.motion
    load = motion["normal_load"].to_numpy()[motion["contact"].to_numpy() > 0]
    pair = results.pair
    span = quantity(float(np.ptp(motion["dte"].to_numpy())), "m", 3)
    efficiency = f"{100 * float(motion.attrs['mesh_efficiency']):.2f} %"
    predicted = (
        f"Transmission error {span} peak to peak, tooth loads up to "
        f"{number(float(load.max()) / results.static_load, 3)} times the static load, mesh efficiency "
        f"{efficiency}."
    )
    over_range = _stable_speeds(results)
    state = worst_state(results.flags)
    raised = [flag.name.lower() for flag in results.flags if flag.state != "ok"]
    validity = {
        "ok": "valid here",
        "warning": "near a limit of its validity",
        "violated": "not valid here",
    }[state]
    verdict = results.multipliers.verdict
    stands = verdict == "stable"
    here = "stable here and" if stands else f"{verdict} here and stable"
    says = "predicts" if stands else f"has an {verdict} periodic motion with"
    if not stands:
        predicted = f"No motion that a pair would keep: this periodic motion is {verdict}. {predicted}"
    sentence = (
        f"At {results.operating_rpm:.5g} rpm and {pair.operating.pinion_torque:.4g} N m the lumped model "
        f"{says} a transmission error of {span} peak to peak and a mesh efficiency of {efficiency}; the "
        f"independent multibody model {_agreement(results.check)}; the motion is {here} {over_range}; the "
        f"model is {validity}" + (f" (in question: {', '.join(raised)})." if raised else ".")
    )
    return Summary(
        sentence,
        (
            Answer(
                "What does the model predict?",
                Badge("prediction") if stands else Badge(verdict),
                predicted,
                "steady_state",
            ),
            Answer(
                "Does the independent model agree?",
                Badge(results.check.verdict),
                _first_upper(_agreement_sentence(results.check)) + ".",
                "cross_check",
            ),
            Answer(
                "Is the motion stable?",
                Badge(verdict),
                f"Largest multiplier {results.multipliers.spectral_radius:.4f} at the operating point; "
                f"stable {over_range} at the given damping.",
                "stability",
            ),
            Answer(
                "Is the model valid here?",
                Badge(state),
                f"{sum(f.state == 'ok' for f in results.flags)} of {len(results.flags)} checks pass"
                + (f"; look at: {', '.join(raised)}." if raised else "."),
                "validity",
            ),
        ),
    )


def _stable_speeds(results: Results) -> str:
    low, high = results.margins.speed_range
    reach = f"at all speeds from {low:.0f} to {high:.0f} rpm"
    unstable = results.margins.unstable_here
    if not unstable.size:
        return reach
    width = float(np.sum(unstable[:, 1] - unstable[:, 0]))
    ranges = "one range" if len(unstable) == 1 else f"{len(unstable)} ranges"
    return f"{reach} but {ranges}, {quantity(width, 'rpm', 3)} wide in all"


def _agreement(check: CrossCheck) -> str:
    finite = finite_motions(check)
    return {
        "confirmed": f"agrees within its stated tolerances ({finite})",
        "bounded": f"confirms the equations, and finite motions do more than expected ({finite})",
        "not confirmed": f"does not confirm it ({finite})",
    }[check.verdict]


def finite_motions(check: CrossCheck) -> str:
    """How much the exact model differs: in the transmission error, and in whatever differs most.

    And how much of that the lumped model does not foresee. Stated whatever the verdict is: a difference that
    is understood, and so within its tolerance, is still one.
    """
    exact = check.of("exact")
    largest = max(exact, key=lambda a: a.relative_l2)
    dte = next((a for a in exact if a.quantity == "dte"), largest)
    text = f"difference {_percent(dte.relative_l2)} in the transmission error"
    if largest.quantity != dte.quantity:
        text += f", at most {_percent(largest.relative_l2)}, in {NAMES[largest.quantity]}"
    left = max(a.remainder_l2 for a in exact)
    return f"{text}, foreseen from the lumped model alone but for {_percent(left)} at most"


def _percent(ratio: float) -> str:
    return f"{number(100 * ratio, 2)} %"


def _agreement_sentence(check: CrossCheck) -> str:
    linear = max(check.of("linear"), key=lambda a: a.judged / a.tolerance.limit)
    verb = "agrees with" if linear.within else "disagrees with"
    worst = f"largest use of a tolerance: {number(linear.judged, 2)} of {number(linear.tolerance.limit, 2)}"
    return (
        f"with the same linear equations the multibody model {verb} the lumped one ({worst}); with finite "
        f"motions: {finite_motions(check)}"
    )


def _first_upper(text: str) -> str:
    return text[:1].upper() + text[1:]
