"""Is the misfit 0 for equal motions in any phase, and does it see what a peak to peak does not?"""

import dataclasses
import math

import numpy as np
import pytest

from tests.unlike_pairs import unlike_pair
from tests.validation.check.curves_of_motions import sampled
from tests.validation.check.motions import lumped_motion
from validation.check.curve_orders import ChannelOrders, drift, without_ramp
from validation.check.curves import Channel, Curves
from validation.check.mesh_frequency import mesh_frequency
from validation.check.misfit import ChannelMisfit, Misfit, static_value
from validation.check.problem import Problem
from validation.check.quantities import quantity_of
from validation.check.settled import settled
from validation.signals.complex_orders import ComplexOrders

SEVERAL = ("dte", "x_p", "y_g", "mesh_force", "bearing_force_y_p")
NAMES = (
    "rack_25_degrees_always_pushing",
    "larger_gear_drives_contact_lost",
    "contact_ratio_1_1_large_shifts",
    "heavily_relieved_under_load",
    "contact_ratio_2_3_on_shafts",
)


@pytest.fixture(scope="module", params=NAMES)
def pair(request):
    return unlike_pair(request.param)


def problem(pair, **settings):
    return Problem.of(
        pair, sampled(pair, settings.pop("quantities", SEVERAL), **settings), lumped_motion(pair)
    )


def test_equal_motions_have_no_misfit_in_any_phase(pair):
    for phase, per_cycle in ((0.37, 201.7), (0.81, 64.0), (0.0, 510.0)):
        one = problem(pair, phase=phase, per_cycle=per_cycle)
        # Both are read linearly between 512 samples a cycle. In 64 samples high orders move the shift.
        assert one.misfit.value < 5e-3
        assert one.misfit.shift == pytest.approx(phase, abs=1e-3) or phase == 0.0
        assert one.settled.change == 0.0 or one.settled.change < 1e-3


def test_one_percent_of_noise_is_no_difference(pair):
    assert problem(pair, noise=0.01, cycles=12).misfit.value < 0.01


def test_strong_noise_is_taken_from_the_misfit():
    # The square of the difference has the expected square of the noise; what is left has a mean near 0.
    pair = unlike_pair(NAMES[0])
    squares, noises = [], []
    for seed in range(8):
        one = problem(pair, quantities=("dte",), noise=0.1, cycles=6, seed=seed).misfit.channels[0]
        raw = np.linalg.norm(one.channel.orders.values - one.ours.values)
        squares.append(raw**2 / one.channel.noise**2)
        noises.append(one.motion * one.scale / one.channel.noise)
    # 12 complex differences each: a mean of 8 has a standard deviation of 0.1; halves estimate less well.
    assert 0.7 < np.mean(squares) < 1.5
    assert np.mean(noises) < 0.6 * np.sqrt(np.mean(squares))


def test_a_motion_at_rest_has_a_misfit_of_one(pair):
    still = problem(pair, change=lambda name, values, time: np.full_like(values, values.mean()))
    assert [row.motion for row in still.misfit.channels] == pytest.approx(len(SEVERAL) * [1.0], abs=0.02)


def test_a_channel_of_the_wrong_sign_has_a_misfit_of_two(pair):
    flipped = problem(pair, change=lambda name, values, time: -values if name == "x_p" else values)
    by_name = {row.channel.channel.name: row.motion for row in flipped.misfit.channels}
    assert by_name["x_p"] == pytest.approx(2.0, abs=0.4)  # the common shift gives way a little
    sizes = [row.channel.orders.peak_to_peak / row.ours.peak_to_peak for row in flipped.misfit.channels]
    assert sizes == pytest.approx(len(SEVERAL) * [1.0], abs=0.05)  # no peak to peak shows it


def test_the_same_size_of_another_motion_differs(pair):
    def third_order(name, values, time):
        wave = np.sin(6.0 * np.pi * time / pair.geometry.mesh_period)
        return values.mean() + 0.5 * np.ptp(values) * wave

    other = problem(pair, quantities=("dte", "x_p"), change=third_order)
    assert other.misfit.value > 0.3
    rows = other.misfit.channels
    assert [row.channel.orders.peak_to_peak / row.ours.peak_to_peak for row in rows] == pytest.approx(
        len(rows) * [1.0], rel=0.08
    )


def test_order_and_subset_of_channels(pair):
    one = problem(pair.with_(torque=0.8 * pair.operating.pinion_torque))
    turned = dataclasses.replace(one.curves, channels=one.curves.channels[::-1])
    other = Problem.of(pair, turned, one.motion)
    assert other.misfit.value == pytest.approx(one.misfit.value, rel=1e-6)
    rows = {row.channel.channel.name: row.total for row in one.misfit.channels}
    single = Problem.of(pair, dataclasses.replace(one.curves, channels=one.curves.channels[:1]), one.motion)
    assert single.misfit.channels[0].total <= rows["dte"] + 1e-3  # its own shift is free


def test_a_mean_that_an_export_removed_is_not_compared(pair):
    removed = problem(pair, change=lambda name, values, time: values - values.mean())
    assert removed.misfit.value < 5e-3
    assert not any(row.compares_mean for row in removed.misfit.channels if row.channel.channel.name == "dte")
    for share in (0.1, -0.1):
        shifted = problem(pair, change=lambda name, values, time, share=share: values + share * values.mean())
        by_name = {row.channel.channel.name: row.mean for row in shifted.misfit.channels}
        assert by_name["dte"] == pytest.approx(0.1, rel=0.05)


@pytest.mark.parametrize(("factor", "cause"), [
    (1e-3, "times are in milliseconds"), (1.0, ""), (1.003, ""),
])  # fmt: skip
def test_the_mesh_frequency_of_the_samples(pair, factor, cause):
    curves = sampled(pair, ("dte", "x_p"), cycles=20)
    scaled = dataclasses.replace(curves, places=curves.places / factor)
    frequency = mesh_frequency(scaled, pair)
    assert frequency.cause == cause
    assert frequency.factor == pytest.approx(factor, rel=3e-4)  # a phase of 0.006 after 20 cycles


@pytest.mark.parametrize("kind", [
    "angles of the pinion in radians", "angles of the pinion in degrees", "angles of the gear in radians",
    "turns of the pinion", "mesh cycles",
])  # fmt: skip
def test_the_mesh_frequency_of_angles_in_the_place_of_times(pair, kind):
    speed, teeth = pair.operating.pinion_speed, (pair.pinion.teeth, pair.gear.teeth)
    per_second = {
        "angles of the pinion in radians": speed,
        "angles of the pinion in degrees": math.degrees(speed),
        "angles of the gear in radians": speed * teeth[0] / teeth[1],
        "turns of the pinion": speed / (2.0 * math.pi),
        "mesh cycles": speed * teeth[0] / (2.0 * math.pi),
    }[kind]
    curves = sampled(pair, ("dte", "x_p"), cycles=20)
    frequency = mesh_frequency(dataclasses.replace(curves, places=curves.places * per_second), pair)
    assert frequency.cause == f"times are {kind}"
    assert frequency.factor == pytest.approx(1.0 / per_second, rel=3e-4)


def test_a_rotation_with_its_nominal_part_is_a_ramp(pair):
    speed = pair.operating.pinion_speed
    turned = problem(pair, quantities=("theta_p",), change=lambda name, values, time: values + speed * time)
    assert turned.misfit.value < 5e-3


def test_a_motion_that_has_not_settled_is_seen(pair):
    def decaying(name, values, time):
        period = pair.geometry.mesh_period
        return values + 0.5 * np.ptp(values) * np.exp(-time / (4.0 * period)) * np.cos(12.3 * time / period)

    assert problem(pair, change=decaying, cycles=8).settled.change > 0.02
    assert problem(pair, change=decaying, cycles=60).settled.change < 0.005


def test_rates_and_accelerations_are_those_of_the_motion(pair):
    time_step = pair.geometry.mesh_period / 512
    one = problem(pair, quantities=("dte",), per_cycle=512.0, phase=0.0)
    values = one.curves.channels[0].values
    rate = (np.roll(values, -1) - np.roll(values, 1)) / (2.0 * time_step)  # central differences
    channel = Channel("rate", "dte_dot", rate)
    inside = slice(512, -512)
    curves = Curves(
        "other", "time", one.curves.places[inside],
        (dataclasses.replace(channel, values=rate[inside]),),
    )  # fmt: skip
    assert Problem.of(pair, curves, one.motion).misfit.value < 0.01


def test_what_repeats_with_every_cycle_is_no_noise(pair):
    # A force with jumps has orders above the compared ones in every cycle.
    larger = problem(
        pair,
        quantities=("mesh_force",),
        per_cycle=64.0,
        change=lambda name, values, time: values.mean() + 1.06 * (values - values.mean()),
    )
    assert larger.misfit.channels[0].motion == pytest.approx(0.06 / 1.06, rel=0.1)
    noisy = problem(pair, quantities=("mesh_force",), noise=0.05, cycles=12)
    one = noisy.theirs[0]
    size = 0.05 * np.ptp(sampled(pair, ("mesh_force",)).channels[0].values)
    expected = size * np.sqrt(4.0 * one.orders.orders.size / noisy.settled.used.sum())
    assert 0.5 * expected < one.noise < 1.2 * expected  # by two halves: 12 complex differences


def test_static_values_of_rates_and_of_both_torques(pair):
    """A rate is a mesh frequency [rad/s] times the value; the torques are as the teeth."""
    motion = lumped_motion(pair)
    frequency = 2.0 * np.pi / pair.geometry.mesh_period
    still, rate, acceleration = (
        static_value(quantity_of(name), motion) for name in ("dte", "dte_dot", "dte_ddot")
    )
    assert rate == pytest.approx(frequency * still)
    assert acceleration == pytest.approx(frequency**2 * still)
    torques = [static_value(quantity_of(f"mesh_torque_{gear}"), motion) for gear in "pg"]
    assert torques[0] == pair.operating.pinion_torque
    assert torques[1] / torques[0] == pytest.approx(pair.gear.teeth / pair.pinion.teeth)


@pytest.mark.parametrize(("whole", "period", "cycles", "used"), [
    (5, 1, 5, 2), (17, 4, 4, 8), (8, 4, 2, 4), (3, 1, 3, 1),
])  # fmt: skip
def test_whole_periods_of_the_last_half_are_compared(whole, period, cycles, used):
    """The last sample lies a step before the end of the last cycle, and ends it."""
    places = np.arange(64 * whole) / 64
    channel = Channel("dte", "dte", np.cos(2.0 * np.pi * places))
    result = settled(Curves("other", "mesh_cycles", places, (channel,)), places, period)
    assert result.cycles == cycles
    assert np.count_nonzero(result.used) == 64 * used
    assert result.used[-1]


@pytest.mark.parametrize("acceleration", [0.0, 3e-5, -2e-4])
def test_the_drift_of_a_rotation_is_that_of_its_parabola_at_the_ends(acceleration):
    cycles = np.arange(64 * 7) / 64
    middle = cycles.mean()
    vibration = 1e-5 * np.cos(2.0 * np.pi * cycles + 0.4) + 4e-6 * np.sin(6.0 * np.pi * cycles)
    values = vibration + 1e-3 * cycles + acceleration * (cycles - middle) ** 2
    assert drift(cycles, values) == pytest.approx(abs(acceleration) * (0.5 * np.ptp(cycles)) ** 2, abs=1e-9)
    left = without_ramp(cycles, values)
    assert left - left.mean() == pytest.approx(vibration - vibration.mean(), abs=1e-9)


@pytest.mark.parametrize("quantity", ["mesh_force", "dte"])
def test_noise_in_few_samples_is_that_of_two_halves(pair, quantity):
    """In 30 samples a cycle high orders look like white noise, two to twelve times as large."""
    clean = sampled(pair, (quantity,), per_cycle=30.0, cycles=24).channels[0].values
    ratios = []
    for seed in range(8):
        noisy = problem(pair, quantities=(quantity,), per_cycle=30.0, noise=0.02, cycles=24, seed=seed)
        orders = noisy.theirs[0].orders.orders.size
        expected = 0.02 * np.ptp(clean) * np.sqrt(4.0 * orders / noisy.settled.used.sum())
        ratios.append(noisy.theirs[0].noise / expected)
    assert np.mean(ratios) == pytest.approx(1.0, abs=0.3)  # a mean of 8 estimates from 12 differences each


def test_a_motion_that_fades_is_no_noise(pair):
    def fading(name, values, time):
        period = pair.geometry.mesh_period
        wave = np.cos(12.3 * time / period)
        return values + 2.0 * np.ptp(values) * np.exp(-time / (4.0 * period)) * wave

    curves = sampled(pair, ("dte",), change=fading, cycles=8)
    noisy = problem(pair, quantities=("dte",), change=fading, cycles=8, noise=0.003)
    orders = noisy.theirs[0].orders.orders.size
    expected = 0.003 * np.ptp(curves.channels[0].values) * np.sqrt(4.0 * orders / noisy.settled.used.sum())
    assert noisy.theirs[0].noise == pytest.approx(expected, rel=0.3)


def test_all_tooth_pairs_count_as_one_channel():
    """e^2 = mean of the squares of dte, .1, and of the tooth loads together, (.3^2 + .5^2)/2."""
    waves = ComplexOrders(np.array([1.0]), np.array([1.0 + 0.0j]), 0.0, np.zeros((2, 2)))

    def row(channel, size):
        ours = dataclasses.replace(waves, values=waves.values * (1.0 + size))
        return ChannelMisfit(ChannelOrders(channel, waves), ours, 1.0, 1.0, compares_mean=False)

    rows = (
        row(Channel("te", "dte", np.zeros(8)), 0.1),
        row(Channel("N_A", "normal_load", np.zeros(8), "A"), 0.3),
        row(Channel("N_B", "normal_load", np.zeros(8), "B"), -0.5),
    )
    assert Misfit(rows, 0.0).value == pytest.approx(np.sqrt((0.01 + (0.09 + 0.25) / 2) / 2))
