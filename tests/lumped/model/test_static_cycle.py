"""Has a mesh cycle whose laws are computed where they are read the laws of the fitted mesh cycle?"""

import numpy as np
import pytest

from lumped.model.mesh_cycle import MeshCycle
from lumped.model.periodic_system import LTVSystem
from lumped.model.propagation import fastest_frequency
from lumped.model.static_cycle import StaticCycle
from lumped.model.steady import periodic_solution
from lumped.model.tooth_laws import ToothLaws
from lumped.schema.files import load_gear_pair
from tests.unlike_pairs import unlike_pair

PAIRS = {
    "nasa_28_28": load_gear_pair("nasa_28_28"),
    "fzg_c": load_gear_pair("fzg_c"),
    "relieved": unlike_pair("heavily_relieved_under_load").healthy,
    "large shifts": unlike_pair("contact_ratio_1_1_large_shifts"),
    "finite elements": unlike_pair("unlike_teeth_finite_elements").healthy,
    "gear drives": unlike_pair("larger_gear_drives_contact_lost"),
}


def both(name):
    pair = PAIRS[name]
    return MeshCycle.of(pair), StaticCycle(ToothLaws(pair))


@pytest.mark.parametrize("name", PAIRS)
def test_computed_laws_are_the_fitted_ones(name):
    """The fits err by 1e-11 of the largest value, on short pieces by more; a slope of the gap by 1e-8."""
    fitted, computed = both(name)
    times = (np.arange(211) + 0.37) / 211.0 * fitted.period
    one = fitted.sample(times)
    other = computed.sample(times)
    np.testing.assert_array_equal(other.contact, one.contact)
    for field, tolerance in {
        "position": 1e-14,
        "stiffness": 1e-8,
        "damping": 1e-8,
        "friction": 1e-9,
        "error_rate": 1e-6,
        "tilt": 1e-8,
    }.items():
        largest = max(float(np.abs(getattr(one, field)).max()), 1e-300)
        np.testing.assert_allclose(
            getattr(other, field), getattr(one, field), rtol=0.0, atol=tolerance * largest
        )
    approach = np.full(times.size, 2.0 * np.abs(one.error).max() + 1e-6)
    rate = np.full(times.size, 1e-3)
    loads = one.load(approach, rate)
    np.testing.assert_allclose(other.load(approach, rate), loads, rtol=0.0, atol=1e-7 * np.abs(loads).max())


@pytest.mark.parametrize("name", PAIRS)
def test_the_linear_motion_from_which_a_search_starts(name):
    """Long steps, with kinks inside them, err by less than 1e-2 of the motion: enough for a start."""
    pair = PAIRS[name]
    fitted = LTVSystem.of(pair, "full", supports="springs")
    computed = LTVSystem.of(pair, "full", cycle=StaticCycle(ToothLaws(pair)), supports="springs")
    assert fastest_frequency(computed) == pytest.approx(fastest_frequency(fitted), rel=1e-2)
    start = np.zeros(1)
    exact = periodic_solution(fitted, start, estimate_error=False)
    rough = periodic_solution(computed, start, estimate_error=False, step_angle=2.0)
    relative = fitted.supports.to_relative_states
    sizes = np.repeat(np.abs(exact.cycle_states @ relative.T).reshape(-1, 2, 5).max(axis=(0, 2)), 5)
    difference = np.abs(relative @ (rough.states[0] - exact.states[0])) / sizes
    assert difference.max() <= 1e-2
    assert rough.brake_torque == pytest.approx(exact.brake_torque, rel=1e-4)
    assert rough.spectral_radius == pytest.approx(exact.spectral_radius, rel=1e-2)


def test_contact_and_elements_are_those_of_the_pair():
    fitted, computed = both("relieved")
    assert (computed.start, computed.end) == (fitted.start, fitted.end)
    np.testing.assert_array_equal(computed.offsets, fitted.offsets)
    assert computed.elements.stiffness is fitted.elements.stiffness
