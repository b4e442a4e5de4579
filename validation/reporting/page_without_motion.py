"""Page 1 of a pair whose motion, or another result of page 1, cannot be computed: what is known without it.

The verdict says why. The rows are those of the prediction where there is one, then the static ones: they need
no motion.
"""

from __future__ import annotations

import math
from dataclasses import replace

from lumped.errors import BeyondFlanksError, NumericalError, SlowPairError
from lumped.model.averaged import Mode
from validation.files.formatting import number, quantity
from validation.prediction.motion import ORDERS
from validation.prediction.resonance import mode_name
from validation.prediction.static import StaticPair
from validation.reporting.actions import Action
from validation.reporting.facts import Fact, Scope, rpm
from validation.reporting.first_numbers import Number, first_numbers
from validation.reporting.page_one import PageOne, measurement_words, page_one, title
from validation.reporting.results import Results
from validation.reporting.verdict import Judgement, Verdict

_NOTHING_COMPARED = "Solved right? Not checked: the second program was not compared."
_STATIC = "These rows are static: the pair at rest under its torque, with perfect teeth."


def first_page(results: Results) -> PageOne:
    """Return page 1 of any pair: the complete one where all of its results can be computed."""
    if (none := results.without_motion) is not None:
        return page_without_motion(results, none)
    try:
        return page_one(results)
    except NumericalError as error:
        return page_without_motion(results, error)


def page_without_motion(results: Results, error: NumericalError) -> PageOne:
    """Return page 1 of a pair of which a result of page 1 cannot be computed.

    ``error``: the error of the result that page 1 needs.
    """
    predicted = results.without_motion is None
    known_count, assumed = results.inputs
    fact = _fact(results, error)
    verdict, headline, reason = judgement(results, error)
    rows = (*(first_numbers(results.prediction) if predicted else ()), *static_numbers(results.static))
    scope = fact.scope.words
    return PageOne(
        title=title(results),
        verdict=verdict,
        headline=headline,
        reason=reason,
        numbers=tuple(replace(row, scope=scope) for row in rows if math.isfinite(row.value)),
        actions=actions_without_motion(results, error),
        sure=(
            _NOTHING_COMPARED,
            f"Inputs: {assumed} of {known_count + assumed} inputs are assumed.",
            f"Compared with a measurement? {measurement_words(results, None)}.",
        ),
        remark="" if predicted else _STATIC,
        not_modelled="Not modelled: helix; misalignment; housing and sound radiation.",
        warnings=results.warnings,
        facts=(fact,),
    )


def judgement(results: Results, error: NumericalError) -> Judgement:
    """Return verdict, headline and reason. ``error``: of the result that page 1 needs."""
    words = _clause(error)
    if results.without_motion is None:
        headline = f"{Verdict.UNCERTAIN.value}: a part of this report could not be computed."
        return Judgement(Verdict.UNCERTAIN, headline, str(error))
    none = "No motion was computed, so the numbers below are static."
    geometry = results.pair.geometry
    undercut = geometry.undercut_pinion > 0.0 or geometry.undercut_gear > 0.0
    if isinstance(error, BeyondFlanksError) and not undercut:
        return Judgement(Verdict.DO_NOT_RUN, f"{Verdict.DO_NOT_RUN.value}: {words}.", none)
    if isinstance(error, BeyondFlanksError):
        return Judgement(Verdict.OUTSIDE, f"{Verdict.OUTSIDE.value}: {words}.", none)
    if isinstance(error, SlowPairError):
        headline = f"{Verdict.UNCERTAIN.value}: the static values stand in."
        reason = f"No motion was computed: {words[0].lower()}{words[1:]}. So slow a pair hardly vibrates."
        return Judgement(Verdict.UNCERTAIN, headline, reason)
    headline = f"{Verdict.DO_NOT_RUN.value}: the model has no bounded motion here."
    return Judgement(Verdict.DO_NOT_RUN, headline, f"{error} {none}")


def _clause(error: NumericalError) -> str:
    """The first clause of an error, which says what is wrong, without the advice behind the colon."""
    clause = str(error).partition(": ")[0].removesuffix(".")
    return f"{clause[0].lower()}{clause[1:]}"


def _fact(results: Results, error: NumericalError) -> Fact:
    """The fact that a result of page 1 cannot be computed."""
    speed = results.operating_rpm
    scope = Scope(
        (speed, speed),
        motion="no motion" if results.without_motion is not None else results.prediction.motion.text,
        supports="springs" if results.pair.shafts is None else "shafts",
        teeth="alike" if results.given is results.pair else "as given",
        inputs="as given",
        effort=results.effort.name,
    )
    claim = f"not computed: {_clause(error)}"
    return Fact("not_computed", claim, math.nan, "1", scope, "predict")


def static_numbers(static: StaticPair) -> tuple[Number, ...]:
    """Return the rows that need no motion. A number that cannot be computed is NaN."""
    mode = _mesh_mode(static)
    frequency = math.nan if mode is None else mode.natural_frequency
    return (
        Number("static_force", "Static mesh force, torque / base radius", static.mesh_force, "N"),
        Number("static_peak_to_peak", "Static transmission error, peak to peak", static.peak_to_peak, "m"),
        Number("static_tooth_load", "Largest static load on one tooth / mesh force", static.tooth_load, "1"),
        Number("loaded_pairs", "Mean number of tooth pairs under load", static.loaded_pairs, "1"),
        Number("mesh_stiffness", "Mean mesh stiffness", static.mesh_stiffness, "N/m"),
        Number("static_efficiency", "Mesh efficiency without vibration", static.efficiency, "%"),
        Number("mesh_mode", "Natural frequency of the mesh mode", frequency, "Hz", note=_torque_note(static)),
        _resonance_row(static),
    )


def _mesh_mode(static: StaticPair) -> Mode | None:
    """The mode in which the teeth move most against the bearings. None: there are no modes."""
    of_the_mesh = [mode for mode in static.modes if mode_name(mode) == "mesh mode"]
    return max(of_the_mesh or static.modes, key=lambda mode: mode.natural_frequency, default=None)


def _torque_note(static: StaticPair) -> str:
    """Words on the torque of the modes; empty: the torque of the pair."""
    torque = static.largest_torque
    if torque == static.pair.operating.pinion_torque or math.isnan(torque):
        return ""
    return f"under {quantity(torque, 'N m', 3)}, the largest torque with a motion"


def _resonance_row(static: StaticPair) -> Number:
    """Distance to the nearest speed at which a mesh order meets a natural frequency."""
    label = "Distance to the nearest resonance"
    speed = static.pair.operating.pinion_speed * 30.0 / math.pi
    crossings = [
        (mode.resonant_speed / order, order, mode) for mode in static.modes for order in range(1, ORDERS + 1)
    ]
    if not crossings:
        return Number("resonance", label, math.nan, "rpm")
    nearest, order, mode = min(crossings, key=lambda crossing: abs(math.log(crossing[0] / speed)))
    note = f"order {order} meets the {mode_name(mode)} ({mode.natural_frequency:.0f} Hz) at {rpm(nearest)}"
    return Number("resonance", label, nearest - speed, "rpm", note=note)


def actions_without_motion(results: Results, error: NumericalError) -> tuple[Action, ...]:
    """Return what to change so that a motion can be computed."""
    static = results.static
    command = f"spurcheck report {results.name}"
    actions: list[Action] = []
    if isinstance(error, BeyondFlanksError):
        geometry = results.pair.geometry
        undercut = [name for name in ("pinion", "gear") if getattr(geometry, f"undercut_{name}") > 0.0]
        actions += [
            Action(f"Raise the profile shift: the {name} is undercut", f"{name}.profile_shift", "")
            for name in undercut
        ]
        torque = static.largest_torque
        if math.isfinite(torque) and torque < static.pair.operating.pinion_torque:
            limit = _rounded_down(torque)
            text = f"Take {quantity(limit, 'N m', 3)} or less: under this torque the pair has a motion"
            actions.append(Action(text, f'{command} --torque "{limit:g} N m"', ""))
        actions.append(Action("Take wider teeth or a larger module", "spurcheck init", ""))
    elif isinstance(error, SlowPairError):
        fastest = max((mode.natural_frequency for mode in static.modes), default=math.nan)
        if math.isfinite(fastest):
            words = quantity(fastest, "Hz", 3)
            text = f"Check the stiffness of the bearings: the fastest mode of the pair is at {words}"
            actions.append(Action(text, "bearings.stiffness", ""))
        actions.append(Action("Read the curves of slow rolling", "chapter “At rest”", ""))
    else:
        actions.append(Action("Raise the damping, or change the speed", "mesh.damping_ratio", ""))
    return tuple(actions[:3])


def _rounded_down(value: float) -> float:
    """A positive value rounded down to two digits."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return float(number(math.floor(value / unit + 1e-9) * unit, 2))
