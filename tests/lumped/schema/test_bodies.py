"""Does each gear get its own mass, inertia, tip and flank? On pairs with unlike gears."""

import math

import pytest

from lumped.schema.bodies import bodies
from tests.guards.by_hand import ByHand


def disc(pair, gear):
    """Ring from bore to reference circle: rho pi (r^2 - r_i^2) b and m (r^2 + r_i^2)/2."""
    own = getattr(pair, gear)
    radius = 1e-3 * ByHand(pair, gear).r
    inner = 0.5 * own.bore
    mass = own.density * math.pi * (radius**2 - inner**2) * own.face_width
    return mass, 0.5 * mass * (radius**2 + inner**2)


def test_each_gear_is_a_disc_with_its_bore_width_and_density(unlike):
    found = bodies(unlike)
    (m_p, j_p), (m_g, j_g) = disc(unlike, "pinion"), disc(unlike, "gear")
    assert found.mass_pinion == pytest.approx(m_p, rel=1e-12)
    assert found.mass_gear == pytest.approx(m_g, rel=1e-12)
    assert found.inertia_pinion == pytest.approx(j_p, rel=1e-12)
    assert found.inertia_gear == pytest.approx(j_g, rel=1e-12)
    r_bp, r_bg = (1e-3 * ByHand(unlike, gear).r_b for gear in ("pinion", "gear"))
    assert found.effective_mass == pytest.approx(1.0 / (r_bp**2 / j_p + r_bg**2 / j_g), rel=1e-12)


@pytest.mark.parametrize(("gear", "mate"), [("pinion", "gear"), ("gear", "pinion")])
def test_a_given_mass_or_inertia_is_that_of_its_gear_alone(unlike, gear, mate):
    found = bodies(unlike.with_({f"{gear}.mass": 3.3, f"{gear}.inertia": 0.017}))
    assert (getattr(found, f"mass_{gear}"), getattr(found, f"inertia_{gear}")) == (3.3, 0.017)
    assert getattr(found, f"mass_{mate}") == pytest.approx(disc(unlike, mate)[0], rel=1e-12)
    assert getattr(found, f"inertia_{mate}") == pytest.approx(disc(unlike, mate)[1], rel=1e-12)


@pytest.mark.parametrize(("which", "gear"), [(0, "pinion"), (1, "gear")])
def test_a_flank_is_that_of_its_gear(unlike, which, gear):
    found = unlike.flank(which)
    hand = ByHand(unlike, gear)
    assert found.tip == pytest.approx(1e-3 * hand.tip_length, rel=1e-9)
    assert found.start == pytest.approx(1e-3 * hand.start_length, rel=1e-9)
    assert found.youngs_modulus == getattr(unlike, gear).youngs_modulus
    plane = sum((1.0 - one.poisson_ratio**2) / one.youngs_modulus for one in (unlike.pinion, unlike.gear))
    width = min(unlike.pinion.face_width, unlike.gear.face_width)
    assert found.face_width == width
    assert found.hertz == pytest.approx(2.0 * plane / (math.pi * width), rel=1e-12)
