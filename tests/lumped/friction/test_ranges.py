"""Do the laws say where they do not hold, how far the contact is outside, and once only?

The limits and the numbers compared with them: tests/guards, tests/lumped/path_of_contact.
"""

import warnings

import numpy as np
import pytest

import lumped
from lumped import load_gear_pair
from lumped.errors import LawRangeWarning
from lumped.friction import LAWS
from lumped.path_of_contact import (
    contact_path,
    friction_path_function,
    law_range_violations,
)
from lumped.ranges import ValidityRange, range_violations


@pytest.fixture(scope="module")
def slow():
    """A small slow pair: 48/48, m 1, 50 rpm; law II gives a mean mu of a dry contact."""
    return load_gear_pair("kahraman_blankenship_50_50").with_(
        pinion__teeth=48, gear__teeth=48, basic_rack__module=1.0, centre_distance=48.0, mesh__backlash=0.1,
        operating__pinion_speed=50.0, operating__pinion_torque=5.0,
    )  # fmt: skip


@pytest.mark.parametrize(("law", "quantity"), [
    ("benedict_kelley", "mean_coefficient"),
    ("xu_kahraman", "mean_rolling_velocity"),
    ("iso_14179", "unit_load"),
])  # fmt: skip
def test_a_slow_small_pair_is_outside_and_the_warning_says_how_far(slow, law, quantity):
    (violation,) = (v for v in law_range_violations(slow, law) if v.range.quantity == quantity)
    function = friction_path_function(slow, law)
    path = contact_path(slow)
    xi = np.linspace(path.L_XA, path.L_XD, 203)[1:-1]
    assert violation.largest == pytest.approx(np.abs(function(xi)).max(), abs=1e-9)
    assert violation.share == 1.0
    with pytest.warns(LawRangeWarning) as caught:
        friction_path_function(slow, law)
    (one,) = (w.message for w in caught if w.message.subject == f"{LAWS[law].title}: {quantity}")
    assert violation.range.words in str(one)
    assert f"{violation.minimum:.4g}" in str(one)
    assert f"mu is up to {violation.largest:.2g}" in str(one)


@pytest.mark.parametrize("name", ["fzg_c", "nasa_28_28", "high_contact_ratio_29_47"])
def test_ordinary_pairs_are_inside(name):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for law in ("benedict_kelley", "xu_kahraman", "iso_14179"):
            friction_path_function(load_gear_pair(name), law)


def test_a_sweep_warns_once_and_of_its_worst_speed(slow):
    speeds = [30.0, 20.0, 10.0]
    with pytest.warns(LawRangeWarning) as caught:
        lumped.speed_sweep(slow, speeds, samples_per_cycle=32)
    subjects = [w.message.subject for w in caught]
    assert len(subjects) == len(set(subjects)) >= 2
    (one,) = (w.message for w in caught if w.message.subject.endswith("mean_rolling_velocity"))
    each = [slow.with_(operating__pinion_speed=rpm) for rpm in speeds]
    largest = [
        v.largest
        for pair in each
        for v in law_range_violations(pair)
        if v.range.quantity == "mean_rolling_velocity"
    ]
    # The sweep follows contact beyond A and D too, so its largest mu is not below that of the path.
    assert one.largest >= max(largest) > min(largest)


def test_only_positions_outside_give_the_largest_coefficient():
    limits = ValidityRange("speed", "m/s", None, 2.0, "test")
    (violation,) = range_violations("law", (limits,), {"speed": [1.0, 3.0, 4.0]}, [-0.9, 0.1, -0.3])
    assert (violation.largest, violation.share) == (0.3, pytest.approx(2.0 / 3.0))
    assert str(violation) == (
        "law: speed runs from 1 to 4 m/s, outside speed <= 2 m/s over 66.7 % of the positions, "
        "where mu is up to 0.3 (test)"
    )
