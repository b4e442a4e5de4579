"""Is a stiffness of the whole mesh used as given: nothing added to it, nothing taken off?

It is load over transmission error of the whole mesh by definition: the static transmission error is F/k, of a
constant one the same at every phase. On stiff bearings the pair vibrates as two discs on one spring, with the
angular frequency sqrt(k (r1^2/I1 + r2^2/I2)) of any book on vibration.
"""

import math

import numpy as np
import pytest

import lumped
import multibody
from lumped import ParameterError, load_gear_pair, static_transmission_error
from lumped.quasi_static import optimal_relief
from lumped.schema.assumed import State
from lumped.schema.bodies import bodies_of
from spurcheck import dynamic_factor, new_pair
from tests.unlike_pairs import UNLIKE, unlike_pair

#: Contact and relief of the files are those of a tooth pair: the stiffness of the whole mesh decides anew.
FREE = {"mesh.contact": None, "mesh.relief": None}
PHASES = np.arange(64) / 64
#: The tooth of the pinion that is displaced, counted from 1.
DISPLACED_TOOTH = 5
#: Of a gear with a rim: three modules below the root circle are left.
BORES = {"19/41": (17.0, 70.0), "27/28": (30.0, 30.0)}


def wave(phase):
    """Stiffness over a mesh cycle [N/m], without symmetry."""
    return 3e8 * (1.0 + 0.2 * np.cos(2 * np.pi * phase) + 0.1 * np.sin(4 * np.pi * phase))


def whole(name, stiffness, **more):
    """One of the unlike pairs, its teeth alike, with a stiffness of the whole mesh."""
    return unlike_pair(name).healthy.with_({**FREE, **more}, stiffness=stiffness)


def force(pair):
    return pair.operating.pinion_torque / pair.geometry.base_radius_pinion


@pytest.mark.parametrize("name", UNLIKE)
def test_static_transmission_error_is_load_over_stiffness(name):
    """Contact ratios 1.1 to 2.3, with reliefs, with bores, at three torques: in proportion to the load."""
    constant = whole(name, 2.3e8)
    curve = whole(name, lambda phase: wave(phase))
    for pair, stiffness in ((constant, 2.3e8), (curve, wave(PHASES))):
        torques = pair.operating.pinion_torque * np.array([0.01, 1.0, 3.0])
        transmission_error = static_transmission_error(pair, torques, phases=64)[
            "transmission_error"
        ].to_numpy()
        expected = torques[:, None] / pair.geometry.base_radius_pinion / stiffness
        # A curve is sampled at 240 places, of which these phases are not all: (2 pi 2/240)^2/8 of 0.3.
        assert transmission_error == pytest.approx(
            np.broadcast_to(expected, transmission_error.shape), rel=1.5e-4
        )
        sharing = lumped.static_sharing(pair, samples_per_cycle=64)["transmission_error"].to_numpy()
        assert sharing == pytest.approx(transmission_error[1], rel=1e-8)
    assert (
        np.ptp(static_transmission_error(constant)["transmission_error"].to_numpy())
        < 1e-9 * force(constant) / 2.3e8
    )


@pytest.mark.parametrize("teeth", BORES)
def test_a_rim_changes_the_shares_and_not_the_sum(teeth):
    bores = dict(zip(("pinion.bore", "gear.bore"), BORES[teeth], strict=True))
    pair = new_pair(teeth, 2.5, 20.0, 1450.0, 80.0, bores, stiffness=4e8)
    transmission_error = static_transmission_error(pair)["transmission_error"].to_numpy()
    assert transmission_error == pytest.approx(np.full(transmission_error.shape, force(pair) / 4e8), rel=1e-8)


@pytest.mark.parametrize(
    ("name", "unilateral"),
    [
        ("contact_ratio_2_3_on_shafts", True),
        ("heavily_relieved_under_load", False),
        ("rack_25_degrees_always_pushing", True),
    ],
)
def test_both_models_stand_still_on_a_constant_stiffness(name, unilateral):
    """Nothing excites the mesh: both models turn without vibration, and the dynamic factor is 1."""
    pair = whole(name, 2.3e8, **{"friction.law": "none", "operating.torque_ripple": None, "shafts": None})
    contact = "unilateral" if unilateral else "linear"
    motion = lumped.steady_state(pair, contact=contact, samples_per_cycle=64)
    still = force(pair) / 2.3e8
    assert motion["dte"].to_numpy() == pytest.approx(np.full(64, still), rel=1e-7)
    assert dynamic_factor(pair) == pytest.approx(1.0, abs=1e-7)
    exact = multibody.steady_state(pair, samples_per_cycle=64)
    # Finite motions turn the line of action; early contact would be some per cent.
    assert float(np.ptp(exact["dte"].to_numpy())) < 1e-3 * still


def test_first_frequency_is_that_of_two_discs_on_one_spring():
    """38/62, module 5, 5e7 N/m, bearings that do not give way: 617.2 Hz."""
    inertia = {"pinion.inertia": 0.05, "gear.inertia": 0.15}
    changes = {"friction.law": "none", "bearings.stiffness": 1e12, **inertia}
    pair = new_pair("38/62", 5, 50, 1000, 950, changes, stiffness=5e7)
    r_p, r_g = pair.geometry.base_radius_pinion, pair.geometry.base_radius_gear
    expected = math.sqrt(5e7 * (r_p**2 / 0.05 + r_g**2 / 0.15)) / (2 * math.pi)
    assert expected == pytest.approx(617.2, abs=0.05)
    assert lumped.natural_frequencies(pair)[0] == pytest.approx(expected, rel=1e-4)
    assert dynamic_factor(pair) == pytest.approx(1.0, abs=1e-7)
    assert bodies_of(pair).inertia_pinion == 0.05


def test_errors_of_single_teeth_are_in_series_with_the_curve():
    """Where all pairs press, sum k_i (delta - e_i) = F: the errors act by their share of the stiffness."""
    pair = whole("rack_25_degrees_always_pushing", 2.3e8)
    index = [0.0] * pair.pinion.teeth
    index[DISPLACED_TOOTH - 1] = 3.0
    deviated = pair.with_({"pinion.deviations": {"index": index, "first_order": "steps"}})
    sharing, like = (lumped.static_sharing(one, samples_per_cycle=32) for one in (deviated, pair))
    load = sharing["normal_load"].to_numpy()
    total = force(deviated)
    still = force(deviated) / 2.3e8
    assert load.sum(axis=0) == pytest.approx(np.full(load.shape[1], total), rel=1e-9)
    # The share of a pair is the load without errors over that of the mesh, and repeats with every cycle.
    share = np.tile(like["normal_load"].to_numpy(), load.shape[1] // like.sizes["phase"]) / total
    displaced = sharing["pinion_tooth"].to_numpy() == DISPLACED_TOOTH
    late = np.where(displaced, 3e-6 * math.cos(pair.basic_rack.pressure_angle), 0.0)
    change = sharing["transmission_error"].to_numpy() - still
    assert change.max() > 2e-6
    assert change == pytest.approx((share * late).sum(axis=0), abs=1e-9)


def test_contact_and_relief_follow_the_stiffness():
    pair = load_gear_pair("nasa_28_28")
    assert (pair.mesh.contact, pair.mesh.relief) == ("loaded", "static")
    stiffness_stated = pair.with_(stiffness=2.5e8)
    assert (stiffness_stated.mesh.contact, stiffness_stated.mesh.relief) == ("prescribed", "ignored")
    assert stiffness_stated.state("mesh.contact") is stiffness_stated.state("mesh.relief") is State.ASSUMED
    again = load_gear_pair(stiffness_stated.to_mapping())
    assert again == stiffness_stated
    assert again.state("mesh.contact") is State.ASSUMED
    back = stiffness_stated.with_(stiffness="energy")
    assert (back.mesh.contact, back.mesh.relief) == ("loaded", "static")
    single = stiffness_stated.with_({"mesh.contact": "loaded"}, stiffness=lambda xi: 1e10 * xi)
    assert (single.mesh.contact, single.state("mesh.contact")) == ("loaded", State.KNOWN)
    contact_stated = pair.with_(mesh__contact="prescribed").with_(stiffness="energy")
    assert contact_stated.mesh.contact == "prescribed"  # what is known stays


def test_a_file_of_before_in_which_contact_was_assumed_is_read():
    """Until now a saved pair had contact = "loaded" as an assumed default beside any stiffness."""
    data = load_gear_pair("fzg_c").with_(stiffness=2.5e8).to_mapping()
    data["mesh"] |= {"contact": "loaded", "relief": "static"}
    data["assumed"] |= {"mesh.contact": "loaded", "mesh.relief": "static"}
    assert load_gear_pair(data).mesh.contact == "prescribed"
    del data["assumed"]["mesh.contact"]
    with pytest.raises(ParameterError, match=r"mesh\.contact = loaded"):
        load_gear_pair(data)


@pytest.mark.parametrize(
    ("changes", "field"),
    [({"mesh.contact": "loaded"}, "mesh.contact"), ({"mesh.relief": "static"}, "mesh.relief")],
)
def test_what_the_stiffness_has_in_it_is_refused_beside_it(changes, field):
    pair = load_gear_pair("nasa_28_28")
    for attempt in (
        lambda: pair.with_(changes).with_(stiffness=2.5e8),
        lambda: pair.with_(stiffness=2.5e8).with_(changes),
        lambda: pair.with_({**changes, "mesh.stiffness": 2.5e8}),
    ):
        with pytest.raises(ParameterError) as caught:
            attempt()
        (problem,) = caught.value.problems
        assert (problem.field, problem.value) == (field, next(iter(changes.values())))
        assert "whole mesh" in problem.allowed
        assert "kind = 'pair'" in problem.action
        assert f"{field} = " in problem.action


def test_relief_counts_once():
    """The profile is in the curve: another amount of relief changes nothing."""
    plain = whole("heavily_relieved_under_load", wave)
    more = plain.with_({"pinion.tip_relief.amount": 1.7 * plain.pinion.tip_relief.amount * 1e6})
    a, b = (lumped.steady_state(one, samples_per_cycle=64)["dte"].to_numpy() for one in (plain, more))
    assert np.array_equal(a, b)
    with pytest.raises(ParameterError, match=r"mesh\.stiffness\.kind = total"):
        optimal_relief(plain)


def test_extended_contact_is_refused_where_the_curve_has_it():
    with pytest.raises(ParameterError, match="extended = True: allowed False where"):
        static_transmission_error(whole("rack_25_degrees_always_pushing", 2.3e8), extended=True)


def test_a_constant_of_any_pair_is_sampled():
    """Five phases are a quarter of a cycle apart, which rounding must not make more than a quarter."""
    for name in lumped.preset_names():
        for shift in (0.0, 0.013, 0.21):
            pair = load_gear_pair(name).with_(
                {"pinion.profile_shift": shift, "centre_distance": None, "mesh.relief": None}
            )
            assert pair.with_(stiffness=2.5e8).mesh.stiffness.whole_mesh


def test_results_say_whose_stiffness_is_given():
    pair = load_gear_pair("fzg_c")
    stiffness_stated = pair.with_(stiffness=5e7)
    assert (
        lumped.mesh_stiffness(stiffness_stated).attrs["stiffness"]
        == "stiffness of the whole mesh, as given: 5e7 N/m"
    )
    curve = static_transmission_error(pair.with_(stiffness=lambda xi: 1e8 + 0.0 * xi))
    assert curve.attrs["stiffness"] == "stiffness of one tooth pair, as given: 1e8 N/m"
    assert "one tooth pair, model rectangular" in static_transmission_error(pair).attrs["stiffness"]
