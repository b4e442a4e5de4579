"""The figure of page 1: does it show what its legend names?"""

import numpy as np
import pytest
import xarray as xr

from validation.plots.motion import first_figure


@pytest.mark.parametrize(("operating", "named"), [(1450.0, True), (5000.0, False)])
def test_the_operating_point_is_named_where_it_is_in_the_range(operating, named):
    time = np.linspace(0.0, 1e-3, 9)
    motion = xr.Dataset({"dte": ("time", 1e-6 * np.sin(time))}, {"time": time})
    speed, ones = np.array([1000.0, 2000.0]), ("speed", np.ones(2))
    sweep = xr.Dataset(
        {"dte_peak_to_peak": ones, "normal_load_min": ones, "spectral_radius": ("speed", np.full(2, 0.5))},
        {"speed": speed},
    )
    figure = first_figure(motion, motion, 1e-3, sweep, operating, 1.0)
    legends = [text.get_text() for ax in figure.axes if ax.get_legend() for text in ax.get_legend().texts]
    assert ("operating point" in legends) == named
