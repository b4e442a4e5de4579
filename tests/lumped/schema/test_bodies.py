"""Does each gear get its own mass, inertia, tip and flank? On pairs with unlike gears."""

import math

import pytest

from lumped.schema.bodies import bodies
from tests.guards.by_hand import ByHand


def disc(pair, gear):
    """Ring from bore to reference circle: rho pi (r^2 - r_i^2) b and m (r^2 + r_i^2)/2."""
    wheel = getattr(pair, gear)
    radius = 1e-3 * ByHand(pair, gear).r
    inner = 0.5 * wheel.bore
    mass = wheel.density * math.pi * (radius**2 - inner**2) * wheel.face_width
    return mass, 0.5 * mass * (radius**2 + inner**2)


def test_each_gear_is_a_disc_with_its_bore_width_and_density(unlike):
    masses = bodies(unlike)
    m_p, j_p = disc(unlike, "pinion")
    m_g, j_g = disc(unlike, "gear")
    assert masses.mass_pinion == pytest.approx(m_p, rel=1e-12)
    assert masses.mass_gear == pytest.approx(m_g, rel=1e-12)
    assert masses.inertia_pinion == pytest.approx(j_p, rel=1e-12)
    assert masses.inertia_gear == pytest.approx(j_g, rel=1e-12)
    r_bp, r_bg = (1e-3 * ByHand(unlike, gear).r_b for gear in ("pinion", "gear"))
    assert masses.effective_mass == pytest.approx(1.0 / (r_bp**2 / j_p + r_bg**2 / j_g), rel=1e-12)


@pytest.mark.parametrize(("gear", "mate"), [("pinion", "gear"), ("gear", "pinion")])
def test_a_given_mass_or_inertia_is_that_of_its_gear_alone(unlike, gear, mate):
    masses = bodies(unlike.with_({f"{gear}.mass": 3.3, f"{gear}.inertia": 0.017}))
    assert (getattr(masses, f"mass_{gear}"), getattr(masses, f"inertia_{gear}")) == (3.3, 0.017)
    assert getattr(masses, f"mass_{mate}") == pytest.approx(disc(unlike, mate)[0], rel=1e-12)
    assert getattr(masses, f"inertia_{mate}") == pytest.approx(disc(unlike, mate)[1], rel=1e-12)


@pytest.mark.parametrize(("gear_index", "gear"), [(0, "pinion"), (1, "gear")])
def test_a_flank_is_that_of_its_gear(unlike, gear_index, gear):
    flank = unlike.flank(gear_index)
    hand = ByHand(unlike, gear)
    assert flank.tip == pytest.approx(1e-3 * hand.tip_length, rel=1e-9)
    assert flank.start == pytest.approx(1e-3 * hand.start_length, rel=1e-9)
    assert flank.youngs_modulus == getattr(unlike, gear).youngs_modulus
    plane = sum((1.0 - one.poisson_ratio**2) / one.youngs_modulus for one in (unlike.pinion, unlike.gear))
    width = min(unlike.pinion.face_width, unlike.gear.face_width)
    assert flank.face_width == width
    assert flank.hertz == pytest.approx(2.0 * plane / (math.pi * width), rel=1e-12)
