"""What a calibration says about inputs whose truth is known, and how its width follows noise and records."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import ndtr

from tests.validation.calibrate.rig import RANGES, TRUTH, rig_pair, rig_record
from validation.calibrate import calibrate
from validation.calibrate.measured import measured_records
from validation.calibrate.mixture import moments
from validation.prediction.motion import predicted

OFF_LINE = "bearings.pinion.oloa_damping_ratio"


def _widths(posterior):
    """Standard deviation of each normal score."""
    return np.sqrt(np.diag(moments(posterior.components)[1]))


def _deviations_off(posterior, truth):
    """Distance of the truth from the mean of each input, in standard deviations."""
    mean, covariance = moments(posterior.components)
    rows = []
    for j, one in enumerate(posterior.inputs):
        grid = np.linspace(-3.0, 3.0, 6001)
        values = np.array([one.parts[0].at(float(share)) for share in ndtr(grid)])
        score = grid[np.abs(values - truth[one.field]).argmin()]
        rows.append((mean[j] - score) / np.sqrt(covariance[j, j]))
    return np.array(rows)


def _truth_in_file_units():
    return TRUTH | {"bearings.gear.loa_stiffness": 2.6e8, OFF_LINE: 0.05}


def test_truth_lies_in_the_posterior(one_run, exact):
    for posterior in (one_run, exact):
        # Four inputs: a normal number beyond 3 has a probability of 0.003.
        assert np.abs(_deviations_off(posterior, _truth_in_file_units())).max() < 3.0


def test_results_of_the_truth_lie_in_the_ranges(one_run, truth):
    numbers = predicted(truth).numbers
    for name in ("dte_peak_to_peak", "dynamic_factor", "bearing_rms"):
        low, _, high = one_run.results[f"{name}_percentile"].to_numpy()
        # A range from 5 to 95 % of 32 machines, and as much again on both sides.
        assert low - (high - low) < numbers[name] < high + (high - low)


def test_the_record_narrows_the_range_of_the_transmission_error(one_run):
    # Without the error of the model, which the range before the record does not have either.
    sizes = [one["dte_peak_to_peak"] for one in one_run.machines.numbers[1:]]
    low, high = np.percentile(sizes, [5.0, 95.0])
    prior = []
    for share in (0.05, 0.95):  # the stiffness alone at its ends
        factor = one_run.inputs[[i.field for i in one_run.inputs].index("mesh.stiffness_factor")].at(share)
        prior.append(predicted(rig_pair().with_({"mesh.stiffness_factor": factor})).peak_to_peak)
    assert high - low < abs(prior[1] - prior[0])


def test_what_the_record_cannot_know_is_listed(one_run):
    # Transmission error of a mesh without lost contact: nothing moves off the line of action but by friction.
    assert OFF_LINE in one_run.not_identified
    assert OFF_LINE not in one_run.identified
    assert "mesh.stiffness_factor" in one_run.identified
    assert any(OFF_LINE in sentence for sentence in one_run.sentences)


def test_assumed_backlash_is_listed():
    pair = rig_pair()
    assumed = pair.to_mapping() | {"assumed": {"mesh.backlash": 0.115}, "uncertainty": {}}
    from lumped import load_gear_pair
    from validation.calibrate.posterior import Posterior

    posterior = Posterior(load_gear_pair(assumed), (), (), (), None, True)
    object.__setattr__(posterior, "shares", {})
    assert posterior.not_identified == ("mesh.backlash",)
    known = Posterior(pair, (), (), (), None, True)
    object.__setattr__(known, "shares", {})
    assert known.not_identified == ()


def _with_strange_order(record, truth, order, size):
    """The record with an order that the model cannot have; ``size`` over the peak to peak."""
    channel = record.channels[0]
    cycles = record.places / truth.geometry.mesh_period
    strange = size * np.ptp(channel.values) * np.cos(2.0 * np.pi * order * cycles)
    return replace(record, channels=(replace(channel, values=channel.values + strange),))


@pytest.fixture(scope="module")
def wrong_model(truth):
    """A record that no inputs explain, calibrated with a discrepancy and without."""
    record = _with_strange_order(rig_record(truth), truth, 5.0, 0.12)
    return [calibrate(rig_pair(), record, allowed, machines=16, progress=False) for allowed in (True, False)]


def test_without_a_discrepancy_the_posterior_of_a_wrong_model_is_narrower(wrong_model):
    wide, narrow = wrong_model
    known = [one.field for one in wide.inputs].index("mesh.stiffness_factor")
    assert _widths(narrow)[known] < 0.7 * _widths(wide)[known]
    assert wide.level > 0.05
    assert narrow.level == 0.0
    assert any("too narrow" in one for one in narrow.sentences)
    assert not any("too narrow" in one for one in wide.sentences)


def test_an_order_that_no_input_explains_is_printed(wrong_model):
    unexplained = wrong_model[0].unexplained
    assert unexplained[0].place == "order 5"
    assert unexplained[0].words in wrong_model[0].sentences


def test_twice_the_noise_is_twice_the_width(truth):
    # Noise far above the floor of the numerics, and a width far below the prior's.
    widths = [
        _widths(
            calibrate(rig_pair(), rig_record(truth, noise=noise, seed=3), False, machines=16, progress=False)
        )
        for noise in (0.04, 0.08)
    ]
    best = int(widths[0].argmin())
    # The noise of each order is known to 10 % from 60 cycles, and the prior takes some of the width.
    assert widths[1][best] / widths[0][best] == pytest.approx(2.0, rel=0.25)


def test_another_record_never_widens(truth, exact):
    both = calibrate(
        rig_pair(), [rig_record(truth), rig_record(truth, rpm=2900.0, seed=2)], False, machines=16,
        progress=False,
    )  # fmt: skip
    # Slopes at two nearly equal minima differ by a few per cent.
    assert (_widths(both) <= 1.05 * _widths(exact)).all()
    assert _widths(both).min() < _widths(exact).min()


def test_form_of_a_record_does_not_matter(truth, exact):
    record = rig_record(truth)
    mapping = _mapping({"time [ms]": 1e3 * record.places, "dte [um]": 1e6 * record.channels[0].values})
    again = calibrate(rig_pair(), mapping, False, machines=16, progress=False)
    np.testing.assert_allclose(_widths(again), _widths(exact), rtol=1e-5)


def _mapping(columns):
    operating = {"pinion_speed": "1450 rpm", "pinion_torque": "80 N*m"}
    return {"name": "table", "role": "measurement"} | operating | columns


@pytest.fixture(scope="module")
def three_channels(truth):
    return rig_record(truth, quantities=("dte", "theta_p", "bearing_force_x_p"))


#: Headings of a table, and how much of the unit is in the SI unit.
UNITS = {
    "SI": ("time [s]", 1.0, "dte [m]", 1.0, "theta_p [rad]", 1.0, "bearing_force_x_p [N]", 1.0),
    "small": ("time [ms]", 1e3, "dte [um]", 1e6, "theta_p [mrad]", 1e3, "bearing_force_x_p [kN]", 1e-3),
    "degrees": (
        "time [us]", 1e6, "dte [mm]", 1e3, "theta_p [deg]", 180.0 / np.pi, "bearing_force_x_p [lbf]",
        1.0 / 4.4482216152605,
    ),
}  # fmt: skip


@pytest.mark.parametrize("units", UNITS)
def test_unit_of_a_record_does_not_matter(three_channels, units):
    expected = measured_records(rig_pair(), [three_channels])[0].values
    curves = [three_channels.places, *(channel.values for channel in three_channels.channels)]
    headings = UNITS[units]
    columns = {
        name: factor * values
        for name, factor, values in zip(headings[::2], headings[1::2], curves, strict=True)
    }
    found = measured_records(rig_pair(), [_mapping(columns)])[0].values
    # A table states its times with rounding, so phases differ by 1e-9 of a cycle.
    for part in np.split(np.arange(expected.size), 3):
        size = np.abs(expected[part]).max()
        np.testing.assert_allclose(found[part], expected[part], atol=1e-6 * size, rtol=0.0)


@pytest.mark.parametrize(("unit", "turn"), [("deg", 360.0), ("rad", 2.0 * np.pi)])
def test_angle_of_the_pinion_in_degrees_and_radians(truth, exact, unit, turn):
    record = rig_record(truth)
    cycles = record.places / truth.geometry.mesh_period
    angle = turn * cycles / truth.pinion.teeth
    mapping = _mapping({f"pinion_angle [{unit}]": angle, "dte [um]": 1e6 * record.channels[0].values})
    found = measured_records(rig_pair(), [mapping])[0].values
    expected = exact.records[0].values
    np.testing.assert_allclose(found, expected, atol=1e-6 * np.abs(expected).max(), rtol=0.0)


def test_a_second_channel_tells_more(truth, exact):
    record = rig_record(truth, quantities=("dte", "bearing_force_x_g"))
    both = calibrate(rig_pair(), record, False, machines=16, progress=False)
    name = [one.field for one in both.inputs].index("bearings.gear.loa_stiffness")
    # The force of a bearing is its stiffness times its displacement; the transmission error has sums.
    assert _widths(both)[name] < 0.8 * _widths(exact)[name]
    assert (_widths(both) <= 1.05 * _widths(exact)).all()


def test_the_slopes_are_those_of_the_minimum(one_run):
    from validation.calibrate.fit import Fit

    one = one_run.components[0].minimum
    count = one.motions.values.size
    fit = Fit(rig_pair(), one_run.inputs, one_run.records, np.eye(count))
    motions = fit.motions(one.z)
    np.testing.assert_allclose(motions.values, one.motions.values, rtol=1e-9, atol=1e-15)
    fresh = fit.slopes(one.z, motions)
    np.testing.assert_allclose(fresh, one.slopes, rtol=1e-6, atol=1e-6 * np.abs(fresh).max())


def test_each_slope_is_that_of_the_motions(one_run):
    from validation.calibrate.fit import Fit

    one = one_run.components[0].minimum
    fit = Fit(rig_pair(), one_run.inputs, one_run.records, np.eye(one.motions.values.size))
    largest = np.linalg.norm(one.slopes, axis=0).max()
    for j in range(one.z.size):
        off = []
        for step in (-0.1, 0.1):
            moved = one.z.copy()
            moved[j] += step
            side = (fit.motions(moved).values - one.motions.values) / step
            off.append(np.linalg.norm(one.slopes[:, j] - side))
        # Differences towards the middle of the range: one of the two sides.
        assert min(off) < 1e-6 * largest, one_run.inputs[j].field


def test_the_inputs_are_those_of_the_file(one_run):
    assert {one.field for one in one_run.inputs} == set(RANGES)
    assert list(one_run.table["input"].to_numpy()) == [one.field for one in one_run.inputs]
    before = one_run.table["before"].sel(input="mesh.stiffness_factor").to_numpy()
    np.testing.assert_allclose(before, [0.91, 1.0, 1.09], rtol=1e-9)  # 5, 50, 95 % of 0.9 to 1.1
