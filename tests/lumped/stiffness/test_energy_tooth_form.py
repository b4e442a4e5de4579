"""Is the tooth form of the energy method the one that the rack cuts?"""

import math

import numpy as np
import pytest

from lumped.gear_geometry.tooth_profile import ToothProfile, tooth_half_angle

MODULE = 3e-3
GEARS = [(28, 0.0, 20.0, 0.38), (12, 0.0, 20.0, 0.38), (16, 0.18, 20.0, 0.2), (60, -0.2, 25.0, 0.3)]
GEARS += [(40, 0.95, 20.0, 0.38)]  # the rack's tip circle has its centre above the pitch line
ROUNDING = 1e-12  # of lengths and angles of order one module or one radian, a few operations each


@pytest.fixture(params=GEARS, ids=lambda g: f"z{g[0]}_x{g[1]}")
def profile(request):
    teeth, shift, angle, fillet = request.param
    return ToothProfile(teeth, MODULE, math.radians(angle), shift, 1.25, fillet)


def test_involute_has_the_tooth_thickness_of_the_standard(profile):
    length = np.linspace(profile.form_length, 0.6 * profile.base_radius, 9)
    u, h, _, _ = profile.involute_points(length)
    radius = np.hypot(profile.base_radius, length)
    assert np.hypot(u, h) == pytest.approx(radius, rel=ROUNDING)
    half = [
        tooth_half_angle(
            profile.teeth, profile.profile_shift, profile.pressure_angle, math.acos(profile.base_radius / r)
        )
        for r in radius
    ]
    assert np.arctan2(h, u) == pytest.approx(half, abs=ROUNDING)


def test_load_angle_is_the_normal_of_the_flank(profile):
    # The tangent (du, dh) of the flank is normal to the line of action (sin a, cos a) through the contact.
    length = np.linspace(1.1 * profile.form_length, 0.6 * profile.base_radius, 7)
    step = 1e-7 * MODULE
    ahead, behind = profile.involute_points(length + step), profile.involute_points(length - step)
    du, dh = (ahead[0] - behind[0]) / (2 * step), (ahead[1] - behind[1]) / (2 * step)
    _, _, slope, angle = profile.involute_points(length)
    assert du == pytest.approx(slope, abs=1e-7)  # central difference of step 1e-7 modules
    assert du * np.sin(angle) + dh * np.cos(angle) == pytest.approx(0.0, abs=1e-7)
    # The line of action touches the base circle: r_b = u cos a - h sin a.
    u, h, _, _ = profile.involute_points(length)
    assert u * np.cos(angle) - h * np.sin(angle) == pytest.approx(profile.base_radius, rel=ROUNDING)


def test_fillet_is_the_rack_tips_envelope_and_meets_both_neighbours(profile):
    roll = np.linspace(*profile.fillet_range, 15)
    u, h, slope = profile.fillet_points(roll)
    x, y = profile.trochoid(roll)
    from_space = np.arctan2(x, y) + roll
    assert np.hypot(u, h) == pytest.approx(np.hypot(x, y), rel=ROUNDING)
    assert np.arctan2(h, u) == pytest.approx(math.pi / profile.teeth - from_space, abs=ROUNDING)
    assert math.hypot(u[0], h[0]) == pytest.approx(profile.root_radius, rel=ROUNDING)
    start = profile.involute_points(np.array([profile.form_length]))
    # Where the rack undercuts, form_length is a root found to 2e-12 rad at a nearly tangent crossing.
    assert (u[-1], h[-1]) == pytest.approx((start[0][0], start[1][0]), abs=5e-9 * MODULE)
    step = 1e-6
    difference = (profile.fillet_points(roll + step)[0] - profile.fillet_points(roll - step)[0]) / (2 * step)
    assert difference == pytest.approx(slope, rel=1e-7)  # second-order difference of step 1e-6
