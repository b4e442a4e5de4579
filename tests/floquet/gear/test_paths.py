"""Does every path of a multiplier stay with its own mode, however coarse the axis?"""

from __future__ import annotations

import numpy as np
import pytest

import floquet.gear.paths
from floquet import fast_monodromies, gear_block, gear_pair_multipliers, multiplier_paths
from floquet.engine.tongues import mode_shares
from floquet.gear.axes import vary
from floquet.gear.paths import joined
from lumped import load_gear_pair
from lumped.errors import ParameterError
from lumped.schema.pair import GearPair


@pytest.fixture(scope="module")
def pair() -> GearPair:
    return load_gear_pair("nasa_28_28").with_(friction__law="coulomb", friction__coefficient=0.05)


def modes_of(pair: GearPair, speed: float, path: np.ndarray) -> list[int]:
    """Mode of the mean system in which the motion of each multiplier has 9 tenths of its action."""
    block = gear_block(vary(pair, {"speed_rpm": speed}))
    values, vectors = np.linalg.eig(fast_monodromies(block).matrices[0])
    shares = np.array([mode_shares(x, block.modal().omega).sum(axis=0) for x in vectors.T])
    nearest = [int(np.argmin(np.abs(values - one))) for one in path]
    assert (shares[nearest].max(axis=1) > 0.9).all()
    return [int(mode) for mode in shares[nearest].argmax(axis=1)]


def test_paths_keep_their_mode_at_low_speed(pair: GearPair, monkeypatch: pytest.MonkeyPatch) -> None:
    # From one point to the next multipliers turn by up to 90 rad. Mode shapes do not turn: at 3 % damping,
    # away from the wide tongues, each multiplier belongs to one mode.
    damped = pair.with_(mesh__damping_ratio=0.03)
    speeds = np.linspace(700, 3000, 4)
    result = multiplier_paths(damped, "speed_rpm", speeds)
    assert result.certain.all()
    modes = [modes_of(damped, *at) for at in zip(speeds, result.multipliers.values, strict=True)]
    assert all(row == modes[0] for row in modes)
    # Without points between, the nearest multipliers are others, and the result says that it is not sure.
    monkeypatch.setattr(floquet.gear.paths._Line, "follow", unrefined)
    coarse = multiplier_paths(damped, "speed_rpm", speeds)
    modes = [modes_of(damped, *at) for at in zip(speeds, coarse.multipliers.values, strict=True)]
    assert any(row != modes[0] for row in modes)
    assert not coarse.certain[1:].any()


_follow = floquet.gear.paths._Line.follow


def unrefined(line: object, here: object, low: float, high: float, halvings: int) -> object:
    return _follow(line, here, low, high, 0)  # type: ignore[arg-type]


def test_paths_are_continuous_and_complete(pair: GearPair) -> None:
    damping = np.linspace(0.0, 0.1, 81)
    result = multiplier_paths(pair.with_(operating__pinion_speed=16700), "damping_ratio", damping)
    steps = np.abs(np.diff(result.multipliers.values, axis=0))
    # Leaving the tongue two multipliers meet on the real axis and part like a square root of the step.
    assert steps.max() < 3 * np.sqrt(damping[1])
    at = gear_pair_multipliers(pair.with_(operating__pinion_speed=16700, mesh__damping_ratio=0.05))
    one = result.multipliers.sel(damping_ratio=0.05, method="nearest").values
    assert np.abs(one[:, None] - at.feedback).min(axis=1).max() < 1e-7


def test_one_block_for_all_speeds_is_one_for_each(pair: GearPair, monkeypatch: pytest.MonkeyPatch) -> None:
    speeds = [4000.0, 4200.0]
    shared = multiplier_paths(pair, "speed_rpm", speeds)
    monkeypatch.setattr(floquet.gear.paths, "depends_on_speed", lambda pair: True)
    own = multiplier_paths(pair, "speed_rpm", speeds)
    for one, other in zip(shared.multipliers.values, own.multipliers.values, strict=True):
        assert np.abs(np.sort_complex(one) - np.sort_complex(other)).max() < 1e-8


def test_a_joint_is_certain_where_multipliers_are_farther_apart_than_they_move() -> None:
    here = np.array([1.0, 0.5, 0.2 + 0.1j, 0.2 - 0.1j])
    order, certain = joined(here, np.array([0.17, 0.2 - 0.1j, 1.1, 0.2 + 0.1j]))
    assert order.tolist() == [2, 0, 3, 1]
    assert certain.tolist() == [True, False, False, False]  # 0.5 moves by 0.33 and was 0.32 away
    order, certain = joined(here, np.array([0.3, 0.2 - 0.1j, 1.1, 0.2 + 0.1j]))
    assert certain.all()
    order, certain = joined(here, np.array([1.0, 0.5, 0.2, 0.19]))
    assert certain.all()  # conjugates that meet on the real axis are each other's, and nobody else's


def test_unusable_axes_are_refused(pair: GearPair) -> None:
    with pytest.raises(ParameterError, match="axes"):
        multiplier_paths(pair, "moon_phase", [1.0])
    with pytest.raises(ParameterError, match="increasing"):
        multiplier_paths(pair, "speed_rpm", [2000.0, 1000.0])


def test_speeds_at_which_the_modes_turn_without_end_are_refused_at_once(pair: GearPair) -> None:
    # At 1 rpm the fastest mode turns by 1e5 rad in a mesh cycle: following it took hours without a word.
    with pytest.raises(ParameterError, match=r"speed_rpm = 1 to 50.*higher speed"):
        multiplier_paths(pair, "speed_rpm", [1.0, 50.0, 100.0])


def test_progress_ends_with_the_last_value(pair: GearPair) -> None:
    told: list[float] = []
    multiplier_paths(pair, "speed_rpm", [3000.0, 4000.0, 5000.0], progress=lambda f, stage="": told.append(f))
    assert told == sorted(told)
    assert told[-1] == 1.0
