"""Does the cross-check tell agreement from disagreement, and does the verdict follow from the numbers?"""

import dataclasses

import numpy as np
import pytest

import lumped
import multibody
from lumped import ParameterError
from validation.cross_check import comparison
from validation.cross_check.agreement import (
    QUANTITIES,
    agreement,
    contact_shift,
    off_switch_samples,
)
from validation.cross_check.comparison import crosscheck
from validation.cross_check.finite_motion import PREDICTED
from validation.cross_check.tolerances import LOST, tolerance
from validation.reporting.cross_check_words import failed_checks


def test_linear_fidelity_solves_the_same_equations(check):
    dte = next(a for a in check.of("linear") if a.quantity == "dte")
    assert dte.maximum_over_span < 1e-6  # the requirement; both integrate to 1e-10
    assert all(a.within for a in check.of("linear"))


def test_progress_goes_on_while_the_twin_is_checked(check, told):
    assert told == sorted(told)
    assert told[-1] == 1.0
    # Four runs, the last of them the twin, which tells its own three and some cycles of these.
    assert len({fraction for fraction in told if fraction > 0.75}) >= 6


def test_every_quantity_is_judged_at_both_fidelities(check):
    assert [(a.fidelity, a.quantity) for a in check.agreements] == [
        (fidelity, quantity) for fidelity in ("linear", "exact") for quantity in QUANTITIES
    ]


def test_the_exact_model_is_compared_in_a_periodic_motion_of_its_own(check):
    assert check.periodic
    assert check.compared_cycles == 1
    assert check.unsettled["exact"] < 1e-7
    lumped_torque, own = (d.attrs["brake_torque"] for d in (check.lumped, check.multibody["exact"]))
    assert 1e-8 < abs(own / lumped_torque - 1.0) < 1e-5  # its friction takes another power


def test_a_pair_that_would_drift_under_the_lumped_torque_is_confirmed_in_its_own_balance():
    # In 24 cycles from the lumped motion this pair slips by half a hundredth of a cycle, over which its
    # ringing after entry changes by a tenth of its span: a difference of phase, not of motion.
    found = crosscheck(lumped.load_gear_pair("fzg_c"), cycles=6, samples_per_cycle=64, twin=False)
    assert found.verdict == "confirmed"
    assert max(a.remainder_l2 for a in found.of("exact")) < 0.2 * found.contact_shift


def test_an_exact_model_without_a_periodic_motion_of_its_own_is_run(pair, monkeypatch):
    def fail(*args, **kwargs):
        raise lumped.NumericalError("no motion")

    monkeypatch.setattr(multibody, "steady_state", fail)
    found = crosscheck(pair, cycles=12, samples_per_cycle=32, quantities=("dte",), twin=False)
    assert not found.periodic
    assert found.compared_cycles == 4
    assert found.multibody["exact"].attrs["brake_torque"] == found.lumped.attrs["brake_torque"]


def test_an_unstable_motion_is_run_because_no_pair_stays_in_it(pair, monkeypatch):
    monkeypatch.setattr(comparison, "parted_orbit", lambda pair: None)  # as where it beats
    unstable = pair.with_({"operating.pinion_speed": 17000, "mesh.damping_ratio": 0.0})
    assert not crosscheck(unstable, cycles=6, samples_per_cycle=32, quantities=("dte",), twin=False).periodic


def test_a_model_that_is_not_run_is_not_predicted(pair):
    found = crosscheck(
        pair, cycles=6, samples_per_cycle=32, fidelities=("linear",), quantities=("dte",), twin=False
    )
    assert found.finite_motion is None
    assert found.verdict == "not confirmed"


def test_metrics_see_a_wrong_sign_of_the_gear_displacement(pair, check, monkeypatch):
    def wrong(*args, **kwargs):
        result = true_simulate(*args, **kwargs)
        result["x_g"] = -result["x_g"]
        return result

    true_simulate = multibody.simulate
    monkeypatch.setattr(multibody, "simulate", wrong)
    found = crosscheck(pair, cycles=6, samples_per_cycle=64, quantities=("dte", "x_g"), twin=False)
    assert found.verdict == "not confirmed"
    by_name = {(a.quantity, a.fidelity): a for a in found.agreements}
    assert by_name["dte", "linear"].within
    # x_g oscillates about its mean: reversed it is twice itself away, and exactly out of phase.
    assert by_name["x_g", "linear"].relative_l2 == pytest.approx(2.0, rel=1e-6)
    assert by_name["x_g", "linear"].sprague_geers.phase == pytest.approx(1.0, abs=1e-6)


def test_pairs_without_friction_agree_though_nothing_moves_off_the_line_of_action(pair):
    found = crosscheck(pair.with_({"friction.law": "none"}), cycles=12, samples_per_cycle=64, twin=False)
    for a in found.agreements:
        if a.quantity in ("y_p", "y_g", "friction_force"):
            assert a.within
            assert a.peak_to_peak_ratio is None
            assert a.sprague_geers is None


def test_order_amplitudes_of_both_models_agree_at_linear_fidelity(check):
    orders = next(o for o in check.orders if o.quantity == "dte" and o.fidelity == "linear")
    np.testing.assert_allclose(orders.multibody.amplitude, orders.lumped.amplitude, rtol=1e-6)
    # Order 0 is the mean over whole cycles; the grid's last time starts a cycle that is not there.
    mean = float(check.lumped["dte"][:-1].mean())
    assert orders.lumped.amplitude[0] == pytest.approx(mean, rel=1e-9)


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


def test_another_motion_is_beyond_the_limit_that_is_shown_and_told_in_words(check):
    apart = dataclasses.replace(check, agreements=_with(check.agreements, "exact", "dte", relative_l2=0.73))
    (dte,) = [a for a in apart.of("exact") if a.quantity == "dte"]
    assert dte.relative_l2 > dte.whole_limit
    told = failed_checks(apart).replace("\u00a0", " ")
    assert told == "transmission error 73 % off, which is another motion, limit 50 %"


def test_verdict_follows_from_the_agreements(check):
    def verdict(agreements):
        return dataclasses.replace(check, agreements=tuple(agreements)).verdict

    agreeing = check.agreements
    assert verdict(agreeing) == "confirmed"
    assert verdict(_with(agreeing, "exact", "y_p", relative_l2=0.4)) == "explained"
    assert verdict(_with(agreeing, "exact", "y_p", remainder_l2=0.01)) == "not confirmed"
    assert verdict(_with(agreeing, "exact", "y_p", remainder_l2=np.nan)) == "not confirmed"
    assert verdict(_with(agreeing, "exact", "dte", relative_l2=1.01 * LOST)) == "not confirmed"
    assert verdict(_with(agreeing, "linear", "x_p", maximum_over_span=1e-3)) == "not confirmed"
    assert verdict([a for a in agreeing if a.fidelity == "linear"]) == "not confirmed"
    assert verdict([a for a in agreeing if a.fidelity == "exact"]) == "not confirmed"


def test_a_failure_names_check_value_and_limit(check):
    wrong = dataclasses.replace(check, agreements=_with(check.agreements, "exact", "y_p", remainder_l2=1.0))
    [failure] = wrong.failures
    assert (failure.check, failure.value) == ("remainder: y_p", 1.0)
    assert failure.limit == check.contact_shift * (1.0 + check.effects.largest("y_p"))
    assert "base pitch" in failure.reason


def test_raw_limits_are_what_the_effects_can_do_to_first_order(check):
    """Every quantity of the default pair is within; friction of the wrong sign would be twice itself away."""
    effects = check.effects
    assert set(effects.most) == set(effects.alone) == set(PREDICTED["prescribed"])
    for a in check.of("exact"):
        assert a.raw_limit.limit == effects.largest(a.quantity) + check.contact_shift
        assert a.relative_l2 < a.raw_limit.limit < 0.5, a.quantity
        assert a.remainder_l2 < 0.1 * a.predicted_l2
    # Late entry moves the transmission error, friction at the actual sliding moves y.
    assert effects.alone["entry_shift"]["dte"] > 10.0 * effects.alone["sliding_velocity"]["dte"]
    assert effects.alone["sliding_velocity"]["y_p"] > 3.0 * effects.alone["entry_shift"]["y_p"]


def test_exact_tolerance_is_the_shift_of_the_contact_and_linear_is_fixed(pair):
    """The shift is half the wind-up where both gears turn alike: (delta + x_g - x_p)/2 over the pitch."""
    motion = lumped.steady_state(pair, samples_per_cycle=64)
    wind_up = float((motion["dte"] + motion["x_g"] - motion["x_p"]).mean())
    shift = contact_shift(pair, motion)
    assert shift == pytest.approx(0.5 * wind_up / lumped.geometry(pair).base_pitch, rel=1e-2)
    for quantity in QUANTITIES:
        limit = tolerance(quantity, "exact", shift)
        assert (limit.metric, limit.limit) == ("remainder_l2", shift)
        assert tolerance(quantity, "linear", 0.1) == tolerance(quantity, "linear", 1e-5)
    assert tolerance("dte", "linear", 0.1).limit == 1e-6
    assert tolerance("y_p", "linear", 0.1).limit == 1e-5


def test_what_is_predicted_is_taken_off_before_judging(pair, check):
    """With stiffness jumps the whole difference is many times the limit; what is left, a small part of it."""
    assert check.finite_motion.settled
    for a in check.of("exact"):
        assert a.judged == a.remainder_l2
        assert a.remainder_l2 < 0.1 * a.relative_l2, a.quantity
        assert a.within
    dte = next(a for a in check.of("exact") if a.quantity == "dte")
    assert dte.relative_l2 > 3.0 * dte.tolerance.limit
    exact = check.multibody["exact"]
    keep = np.ones(check.lumped.sizes["time"], dtype=bool)
    limit = tolerance("dte", "exact", check.contact_shift)
    half = 0.5 * (exact["dte"] - check.lumped["dte"]).to_numpy()
    found = agreement("dte", "exact", exact, check.lumped, keep, limit, half)
    assert found.remainder_l2 == pytest.approx(0.5 * found.relative_l2, rel=1e-12)


@pytest.mark.parametrize(
    "arguments",
    [
        {"cycles": 5},
        {"samples_per_cycle": 31},
        {"fidelities": ("rough",)},
        {"fidelities": ()},
        {"quantities": ("dte", "dte")},
        {"quantities": ("speed",)},
    ],
)
def test_arguments_out_of_range_are_refused_before_any_work(pair, arguments):
    with pytest.raises(ParameterError):
        crosscheck(pair, **arguments)
