"""Does the predicted effect of the actual sliding velocity explain what the multibody model shows?"""

import pytest

import lumped
import multibody
from validation.metrics import relative_l2
from validation.sliding_effect import sliding_effect

SMOOTH = {"model": "parabolic", "ramp_length": 2.0}


@pytest.mark.parametrize("torque", [56.5, 14.0])
def test_it_is_the_multibody_model_with_this_effect_alone(torque):
    pair = lumped.load_gear_pair("nasa_28_28").with_(mesh__stiffness=SMOOTH, operating__pinion_torque=torque)
    predicted = sliding_effect(pair, lumped.steady_state(pair, samples_per_cycle=256))
    settings = {"cycles": 40, "initial": "periodic"}
    exact = multibody.simulate(pair, effects={"sliding_velocity"}, **settings)
    nominal = lumped.simulate(pair, **settings)
    last = slice(-4 * 256 - 1, -1)
    for quantity in ("friction_force", "y_p", "y_g"):
        seen, without = (d[quantity].to_numpy()[..., last] for d in (exact, nominal))
        size = relative_l2(seen, without)
        left = relative_l2(seen - predicted.over(quantity, 4 * 256), without)
        # First order in the effect, whose size is 2 % or less here; friction acts back on the motion.
        assert left < 0.1 * size


def test_there_is_none_without_friction():
    pair = lumped.load_gear_pair("nasa_28_28").with_(friction__law="none")
    effect = sliding_effect(pair, lumped.steady_state(pair))
    assert effect.changes == {}
    assert effect.over("y_p", 512) == 0.0
