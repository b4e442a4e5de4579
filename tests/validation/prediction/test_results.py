"""Are predictions results like any other: plotted, analysed, written and read again?"""

import tomllib

import matplotlib.pyplot as plt
import numpy as np
import pytest
import xarray as xr

import spurcheck
from tests.unlike_pairs import UNLIKE, unlike_pair
from validation.prediction.motion import Motion, predicted

PRESCRIBED = {
    f"{name}, prescribed": name for name in UNLIKE if unlike_pair(name).healthy is unlike_pair(name)
}
CASES = (*UNLIKE, *PRESCRIBED)


@pytest.fixture(scope="module")
def prediction():
    """Function: the prediction of an unlike pair, as given or with prescribed contact; computed once."""
    predictions = {}

    def prediction_of(name):
        if name not in predictions:
            pair = unlike_pair(PRESCRIBED.get(name, name))
            predictions[name] = predicted(
                pair.with_(mesh__contact="prescribed") if name in PRESCRIBED else pair
            )
        return predictions[name]

    return prediction_of


def test_the_cases_hold_every_kind_of_motion(prediction):
    motions = [prediction(name) for name in CASES]
    assert {one.motion for one in motions} == {Motion.UNILATERAL}
    assert {one.cycle.attrs["supports"] for one in motions} == {"springs", "shafts"}
    assert {one.cycle.attrs["teeth"] for one in motions} == {"alike", "as given"}
    assert prediction("larger_gear_drives_contact_lost").contact_lost


@pytest.mark.parametrize("name", CASES)
def test_a_prediction_is_plotted(prediction, name):
    """As the example in the help of ``spurcheck`` does."""
    figure = spurcheck.plot(prediction(name))
    assert any(axes.lines for axes in figure.axes)
    plt.close(figure)


@pytest.mark.parametrize("name", CASES)
def test_orders_of_a_predicted_motion_are_its_amplitudes(prediction, name):
    motion = prediction(name)
    spectrum = spurcheck.order_spectrum(motion.cycle)
    phase = 2.0 * np.pi * motion.cycle["time"].to_numpy() / motion.pair.geometry.mesh_period
    for order in (1, 2):
        expected = 2.0 * abs(np.mean(motion.cycle["dte"].to_numpy() * np.exp(-1j * order * phase)))
        amplitude = spectrum["amplitude"].sel(order=order, method="nearest")
        assert float(amplitude) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("name", CASES)
def test_a_written_motion_knows_its_pair(prediction, name, tmp_path):
    motion = prediction(name)
    spurcheck.write_results(motion.cycle, tmp_path / "motion.nc")
    with xr.open_dataset(tmp_path / "motion.nc", engine="h5netcdf") as read:
        assert spurcheck.load_gear_pair(tomllib.loads(read.attrs["parameters"])) == motion.pair
        assert read["dte"].to_numpy() == pytest.approx(motion.cycle["dte"].to_numpy(), abs=0.0)
