"""The list "Do next" of page 1: actions of the user, with the gain of each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from lumped.outcomes import Absent
from validation.files.formatting import read_table, span
from validation.prediction.inputs import kind_of
from validation.reporting.facts import rpm
from validation.reporting.results import Results
from validation.reporting.verdict import Verdict, way_out

#: An input has an advice where its swing is at least this share of the result.
_COUNTS = 0.05
_MOST_ACTIONS = 3
#: Kind of an input -> what to do about it.
_ADVICE = read_table("validation.reporting", "advice.toml")


@dataclass(frozen=True)
class Action:
    """One thing to do: a sentence, the field or the command, and the gain. Empty: there is none."""

    text: str
    command: str
    gain: str


def actions_of(results: Results, verdict: Verdict) -> tuple[Action, ...]:
    """Return the most useful actions, three at most."""
    actions: list[Action] = []
    if verdict is Verdict.BROKEN:
        return (Action("Report this failure with the parameter file", "report.json", ""),)
    if verdict is Verdict.OUTSIDE:
        actions = [Action(flag.action.removesuffix("."), "", "") for flag in results.outside]
    if verdict is Verdict.CONTRADICTED:
        what = "See which channel and which order the record contradicts"
        actions = [Action(what, "chapter “The record”", "")]
    if verdict is Verdict.DO_NOT_RUN:
        hazard = results.nearest_hazard
        if hazard is not None and hazard.kind == "jump":
            actions.append(Action(f"Do not pass {rpm(hazard.speed_rpm)} at this torque", "", ""))
        if results.teeth_apart:
            actions.append(
                Action("Take teeth of a better tolerance class, more torque or less speed", "", "")
            )
        command = f"spurcheck response {results.name} --map"
        actions.append(Action("See where the pair can jump, over speed and torque", command, ""))
        actions.append(Action("Try tip relief for this torque", "--set pinion.tip_relief.amount=...", ""))
    resonance = results.resonance
    runs = verdict in (Verdict.ABSOLUTE, Verdict.UNCERTAIN)
    if runs and resonance is not None and resonance.near and (words := way_out(resonance)):
        actions.append(Action(f"Move the speed off the resonance, {words}", "", ""))
    actions += _open_searches(results) + _further_samples(results)
    return (*actions, *advice_on_inputs(results))[:_MOST_ACTIONS]


def _open_searches(results: Results) -> list[Action]:
    """Command to continue the search for jumps, in the nearest range behind the time limit."""
    speed = results.operating_rpm
    open_ranges = sorted(results.jump_search.open, key=lambda ends: min(abs(end - speed) for end in ends))
    return [
        Action(
            f"Search for jumps from {low:.0f} to {high:.0f} rpm",
            f"spurcheck response {results.name} --range {low:.0f}..{high:.0f}",
            "",
        )
        for low, high in open_ranges[:1]
    ]


def _further_samples(results: Results) -> list[Action]:
    """Command to compute the samples behind the time limit."""
    samples = results.uncertainty
    if not isinstance(samples, xr.Dataset) or samples.attrs["taken"] == samples.attrs["asked"]:
        return []
    command = f"spurcheck uncertainty {results.name} --samples {samples.attrs['asked']}"
    return [Action("Take all possible machines into the range", command, "")]


def advice_on_inputs(results: Results) -> list[Action]:
    """Return one action for each kind of input, the input with the largest effect first."""
    samples = results.uncertainty
    if isinstance(samples, Absent):
        vary = Action("Vary the assumed inputs", f"spurcheck uncertainty {results.name}", "")
        return [vary] if results.varies else []
    predicted_size = results.like.peak_to_peak
    swing = samples["dte_peak_to_peak_swing"].to_numpy()
    actions: dict[str, Action] = {}
    for j in np.argsort(-np.nan_to_num(np.ptp(swing, axis=1))):
        low = swing[j].min()
        high = swing[j].max()
        if not high - low > _COUNTS * predicted_size:  # NaN: this input was not moved alone
            break
        field = str(samples["input"].to_numpy()[j])
        kind = kind_of(field)
        advice = _ADVICE.get(kind, {"text": "Narrow the range of this input", "command": field})
        if kind not in actions:
            gain = f"it moves the transmission error from {span(low, high, 'm')}"
            actions[kind] = Action(advice["text"], advice["command"].format(field=field), gain)
    return list(actions.values())
