"""Does every joule that the drive puts in come out somewhere, and does friction only ever take?"""

import pytest

import lumped
import multibody
from tests.unlike_pairs import UNLIKE, unlike_pair

#: Prescribed contact is for teeth that are alike.
LIKE_TEETH = [name for name in UNLIKE if unlike_pair(name).healthy is unlike_pair(name)]


def prescribed(name: str) -> lumped.GearPair:
    return unlike_pair(name).with_(mesh__contact="prescribed")


#: Pair -> how it is run: each fidelity with and without sliding that turns, on pairs of their own.
OPTIONS = {
    "contact_ratio_1_1_large_shifts": {"fidelity": "exact", "friction_velocity": 0.05},
    "contact_ratio_2_3_on_shafts": {"fidelity": "linear"},
    "heavily_relieved_under_load": {"fidelity": "exact"},
    "larger_gear_drives_contact_lost": {"fidelity": "linear"},
    "rack_25_degrees_always_pushing": {
        "fidelity": "exact", "effects": {"moving_line": False, "contact_loss": False},
    },
}  # fmt: skip


@pytest.mark.parametrize("name", OPTIONS)
def test_power_balance_closes(name):
    balance = multibody.power_balance(prescribed(name), 5, supports="springs", **OPTIONS[name])
    # rtol 1e-8 per step over some thousand steps; required is 1e-6 of the input, and friction is 0.3 to
    # 1.5 % of the input.
    assert abs(balance.residual) < 1e-8 * balance.driving
    assert abs(balance.residual) < 1e-6 * balance.friction
    assert balance.friction > 0
    assert balance.mesh_damping > 0
    assert balance.bearings > 0


def test_the_first_law_holds_without_a_source(unlike):
    """Driving power is braking power, stored energy and losses; no energy residual."""
    balance = multibody.power_balance(unlike, 3, rtol=1e-10, friction_velocity=0.05, supports="springs")
    assert abs(balance.residual) < 1e-9 * balance.driving
    assert balance.energy_residual == 0.0
    # The energy does not jump: contact begins and ends where the teeth carry nothing.
    assert abs(balance.mesh_jump) < 1e-10 * balance.driving
    assert balance.mesh_damping > 0.0
    assert balance.bearings > 0.0


@pytest.mark.parametrize(("preset", "changes"), [
    ("nasa_28_28", {"operating.pinion_speed": 18000.0, "mesh.stiffness": {"model": "energy"}}),
    ("kahraman_blankenship_50_50", {"friction": {"law": "coulomb", "coefficient": 0.0}}),
], ids=["far above the resonances", "no friction"])  # fmt: skip
def test_the_first_law_holds_at_limits_that_the_unlike_pairs_are_far_from(preset, changes):
    pair = lumped.load_gear_pair(preset).with_({"mesh.contact": "loaded"} | changes)
    balance = multibody.power_balance(pair, 3, rtol=1e-10, friction_velocity=0.05)
    assert abs(balance.residual) < 1e-9 * balance.driving
    assert abs(balance.mesh_jump) < 1e-10 * balance.driving


@pytest.mark.parametrize("name", ["larger_gear_drives_contact_lost", "contact_ratio_1_1_large_shifts"])
def test_without_path_work_and_tip_contact_the_balance_needs_a_source(name):
    balance = multibody.power_balance(prescribed(name), 3, rtol=1e-10, friction_velocity=0.05)
    assert abs(balance.residual) < 1e-9 * balance.driving
    assert balance.mesh_jump > 1e-4 * balance.driving
    assert abs(balance.energy_residual) > 1e-6 * balance.driving


@pytest.mark.parametrize("name", LIKE_TEETH)
def test_the_balance_of_the_linear_mesh_in_the_loaded_form_closes(name):
    """The springs follow the error of the tangent, the dampers the gap. With Hertz's contact these differ."""
    balance = multibody.power_balance(unlike_pair(name), 3, fidelity="linear", rtol=1e-11, supports="springs")
    assert abs(balance.residual) < 1e-10 * balance.driving
    # Work that goes into no energy, ten thousand times the residual: stiffness varies along each path.
    assert abs(balance.energy_residual) > 1e-6 * balance.driving


#: Each has a law of its own. A start at rest swings strongly: the actual sliding turns away from P.
@pytest.mark.parametrize("name", LIKE_TEETH)
def test_friction_never_feeds_energy_in(name):
    run = multibody.simulate(prescribed(name), 4)
    assert float(run["friction_power"].max()) <= 0.0
    assert float(run["friction_power"].min()) < -1.0  # W: friction does act
    # The same statement without the sign convention of the force: mu has the sign of the sliding velocity.
    assert float((run["mu"] * run["sliding_velocity"]).min()) >= 0.0


@pytest.mark.parametrize("name", ["contact_ratio_1_1_large_shifts", "larger_gear_drives_contact_lost"])
def test_nominal_friction_would_feed_energy_in(name):
    """With the nominal sign, as in the lumped model, the same start breaks the rule."""
    run = multibody.simulate(prescribed(name), 4, effects={"sliding_velocity": False})
    assert float(run["friction_power"].max()) > 1.0


@pytest.mark.parametrize("name", LIKE_TEETH)
def test_the_balance_of_a_periodic_motion_has_its_own_brake_torque_and_stores_nothing(name):
    pair = unlike_pair(name)
    motion = multibody.steady_state(pair, supports="springs")
    g = pair.geometry
    balance = multibody.motion_balance(pair, motion, 1e-10)
    # A motion that closes to 1e-8 has the nominal mean speed; the torques of both models differ by more.
    assert balance.braking == pytest.approx(
        motion.attrs["brake_torque"] * g.omega_gear * g.mesh_period, rel=1e-9
    )
    assert abs(balance.kinetic) < 1e-6 * balance.friction
