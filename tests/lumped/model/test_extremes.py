"""Is peak to peak one number, however a motion is sampled?"""

import numpy as np
import pytest

from lumped import simulate, steady_state
from lumped.model.results import cycle_peak_to_peak, peak_to_peak


def test_extremes_between_samples_are_found():
    time = np.linspace(0.0, 2.0 * np.pi, 9)  # the extremes of the sine below lie between these
    found = peak_to_peak(time, np.sin(time + 0.3), np.cos(time + 0.3))
    # Cubic from exact values and rates: error up to h^4/384 at each extreme, h = pi/4.
    assert found == pytest.approx(2.0, abs=2 * (np.pi / 4) ** 4 / 384)
    assert np.ptp(np.sin(time + 0.3)) < 1.92


def test_a_straight_line_and_a_constant_have_no_extremes_between():
    time = np.array([0.0, 1.0, 3.0])
    assert peak_to_peak(time, 2.0 * time, np.full(3, 2.0)) == 6.0
    assert peak_to_peak(time, np.ones(3), np.zeros(3)) == 0.0


@pytest.mark.parametrize("speed", [300, 1450, 9000])
def test_the_transmission_error_of_a_pair_has_one_peak_to_peak(unequal, speed):
    pair = unequal.with_(operating__pinion_speed=speed)
    few, many = (steady_state(pair, samples_per_cycle=n) for n in (16, 2048))
    swing = many.attrs["dte_peak_to_peak"]
    assert few.attrs["dte_peak_to_peak"] == pytest.approx(swing, rel=1e-4)
    assert swing == pytest.approx(np.ptp(many["dte"].to_numpy()), rel=1e-3)
    assert cycle_peak_to_peak(many, "dte", pair.geometry.mesh_period) == pytest.approx(swing, rel=1e-5)
    run = simulate(pair, 1, samples_per_cycle=512, initial="periodic")
    assert cycle_peak_to_peak(run, "dte") == pytest.approx(swing, rel=1e-3)
