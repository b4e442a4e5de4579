"""Does the cross-check tell agreement from disagreement, and sound pairs from what symmetry hides?"""

import dataclasses
import math
import re

import numpy as np
import pytest

import lumped
import multibody
from lumped import ParameterError, bodies
from lumped.model import periodic_system
from multibody.contact.machine import machine
from validation.cross_check import comparison
from validation.cross_check.agreement import QUANTITIES, off_switch_samples
from validation.cross_check.comparison import crosscheck
from validation.cross_check.variant import asymmetric_variant
from validation.cross_check.verdict import Verdict, limit_of
from validation.cross_check.words import NAMES, cause_of_difference, failed_checks, whole_difference
from validation.exchange import new_pair


def test_progress_goes_on_while_the_variant_is_checked(check, fractions):
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0
    assert len({fraction for fraction in fractions if fraction > 0.75}) >= 6


def test_the_exact_model_is_compared_in_a_periodic_motion_of_its_own(check):
    assert check.periodic
    lumped_torque, exact_torque = (d.attrs["brake_torque"] for d in (check.lumped, check.multibody["exact"]))
    assert 1e-8 < abs(exact_torque / lumped_torque - 1.0) < 1e-5  # its friction takes another power


def test_the_difference_is_that_of_the_motions_over_the_peak_to_peak(check):
    last = slice(-129, None)
    reference, other = (d.isel(time=last) for d in (check.lumped, check.multibody["exact"]))
    keep = off_switch_samples(check.pair, reference["time"].to_numpy())
    agreements = {a.quantity: a for a in check.of("exact")}
    for name in ("dte", "x_p", "y_g"):
        a, b = (motion[name].to_numpy()[keep] for motion in (other, reference))
        swing = np.ptp(b)
        if name == "x_p":  # a part of the transmission error, which measures it where it is larger
            swing = max(swing, np.ptp(reference["dte"].to_numpy()))
        mean = (a - b).mean() if name == "y_g" else 0.0  # small beside the vibration here
        assert agreements[name].difference == pytest.approx(np.abs(a - b - mean).max() / swing, rel=1e-12)
        assert agreements[name].peak_to_peak_multibody == pytest.approx(np.ptp(a), rel=1e-12)
    # Rectangular stiffness: one tooth force jumps by all of itself where the entry moves. The sum is judged,
    # more than 2 % of a cycle from the switches.
    keep = off_switch_samples(check.pair, reference["time"].to_numpy(), 0.02)
    a, b = (motion["normal_load"].to_numpy().sum(axis=0)[keep] for motion in (other, reference))
    assert agreements["normal_load"].difference == pytest.approx(np.abs(a - b).max() / np.ptp(b), rel=1e-12)


@pytest.mark.parametrize(("teeth", "module", "rpm"), [((19, 41), 2.5, 0.5), ((60, 23), 0.4, 12.0)])
def test_a_speed_that_is_too_slow_is_refused_by_its_name(teeth, module, rpm):
    """The number of samples follows from the speed: a refusal of samples names what nobody gave."""
    slow = new_pair(teeth, module, 8 * module, rpm, 3.0 * module**3)
    with pytest.raises(ParameterError) as caught:
        crosscheck(slow, variant=False)
    (problem,) = caught.value.problems
    assert (problem.field, problem.value) == ("operating.pinion_speed", f"{rpm:g} rpm")
    least = float(re.search(r">= (\S+) rpm", problem.allowed)[1])
    # Vibrations in a mesh cycle are in inverse proportion to the speed.
    for speed, refused in ((0.98 * least, True), (least, False)):
        vibrations = machine(slow).vibrations_per_cycle * rpm / speed
        samples = 256 * math.ceil(comparison._PER_SWING * vibrations / 256)
        assert (samples > comparison._MOST_SAMPLES) == refused


def test_an_exact_model_without_a_periodic_motion_of_its_own_is_run_and_not_judged(pair, monkeypatch):
    def fail(*args, **kwargs):
        raise lumped.NumericalError("no motion")

    monkeypatch.setattr(multibody, "steady_state", fail)
    result = crosscheck(pair, cycles=12, samples_per_cycle=32, variant=False)
    assert not result.periodic
    assert result.verdict is Verdict.NOT_CHECKED
    brake_torque = result.multibody["exact"].attrs["brake_torque"]
    assert brake_torque == pytest.approx(result.lumped.attrs["brake_torque"], rel=1e-12)


def test_an_unstable_motion_is_not_judged_because_no_pair_stays_in_it(pair, monkeypatch):
    monkeypatch.setattr(comparison, "unilateral_orbit", lambda pair: (None, "why"))  # as where it beats
    unstable = pair.with_({"operating.pinion_speed": 17000, "mesh.damping_ratio": 0.0})
    result = crosscheck(unstable, cycles=6, samples_per_cycle=32, variant=False)
    assert not result.periodic
    assert result.pulling == "why"
    assert result.verdict is Verdict.NOT_CHECKED


def test_without_the_exact_model_nothing_is_checked(pair):
    result = crosscheck(pair, cycles=6, samples_per_cycle=32, fidelities=("linear",), variant=False)
    assert result.failures == ()
    assert result.verdict is Verdict.NOT_CHECKED


def test_pairs_without_friction_agree_though_nothing_moves_off_the_line_of_action(pair):
    result = crosscheck(pair.with_({"friction.law": "none"}), cycles=12, samples_per_cycle=64, variant=False)
    for a in result.agreements:
        if a.quantity in ("y_p", "y_g", "friction_force"):
            assert a.within


def test_samples_on_switches_are_left_out_also_after_many_cycles(pair):
    cycle = lumped.mesh_cycle(pair)
    # 21 T_m reduced modulo T_m rounds to just below T_m: a sample on a switch all the same.
    time = np.array([0.0, 1.0, 21.0, 21.5, 40.0]) * cycle.period
    assert off_switch_samples(pair, time).tolist() == [False, False, False, True, False]
    assert not off_switch_samples(pair, cycle.switch_times + 3 * cycle.period).any()


def _with(agreements, fidelity, quantity, **changes):
    return tuple(
        dataclasses.replace(a, **changes) if (a.fidelity, a.quantity) == (fidelity, quantity) else a
        for a in agreements
    )


def test_verdict_follows_from_the_agreements(check):
    def verdict(agreements):
        return dataclasses.replace(check, agreements=tuple(agreements)).verdict

    agreeing = check.agreements
    assert verdict(agreeing) is Verdict.AGREES
    assert verdict(_with(agreeing, "exact", "y_p", difference=0.19)) is Verdict.AGREES
    assert verdict(_with(agreeing, "exact", "y_p", difference=0.21)) is Verdict.DIFFERS
    assert verdict(_with(agreeing, "exact", "y_p", difference=np.nan)) is Verdict.DIFFERS
    assert verdict(_with(agreeing, "exact", "dte", difference=0.051)) is Verdict.DIFFERS
    assert verdict(_with(agreeing, "linear", "x_p", difference=1e-3)) is Verdict.FAILS
    assert verdict(_with(agreeing, "linear", "x_p", difference=np.nan)) is Verdict.FAILS
    assert verdict([a for a in agreeing if a.fidelity == "linear"]) is Verdict.NOT_CHECKED
    broken = dataclasses.replace(check.conservation[0], value=1.0)
    assert dataclasses.replace(check, conservation=(broken,)).verdict is Verdict.FAILS


def test_limits_do_not_depend_on_the_motion_and_a_gate_sets_the_first():
    assert {q: limit_of(q, "linear")[0] for q in ("dte", "y_p")} == {"dte": 1e-6, "y_p": 1e-5}
    for quantity in QUANTITIES:
        by_friction = quantity in ("y_p", "y_g", "friction_force")
        assert limit_of(quantity, "exact")[0] == (0.2 if by_friction else 0.05)
        assert limit_of(quantity, "exact", 0.02)[0] == (0.2 if by_friction else 0.02)


def test_a_tighter_limit_turns_the_verdict(pair, check):
    result = crosscheck(pair, cycles=6, samples_per_cycle=128, limit=0.02, variant=False)
    assert check.verdict is Verdict.AGREES
    assert result.verdict is Verdict.DIFFERS
    text = f"{whole_difference(result)} {cause_of_difference(result)}".replace("\u00a0", " ")
    assert "peak to peak beside" in text
    assert "limit 2 %" in text
    far = dataclasses.replace(result, agreements=_with(result.agreements, "exact", "y_p", difference=9.2))
    assert "m, by 9.2 times, limit 20" in whole_difference(far).replace("\u00a0", " ")
    assert text.endswith("momentary load and the centres.")
    unlike = result.pair.with_({"pinion.deviations": {"index": [1.0] + [0.0] * 27}})
    assert cause_of_difference(dataclasses.replace(result, pair=unlike)) == ""


@pytest.mark.parametrize(
    ("arguments", "quantity", "words", "share_left"),
    [
        # Slow and light: ten times the inertia of both gears makes a ninth of the difference.
        (("32/83", 1, 11.6, 146, 8.11), "dte", "the free shafts turn to and fro by 0.92 %", 0.01),
        # 37 % of the swing of the friction force, which neither inertia nor contact explains.
        (("38/54", 1.25, 14.5, 970, 54.2), "friction_force", "friction follows the actual sliding", 0.02),
        # With contact loss: 21 % of it.
        (("31/43", 1.25, 9.12, 5230, 46), "friction_force", "friction follows the actual sliding", 0.03),
    ],
)
def test_the_effect_that_is_named_takes_the_difference_with_it(arguments, quantity, words, share_left):
    settings = {"cycles": 6, "samples_per_cycle": 128, "fidelities": ("exact",), "variant": False}
    of_springs = {"mesh.stiffness.model": "energy", "law": "xu_kahraman", "bearings.stiffness": 1e8}
    result = crosscheck(new_pair(*arguments, of_springs), **settings)
    worst = result.worst("exact")
    assert (result.verdict, worst.quantity) == (Verdict.DIFFERS, quantity)
    text = cause_of_difference(result).replace("\u00a0", " ")
    assert words in text
    _, _, without = text.partition("Without it the ")
    name, _, rest = without.partition(" differs by ")
    assert name == NAMES[quantity]
    assert float(rest.partition(" %")[0]) < 100.0 * share_left < 25.0 * worst.difference
    if quantity == "dte":
        inertia = {
            f"{g}.inertia": 10.0 * getattr(bodies(result.pair), f"inertia_{g}") for g in ("pinion", "gear")
        }
        heavy = crosscheck(result.pair.with_(inertia), **settings)
        assert heavy.of("exact")[0].difference < 0.2 * worst.difference


def test_a_failure_is_told_with_value_and_limit(check):
    wrong = dataclasses.replace(check, agreements=_with(check.agreements, "linear", "y_p", difference=0.73))
    text = failed_checks(wrong).replace("\u00a0", " ")
    assert text == "pinion y 73 % off with the same equations, limit 0.001 %"
    [failure] = wrong.failures
    assert (failure.check, failure.value, failure.limit) == ("same equations: y_p", 0.73, 1e-5)
    broken = dataclasses.replace(check.conservation[0], value=1.0)
    text = failed_checks(dataclasses.replace(check, conservation=(broken,)))
    assert text.startswith("conservation: friction takes power, lumped 1, limit")


@pytest.mark.parametrize("arguments", [
    {"cycles": 5},
    {"samples_per_cycle": 31},
    {"fidelities": ("rough",)},
    {"fidelities": ()},
    {"fidelities": ("linear", "linear")},
    {"limit": 0.0},
    {"limit": 1.5},
])  # fmt: skip
def test_arguments_out_of_range_are_refused_before_any_work(pair, arguments):
    with pytest.raises(ParameterError):
        crosscheck(pair, **arguments)


QUICK = {"cycles": 6, "samples_per_cycle": 64}


def _swapped(s):
    order = [0, 1, 3, 2, 5, 4]
    return dataclasses.replace(s, stiffness=s.stiffness[order], damping=s.damping[order])


def test_what_symmetry_hides_is_seen_by_the_asymmetric_variant(pair, monkeypatch):
    """The default pair has equal bearings: swapped ones change nothing but in the variant."""
    true = periodic_system.structure
    monkeypatch.setattr(periodic_system, "structure", lambda *a, **k: _swapped(true(*a, **k)))
    result = crosscheck(pair, **QUICK)
    assert result.verdict is Verdict.FAILS
    assert all(failure.check.startswith("variant: ") for failure in result.failures)


def test_a_sound_pair_and_its_variant_obey_the_conservation_laws(check):
    assert check.failures == ()
    assert check.variant is not None
    for result in (check, check.variant):
        checks = [j.check for j in result.conservation]
        assert len(set(checks)) == len(checks) > 25
    pinion = check.variant.pair.bearings.pinion
    gear = check.variant.pair.bearings.gear
    values = [getattr(b, f"{axis}_stiffness") for b in (pinion, gear) for axis in ("loa", "oloa")]
    assert len(set(values)) == 4
    assert check.variant.pair.pinion.teeth != check.variant.pair.gear.teeth


def test_vibration_that_reverses_sliding_is_no_wrong_sign(check):
    """The lumped friction feeds power in where vibration turns the sliding: a limit of validity, stated."""
    assert float(check.lumped["friction_power"].max()) > 0.0
    [taken] = [j for j in check.conservation if j.check == "conservation: friction takes power, lumped"]
    assert taken.within


def test_a_variant_that_loses_contact_is_not_taken(pair):
    slow = pair.with_({"operating.pinion_torque": 5.0, "operating.pinion_speed": 8500.0})
    variant = asymmetric_variant(slow)
    assert (
        variant is None
        or float(lumped.steady_state(variant, samples_per_cycle=64)["normal_load"].min()) >= 0.0
    )
