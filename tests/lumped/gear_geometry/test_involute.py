"""Is the usable involute the one that a rack cuts? Answered by cutting, point by point."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq

from lumped.gear_geometry.tooth_profile import ToothProfile, inverse_involute, involute, tooth_half_angle


@given(angle=st.floats(1e-3, 1.4))
def test_inverse_involute(angle):
    # d inv/d angle = tan^2(angle): a rounding of inv(angle) moves the angle by that over tan^2.
    slack = 1e-15 * (1 + 1 / math.tan(angle) ** 2)
    assert inverse_involute(involute(angle)) == pytest.approx(angle, abs=4 * slack)


def rack_depth(x, y, alpha, pitch_half_width, depth, radius):
    """How deep a point (x along the pitch line, y below it) lies inside the rounded rack tooth; < 0 outside.

    The tooth is every point within ``radius`` of an inner tooth with sharp corners.
    """
    x = np.abs(x)
    sine, cosine = math.sin(alpha), math.cos(alpha)
    corner_y = depth - radius
    corner_x = pitch_half_width - corner_y * math.tan(alpha) - radius / cosine
    # Signed distances to the inner tooth's flank line and tip line, positive outside.
    flank = (x - corner_x) * cosine + (y - corner_y) * sine
    tip = y - corner_y
    along = -(x - corner_x) * sine + (y - corner_y) * cosine  # < 0: the flank point is above the corner
    outside = np.where(
        (x <= corner_x) & (tip > 0),
        tip,
        np.where(
            (flank > 0) & (along > 0) & (x > corner_x), np.hypot(x - corner_x, tip), np.maximum(flank, tip)
        ),
    )
    return radius - outside


def cut_depth(radius, z, alpha, shift, dedendum, fillet):
    """Largest depth that the rolling rack reaches below each involute point; 0 where it cuts the involute."""
    # module 1
    r = 0.5 * z
    r_b = 0.5 * z * math.cos(alpha)
    profile = np.arccos(r_b / radius)
    thickness = 0.5 * math.pi + 2 * shift * math.tan(alpha)
    half_tooth = thickness / (2 * r) + involute(alpha) - (np.tan(profile) - profile)
    angle = math.pi / z - half_tooth  # from the space's centre line
    best = np.full(radius.shape, -np.inf)
    centre = np.zeros(radius.shape)
    width = 1.3 * max(1.0, 20 / z)
    for _ in range(3):  # a coarse search over the roll, twice refined about its best
        roll = centre[:, None] + np.linspace(-width, width, 6001)
        phase = angle[:, None] + roll
        x = radius[:, None] * np.sin(phase) - r * roll
        y = r - radius[:, None] * np.cos(phase)
        depth = rack_depth(x, y, alpha, 0.25 * math.pi - shift * math.tan(alpha), dedendum - shift, fillet)
        j = depth.argmax(axis=1)
        best = np.maximum(best, depth[np.arange(radius.size), j])
        centre = roll[np.arange(radius.size), j]
        width /= 1500
    return best


RACKS = [
    # z, alpha, x, dedendum, tip radius, whether undercut
    (10, 20, 0.0, 1.25, 0.38, True),
    (12, 20, 0.1, 1.25, 0.38, True),
    (14, 20, 0.0, 1.25, 0.30, True),
    (16, 20, 0.0, 1.4, 0.20, True),
    (9, 14.5, 0.0, 1.2, 0.20, True),
    # Only just undercut, within 3e-3 of a module above the base circle.
    (27, 13.946871753408873, 0.030046593812647182, 1.0767425681923222, 0.1784657295885227, True),
    (40, 14.861625893261618, -0.7705433101076887, 0.969790002565236, 0.3191553018447578, True),
    (22, 14.5, 0.0, 1.25, 0.30, True),
    (28, 20, 0.0, 1.25, 0.38, False),
    (20, 20, 0.3, 1.25, 0.38, False),
    (25, 25, 0.0, 1.25, 0.25, False),
    (60, 20, -0.4, 1.25, 0.38, False),
    (16, 20, 0.1817, 1.25, 0.25, False),
]


@pytest.mark.parametrize(("z", "degrees", "shift", "dedendum", "fillet", "undercut"), RACKS)
def test_form_circle_against_cutting(z, degrees, shift, dedendum, fillet, undercut):
    alpha = math.radians(degrees)
    r = 0.5 * z
    r_b = 0.5 * z * math.cos(alpha)
    length = ToothProfile(z, 1.0, alpha, shift, dedendum, fillet).form_length
    form = math.hypot(r_b, length)
    closed = r * math.sin(alpha) - (dedendum - fillet * (1 - math.sin(alpha)) - shift) / math.sin(alpha)
    assert (closed < 0) == undercut
    tip = r + 1.0 + shift
    above = np.linspace(form + 2e-3, tip, 40)
    # The roll is found to 1e-6 rad, so a depth is known to about r * 1e-12; 1e-9 is far from any undercut.
    assert np.abs(cut_depth(above, z, alpha, shift, dedendum, fillet)).max() < 1e-9
    below = np.linspace(r_b * (1 + 1e-9), form - 2e-3, 40)
    below = below[(below < form - 1e-3) & (below > r_b)]
    if below.size:
        depth = cut_depth(below, z, alpha, shift, dedendum, fillet)
        if undercut:
            assert depth[-1] > 1e-9  # just below the crossing the fillet has cut the involute away
        else:
            assert depth[-1] < -1e-9  # material is left over: no involute yet
    if undercut:
        # The crossing is transversal: locate it to the accuracy of the search.
        form_by_cutting = brentq(
            lambda radius: cut_depth(np.array([radius]), z, alpha, shift, dedendum, fillet)[0] - 1e-8,
            form - 2e-3,
            form + 1e-4,
            xtol=1e-9,
        )
        assert form_by_cutting == pytest.approx(form, abs=2e-5)


@pytest.mark.parametrize(("z", "degrees", "shift", "dedendum", "fillet", "undercut"), RACKS)
def test_trochoid_is_the_boundary_of_the_cut(z, degrees, shift, dedendum, fillet, undercut):
    """Each trochoid point touches the rack at its own roll, and its lowest point is the root circle."""
    alpha = math.radians(degrees)
    roll = np.linspace(-0.2, 0.2, 9)
    tooth = ToothProfile(z, 1.0, alpha, shift, dedendum, fillet)
    r = 0.5 * z
    # The rack frame slides along by r * roll while the gear turns by roll.
    x, along = tooth.trochoid(roll)
    y = r - along
    depth = rack_depth(x + 0.0, y, alpha, 0.25 * math.pi - shift * math.tan(alpha), dedendum - shift, fillet)
    half_width = (
        0.25 * math.pi - (dedendum - fillet) * math.tan(alpha) - fillet / math.cos(alpha)
    )  # tip circle centre from the tooth's centre line
    touching = np.hypot(x - (half_width - r * roll), y - (dedendum - shift - fillet)) - fillet
    assert np.abs(touching).max() < 1e-12
    assert depth.shape == roll.shape
    root = np.hypot(*tooth.trochoid(np.array(half_width / r)))
    assert root == pytest.approx(r - dedendum + shift, rel=1e-14)
    assert np.hypot(x, along).min() >= root - 1e-12


def test_tooth_half_angle_at_the_reference_circle():
    alpha = math.radians(20)
    # s = m (pi/2 + 2 x tan(alpha)) on the reference circle of radius m z/2, by the definition of x.
    assert tooth_half_angle(28, 0.3, alpha, alpha) == pytest.approx(
        (math.pi / 2 + 0.6 * math.tan(alpha)) / 28, rel=1e-14
    )


def test_standard_teeth_of_a_pair_fill_the_pitch():
    alpha = math.radians(20)
    half = [tooth_half_angle(z, x, alpha, alpha) * z for z, x in ((25, 0.2), (31, -0.2))]
    assert sum(half) == pytest.approx(math.pi, rel=1e-14)


def test_undercut_grows_from_nothing():
    """As the shift falls below d - rho (1 - sin a) - (z/2) sin^2 a, here 1 - 8.5 sin^2(20 deg)."""
    alpha = math.radians(20)
    limit = 1.0 - 8.5 * math.sin(alpha) ** 2
    lacking = np.logspace(-18, -2, 120)
    fillet = 0.25 / (1 - math.sin(alpha))
    lengths = [ToothProfile(17, 1.0, alpha, limit - e, 1.25, fillet).form_length for e in lacking]
    # The crossing is at most as far beyond X as the flank's end falls short of it, e/sin(a). Lengths below
    # 1e-4 of a module, a form radius 1e-9 of a module beyond the base circle, do not count.
    assert np.all(np.diff(lengths) >= -1e-4)
    assert np.all(np.array(lengths) <= lacking / math.sin(alpha) + 1e-4)
    assert lengths[-1] > 1e-3


@pytest.mark.parametrize(
    ("z", "alpha", "shift", "dedendum", "fillet"),
    [
        # Found by search: the trochoid's depth is below rounding where it passes the base circle.
        (81, 0.23080577008515268, -1.4353245316593124, 0.9475775213877308, 0.34154099905330737),
        (116, 0.1764933654101075, -0.5125017671791579, 1.5758501294228693, 0.3642612045811606),
    ],
)
def test_an_undercut_within_rounding_has_a_crossing_too(z, alpha, shift, dedendum, fillet):
    sine = math.sin(alpha)
    lacking = dedendum - fillet * (1 - sine) - shift - 0.5 * z * sine**2
    assert lacking > 1e-4 * sine  # so that it counts as undercut
    length = ToothProfile(z, 1.0, alpha, shift, dedendum, fillet).form_length
    assert 0.0 <= length <= lacking / sine + 1e-4
