"""Is a sweep over speed the periodic solution at each of its speeds?"""

import math

import numpy as np
import pytest

from lumped import ParameterError, load_gear_pair, speed_sweep, steady_state
from lumped.model.sweep import resolved_sweep

SPEEDS = [700.0, 4875.0, 9000.0]


def test_every_speed_is_its_own_periodic_solution(published):
    sweep = speed_sweep(published, SPEEDS, samples_per_cycle=64)
    np.testing.assert_array_equal(sweep["speed"], SPEEDS)
    assert bool(sweep["periodic"].all())
    for j, speed in enumerate(SPEEDS):
        run = steady_state(published.with_(operating__pinion_speed=speed), samples_per_cycle=64)
        for name in ("dte", "x_p", "x_g", "y_p", "y_g"):
            values = run[name].to_numpy()
            assert float(sweep[f"{name}_rms"][j]) == pytest.approx(
                math.sqrt(np.mean((values - values.mean()) ** 2)), rel=1e-11
            )
        loads = run["normal_load"].to_numpy()[run["contact"].to_numpy() > 0]
        # Speeds are computed together, on the clock of the first: times are rounded once more.
        for name, value in (
            ("dte_peak_to_peak", run.attrs["dte_peak_to_peak"]),
            ("normal_load_max", loads.max()),
            ("normal_load_min", loads.min()),
        ):
            assert float(sweep[name][j]) == pytest.approx(value, rel=1e-11)
        assert float(sweep["mesh_efficiency"][j]) == pytest.approx(run.attrs["mesh_efficiency"], rel=1e-14)


def test_how_far_sliding_is_reversed_does_not_depend_on_the_samples(coulomb_pair):
    """The largest of the samples alone is up to a step off: 1/64 of a base pitch, of a reversal of 1/26."""
    pair = coulomb_pair.with_({"mesh.damping_ratio": 0.01})
    few, many = (
        float(speed_sweep(pair, [600.0], samples_per_cycle=n)["sliding_reversal"][0]) for n in (64, 4096)
    )
    assert many > 0.0
    assert few == pytest.approx(many, rel=0.02)  # error of a straight line over a step, of second order


def test_a_speed_without_periodic_motion_is_marked(coulomb_pair):
    """Undamped and on the third subharmonic of the bearing's own frequency: NaN, and said so."""
    none = {f"bearings.{g}.{d}_damping_ratio": 0.0 for g in ("pinion", "gear") for d in ("loa", "oloa")}
    none |= {"friction.law": "none", "mesh.damping_ratio": 0.0}
    pair = coulomb_pair.with_(none | {"gear.mass": 0.3})
    stiffness = pair.bearings.gear.oloa_stiffness
    speed = math.sqrt(stiffness / 0.3) * 60 / (2 * math.pi * pair.pinion.teeth) / 3
    result = speed_sweep(pair, [0.97 * speed, speed], samples_per_cycle=8)
    assert result["periodic"].to_numpy().tolist() == [True, False]
    assert np.isnan(result["dte_rms"][1])
    assert np.isfinite(result["dte_rms"][0])


def test_progress(coulomb_pair):
    seen = []
    speed_sweep(coulomb_pair, [1000, 2000], samples_per_cycle=8, progress=seen.append)
    assert seen == [0.5, 1.0]


@pytest.mark.parametrize(
    "speeds", [[0.0], [-1000.0], [1000.0, math.nan], [math.inf], ["fast"], [None], [], None]
)
def test_speeds_are_positive_numbers(coulomb_pair, speeds):
    with pytest.raises(ParameterError, match="speed"):
        speed_sweep(coulomb_pair, speeds)


def test_no_speed_beyond_the_schema_is_computed_first(coulomb_pair):
    """A refused speed at the end is refused before the others have cost any time."""
    seen = []
    with pytest.raises(ParameterError, match="speed"):
        speed_sweep(coulomb_pair, [1000, 1e9], samples_per_cycle=8, progress=seen.append)
    assert seen == []


#: A small gear on slightly damped bearings: narrow resonances, many in the range.
PAIR = load_gear_pair("fzg_c").with_(
    mesh__contact="prescribed",
    bearings__pinion__loa_damping_ratio=0.01,
    bearings__gear__loa_damping_ratio=0.01,
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
    resolved = resolved_sweep(PAIR, ENDS, most=80, samples_per_cycle=64)
    speed = resolved["speed"].to_numpy()
    even = speed_sweep(PAIR, np.linspace(*ENDS, speed.size), samples_per_cycle=64)
    assert distance(reference, resolved) < 0.01
    assert distance(reference, resolved) < 0.3 * distance(reference, even)
    assert distance(reference, resolved, "normal_load_max") < 0.01


def test_it_stops_where_nothing_bends_and_takes_a_range_without_the_operating_speed():
    sweep = resolved_sweep(PAIR, (40_000.0, 40_400.0), most=100, samples_per_cycle=64)
    assert sweep.sizes["speed"] < 40


def test_two_speeds_are_the_least():
    assert resolved_sweep(PAIR, ENDS, most=2, samples_per_cycle=64).sizes["speed"] == 2
