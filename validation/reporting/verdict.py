"""The report's first lines: one sentence and four verdicts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from validation.comparison import CrossCheck
from validation.reporting.blocks import Badge
from validation.reporting.chapters.stability import margins
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
    m = margins(results.chart, results.operating_rpm, pair.mesh.damping_ratio)
    speeds = results.chart["speed_rpm"].to_numpy()
    reach = f"{speeds[0]:.0f} to {speeds[-1]:.0f} rpm"
    everywhere = m.stable_speeds == m.speeds
    over_range = (
        f"at all {m.speeds} speeds from {reach}"
        if everywhere
        else f"at {m.stable_speeds} of {m.speeds} speeds from {reach}"
    )
    state = worst_state(results.flags)
    raised = [flag.name.lower() for flag in results.flags if flag.state != "ok"]
    validity = {
        "ok": "valid here",
        "warning": "near a limit of its validity",
        "violated": "not valid here",
    }[state]
    verdict = results.multipliers.verdict
    here = "stable here and" if verdict == "stable" else f"{verdict} here and stable"
    sentence = (
        f"At {results.operating_rpm:.5g} rpm and {pair.operating.pinion_torque:.4g} N m the lumped model "
        f"predicts a transmission error of {span} peak to peak and a mesh efficiency of {efficiency}; the "
        f"independent multibody model {_agreement(results.check)}; the motion is {here} {over_range}; the "
        f"model is {validity}" + (f" ({', '.join(raised)})." if raised else ".")
    )
    return Summary(
        sentence,
        (
            Answer(
                "What does the model predict?",
                Badge("prediction"),
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


def _agreement(check: CrossCheck) -> str:
    exact = next(a for a in check.of("exact") if a.quantity == "dte")
    finite = f"{100 * exact.relative_l2:.2g} % of the transmission error"
    return {
        "confirmed": f"confirms it (finite motions change {finite}, as expected)",
        "bounded": f"confirms the equations and bounds the effect of finite motions ({finite})",
        "not confirmed": "does not confirm it",
    }[check.verdict]


def _agreement_sentence(check: CrossCheck) -> str:
    linear = next(a for a in check.of("linear") if a.quantity == "dte")
    exact = next(a for a in check.of("exact") if a.quantity == "dte")
    worst = check.worst("exact")
    if not all(a.within for a in check.of("linear")):
        return f"the multibody model does not confirm the equations (difference {number(linear.judged, 2)})"
    text = f"the multibody model confirms the equations to {number(linear.judged, 2)}"
    finite = f"finite motions change the transmission error by {100 * exact.relative_l2:.2g} %"
    if check.verdict == "confirmed":
        return f"{text}, and {finite}, as expected"
    beyond = (
        "" if worst.quantity == "dte" else f" and the {worst.long_name} by {100 * worst.relative_l2:.2g} %"
    )
    if check.verdict == "bounded":
        return f"{text}, while {finite}{beyond}, more than expected"
    return f"{text}, but {finite}{beyond}: the lumped motion no longer describes it"


def _first_upper(text: str) -> str:
    return text[:1].upper() + text[1:]
