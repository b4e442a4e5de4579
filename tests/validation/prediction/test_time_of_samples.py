"""Does a limit of time end the samples where it says, and what is left of them?"""

import math
from dataclasses import replace

import numpy as np
import pytest

from floquet.orbits import deadline
from lumped.errors import ParameterError
from tests.unlike_pairs import known_sizes, unlike_pair
from validation.prediction import compare as compare_module
from validation.prediction import uncertainty as module
from validation.prediction.compare import compare
from validation.prediction.sobol import sobol_points
from validation.prediction.uncertainty import (
    FLAGS,
    least_samples,
    sampled_predictions,
    speed_band,
    teeth_band,
    uncertainty,
)

from .test_compare import GREATER, TORQUE
from .test_uncertainty import LINEAR

#: Four inputs, each with two ends.
FOUR = LINEAR.with_({
    "uncertainty": {
        "operating.pinion_torque": "+- 4 %", "mesh.damping_ratio": "+- 20 %",
        "bearings.gear.loa_stiffness": "/ 2 .. * 2", "bearings.pinion.loa_stiffness": "/ 2 .. * 2",
    }
})  # fmt: skip


class Clock:
    """Processor time that runs by 7 s in each prediction, and in nothing else."""

    def __init__(self, monkeypatch, where, name="_numbers"):
        self.now = 1000.0
        function = getattr(where, name)

        def slow(*arguments, **options):
            self.now += 7.0
            return function(*arguments, **options)

        monkeypatch.setattr(where, name, slow)
        monkeypatch.setattr(deadline.time, "process_time", lambda: self.now)


def test_samples_end_with_the_time_and_are_the_first_of_all(monkeypatch):
    """Of 300 s the result as given takes 7, two ends 14: samples begin at 21, 28, ..., 294."""
    every = uncertainty(LINEAR, 64, seed=3)
    assert (every.attrs["taken"], every.attrs["alone"], every.attrs["seconds"]) == (64, 1, math.inf)
    Clock(monkeypatch, module)
    ranges = uncertainty(LINEAR, 64, seed=3, seconds=300.0)
    assert {name: ranges.attrs[name] for name in ("taken", "asked", "refused", "alone", "seconds")} == {
        "taken": 40, "asked": 64, "refused": 0, "alone": 1, "seconds": 300.0,
    }  # fmt: skip
    np.testing.assert_array_equal(ranges["dte_peak_to_peak"], every["dte_peak_to_peak"][:40])
    # Proportional to the torque: percentiles at their shares of +- 4 %, to the unevenness of 40 points.
    as_given = ranges.attrs["given_dte_peak_to_peak"]
    expected = as_given * (1.0 + 0.04 * (2.0 * np.array([0.05, 0.5, 0.95]) - 1.0))
    np.testing.assert_allclose(ranges["dte_peak_to_peak_percentile"], expected, rtol=2.0 * 0.08 / 40)
    assert ranges["dte_peak_to_peak_form"].isnull().all()  # no time was left for other forms
    assert every["dte_peak_to_peak_form"].notnull().any()


def test_first_points_fill_the_space_more_evenly_than_random_ones():
    """Any number of the first Sobol points: the largest gap between sorted values of each input.

    Of n random values it is about ln(n)/n; of Sobol points at most 2/2^k, 2^k the power of two below n, and
    the end of an interval adds one.
    """
    points = sobol_points(np.zeros(12), 128, 1)
    for count in (33, 47, 90):
        gaps = np.diff(np.sort(points[:count], axis=0), axis=0, prepend=0.0, append=1.0)
        assert gaps.max() <= 2.0 / 2 ** int(math.log2(count)) < math.log(count) / count


def test_too_few_samples_make_no_range(monkeypatch):
    """Of 100 s: 7 + 14, then samples at 21, ..., 98: 12 of them, and 32 are a range."""
    Clock(monkeypatch, module)
    ranges = uncertainty(LINEAR, 64, seed=3, seconds=100.0)
    assert (ranges.attrs["taken"], ranges.sizes["sample"]) == (12, 12)
    for name in ("dte_peak_to_peak_percentile", "dte_peak_to_peak_interval", "efficiency_rank_correlation"):
        assert ranges[name].isnull().all()
    assert ranges["dte_peak_to_peak_swing"].notnull().all()
    assert [least_samples(samples) for samples in (16, 48, 64, 128, 4096)] == [8, 24, 32, 32, 32]


def test_inputs_alone_take_a_third_of_the_time(monkeypatch):
    """Of 97 s: 7 as given, then a third of 90: the third input begins at 28 of 30 s, the fourth does not."""
    Clock(monkeypatch, module)
    ranges = uncertainty(FOUR, 16, seconds=97.0)
    assert (ranges.attrs["alone"], ranges.sizes["input"]) == (3, 4)
    computed = ranges["dte_peak_to_peak_swing"].notnull().all("end").to_numpy()
    assert computed.tolist() == [True, True, True, False]
    assert ranges.attrs["taken"] == math.ceil((97 - 7 - 42) / 7)
    assert ranges["value"].notnull().all()  # the samples move all inputs


def test_no_time_at_all_gives_the_result_as_given():
    ranges = uncertainty(FOUR, 128, seconds=1e-9)
    assert (ranges.attrs["taken"], ranges.attrs["alone"], ranges.sizes["sample"]) == (0, 0, 0)
    assert ranges.attrs["given_dte_peak_to_peak"] > 0.0
    assert ranges["dte_peak_to_peak_percentile"].isnull().all()
    with pytest.raises(ParameterError, match="seconds"):
        uncertainty(FOUR, 128, seconds=0.0)


def test_samples_without_a_motion_of_their_own_are_counted(monkeypatch):
    """Every third has no prediction, every second the linear one."""
    count = [0]
    predict = module.predicted
    every_sample = uncertainty(LINEAR, 16)
    assert FLAGS[-1] == "linear"
    assert every_sample.attrs["linear"] == every_sample.attrs["refused"] == 0

    def third(pair):
        count[0] += 1
        if count[0] > 3 and count[0] % 3 == 0:  # after the inputs as given, and both ends
            raise module.NumericalError("no motion")
        motion = module.Motion.LINEAR if count[0] % 2 else module.Motion.UNILATERAL
        return replace(predict(pair), motion=motion)

    monkeypatch.setattr(module, "predicted", third)
    ranges = uncertainty(LINEAR, 16)
    numbers = range(4, 20)
    assert ranges.attrs["refused"] == sum(k % 3 == 0 for k in numbers)
    assert ranges.attrs["linear"] == sum(k % 3 != 0 and k % 2 == 1 for k in numbers)
    assert ranges.attrs["contact_lost"] == ranges.attrs["lost_or_unstable"] == 0


def test_ranges_of_few_samples_end_with_the_time_too():
    ranges = uncertainty(LINEAR, 16)
    band = speed_band(LINEAR, np.array([700.0, 900.0]), ranges, 16, seconds=1e-9)
    assert (band.attrs["samples"], band.attrs["taken"], band.attrs["asked"]) == (0, 0, 16)
    assert band["low"].isnull().all()
    assert band["high"].isnull().all()
    differ = LINEAR.with_({"pinion.deviations": {"tolerance_class": 6}})
    teeth = teeth_band(differ, ranges, seconds=1e-9)
    assert teeth["sideband_ratio"].isnull().all()
    assert teeth.attrs["taken"] == 0 < teeth.attrs["asked"]
    varied = sampled_predictions(LINEAR, ranges, 16, seconds=1e-9)
    assert (varied.samples, varied.taken, varied.asked) == ((), 0, 16)


def test_machines_of_a_comparison_end_with_the_time_but_not_before_32(monkeypatch):
    """Of 602 s two variants as given take 14, two ends 14: machines of 14 s begin until 588."""
    Clock(monkeypatch, compare_module)
    comparison = compare(TORQUE, GREATER, samples=64, seconds=602.0)
    assert (comparison.attrs["taken"], comparison.attrs["asked"], comparison.sizes["sample"]) == (41, 64, 41)
    few = compare(TORQUE, GREATER, samples=64, seconds=1.0)
    assert (few.attrs["taken"], few.sizes["sample"]) == (32, 32)
    np.testing.assert_array_equal(few["dte_peak_to_peak"], comparison["dte_peak_to_peak"][:, :32])


def test_a_pair_that_loses_contact_has_its_slow_samples_in_the_range(monkeypatch):
    """The sample in which the time ends is kept though it is the slow one."""
    pair = known_sizes(unlike_pair("larger_gear_drives_contact_lost")).with_(
        {"assumed": {}, "uncertainty": {"mesh.damping_ratio": "/ 2 .. * 2"}}
    )
    Clock(monkeypatch, module)
    ranges = uncertainty(pair, 16, seconds=24.0)  # 21 s before the first sample
    assert ranges.sizes["sample"] == 1
    assert ranges.attrs["contact_lost"] == 1
