"""Are motions by long steps those of the schemes, and do they tend to the motion as the steps get short?"""

import numpy as np
import pytest

import lumped
from lumped.model.steady import periodic_solution, sample_times
from tests.unlike_pairs import unlike_pair
from tests.validation.check.sampled_motions import COULOMB
from validation.check.explanations.physics import Physics, altered_system
from validation.check.explanations.step_schemes import stepped

SCHEMES = ("implicit Euler", "explicit Euler", "semi-implicit Euler", "trapezoidal rule", "Runge-Kutta")


@pytest.fixture(scope="module", params=["high_contact_ratio_29_47", "rack_25_degrees_always_pushing"])
def system(request):
    """The "full" system of unlike pairs with prescribed contact."""
    presets = request.param.startswith("high")
    pair = lumped.load_gear_pair(request.param) if presets else unlike_pair(request.param)
    return altered_system(pair.with_(COULOMB), Physics())


def error_of(system, scheme, steps):
    """Largest difference of the displacements to the motion with steps of no length, over their size."""
    true = periodic_solution(system, sample_times(system.period, 256)).states[:, :6]
    found = stepped(system, scheme, steps, 256).states[:, :6]
    swing = np.ptp(true, axis=0)
    moves = swing > 0.0
    return float((np.abs(found - true).max(axis=0)[moves] / swing[moves]).max())


@pytest.mark.parametrize("scheme", SCHEMES)
def test_short_steps_give_the_motion(system, scheme):
    """The error falls with the step, by its first power for Euler's schemes."""
    long, short = (error_of(system, scheme, steps) for steps in (4096, 16384))
    assert short < 0.05
    assert short < 0.4 * long


@pytest.mark.parametrize("scheme", SCHEMES)
def test_the_states_obey_the_scheme(system, scheme):
    """Each step of the states at the steps, written out for one step of a scheme."""
    steps = 4096
    motion = stepped(system, scheme, steps, steps)
    h = system.period / steps
    for place in (7, 1500, 4000):
        one, other = motion.states[place : place + 2]
        now, then = (
            system.A(k * h) @ x + system.b(k * h, motion.brake_torque)
            for k, x in ((place, one), (place + 1, other))
        )
        step = {
            "implicit Euler": h * then,
            "explicit Euler": h * now,
            "trapezoidal rule": 0.5 * h * (now + then),
        }
        m = len(system.coordinates)
        rates = one[m:] + h * now[m:]
        step["semi-implicit Euler"] = np.concatenate([h * rates, h * now[m:]])

        def rate(share, x, place=place):
            time = (place + share) * h
            return system.A(time) @ x + system.b(time, motion.brake_torque)

        k2 = rate(0.5, one + 0.5 * h * now)
        k3 = rate(0.5, one + 0.5 * h * k2)
        step["Runge-Kutta"] = h / 6.0 * (now + 2.0 * k2 + 2.0 * k3 + rate(1.0, one + h * k3))
        size = np.abs(motion.states).max(axis=0)
        assert np.abs(other - one - step[scheme]) / size == pytest.approx(0.0, abs=1e-9)
