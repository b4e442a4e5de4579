"""Does every joule that the drive puts in come out somewhere, and does friction only ever take?"""

import numpy as np
import pytest

import lumped
import multibody

PAIR = lumped.load_gear_pair("nasa_28_28").with_(friction__law="coulomb", friction__coefficient=0.08)


@pytest.mark.parametrize(
    "options",
    [
        {"fidelity": "linear"},
        {"fidelity": "exact"},
        {"fidelity": "exact", "effects": {"moving_line": False, "contact_loss": False}},
        {"fidelity": "exact", "friction_velocity": 0.05},
    ],
    ids=["linear", "exact", "exact, fixed line", "exact, smooth friction"],
)
def test_power_balance_closes(options):
    balance = multibody.power_balance(PAIR, 5, **options)
    # rtol 1e-8 per step over some thousand steps; required is 1e-6 of the input, and friction is 0.8 % of
    # the input.
    assert abs(balance.residual) < 1e-8 * balance.driving
    assert abs(balance.residual) < 1e-6 * balance.friction
    assert balance.friction > 0
    assert balance.mesh_damping > 0
    assert balance.bearings > 0


@pytest.mark.parametrize(
    ("preset", "changes"),
    [
        ("nasa_28_28", {"mesh.stiffness": {"model": "energy"}}),
        ("nasa_28_28", {"mesh.stiffness": {"model": "energy"}, "mesh.relief": "static"}),
        ("nasa_28_28", {"operating.pinion_speed": 500.0}),
        ("nasa_28_28", {"operating.pinion_speed": 18000.0, "mesh.stiffness": {"model": "energy"}}),
        ("fzg_c", {"mesh.stiffness": {"model": "energy"}}),
        ("nasa_art_25_31", {"mesh.stiffness": {"model": "parabolic"}}),
        ("kahraman_blankenship_50_50", {"friction": {"law": "coulomb", "coefficient": 0.0}}),
        ("high_contact_ratio_29_47", {}),
        ("high_contact_ratio_29_47", {"mesh.stiffness": {"model": "energy"}}),
    ],
)
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
        mesh__relief="ignored", mesh__stiffness={"model": "energy"}
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


def test_steady_friction_loss_is_the_lumped_efficiency():
    """Over a periodic motion all losses together are (1 - efficiency) T_p Omega_p."""
    balance = multibody.power_balance(PAIR, 20, fidelity="linear", initial="periodic")
    lost = balance.friction + balance.bearings + balance.mesh_damping + balance.mesh_stiffness
    steady = lumped.steady_state(PAIR)
    # Stored energy returns to its value after whole cycles of a periodic motion.
    assert abs(balance.kinetic) < 1e-9 * balance.driving
    assert lost / balance.driving == pytest.approx(1 - steady.attrs["mesh_efficiency"], rel=1e-6)


def test_newtons_law_gives_exudyns_accelerations():
    """Forces summed by hand give the accelerations that exudyn finds from its own objects."""
    import exudyn as exu
    import exudyn.itemInterface as items

    from multibody.run.integration import settings
    from multibody.run.model import accelerations
    from multibody.run.setup import prepare

    setup = prepare(PAIR, fidelity="exact")
    model, system = setup.model, setup.model.system
    sensors = [
        system.AddSensor(
            items.SensorNode(
                nodeNumber=node, outputVariableType=exu.OutputVariableType.Coordinates_tt, storeInternal=True
            )
        )
        for node in model.nodes
    ]
    system.Assemble()
    s = settings(1e-8, 1e-14, setup.machine.period)
    s.timeIntegration.explicit.computeEndOfStepAccelerations = True
    s.timeIntegration.initialStepSize = 1e-4 * setup.machine.period
    s.timeIntegration.endTime = 0.3 * setup.machine.period
    for name, values in (("SetODE2Coordinates", setup.q), ("SetODE2Coordinates_t", setup.v)):
        getattr(system.systemData, name)(values, configuration=exu.ConfigurationType.Initial)
    system.SolveDynamic(s)
    rows = [
        np.asarray(system.GetSensorStoredData(n))[1:]
        for n in (*model.sensors[0], *model.sensors[1], *sensors)
    ]
    q, v = rows[0][:, 1:], rows[1][:, 1:]
    a = np.hstack([rows[2][:, 1:], rows[3][:, 1:]])
    expected = accelerations(model, rows[0][:, 0], q, v)
    # Same numbers from the same states; rounding of large opposing forces only.
    np.testing.assert_allclose(a, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())
