"""A gear with nine teeth on a coarse mesh, for all that does not depend on the number of teeth."""

import math

import pytest

from lumped.elasticity.sector import sector, stations
from lumped.gear_geometry.tooth_profile import ToothProfile

TEETH = 9
NU = 0.3


def meshed(profile, shift, bore, size):
    tip = 0.5 * profile.teeth + 1.0 + shift
    return sector(profile, tip, bore, stations(profile, tip, bore, size))


@pytest.fixture(scope="session")
def small():
    return ToothProfile(TEETH, 1.0, math.radians(20.0), 0.5, 1.25, 0.38)


@pytest.fixture(scope="session")
def coarse(small):
    return meshed(small, 0.5, small.root_radius / 4.0, 0.3)
