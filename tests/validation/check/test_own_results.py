"""Are results of this program read back from every file, with the loads of labelled tooth pairs?"""

import numpy as np
import pytest

import lumped
from lumped.errors import ParameterError
from tests.validation.check.known_curves import PAIR
from validation.check.quantities import QUANTITIES
from validation.check.reading.reader import read
from validation.exchange import write_results

CYCLES = 5
SAMPLES = 16
pytestmark = pytest.mark.filterwarnings("ignore::lumped.errors.LawRangeWarning")


@pytest.fixture(scope="module")
def motion():
    return lumped.simulate(PAIR, cycles=CYCLES, samples_per_cycle=SAMPLES)


@pytest.fixture(scope="module")
def sweep():
    return lumped.speed_sweep(PAIR, [1500.0, 2000.0])


def test_a_result_is_read_with_its_speed_and_torque(motion):
    curves = read(motion, PAIR)
    assert curves.pinion_speed == pytest.approx(PAIR.operating.pinion_speed, rel=1e-14)
    assert curves.pinion_torque == PAIR.operating.pinion_torque
    for one in curves.channels:
        if one.tooth_pair is None:
            np.testing.assert_array_equal(one.values, motion[one.quantity])
    of_the_mesh = {name for name, one in QUANTITIES.items() if not one.of_tooth_pair} & set(motion)
    assert {one.quantity for one in curves.channels} == of_the_mesh | {"normal_load", "friction_force"}


def test_a_labelled_pair_is_followed_through_its_contact(motion):
    """Pair A is at A at t = 0, and B follows one pitch later, as the positions of the result say."""
    curves = read(motion, PAIR)
    g = PAIR.geometry
    position = motion["position"].to_numpy()
    load = motion["normal_load"].to_numpy()
    cycles = motion["time"].to_numpy() / g.mesh_period
    loads = curves.of_quantity("normal_load")
    assert curves.recurrence == len(loads) == len(load)
    np.testing.assert_array_equal(sum(one.values for one in loads), load.sum(axis=0))
    for number, one in enumerate(loads):
        assert one.tooth_pair == "ABC"[number]
        for sample in range(cycles.size):
            # Pitches from A to this pair, in the life in which it now is.
            pitches = cycles[sample] - number
            lives = [pitches - curves.recurrence * n for n in range(-2, CYCLES)]
            places = [np.abs(position[:, sample] - g.L_XA - life * g.base_pitch) for life in lives]
            nearest = min(places, key=np.min)
            assert nearest.min() < 1e-4 * g.base_pitch
            assert one.values[sample] == load[nearest.argmin(), sample]


@pytest.mark.parametrize("ending", [".csv", ".mat", ".nc"])
def test_every_file_that_is_written_is_read_back(motion, sweep, tmp_path, ending):
    direct = read(motion, PAIR)
    from_file = read(write_results(motion, tmp_path / f"motion{ending}"), PAIR)
    channels = {one.name: one for one in from_file.channels}
    assert set(channels) == {one.name for one in direct.channels}
    for one in direct.channels:
        np.testing.assert_allclose(channels[one.name].values, one.values, rtol=1e-15, err_msg=one.name)
    assert from_file.recurrence == direct.recurrence
    if ending != ".csv":  # a table of text has no attributes
        assert from_file.pinion_speed == direct.pinion_speed
    values = read(write_results(sweep, tmp_path / f"sweep{ending}"), PAIR)
    np.testing.assert_allclose(values.speeds, np.array([1500.0, 2000.0]) * np.pi / 30, rtol=1e-14)
    columns = {one.name.partition(" ")[0]: one for one in values.columns}
    np.testing.assert_allclose(columns["dte_rms"].values, sweep["dte_rms"], rtol=1e-15)
    assert (columns["x_g_peak_to_peak"].quantity, columns["x_g_peak_to_peak"].statistic) == (
        "x_g", "peak_to_peak",
    )  # fmt: skip


def test_without_positions_the_place_is_the_label():
    time = np.arange(9.0)
    loads = np.arange(18.0).reshape(2, 9)
    curves = read({"time": time, "normal_load": loads}, PAIR)
    assert [(one.tooth_pair, one.values[0]) for one in curves.channels] == [("A", 0.0), ("B", 9.0)]
    assert curves.recurrence is None
    columns = read({"time": time, "normal_load": loads.T}, PAIR)
    for one, other in zip(curves.channels, columns.channels, strict=True):
        np.testing.assert_array_equal(one.values, other.values)
    with pytest.raises(ParameterError, match="number of pairs"):
        read({"time": time, "normal_load": np.zeros((9, 10))}, PAIR)
