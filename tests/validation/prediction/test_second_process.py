"""Do two processes give the samples that one process gives, also where the second one ends early?"""

import math

import numpy as np
import pytest

from tests.unlike_pairs import unlike_pair
from validation.prediction import uncertainty as module
from validation.prediction.second_process import SampleRequest, SecondProcess
from validation.prediction.uncertainty import STEP, speed_band, uncertainty

from .test_uncertainty import LINEAR

SPEEDS = np.array([700.0, 900.0, 1300.0])
SAMPLES = 16


class Ended:
    """A second process that has ended after some samples, which took it a time [s]."""

    def __init__(self, results, seconds=0.0):
        self.results = results
        self.count = len(results)
        self.seconds = seconds

    def first(self, count):
        return self.results[:count]


@pytest.fixture(scope="module")
def known():
    return uncertainty(LINEAR, SAMPLES)


def peaks_of(sample):
    return module._peaks(sample, SPEEDS, STEP)


@pytest.mark.parametrize("count", [0, 5, 15, 16])
def test_samples_from_both_ends_are_the_samples_of_one_process_in_their_order(known, count):
    one = module._each_sample(LINEAR, known, SAMPLES, peaks_of, None)
    both = module._from_both_ends(LINEAR, known, SAMPLES, peaks_of, None, Ended(list(one.results[:count])))
    np.testing.assert_array_equal(both.results, one.results)
    assert (both.taken, both.asked) == (one.taken, one.asked) == (SAMPLES, SAMPLES)


def test_a_sample_of_the_other_process_is_not_computed_again(known):
    """Its numbers are marks: 5 samples of the other process, the last 10 of this one, 1 that it had begun."""
    marks = [np.full(SPEEDS.size, -1.0 - k) for k in range(5)]
    both = module._from_both_ends(LINEAR, known, SAMPLES, peaks_of, None, Ended(marks))
    np.testing.assert_array_equal(both.results[:5], marks)
    assert (np.array(both.results[5:]) > 0.0).all()


def test_the_processor_time_of_both_processes_counts(known):
    """The other process has used the limit: this one begins no sample."""
    marks = [np.ones(SPEEDS.size)] * 9
    both = module._from_both_ends(LINEAR, known, SAMPLES, peaks_of, 10.0, Ended(marks, seconds=10.0))
    assert (len(both.results), both.taken, both.asked) == (9, 9, SAMPLES)


@pytest.mark.parametrize("name", ["", "larger_gear_drives_contact_lost"])
def test_a_second_process_gives_the_numbers_of_this_one(name):
    pair = unlike_pair(name) if name else LINEAR
    request = SampleRequest(pair, SAMPLES, None, pair, SPEEDS, SAMPLES, STEP, None)
    second = SecondProcess()
    try:
        second.compute(request)
        there = second.uncertainty(pair, SAMPLES)
        assert second.uncertainty(pair, 2 * SAMPLES) is None  # another request
        band_of_both = speed_band(pair, SPEEDS, there, SAMPLES, STEP, None, second)
    finally:
        second.close()
    here = uncertainty(pair, SAMPLES)
    assert there.identical(here)
    assert math.isfinite(second.seconds)
    assert band_of_both.identical(speed_band(pair, SPEEDS, here, SAMPLES))


def test_where_the_second_process_ends_the_first_one_computes(known):
    request = SampleRequest(LINEAR, SAMPLES, None, LINEAR, SPEEDS, SAMPLES, STEP, None)
    second = SecondProcess()
    second.close()
    second.compute(request)
    assert second.uncertainty(LINEAR, SAMPLES) is None
    band = speed_band(LINEAR, SPEEDS, known, SAMPLES, STEP, None, second)
    assert band.identical(speed_band(LINEAR, SPEEDS, known, SAMPLES))
