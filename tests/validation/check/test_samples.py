"""Are the peaks to peak those of the samples, and is a difference between the compared orders said?"""

import numpy as np
import pytest

from tests.unlike_pairs import unlike_pair
from tests.validation.check.curves_of_motions import sampled
from validation.check import check
from validation.check.samples import difference_at_no_order, peaks_to_peak, samples_of
from validation.signals.complex_orders import complex_orders

NAMES = ("rack_25_degrees_always_pushing", "heavily_relieved_under_load", "contact_ratio_2_3_on_shafts")
QUANTITIES = ("dte", "y_g")


@pytest.fixture(scope="module", params=NAMES)
def pair(request):
    return unlike_pair(request.param)


def with_wave(pair, order, share):
    """Curves with a wave of a mesh order on the transmission error, ``share`` of its peak to peak."""

    def change(name, values, time):
        if name != "dte":
            return values
        wave = np.cos(2.0 * np.pi * order * time / pair.geometry.mesh_period)
        return values + share * np.ptp(values) * wave

    return sampled(pair, QUANTITIES, change=change, cycles=16)


def test_the_peak_to_peak_of_a_model_is_that_of_its_samples(pair):
    curves = with_wave(pair, 17.0, 0.3)
    result = check(pair, curves, explain=False)
    (row,) = [one for one in result.problem.misfit.channels if one.channel.channel.name == "dte"]
    used = result.problem.settled.used
    peaks = peaks_to_peak(result.problem, row)
    assert peaks.theirs == np.ptp(curves.channels[0].values[used])
    # The wave is above the orders, whose peak to peak is too small.
    assert peaks.theirs > 1.3 * row.channel.orders.peak_to_peak
    right = check(pair, sampled(pair, QUANTITIES), explain=False)
    (row,) = [one for one in right.problem.misfit.channels if one.channel.channel.name == "dte"]
    same = peaks_to_peak(right.problem, row)
    assert same.theirs == pytest.approx(same.ours, rel=2e-3)  # ours is read linearly between its samples
    samples = samples_of(right.problem, row.channel.channel)
    assert samples.ours == pytest.approx(samples.theirs, abs=5e-3 * same.ours)
    table = right.channels.sel(channel="dte")
    assert float(table["their_peak_to_peak"]) == same.theirs


@pytest.mark.parametrize("order", [17.0, 3.5])  # above the compared orders, and between two of them
def test_a_difference_at_no_compared_order_is_said(pair, order):
    result = check(pair, with_wave(pair, order, 0.1), explain=False)
    (row,) = [one for one in result.problem.misfit.channels if one.channel.channel.name == "dte"]
    expected = 0.1 * np.ptp(sampled(pair, QUANTITIES).channels[0].values) / row.scale
    assert difference_at_no_order(result.problem, row) == pytest.approx(expected, rel=0.1)
    assert result.agrees, result.words
    (remark,) = [one for one in result.remarks if "none of the compared mesh orders" in one]
    assert "dte by" in remark
    assert "y_g" not in remark


def test_values_with_few_digits_are_said(pair):
    def rounded(name, values, time):
        if name != "dte":
            return values
        step = np.ptp(values) / 12.0
        return np.round(values / step) * step

    curves = sampled(pair, QUANTITIES, change=rounded)
    (remark,) = [one for one in check(pair, curves, explain=False).remarks if "in steps of" in one]
    assert remark.startswith("dte is written in steps of ")
    assert "8.3" in remark or "9.1" in remark  # 12 steps, or 11 where both ends are rounded inwards
    assert not [one for one in check(pair, sampled(pair, QUANTITIES)).remarks if "in steps of" in one]


def test_a_difference_of_the_orders_is_none_of_the_rest(pair):
    def larger(name, values, time):
        mean = values.mean()
        return mean + 1.2 * (values - mean)

    result = check(pair, sampled(pair, ("dte",), change=larger, cycles=16), explain=False)
    (row,) = result.problem.misfit.channels
    assert row.total == pytest.approx(0.2 / 1.2, abs=0.02)
    right = check(pair, sampled(pair, ("dte",), cycles=16), explain=False).problem
    samples = samples_of(right, right.misfit.channels[0].channel.channel)
    orders = np.arange(1.0, 13.0)
    fitted = complex_orders(samples.cycles, samples.theirs, orders)
    rest = samples.theirs - fitted.mean - fitted.at(samples.cycles)
    # A fifth of what our own motion has above the orders.
    expected = 0.2 * np.sqrt(2.0 * np.mean(rest**2)) / row.scale
    assert difference_at_no_order(result.problem, row) == pytest.approx(expected, rel=0.2, abs=5e-3)


def test_a_model_that_differs_is_told_so_once(pair):
    def louder(name, values, time):
        wave = np.cos(34.0 * np.pi * time / pair.geometry.mesh_period)
        mean = values.mean()
        return mean + 1.5 * (values - mean) + 0.3 * np.ptp(values) * wave

    result = check(pair, sampled(pair, ("dte",), change=louder, cycles=16), explain=False)
    assert not result.agrees
    assert not [one for one in result.remarks if "none of the compared mesh orders" in one]


def test_noise_and_motions_that_agree_say_nothing(pair):
    for noise in (0.0, 0.01, 0.04):
        result = check(pair, sampled(pair, QUANTITIES, noise=noise, cycles=16))
        assert not [one for one in result.remarks if "none of the compared mesh orders" in one]


def test_jumps_at_few_samples_are_no_typical_difference(pair):
    """Every fortieth sample is wrong by half the peak to peak: much in the mean, little elsewhere."""

    def jumps(name, values, time):
        return values + 0.5 * np.ptp(values) * (np.arange(values.size) % 40 == 0)

    problem = check(pair, sampled(pair, ("dte",), change=jumps, cycles=16), explain=False).problem
    (row,) = problem.misfit.channels
    assert difference_at_no_order(problem, row, typical=True) < 0.2 * difference_at_no_order(problem, row)
