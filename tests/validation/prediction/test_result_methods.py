"""Does a prediction draw itself, give its spectrum and its dataset, and show itself in a notebook?"""

from __future__ import annotations

import base64
import re

import matplotlib.pyplot as plt
import numpy as np
import pytest

import spurcheck
from tests.unlike_pairs import unlike_pair
from validation import Prediction
from validation.exchange import read_netcdf
from validation.prediction.motion import QUANTITIES


@pytest.fixture(scope="module", params=["rack_25_degrees_always_pushing", "larger_gear_drives_contact_lost"])
def prediction(request: pytest.FixtureRequest) -> Prediction:
    return spurcheck.predict(unlike_pair(request.param))


def test_the_spectrum_has_the_power_of_the_motion(prediction: Prediction) -> None:
    """Parseval: the mean square about the mean is half the sum of the squared amplitudes."""
    for variable in ("dte", "bearing_force_x_p"):
        spectrum = prediction.spectrum(variable=variable)
        vibration = spectrum["amplitude"].where(spectrum["order"] > 0, drop=True).to_numpy()
        expected = float(prediction.cycle[variable].var())
        assert 0.5 * np.sum(vibration**2) == pytest.approx(expected, rel=1e-6)
        assert spectrum["amplitude"].attrs["units"] == prediction.cycle[variable].attrs["units"]


def test_the_spectrum_of_a_shaft_counts_its_turns(prediction: Prediction) -> None:
    mesh = prediction.spectrum()["order"].to_numpy()
    for shaft in ("pinion", "gear"):
        teeth = getattr(prediction.pair, shaft).teeth
        np.testing.assert_allclose(prediction.spectrum(shaft)["order"], teeth * mesh)


def test_the_dataset_has_motion_and_numbers_and_survives_a_file(prediction: Prediction, tmp_path) -> None:
    data = prediction.to_dataset()
    for name, (unit, words) in QUANTITIES.items():
        assert float(data[name]) == prediction.numbers[name]
        assert (data[name].attrs["units"], data[name].attrs["long_name"]) == (unit, words)
    np.testing.assert_array_equal(data["dte"], prediction.cycle["dte"])
    spurcheck.write_results(data, tmp_path / "motion.nc")
    read = read_netcdf(tmp_path / "motion.nc")
    assert float(read["dynamic_factor"]) == prediction.dynamic_factor
    assert read.attrs["motion"] == prediction.motion.text
    assert spurcheck.plot(data).axes[0].get_ylabel().startswith("transmission error [")


def test_the_plot_is_the_motion(prediction: Prediction) -> None:
    figure = prediction.plot()
    line = figure.axes[0].lines[0].get_ydata()
    assert np.ptp(line) == pytest.approx(1e6 * np.ptp(prediction.transmission_error.to_numpy()), rel=1e-9)
    plt.close(figure)


def test_a_notebook_shows_numbers_units_and_a_picture(prediction: Prediction) -> None:
    page = prediction._repr_html_()
    cells = re.findall(r"<tr><td[^>]*><code>(\w+)</code></td><td[^>]*>([^<]*)</td>", page)
    values = dict(cells)
    assert values["peak_to_peak"] == f"{1e6 * prediction.peak_to_peak:.4g}\u00a0µm"
    assert values["contact_lost"] == ("yes" if prediction.contact_lost else "no")
    image = re.search(r'src="data:image/png;base64,([^"]+)"', page)
    assert image
    assert base64.b64decode(image[1]).startswith(b"\x89PNG")
    assert len(page) < 200_000


@pytest.mark.parametrize(("name", "words"), [
    ("dte", "transmission_error"), ("save", "write_results"), ("speed", "pair.operating.pinion_speed"),
    ("geometry", "read .pair.geometry"), ("efficency", "efficiency"),
])  # fmt: skip
def test_a_name_that_is_not_there_names_the_right_one(prediction: Prediction, name: str, words: str) -> None:
    with pytest.raises(AttributeError, match=re.escape(words)):
        getattr(prediction, name)


def test_other_results_draw_themselves_with_plot() -> None:
    pair = unlike_pair("rack_25_degrees_always_pushing")
    check = spurcheck.crosscheck(pair, cycles=8, samples_per_cycle=32, variant=False)
    figure = spurcheck.plot(check)
    assert len(figure.axes[0].lines) == 1 + len(check.multibody)
    assert "<img" in check._repr_html_()
    case = spurcheck.reference(spurcheck.reference_names()[0])
    assert spurcheck.plot(case).axes
    assert "<img" not in spurcheck.bodies(pair)._repr_html_()
    plt.close("all")
