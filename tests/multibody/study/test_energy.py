"""Does every joule that the drive puts in come out somewhere, and does friction only ever take?"""

import pytest

import lumped
import multibody

PAIR = lumped.load_gear_pair("nasa_28_28").with_(
    mesh__contact="prescribed", friction__law="coulomb", friction__coefficient=0.08
)


@pytest.mark.parametrize("options", [
    {"fidelity": "linear"},
    {"fidelity": "exact"},
    {"fidelity": "exact", "effects": {"moving_line": False, "contact_loss": False}},
    {"fidelity": "exact", "friction_velocity": 0.05},
], ids=["linear", "exact", "exact, fixed line", "exact, smooth friction"])  # fmt: skip
def test_power_balance_closes(options):
    balance = multibody.power_balance(PAIR, 5, **options)
    # rtol 1e-8 per step over some thousand steps; required is 1e-6 of the input, and friction is 0.8 % of
    # the input.
    assert abs(balance.residual) < 1e-8 * balance.driving
    assert abs(balance.residual) < 1e-6 * balance.friction
    assert balance.friction > 0
    assert balance.mesh_damping > 0
    assert balance.bearings > 0


@pytest.mark.parametrize(("preset", "changes"), [
    ("nasa_28_28", {"mesh.stiffness": {"model": "energy"}}),
    ("nasa_28_28", {"mesh.stiffness": {"model": "energy"}, "mesh.relief": "static"}),
    ("nasa_28_28", {"operating.pinion_speed": 500.0}),
    ("nasa_28_28", {"operating.pinion_speed": 18000.0, "mesh.stiffness": {"model": "energy"}}),
    ("fzg_c", {"mesh.stiffness": {"model": "energy"}}),
    ("nasa_art_25_31", {"mesh.stiffness": {"model": "parabolic"}}),
    ("kahraman_blankenship_50_50", {"friction": {"law": "coulomb", "coefficient": 0.0}}),
    ("high_contact_ratio_29_47", {}),
    ("high_contact_ratio_29_47", {"mesh.stiffness": {"model": "energy"}}),
])  # fmt: skip
def test_the_first_law_holds_without_a_source(preset, changes):
    """Driving power is braking power, stored energy and losses; no energy residual."""
    pair = lumped.load_gear_pair(preset).with_({"mesh.contact": "loaded"} | changes)
    balance = multibody.power_balance(pair, 3, rtol=1e-10, friction_velocity=0.05)
    assert abs(balance.residual) < 1e-9 * balance.driving
    assert balance.energy_residual == 0.0
    # The energy does not jump: contact begins and ends where the teeth carry nothing.
    assert abs(balance.mesh_jump) < 1e-10 * balance.driving
    assert balance.mesh_damping > 0.0
    assert balance.bearings > 0.0


def test_without_path_work_and_tip_contact_the_balance_needs_a_source():
    pair = lumped.load_gear_pair("nasa_28_28").with_(
        mesh__contact="prescribed", mesh__relief="ignored", mesh__stiffness={"model": "energy"}
    )
    balance = multibody.power_balance(pair, 3, rtol=1e-10, friction_velocity=0.05)
    assert abs(balance.residual) < 1e-9 * balance.driving
    assert balance.mesh_jump > 1e-4 * balance.driving
    assert abs(balance.energy_residual) > 1e-6 * balance.driving


@pytest.mark.parametrize("relief", ["ignored", "static"])
def test_the_balance_of_the_linear_mesh_in_the_loaded_form_closes(relief):
    """Its springs follow the tangent's error its dampers the gap; with Hertz's contact these differ."""
    pair = PAIR.with_(mesh__stiffness={"model": "energy"}, mesh__contact="loaded", mesh__relief=relief)
    balance = multibody.power_balance(pair, 3, fidelity="linear", rtol=1e-11)
    assert abs(balance.residual) < 1e-10 * balance.driving
    assert abs(balance.energy_residual) > 1e-5 * balance.driving


@pytest.mark.parametrize(
    "law", ["coulomb", "benedict_kelley", "xu_kahraman", "smoothed_coulomb", "composite"]
)
def test_friction_never_feeds_energy_in(law):
    """A start at rest swings strongly: the actual sliding velocity changes sign away from P."""
    run = multibody.simulate(PAIR.with_(friction__law=law, operating__pinion_speed=1500), 4)
    assert float(run["friction_power"].max()) <= 0.0
    assert float(run["friction_power"].min()) < -1.0  # W: friction does act
    # The same statement without the sign convention of the force: mu has the sign of the sliding velocity.
    assert float((run["mu"] * run["sliding_velocity"]).min()) >= 0.0


def test_nominal_friction_would_feed_energy_in():
    """With the nominal sign, as in the lumped model, the same start breaks the rule."""
    run = multibody.simulate(PAIR.with_(operating__pinion_speed=1500), 4, effects={"sliding_velocity": False})
    assert float(run["friction_power"].max()) > 1.0


def test_the_balance_of_a_periodic_motion_has_its_own_brake_torque_and_stores_nothing():
    motion, g = multibody.steady_state(PAIR), PAIR.geometry
    found = multibody.motion_balance(PAIR, motion, 1e-10)
    # A motion that closes to 1e-7 has the nominal mean speed; the torques of both models differ by more.
    assert found.braking == pytest.approx(
        motion.attrs["brake_torque"] * g.omega_gear * g.mesh_period, rel=1e-9
    )
    assert abs(found.kinetic) < 1e-6 * found.friction
