"""Are stability and bounds of a pair on its shafts those of its equations, whatever speed and route?"""

import numpy as np
import pytest

import floquet
import lumped
from floquet import gear_block, gear_pair_multipliers, scan, stability_boundaries, stability_chart
from floquet.gear.axes import GearVariation, vary
from floquet.gear.multipliers import MODES, feedback_system
from lumped.errors import ParameterError
from lumped.schema.pair import GearPair
from tests.unlike_pairs import unlike_pair


def on_shafts(pinion: tuple[float, float], gear: tuple[float, float], **more: object) -> GearPair:
    """Shafts of these diameters, gears at these places [mm]; bearings at 20 and 140 mm."""
    shafts = [
        {
            "segments": [{"length": 220, "diameter": diameter}],
            "gear_position": place,
            "bearings": [{"position": z, "loa_stiffness": 2e8, "oloa_stiffness": 1.5e8} for z in (20, 140)],
        }
        for diameter, place in (pinion, gear)
    ]
    both = {"damping_ratio": 0.01, "pinion": shafts[0], "gear": shafts[1]}
    pair = lumped.load_gear_pair("nasa_28_28").with_(mesh__relief="ignored", friction__law="coulomb")
    return pair.with_(friction__coefficient=0.06, shafts=both | more)


@pytest.fixture(scope="module")
def slender() -> GearPair:
    """Both gears overhung on slender shafts, which bend, tilt and whirl; they differ a little."""
    return on_shafts((30.0, 200.0), (32.0, 195.0), max_frequency=14e3)


def matched(multipliers: np.ndarray, exact: np.ndarray) -> np.ndarray:
    return np.asarray(np.abs(multipliers[:, None] - exact).min(axis=1))


def test_charts_are_the_general_engine_at_every_speed(slender: GearPair) -> None:
    pair = unlike_pair("contact_ratio_2_3_on_shafts")
    axes = {"speed_rpm": [2600.0, 12000.0], "friction_coefficient": [0.1], "torque": [150.0]}
    chart = stability_chart(pair, axes, supports="shafts", rtol=1e-8, store="all")
    slow = scan(lambda point: gear_pair_multipliers(vary(pair, point, "shafts"), 1e-6, method="gauss"), axes)
    for values, errors, exact, bounds in zip(
        *(part.values.reshape(2, -1) for c in (chart, slow) for part in (c.multipliers, c.multiplier_errors)),
        strict=True,
    ):
        assert (matched(values, exact) <= errors + bounds.max()).all()
    assert chart.certificate == "proven"
    assert chart.supports == "shafts"
    assert float(chart.error.max()) < 1e-6
    still = gear_block(slender, supports="shafts")
    assert still.v.size == MODES
    assert still.gyroscopic is not None
    assert np.abs(still.gyroscopic + still.gyroscopic.T).max() < 1e-12 * np.abs(still.gyroscopic).max()


def test_modes_left_out_hardly_count(slender: GearPair) -> None:
    """The lumped model propagates all modes together, by another method; what is left out counts least."""
    multipliers = gear_pair_multipliers(slender, supports="shafts")
    everything = lumped.steady_state(slender, supports="shafts", samples_per_cycle=64)
    assert multipliers.certificate == "proven"
    assert multipliers.feedback.size == 2 * MODES
    assert abs(multipliers.spectral_radius - everything.spectral_radius) < 1e-4
    decay, squares = feedback_system(GearVariation.of(slender, "shafts")).separate
    assert decay.size > MODES
    # What the shafts' damping ratio says, apart from what the mesh does to a mode.
    assert decay / np.sqrt(squares) == pytest.approx(np.full(decay.size, 0.01), rel=2e-2)


def test_boundaries_are_where_the_radius_is_one() -> None:
    pair = on_shafts((60.0, 80.0), (60.0, 80.0))
    boundaries = stability_boundaries(pair, (5500.0, 6200.0), nodes=0, orders=2, supports="shafts")
    assert boundaries.complete
    assert boundaries.present.values.any()
    ends = np.unique([end for end in boundaries.lower.values if 5500.0 < end < 6200.0])
    beside = np.concatenate([ends * (1.0 - 1e-5), ends * (1.0 + 1e-5)])
    chart = stability_chart(pair, {"speed_rpm": beside}, supports="shafts")
    assert (chart.verdict.values == np.repeat([1, -1], ends.size)).all()


def test_stiff_shafts_are_springs() -> None:
    # Short, light and stiff ones, each in one bearing under its gear.
    pair = lumped.load_gear_pair("nasa_28_28").with_(friction__law="coulomb", friction__coefficient=0.06)
    springs = pair.bearings.pinion
    bearing = {"loa_stiffness": springs.loa_stiffness, "oloa_stiffness": springs.oloa_stiffness}
    shaft = {
        "segments": [{"length": 20, "diameter": 40}], "youngs_modulus": 2000, "density": 10,
        "gear_position": 10, "bearings": [bearing | {"position": 10, "tilt_stiffness": 1e7}],
    }  # fmt: skip
    both = {"damping_ratio": springs.loa_damping_ratio, "pinion": shaft, "gear": shaft}
    for speed in (3000.0, 12000.0):
        pair_at_speed = pair.with_(operating__pinion_speed=speed)
        sprung = gear_pair_multipliers(pair_at_speed)
        shafted = gear_pair_multipliers(pair_at_speed.with_(shafts=both), supports="shafts")
        assert matched(sprung.multipliers, shafted.multipliers).max() < 1e-2
        assert shafted.verdict == sprung.verdict


def test_what_shafts_do_not_have_is_refused(slender: GearPair) -> None:
    with pytest.raises(ParameterError, match="shafts"):
        stability_chart("nasa_28_28", {"speed_rpm": [9000.0]}, supports="shafts")
    with pytest.raises(ParameterError, match="bearing_stiffness"):
        stability_chart(slender, {"bearing_stiffness": [1e8]}, supports="shafts")
    with pytest.raises(ParameterError, match="bearing_stiffness"):
        stability_boundaries(slender, (900.0, 1e3), axes={"bearing_stiffness": [1e8]}, supports="shafts")
    with pytest.raises(ParameterError, match="supports"):
        gear_pair_multipliers(slender, supports="rubber")


def test_teeth_that_differ_have_the_modes_of_like_teeth(slender: GearPair) -> None:
    like = slender.with_(mesh__contact="prescribed")
    expected = gear_pair_multipliers(like, supports="shafts")
    multipliers = floquet.revolution_multipliers(
        like.with_(pinion__mounting={"eccentricity": 1e-9}), supports="shafts"
    )
    assert abs(multipliers.rate - abs(expected.feedback).max()) <= multipliers.error + expected.error
    assert multipliers.error < 1e-8
