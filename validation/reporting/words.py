"""What several chapters and the first lines of the report say about the shared results."""

from __future__ import annotations

import numpy as np
import xarray as xr

from lumped import GearPair
from validation.cross_check.verdict import Verdict
from validation.reporting.blocks import Text
from validation.reporting.cross_check_words import cause_of_difference, failed_checks, whole_difference
from validation.reporting.formatting import digits, number, quantity
from validation.reporting.results import ContactLoss, Results
from validation.validity.four_springs import LIMITS, FourSprings

#: Largest difference of the transmission error from exact contact, over its peak to peak, that the first
#: words pass over.
_CONTACT_LIMIT = 0.1


def headline(results: Results) -> str:
    """The first words of the report: whether the prediction can be relied on, and every reason against it."""
    if wrong := objections(results):
        return f"Do not rely on this prediction: {'; '.join(wrong)}."
    here = f"At {results.operating_rpm:.5g} rpm and {number(results.pair.operating.pinion_torque)} N m"
    if off := contact_off(results):
        return f"{here} the equations are solved right, but {off}."
    near = [f"“{flag.name.lower()}” is near its limit" for flag in results.flags if flag.state == "warning"]
    near += ["check the values named below"] if results.doubts else []
    care = f"{', with care: ' if near else ''}{'; '.join(near)}"
    if confirmed_contact_loss(results):
        return (
            f"{here} contact is lost: the linear model does not hold, its equations with unilateral contact "
            f"do{care}."
        )
    return f"{here} the prediction holds{care}."


def confirmed_contact_loss(results: Results) -> ContactLoss | None:
    """The motion with contact loss, where the cross-check compares it and does not fail."""
    found = results.contact_loss
    judged = isinstance(found, ContactLoss) and found.judged and results.check.verdict is not Verdict.FAILS
    return found if judged and isinstance(found, ContactLoss) else None


def contact_off(results: Results) -> str:
    """How the transmission error changes with contact that follows the load; empty where that is little."""
    forms = results.forms
    if isinstance(forms, str) or forms.difference[forms.own] <= _CONTACT_LIMIT:
        return ""
    if found := confirmed_contact_loss(results):
        follows = forms.spans(results.geometry.mesh_period)["exact"]
        low, high = found.orbit.dte_range
        if abs(high - low - follows) <= _CONTACT_LIMIT * follows:
            return ""
        return (
            f"with contact that follows the load the transmission error is {quantity(follows, 'm', 3)} peak "
            f"to peak, not {quantity(high - low, 'm', 3)}"
        )
    reason = "their contact is too simple: with contact that follows the load"
    right = forms.spans(results.geometry.mesh_period)["exact"]
    if (pushing := lifting(results)) is not None:
        reason = "one tooth pair lifts off while another carries: with unilateral contact of each pair"
        right = pushing.attrs["dte_peak_to_peak"]
    most = number(100 * forms.difference[forms.own], 2)
    return (
        f"{reason} the transmission error is {quantity(right, 'm', 3)} peak to peak, not {span(results)}, "
        f"and in between up to {most}\u00a0% of that off"
    )


def lifting(results: Results) -> xr.Dataset | None:
    """The motion with unilateral contact, where loaded contact is off because it lets one pair pull."""
    motion, forms = results.lifting, results.forms
    return None if motion is None or isinstance(forms, str) or forms.off(motion) > _CONTACT_LIMIT else motion


def sentence(results: Results) -> str:
    """The report in one paragraph: the first words, then what the model predicts and why that may be used."""
    told = (headline, motion, agreement, stability, validity)
    return " ".join(one(results) for one in told)


def motion(results: Results) -> str:
    """What the model computes, in the digits that its sampling allows."""
    if found := confirmed_contact_loss(results):
        return f"{with_loss_of_contact(results, found)}{ignored_relief(results.pair)}"
    load, error = largest_load(results)
    factor = number(load / results.static_load, digits(error / load), measured=True)
    numbers = (
        f"transmission error {span(results)} peak to peak, tooth load up to {factor} times the static load, "
        f"{efficiency(results)}."
    )
    numbers += ignored_relief(results.pair)
    if objections(results):
        told = f"Computed, but not what a gear pair would show: {numbers}"
        return f"{told} {with_unilateral_contact(results) if pulls(results) else ''}".rstrip() + on_shafts(
            results
        )
    return numbers[0].upper() + numbers[1:]


def with_loss_of_contact(results: Results, found: ContactLoss) -> str:
    """What the equations with unilateral contact give."""
    low, high = found.orbit.dte_range
    driving = results.pair.operating.pinion_torque * results.geometry.omega_pinion
    lost = -float(found.orbit.motion["friction_power"].sum("pair").mean()) / driving
    return (
        f"With unilateral contact: transmission error {quantity(high - low, 'm', 3)} peak to "
        f"peak, tooth load up to {number(found.orbit.largest_load / results.static_load, 3)} times the "
        f"static load, {number(100 * lost, 2)}\u00a0% of the power lost in sliding. The linear model, with "
        f"negative tooth loads, gives {span(results)}."
    )


def jumps(results: Results) -> str:
    """At which speeds the pair jumps to another motion, and between which; where no motion repeats.

    Empty where nothing is known.
    """
    found = results.branches
    if found is None or isinstance(found, str):
        return ""
    low, high = (f"{rpm:.0f}" for rpm in found.speeds_rpm)
    gaps = ", ".join(f"{number(a, 4)} to {number(b, 4)}" for a, b in found.gaps)
    restless = (
        f" No stable motion that repeats after a few mesh cycles was found at {gaps}\u00a0rpm: there it "
        "beats, is chaotic or comes to a motion apart from these."
        if gaps
        else ""
    )
    if not found.jumps:
        return (
            f"From {low} to {high} rpm no jump was found on the motions that continue the linear one; "
            f"motions apart from them were not looked for.{restless}"
        )
    most = max(
        found.jumps, key=lambda jump: np.nan_to_num(abs(jump.dte_rms_after - jump.dte_rms), nan=np.inf)
    )
    more = f" (the largest of {len(found.jumps)} jumps)" if len(found.jumps) > 1 else ""
    grows = not np.isfinite(most.dte_rms_after)
    after = "beyond the backlash" if grows else f"to {quantity(most.dte_rms_after, 'm', 3)}"
    return (
        f"From {low} to {high} rpm it jumps at {number(most.speed_rpm, 4)} rpm on running "
        f"{'up' if most.rising else 'down'}, from {quantity(most.dte_rms, 'm', 3)} {after} root mean square"
        f"{more}.{restless}"
    )


def on_shafts(results: Results) -> str:
    """The transmission error on shafts, where four springs do not stand for them; else nothing."""
    found = results.four_springs
    if not isinstance(found, FourSprings) or found.off_here("springs") <= LIMITS[1]:
        return ""
    span = found.here("shafts", "dte")
    return f" On its shafts: {quantity(span, 'm', 3)} peak to peak." if np.isfinite(span) else ""


def pulls(results: Results) -> bool:
    """Whether the linear motion at the operating point has negative tooth loads."""
    return any(flag.key == "contact_loss" and flag.state != "ok" for flag in results.flags)


def with_unilateral_contact(results: Results) -> str:
    """What the pair does where the linear motion has negative tooth loads; empty where it has none."""
    found = results.contact_loss
    if found is None or isinstance(found, str):
        return ""
    low, high = found.orbit.dte_range
    off = abs(high - low - found.exact_peak_to_peak) / found.exact_peak_to_peak
    return (
        f"With unilateral contact the same equations give {quantity(high - low, 'm', 3)} peak to "
        f"peak, {number(100 * off, 2)}\u00a0% off the multibody model."
    )


def largest_load(results: Results) -> tuple[float, float]:
    """Largest normal load of a tooth pair in contact, and how much of it half the samples miss [N]."""
    loads = results.motion["normal_load"].where(results.motion["contact"] > 0)
    largest = float(loads.max())
    return largest, largest - float(loads[..., ::2].max())


def ignored_relief(pair: GearPair) -> str:
    """Sentence that relief is given and left out; nothing where it is not so."""
    given = any(
        r is not None for gear in (pair.pinion, pair.gear) for r in (gear.tip_relief, gear.root_relief)
    )
    if pair.mesh.relief == "static" or not given:
        return ""
    return " The relief of the flanks is given but ignored: everything here holds for involutes."


def span(results: Results) -> str:
    """Peak to peak of the transmission error, in digits that its error allows."""
    attrs = results.motion.attrs
    certain = digits(float(attrs["error_estimate"]))
    return quantity(attrs["dte_peak_to_peak"], "m", certain, measured=True)


def efficiency(results: Results) -> str:
    """Loss of the mesh in percent; none where a conservation law does not hold."""
    if not lawful(results):
        return f"no mesh efficiency, because {unlawful(results)}"
    attrs = results.motion.attrs
    if results.pair.mesh.contact == "loaded":
        return f"mesh efficiency {100 * float(attrs['mesh_efficiency']):.2f}\u00a0%, all losses counted"
    driving = results.pair.operating.pinion_torque * results.geometry.omega_pinion
    return f"{number(100 * float(attrs['power_sliding']) / driving, 2)}\u00a0% of the power lost in sliding"


def agreement(results: Results) -> str:
    """Whether the multibody model agrees, by how much it differs, and the effect that explains most."""
    check = results.check
    if check.verdict is Verdict.FAILS:
        return f"A check of the program fails: {failed_checks(check)}."
    if check.verdict is Verdict.NOT_CHECKED:
        return "A second, independent model has no periodic motion near this one that could be compared."
    same = "with the same contact " if check.pair.mesh.contact == "prescribed" else ""
    told = f"A second, independent model {same}{check.verdict}. {whole_difference(check)}"
    if check.verdict is Verdict.DIFFERS:
        told = f"{told} {cause_of_difference(check, results.attribution)}".rstrip()
    return f"{told} {contact_form(results)}".rstrip() if same else told


def contact_form(results: Results) -> str:
    """How far the form of the contact is off the exact one; empty where the exact contact has no motion."""
    forms = results.forms
    if isinstance(forms, str):
        return ""
    spans = forms.spans(results.geometry.mesh_period)
    off = {name: number(100 * value, 2) for name, value in forms.difference.items()}
    told = {name: quantity(value, "m", 3) for name, value in spans.items()}
    if forms.own == "loaded":
        return (
            "The contact follows the load: this form is off the exact contact by up to "
            f"{off['loaded']}\u00a0% of the transmission error's peak to peak, prescribed contact by "
            f"{off['prescribed']}\u00a0%."
        )
    powers = forms.powers["prescribed"]
    return (
        f"Exact contact, from gaps and an elastic energy, gives {told['exact']} peak to peak. Prescribed "
        f"contact is off it by up to {off['prescribed']}\u00a0% of that, with an energy residual of "
        f"{quantity(powers.energy_residual, 'W', 3)} ({quantity(powers.driving, 'W', 3)} input); loaded "
        f"contact gives {told['loaded']} and is off by up to {off['loaded']}\u00a0%."
    )


def stability(results: Results) -> str:
    """Whether the motion is stable here, and at which other speeds."""
    if loss := confirmed_contact_loss(results):
        left = number(100 * loss.orbit.spectral_radius, 2)
        return (
            f"A disturbance of this motion fades to {left}\u00a0% in a mesh cycle. {jumps(results)}".rstrip()
        )
    found = results.multipliers
    radius, certain = found.spectral_radius, digits(found.error / found.spectral_radius)
    left = number(100 * radius, min(certain, 2))
    here = {
        "stable": f"A disturbance of this motion fades to {left}\u00a0% in a mesh cycle",
        "unstable": f"A disturbance of this motion grows {number(radius, certain)} times in a mesh cycle",
    }.get(found.verdict, "Whether a disturbance of this motion fades cannot be decided")
    over = f"{here}; the computed motion is stable {stable_speeds(results)}."
    return f"{over} {jumps(results)}".rstrip()


def lawful(results: Results) -> bool:
    """Whether the conservation laws hold in both models, and their powers agree."""
    return all(j.within for j in results.check.conservation)


def unlawful(results: Results) -> str:
    """What of ``lawful`` does not hold."""
    broken = [j.check for j in results.check.conservation if not j.within]
    if all(check.startswith("conservation: power ") for check in broken):
        return "the powers of both models differ"
    return "a conservation law does not hold"


def objections(results: Results) -> list[str]:
    """Reasons why a gear pair would not show the predicted motion."""
    verdict, parts = results.multipliers.verdict, confirmed_contact_loss(results)
    if parts:  # the motion of the linear model is not the one that is predicted
        verdict = "stable"
    found = [] if verdict == "stable" else [f"the periodic motion is {verdict}, so a pair would leave it"]
    found += [
        f"the assumption “{flag.name.lower()}” is violated"
        for flag in results.flags
        if flag.state == "violated" and flag.key not in ("stability", *(["contact_loss"] if parts else []))
    ]
    failed = [check.key for check in results.checks if not check.passes]
    if failed:
        found.insert(0, f"checks of the models fail ({', '.join(failed)})")
    if results.check.verdict is Verdict.FAILS:
        found.insert(0, "the cross-check of the program fails")
    return found


def cautions(results: Results) -> tuple[Text, ...]:
    """What a chapter on the periodic motion says first where that motion is not to be relied on."""
    stability, check, found = results.multipliers, results.check, []
    if confirmed_contact_loss(results):
        found.append(
            "The numbers of the linear model in this chapter are those of negative tooth loads. What the "
            "pair does is in the chapter “Contact loss”."
        )
    elif stability.verdict != "stable":
        found.append(
            f"Warning: the periodic motion at the operating point is {stability.verdict} (largest multiplier "
            f"{stability.spectral_radius:.4g}). What follows is a solution of the equations that a gear pair "
            "leaves at the smallest disturbance: not a prediction of what it does."
        )
    if check.verdict is Verdict.FAILS:
        found.append(
            "Warning: do not rely on the numbers of this chapter. The cross-check of the program fails: "
            f"{failed_checks(check)}."
        )
    return tuple(map(Text, found))


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
    """Which assumptions hold here, and over how much of the speed range contact holds."""
    states = {"warning": "near its limit", "violated": "violated"}
    raised = [f"{flag.name.lower()} ({states[flag.state]})" for flag in results.flags if flag.state != "ok"]
    if contact_off(results):
        raised.append(
            "no tooth pair lifts off alone (one does)"
            if lifting(results) is not None
            else "the contact follows the load (it does not)"
        )
    text = f"Of {len(results.flags) + 1} checked assumptions "
    text += f"all hold but: {', '.join(raised)}" if raised else "all hold here"
    share, (low, high) = results.separating_share, results.margins.speed_range
    if not share:
        return f"{text}."
    return (
        f"{text}; from {low:.0f} to {high:.0f} rpm contact is lost at {100 * share:.2g}\u00a0% of the "
        "speeds, where the linear model does not hold."
    )
