"""Do profile and ranges show the contact of a pair? Its formulas: tests/lumped/friction/test_call_sites."""

import pytest

from lumped.path_of_contact import contact_path, friction_profile, law_range_violations
from tests.guards.by_hand import Contact

ROUNDING = 1e-9  # positions cancel some digits of lengths


def test_a_profile_shows_the_contact_under_its_names(unlike):
    profile = friction_profile(unlike, 9)
    path = contact_path(unlike)
    names = ("hertz_pressure", "half_width", "sliding_velocity", "entraining_velocity", "film_thickness",
             "film_parameter", "slide_to_roll")  # fmt: skip
    for name in names:
        assert (profile[name].to_numpy() == getattr(path, name)(profile["xi"].to_numpy())).all(), name


def test_ranges_see_every_quantity_in_its_unit(unlike):
    """A pair that leaves all ranges at once: the numbers in the violations are those of the contact."""
    slow_pair = unlike.with_(speed=3.0, torque=0.02, viscosity=0.5)
    by_hand = Contact(slow_pair)
    expected = {}
    expected["viscosity"] = (0.5, 0.5)
    expected["pressure"] = tuple(1e-9 * value for value in (by_hand.pressure.min(), by_hand.pressure.max()))
    expected["mean_rolling_velocity"] = tuple(
        0.5 * value for value in (by_hand.entraining.min(), by_hand.entraining.max())
    )
    expected["unit_load"] = (1e-3 * by_hand.unit_load,) * 2
    ranges = {}
    for law in ("xu_kahraman", "iso_14179"):
        ranges |= {v.range.quantity: (v.minimum, v.maximum) for v in law_range_violations(slow_pair, law)}
    for quantity, ends in expected.items():
        assert ranges[quantity] == pytest.approx(ends, rel=ROUNDING), quantity
