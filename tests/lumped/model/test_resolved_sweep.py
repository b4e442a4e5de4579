"""Do straight lines between the speeds of a resolved sweep follow the response through its resonances?"""

import numpy as np
import pytest

from lumped import load_gear_pair, speed_sweep
from lumped.model.sweep import resolved_sweep

#: A small gear on slightly damped bearings: narrow resonances, many in the range.
PAIR = load_gear_pair("fzg_c").with_(
    bearings__pinion__loa_damping_ratio=0.01, bearings__gear__loa_damping_ratio=0.01
)
ENDS = (1500.0, 3500.0)


@pytest.fixture(scope="module")
def reference():
    return speed_sweep(PAIR, np.linspace(*ENDS, 200), samples_per_cycle=64)


def distance(reference, sweep, name="dte_peak_to_peak"):
    """Largest distance of the straight lines from the curve, over its height."""
    curve = reference[name].to_numpy()
    drawn = np.interp(reference["speed"].to_numpy(), sweep["speed"].to_numpy(), sweep[name].to_numpy())
    return float(np.abs(drawn - curve).max() / np.abs(curve).max())


def test_lines_follow_the_curve_better_than_even_steps(reference):
    found = resolved_sweep(PAIR, ENDS, most=80, samples_per_cycle=64)
    speed = found["speed"].to_numpy()
    even = speed_sweep(PAIR, np.linspace(*ENDS, speed.size), samples_per_cycle=64)
    assert distance(reference, found) < 0.01
    assert distance(reference, found) < 0.3 * distance(reference, even)
    assert distance(reference, found, "normal_load_max") < 0.01


def test_it_is_a_sweep_over_the_range_with_the_operating_speed():
    seen = []
    found = resolved_sweep(
        PAIR, ENDS, most=30, samples_per_cycle=64, progress=lambda done, stage="", /: seen.append(done)
    )
    speed = found["speed"].to_numpy()
    assert speed.size == 30
    assert (np.diff(speed) > 0.0).all()
    assert (speed[0], speed[-1]) == ENDS
    assert np.abs(speed - 30.0 / np.pi * PAIR.operating.pinion_speed).min() < 1e-9
    again = speed_sweep(PAIR, speed, samples_per_cycle=64)
    for name in again.data_vars:
        np.testing.assert_allclose(found[name].to_numpy(), again[name].to_numpy(), rtol=1e-9, err_msg=name)
    assert found.attrs == again.attrs
    assert seen == sorted(seen)
    assert seen[-1] == 1.0


def test_it_stops_where_nothing_bends_and_takes_a_range_without_the_operating_speed():
    flat = resolved_sweep(PAIR, (40_000.0, 40_400.0), most=100, samples_per_cycle=64)
    assert flat.sizes["speed"] < 40


def test_two_speeds_are_the_least():
    assert resolved_sweep(PAIR, ENDS, most=2, samples_per_cycle=64).sizes["speed"] == 2
