"""Do motions of the multibody model that start on a motion with contact loss stay on it?"""

import numpy as np
import pytest

import floquet
import lumped
import multibody
from floquet.gear.unilateral import unilateral_system
from lumped import ParameterError
from lumped.model.equations import X_P
from tests.unlike_pairs import UNLIKE, unlike_pair
from validation.cross_check.comparison import crosscheck
from validation.cross_check.verdict import Verdict


@pytest.fixture(scope="module")
def pair_beyond():
    """At 8000 rpm contact is lost."""
    return lumped.load_gear_pair("nasa_28_28").with_(
        mesh__contact="prescribed", mesh__damping_ratio=0.05, mesh__relief="ignored", friction__law="none",
        operating__pinion_speed="8000 rpm",
    )  # fmt: skip


@pytest.mark.parametrize(("name", "effects"), [
    ("larger_gear_drives_contact_lost", "loaded"),
    ("heavily_relieved_under_load", "loaded"),
    ("nasa_28_28", "prescribed, exact kernel"),
])  # fmt: skip
def test_the_multibody_model_has_the_same_periodic_motion(name, effects):
    """With relief as clearance, friction and y; it finds the motion by Broyden's method from its own runs."""
    contact, _, kernel = effects.partition(", ")
    pair = unlike_pair(name) if name in UNLIKE else lumped.load_gear_pair(name)
    pair = pair.with_(mesh__contact=contact)
    orbit = floquet.periodic_orbit(pair)
    assert orbit.contact_lost
    run = multibody.steady_state(
        pair,
        fidelity="exact" if kernel else "linear",
        effects=["contact_loss", "clearance"] if kernel else ["contact_loss"],
        initial=orbit.states[0],
        samples_per_cycle=256,
    )
    for name in ("dte", "x_p", "x_g", "y_p", "y_g", "bearing_force_y_p"):
        expected = orbit.motion[name].values
        assert run[name].values == pytest.approx(expected, abs=1e-6 * np.ptp(expected)), name
    loads = orbit.motion.normal_load.values
    assert run.normal_load.values == pytest.approx(loads, abs=1e-6 * loads.max())
    assert run.attrs["brake_torque"] == pytest.approx(orbit.brake_torque, rel=1e-6)


def test_motions_of_two_cycles_are_found_too(pair_beyond):
    """The motion is unstable, so no run settles to this motion. At half the speed it repeats every cycle."""
    start = np.zeros(12)
    start[0] = 1e-4 / pair_beyond.geometry.base_radius_pinion
    single = floquet.periodic_orbit(pair_beyond.with_({"operating.pinion_speed": 9500.0}), start=start)
    pair = pair_beyond.with_({"operating.pinion_speed": 19000.0})
    orbit = floquet.periodic_orbit(pair, 2, single.states[0])
    assert orbit.spectral_radius == pytest.approx(single.spectral_radius, rel=1e-6)
    assert not orbit.stable
    run = multibody.steady_state(
        pair, fidelity="linear", effects=["contact_loss"], initial=orbit.states[0], cycles=2
    )
    expected = orbit.motion.dte.values
    assert run.dte.values[::2] == pytest.approx(expected, abs=1e-6 * np.ptp(expected))
    with pytest.raises(ParameterError, match="at most contact_loss"):
        multibody.steady_state(pair, fidelity="linear", effects=["entry_shift"])


def test_the_multibody_sweep_measures_the_mean_over_whole_cycles(pair_beyond):
    """The root mean square is that of the periodic motion. One sample too many gave an error of 6e-4."""
    orbit = floquet.periodic_orbit(pair_beyond)
    sweep = multibody.speed_sweep(
        pair_beyond,
        [8000.0],
        settle=150,
        cycles=2,
        samples_per_cycle=256,
        effects=["contact_loss"],
        rtol=1e-8,
    )
    assert float(sweep["dte_rms"][0]) == pytest.approx(orbit.dte_rms, rel=1e-5)
    assert float(sweep["unsettled"][0]) < 1e-5


@pytest.mark.parametrize("name", ["larger_gear_drives_contact_lost", "rack_25_degrees_always_pushing"])
def test_back_sides_strike_as_in_the_multibody_model(name):
    """There the mirror image of the drive flanks, from body angles; here laws of the phase. With friction."""
    pair = unlike_pair(name).with_(mesh__contact="prescribed", mesh__damping_ratio=0.05)
    backlash = pair.geometry.normal_backlash
    period = pair.geometry.mesh_period
    start = np.zeros(12)
    start[X_P] = 3.0 * backlash  # the pinion presses deep and is thrown onto the back side
    run = multibody.simulate(
        pair, 3, initial=start, effects=["contact_loss"], rtol=1e-11, samples_per_cycle=64
    )
    state = np.zeros(10)
    state[1] = start[X_P]
    lumped_run = unilateral_system(pair, form="back_side").run(
        state, period, 3, run.attrs["brake_torque"], samples=np.arange(64) / 64
    )
    for j, variable in enumerate(("x_p", "x_g", "y_p", "y_g"), 1):
        wanted = run[variable].values[:-1]
        assert lumped_run.states[:, j] == pytest.approx(wanted, abs=1e-8 * np.ptp(wanted)), variable
    back = run.normal_load_back.sum("pair").values[:-1]
    drive = run.sizes["pair"]
    assert back.max() > 1000.0
    assert lumped_run.loads[:, drive:].sum(axis=1) == pytest.approx(back, abs=1e-6 * back.max())


@pytest.fixture(scope="module")
def contact_lost():
    """Default pair: its relief makes the linear motion need teeth that pull."""
    return crosscheck(
        lumped.load_gear_pair("nasa_28_28").with_(mesh__contact="prescribed"),
        cycles=6,
        samples_per_cycle=64,
        variant=False,
    )


def test_the_cross_check_compares_the_motion_with_unilateral_contact(contact_lost, pair_beyond):
    loaded = pair_beyond.with_({"mesh.contact": "loaded", "friction.law": "coulomb"})
    loaded = loaded.with_({"operating.pinion_speed": 17000.0, "mesh.stiffness": {"model": "energy"}})
    for check in (contact_lost, crosscheck(loaded, cycles=6, samples_per_cycle=64, variant=False)):
        assert check.orbit.contact_lost
        assert check.periodic
        assert check.failures == ()
        assert check.pulling == ""
        [dte] = [a for a in check.of("exact") if a.quantity == "dte"]
        assert 1e-5 < dte.difference < 0.05
    assert contact_lost.verdict is Verdict.AGREES
