"""Do the mean powers of a periodic multibody motion balance, on springs and on shafts?"""

import pytest

import multibody
from tests.unlike_pairs import UNLIKE, unlike_pair


@pytest.mark.parametrize(("name", "supports"), [*((name, "springs") for name in UNLIKE),
                                                ("contact_ratio_2_3_on_shafts", "shafts")])  # fmt: skip
def test_driving_less_braking_power_is_lost_at_the_places_that_are_named(name, supports):
    """First law over a period: nothing is stored, so T_p Omega_p - T_g Omega_g is what all places take."""
    pair = unlike_pair(name).healthy
    g = pair.geometry
    about = multibody.steady_state(pair, samples_per_cycle=16, supports=supports).attrs
    driving = pair.operating.pinion_torque * g.omega_pinion
    braking = about["brake_torque"] * g.omega_gear
    places = ["sliding", "tooth_dampers", "bearings", *(["shafts"] if supports == "shafts" else [])]
    lost = [about[f"power_{place}"] for place in places]
    assert min(lost) > 0.0 or supports == "shafts"  # the bearings of these shafts have no dampers
    assert about["power_energy_residual"] == 0.0  # this contact has an energy
    # Integration at 1e-9 leaves some 1e-10 of the driving power; the losses are 0.3 to 2 % of it.
    assert driving - braking == pytest.approx(sum(lost), abs=1e-8 * driving)
    assert about["mesh_efficiency"] == pytest.approx(1.0 - sum(lost) / driving, abs=1e-9)
