"""Which gear pairs without damping are neutral, and which of their motions decide?"""

import numpy as np
import pytest

from floquet import GEAR_AXES, gear_pair_multipliers, monodromy, stability_chart
from floquet.gear.axes import GearVariation
from floquet.gear.multipliers import (
    FeedbackMultipliers,
    OffLineOfAction,
    corners_push_apart,
    feedback_system,
    gear_pair_system,
    stays_bounded,
)
from lumped import load_gear_pair
from tests.unlike_pairs import UNLIKE, unlike_pair

LINES = {line: [f"bearings.{g}.{line}_damping_ratio" for g in ("pinion", "gear")] for line in ("loa", "oloa")}
ON_LINE = {"mesh.damping_ratio": 0.0, **dict.fromkeys(LINES["loa"], 0.0)}
OFF_LINE = dict.fromkeys(LINES["oloa"], 0.0)
NO_FRICTION = {
    "friction.law": "none", "friction.coefficient": None, "friction.maximum": None,
    "friction.sharpness": None, "friction.thresholds": None,
}  # fmt: skip
PAIRS = ("nasa_28_28", *(name for name in UNLIKE if "shafts" not in name))


def pair_of(name: str):
    """A pair on springs that touches on the line of action alone, without friction."""
    pair = unlike_pair(name) if name in UNLIKE else load_gear_pair(name)
    return pair.healthy.with_(NO_FRICTION | {"mesh.contact": "prescribed"})


@pytest.mark.parametrize("name", PAIRS)
def test_undamped_pairs_are_neutral_or_unstable_and_damping_makes_neutral_ones_stable(name: str) -> None:
    pair = pair_of(name)
    speed = np.round(GEAR_AXES["speed_rpm"].own(pair) * np.linspace(0.6, 1.4, 9))
    verdicts = []
    for rpm in speed:
        at_speed = pair.with_({"operating.pinion_speed": float(rpm)})
        undamped = gear_pair_multipliers(at_speed.with_(ON_LINE | OFF_LINE), supports="springs")
        verdicts.append(undamped.verdict)
        assert undamped.symplectic
        assert np.abs(np.abs(undamped.oloa) - 1.0).max() < 1e-12
        if undamped.verdict == "neutral":
            damped = at_speed.with_(
                {"mesh.damping_ratio": 0.05} | dict.fromkeys(LINES["loa"] + LINES["oloa"], 0.05)
            )
            assert gear_pair_multipliers(damped, supports="springs").verdict == "stable"
            assert "proven" in undamped.verdict_words
    assert set(verdicts) <= {"neutral", "unstable"}
    assert verdicts.count("neutral") >= 3


@pytest.mark.parametrize("name", ["nasa_28_28", "rack_25_degrees_always_pushing"])
def test_each_cause_takes_the_proof_away(name: str) -> None:
    """Damping of one bearing, of the mesh, friction however small, a callable, shafts."""
    # Motions off the line of action die out, so that the block alone decides.
    pair = pair_of(name).with_(ON_LINE | dict.fromkeys(LINES["oloa"], 0.02))
    for rpm in np.round(GEAR_AXES["speed_rpm"].own(pair) * np.linspace(0.6, 1.4, 9)):
        pair = pair.with_({"operating.pinion_speed": float(rpm)})
        if gear_pair_multipliers(pair, supports="springs").verdict == "neutral":
            break
    for change in (
        {"mesh.damping_ratio": 1e-9},
        {LINES["loa"][1]: 1e-9},
        {"friction.law": "coulomb", "friction.coefficient": 1e-9},
    ):
        changed = gear_pair_multipliers(pair.with_(change), supports="springs")
        assert not changed.symplectic
        assert not changed.neutral
    sampled = monodromy(gear_pair_system(pair, "mesh", supports="springs"))
    assert (sampled.verdict, sampled.symplectic) == ("undecided", False)


def test_bearings_off_the_line_of_action_alone_leave_the_pair_neutral() -> None:
    """Friction drives them, and they drive nothing: the block dies out, they do not."""
    pair = load_gear_pair("nasa_28_28").with_(OFF_LINE | {"mesh.damping_ratio": 0.08})
    result = gear_pair_multipliers(pair, supports="springs")
    assert np.abs(result.feedback).max() < 1.0 - 1e-6
    assert (result.verdict, result.symplectic) == ("neutral", False)
    one_line = pair.with_({LINES["oloa"][0]: 0.02})
    assert gear_pair_multipliers(one_line, supports="springs").verdict == "neutral"
    both = one_line.with_({LINES["oloa"][1]: 0.02})
    assert gear_pair_multipliers(both, supports="springs").verdict == "stable"


def test_what_is_free_off_the_line_of_action_is_not_bounded() -> None:
    """A mass without a spring has two exponents 0 and drifts; an exponent above 0 grows."""
    values, none = np.exp(1j * np.array([[0.5, -0.5, 1.4, -1.4]])), np.zeros((1, 4))
    one_second = np.ones(1)
    for exponents, bounded in (
        ([3j, -3j], True), ([0j, 0j], False), ([0.1 + 3j, 0.1 - 3j], False), ([-0.1 + 3j, -0.1 - 3j], True),
    ):  # fmt: skip
        off_line = OffLineOfAction(np.array(exponents), np.full(2, 1e-12))
        on_circle = FeedbackMultipliers(values, none, np.array([True]))
        fading = FeedbackMultipliers(0.9 * values, none, np.array([False]))
        assert stays_bounded(on_circle, off_line, one_second, driven=False)[0] == bounded
        inside = stays_bounded(fading, off_line, one_second, driven=False)[0]
        assert inside == (bounded and exponents[0].real == 0.0)


@pytest.mark.parametrize(
    ("angle", "bounded"), [(3.0, True), (1.4, False), (1.4 + 1e-9, False), (1.4 + 1e-7, True)]
)
def test_an_undamped_motion_that_is_driven_at_its_own_multiplier_is_not_bounded(angle, bounded) -> None:
    """y'' + w^2 y = z, z of the same multiplier, grows like t; disks of 1e-8 decide whether it may be so."""
    values = np.exp(1j * np.array([[0.5, -0.5, 1.4, -1.4]]))
    block = FeedbackMultipliers(values, np.full((1, 4), 1e-8), np.array([True]))
    off_line = OffLineOfAction(np.array([1j * angle, -1j * angle]), np.full(2, 1e-12))
    assert stays_bounded(block, off_line, np.ones(1), driven=True)[0] == bounded
    assert stays_bounded(block, off_line, np.ones(1), driven=False)[0]
    fading = OffLineOfAction(np.array([-0.1 + 1j * angle, -0.1 - 1j * angle]), np.full(2, 1e-12))
    assert stays_bounded(block, fading, np.ones(1), driven=True)[0]


@pytest.mark.parametrize("name", ["fzg_c", "heavily_relieved_under_load", "rack_25_degrees_always_pushing"])
def test_tip_corners_push_the_gears_apart_and_leave_the_block_symmetric(name: str) -> None:
    """The powers of the map of all ten states stay bounded; it is computed from A(t) by Gauss collocation."""
    pair = (unlike_pair(name) if name in UNLIKE else load_gear_pair(name)).healthy
    pair = pair.with_(NO_FRICTION | ON_LINE | OFF_LINE)
    assert corners_push_apart(feedback_system(GearVariation(pair, supports="springs")))
    speed = np.round(GEAR_AXES["speed_rpm"].own(pair) * np.linspace(0.6, 1.4, 7))
    verdicts = []
    for rpm in speed:
        at_speed = pair.with_({"operating.pinion_speed": float(rpm)})
        result = gear_pair_multipliers(at_speed, supports="springs")
        assert result.symplectic
        verdicts.append(result.verdict)
        flow = monodromy(gear_pair_system(at_speed, supports="springs"), 1e-9)
        powers = flow.matrix * flow.scaling / flow.scaling[:, None]
        first = np.linalg.norm(powers, 2)
        for _ in range(12):  # the power 4096, or less where it has grown
            if np.linalg.norm(powers, 2) < 1e6 * first:
                powers = powers @ powers
        # A bounded one is a rotation in coordinates whose condition is below 100.
        assert (np.linalg.norm(powers, 2) < 100.0 * first) == (result.verdict == "neutral")
    assert set(verdicts) <= {"neutral", "unstable"}
    assert verdicts.count("neutral") >= 2


def test_a_chart_says_so_where_damping_and_friction_are_zero() -> None:
    pair = load_gear_pair("nasa_28_28").with_(NO_FRICTION | ON_LINE | OFF_LINE)
    axes = {"speed_rpm": np.linspace(3000.0, 20000.0, 18), "damping_ratio": [0.0, 0.02]}
    verdict = stability_chart(pair, axes)["verdict"].values
    assert set(verdict[:, 0]) == {-1, 2}
    assert 2 not in verdict[:, 1]
    # The operating point of each node.
    for i, rpm in enumerate(axes["speed_rpm"]):
        alone = gear_pair_multipliers(pair.with_({"operating.pinion_speed": float(rpm)}))
        assert alone.verdict == {2: "neutral", -1: "unstable"}[int(verdict[i, 0])]
    coulomb = pair.with_({"friction.law": "coulomb", "friction.coefficient": 0.05})
    over_friction = stability_chart(
        coulomb, {"speed_rpm": axes["speed_rpm"], "friction_coefficient": [0.0, 0.05]}
    )
    assert (over_friction["verdict"].values[:, 0] == verdict[:, 0]).all()
    assert 2 not in over_friction["verdict"].values[:, 1]
