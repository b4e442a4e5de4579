"""Do the lumped and the multibody model agree, and differ by what finite motion explains?"""

import numpy as np
import pytest

import lumped
import multibody
from lumped.model.equations import X_P
from multibody.run.effects import default_effects
from multibody.run.setup import prepare
from multibody.run.simulation import record
from tests.unlike_pairs import unlike_pair
from validation.cross_check.agreement import _scale

BASE = lumped.load_gear_pair("nasa_28_28").with_(
    mesh__contact="prescribed", mesh__relief="ignored", friction__law="coulomb", friction__coefficient=0.05,
    operating__pinion_torque=56.5, operating__pinion_speed=4875,
)  # fmt: skip
SMOOTH = BASE.with_(mesh__stiffness={"model": "parabolic", "ramp_length": 3.0})


def difference(run, reference, name):
    """Largest difference over the peak to peak of the reference."""
    return float(np.abs(run[name] - reference[name]).max()) / float(np.ptp(reference[name].to_numpy()))


def test_the_measure_of_the_load_is_at_most_the_static_load():
    """Mean 110 N: teeth that bend by 0 to 4 um about a mean of 2 um swing by the whole load, and no more."""
    for swing, expected in ((1.0, 55.0), (4.0, 110.0)):
        dte = 2.0 + swing * np.array([-0.5, 0.5])
        assert _scale("normal_load", dte, np.array([100.0, 120.0])) == pytest.approx(expected)
    assert _scale("normal_load", np.array([-1.0, 4.0]), np.array([100.0, 120.0])) == 110.0


def test_both_models_return_the_same_table():
    pair = RACK_25.with_(mesh__contact="prescribed")
    linear = multibody.simulate(pair, 1, fidelity="linear")
    reference = lumped.simulate(pair, 1)
    assert set(reference.data_vars) <= set(linear.data_vars)
    np.testing.assert_array_equal(linear["time"], reference["time"])
    for name, variable in reference.data_vars.items():
        assert linear[name].dims == variable.dims
        assert linear[name].attrs == variable.attrs
    for key in ("brake_torque", "pinion_torque", "mesh_efficiency", "parameters_sha256"):
        assert linear.attrs[key] == reference.attrs[key]


RACK_25 = unlike_pair("rack_25_degrees_always_pushing")
RATIO_1_1 = unlike_pair("contact_ratio_1_1_large_shifts")
LARGER_DRIVES = unlike_pair("larger_gear_drives_contact_lost")
#: At a fifth of its torque the relief keeps pairs apart on the path.
APART = unlike_pair("heavily_relieved_under_load").with_(operating__pinion_torque=300.0)
#: Effect -> a pair on which it acts, and one that has not what it acts on.
WHERE_IT_ACTS = {
    "rotation_phase": (RACK_25, None),
    "moving_line": (RACK_25, None),
    "sliding_velocity": (RACK_25, RACK_25.with_(friction__law="none")),
    "entry_shift": (RATIO_1_1.with_(mesh__contact="prescribed"), RATIO_1_1),  # loaded: gaps say where
    "contact_loss": (LARGER_DRIVES, None),
    "friction_load": (RACK_25, LARGER_DRIVES),  # law II, law IV
    "path_work": (RACK_25, None),
    "tip_contact": (RACK_25, None),
    "clearance": (APART.with_(mesh__contact="prescribed"), RACK_25.with_(mesh__contact="prescribed")),
    "contact_law": (LARGER_DRIVES, RACK_25),  # of stiffness that knows Hertz's part
    "neighbours": (LARGER_DRIVES, RACK_25),  # of stiffness that knows the body's part
}


@pytest.mark.parametrize("effect", sorted(multibody.EFFECTS))
def test_each_effect_acts_where_its_physics_is_and_nowhere_else(effect):
    """Turned round among those of the form of contact: a switch that did nothing, or something else, would
    make the attribution of differences worthless.
    """

    def change(pair):
        start = np.zeros(12)
        start[0] = -5e-6 / pair.geometry.base_radius_pinion  # apart, so that loss of contact can act
        acts = effect in default_effects(pair.mesh.contact)
        deflected, run = (
            multibody.simulate(pair, 3, effects={effect: on}, initial=start) for on in (not acts, acts)
        )
        return difference(deflected, run, "dte")

    there, elsewhere = WHERE_IT_ACTS[effect]
    assert change(there) > 1e-3  # clearance, the least, changes 0.3 %; a run errs by 1e-7
    assert elsewhere is None or change(elsewhere) == 0.0


def test_steady_state_attracts():
    """Pushed off the motion that Newton's method found on the flow map, a run settles on it again."""
    pair = SMOOTH.with_(mesh__damping_ratio=0.08)
    steady = multibody.steady_state(pair, samples_per_cycle=64)
    assert steady.attrs["closure"] < 1e-6
    names = lumped.periodic_system(pair, "full").state_names
    start = np.array([float(steady[name][0]) for name in names])
    start[X_P] += 2e-6  # the pinion, by a third of the swing of the transmission error
    setup = prepare(pair, initial=start, rtol=1e-9)
    run, _, _ = record(setup.with_torques(setup.machine.torque_pinion, steady.attrs["brake_torque"]), 80, 64)
    swing = float(np.ptp(steady["dte"].to_numpy()))
    distances = [
        float(np.abs(run["dte"].to_numpy()[rows] - steady["dte"].to_numpy()).max()) / swing
        for rows in (slice(0, 64), slice(-65, -1))
    ]
    assert distances[0] > 0.1
    # The free rotation is neutral: it keeps what friction did to it meanwhile, a slow shift of the phase.
    assert distances[1] < 0.02 * distances[0]


@pytest.mark.parametrize("stiffness", ["rectangular", "parabolic"])
def test_periodic_motion_is_found_where_friction_holds_the_teeth(stiffness):
    """Here the lumped monodromy matrix is far from the matrix of the multibody model.

    An iteration with the lumped matrix alone fails. Broyden's method corrects the matrix in every step, and
    closes the cycle to ten times rtol in some ten cycles.
    """
    pair = lumped.load_gear_pair("kahraman_blankenship_50_50").with_(
        mesh__contact="prescribed", friction__law="benedict_kelley", mesh__stiffness={"model": stiffness}
    )
    slow = pair.with_(operating__pinion_speed=0.3 * pair.operating.pinion_speed * 30 / np.pi)
    run = multibody.steady_state(slow, samples_per_cycle=16)
    assert run.attrs["friction_velocity"] > 0.0
    assert run.attrs["closure"] < 1e-8


def steady_difference(pair):
    """Periodic motions compared, each with the brake torque that balances it: no transient, no drift."""
    springs = {"samples_per_cycle": 128, "supports": "springs"}
    run = multibody.steady_state(pair, effects={"contact_loss": False}, **springs)
    reference = lumped.steady_state(pair, **springs)
    return {name: difference(run, reference, name) for name in ("dte", "x_p", "x_g", "theta_p", "theta_g")}


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    ["contact_ratio_2_3_on_shafts", "heavily_relieved_under_load", "rack_25_degrees_always_pushing"],
)
def test_exact_level_scales_with_torque(name):
    """Coulomb friction (a coefficient free of torque) at a fourth and at a sixteenth of the pair's torque.

    Not where vibration turns the sliding (contact ratio 1.1) or light damping stands at a resonance that
    finite motions move (the larger gear): there the difference is no first order of the torque.
    """
    pair = unlike_pair(name).with_(
        mesh__contact="prescribed",
        mesh__relief="ignored",
        friction__law="coulomb",
        friction__coefficient=0.05,
    )
    torque = pair.operating.pinion_torque
    full, quarter = (
        steady_difference(pair.with_(operating__pinion_torque=share * torque)) for share in (0.25, 0.0625)
    )
    for name, value in full.items():
        # The next order in torque is a share of the difference itself: some per cent.
        assert value / quarter[name] == pytest.approx(4.0, rel=0.08), name
        assert value < 0.15
