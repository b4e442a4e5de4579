"""Does the energy method repeat a published value when given its tooth, and is the fillet the rack's?"""

import math

import numpy as np
import pytest

from lumped.gear_geometry.tooth_profile import ToothProfile
from lumped.stiffness.energy import beam_compliance, linear_hertz_compliance
from lumped.stiffness.foundation import coefficients

E, NU = 206e9, 0.3


class BaseCircleTooth(ToothProfile):
    """An involute from the base circle, with no fillet below."""

    form_length = 0.0
    fillet_range = (0.0, 0.0)


def tooth(teeth, module=3e-3):
    return BaseCircleTooth(teeth, module, math.radians(20.0), 0.0, 1.25, 0.38)


def test_deflection_of_a_published_gear_pair():
    # F. H. A. S. Dias, G. C. Silva, D. S. Chui, Vibration attenuation on spur gears through optimal profile
    # modification, J. Braz. Soc. Mech. Sci. Eng. 46 (2024) 10: 27/35 teeth, m 3 mm, b 25 mm, E 206 GPa, 80 kW
    # at 2000 rpm; the authors' program gives F/min(k) = 43.881 um in single contact. Their tooth stands on
    # the base circle, their body has h_f = 5, theta_f of the base circle, and S_f = theta_f m (z - 2.334).
    teeth, module, width = (27, 35), 3e-3, 25e-3
    profiles = [tooth(z, module) for z in teeth]
    tangents = [
        math.sqrt((0.5 * module * (z + 2)) ** 2 - p.base_radius**2)
        for z, p in zip(teeth, profiles, strict=True)
    ]
    between = 0.5 * module * sum(teeth) * math.sin(math.radians(20.0))
    pitch = math.pi * module * math.cos(math.radians(20.0))
    xi = np.linspace(tangents[0] - pitch, between - tangents[1] + pitch, 101)
    compliance = np.full(xi.shape, linear_hertz_compliance((E, E), (NU, NU)))
    for z, profile, length in zip(teeth, profiles, (xi, between - xi), strict=True):
        beam = beam_compliance(profile, length, E, NU)
        angle, theta = profile.involute_points(length)[3], profile.base_half_angle
        l_, m_, p_, q_ = coefficients(5.0, theta)
        lever = profile.base_radius * (1 / np.cos(angle) - math.cos(theta)) / (theta * module * (z - 2.334))
        body = np.cos(angle) ** 2 / E * (l_ * lever**2 + m_ * lever + p_ * (1 + q_ * np.tan(angle) ** 2))
        compliance += beam.bending + beam.shear + beam.axial + body
    force = 80e3 / (2000 * math.pi / 30) / profiles[0].base_radius
    # Theirs is the least of some 15 samples per mesh cycle, which misses the end of single contact: 0.5 %.
    assert (force / width * compliance).max() * 1e6 == pytest.approx(43.881, rel=5e-3)


MODULE = 3e-3
GEARS = [(28, 0.0, 20.0, 0.38), (12, 0.0, 20.0, 0.38), (16, 0.18, 20.0, 0.2), (60, -0.2, 25.0, 0.3)]
GEARS += [(40, 0.95, 20.0, 0.38)]  # the rack's tip circle has its centre above the pitch line
ROUNDING = 1e-12  # of lengths and angles of order one module or one radian, a few operations each


@pytest.fixture(params=GEARS, ids=lambda g: f"z{g[0]}_x{g[1]}")
def profile(request):
    teeth, shift, angle, fillet = request.param
    return ToothProfile(teeth, MODULE, math.radians(angle), shift, 1.25, fillet)


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
