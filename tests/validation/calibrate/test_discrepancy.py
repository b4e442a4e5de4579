"""The covariance of the discrepancy: its size by order and channel, and what records share."""

import numpy as np
import pytest

from tests.validation.calibrate.rig import TRUTH, rig_pair, rig_record
from validation.calibrate.discrepancy import discrepancy_covariance, noise_covariance
from validation.calibrate.measured import measured_records


@pytest.fixture(scope="module")
def records():
    truth = rig_pair().with_(TRUTH)
    return measured_records(
        rig_pair(),
        [rig_record(truth, quantities=("dte", "bearing_force_x_p")), rig_record(truth, rpm=2900.0, seed=2)],
    )


def test_each_part_has_the_variance_of_largest_and_own_order(records):
    diagonal = np.diag(discrepancy_covariance(records))
    start = 0
    for record in records:
        for channel in record.channels:
            sizes = channel.orders.amplitudes
            expected = 0.5 * (sizes.max() ** 2 + sizes**2)
            np.testing.assert_allclose(diagonal[start : start + sizes.size], expected, rtol=1e-12)
            np.testing.assert_allclose(
                diagonal[start + sizes.size : start + 2 * sizes.size], expected, rtol=1e-12
            )
            start += 2 * sizes.size
    assert start == diagonal.size


def test_half_of_it_is_common_to_records_of_a_quantity_in_their_own_phase(records):
    covariance = discrepancy_covariance(records)
    first = records[0].channels[0].orders.values
    count = first.size
    second_start = sum(2 * one.orders.orders.size for one in records[0].channels)
    second = records[1].channels[0].orders.values
    for j in range(count):
        rows = [j, j + count]
        columns = [second_start + j, second_start + j + second.size]
        block = covariance[np.ix_(rows, columns)]
        # A common relative error c moves both orders by c V: the covariance turns by the difference of phase.
        size = 0.5 * np.sqrt(covariance[rows[0], rows[0]] * covariance[columns[0], columns[0]])
        turn = np.angle(first[j] * np.conj(second[j]))
        expected = size * np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        np.testing.assert_allclose(block, expected, rtol=1e-9, atol=1e-9 * size)
    # The bearing force of the first record shares nothing with the transmission error of either.
    force = slice(2 * count, second_start)
    assert not covariance[force, : 2 * count].any()
    assert not covariance[force, second_start:].any()


def test_it_is_positive_definite_with_the_noise(records):
    covariance = noise_covariance(records) + discrepancy_covariance(records)
    scale = np.sqrt(np.diag(covariance))
    assert np.linalg.eigvalsh(covariance / np.outer(scale, scale)).min() > 1e-6


def test_noise_of_each_order_is_that_of_white_noise(records):
    # Amplitudes of n samples with white noise s have the standard deviation s sqrt(2/n) in each part.
    channel = records[0].channels[0]
    samples = channel.channel.values.size
    noise = 0.03 * np.ptp(channel.channel.values)
    found = np.sqrt(np.diag(channel.orders.covariance))
    # The scatter of 60 cycles knows a standard deviation to about 1/sqrt(120), so 12 values to 30 %.
    np.testing.assert_allclose(found, noise * np.sqrt(2.0 / samples), rtol=0.4)
