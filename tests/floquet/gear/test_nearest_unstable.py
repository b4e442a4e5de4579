"""Is the nearest unstable speed found, however narrow its zone is, and is what is called stable stable?"""

import math

import numpy as np
import pytest

from floquet import gear_pair_multipliers, nearest_unstable_speed, stability_chart
from floquet.gear.nearest_unstable import StabilityOverSpeed
from lumped import ParameterError, load_gear_pair
from tests.unlike_pairs import unlike_pair

pytestmark = pytest.mark.filterwarnings("ignore::lumped.errors.LawRangeWarning")
LIGHT = {
    "mesh.damping_ratio": 0.0043,
    **{f"bearings.{g}.{line}_damping_ratio": 0.002 for g in ("pinion", "gear") for line in ("loa", "oloa")},
}


def fzg():
    """The pair of which a grid of 500 speeds shows some 4700 rpm as the nearest unstable speed."""
    prescribed = {"mesh.contact": "prescribed", "mesh.relief": "ignored", "operating.pinion_speed": 3157.87}
    return load_gear_pair("fzg_c").with_(LIGHT | prescribed)


def test_a_zone_of_four_rpm_is_the_nearest_unstable_speed() -> None:
    pair = fzg()
    result = nearest_unstable_speed(pair)
    assert result.complete
    assert 4050.0 < result.unstable_rpm < 4056.0
    grid = stability_chart(pair, {"speed_rpm": np.linspace(*result.speed_rpm, 500)}, rtol=1e-8, refine=False)
    nodes = grid["speed_rpm"].values[grid["verdict"].values < 0]
    assert np.abs(nodes - result.operating_rpm).min() > 1500.0
    inside = gear_pair_multipliers(pair.at_speed(result.unstable_rpm + 1e-3))
    assert inside.verdict == "unstable"
    assert gear_pair_multipliers(pair.at_speed(result.stable_rpm[1] - 1e-3)).verdict == "stable"
    steps = np.arange(result.stable_rpm[0] + 0.05, result.stable_rpm[1], 0.37)
    chart = stability_chart(pair, {"speed_rpm": steps}, rtol=1e-8, refine=False)
    assert (chart["verdict"].values > 0).all()


CASES = [
    ("nasa_28_28", "coulomb", 2476.0), ("nasa_art_25_31", "smoothed_coulomb", 4653.4),
    ("high_contact_ratio_29_47", "benedict_kelley", 3736.4), ("heavily_relieved_under_load", "none", 2490.8),
    ("larger_gear_drives_contact_lost", "xu_kahraman", 7503.0),
    ("kahraman_blankenship_50_50", "iso_14179", 2533.5),
]  # fmt: skip


@pytest.mark.parametrize(("name", "law", "speed"), CASES)
def test_every_step_of_a_tenth_of_a_revolution_agrees(name: str, law: str, speed: float) -> None:
    """Over the 40 rpm on either side of the nearest unstable speed, and at random in between."""
    pair = load_gear_pair(name) if name in PRESETS else unlike_pair(name)
    changes = {
        "friction.law": law,
        "friction.coefficient": None,
        "friction.sharpness": None,
        "friction.maximum": None,
    }
    half = {key: 0.5 * value for key, value in LIGHT.items()} if law == "benedict_kelley" else LIGHT
    light = pair.healthy.with_(half | changes | {"operating.pinion_speed": speed})
    result = nearest_unstable_speed(light, supports="springs")
    assert result.complete
    assert not math.isnan(result.unstable_rpm)
    low, high = result.searched_rpm
    rng = np.random.default_rng(4)
    speeds = np.concatenate([np.arange(-40.0, 40.0, 0.1) + result.unstable_rpm, rng.uniform(low, high, 500)])
    speeds = np.sort(speeds[(speeds >= low) & (speeds <= high)])
    verdict = stability_chart(light, {"speed_rpm": speeds}, rtol=1e-8, refine=False, supports="springs")[
        "verdict"
    ].values
    proven = result.verdict[np.clip(np.searchsorted(result.low, speeds, side="right") - 1, 0, None)]
    assert (verdict[proven > 0] > 0).all()
    assert (verdict[proven < 0] < 0).all()
    assert (proven == 0).mean() < 0.02
    edge = low if result.unstable_rpm < result.operating_rpm else high
    assert gear_pair_multipliers(light.at_speed(edge), supports="springs").verdict == "unstable"


PRESETS = ("nasa_28_28", "nasa_art_25_31", "high_contact_ratio_29_47", "kahraman_blankenship_50_50")


def test_all_of_the_range_is_proven_stable_where_damping_is_usual() -> None:
    for pair, supports in (
        (load_gear_pair("fzg_c"), None),
        (unlike_pair("contact_ratio_2_3_on_shafts"), "shafts"),
    ):
        result = nearest_unstable_speed(pair.healthy, supports=supports)
        assert result.complete
        assert math.isnan(result.unstable_rpm)
        assert result.stable_rpm == pytest.approx(result.speed_rpm, rel=1e-12)
        assert (result.verdict == 1).all()


def test_nothing_is_proven_where_a_bearing_off_the_line_of_action_has_no_damping() -> None:
    changes = {f"bearings.{g}.oloa_damping_ratio": 0.0 for g in ("pinion", "gear")}
    result = nearest_unstable_speed(load_gear_pair("nasa_28_28").with_(changes))
    assert (result.searched_rpm, result.complete) == ((result.operating_rpm,) * 2, False)
    assert result.stable_rpm == result.searched_rpm


def test_a_range_without_the_operating_speed_is_refused() -> None:
    with pytest.raises(ParameterError, match="speed_rpm"):
        nearest_unstable_speed("nasa_28_28", (100.0, 200.0))


def of_verdicts(*verdicts: int) -> StabilityOverSpeed:
    """Intervals of 1, 2, 3 ... rpm from 10 rpm, operating speed 22 rpm."""
    ends = 10.0 + np.cumsum(np.arange(len(verdicts) + 1))
    return StabilityOverSpeed(22.0, (10.0, 60.0), ends[:-1], ends[1:], np.array(verdicts))


def test_what_is_undecided_is_the_widest_run_between_stable_intervals() -> None:
    # 10-11-13-16-20-25-31-38-46: the operating speed is in the fifth interval.
    result = of_verdicts(1, 0, 0, 1, 1, 0, 1, -1)
    assert (result.stable_rpm, result.widest_undecided) == ((10.0, 38.0), 6.0)
    assert (result.unstable_rpm, result.complete) == (38.0, True)
    ended = of_verdicts(-1, 0, 0, 1, 1, 0, 0, -1)
    assert (ended.stable_rpm, ended.widest_undecided, ended.unstable_rpm) == ((16.0, 25.0), 0.0, 11.0)
    here = of_verdicts(1, 1, 1, 1, -1, 1, 1, 1)
    assert (here.stable_rpm, here.unstable_rpm) == ((22.0, 22.0), 22.0)
    open_ended = of_verdicts(1, 1, 1, 1, 1, 1, 1, 1)
    assert (open_ended.complete, math.isnan(open_ended.unstable_rpm)) == (False, True)
