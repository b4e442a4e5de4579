"""What several chapters and the first lines of the report say about the shared results."""

from __future__ import annotations

from validation.cross_check.comparison import CrossCheck
from validation.reporting.blocks import Text
from validation.reporting.formatting import number, quantity
from validation.reporting.results import Results

#: Short names of the quantities that the models are compared by.
NAMES = {
    "dte": "transmission error",
    "x_p": "pinion x",
    "x_g": "gear x",
    "y_p": "pinion y",
    "y_g": "gear y",
    "normal_load": "normal load",
    "friction_force": "friction force",
}


def sentence(results: Results) -> str:
    """The report in one paragraph: what is wrong comes first."""
    wrong = objections(results)
    return (
        (f"Do not rely on this prediction: {'; '.join(wrong)}. " if wrong else "")
        + f"At {results.operating_rpm:.5g} rpm and {results.pair.operating.pinion_torque:.4g} N m the lumped "
        f"model {'computes' if wrong else 'predicts'} a transmission error of {span(results)} peak to peak"
        f" and {efficiency(results)}. {_agreement(results.check)} The motion is "
        f"{_stability(results)} {validity(results)} {contact_form(results)}".rstrip()
    )


def span(results: Results) -> str:
    """Peak to peak of the transmission error."""
    return quantity(results.motion.attrs["dte_peak_to_peak"], "m", 3)


def efficiency(results: Results) -> str:
    """Mesh efficiency in percent; in the paper's form its sliding loss and what it leaves unpaid."""
    if not lawful(results):
        return "no mesh efficiency, because a law of nature does not hold"
    attrs = results.motion.attrs
    if results.pair.mesh.contact == "loaded":
        return f"a mesh efficiency of {100 * float(attrs['mesh_efficiency']):.2f}\u00a0%, all losses counted"
    driving = results.pair.operating.pinion_torque * results.geometry.omega_pinion
    lost = 100 * float(attrs["power_sliding"]) / driving
    unpaid = quantity(float(attrs["power_unpaid"]), "W", 2)
    return (
        f"a sliding loss of {lost:.2f}\u00a0% of the input; {unpaid} of what its bearings and tooth "
        "dampers take is unpaid"
    )


def contact_form(results: Results) -> str:
    """How far the form of the contact is off the exact one, and what the other form gives."""
    forms = results.forms
    if isinstance(forms, str):
        return ""
    spans = forms.spans(results.geometry.mesh_period)
    off = {name: number(100 * value, 2) for name, value in forms.difference.items()}
    told = {name: quantity(value, "m", 3) for name, value in spans.items()}
    if forms.own == "loaded":
        return (
            "The contact follows the load: this form is off the exact contact by up to "
            f"{off['loaded']}\u00a0% of the transmission error's peak to peak, the paper's form by "
            f"{off['paper']}\u00a0%."
        )
    return (
        "The paper's contact, which begins by decree, is off the exact contact "
        f"({told['exact']} peak to peak) by up to {off['paper']}\u00a0% of that; for the same pair the "
        f"loaded form gives {told['loaded']} and is off by {off['loaded']}\u00a0%."
    )


def lawful(results: Results) -> bool:
    """Whether the laws of nature hold in both models."""
    return all(j.within for j in results.check.nature)


def objections(results: Results) -> list[str]:
    """Reasons why a gear pair would not show the predicted motion."""
    verdict = results.multipliers.verdict
    found = [] if verdict == "stable" else [f"the periodic motion is {verdict}, so a pair would leave it"]
    found += [
        f"the assumption “{flag.name.lower()}” is violated"
        for flag in results.flags
        if flag.state == "violated" and flag.key != "stability"
    ]
    failed = [check.key for check in results.checks if not check.passes]
    if failed:
        found.insert(0, f"checks of the models fail ({', '.join(failed)})")
    if results.check.verdict == "not confirmed":
        found.insert(0, "the cross-check does not confirm it")
    return found


def cautions(results: Results) -> tuple[Text, ...]:
    """What a chapter on the periodic motion says first where that motion is not to be relied on."""
    stability, check, found = results.multipliers, results.check, []
    if stability.verdict != "stable":
        found.append(
            f"Warning: the periodic motion at the operating point is {stability.verdict} (largest multiplier "
            f"{stability.spectral_radius:.4g}). What follows is a solution of the equations that a gear pair "
            "leaves at the smallest disturbance: not a prediction of what it does."
        )
    if check.verdict == "not confirmed":
        found.append(
            "Warning: do not rely on the numbers of this chapter. The cross-check does not confirm the "
            f"model: {failed_checks(check)}."
        )
    return tuple(map(Text, found))


def _stability(results: Results) -> str:
    verdict = results.multipliers.verdict
    here = "stable here and" if verdict == "stable" else f"{verdict} here and stable"
    routes = results.routes
    doubt = "" if isinstance(routes, str) or routes.agree else ", which a second route does not confirm"
    return f"{here} {stable_speeds(results)}{doubt}."


def stable_speeds(results: Results) -> str:
    """At which speeds of the range the motion is stable."""
    low, high = results.margins.speed_range
    reach = f"at all speeds from {low:.0f} to {high:.0f} rpm"
    unstable, above = results.margins.unstable_here, results.margins.unstable_above
    if not unstable.size:
        return (
            reach if above is None else f"{reach} (the first unstable speeds above: from {above:.5g} rpm on)"
        )
    ranges = ", ".join(f"{a:.5g} to {b:.5g} rpm" for a, b in unstable[:3])
    more = f" and {len(unstable) - 3} more ranges" if len(unstable) > 3 else ""
    return f"{reach} but {ranges}{more}"


def validity(results: Results) -> str:
    """Which assumptions hold here, and over how much of the speed range teeth stay in contact."""
    raised = [flag for flag in results.flags if flag.state != "ok"]
    words = {"warning": "near a limit", "violated": "violated"}
    text = "The model's assumptions hold here"
    if raised:
        listed = (f"{flag.name.lower()} ({words[flag.state]})" for flag in raised)
        text = f"Of the model's assumptions, these are in question here: {', '.join(listed)}"
    share, (low, high) = results.separating_share, results.margins.speed_range
    if not share:
        return f"{text}."
    return (
        f"{text}; at {100 * share:.2g} % of the speeds from {low:.0f} to {high:.0f} rpm teeth would "
        "separate, and neither motion nor stability there is as computed."
    )


def _agreement(check: CrossCheck) -> str:
    if check.verdict == "not confirmed":
        return f"The cross-check does not confirm it: {failed_checks(check)}."
    confirms = {
        "confirmed": "confirms it",
        "explained": "shows a larger difference than expected, which finite motions account for",
    }[check.verdict]
    same = " with the same contact" if check.pair.mesh.contact == "paper" else ""
    return f"The independent multibody model{same} {confirms}. {finite_motions(check)}"


def failed_checks(check: CrossCheck, most: int = 3) -> str:
    """The first checks that fail, with value and limit."""
    failed = check.failures
    told = [f"{j.check} {number(j.value, 2)}, limit {number(j.limit, 2)}" for j in failed[:most]]
    more = [f"and {len(failed) - most} more"] if len(failed) > most else []
    return "; ".join(told + more)


def same_equations(check: CrossCheck) -> str:
    """How well the multibody model agrees when it holds the equations of the lumped model."""
    worst = check.worst("linear")
    verb = "agrees" if worst.within else "does not agree"
    return (
        f"With the same equations the multibody model {verb}: {NAMES[worst.quantity]} to "
        f"{number(worst.judged, 2)} of its peak to peak, tolerance {number(worst.tolerance.limit, 2)}."
    )


def finite_motions(check: CrossCheck) -> str:
    """How much the exact model differs, in the transmission error and in whatever differs most.

    The text also says how much of the difference follows from the lumped motion. A difference is stated
    whatever the verdict is: also one that is understood, and so within its tolerance.
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
