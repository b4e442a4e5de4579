"""Do the lumped and the multibody model agree, and differ by what finite motion explains?"""

import numpy as np
import pytest

import lumped
import multibody
from multibody.run.setup import prepare
from multibody.run.simulation import record

BASE = lumped.load_gear_pair("nasa_28_28").with_(
    mesh__relief="ignored",
    friction__law="coulomb",
    friction__coefficient=0.05,
    operating__pinion_torque=56.5,
    operating__pinion_speed=4875,
)
SMOOTH = BASE.with_(mesh__stiffness={"model": "parabolic", "ramp_length": 3.0})


def difference(run, reference, name):
    """Largest difference over the peak to peak of the reference."""
    return float(np.abs(run[name] - reference[name]).max()) / float(np.ptp(reference[name].to_numpy()))


def test_both_models_return_the_same_table():
    linear, reference = multibody.simulate(BASE, 1, fidelity="linear"), lumped.simulate(BASE, 1)
    assert set(reference.data_vars) <= set(linear.data_vars)
    np.testing.assert_array_equal(linear["time"], reference["time"])
    for name, variable in reference.data_vars.items():
        assert linear[name].dims == variable.dims
        assert linear[name].attrs == variable.attrs
    for key in ("brake_torque", "pinion_torque", "mesh_efficiency", "parameters_sha256"):
        assert linear.attrs[key] == reference.attrs[key]


@pytest.mark.parametrize("options", [{"fidelity": "linear"}, {"effects": ()}], ids=["linear", "effects off"])
def test_all_effects_off_equals_lumped_to_integration_tolerance(options):
    """Involute geometry at the nominal pose is the lumped geometry: 1e-8 at rtol 1e-10."""
    run, reference = (multibody.simulate(BASE, 20, rtol=1e-10, **options), lumped.simulate(BASE, 20))
    for name in ("dte", "x_p", "x_g", "y_p", "y_g", "theta_p", "theta_g", "normal_load"):
        assert difference(run, reference, name) < 1e-8


@pytest.mark.parametrize("effect", sorted(multibody.EFFECTS))
def test_each_effect_acts(effect):
    """A switch that did nothing would make the attribution of differences worthless."""
    # Some effects act on laws that the pair itself has not.
    laws = {
        "friction_load": {"friction.law": "xu_kahraman"},
        "contact_law": {"mesh.stiffness": {"model": "energy"}},
        "neighbours": {"mesh.stiffness": {"model": "energy"}},
        "clearance": {"mesh.relief": "static"},
    }
    pair = BASE.with_(laws.get(effect, {}))
    start = np.zeros(12)
    start[0] = -5e-6 / lumped.geometry(BASE).base_radius_pinion  # apart, so that loss of contact can act
    reference = multibody.simulate(pair, 3, effects=(), initial=start)
    run = multibody.simulate(pair, 3, effects={effect}, initial=start)
    assert difference(run, reference, "dte") > 1e-5  # a thousand times the error of either run


@pytest.mark.slow
def test_order_in_torque_is_two():
    """Deflections are proportional to torque, what they do to the geometry to its square.

    So absolute differences have slope 2 over T ... T/64. Teeth that may not pull are left out: whether a load
    is negative does not depend on the size of the torque. The friction coefficient is a constant, because
    laws II and III depend on torque themselves. Measured: 1.989 (dte), 1.989 (x_p), 1.990 (y_p).
    """
    torques = 56.5 / 4.0 ** np.arange(4)
    sizes = {name: np.empty(4) for name in ("dte", "x_p", "y_p")}
    for j, torque in enumerate(torques):
        pair = SMOOTH.with_(operating__pinion_torque=float(torque))
        run = multibody.steady_state(pair, samples_per_cycle=128, effects={"contact_loss": False})
        reference = lumped.steady_state(pair, samples_per_cycle=128)
        for name, values in sizes.items():
            values[j] = np.abs(run[name] - reference[name]).max()
        if j == 0:
            assert 1e-3 < difference(run, reference, "dte") < 1e-2
    for name, values in sizes.items():
        order = np.polyfit(np.log(torques), np.log(values), 1)[0]
        assert order == pytest.approx(2.0, abs=0.05), name


def test_steady_state_attracts():
    """Pushed off the motion that Newton's method found on the flow map, a run settles on it again."""
    pair = SMOOTH.with_(mesh__damping_ratio=0.08)
    steady = multibody.steady_state(pair, samples_per_cycle=64)
    assert steady.attrs["closure"] < 1e-6
    names = lumped.periodic_system(pair, "full").state_names
    start = np.array([float(steady[name][0]) for name in names])
    start[2] += 2e-6  # the pinion, by a third of the swing of the transmission error
    setup = prepare(pair, initial=start, rtol=1e-9)
    run, _, _ = record(setup.with_torques(setup.machine.torque_pinion, steady.attrs["brake_torque"]), 80, 64)
    swing = float(np.ptp(steady["dte"].to_numpy()))
    off = [
        float(np.abs(run["dte"].to_numpy()[rows] - steady["dte"].to_numpy()).max()) / swing
        for rows in (slice(0, 64), slice(-65, -1))
    ]
    assert off[0] > 0.1
    # The free rotation is neutral: it keeps what friction did to it meanwhile, a slow shift of the phase.
    assert off[1] < 0.02 * off[0]


@pytest.mark.parametrize("stiffness", ["rectangular", "parabolic"])
def test_periodic_motion_is_found_where_friction_holds_the_teeth(stiffness):
    """There the lumped monodromy matrix is far from the own one, and iterating with it alone fails.

    Corrected along its way it closes the cycle to ten times rtol, in some ten cycles.
    """
    pair = lumped.load_gear_pair("kahraman_blankenship_50_50").with_(
        friction__law="benedict_kelley", mesh__stiffness={"model": stiffness}
    )
    slow = pair.with_(operating__pinion_speed=0.3 * pair.operating.pinion_speed * 30 / np.pi)
    run = multibody.steady_state(slow, samples_per_cycle=16)
    assert run.attrs["friction_velocity"] > 0.0
    assert run.attrs["closure"] < 1e-8


@pytest.mark.parametrize("stiffness", ["rectangular", "parabolic"])
def test_linear_steady_state_is_the_lumped_one(stiffness):
    pair = BASE.with_(mesh__stiffness={"model": stiffness})
    run, reference = multibody.steady_state(pair, fidelity="linear", rtol=1e-10), lumped.steady_state(pair)
    np.testing.assert_array_equal(run["time"], reference["time"])
    for name in ("dte", "x_p", "y_p", "theta_p", "normal_load"):
        assert difference(run, reference, name) < 1e-7
    for key in ("brake_torque", "mesh_efficiency"):
        assert run.attrs[key] == pytest.approx(reference.attrs[key], rel=1e-9)
