"""Every number in the sentences of the report, and of page 1 as printed, against the numbers they are of."""

import copy
import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import lumped
from lumped.losses import losses_of_laws
from lumped.schema.pair import field_values
from tests.unlike_pairs import known_sizes
from tests.validation.reporting import recomputed
from tests.validation.reporting.columns import recomputes
from tests.validation.reporting.test_numbers import motions_of, nearest_hazard, of_motion, pair_of
from tests.validation.reporting.written import SMALL, known, pair, plain
from validation.exchange import new_pair
from validation.files.formatting import prose, read_table
from validation.prediction.inputs import kind_of
from validation.prediction.motion import Motion
from validation.prediction.uncertainty import LONG_STEP, _peaks
from validation.reporting.blocks import Badge
from validation.reporting.build import findings
from validation.reporting.chapters import contact_loss, inputs, second_program, stability
from validation.reporting.effort import QUICK
from validation.reporting.first_figures import plain_name
from validation.reporting.hazards import Hazard
from validation.reporting.page_one import _remark, page_one
from validation.reporting.results import SHORT, Results
from validation.reporting.second_program_words import second_program_words
from validation.reporting.verdict import Verdict

_ADVICE = read_table("validation.reporting", "advice.toml")
#: Numbers of page 1 that have a range, in a sentence.
RANGED = {
    "dte_peak_to_peak": "transmission error", "dynamic_factor": "dynamic factor",
    "tooth_load": "largest tooth load", "bearing_rms": "bearing force", "efficiency": "efficiency",
}  # fmt: skip


def speed_of(written):
    return written.parameters["operating"]["pinion_speed"], "rpm"


def inputs_of(written):
    """Numbers of inputs that are given and assumed."""
    states = [one["state"] for one in written.table("parameters")]
    return str(states.count("")), str(len(states) - states.count("") - states.count("not read"))


def test_page_1_prints_the_numbers(written):
    """Two digits where the range is wider than a tenth of the result, else three; per cent are times 100."""
    shown = written.printed["numbers"]
    assert shown.headings == [
        f"At {speed_of(written)[0]:g} rpm, {written.parameters['operating']['pinion_torque']:g} N m",
        "result",
        "5 to 95 %",
        "second program",
    ]
    for (key, number), (label, value, spread, second) in zip(
        written.document["numbers"].items(), shown.rows, strict=True
    ):
        samples = written.data("uncertainty")
        middle = number["median"]
        if middle is not None:
            assert middle == pytest.approx(np.median(samples[key].to_numpy()))
            words = "median of the possible machines"
            label, _, median = label.rpartition(words)
            recomputed.assert_printed(median.strip(), (100.0 if number["unit"] == "%" else 1.0) * middle,
                               number["unit"], 2)  # fmt: skip
            label = label.rstrip("; ")
        if key in RANGED:
            below = np.mean(samples[key].to_numpy() < number["value"])
            assert (middle is None) == (0.2 <= below <= 0.8), key
        assert label == plain(f"{number['label']} {number['note']}")
        unit = number["unit"]
        times = 100.0 if number["unit"] == "%" else 1.0
        low, high = number["low"], number["high"]
        is_wide = low is not None and high - low > 0.1 * abs(number["value"])
        digits = 5 if unit == "rpm" else 4 if unit == "%" else 2 if is_wide else 3
        digits = 2 if key == "trouble" else digits
        if number["value"] is None:
            assert value == "none"
        elif unit != "rpm":
            recomputed.assert_printed(value, times * number["value"], unit, digits)
            shown_digits = re.sub(r"\D", "", value.partition(" ")[0]).lstrip("0")
            assert unit == "%" or "." not in value or len(shown_digits) <= digits
        else:
            assert value == f"{number['value']:+.0f} rpm"
        if low is None:
            assert spread == "–"
        else:
            if unit != "%":
                spread, share = re.fullmatch(r"(.+) \((.+) %\)", spread).groups()
                assert_relative(share, low / number["value"] - 1.0, high / number["value"] - 1.0)
            for shown_end, end in zip(ends_of(spread), (low, high), strict=True):
                recomputed.assert_printed(shown_end, times * end, unit, 3 if unit == "%" else digits)
        if number["second"] is None:
            assert second == "not computed"
        else:
            recomputed.assert_printed(second, times * number["second"], unit, 4 if unit == "%" else 3)


def ends_of(printed):
    """Both ends of a printed range, each with the unit that stands once: "0.9 to 1.6 µm"."""
    low, high = re.fullmatch(r"(\S+) to (.+)", printed).groups()
    _, _, unit = high.partition(" ")
    return f"{low} {unit}".strip(), high


def assert_relative(text, low, high):
    """A printed range relative to its result, "-20/+180", to two digits."""
    for shown, end in zip(text.split("/"), (low, high), strict=True):
        assert float(shown) == pytest.approx(100.0 * end, rel=0.051, abs=1e-9)
        assert shown[0] == ("-" if end < 0.0 else "+")


def test_the_title(written):
    p = written.parameters
    speed, _ = speed_of(written)
    recomputed.assert_says(
        plain(written.result.first.title),
        r"(\w+): spur gears (\d+)/(\d+), m ([\d.]+), b ([\d.]+) mm, (.*), ([\d.]+) N m \((.*)\)", p["name"],
        str(p["pinion"]["teeth"]), str(p["gear"]["teeth"]), f"{p['basic_rack']['module']:g}",
        f"{min(p['pinion']['face_width'], p['gear']['face_width']):g}", (speed, "rpm"),
        f"{p['operating']['pinion_torque']:g}", (recomputed.power(p), "W"),
    )  # fmt: skip


def test_the_verdict(written):
    verdict = written.document["verdict"]
    hazard = nearest_hazard(written)
    speed, _ = speed_of(written)
    headline = plain(verdict["headline"])
    reason = plain(verdict["reason"])
    if hazard is None:
        numbers = written.document["numbers"]
        ends = {
            name: np.percentile(written.data("uncertainty")[name].to_numpy(), [5.0, 95.0])
            / numbers[name]["value"] - 1.0
            for name in RANGED
        }  # fmt: skip
        widest = max(ends, key=lambda name: np.abs(ends[name]).max())
        assert np.abs(ends[widest]).max() > 0.10, "else another verdict"
        assert verdict["kind"] == "UNCERTAIN"
        pattern = r"Levels uncertain: transmission error (.+?) %\."
        names = ["dte_peak_to_peak"]
        if widest != "dte_peak_to_peak":
            names.append(widest)
            pattern = rf"Levels uncertain: transmission error (.+?) %, {RANGED[widest]} (.+?) %\."
        for text, name in zip(re.fullmatch(pattern, headline).groups(), names, strict=True):
            assert_relative(text, *ends[name])
        where = f"From {0.1 * speed:g} to {2.0 * speed:g} rpm"
        finding = "contact is kept, and no jump was found"
        assert reason.endswith(f"{where} no speed is unstable, and {finding}.")
        resonance = written.document["facts"]["resonance"]
        near = abs(resonance["value"] / speed) <= 0.05
        runs = resonance["claim"] if near else "contact is kept and the motion is stable"
        start = "The pair runs on a resonance: " if near else "The pair runs smoothly: "
        assert reason.startswith(plain(start + runs))
        return
    jump_rpm = hazard[0]
    one = min(
        (written.data(name).isel(jump=k) for name in motions_of(written)
         for k in range(written.data(name).sizes["jump"])),
        key=lambda jump: abs(float(jump["jump_speed_rpm"]) - jump_rpm),
    )  # fmt: skip
    apart = 100.0 * (speed / jump_rpm - 1.0)
    side = "above" if apart > 0.0 else "below"
    near = (
        f", {abs(apart):.0f} % {side} a jump"
        if abs(speed / jump_rpm - 1.0) > 0 and abs(jump_rpm / speed - 1) <= 0.05
        else ""
    )
    assert headline == f"Do not run here: the teeth lose contact{near}."
    recomputed.assert_says(
        reason,
        r"The mesh force falls to zero and rises to (.*) times its mean\. Running (\w+), the vibration "
        r"jumps at (.*) to (.*) times \(rms\)\.",
        (of_motion(written, "prediction")["dynamic_factor"], "1"),
        hazard[1],
        (jump_rpm, "rpm"),
        (float(one["jump_dte_rms_after"] / one["jump_dte_rms"]), "1"),
        digits=2,
    )


def test_the_actions(written):
    actions = written.document["actions"]
    samples = written.data("uncertainty")
    as_given = written.document["numbers"]["dte_peak_to_peak"]["value"]
    hazard = nearest_hazard(written)
    swing = samples["dte_peak_to_peak_swing"].to_numpy()
    width = np.abs(swing[:, 1] - swing[:, 0])
    gains = [plain(one["gain"]) for one in actions if one["gain"]]
    if hazard is not None:
        recomputed.assert_says(
            plain(actions[0]["text"]), r"Do not pass (.*) at this torque", (hazard[0], "rpm"), digits=5
        )
        assert actions[1]["command"] == f"spurcheck response {written.document['gear_pair']} --map"
    widths = []
    for gain in gains:
        low, high = ends_of(re.fullmatch(r"it moves the transmission error from (.*)", gain)[1])
        rounding = [
            0.051 * 10.0 ** np.floor(np.log10(v)) for v in (recomputed.read(low)[0], recomputed.read(high)[0])
        ]
        fits = (np.abs(swing.min(axis=1) - recomputed.read(low)[0]) <= rounding[0]) & (
            np.abs(swing.max(axis=1) - recomputed.read(high)[0]) <= rounding[1]
        )
        assert fits.any(), gain
        fields = [str(field) for field in samples["input"].to_numpy()[fits]]
        advised = next(one for one in actions if plain(one["gain"]) == gain)
        texts = {_ADVICE[kind_of(field)]["text"] for field in fields if kind_of(field) in _ADVICE}
        assert advised["text"] in texts | {"Narrow the range of this input"}
        widths.append(width[fits].max())
    assert all(one >= 0.05 * as_given for one in widths)
    assert widths == sorted(widths, reverse=True)
    if hazard is None and width.max() >= 0.05 * as_given:
        assert widths[0] == width.max(), "the input that matters most comes first"


def test_how_sure(written):
    solved, inputs, measured = map(plain, written.document["how_sure"])
    given_count, assumed_count = inputs_of(written)
    counted = f"Inputs: {assumed_count} of {int(given_count) + int(assumed_count)} inputs are assumed."
    attributes = written.data("uncertainty").attrs
    if linear := attributes["linear"]:  # the range is not of motions with unilateral contact alone
        taken = attributes["taken"]
        computed = attributes["taken"] - attributes["refused"]
        words = (
            f"The range is from {taken} possible machines; "
            f"in {linear} of {computed} the linear motion stands in."
        )
        counted = f"{counted} {words}"
    assert inputs == counted
    assert measured == "Compared with a measurement? No."
    assert solved == f"Solved right? {plain(written.sentences['second_program'])}"
    exact = [one for one in written.table("agreement") if one["fidelity"].startswith("exact")]
    assert all(one["difference"] <= one["limit"] for one in exact), "else the sentence of the next test"
    sentence = prose(solved.removeprefix("Solved right? "))
    assert sentence in " ".join(plain(written.page).split()), (
        "page 1 has no powers of ten as a computer writes them"
    )
    first = of_motion(written, "prediction")
    second = of_motion(written, "second_program")
    first["dte_peak_to_peak"] = written.document["numbers"]["dte_peak_to_peak"]["value"]
    second["dte_peak_to_peak"] = written.document["numbers"]["dte_peak_to_peak"]["second"]
    apart = {name: abs(second[name] / first[name] - 1.0) for name in first if name != "least_force"}
    most = max(apart, key=apart.__getitem__)
    unit = {"dte_peak_to_peak": "m", "bearing_rms": "N"}.get(most, "1")
    pattern = (
        rf"Yes: a second program agrees\. Of page 1 the {RANGED[most]} differs most, by (.*) %: "
        r"(.*) here, (.*) there\."
    )
    share, of_prediction, of_second = re.fullmatch(pattern, sentence).groups()
    recomputed.assert_printed(of_second, second[most], unit, 3)
    recomputed.assert_printed(of_prediction, first[most], unit, 3)
    recomputed.assert_printed(share, 100.0 * apart[most], "1", 2)


def test_where_the_second_program_differs(written):
    """The quantity that is farthest beyond its limit, that of the second program first."""
    results = copy.copy(known(written.document["gear_pair"]))
    beyond = [
        replace(one, limit=0.5 * one.difference, peak_to_peak_multibody=1.3 * one.peak_to_peak)
        if (one.quantity, one.fidelity) == ("y_p", "exact")
        else one
        for one in results.check.agreements
    ]
    size = np.ptp(written.data("prediction")["y_p"].to_numpy())
    vars(results)["check"] = replace(results.check, agreements=tuple(beyond))
    differences = {
        one["quantity"]: one["difference"] for one in written.table("agreement") if "exact" in one["fidelity"]
    }
    name = "pinion displacement off the line of action"
    recomputed.assert_says(
        plain(second_program_words(results)),
        r"In part\. A second program with exact contact does not confirm the (.*): (.*) here, (.*) there, "
        r"a difference of (.*) %\. Of page 1 the .*",
        name,
        *((factor * size, "m") for factor in (1.0, 1.3)),
        (100.0 * differences[name], "1"),
        digits=2,
    )


def test_the_remark(written):
    remark = plain(written.result.first.remark)
    if of_motion(written, "prediction")["least_force"] > 0.0:
        assert "linear model" not in remark
        return
    size = np.ptp(written.data("linear")["dte"].to_numpy())
    words = r"The linear model would give (.*)\. It lets teeth pull, so it is not used here\."
    recomputed.assert_says(remark, words, (size, "m"), digits=2)


class AboveAJump(Results):
    """A pair that runs 3 % above a jump."""

    @property
    def nearest_hazard(self):
        """The jump."""
        return Hazard(self.operating_rpm / 1.03, "jump", "running up")


def test_page_1_prints_what_differs_from_the_prediction(written):
    """Jump, linear model and second program, moved so far that none can stand for the prediction."""
    results = copy.copy(known(written.document["gear_pair"]))
    results.__class__ = AboveAJump
    size = results.prediction.peak_to_peak
    vars(results)["second"] = replace(results.second, peak_to_peak=1.7 * size)
    first = page_one(results)
    recomputed.assert_says(plain(first.numbers[0].second_shown), r"(.*)", (1.7 * size, "m"), digits=2)
    if results.contact_lost:
        assert plain(first.headline) == "Do not run here: the teeth lose contact, 3 % above a jump."
        vars(results)["linear"] = results.linear.assign_attrs(dte_peak_to_peak=2.3 * size)
        words = r"The linear model would give (.*)\. It lets teeth pull, so it is not used here\."
        recomputed.assert_says(plain(_remark(results)), words, (2.3 * size, "m"), digits=2)


def test_a_form_of_the_model_outside_the_range_is_named():
    """The range of the samples is moved so that one form of the budget lies below it, and one above."""
    results = copy.copy(known("calm"))
    budget = results.budget.copy(deep=True)
    size = results.prediction.peak_to_peak
    low, high = (size * (1.0 + end) for end in results.spread("dte_peak_to_peak"))
    row_of = {key: place for place, key in enumerate(map(str, budget["row"].to_numpy()))}
    budget["result"][row_of["contact"]] = 0.97 * low
    budget["result"][row_of["second"]] = 1.04 * high
    budget["result"][row_of["stiffness"]] = 0.5 * (low + high)
    vars(results)["budget"] = budget
    recomputed.assert_says(
        plain(_remark(results)),
        r"Outside this range of the transmission error: contact prescribed from A to D, (.*); "
        r"second program, (.*)\.", (0.97 * low, "m"), (1.04 * high, "m"),
    )  # fmt: skip


@recomputes("claims", claim="claim", scope="scope", computed_by="by")
def test_the_claims(written):
    """Each fact of report.json, and its row in the table of claims, against the saved data."""
    facts = written.document["facts"]
    table = written.table("claims")
    assert [plain(one["claim"]).lower() for one in table] == [
        f"{plain(one['claim'])}.".lower() for one in facts.values()
    ]
    assert [one["computed_by"] for one in table] == [one["computed_by"] for one in facts.values()]
    for one, fact in zip(table, facts.values(), strict=True):
        scope = fact["scope"]
        words = (scope["motion"], scope["supports"], f"teeth {scope['teeth']}", f"inputs {scope['inputs']}")
        speeds = [plain(f"{end:.5g}") for end in scope["speeds_rpm"]]
        start = f"at {speeds[0]} rpm" if speeds[0] == speeds[1] else f"from {speeds[0]} to {speeds[1]} rpm"
        assert plain(one["scope"]) == "; ".join([start, *words, scope["effort"]])
    speed, _ = speed_of(written)
    lost = of_motion(written, "prediction")["least_force"] == 0.0
    assert facts["contact"]["claim"] == ("the teeth lose contact" if lost else "contact is kept")
    operating_only = [speed, speed]
    over = [0.1 * speed, 2.0 * speed]
    for key, one in facts.items():
        scope = one["scope"]
        assert scope["effort"] == "small report"
        assert (scope["supports"], scope["teeth"]) == ("springs", "alike")
        over_range = key in ("unstable_speeds", "jumps", "resonance")
        assert scope["speeds_rpm"] == pytest.approx(over if over_range else operating_only)
    samples = written.data("uncertainty")
    unloaded = int((samples["least_force"].to_numpy() <= 0.0).sum())
    count = samples.sizes["sample"]
    unstable = int(samples.attrs["unstable"])
    words = [f"{unloaded} of {count} possible machines lose contact"] if unloaded else []
    words += [f"{unstable} of {count} are unstable"] if unstable else []
    none = f"none of {count} possible machines loses contact or is unstable"
    assert facts["trouble"]["claim"] == (" and ".join(words) or none)
    if not unstable:
        assert facts["trouble"]["value"] == pytest.approx(unloaded / count)
    order, share, side, hertz = re.fullmatch(
        r"order (\d+) is ([\d.]+) % (above|below) the .* \((\d+) Hz\)", plain(facts["resonance"]["claim"])
    ).groups()
    frequencies = [one["frequency"]["value"] for one in written.table("modes")]
    frequency = min(frequencies, key=lambda one: abs(one - float(hertz)))
    assert abs(frequency - float(hertz)) < 0.51
    apart = int(order) * recomputed.mesh_frequency(written.parameters) / frequency - 1.0
    assert 100.0 * abs(apart) == pytest.approx(float(share), rel=0.06)
    assert side == ("above" if apart > 0.0 else "below")
    assert facts["resonance"]["value"] == pytest.approx(speed / (1.0 + apart) - speed)


def test_the_windows_of_contact_loss(written):
    """Windows that were searched: the ranges of the saved motions."""
    text = plain(written.sentences["contact_loss"])
    _, _, after_lost_at = text.partition("lost at")
    shown = re.findall(r"([\d.]+) to ([\d.]+)(?= rpm;| and)", after_lost_at)
    ranges = [written.data(name).attrs for name in motions_of(written)]
    for one in ranges:
        ends = one["speed_low_rpm"], one["speed_high_rpm"]
        assert any(tuple(map(float, two)) == pytest.approx(ends, rel=1e-4) for two in shown), (ends, text)


def test_forms_outside_the_range_are_named_and_no_others(written):
    first = written.document["numbers"]["dte_peak_to_peak"]
    budget = written.data("budget")
    if of_motion(written, "prediction")["least_force"] == 0.0:
        return
    remark = plain(written.result.first.remark)
    for form, size in zip(budget.attrs["forms"].split("; "), budget["result"].to_numpy(), strict=True):
        if form and np.isfinite(size):
            outside = not first["low"] <= size <= first["high"]
            assert (f"{form}, " in remark) == outside
            if outside:
                _, _, after_form = remark.partition(f"{form}, ")
                recomputed.assert_printed(after_form.partition(" µm")[0] + " µm", size, "m", 3)


def test_findings(written):
    first = of_motion(written, "prediction")
    lost = first["least_force"] == 0.0
    assert written.document["findings"] == (["contact", "holds"] if lost else [])


def test_the_sentences_of_response_forces_and_contact_loss(written):
    sentences = written.sentences
    first = of_motion(written, "prediction")
    speed, _ = speed_of(written)
    size = recomputed.amplitudes(written.data("prediction")["dte"].to_numpy())
    recomputed.assert_says(
        plain(sentences["response"]),
        r"The prediction is (.*); its transmission error is (.*) peak to peak, most of it at mesh order "
        r"(\d+)\.",
        known(written.document["gear_pair"]).prediction.motion.value,
        (written.document["numbers"]["dte_peak_to_peak"]["value"], "m"),
        str(int(np.argmax(size)) + 1),
    )
    recomputed.assert_says(
        plain(sentences["forces"]),
        r"The largest mesh force is (.*) times the mean (.*); one tooth pair carries at most (.*) times "
        r"the mean force\.",
        (first["dynamic_factor"], "1"),
        (written.data("prediction")["normal_load"].sum("pair").mean().item(), "N"),
        (first["tooth_load"], "1"),
    )
    if nearest_hazard(written) is None:
        pattern = r"Contact is never lost from (.*) to (.*) rpm\."
        count = []
    else:
        pattern = (
            r"Contact is lost at the operating point\. From (.*) to (.*) rpm contact can be lost at .* rpm; "
            r"there (.*) found\."
        )
        jumps = sum(written.data(name).sizes["jump"] for name in motions_of(written))
        count = ["one jump was" if jumps == 1 else f"{jumps} jumps were"]
    recomputed.assert_says(
        plain(sentences["contact_loss"]), pattern, (0.1 * speed, "1"), (2.0 * speed, "1"), *count, digits=5
    )


def test_the_sentences_of_stability_losses_and_inputs(written):
    sentences = written.sentences
    speed, _ = speed_of(written)
    _, _, after_first_part = plain(sentences["stability"]).partition("; ")
    recomputed.assert_says(
        after_first_part.partition(" unstable")[0],
        r"at the given damping no speed from (.*) to (.*) rpm is",
        (0.1 * speed, "1"),
        (2.0 * speed, "1"),
        digits=5,
    )
    assert written.data("linear").attrs["spectral_radius"] < 1.0
    assert "the linear motion is stable" in sentences["stability"]
    loss = 100.0 * (1.0 - losses_of_laws(pair_of(written))["mesh_efficiency"].to_numpy())
    supply = recomputed.power(written.parameters)
    recomputed.assert_says(
        plain(sentences["losses"]), r"The pair loses (.*) of (.*); sliding alone takes (.*) to (.*) % by the "
        r"different friction laws\.",
        ((1.0 - written.document["numbers"]["efficiency"]["value"]) * supply, "W"), (supply, "W"),
        (loss.min(), "1"), (loss.max(), "1"), digits=2,
    )  # fmt: skip
    samples = written.data("uncertainty")
    low, high = np.percentile(samples["dte_peak_to_peak"].to_numpy(), [5.0, 95.0])
    budget = [one for one in written.table("error_budget") if one["share"] is not None]
    own_errors = [
        one for one in budget if one["error"] not in ("linear model, for charts", "form of the contact")
    ]
    recomputed.assert_says(
        plain(sentences["how_sure"]),
        r"With its uncertain inputs the transmission error lies from (\S+) to (\S+) µm \(5 to 95 %\)\. "
        r"The largest error of the prediction is “(.*)”\.",
        (1e6 * low, "1"),
        (1e6 * high, "1"),
        max(own_errors, key=lambda one: one["share"])["error"],
        digits=2,
    )
    text = next(one[0] for one in written.document["chapters"]["how_sure"]["text"] if "Sobol" in one[0])
    lost = int((samples["least_force"].to_numpy() <= 0.0).sum())
    unstable = samples.attrs["unstable"]
    refused = samples.attrs["refused"]
    count = samples.sizes["sample"] + refused
    assert text.startswith(
        f"Possible machines are scrambled Sobol points, seed {samples.attrs['seed']}; "
        f"the range is from {count} "
    )
    assert (f"of which {refused} have no motion" in text) == (refused > 0)
    assert f". Contact is lost in {lost} of them, {unstable} are unstable" in text
    assert sentences["evidence"] == "Every check of the program passes."


def test_every_uncertain_input_has_words_of_its_own(written):
    names = [plain_name(str(field)) for field in written.data("uncertainty")["input"].to_numpy()]
    assert len(set(names)) == len(names)
    for field, name in zip(written.data("uncertainty")["input"].to_numpy(), names, strict=True):
        for gear in ("pinion", "gear"):
            if f".{gear}." in f".{field}." and "bearings" in str(field):
                assert name.startswith(gear)
        if "bearings" in str(field) and "loa" in str(field):
            assert name.endswith(f"{'off' if 'oloa' in str(field) else 'along'} the line of action")
    name = plain_name("shafts.pinion.bearings.0.loa_stiffness")
    assert name == "bearing 1 of the pinion shaft, stiffness along the line of action"
    assert lumped.load_gear_pair(written.parameters).name == written.document["gear_pair"]


def test_on_shafts_the_second_program_is_judged_on_the_shafts():
    """Agreement on springs says nothing about another machine: its numbers there are compared too."""
    reference = known("calm")
    results = Results(pair("shafts", "19/41", 1450.0, 80.0).with_(shafts_of(30, 2e8)), SMALL)
    like = reference.prediction
    vars(results) | {"check": reference.check}
    vars(results)["check"] = reference.check
    vars(results)["like"] = like
    for factor, words in ((1.1, "by 10 %"), (0.8, "by 20 %")):
        vars(results)["second"] = replace(like, peak_to_peak=factor * like.peak_to_peak)
        sentence = plain(second_program_words(results))
        assert sentence.startswith(
            "Yes: a second program agrees, on the springs of [bearings]. "
            f"Of page 1 the {SHORT['dte_peak_to_peak']} differs most, {words}: "
        )
        assert sentence.endswith(" there on the shafts.")


def test_a_pair_too_slow_for_the_second_program_has_a_report():
    """A mesh cycle of 607 swings of the fastest mode is refused there: nothing but that motion is missing."""
    results = Results(new_pair("16/32", 1.5, 12.8, 114, 12.2), SMALL)
    assert (
        second_program_words(results)
        == "Not checked: the second program does not run here; its chapter says why."
    )
    (why,) = second_program.write(results).blocks
    assert why.text.startswith("operating.pinion_speed = 114 rpm: allowed at least")
    assert (str(results.second), results.same_equations) == (str(results.check), None)
    assert results.samples == SMALL.samples // 2  # each costs much
    near = results.pair.with_({"operating.speed_range": [100.0, 130.0]})
    few = Results(
        near,
        replace(QUICK, sweep_speeds=9, chart_speeds=21, chart_dampings=5, jump_seconds=0.5, drawn_machines=0),
    )
    vars(few)["check"] = results.check
    first = page_one(few)  # bare discs swing: tenfold inertia leaves 1 %
    assert (first.verdict, "motor and brake" in first.actions[0].text) == (Verdict.OUTSIDE, True)
    sizes = lumped.speed_sweep(results.pair, [20.0, 114.0])["dte_peak_to_peak"].to_numpy()
    np.testing.assert_allclose(_peaks(results.pair, np.array([20.0, 114.0]), LONG_STEP), sizes, rtol=5e-4)


def shafts_of(diameter, stiffness):
    ends = [
        {"position": position, "loa_stiffness": stiffness, "oloa_stiffness": stiffness}
        for position in (10, 150)
    ]
    one = {"segments": [{"length": 160, "diameter": diameter}], "gear_position": 80, "bearings": ends}
    return {"shafts": {"damping_ratio": 0.03, "pinion": one, "gear": one}}


@cache
def _not_varied():
    """Results of the calm pair without samples of its inputs."""
    reference = known("calm")
    results = Results(reference.pair, replace(SMALL, samples=0))
    results.__dict__ |= {"check": reference.check, "chart": reference.chart}
    return results


#: Results of like teeth on springs; and those on the supports of the prediction.
_ON_SPRINGS = ("check", "chart", "sweep", "jump_search", "proven_stability")
_ON_SUPPORTS = ("like", "resonance")


def _of_the_motion(results):
    """Results that neither the sources of inputs nor their ranges enter, for a pair that differs in these."""
    return {name: getattr(results, name) for name in (*_ON_SPRINGS, *_ON_SUPPORTS)}


@pytest.mark.parametrize("words", ["Assumed", "a guess", "estimated"])
def test_words_of_a_source_make_no_absolute_level(words):
    """They were a source like a measurement: 0 values assumed, and usable for absolute levels."""
    less = _not_varied()
    reworded = Results(
        less.pair.with_({"sources": dict.fromkeys((*field_values(less.pair), "mesh.stiffness"), words)}),
        less.effort,
    )
    vars(reworded).update(_of_the_motion(less))
    assert reworded.inputs == less.inputs
    assert page_one(reworded).verdict is page_one(less).verdict is Verdict.UNCERTAIN
    table = next(one for one in inputs.write(reworded).blocks if one.key == "parameters")
    rows = [dict(zip(table.columns, row, strict=True)) for row in table.rows]
    assert all(row["source"] == words for row in rows)
    assert sum(isinstance(row["state"], Badge) for row in rows) == less.inputs[1] > 20


@pytest.mark.parametrize("what", ["known", "stiff shafts", "slender shafts"])
def test_more_information_never_gives_a_worse_verdict(what):
    """A pair on springs, and the same with every value known, and on shafts, where contact is kept too."""
    reference = known("calm")
    changes = {
        "known": {"assumed": {}},
        "stiff shafts": shafts_of(60, 6e8),
        "slender shafts": shafts_of(20, 2e8),
    }
    less = _not_varied()
    base = known_sizes(reference.pair) if what == "known" else reference.pair
    more = Results(base.with_(changes[what]), less.effort)
    vars(more).update({name: getattr(less, name) for name in _ON_SPRINGS})  # on springs in both
    poorer = page_one(less)
    first = page_one(more)
    assert list(Verdict).index(first.verdict) <= list(Verdict).index(poorer.verdict)
    values = sum(less.inputs)
    assert f"{less.inputs[1]} of {values} inputs are assumed, and they were not varied." in poorer.headline
    on_springs = ", on the springs of [bearings]"
    if what == "known":  # all is known: for absolute levels, and nothing to vary
        assert (first.verdict, first.actions) == (Verdict.ABSOLUTE, ())
        more.__dict__["inputs"] = (values - 1, 1)  # of no stated range
        assert page_one(more).verdict is Verdict.UNCERTAIN
        assert not first.numbers[-1].note.endswith(on_springs)
        return
    assert first.numbers[-1].note.endswith(on_springs)
    assert all(f"{on_springs}." in chapter.write(more).result for chapter in (contact_loss, stability))
    agreed = "Solved right? Yes: a second program agrees"
    assert poorer.sure[0].startswith(f"{agreed}. ")
    assert first.sure[0].startswith(f"{agreed}{on_springs}. ")
    assert first.sure[0].endswith(" on the shafts.")
    assert first.numbers[0].value != less.prediction.peak_to_peak
    assert more.prediction.least_force > 0.0
    vars(more.prediction)["mesh_force"] = np.append(more.prediction.mesh_force, 0.0)
    assert page_one(more).headline == "Do not run here: the teeth lose contact."
    assert "contact" in findings(more)


@pytest.mark.parametrize("motion", [Motion.FOLLOWED, Motion.LINEAR])
def test_a_pair_whose_runs_do_not_settle_must_not_run_here(motion):
    """Whose the numbers are: those of a stable motion beside chaos, or of the linear motion."""
    less = _not_varied()
    results = Results(less.pair, less.effort)
    vars(results).update(_of_the_motion(less))
    reason = "" if motion is Motion.FOLLOWED else "A run has not come to a motion."
    results.__dict__["prediction"] = replace(less.prediction, motion=motion, roams=True, reason=reason)
    first = page_one(results)
    assert first.verdict is Verdict.DO_NOT_RUN
    assert first.headline == "Do not run here: runs come to no motion that repeats."
    hazard = next(row for row in first.numbers if row.key == "hazard")
    assert hazard.value == 0.0
    assert hazard.note.startswith("runs come to no motion that repeats at ")
    if motion is Motion.FOLLOWED:
        size = f"{1e6 * less.prediction.peak_to_peak:.3g} µm"
        assert f"its transmission error is {size}" in plain(first.reason)
        assert "depends on how it reached the speed" in first.reason
    else:
        assert first.reason.startswith("A run has not come to a motion. The numbers are those of the linear")
