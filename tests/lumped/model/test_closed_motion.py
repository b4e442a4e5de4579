"""Is the motion that the search closes the one to which a long run comes, and are its multipliers right?"""

import math
from dataclasses import replace

import numpy as np
import pytest

from lumped.errors import NumericalError
from lumped.model.momentary_load import body_of
from lumped.model.unilateral_motion import Shooting, _first_settling, _settling, motion_of_shooting
from lumped.schema.files import load_gear_pair
from tests.unlike_pairs import unlike_pair
from validation.exchange.new_pair_file import new_pair

#: Pairs whose motion repeats with the mesh cycle: with contact lost, always pushing, with neighbours that
#: move each other, with large profile shifts, with relief.
PAIRS = {
    "nasa_art_25_31, contact lost": load_gear_pair("nasa_art_25_31"),
    "50/50, contact lost": load_gear_pair("kahraman_blankenship_50_50").with_(speed=1080),
    "gear drives, contact lost": unlike_pair("larger_gear_drives_contact_lost"),
    "always pushing": unlike_pair("rack_25_degrees_always_pushing"),
    "large shifts": unlike_pair("contact_ratio_1_1_large_shifts"),
    "relieved": unlike_pair("heavily_relieved_under_load").healthy,
    "finite elements": unlike_pair("unlike_teeth_finite_elements").healthy,
    "prescribed": load_gear_pair("nasa_28_28").with_({"mesh.contact": "prescribed"}),
}
#: What a run from rest keeps of its start, as a share.
FADED = 1e-9


def search(name):
    return Shooting.of(PAIRS[name], 64, "springs")


@pytest.mark.parametrize("name", PAIRS)
def test_a_run_from_rest_comes_to_the_closed_motion(name):
    """A run is the plain road: it knows no linear motion and no derivative, and no state is solved for.

    It starts from the static deflection and lasts until the multipliers of the motion let the start fade.
    Only the brake torque is that of the closed motion, because with another one the speed would drift.
    """
    shooting = search(name)
    motion = motion_of_shooting(shooting)
    cycles = math.ceil(math.log(FADED) / math.log(min(max(motion.spectral_radius, 0.1), 0.98))) + 20
    rest = shooting.at_rest()
    rest[-1] = motion.brake_torque
    _, run = shooting.run(rest, shooting.fine, cycles=cycles, recorded=1)
    coordinates = len(shooting.system.coordinates)
    closed = motion.states[:, :coordinates] @ shooting.system.deflection
    settled = run.states[:, :coordinates] @ shooting.system.deflection
    assert np.abs(settled - closed).max() <= 1e-7 * np.ptp(closed)
    np.testing.assert_allclose(run.loads, motion.load, rtol=0.0, atol=1e-7 * motion.load.max())


@pytest.mark.parametrize("name", PAIRS)
def test_multipliers_are_those_of_all_states(name):
    """Leaving out the states that move no tooth leaves the multipliers: those of all states contain them.

    Differences with steps of 1/256 cycle give a free vibration off the line of action to 1e-6.
    """
    shooting = search(name)
    motion = motion_of_shooting(shooting)
    unknowns = shooting.unknowns(motion.states[0], motion.pinion_torque, motion.brake_torque)
    slopes = shooting.derivatives(unknowns)[:-1, :-1]
    radius = np.abs(np.linalg.eigvals(slopes + np.eye(len(slopes)))).max()
    assert motion.spectral_radius == pytest.approx(radius, rel=2e-6)


def test_a_free_vibration_off_the_line_of_action_decides_where_it_fades_last():
    """A weakly damped bearing off the line of action: exp(-zeta omega T) is the largest multiplier."""
    pair = PAIRS["always pushing"].with_({"bearings.pinion.oloa_damping_ratio": 1e-5})
    shooting = Shooting.of(pair, 64, "springs")
    s = shooting.system.structure
    of_bearing = math.exp(-0.5 * s.damping[4] / s.mass[4] * shooting.system.period)
    radius = motion_of_shooting(shooting).spectral_radius
    assert of_bearing > motion_of_shooting(search("always pushing")).spectral_radius + 1e-3
    assert radius == pytest.approx(of_bearing, rel=1e-12)


def test_on_springs_the_states_off_the_line_of_action_move_no_tooth():
    """q, x_p, x_g move the teeth, y_p and y_g do not; nor do their rates."""
    still = search("always pushing").moves_no_tooth
    np.testing.assert_array_equal(still, np.tile([False, False, False, True, True], 2))


def test_a_state_that_acts_on_the_teeth_through_another_one_moves_the_teeth():
    """With a gyroscopic force from y_p' on x_p nothing but y_g and its rate is left."""
    shooting = search("always pushing")
    constant = shooting.system.constant.copy()
    constant[8, 10] = 1.0  # x_p'' by y_p'
    coupled = replace(shooting, system=replace(shooting.system, constant=constant))
    np.testing.assert_array_equal(coupled.moves_no_tooth, np.tile([False, False, False, False, True], 2))


@pytest.mark.parametrize("supports", ["springs", "shafts"])
def test_terms_that_are_not_zero_are_the_whole_matrix(supports):
    pair = unlike_pair("contact_ratio_2_3_on_shafts")
    system = Shooting.of(pair, 64, supports).system
    body = body_of(system)
    m = len(system.coordinates)
    state = np.random.default_rng(3).normal(size=2 * m)
    scale = np.abs(system.constant[m:]) @ np.abs(state)
    by_terms = (body.constant * state[body.states]).sum(axis=1)
    assert (np.abs(by_terms - system.constant[m:] @ state) <= 1e-14 * scale).all()
    assert body.states.shape[1] == (
        2 if supports == "springs" else np.count_nonzero(system.constant[m:], 1).max()
    )


def test_where_motions_coexist_the_search_starts_from_the_exact_linear_motion():
    """Near resonance 23/37 has two stable motions: of one mesh cycle, and of three with four times the swing.

    To which of them a search comes depends on the last digits of its start. From the rough linear motion few
    steps do not suffice here, so that only the exact one decides.
    """
    pair = new_pair("23/37", 3.0, 25.0, 22881.246, 120.0).with_(damping=0.005)
    shooting = Shooting.of(pair, 64, "springs")
    assert shooting.close_by() is None
    motion = motion_of_shooting(shooting)
    exact = motion_of_shooting(shooting.with_fitted_laws())
    assert motion.spectral_radius < 1.0
    assert motion.period == exact.period
    np.testing.assert_array_equal(motion.states, exact.states)


@pytest.mark.parametrize("cycles", [1, 6, 19_998])
def test_a_run_lasts_until_its_start_has_faded_and_two_cycles_more(cycles):
    """A start fades by the spectral radius in each cycle: radius^n <= 1e-11 after the first such n."""
    just, later = (1e-11 ** (1.0 / (cycles + more)) for more in (-0.01, 0.01))
    assert _settling(just) == cycles + 2
    assert _first_settling(just) == min(cycles + 2, 400)
    assert _first_settling(later) == min(cycles + 3, 400)
    if cycles < 19_998:
        assert _settling(later) == cycles + 3
    else:  # 20,000 cycles are the most
        with pytest.raises(NumericalError, match="fades in 20001 mesh cycles, too slowly"):
            _settling(later)


def test_a_start_that_underflows_is_gone_at_once_and_one_that_stays_gets_the_longest_first_run():
    assert _first_settling(0.0) == 0 + 2
    assert _first_settling(1.0) == _first_settling(1.5) == _first_settling(np.nan) == 400
    with pytest.raises(NumericalError, match="not stable"):
        _settling(1.0)
