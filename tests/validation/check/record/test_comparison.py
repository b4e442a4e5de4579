"""Does a right record confirm the prediction, and does one that is wrong in any channel contradict it?"""

import dataclasses
from functools import cache

import numpy as np
import pytest

import lumped
from lumped.errors import ParameterError
from lumped.model.results import plain
from tests.unlike_pairs import unlike_pair
from tests.validation.check.record.dynamic_motions import dynamic_record, motion
from validation.check.record.channel import (
    NOT_VARIED,
    SHARE,
    UNKNOWN,
    ChannelComparison,
    PeakToPeak,
    Record,
)
from validation.check.record.compare import compare_record
from validation.exchange.new_pair_file import new_pair
from validation.prediction.motion import predicted
from validation.prediction.uncertainty import Varied
from validation.signals.complex_orders import ComplexOrders

PAIRS = {
    "19/41": lambda: new_pair("19/41", module=2.5, face_width=20, speed=1450, torque=80),
    "31/57 contact lost": lambda: new_pair("31/57", module=3, face_width=25, speed=12000, torque=150).with_(
        {"mesh.damping_ratio": 0.02, "pinion.tip_relief": None, "gear.tip_relief": None}
    ),
    "fzg_c": lambda: lumped.load_gear_pair("fzg_c"),
    "25/103": lambda: new_pair("25/103", module=2, face_width=20, speed=1500, torque=60),
}
SEVERAL = ("dte", "x_p", "bearing_force_y_g")
WITH_A_TOOTH = ("dte", "normal_load", "friction_force")


@cache
def motion_of(name):
    return predicted(PAIRS[name]())


@cache
def varied(name, spread=0.05):
    """Predictions at torques about the given one: the motion moves by about as much."""
    pair = PAIRS[name]()
    torque = pair.operating.pinion_torque
    factors = (1.0 - spread, 1.0 - 0.3 * spread, 1.0 + 0.6 * spread, 1.0 + spread)
    samples = (predicted(pair.with_({"operating.pinion_torque": f * torque})) for f in factors)
    return Varied(motion_of(name), tuple(samples))


def compared(name, quantities=SEVERAL, *, samples=None, **made):
    prediction = motion_of(name)
    return compare_record(dynamic_record(prediction, quantities, **made), prediction, varied=samples)


def test_contact_is_lost_in_one_of_the_pairs():
    assert [name for name in PAIRS if motion_of(name).contact_lost] == ["31/57 contact lost"]


@pytest.mark.parametrize("quantities", [("dte",), SEVERAL, WITH_A_TOOTH], ids=" ".join)
@pytest.mark.parametrize("name", PAIRS)
def test_a_right_record_confirms(name, quantities):
    # Another phase, 50.317 samples a mesh cycle; 400 mesh cycles hold many engagements of tooth pair A.
    cycles = 400 if quantities is WITH_A_TOOTH else 60
    for seed, phase, samples in ((1, 0.37, None), (2, 0.81, varied(name))):
        comparison = compared(name, quantities, cycles=cycles, seed=seed, phase=phase, samples=samples)
        assert [one.verdict for one in comparison.channels] == len(quantities) * [Record.CONFIRMS], (
            comparison.words
        )
        assert min(one.explained for one in comparison.channels) > 0.995
        assert comparison.shift % 1.0 == pytest.approx(phase, abs=2e-3)


@pytest.mark.parametrize(("noise", "seeds"), [(0.0, 1), (0.01, 3)])
@pytest.mark.parametrize("name", PAIRS)
def test_one_percent_of_noise_changes_no_verdict(name, noise, seeds):
    for change, verdict in ((None, Record.CONFIRMS), (flip("x_p"), Record.CONTRADICTS)):
        for seed in range(seeds):
            comparison = compared(name, noise=noise, change=change, seed=seed)
            assert comparison.verdict is verdict, comparison.words


def flip(name):
    return lambda quantity, values, u: -values if quantity == name else values


@pytest.mark.parametrize("name", PAIRS)
def test_a_pure_third_order_of_the_right_size_contradicts(name):
    swing = motion_of(name).peak_to_peak

    def third(quantity, values, u):
        return 0.5 * swing * np.sin(6.0 * np.pi * u)

    for samples in (None, varied(name)):
        comparison = compared(name, ("dte",), change=third, samples=samples, noise=0.005)
        assert abs(comparison.error) < 0.02 * swing  # the size alone says nothing
        assert comparison.verdict is Record.CONTRADICTS
        assert not comparison.leading.contradicts_size
        assert "Order 3 is" in comparison.words or "Order 1 is" in comparison.words


@pytest.mark.parametrize("name", PAIRS)
@pytest.mark.parametrize("factor", [1.0 / 0.73, 0.7])
def test_a_wrong_size_contradicts_and_is_told_in_percent_of_the_measured(name, factor):
    for samples in (None, varied(name)):
        comparison = compared(name, change=lambda q, values, u: factor * values, samples=samples)
        assert comparison.verdict is Record.CONTRADICTS, comparison.words
        assert comparison.peak_to_peak.percent == pytest.approx(100.0 * (1.0 / factor - 1.0), abs=1.5)
        assert "27 % too low" in comparison.words if factor > 1.0 else "43 % too high" in comparison.words
        assert "Order" not in comparison.words  # the shape is right
        assert ("not varied" in comparison.words) == (samples is None)


def test_a_record_far_off_contradicts_without_varied_inputs():
    # 12 um off: the fault was that inputs that are not varied hid it.
    for name in ("19/41", "fzg_c"):
        swing = motion_of(name).peak_to_peak
        comparison = compared(name, ("dte",), change=lambda q, v, u, swing=swing: v * (1.0 + 12e-6 / swing))
        assert comparison.error == pytest.approx(-12e-6, rel=0.02)
        assert comparison.verdict is Record.CONTRADICTS


@pytest.mark.parametrize("name", PAIRS)
@pytest.mark.parametrize("samples", [False, True])
def test_a_channel_in_the_wrong_phase_or_sign_contradicts(name, samples):
    prediction = motion_of(name)

    def late(quantity, values, u):
        return motion(prediction, "x_p", u - 0.1) if quantity == "x_p" else values

    for change in (late, flip("x_p"), flip("bearing_force_y_g")):
        comparison = compared(name, change=change, samples=varied(name) if samples else None)
        sizes = [abs(one.peak_to_peak.percent) for one in comparison.channels]
        assert max(sizes) < 2.0  # peaks to peak are right
        assert comparison.verdict is Record.CONTRADICTS, comparison.words
        assert (
            "degrees" in comparison.words
            or "opposite sign" in comparison.words
            or "Order" in comparison.words
        )


def test_the_order_of_the_channels_does_not_matter():
    for change in (None, flip("x_p")):
        one, other = (compared("25/103", names, change=change) for names in (SEVERAL, SEVERAL[::-1]))
        assert one.verdict is other.verdict
        assert one.leading.quantity == other.leading.quantity == "dte"


def test_a_noisy_record_is_too_uncertain_and_never_contradicts():
    for name in PAIRS:
        verdicts = [compared(name, noise=4.0, cycles=45, per_cycle=20.3, seed=seed) for seed in range(10)]
        # Noise alone contradicts in 5 of 100 records at most: 3 of 10 would be one in 90.
        wrong = sum(one.verdict is Record.CONTRADICTS for one in verdicts)
        assert wrong <= 2
        assert sum(one.verdict is Record.TOO_UNCERTAIN for one in verdicts) >= 8
        assert any("noise" in one.words for one in verdicts)


def test_noise_is_no_agreement_where_the_inputs_were_varied():
    # Close enough by chance, with inputs that leave little: the noise alone decides.
    comparisons = [
        compared(
            "fzg_c", ("dte",), noise=0.7, cycles=20, per_cycle=20.3, seed=seed, samples=varied("fzg_c", 0.01)
        )
        for seed in range(12)
    ]
    close = [one for one in comparisons if abs(one.peak_to_peak.percent) < 100.0 * SHARE]
    assert close
    assert {one.verdict for one in close} == {Record.TOO_UNCERTAIN}
    assert all(one.leading.noisy for one in close)


def test_more_of_a_noisy_record_is_certain():
    short, long = (compared("19/41", noise=1.0, cycles=count) for count in (20, 2000))
    assert (short.verdict, long.verdict) == (Record.TOO_UNCERTAIN, Record.CONFIRMS)


def test_inputs_that_leave_much_neither_confirm_nor_contradict():
    many = varied("25/103", 0.6)
    comparison = compared("25/103", ("dte",), change=lambda q, v, u: 1.3 * v, samples=many)
    assert comparison.verdict is Record.TOO_UNCERTAIN
    assert "known to" in comparison.words
    assert 2.0 * comparison.uncertainty > UNKNOWN * comparison.measured
    # A record that is met is met, whatever the inputs could have done.
    assert compared("25/103", ("dte",), samples=many).verdict is Record.CONFIRMS


def test_without_varied_inputs_a_moderate_difference_is_no_verdict():
    # Between SHARE and twice NOT_VARIED.
    comparison = compared("19/41", ("dte",), change=lambda q, v, u: v / 0.82)
    assert SHARE < abs(comparison.error) / comparison.measured < 2.0 * NOT_VARIED
    assert comparison.verdict is Record.TOO_UNCERTAIN
    assert "not varied" in comparison.words


def test_inputs_move_the_prediction_by_as_much_as_their_samples_do():
    name = "fzg_c"
    nominal = motion_of(name)
    samples = varied(name)
    peak_to_peak = compared(name, ("dte",), samples=samples).peak_to_peak
    moves = [one.peak_to_peak - nominal.peak_to_peak for one in samples.samples]
    assert peak_to_peak.inputs == pytest.approx(np.sqrt(np.mean(np.square(moves))), rel=5e-3)


def test_a_phase_that_all_channels_share_is_no_uncertainty_of_the_inputs():
    # The same motion a fifth of a mesh cycle later: a record would be shifted by as much.
    nominal = motion_of("25/103")
    later = dataclasses.replace(nominal, plain=plain(nominal.cycle.roll(time=102, roll_coords=False)))
    comparison = compared("25/103", samples=Varied(nominal, (later,)))
    for one in comparison.channels:
        assert np.sqrt(one.by_inputs.max()) < 1e-3 * one.scale


def agreeing(noise=0.0, **sizes):
    """A channel whose 20 orders agree; ``noise``: of all together over the motion."""
    count = 20
    values = np.exp(1j * np.arange(count)) / np.sqrt(count)
    spread = noise**2 / (2 * count) * np.eye(2 * count)
    measured = ComplexOrders(np.arange(1.0, count + 1.0), values, 0.0, spread)
    predicted_ = dataclasses.replace(measured, covariance=0.0 * spread)
    none = np.zeros((count, 2, 2))
    size = PeakToPeak(**({"measured": 2.0, "predicted": 2.0} | dict.fromkeys(UNKNOWNS, 0.0) | sizes))
    return ChannelComparison(
        "te", "dte", "m", "", measured, predicted_, none, 0.0, 1.0, size, count, varied=True,
    )  # fmt: skip


UNKNOWNS = ("record", "inputs", "numerical")


@pytest.mark.parametrize(("noise", "verdict"), [(0.24, Record.CONFIRMS), (0.26, Record.TOO_UNCERTAIN)])
def test_noise_of_many_small_orders_counts_together(noise, verdict):
    assert agreeing(noise).verdict is verdict


@pytest.mark.parametrize(("sizes", "verdict"), [
    ({"predicted": 1.82, "inputs": 0.9}, Record.CONFIRMS),  # 9 % off: agrees
    ({"predicted": 1.7, "inputs": 0.2}, Record.CONFIRMS),  # 15 % off, known to 20 %
    ({"predicted": 1.7, "inputs": 0.26}, Record.TOO_UNCERTAIN),  # known to 26 %
    ({"predicted": 1.7, "inputs": 0.14}, Record.CONTRADICTS),  # known to 14 %
    ({"predicted": 2.3, "record": 0.1, "inputs": 0.08, "numerical": 0.07}, Record.CONTRADICTS),  # 14.6 %
    ({"predicted": 2.3, "record": 0.1, "inputs": 0.09, "numerical": 0.07}, Record.CONFIRMS),  # 15.2 %
])  # fmt: skip
def test_the_size_alone_turns_the_verdict(sizes, verdict):
    assert agreeing(**sizes).verdict is verdict


def test_three_uncertainties_add_as_squares():
    peak_to_peak = PeakToPeak(4e-6, 5e-6, record=2e-7, inputs=1e-7, numerical=2e-7)
    assert peak_to_peak.error == pytest.approx(1e-6)
    assert peak_to_peak.u_val == pytest.approx(3e-7)
    assert peak_to_peak.percent == pytest.approx(25.0)


def test_orders_have_the_amplitudes_and_phases_that_were_put_in():
    def change(quantity, values, u):
        return 3e-6 * np.cos(2 * np.pi * u) + 1e-6 * np.cos(2 * np.pi * 4 * u + 0.5)

    comparison = compared("25/103", ("dte",), change=change, noise=0.003)
    orders = comparison.orders.sel(channel="dte")
    for order, size in ((1, 3e-6), (4, 1e-6)):
        one = orders.sel(order=order)
        assert float(one["measured"]) == pytest.approx(size, abs=4.0 * float(one["measured_deviation"]))
    # Unrelated to the common shift: the phase of order 4 less four times that of order 1.
    leading = comparison.leading.measured
    turn = np.angle(leading.values[leading.orders == 4] * leading.values[leading.orders == 1].conj() ** 4)
    assert turn[0] % (2 * np.pi) == pytest.approx((0.5 + 2 * np.pi * (4 - 4) * 0.37) % (2 * np.pi), abs=0.05)


def test_teeth_that_differ_are_compared_by_their_mean_mesh_cycle():
    prediction = predicted(unlike_pair("unlike_teeth_finite_elements"))
    count = prediction.mesh_cycles
    assert count > 1
    # Two hunting periods, and the same of a record that is no whole number of them.
    for cycles in (2 * count, 3.4 * count):
        made = dynamic_record(prediction, ("dte", "x_p"), cycles=cycles)
        comparison = compare_record(made, prediction)
        assert comparison.verdict is Record.CONFIRMS, comparison.words
        assert comparison.mesh_cycles == count
    # Mesh orders alone: the swing over a revolution is larger.
    assert comparison.measured < 0.5 * prediction.peak_to_peak
    wrong = dynamic_record(prediction, ("dte", "x_p"), cycles=2 * count, change=flip("x_p"))
    assert compare_record(wrong, prediction).verdict is Record.CONTRADICTS


@pytest.mark.parametrize("name", ["19/41", "fzg_c"])
def test_a_speed_stated_a_little_wrong_is_found(name):
    prediction = motion_of(name)
    made = dynamic_record(prediction, SEVERAL, cycles=800)
    for speed_error in (-0.003, 0.0008):
        comparison = compare_record(
            dataclasses.replace(made, places=made.places / (1.0 + speed_error)), prediction
        )
        assert comparison.verdict is Record.CONFIRMS, comparison.words


@pytest.mark.parametrize("speed_error", [-0.03, 0.02])
def test_samples_of_another_speed_are_refused_with_that_speed(speed_error):
    prediction = motion_of("19/41")
    made = dynamic_record(prediction, SEVERAL)
    wrong = dataclasses.replace(made, places=made.places / (1.0 + speed_error))
    with pytest.raises(ParameterError, match=f"about {str(1450 * (1 + speed_error))[:3]}"):
        compare_record(wrong, prediction)


@pytest.mark.parametrize(("changes", "match"), [
    ({"pinion_speed": 100.0 * np.pi}, r"pinion_speed = 3000 rpm: allowed 1450 rpm within 1 %"),
    ({"pinion_torque": 81.7}, r"pinion_torque = 81\.7 N\*m: allowed 80 N\*m within 1 %"),
])  # fmt: skip
def test_a_record_of_something_else_is_refused(changes, match):
    prediction = motion_of("19/41")
    with pytest.raises(ParameterError, match=match):
        compare_record(dynamic_record(prediction, **changes), prediction)


def test_samples_at_few_phases_show_few_orders():
    # 10 samples in every mesh cycle: 3 orders, over which both peaks to peak are.
    comparison = compared("19/41", ("dte",), per_cycle=10, noise=0.0, cycles=80)
    assert comparison.leading.measured.orders.max() <= 3
    assert comparison.verdict is not Record.CONTRADICTS


def test_the_table_is_what_the_channels_say():
    comparison = compared("31/57 contact lost", change=flip("x_p"))
    table = comparison.table.sel(channel="x_p")
    channel = next(one for one in comparison.channels if one.name == "x_p")
    assert float(table["explained"]) == channel.explained < 0.5
    assert str(table["verdict"].item()) == "CONTRADICTS"
    assert comparison.table.attrs["verdict"] == "CONTRADICTS"
    assert float(table["worst_order"]) in channel.measured.orders
