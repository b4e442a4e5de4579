"""Are complex orders, their uncertainty, the common shift and the misfit those of signals that are known?"""

import numpy as np
import pytest

from lumped.errors import ParameterError
from validation.signals.complex_orders import (
    channel_scale,
    common_shift,
    complex_orders,
    misfit,
    orders_of_period,
)

#: Amplitudes of unlike orders; the second is zero.
VALUES = np.array([2.0 * np.exp(0.4j), 0.0, 0.7 * np.exp(-2.1j), 0.15 * np.exp(1.3j)])
ORDERS = np.arange(1, 5)


def signal(cycles, values=VALUES, mean=0.6):
    return mean + sum(np.real(v * np.exp(2j * np.pi * m * cycles)) for m, v in enumerate(values, 1))


def test_orders_at_any_times_are_those_of_the_signal():
    cycles = np.sort(np.random.default_rng(3).uniform(0.0, 17.3, 500))
    orders = complex_orders(cycles, signal(cycles), ORDERS)
    np.testing.assert_allclose(orders.values, VALUES, atol=1e-12)
    assert orders.mean == pytest.approx(0.6, abs=1e-12)
    np.testing.assert_allclose(orders.at(cycles) + orders.mean, signal(cycles), atol=1e-11)


@pytest.mark.parametrize("period", [1, 3])
def test_orders_of_a_period_are_those_of_the_signal(period):
    phases = np.arange(64 * period) / 64
    orders = orders_of_period(signal(phases), 4, period)
    integer = orders.orders == np.round(orders.orders)
    np.testing.assert_allclose(orders.values[integer], VALUES, atol=1e-13)
    np.testing.assert_allclose(orders.values[~integer], 0.0, atol=1e-13)
    assert orders.peak_to_peak == pytest.approx(np.ptp(signal(np.arange(20000) / 20000)), rel=1e-4)


def test_a_shift_reads_the_signal_later_and_turns_its_covariance():
    cycles = np.sort(np.random.default_rng(4).uniform(0.0, 30.0, 300))
    noise = np.random.default_rng(5).normal(size=300)
    orders = complex_orders(cycles, signal(cycles) + noise, ORDERS)
    later = orders.shifted(0.23)
    np.testing.assert_allclose(later.at(cycles), orders.at(cycles + 0.23), atol=1e-12)
    turn = np.exp(2j * np.pi * 0.23 * 3)
    turning = np.array([[turn.real, -turn.imag], [turn.imag, turn.real]])
    np.testing.assert_allclose(later.block(2), turning @ orders.block(2) @ turning.T, atol=1e-12)
    assert later.peak_to_peak_deviation == pytest.approx(orders.peak_to_peak_deviation, rel=2e-2)


@pytest.mark.parametrize("correlation", [0.0, 0.9])
def test_the_stated_deviation_is_the_scatter_of_repeated_records(correlation):
    # Noise of neighbouring samples is correlated as a filter makes it; 60 records give a deviation to 9 %.
    cycles = np.arange(1200) / 20.3
    repeated = []
    for seed in range(60):
        white = np.random.default_rng(seed).normal(size=cycles.size)
        noise = np.empty_like(white)
        noise[0] = white[0]
        for k in range(1, white.size):
            noise[k] = correlation * noise[k - 1] + np.sqrt(1.0 - correlation**2) * white[k]
        repeated.append(complex_orders(cycles, signal(cycles) + 0.2 * noise, ORDERS))
    for j in range(4):
        stated = np.sqrt(np.mean([np.trace(one.block(j)) for one in repeated]))
        scatter = np.sqrt(np.mean([abs(one.values[j] - VALUES[j]) ** 2 for one in repeated]))
        assert scatter == pytest.approx(stated, rel=0.3)
    swings = [one.peak_to_peak for one in repeated]
    stated = np.sqrt(np.mean([one.peak_to_peak_deviation**2 for one in repeated]))
    assert np.std(swings, ddof=1) == pytest.approx(stated, rel=0.3)


def test_white_noise_alone_would_understate_correlated_noise():
    # The fault that the blocks avoid: with one block the noise is taken as white.
    cycles = np.arange(1200) / 20.3
    slow = np.repeat(np.random.default_rng(1).normal(size=120), 10)
    blocks = np.zeros(cycles.size, dtype=np.int64)
    white = complex_orders(cycles, slow, ORDERS, blocks=blocks)
    orders = complex_orders(cycles, slow, ORDERS)
    assert np.trace(orders.block(0)) > 3.0 * np.trace(white.block(0))


def test_samples_that_do_not_tell_the_orders_apart_are_refused():
    cycles = np.arange(400) / 4.0  # 4 phases: orders 1 and 3 are the same there
    with pytest.raises(ParameterError, match="few phases"):
        complex_orders(cycles, signal(cycles), ORDERS)
    with pytest.raises(ParameterError, match="17 samples"):
        complex_orders(np.arange(17) / 20.3, np.zeros(17), ORDERS)


def test_one_shift_is_found_for_all_channels():
    phases = np.arange(256) / 256
    first = signal(phases)
    second = signal(phases, VALUES[::-1] * 1e3)
    both = [orders_of_period(one, 4) for one in (first, second)]
    later = [one.shifted(0.637) for one in both]
    assert common_shift(later, both, [1.0, 1e3]) == pytest.approx(0.637, abs=1e-6)
    assert common_shift(later, both, [1.0, 1e3], near=(0.6, 0.1)) == pytest.approx(0.637, abs=1e-6)


def test_the_misfit_of_the_same_of_nothing_and_of_the_wrong_sign():
    phases = np.arange(256) / 256
    one = orders_of_period(signal(phases), 4)
    nothing = orders_of_period(0.0 * phases, 4)
    reversed_ = orders_of_period(-signal(phases), 4)
    for other, expected in ((one, 0.0), (nothing, 1.0), (reversed_, 2.0)):
        assert misfit([one], [other], [one.size]) == pytest.approx(expected, abs=1e-12)
    # Of two channels one of which is wrong: the root of the mean square.
    assert misfit([one, one], [one, nothing], 2 * [one.size]) == pytest.approx(np.sqrt(0.5))


@pytest.mark.parametrize(("one", "other", "expected"), [
    (3.0, 5.0, 3.0), (0.0, 5.0, 5.0), (0.0, 0.0, 0.07), (1e-9, 1e-10, 0.07),
])  # fmt: skip
def test_a_scale_is_never_zero(one, other, expected):
    assert channel_scale(one, other, 70.0) == pytest.approx(expected)
