"""Does the tooth stiffness reproduce ISO 6336-1 method B?"""

import math

import pytest

from lumped import load_gear_pair
from lumped.stiffness import iso6336


def test_worked_example_of_the_standard():
    # ISO/TR 6336-30:2017, example 1: helical 17/103, m_n 8 mm, beta 15.8 deg, x 0.145/0, rack with h_fP 1.4,
    # centre distance 500 mm, virtual teeth 18.905/114.543; its c'_th 17.85584, c' 12.37047,
    # c_gamma_alpha 17.46485 N/(mm um). The numbers are those that a public program quotes from the report's
    # annex (gfsReboucas/Drivetrain, MATISO_6336.m, example_01); the report itself was not at hand.
    theory = iso6336.theoretical_single_stiffness(18.905, 114.543, 0.145, 0.0)
    rack = iso6336.basic_rack_factor(1.4, 20.0)
    single = iso6336.single_stiffness(theory, basic_rack=rack, helix=15.8)
    # Virtual tooth numbers are given to 5e-4, which moves q' = 0.056 mm um/N by C2/z^2 times that, 2e-7.
    assert theory == pytest.approx(17.85584, rel=5e-6)
    assert single == pytest.approx(12.37047, rel=5e-6)
    # The ratio does not carry them: c'/c'_th = 0.8 * 0.9 * cos(15.8 deg), to the printed digits.
    assert single / theory == pytest.approx(12.37047 / 17.85584, rel=2e-6)
    # Transverse contact ratio of the example's gears with standard addendum m_n (1 + x).
    beta, m = math.radians(15.8), 8.0
    alpha_t = math.atan(math.tan(math.radians(20.0)) / math.cos(beta))
    r = [0.5 * z * m / math.cos(beta) for z in (17, 103)]
    base = [value * math.cos(alpha_t) for value in r]
    tip = [r[0] + m * 1.145, r[1] + m]
    path = sum(math.sqrt(a**2 - b**2) for a, b in zip(tip, base, strict=True)) - math.sqrt(
        500.0**2 - sum(base) ** 2
    )
    contact_ratio = path / (math.pi * m / math.cos(beta) * math.cos(alpha_t))
    # The example's tip diameters are not quoted; the standard addendum gives 17.4672, 0.014 % more.
    assert iso6336.mean_mesh_stiffness(12.37047, contact_ratio) == pytest.approx(17.46485, rel=2e-4)


def test_the_standards_gear_one_is_the_smaller_whichever_drives():
    pair = load_gear_pair("nasa_28_28").with_(
        centre_distance=None, pinion__profile_shift=0.1, gear__teeth=40, gear__tip_relief=None
    )
    swapped = pair.with_(
        pinion__teeth=40, pinion__profile_shift=0.0, pinion__tip_relief=None, gear__teeth=28,
        gear__profile_shift=0.1,
    )  # fmt: skip
    assert iso6336.pair_single_stiffness(pair) == iso6336.pair_single_stiffness(swapped)


def test_ranges_are_data_and_reported():
    pair = load_gear_pair("nasa_28_28")
    strong = pair.with_(operating__pinion_torque=56.5)
    assert iso6336.violations(strong) == ()
    weak = pair.with_(operating__pinion_torque=22.6)  # 508 N on 6.35 mm: 80 N/mm
    (found,) = iso6336.violations(weak)
    assert found.range.quantity == "load per face width"
    # F_t/b = 22.6 N m / 44.45 mm / 6.35 mm
    assert found.minimum == pytest.approx(22.6e3 / 44.45 / 6.35, rel=1e-12)
