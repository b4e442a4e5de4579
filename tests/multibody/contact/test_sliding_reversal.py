"""What happens where the actual sliding velocity changes sign away from the pitch point?"""

import pytest

import lumped
import multibody

SLOW = lumped.load_gear_pair("nasa_28_28").with_(
    friction__law="coulomb", friction__coefficient=0.05, operating__pinion_torque=79.1,
    operating__pinion_speed=800,
)  # fmt: skip


def test_default_says_which_sign_function_it_takes_and_why():
    fast = SLOW.with_(operating__pinion_speed=4000)
    for pair, velocity, word in (
        (SLOW, 1e-4, "friction may stick"),
        # Friction changes 0.2 of the nominal acceleration here, but from rest the bearings swing up: sign()
        # sticks.
        (SLOW.with_(operating__pinion_speed=2000), 1e-4, "friction may stick"),
        (fast, 0.0, "resonance could take away"),
        (SLOW.with_(friction__law="xu_kahraman"), 0.0, "continuous"),
    ):
        attributes = multibody.simulate(pair, 1).attrs
        assert attributes["friction_velocity"] == velocity
        assert word in attributes["friction_velocity_reason"]


def test_sign_function_gets_stuck_and_says_so(monkeypatch):
    """In a sliding mode the steps shrink without end; the cap on calls turns a hang into an error."""
    monkeypatch.setattr("multibody.run.setup.CALL_LIMIT", 60_000)
    with pytest.raises(lumped.NumericalError, match="friction_velocity"):
        multibody.simulate(SLOW, 2, friction_velocity=0.0)
