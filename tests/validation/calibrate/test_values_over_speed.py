"""A sweep of values over speed as a record: what it tells, and which sweeps are refused."""

from dataclasses import replace

import numpy as np
import pytest

import spurcheck
from lumped.errors import ParameterError
from lumped.fields.units import to_stated
from tests.validation.calibrate.rig import TRUTH, rig_pair, rig_record
from validation.calibrate import calibrate
from validation.calibrate.data import first_channel
from validation.calibrate.discrepancy import discrepancy_covariance, noise_covariance
from validation.calibrate.fit import Fit
from validation.calibrate.measured import measured_records
from validation.calibrate.mixture import moments
from validation.calibrate.values_at_speed import MOST_SPEEDS, NOISE
from validation.check.curves import SpeedColumn, ValuesOverSpeed

SPEEDS = (1450.0, 1900.0, 2300.0, 2900.0)
STIFFNESS = "mesh.stiffness_factor"


def _sweep(truth, columns=(("dte", "peak_to_peak", 0.0),), speeds=SPEEDS, noise=0.01, seed=1, name="sweep"):
    """Values of the motion that ``spurcheck.predict`` gives, with noise as a share of each value."""
    random = np.random.default_rng(seed)
    rows = []
    for rpm in speeds:
        motion = spurcheck.predict(truth.with_({"operating.pinion_speed": rpm}))
        curves = {"dte": motion.transmission_error, "bearing_force_x_p": motion.cycle["bearing_force_x_p"]}
        row = []
        for quantity, statistic, order in columns:
            values = curves[quantity].to_numpy()
            spectrum = 2.0 * np.abs(np.fft.rfft(values)) / values.size
            cycles = motion.mesh_cycles
            of = {
                "peak_to_peak": np.ptp(values),
                "rms": values.std(),
                "order": spectrum[int(order) * cycles],
            }
            row.append(of[statistic] * (1.0 + noise * random.standard_normal()))
        rows.append(row)
    found = [
        SpeedColumn(f"{quantity} {statistic}", quantity, statistic, np.array(values), order)
        for (quantity, statistic, order), values in zip(columns, np.transpose(rows), strict=True)
    ]
    return ValuesOverSpeed(
        name, np.array(speeds) * np.pi / 30.0, tuple(found), role="measurement", pinion_torque=80.0
    )


@pytest.fixture(scope="module")
def sweep(truth):
    return _sweep(truth)


@pytest.fixture(scope="module")
def posterior(sweep):
    return calibrate(rig_pair(), sweep, False, machines=32, progress=False)


def _scores(posterior):
    mean, covariance = moments(posterior.components)
    return dict(
        zip(
            [one.field for one in posterior.inputs],
            zip(mean, np.sqrt(np.diag(covariance)), strict=True),
            strict=True,
        )
    )


def test_a_sweep_is_one_part_for_each_speed(sweep):
    parts = measured_records(rig_pair(), [sweep])
    rpm = [float(to_stated(one.pair.operating.pinion_speed, "rpm")) for one in parts]
    np.testing.assert_allclose(rpm, SPEEDS, rtol=1e-12)
    assert {one.words for one in parts} == {"sweep (4 speeds, 1450 to 2900 rpm, 80 N m)"}
    assert [one.values[0] for one in parts] == list(sweep.columns[0].values)


def test_speeds_and_torque_of_the_sweep_replace_those_of_the_pair(sweep):
    parts = measured_records(rig_pair(), [replace(sweep, pinion_torque=45.0)])
    assert {one.pair.operating.pinion_torque for one in parts} == {45.0}
    of_pair = measured_records(rig_pair(), [replace(sweep, pinion_torque=None)])
    assert {one.pair.operating.pinion_torque for one in of_pair} == {80.0}


def test_the_sweep_knows_the_truth(posterior):
    stiffness, width = _scores(posterior)[STIFFNESS]
    # +- 10 % from 5 to 95 % is a factor of 1.04 at the share 0.7 of a uniform range, z = 0.524.
    assert abs(stiffness - 0.524) < 3.0 * width
    assert width < 0.5  # of 1 before
    assert STIFFNESS in posterior.identified
    assert posterior.unexplained == ()
    assert "sweep (4 speeds, 1450 to 2900 rpm, 80 N m)" in posterior.sentences[0]
    assert posterior.sentences[0].count("sweep") == 1
    assert "from record sweep" in dict(posterior.pair.sources)[STIFFNESS]


def test_twice_the_stated_noise_is_twice_the_width(truth, sweep):
    widths = []
    for noise in (0.04, 0.08):  # far above the numerics of 0.5 %
        column = replace(sweep.columns[0], noise=noise * float(sweep.columns[0].values.max()))
        record = replace(sweep, columns=(column,))
        fit = _at_truth(record)
        widths.append(fit)
    assert widths[1] / widths[0] == pytest.approx(2.0, rel=0.02)


def _at_truth(record):
    """Standard deviation of the stiffness alone by the values of a record, others known, without a prior."""
    parts = measured_records(rig_pair(), [record])
    inputs = rig_pair().with_({"uncertainty": {STIFFNESS: "+- 10 %"}})
    from validation.calibrate.forms import numeric_inputs

    factor = np.linalg.cholesky(noise_covariance(parts))
    fit = Fit(rig_pair(), numeric_inputs(inputs), parts, factor)
    z = np.array([0.5])
    slopes = np.linalg.solve(factor, fit.slopes(z, fit.motions(z)))
    return float(1.0 / np.linalg.norm(slopes))


def test_noise_of_a_column_that_states_none(sweep):
    parts = measured_records(rig_pair(), [sweep])
    expected = np.diag((np.hypot(NOISE, 0.005) * sweep.columns[0].values) ** 2)
    np.testing.assert_allclose(noise_covariance(parts), expected, rtol=1e-12)


def test_an_error_of_the_model_is_common_to_half_over_the_speeds(truth):
    """The variance is v^2 of a peak to peak v, and (A^2 + v^2)/2 of an order v with the largest order A."""
    columns = (("dte", "peak_to_peak", 0.0), ("dte", "order", 1.0), ("dte", "order", 2.0))
    record = _sweep(truth, columns, SPEEDS[:2])
    parts = measured_records(rig_pair(), [record])
    found = discrepancy_covariance(parts)
    size, first, second = (one.values for one in record.columns)
    largest = np.maximum(first, second)
    expected = np.zeros((6, 6))
    sizes = (
        size,
        np.sqrt(0.5 * (largest**2 + first**2)),
        np.sqrt(0.5 * (largest**2 + second**2)),
    )
    for j, one in enumerate(sizes):
        expected[j, j], expected[3 + j, 3 + j] = one**2
        expected[j, 3 + j] = expected[3 + j, j] = 0.5 * one[0] * one[1]
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-30)


def test_a_curve_and_a_sweep_together(truth, sweep, exact):
    both = calibrate(rig_pair(), [rig_record(truth), sweep], False, machines=16, progress=False)
    assert len(words := both.table.attrs["records"]) == 2, words
    assert both.components[0].minimum.motions.by_shift.shape[1] == 1  # the curve alone has a phase
    stiffness, width = _scores(both)[STIFFNESS]
    assert abs(stiffness - 0.524) < 3.0 * width
    assert width < _scores(exact)[STIFFNESS][1]
    assert _scores(both)["mesh.damping_ratio"][1] < 0.9 * _scores(exact)["mesh.damping_ratio"][1]


def test_rms_and_orders_are_values_too(truth):
    columns = (("dte", "rms", 0.0), ("dte", "order", 1.0), ("bearing_force_x_p", "peak_to_peak", 0.0))
    parts = measured_records(rig_pair(), [_sweep(truth, columns, SPEEDS[:3], noise=0.0)])
    fit = Fit(rig_pair(), (), parts, np.eye(9))
    measured = np.concatenate([one.values for one in parts])
    at_truth = Fit(rig_pair().with_(TRUTH), (), parts, np.eye(9)).motions(np.zeros(0)).values
    # `predict` has 512 samples in a cycle: the largest value lies between two of them.
    np.testing.assert_allclose(at_truth, measured, rtol=2e-3)
    assert not np.allclose(fit.motions(np.zeros(0)).values, measured, rtol=0.05)


def test_the_search_of_a_long_sweep_starts_with_five_speeds(truth, sweep):
    speeds = np.linspace(1400.0, 3000.0, 9)
    parts = measured_records(rig_pair(), [rig_record(truth), _sweep(truth, speeds=speeds), sweep])
    fit = Fit(rig_pair(), (), parts, np.linalg.cholesky(noise_covariance(parts)))
    few = fit.with_few_speeds()
    assert [one.values[0] for one in few.records] == [
        parts[j].values[0] for j in (0, 1, 3, 5, 7, 9, 10, 11, 12, 13)
    ]
    np.testing.assert_allclose(
        few.factor @ few.factor.T, noise_covariance(few.records), rtol=1e-12, atol=1e-40
    )
    short = measured_records(rig_pair(), [sweep])
    assert Fit(rig_pair(), (), short, np.eye(4)).with_few_speeds() is None


def test_a_value_that_no_input_explains_is_printed(sweep):
    values = sweep.columns[0].values.copy()
    values[1] *= 1.6
    record = replace(sweep, columns=(replace(sweep.columns[0], values=values),))
    posterior = calibrate(rig_pair(), record, machines=16, progress=False)
    worst = posterior.unexplained[0]
    assert worst.place == "1900 rpm"
    assert worst.measured == values[1]
    assert "peak to peak at 1900 rpm" in worst.words
    assert worst.words in posterior.sentences
    assert posterior.level > 0.05


def test_the_figure_shows_the_sweep(posterior):
    channel = first_channel(posterior.records, posterior.components[0].minimum.motions.values)
    np.testing.assert_allclose(channel.places, SPEEDS, rtol=1e-12)
    np.testing.assert_allclose(channel.fitted, channel.measured, rtol=0.08)
    _, numbers = posterior.plot().axes
    assert numbers.get_xlabel() == "pinion speed [rpm]"
    assert "peak to peak" in numbers.get_ylabel()


def test_the_next_test_after_a_sweep(posterior):
    best = posterior.next_tests[0]
    assert 0.0 < best.left["bearing_rms"] < 1.0
    assert posterior.recommendation[0] in posterior.text(next_test=True).replace("\n#   ", " ")
    assert "Next test" not in posterior.text()


def _column(sweep, **changes):
    return replace(sweep, columns=(replace(sweep.columns[0], **changes),))


def _no_columns(sweep):
    return replace(sweep, columns=())


def _too_many_speeds(sweep):
    count = MOST_SPEEDS + 1
    column = replace(sweep.columns[0], values=np.full(count, 1e-6))
    return replace(sweep, speeds=np.linspace(100.0, 200.0, count), columns=(column,))


def _means(sweep):
    return _column(sweep, statistic="mean")


def _of_a_tooth_pair(sweep):
    return _column(sweep, quantity="normal_load")


def _below_its_noise(sweep):
    return _column(sweep, noise=0.3 * float(sweep.columns[0].values.min()))


def _negative(sweep):
    return _column(sweep, values=-sweep.columns[0].values)


def _micrometres_as_metres(sweep):
    return _column(sweep, values=1e6 * sweep.columns[0].values)


WRONG = {
    _no_columns: "values at one or more speeds",
    _too_many_speeds: f"at most {MOST_SPEEDS}",
    _means: "peak to peak, rms or an order",
    _of_a_tooth_pair: "quantities of the whole mesh",
    _below_its_noise: "4 times the noise",
    _negative: "> 0",
    _micrometres_as_metres: "a motion of this pair",
}


@pytest.mark.parametrize("spoil", WRONG, ids=lambda one: one.__name__)
def test_a_wrong_sweep_is_refused(sweep, spoil):
    with pytest.raises(ParameterError, match=WRONG[spoil]):
        calibrate(rig_pair(), spoil(sweep), machines=16, progress=False)


def test_the_noise_of_a_value_may_be_a_fourth_of_it(sweep):
    limit = 0.25 * float(sweep.columns[0].values.min())
    assert measured_records(rig_pair(), [_column(sweep, noise=0.999 * limit)])
    with pytest.raises(ParameterError, match="4 times the noise"):
        measured_records(rig_pair(), [_column(sweep, noise=1.001 * limit)])


def test_most_speeds_are_accepted(sweep):
    column = replace(sweep.columns[0], values=np.full(MOST_SPEEDS, 1e-6))
    record = replace(sweep, speeds=np.linspace(100.0, 200.0, MOST_SPEEDS), columns=(column,))
    assert len(measured_records(rig_pair(), [record])) == MOST_SPEEDS


def test_the_same_sweep_twice_is_refused(sweep):
    with pytest.raises(ParameterError, match="records that differ"):
        measured_records(rig_pair(), [sweep, sweep])
