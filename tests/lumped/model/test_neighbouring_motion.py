"""Where no run settles, is the motion followed from a neighbour a stable motion of the pair itself?"""

import numpy as np
import pytest

from lumped.errors import UnsettledError
from lumped.model.neighbouring_motion import (
    NEIGHBOURS,
    between,
    followed_motion,
    unilateral_or_followed_motion,
)
from lumped.model.revolution_motion import Origin
from lumped.model.steady import UNSTABLE
from lumped.model.steady_state import steady_state
from lumped.model.transient import simulate
from lumped.model.unilateral_motion import Shooting, motion_of_shooting
from lumped.schema.files import load_gear_pair
from tests.unlike_pairs import unlike_pair

#: Outputs in a mesh cycle.
SAMPLES = 64
#: Lightly damped, far above the mesh resonance: a stable motion with a small loss of contact beside chaos.
BESIDE_CHAOS = load_gear_pair("nasa_art_25_31").with_(
    {"mesh.damping_ratio": 0.00858, "operating.pinion_speed": "9560.63 rpm"}
)


def search(pair):
    return Shooting.of(pair, SAMPLES, "springs")


def swing_of_run(shooting, unknowns, cycles):
    """Peak to peak of the transmission error in each of the last 20 mesh cycles of a run [m]."""
    _, run = shooting.run(unknowns, shooting.fine, cycles=cycles, recorded=20)
    coordinates = len(shooting.system.coordinates)
    dte = run.states[:, :coordinates] @ shooting.system.deflection
    return np.ptp(dte.reshape(20, SAMPLES), axis=1)


def test_no_run_from_the_linear_motion_settles():
    with pytest.raises(UnsettledError, match="has not come to a motion of at most 8 mesh cycles"):
        motion_of_shooting(search(BESIDE_CHAOS))


def test_the_motion_is_found_from_a_neighbour():
    motion = unilateral_or_followed_motion(BESIDE_CHAOS, SAMPLES)
    assert motion.origin is Origin.NEIGHBOUR
    assert motion.pair == BESIDE_CHAOS
    assert motion.spectral_radius <= UNSTABLE


@pytest.mark.parametrize("changed", [0.0, 0.01])
def test_runs_that_start_near_it_come_back_to_it(changed):
    """The plain road: a run of 1,000 mesh cycles knows no neighbour and no derivative.

    A larger disturbance may lead to chaos, or to a motion of three mesh cycles, which is stable too.
    """
    motion = unilateral_or_followed_motion(BESIDE_CHAOS, SAMPLES)
    shooting = search(BESIDE_CHAOS)
    unknowns = shooting.unknowns(motion.states[0], motion.pinion_torque, motion.brake_torque)
    unknowns[:-1] *= 1.0 + changed * np.random.default_rng(1).standard_normal(unknowns.size - 1)
    coordinates = len(shooting.system.coordinates)
    swing = np.ptp(motion.states[:, :coordinates] @ shooting.system.deflection)
    assert swing_of_run(shooting, unknowns, 1000) == pytest.approx(swing, rel=1e-7)


def test_it_is_the_motion_that_other_dampings_and_speeds_settle_to():
    """With a damping ratio of 0.009 a run does settle; the followed motion is its neighbour in damping."""
    settled = unilateral_or_followed_motion(
        BESIDE_CHAOS.with_({"mesh.damping_ratio": 0.009, "operating.pinion_speed": "9560.63 rpm"}), SAMPLES
    )
    assert settled.origin is Origin.SETTLED
    followed = unilateral_or_followed_motion(BESIDE_CHAOS, SAMPLES)
    swings = [
        np.ptp(m.states[:, : len(m.system.coordinates)] @ m.system.deflection) for m in (settled, followed)
    ]
    assert swings[1] == pytest.approx(swings[0], rel=2e-3)


def test_a_chaotic_pair_without_a_stable_motion_keeps_its_error():
    """Period doubling: the motion near the linear one is unstable, and so are its neighbours."""
    pair = load_gear_pair("nasa_art_25_31").with_(
        {"mesh.damping_ratio": 0.00742, "operating.pinion_speed": "4579.19 rpm"}
    )
    assert followed_motion(pair, search) is None
    with pytest.raises(UnsettledError):
        unilateral_or_followed_motion(pair, SAMPLES)


@pytest.mark.parametrize(("torque", "speed"), NEIGHBOURS)
@pytest.mark.parametrize("brake", ["balanced", 27.8])
def test_a_neighbour_has_both_torques_and_the_speed_in_proportion(torque, speed, brake):
    pair = unlike_pair("larger_gear_drives_contact_lost").with_({"operating.brake_torque": brake})
    neighbour = between(pair, torque, speed)
    own, other = pair.operating, neighbour.operating
    assert other.pinion_torque == pytest.approx(torque * own.pinion_torque, rel=1e-12)
    assert other.pinion_speed == pytest.approx(speed * own.pinion_speed, rel=1e-12)
    if brake == "balanced":
        assert other.brake_torque == "balanced"
    else:
        assert other.brake_torque == pytest.approx(torque * brake, rel=1e-12)
    assert between(pair, 1.0, 1.0).operating.pinion_speed == pytest.approx(own.pinion_speed, rel=1e-15)


def test_a_run_from_the_periodic_motion_stays_in_it():
    """`simulate` starts from the motion that `steady_state` has; it did not settle without neighbours."""
    steady = steady_state(BESIDE_CHAOS, contact="unilateral", samples_per_cycle=SAMPLES)
    run = simulate(BESIDE_CHAOS, 3, contact="unilateral", initial="periodic", samples_per_cycle=SAMPLES)
    assert steady.attrs["origin"] == Origin.NEIGHBOUR.value
    last = run["dte"].to_numpy()[-SAMPLES - 1 : -1]
    assert last == pytest.approx(steady["dte"].to_numpy(), abs=1e-6 * float(np.ptp(last)))
