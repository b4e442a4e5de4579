"""Do gears whose teeth differ keep the first law in the multibody model, and is refused what it has not?"""

import numpy as np
import pytest

import lumped
import multibody

ERRORS = [round(1.5 * np.sin(2.1 * j) + 0.9 * np.cos(5.3 * j), 3) for j in range(28)]
OWN = {
    "pinion.deviations": {"index": ERRORS, "first_order": "steps"},
    "gear.deviations": {"index": ERRORS[::-1], "first_order": "steps"},
    "pinion.mounting": {"eccentricity": 4, "phase": 70},
    "gear.mounting": {"eccentricity": 6},
}


@pytest.fixture(scope="module")
def pair():
    changes = {"mesh.contact": "loaded", "mesh.relief": "ignored", "operating.pinion_torque": 14.0}
    changes |= {"operating.pinion_speed": 1450, "friction.law": "coulomb", "friction.coefficient": 0.0}
    return lumped.load_gear_pair("nasa_28_28").with_(changes)


def test_first_law_holds_with_own_gaps_and_eccentric_base_circles(pair):
    balance = multibody.power_balance(
        pair.with_(OWN | {"gear.mounting": {"eccentricity": 40}, "friction.coefficient": 0.05}),
        cycles=4,
        initial="periodic",
    )
    assert abs(balance.residual) < 1e-8 * balance.driving


@pytest.mark.parametrize(("changes", "field"), [
    ({"pinion.faults": [{"kind": "crack", "tooth": 1, "depth": 1}]}, "pinion.faults"),
    ({"gear.deviations": {"profile_slope": [1.0] * 28}}, "gear.deviations.profile_slope"),
    ({"operating.torque_ripple": [{"shaft": "gear", "order": 1, "amplitude": 1}]}, "torque_ripple"),
])  # fmt: skip
def test_what_it_does_not_have_is_refused(pair, changes, field):
    with pytest.raises(lumped.ParameterError, match=field):
        multibody.simulate(pair.with_(changes), 1)
    with pytest.raises(lumped.ParameterError, match="fidelity"):
        multibody.simulate(pair.with_(OWN), 1, fidelity="linear")
