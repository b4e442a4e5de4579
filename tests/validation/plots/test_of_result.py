"""Does a result draw itself, and does what is drawn belong to it?"""

import numpy as np
import pytest
import xarray as xr

import spurcheck
from lumped.errors import ParameterError

PAIR = "nasa_28_28"
CHART = {"speed_rpm": np.linspace(3000.0, 9000.0, 7), "damping_ratio": np.linspace(0.005, 0.05, 5)}
RESULTS = {
    "simulate": lambda: spurcheck.simulate(PAIR, 2, samples_per_cycle=32),
    "steady state": lambda: spurcheck.steady_state(PAIR, samples_per_cycle=32),
    "multibody": lambda: spurcheck.multibody.simulate(PAIR, 1, samples_per_cycle=32),
    "sweep": lambda: spurcheck.speed_sweep(PAIR, CHART["speed_rpm"], samples_per_cycle=32),
    "chart": lambda: spurcheck.stability_chart(PAIR, CHART),
    "line": lambda: spurcheck.stability_chart(PAIR, {"speed_rpm": CHART["speed_rpm"]}),
    "campbell": lambda: spurcheck.campbell(PAIR, CHART["speed_rpm"]),
    "boundaries": lambda: spurcheck.stability_boundaries(
        PAIR, (3000.0, 9000.0), {"friction_coefficient": [0.0, 0.1]}
    ),
}


@pytest.mark.parametrize("name", RESULTS)
def test_a_result_draws_itself(name, tmp_path):
    figure = spurcheck.plot(RESULTS[name]())
    figure.savefig(tmp_path / "figure.png")  # every axis has a label with a unit, see conftest.py
    assert figure.axes


def test_the_drawn_curve_is_the_result():
    result = RESULTS["steady state"]()
    curve = spurcheck.plot(result).axes[0].lines[0].get_ydata()
    assert np.ptp(curve) * 1e-6 == pytest.approx(np.ptp(result["dte"].to_numpy()), rel=1e-12)


def test_what_cannot_be_drawn_is_refused():
    with pytest.raises(ParameterError, match="a result of simulate"):
        spurcheck.plot(xr.Dataset({"x": ("y", [1.0])}))
    with pytest.raises(ParameterError, match=r"result\.sel"):
        spurcheck.plot(spurcheck.stability_chart(PAIR, {**CHART, "torque": [50.0, 60.0]}))
