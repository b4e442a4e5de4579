"""Do the laws say where they do not hold, and does the mean coefficient of ISO/TR 14179-2 serve as a law?"""

import math
import warnings

import numpy as np
import pytest

import lumped
from lumped import load_gear_pair
from lumped.errors import LawRangeWarning
from lumped.friction import LAWS
from lumped.friction.base import MEAN_COEFFICIENT
from lumped.path_of_contact import (
    contact_path,
    friction_path_function,
    friction_profile,
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
    (found,) = (v for v in law_range_violations(slow, law) if v.range.quantity == quantity)
    function, path = friction_path_function(slow, law), contact_path(slow)
    xi = np.linspace(path.L_XA, path.L_XD, 203)[1:-1]
    assert found.largest == pytest.approx(np.abs(function(xi)).max(), abs=1e-9)
    assert found.share == 1.0
    velocity = 48.0e-3 * math.sin(math.radians(20.0)) * 50.0 * math.pi / 30.0  # 1:1: constant along the path
    expected = {
        "mean_rolling_velocity": 0.5 * velocity,
        "unit_load": 5.0 / (24.0 * math.cos(math.radians(20.0)) * 20e-3),
    }
    assert found.maximum == pytest.approx(expected.get(quantity, found.maximum), rel=1e-9)
    with pytest.warns(LawRangeWarning) as told:
        friction_path_function(slow, law)
    (one,) = (w.message for w in told if w.message.subject == f"{LAWS[law].title}: {quantity}")
    assert found.range.words in str(one)
    assert f"{found.minimum:.4g}" in str(one)
    assert f"mu is up to {found.largest:.2g}" in str(one)


def test_the_mean_is_what_a_measurement_gives(slow):
    (found,) = (v for v in law_range_violations(slow, "benedict_kelley") if v.range is MEAN_COEFFICIENT)
    profile = friction_profile(slow)
    mean = float(profile.mean_mu.sel(law="benedict_kelley"))
    assert mean > 0.1
    assert found.maximum == pytest.approx(mean, rel=0.01)  # 201 positions against the exact mean


@pytest.mark.parametrize("name", ["fzg_c", "nasa_28_28", "high_contact_ratio_29_47"])
def test_ordinary_pairs_are_inside(name):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for law in ("benedict_kelley", "xu_kahraman", "iso_14179"):
            friction_path_function(load_gear_pair(name), law)


def test_a_sweep_warns_once_and_of_its_worst_speed(slow):
    speeds = [30.0, 20.0, 10.0]
    with pytest.warns(LawRangeWarning) as told:
        lumped.speed_sweep(slow, speeds, samples_per_cycle=32)
    subjects = [w.message.subject for w in told]
    assert len(subjects) == len(set(subjects)) >= 2
    (one,) = (w.message for w in told if w.message.subject.endswith("mean_rolling_velocity"))
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
    (found,) = range_violations("law", (limits,), {"speed": [1.0, 3.0, 4.0]}, [-0.9, 0.1, -0.3])
    assert (found.largest, found.share) == (0.3, pytest.approx(2.0 / 3.0))
    assert str(found) == (
        "law: speed runs from 1 to 4 m/s, outside speed <= 2 m/s over 66.7 % of the positions, "
        "where mu is up to 0.3 (test)"
    )


@pytest.fixture(scope="module")
def unequal():
    """16/24 with profile shifts, so that the operating circles are not the reference circles."""
    return load_gear_pair("fzg_c").with_(friction__law="iso_14179", mesh__contact="prescribed")


def test_the_iso_law_from_the_geometry_alone(unequal):
    """mu = 0.048 (w/(v rho))^0.2 eta^-0.05 Ra^0.25 with v = 2 v_t sin(alpha_w), rho at the pitch point."""
    rack, g = unequal.basic_rack, lumped.geometry(unequal)
    teeth = unequal.pinion.teeth, unequal.gear.teeth
    assert teeth[0] != teeth[1]
    base = [0.5 * rack.module * z * math.cos(rack.pressure_angle) for z in teeth]
    alpha = math.acos(sum(base) / g.centre_distance)
    assert abs(alpha - rack.pressure_angle) > math.radians(1.0)
    operating = [g.centre_distance * z / sum(teeth) for z in teeth]
    rho_p, rho_g = (r * math.sin(alpha) for r in operating)
    width = min(unequal.pinion.face_width, unequal.gear.face_width)
    w = unequal.operating.pinion_torque / base[0] / width  # N/m
    v = 2.0 * unequal.operating.pinion_speed * operating[0] * math.sin(alpha)
    rho = rho_p * rho_g / (rho_p + rho_g)
    eta, ra = unequal.lubricant.dynamic_viscosity, 0.5 * (unequal.pinion.roughness + unequal.gear.roughness)
    mu = 0.048 * (1e-3 * w / (v * 1e3 * rho)) ** 0.2 * (1e3 * eta) ** -0.05 * (1e6 * ra) ** 0.25
    function, path = friction_path_function(unequal), contact_path(unequal)
    before, behind = function(np.array([path.L_XP - 1e-4, path.L_XP + 1e-4]))
    assert (-before, behind) == (pytest.approx(mu, rel=1e-12), pytest.approx(mu, rel=1e-12))
    assert path.pitch_line_velocity == pytest.approx(v / (2.0 * math.sin(alpha)), rel=1e-12)
