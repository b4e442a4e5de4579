"""Does the energy method reproduce published formulas and a published value when given their tooth?

Most of the literature takes the tooth as an involute that stands on the base circle, without a fillet. Given
that tooth, the integrals here must equal the closed integrands of that literature.
"""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from lumped.gear_geometry.tooth_profile import ToothProfile, tooth_half_angle
from lumped.stiffness.energy import beam_compliance, linear_hertz_compliance
from lumped.stiffness.foundation import coefficients

E, NU = 206e9, 0.3


class BaseCircleTooth(ToothProfile):
    """An involute from the base circle, with no fillet below."""

    form_length = 0.0
    fillet_range = (0.0, 0.0)


def tooth(teeth, module=3e-3):
    return BaseCircleTooth(teeth, module, math.radians(20.0), 0.0, 1.25, 0.38)


@pytest.mark.parametrize("teeth", [19, 27, 62])
@pytest.mark.parametrize("over_module", [2.5, 4.0, 6.0])
def test_integrals_of_yang_lin_and_tian(teeth, over_module):
    # X. Tian, M. Zuo, K. Fyfe, Analysis of the vibration response of a gearbox with gear tooth faults, IMECE
    # 2004 (bending and compression as in Yang and Lin 1987); a_1 is the load angle, a_2 half the tooth on the
    # base circle, integration from -a_1 to a_2 over the angle of the involute.
    profile = tooth(teeth)
    length = over_module * profile.module
    a_1, a_2 = float(profile.involute_points(np.array([length]))[3][0]), profile.base_half_angle

    def half(x):
        return math.sin(x) + (a_2 - x) * math.cos(x)

    def bending(x):
        arm = 1 + math.cos(a_1) * ((a_2 - x) * math.sin(x) - math.cos(x))
        return 3 * arm**2 * (a_2 - x) * math.cos(x) / (2 * E * half(x) ** 3)

    def shear(x):
        return 1.2 * (1 + NU) * (a_2 - x) * math.cos(x) * math.cos(a_1) ** 2 / (E * half(x))

    def axial(x):
        return (a_2 - x) * math.cos(x) * math.sin(a_1) ** 2 / (2 * E * half(x))

    published = [quad(f, -a_1, a_2, epsrel=1e-12, epsabs=0.0)[0] for f in (bending, shear, axial)]
    found = beam_compliance(profile, np.array([length]), E, NU)
    # Two quadratures of the same integral.
    assert [found.bending[0], found.shear[0], found.axial[0]] == pytest.approx(published, rel=1e-10)


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


# ROSS 2.3.0 (petrobras/ross, GearElementTVMS, an implementation of H. Ma et al. 2014 with true fillets), run
# for the gear of its documentation: 62 teeth, m 2 mm, b 20 mm, bore 35 mm, E 211 GPa, G 81.2 GPa, tip radius
# of the rack 0.25 m/(1 - sin 20 deg). Pressure angle at the contact, then k_b, k_s, k_a, k_f [N/m] as it
# gives them.
ROSS = [
    (0.2777380345253824, 2.9058556613e11, 5.6316833598e09, 2.8124045592e11, 8.0070936314e08),
    (0.3490658503988659, 1.1777017855e10, 2.2936547345e09, 6.3527384460e10, 6.5103154076e08),
    (0.42672233774374957, 9.9084633695e08, 1.0547146148e09, 1.6995806631e10, 4.5232589735e08),
]


@pytest.mark.parametrize(("angle", "k_b", "k_s", "k_a", "k_f"), ROSS)
def test_components_of_an_independent_program(angle, k_b, k_s, k_a, k_f):
    sine = math.sin(math.radians(20.0))
    profile = ToothProfile(62, 2e-3, math.radians(20.0), 0.0, 1.25, 0.25 / (1.0 - sine))
    modulus, shear_modulus, width = 211e9, 81.2e9, 20e-3
    length = np.array([profile.base_radius * math.tan(angle)])
    beam = beam_compliance(profile, length, modulus, 0.5 * modulus / shear_modulus - 1.0)
    found = [width / part[0] for part in (beam.bending, beam.shear, beam.axial)]
    assert found == pytest.approx([k_b, k_s, k_a], rel=1e-10)  # printed digits
    # Its body formula differs in two inputs, not in the formula: the half tooth angle on the root circle is
    # taken without the rack's tip clearance, and u is measured to the contact instead of to where the load
    # crosses the centre line. With them the stiffness is the same.
    fillet = 0.25 / (1.0 - sine)
    tangent, cosine = math.tan(math.radians(20.0)), math.cos(math.radians(20.0))
    theta = (0.5 * math.pi + 2.0 * tangent * (1.0 - fillet) + 2.0 * fillet / cosine) / 62
    height, _, _, load_angle = (v[0] for v in profile.involute_points(length))
    lever = (height - profile.root_radius) / (2.0 * profile.root_radius * theta)
    l_, m_, p_, q_ = coefficients(profile.root_radius / 17.5e-3, theta)
    shape = l_ * lever**2 + m_ * lever + p_ * (1.0 + q_ * math.tan(load_angle) ** 2)
    assert modulus * width / (math.cos(load_angle) ** 2 * shape) == pytest.approx(k_f, rel=1e-10)


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
