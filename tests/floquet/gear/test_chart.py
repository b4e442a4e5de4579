"""Are charts of any size what the chart of the engine is, whatever method and slices they are made of?"""

import numpy as np
import pytest

from floquet import stability_chart
from floquet.gear import chart as engine
from lumped import load_gear_pair
from lumped.errors import ParameterError

SMALL = {"damping_ratio": np.array([0.0, 0.02, 0.05]), "speed_rpm": np.linspace(2000.0, 18000.0, 400)}


@pytest.fixture(scope="module")
def pair():
    return load_gear_pair("nasa_28_28").with_(friction__law="coulomb", friction__coefficient=0.05)


def test_slices_make_the_same_chart_and_tell_how_far_it_is(pair, monkeypatch) -> None:
    whole = stability_chart(pair, SMALL, rtol=1e-8, store="radius")
    monkeypatch.setattr(engine, "_SLICE", 450)
    told: list[float] = []
    sliced = stability_chart(pair, SMALL, rtol=1e-8, store="radius", progress=told.append)
    assert sliced["spectral_radius"].dims == ("damping_ratio", "speed_rpm")
    assert set(sliced.data_vars) == {"spectral_radius", "error", "verdict", "proven"}
    for name in ("speed_rpm", "damping_ratio"):
        assert np.array_equal(sliced[name], whole[name])
        assert sliced[name].attrs["units"] == whole[name].attrs["units"]
    assert np.array_equal(sliced["spectral_radius"], whole["spectral_radius"])
    assert len(told) == 3  # 150 speeds at a time
    assert told == sorted(told)
    assert told[-1] == 1.0


def test_slow_axes_tell_their_progress_value_by_value(pair) -> None:
    axes = {"speed_rpm": np.array([4000.0, 5000.0]), "torque": np.array([20.0, 60.0, 90.0])}
    told: list[float] = []
    found = stability_chart(pair, axes, progress=told.append)
    assert told == pytest.approx([1 / 3, 2 / 3, 1.0])
    assert found["spectral_radius"].dims == ("speed_rpm", "torque")


def test_what_cannot_be_computed_is_refused_before_any_work(pair) -> None:
    with pytest.raises(ParameterError, match="at most 25000000"):
        stability_chart(pair, {"speed_rpm": np.arange(1.0, 6000.0), "damping_ratio": np.linspace(0, 1, 6000)})
