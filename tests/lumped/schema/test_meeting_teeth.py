"""Which teeth meet, and with which errors? Numbers, signs, the first harmonic, tolerances."""

import math

import numpy as np
import pytest

from lumped import ParameterError, flank_tolerances, meeting_teeth, revolution, tooth_gaps
from lumped.schema.tolerances import drawn_index
from lumped.schema.torque_ripples import ripples
from tests.unlike_pairs import unlike_pair

LIST = [round(math.sin(3.0 * j) + 0.1 * j, 3) for j in range(28)]


def steps(values, **more):
    return {"index": list(values), "first_order": "steps", **more}


@pytest.mark.parametrize(("changes", "cycles"), [
    ({}, 1),
    ({"pinion.mounting": {"eccentricity": 1}}, 23),
    ({"gear.deviations": {"tolerance_class": 5}}, 38),
    ({"operating.torque_ripple": [{"shaft": "gear", "order": 1, "amplitude": 1}]}, 38),
    ({"gear.mounting": {"eccentricity": 1}, "pinion.faults": [{"kind": "crack", "tooth": 1, "depth": 0.1}]},
     874),
])  # fmt: skip
def test_period_is_a_revolution_or_the_hunting_period(unequal, changes, cycles):
    assert revolution(unequal.with_(changes)) == cycles


def test_every_pair_of_coprime_teeth_meets_and_28_of_784_of_like_numbers(nasa, unequal):
    both = {f"{gear}.deviations": {"tolerance_class": 6} for gear in ("pinion", "gear")}
    for pair, met in ((unequal.with_(both), 874), (nasa.with_(both), 28)):
        meetings = meeting_teeth(pair)
        assert len({*zip(meetings.pinion_tooth.values, meetings.gear_tooth.values, strict=True)}) == met
        assert (meetings.pinion_tooth[0], meetings.gear_tooth[0]) == (1, 1)
    later = meeting_teeth(nasa.with_({**both, "mesh.first_teeth": [28, 3]}), 2)
    assert later.pinion_tooth.values.tolist() == [28, 1]
    assert later.gear_tooth.values.tolist() == [3, 4]


def test_a_flank_further_along_the_count_comes_late_on_the_pinion_and_early_on_the_gear(unequal):
    along = LIST[:23]
    behind = [round(2.0 * math.cos(1.3 * j), 3) for j in range(38)]
    # Numbered against the count the list is reversed with its sign.
    against = steps([-along[-j % 23] for j in range(23)], counted="against")
    gaps = tooth_gaps(unequal.with_({"pinion.deviations": against, "gear.deviations": steps(behind)}))
    # Along the line of action, by the rack's angle: a pitch deviation F turns the flank by F cos(alpha)/r_b.
    late, early = (np.cos(np.radians(25.0)) * np.array(values) * 1e-6 for values in (along, behind))
    assert gaps.pinion_error.values == pytest.approx(late, rel=1e-14)
    assert gaps.gear_error.values == pytest.approx(-early, rel=1e-14)
    assert gaps.gap.values == pytest.approx(late[:, None] - early, abs=1e-20)


@pytest.mark.parametrize("gear", ["pinion", "gear"])
def test_first_harmonic_of_a_list_turns_as_an_eccentric_gear(nasa, gear):
    # The staircase F[n] = eps/cos(alpha) cos(2 pi n/z + 0.7) is what an eccentric gear shows at the pitch
    # point.
    turn = 2.0 * np.pi * np.arange(28) / 28
    index = 12.0 / np.cos(np.radians(20.0)) * np.cos(turn + 0.7)
    pair = nasa.with_({f"{gear}.deviations": {"index": list(index)}})
    gaps = tooth_gaps(pair)
    g = pair.geometry
    assert gaps[f"{gear}_error"].values == pytest.approx(0.0, abs=1e-20)
    assert gaps.attrs[f"{gear}_eccentricity"] == pytest.approx(12e-6, rel=1e-12)
    at_pitch_point = gaps.attrs[f"{gear}_phase"] + (g.L_XP - g.L_XA) / g.base_radius_pinion
    assert np.cos(at_pitch_point - 0.7) == pytest.approx(1.0 if gear == "pinion" else -1.0, rel=1e-12)


def test_tolerances_are_those_of_the_standard_and_a_draw_meets_one(nasa):
    # ISO 1328-1:2013, class 6 = class 5 times sqrt 2; z 28, m 3.175 mm, by hand.
    tolerances = flank_tolerances(28, 3.175e-3, 6)
    by_hand = {"f_p": 8.99, "F_p": 27.70, "f_Ha": 7.58, "f_fa": 9.54, "F_a": 12.18, "F_r": 24.93}
    assert {name: round(value * 1e6, 2) for name, value in tolerances.items()} == by_hand
    for seed in range(4):
        index = drawn_index(28, 3.175e-3, 6, seed)
        largest = np.abs(np.diff(index, prepend=index[-1])).max()
        assert max(largest / tolerances["f_p"], np.ptp(index) / tolerances["F_p"]) == pytest.approx(
            1.0, rel=1e-12
        )
        assert index.mean() == pytest.approx(0.0, abs=1e-19)
        assert (drawn_index(28, 3.175e-3, 6, seed) == index).all()
    with pytest.raises(ParameterError, match="1 to 11"):
        flank_tolerances(28, 3.175e-3, 12)


def test_each_gear_is_drawn_with_its_own_class_seed_teeth_and_rack():
    """20 teeth of class 6, seed 11; 30 of class 7, seed 5; along the line of action by cos(22.5 deg)."""
    steps_kept = {f"{gear}.deviations.first_order": "steps" for gear in ("pinion", "gear")}
    gaps = tooth_gaps(unlike_pair("unlike_teeth_finite_elements").with_(steps_kept))
    across = math.cos(math.radians(22.5))
    pinion, gear = drawn_index(20, 3.5e-3, 6, 11), drawn_index(30, 3.5e-3, 7, 5)
    np.testing.assert_allclose(gaps.pinion_error, across * pinion, rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(gaps.gear_error, -across * gear, rtol=1e-9, atol=1e-15)


def test_a_ripple_starts_at_its_phase_and_the_tooth_that_meets_first(unequal):
    """Order 3 of the gear turns by 3 * 2 pi/38 a mesh cycle; its tooth 5 is four cycles on at t = 0."""
    ripple = {"shaft": "gear", "order": 3, "amplitude": 1.5, "phase": 40}
    pair = unequal.with_({"operating.torque_ripple": [ripple], "mesh.first_teeth": [2, 5]})
    angle = 3.0 * 2.0 * np.pi / 38.0
    (row,) = ripples(pair)
    assert row == pytest.approx([1.0, angle, np.radians(40.0) + 4.0 * angle, 1.5, 38.0], rel=1e-12)


@pytest.mark.parametrize(("path", "entry", "most"), [
    ("gear.faults", {"kind": "crack", "tooth": 3, "depth": 0.1}, 1000),
    ("operating.torque_ripple", {"shaft": "gear", "order": 5, "amplitude": 0.1}, 100),
])  # fmt: skip
def test_lists_are_as_long_as_they_may_be_and_no_longer(nasa, path, entry, most):
    nasa.with_({path: [entry] * most})
    with pytest.raises(ParameterError, match=f"at most {most}"):
        nasa.with_({path: [entry] * (most + 1)})
