"""Are masses and inertias those given, else the disc's?"""

import math

import pytest
from scipy.integrate import quad

from lumped import bodies, geometry


def test_disc_by_integration(nasa):
    b = bodies(nasa.with_(pinion__bore=30))
    r, width, rho = 44.45e-3, 6.35e-3, 7850.0
    mass, _ = quad(lambda s: rho * 2 * math.pi * s * width, 15e-3, r)
    inertia, _ = quad(lambda s: rho * 2 * math.pi * s**3 * width, 15e-3, r)
    assert b.mass_pinion == pytest.approx(mass, rel=1e-12)  # quadrature of a polynomial
    assert b.inertia_pinion == pytest.approx(inertia, rel=1e-12)


def test_given_values_win_one_by_one(nasa):
    b = bodies(nasa.with_(pinion__mass=0.5, gear__inertia=1e-3))
    disc = bodies(nasa)
    assert (b.mass_pinion, b.inertia_gear) == (0.5, 1e-3)
    assert (b.mass_gear, b.inertia_pinion) == (disc.mass_gear, disc.inertia_pinion)


def test_each_gear_has_its_own_disc(unequal):
    b = bodies(unequal.with_(pinion__mass=None, pinion__inertia=None, gear__mass=None, gear__inertia=None))
    # At equal width mass grows with the square of the teeth, inertia with the fourth power.
    assert b.mass_gear / b.mass_pinion == pytest.approx((31 / 25) ** 2, rel=1e-13)
    assert b.inertia_gear / b.inertia_pinion == pytest.approx((31 / 25) ** 4, rel=1e-13)


def test_effective_mass_is_that_of_two_free_rotors(unequal):
    """Two rotors joined by a spring k on their base circles vibrate at sqrt(k / m_e)."""
    g, b = geometry(unequal), bodies(unequal)
    k = 1e8
    r_p, r_g = g.base_radius_pinion, g.base_radius_gear
    # J_p theta_p'' = -k r_p (r_p theta_p - r_g theta_g), J_g theta_g'' = +k r_g (r_p theta_p - r_g theta_g)
    squared = k * (r_p**2 / b.inertia_pinion + r_g**2 / b.inertia_gear)
    assert k / b.effective_mass == pytest.approx(squared, rel=1e-13)
