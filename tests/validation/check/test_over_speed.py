"""Are values over speed compared with the motion at each speed, in the units of the columns?"""

import numpy as np
import pytest

import lumped
import spurcheck
from lumped.errors import NumericalError, ParameterError
from tests.unlike_pairs import unlike_pair
from tests.validation.check.written_check import FACTORS, SPEEDS, checked, pair, values_over_speed
from validation.check import over_speed
from validation.check.check import Rung, Verdict, check
from validation.check.curves import SpeedColumn, ValuesOverSpeed
from validation.check.words import percent

#: Torque [N m] of the values, which is not that of the file.
TORQUE = 160.0


def motion(one, rpm, torque=None):
    changed = one.with_(speed=rpm) if torque is None else one.with_(speed=rpm, torque=torque)
    return lumped.steady_state(changed, contact="unilateral")


@pytest.fixture(scope="module")
def table():
    """Every statistic, columns in units of a user, at two speeds and another torque."""
    rows = [motion(pair(), rpm, TORQUE) for rpm in SPEEDS[:2]]
    dte = [row["dte"].to_numpy() for row in rows]
    bearing = [row["bearing_force_x_g"].to_numpy() for row in rows]
    third = [2.0 * abs(np.fft.rfft(values)[3]) / values.size for values in dte]
    return {
        "speed [rpm]": np.array(SPEEDS[:2]),
        "pinion_torque": f"{TORQUE} N*m",
        "dte peak-to-peak [um]": 1e6 * np.array([np.ptp(values) for values in dte]),
        "dte order 3 [um]": 1e6 * np.array(third),
        "bearing_force_x_g mean [kN]": 1e-3 * np.array([values.mean() for values in bearing]),
        "bearing_force_x_g rms [N]": np.array([values.std() for values in bearing]),
    }


def test_the_right_values_agree_in_every_statistic_and_unit(table):
    result = check(pair(), table)
    assert result.verdict is Verdict.AGREES
    assert result.misfit < 1e-3
    statistics = [column.statistic for column in result.over_speed.theirs.columns]
    assert statistics == ["peak_to_peak", "order", "mean", "rms"]
    assert result.over_speed.theirs.pinion_torque == TORQUE
    assert str(result) == f"Your model agrees: misfit {percent(result.misfit)}, limit 5 %."


@pytest.mark.parametrize("column", [
    "dte peak-to-peak [um]", "dte order 3 [um]", "bearing_force_x_g mean [kN]", "bearing_force_x_g rms [N]",
])  # fmt: skip
def test_a_column_that_is_a_fifth_too_large_differs_alone(table, column):
    result = check(pair(), table | {column: 1.2 * np.asarray(table[column])})
    assert result.failed is Rung.OVER_SPEED
    by_column = result.over_speed.table["misfit"].to_series()
    place = list(table).index(column) - 2
    # rms(0.2 v)/rms(1.2 v)
    assert by_column.iloc[place] == pytest.approx(1.0 / 6.0, rel=1e-3)
    assert by_column.drop(by_column.index[place]).max() < 1e-3
    assert result.misfit == pytest.approx(1.0 / 12.0, rel=1e-3)  # over four columns


def test_the_torque_of_the_values_counts(table):
    without = {name: values for name, values in table.items() if name != "pinion_torque"}
    assert check(pair(), without).verdict is Verdict.DIFFERS


def test_the_speed_with_the_largest_difference_is_named():
    result = checked("over_speed")
    assert result.over_speed.worst_speed * 30.0 / np.pi == pytest.approx(SPEEDS[int(np.argmax(FACTORS))])
    assert "The largest difference is at 1100 rpm." in result.words
    assert result.explanations == ()


def test_ours_are_the_motions_at_these_speeds():
    table = checked("over_speed").over_speed.table
    expected = [np.ptp(motion(pair(), rpm)["dte"].to_numpy()) for rpm in SPEEDS]
    np.testing.assert_allclose(table["ours_over_speed"].to_numpy()[0], expected, rtol=1e-9)
    np.testing.assert_allclose(table["speed"], SPEEDS, rtol=1e-12)


def test_a_speed_without_a_motion_is_left_out_and_none_at_all_is_an_error(monkeypatch):
    real = over_speed.lumped_motion

    def fails_at(speeds):
        def motion(one):
            if round(one.operating.pinion_speed * 30.0 / np.pi) in speeds:
                raise NumericalError("no motion")
            return real(one)

        monkeypatch.setattr(over_speed, "lumped_motion", motion)

    fails_at({round(SPEEDS[1])})
    result = over_speed.speed_misfit(values_over_speed(), pair())
    assert np.isnan(result.ours[:, 1]).all()
    assert np.isfinite(result.ours[:, [0, 2]]).all()
    # The speed at which theirs is 30 % too large is not compared.
    assert result.value < 0.02
    assert result.worst_speed * 30.0 / np.pi == pytest.approx(SPEEDS[2])
    fails_at(set(map(round, SPEEDS)))
    with pytest.raises(NumericalError, match="at any of these speeds"):
        over_speed.speed_misfit(values_over_speed(), pair())


def test_progress_is_told_and_the_figure_shows_both():
    shares = []
    over_speed.speed_misfit(values_over_speed(), pair(), shares.append)
    assert shares == pytest.approx([1 / 3, 2 / 3, 1.0])
    figure = checked("over_speed").plot()
    first, second = figure.axes
    theirs, ours = first.lines
    np.testing.assert_allclose(theirs.get_xdata(), SPEEDS, rtol=1e-12)
    np.testing.assert_allclose(theirs.get_ydata() / ours.get_ydata(), FACTORS, rtol=1e-6)
    assert first.get_ylabel() == "TE pp [µm]"
    assert second.get_xlabel() == "pinion speed [rpm]"


@pytest.mark.parametrize("column", [
    SpeedColumn("N", "normal_load", "rms", np.ones(2)),
    SpeedColumn("half", "dte", "order", np.ones(2), 0.5),
])  # fmt: skip
def test_values_that_no_motion_has_are_refused(column):
    values = ValuesOverSpeed("run-up", np.array([90.0, 140.0]), (column,))
    with pytest.raises(ParameterError) as refusal:
        check(pair(), values)
    assert refusal.value.problems[0].field == f"column {column.name}"


def test_a_pair_whose_contact_is_lost_has_values_over_speed_too():
    one = unlike_pair("larger_gear_drives_contact_lost")
    rpm = one.operating.pinion_speed * 30.0 / np.pi
    peaks = [float(np.ptp(motion(one, factor * rpm)["dte"].to_numpy())) for factor in (0.9, 1.0)]
    table = {"speed [rpm]": [0.9 * rpm, rpm], "dte peak to peak [m]": peaks}
    assert spurcheck.check(one, table).misfit < 0.01
