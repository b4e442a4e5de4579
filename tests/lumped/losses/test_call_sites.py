"""Does each loss formula get the right gear and unit? On pairs with unlike gears, from their files."""

import math

import numpy as np
import pytest

from lumped.friction.iso_14179 import iso_14179_mean_coefficient
from lumped.losses import iso_14179_mesh_loss, loss_factor, ohlendorf_of
from tests.guards.by_hand import ByHand, Contact
from tests.unlike_pairs import unlike_pair

#: Closed form: contact ratio below 2 and P in single contact, eps_1 and eps_2 <= 1.
CLOSED = ("heavily_relieved_under_load", "larger_gear_drives_contact_lost", "rack_25_degrees_always_pushing",
          "unlike_teeth_finite_elements")  # fmt: skip


def by_hand(pair):
    """Ohlendorf 1958: pi (u + 1)/(z_1 u) (1 - eps + eps_1^2 + eps_2^2), u = z_2/z_1, z_1 the driving gear."""
    pinion, gear = ByHand(pair, "pinion"), ByHand(pair, "gear")
    pitch = pinion.r_b * math.tan(pinion.operating_angle)
    recess = (pinion.tip_length - pitch) / pinion.base_pitch
    approach = (pitch - pinion.start_length) / pinion.base_pitch
    assert max(recess, approach) <= 1.0
    u = gear.z / pinion.z
    return math.pi * (u + 1.0) / (pinion.z * u) * (1.0 - recess - approach + recess**2 + approach**2)


@pytest.mark.parametrize("name", CLOSED)
def test_loss_factor_in_closed_form(name):
    pair = unlike_pair(name)
    assert ohlendorf_of(pair) == pytest.approx(by_hand(pair), rel=1e-9)
    assert loss_factor(pair, "uniform") == pytest.approx(by_hand(pair), rel=1e-9)  # exact quadrature


@pytest.mark.parametrize("name", CLOSED)
def test_iso_loss_is_power_times_coefficient_times_loss_factor(name):
    pair = unlike_pair(name)
    pitch = Contact(pair, np.array([Contact(pair).pitch]))
    mu = iso_14179_mean_coefficient(
        1e-3 * pitch.unit_load, pitch.entraining, 1e3 * pitch.radius, 1e3 * pitch.viscosity,
        1e6 * pitch.roughness,
    )  # fmt: skip
    power = pair.operating.pinion_torque * pair.operating.pinion_speed
    assert iso_14179_mesh_loss(pair) == pytest.approx(power * mu[0] * by_hand(pair), rel=1e-9)
