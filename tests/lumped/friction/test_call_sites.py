"""Is each formula of the contact called with the right argument, gear and unit? On pairs with unlike gears.

The formulas themselves have their numbers in their docstrings. What they are called with is derived here from
the numbers of the file, in SI (``tests.guards.by_hand``).
"""

import math

import numpy as np
import pytest

from lumped.friction import benedict_kelley, xu_kahraman
from lumped.friction.iso_14179 import iso_14179_mean_coefficient
from lumped.path_of_contact import (
    contact_path,
    friction_path_function,
)
from tests.guards.by_hand import Contact
from tests.unlike_pairs import unlike_pair

ROUNDING = 1e-9  # positions cancel some digits of lengths; powers of less than 1 keep the others
FIT = 1e-9  # fits are asked for 1e-10; between its probes the error may be a few times that


def test_conditions_over_the_path(unlike):
    path = contact_path(unlike)
    by_hand = Contact(unlike)
    expected = {
        "hertz_pressure": by_hand.pressure,
        "half_width": by_hand.half_width,
        "entraining_velocity": by_hand.entraining,
        "film_thickness": by_hand.film,
        "film_parameter": by_hand.film_parameter,
    }
    for name, values in expected.items():
        np.testing.assert_allclose(getattr(path, name)(by_hand.xi), values, rtol=ROUNDING, err_msg=name)
    # Near P the two rolling velocities cancel: the error is a share of each of them.
    largest = by_hand.entraining.max()
    np.testing.assert_allclose(
        path.sliding_velocity(by_hand.xi), by_hand.sliding, rtol=0, atol=1e-12 * largest
    )
    ratio = 2.0 * by_hand.sliding / by_hand.entraining
    np.testing.assert_allclose(path.slide_to_roll(by_hand.xi), ratio, rtol=0, atol=1e-11)


def test_what_laws_read_of_the_pair(unlike):
    path = contact_path(unlike)
    by_hand = Contact(unlike)
    assert path.unit_load == pytest.approx(by_hand.unit_load, rel=ROUNDING)
    assert path.effective_modulus == pytest.approx(by_hand.modulus, rel=ROUNDING)
    assert path.roughness == pytest.approx(0.5 * (unlike.pinion.roughness + unlike.gear.roughness), rel=1e-14)
    squares = unlike.pinion.roughness**2 + unlike.gear.roughness**2
    assert path.composite_roughness == pytest.approx(math.sqrt(squares), rel=1e-14)
    assert path.pitch_line_velocity == pytest.approx(by_hand.pitch_line, rel=ROUNDING)
    rough_pair = unlike.with_(friction__composite_roughness=0.2)
    assert contact_path(rough_pair).composite_roughness == pytest.approx(0.2e-6, rel=1e-14)


def test_the_film_of_an_oil_that_is_not_the_default():
    """k = 0.009 and s = 0.17 at 33 mPa s: alpha = 0.009 * 33^0.17 = 0.0163 mm^2/N; exchanged, 0.1754."""
    pair = unlike_pair("rack_25_degrees_always_pushing")
    pitch = np.array([Contact(pair).pitch])
    alpha = 0.009 * 33.0**0.17 * 1e-6
    film = float(contact_path(pair).film_thickness(pitch)[0])
    # Two flanks of 206 GPa, 0.3 and 172 GPa, 0.26; 240 N m on r_b = 1.5 * 23 cos(25 deg) mm, 18 mm wide.
    modulus = 2e9 / ((1 - 0.3**2) / 206.0 + (1 - 0.26**2) / 172.0)
    load = 240.0 / (1.5e-3 * 23 * math.cos(math.radians(25.0))) / 18e-3
    rho = Contact(pair, pitch).radius[0]
    rolling = Contact(pair, pitch).entraining[0]
    speed = 33e-3 * rolling / (2.0 * modulus * rho)
    expected = 3.06 * (alpha * modulus) ** 0.56 * speed**0.69 * (load / modulus / rho) ** -0.1 * rho
    assert film == pytest.approx(expected, rel=ROUNDING)


def test_law_two_is_called_with_its_units(unlike):
    by_hand = Contact(unlike)
    magnitude = benedict_kelley(
        1e-3 * by_hand.unit_load, 1e3 * by_hand.viscosity, by_hand.sliding, by_hand.entraining,
        1e6 * by_hand.roughness, maximum=unlike.friction.maximum,
    )  # fmt: skip
    mu = friction_path_function(unlike, "benedict_kelley", warn=False)(by_hand.xi)
    np.testing.assert_allclose(mu, np.sign(by_hand.xi - by_hand.pitch) * magnitude, rtol=0, atol=FIT)


def test_law_three_is_called_with_its_units(unlike):
    by_hand = Contact(unlike)
    magnitude = xu_kahraman(
        1e-9 * by_hand.pressure, 2.0 * by_hand.sliding / by_hand.entraining, 0.5 * by_hand.entraining,
        1e3 * by_hand.viscosity, 1e6 * by_hand.roughness, by_hand.radius,
    )  # fmt: skip
    mu = friction_path_function(unlike, "xu_kahraman", warn=False)(by_hand.xi)
    np.testing.assert_allclose(mu, np.sign(by_hand.xi - by_hand.pitch) * magnitude, rtol=0, atol=FIT)


def test_the_iso_law_is_called_with_its_units(unlike):
    pitch = Contact(unlike, np.array([Contact(unlike).pitch]))
    magnitude = iso_14179_mean_coefficient(
        1e-3 * pitch.unit_load, pitch.entraining, 1e3 * pitch.radius, 1e3 * pitch.viscosity,
        1e6 * pitch.roughness,
    )  # fmt: skip
    mu = friction_path_function(unlike, "iso_14179", warn=False)(pitch.xi + np.array([-1e-4, 1e-4]))
    np.testing.assert_allclose(mu, [-magnitude[0], magnitude[0]], rtol=ROUNDING)
