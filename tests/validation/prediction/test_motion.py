"""Is the prediction the best motion there is, and are its numbers those of that motion?"""

import itertools
import tomllib

import numpy as np
import pytest

import floquet
import lumped
import multibody
from lumped.model.equations import COORDINATES
from tests.unlike_pairs import UNLIKE, unlike_pair
from validation.cross_check.motions import settled_orbit
from validation.exchange.new_pair_file import new_pair, new_pair_text
from validation.prediction.motion import Motion, predict, predicted


def loaded(name: str) -> lumped.GearPair:
    return lumped.load_gear_pair(name).with_({"mesh.contact": "loaded"})


def smaller(pair: lumped.GearPair, share: float) -> lumped.GearPair:
    """Every length of a tooth's motion times a share: deflections, by the torque, relief and backlash."""
    sizes = {
        "operating.pinion_torque": pair.operating.pinion_torque,
        "mesh.backlash": 1e3 * pair.mesh.backlash,
    }
    for name in ("pinion", "gear"):
        if (relief := getattr(pair, name).tip_relief) is not None:
            sizes[f"{name}.tip_relief.amount"] = 1e6 * relief.amount
    return pair.with_({field: share * size for field, size in sizes.items()})


@pytest.mark.parametrize("name", [name for name in UNLIKE if unlike_pair(name).healthy is unlike_pair(name)])
def test_it_is_within_one_percent_of_the_exact_multibody_motion(name):
    """What is left are finite motions, which fall with every length.

    At the full torque they are 0.3 % of the peak to peak with relief and 1.5 to 6 % where vibration turns the
    sliding and moves the contact, at a quarter 0.02 to 0.4 %. What is no finite motion stays.
    """
    pair = smaller(unlike_pair(name), 0.25)
    supports = "springs" if pair.shafts is None else "shafts"
    exact = float(np.ptp(multibody.steady_state(pair, supports=supports)["dte"].to_numpy()))
    assert predicted(pair).peak_to_peak == pytest.approx(exact, rel=0.01)


def test_with_a_relief_of_the_size_of_the_deflection_it_is_the_exact_motion_at_the_full_torque():
    pair = unlike_pair("heavily_relieved_under_load")
    exact = float(np.ptp(multibody.steady_state(pair)["dte"].to_numpy()))
    assert predicted(pair).peak_to_peak == pytest.approx(exact, rel=0.01)


def test_with_such_a_relief_it_is_the_exact_motion_where_the_linear_one_pulls_nowhere_too():
    """The motion by momentary load is the exact one: nothing else of the program is in the way."""
    rectangular = {"mesh.stiffness": {"model": "rectangular"}}
    pair = new_pair("33/35", module=4, face_width=40, speed=8000, torque=1500, changes=rectangular)
    relief = {"shape": "linear", "amount": 40.0, "start_roll_angle": 24.0}
    pair = pair.with_({f"{gear}.tip_relief": relief for gear in ("pinion", "gear")})
    exact = float(np.ptp(multibody.steady_state(pair)["dte"].to_numpy()))
    assert predicted(pair).peak_to_peak == pytest.approx(exact, rel=0.001)


@pytest.mark.parametrize("name", ["rack_25_degrees_always_pushing", "larger_gear_drives_contact_lost"])
def test_in_fixed_windows_teeth_that_push_all_the_time_move_as_in_the_linear_motion(name):
    pair = unlike_pair(name).with_({"mesh.contact": "prescribed"})
    prediction = predicted(pair)
    linear = lumped.steady_state(pair)
    assert float(linear["normal_load"].where(linear["contact"] > 0).min()) > 0.0
    assert prediction.motion is Motion.UNILATERAL
    assert prediction.peak_to_peak == pytest.approx(float(linear.attrs["dte_peak_to_peak"]), rel=1e-6)


def test_contact_loss_is_that_of_the_total_mesh_force():
    """One relieved pair begins to carry late: that is load sharing, and no contact loss."""
    pair = loaded("nasa_28_28")
    prediction = predicted(pair)
    loads = prediction.cycle["normal_load"].to_numpy()
    assert loads.min() == 0.0  # a pair is apart while it is on the path
    assert prediction.least_force > 0.7
    assert not prediction.contact_lost
    # Friction that varies in a long cycle swings a free train about its mean speed, at which it loses power.
    slow = predicted(pair.with_({"operating.pinion_speed": 30.0})).cycle
    sliding = -float(slow["friction_power"].sum("pair").mean())
    assert slow.attrs["power_sliding"] == pytest.approx(sliding, rel=1e-4)


def test_losses_of_fast_gears_are_those_of_the_torques_of_the_multibody_model():
    """What a pair that leaves loses while it still expands, but does not pull, is 5 % of the losses here.

    Both models differ by finite motions, 0.1 % of the losses.
    """
    tips = {f"{gear}.{one}": None for gear in ("pinion", "gear") for one in ("tip_relief", "tip_diameter")}
    sizes = {"pinion.teeth": 31, "gear.teeth": 57, "centre_distance": None, "operating.pinion_speed": 29500}
    prediction = predicted(loaded("nasa_28_28").with_(tips | sizes))
    names = [f"{name}{rate}" for rate in ("", "_dot") for name in COORDINATES]
    start = np.array([prediction.cycle[name].values[0] for name in names])
    exact = multibody.steady_state(prediction.pair, initial=start)
    assert 1.0 - prediction.efficiency == pytest.approx(1.0 - exact.attrs["mesh_efficiency"], rel=5e-3)


def test_a_motion_that_newton_does_not_find_is_the_one_a_run_settles_to():
    text = new_pair_text(
        "fast",
        {
            "teeth": "31/57", "basic_rack.module": 3.0, "gears.face_width": 25.0,
            "operating.pinion_speed": 12000.0, "operating.pinion_torque": 150.0,
            "mesh.stiffness.model": "rectangular", "bearings.stiffness": 1e8, "friction.law": "xu_kahraman",
        },
    )  # fmt: skip
    pair = lumped.load_gear_pair(tomllib.loads(text))
    prediction = predicted(pair)
    assert prediction.motion is Motion.SETTLED
    assert prediction.contact_lost
    assert prediction.stable
    # Continued along its branch from 13000 rpm, where Newton finds it, the motion is the same.
    start = floquet.periodic_orbit(pair.with_({"operating.pinion_speed": 13000.0}))
    for rpm in np.linspace(13000.0, 12000.0, 11)[1:]:
        start = floquet.periodic_orbit(pair.with_({"operating.pinion_speed": float(rpm)}), start=start)
    low, high = start.dte_range
    assert np.diff(settled_orbit(pair).dte_range) == pytest.approx(high - low, rel=1e-6)
    # Contact and dampers that follow the momentary load move it by 0.2 %.
    assert prediction.peak_to_peak == pytest.approx(high - low, rel=0.005)


def test_an_unstable_motion_of_one_cycle_is_left_for_the_one_a_run_settles_to():
    changes = {"operating.pinion_speed": 4550.0, "mesh.damping_ratio": 0.02}
    pair = lumped.load_gear_pair("nasa_art_25_31").with_(changes)
    assert not floquet.periodic_orbit(pair).stable
    prediction = predicted(pair)
    assert (prediction.motion, prediction.mesh_cycles, prediction.stable) == (Motion.SETTLED, 2, True)


@pytest.mark.parametrize("name", ["heavily_relieved_under_load", "rack_25_degrees_always_pushing"])
def test_its_stability_is_that_of_the_exact_motion(name):
    """Multipliers of two programs; far from contact loss those of the linear form may be others.

    A share of every length leaves a share of what finite motions change: 0.05 and 0.25 %.
    """
    pair = smaller(unlike_pair(name), 0.0625)
    exact = multibody.monodromy(pair, fidelity="exact").spectral_radius
    assert predicted(pair).cycle.attrs["spectral_radius"] == pytest.approx(exact, rel=5e-3)


def test_a_pair_in_a_tongue_of_the_linear_form_may_be_stable():
    """Contact begins and ends by the momentary load, above resonance not where it does at rest."""
    changes = {"friction.law": "none", "mesh.damping_ratio": 0.001, "operating.pinion_speed": "6350 rpm"}
    pair = loaded("nasa_28_28").with_(changes)
    assert lumped.steady_state(pair).attrs["spectral_radius"] > 1.05
    prediction = predicted(pair)
    assert prediction.stable
    exact = multibody.monodromy(pair, fidelity="exact").spectral_radius
    assert prediction.cycle.attrs["spectral_radius"] == pytest.approx(exact, rel=1e-3)


@pytest.mark.parametrize(("name", "changes", "motion"), [
    ("nasa_28_28", {"operating.pinion_speed": "20 rpm"}, Motion.UNILATERAL),
    ("nasa_28_28", {"operating.pinion_speed": "1 rpm"}, Motion.LINEAR),
    ("fzg_c", {"operating.pinion_speed": "60000 rpm"}, Motion.SETTLED),
    ("contact_ratio_1_1_large_shifts", {"operating.pinion_torque": 0.01}, Motion.UNILATERAL),
    ("nasa_28_28", {"operating.pinion_torque": 0.01}, Motion.LINEAR),
    ("heavily_relieved_under_load", {"mesh.damping_ratio": 0.0}, Motion.SETTLED),
    ("rack_25_degrees_always_pushing", {"mesh.damping_ratio": 0.0}, Motion.UNILATERAL),
])  # fmt: skip
def test_the_motion_of_a_slow_fast_light_or_undamped_pair_is_named(name, changes, motion):
    """Where none with unilateral contact is found the linear one stands in, and the reason is told."""
    pair = unlike_pair(name) if name in UNLIKE else lumped.load_gear_pair(name)
    prediction = predicted(pair.with_(changes))
    assert prediction.motion is motion
    assert bool(prediction.reason) == (motion is Motion.LINEAR)
    assert prediction.stable
    assert prediction.cycle.attrs["contact"] == ("linear" if motion is Motion.LINEAR else "unilateral")


def slow_and_rough() -> lumped.GearPair:
    """A pair that hardly vibrates. By its shifts most of the contact lies behind the pitch point, where the
    friction on the pinion carries a part of the torque.
    """
    changes = {
        "pinion.profile_shift": 0.59,
        "gear.profile_shift": -0.28,
        "friction.law": "coulomb",
        "friction.coefficient": 0.1,
    }
    return new_pair((58, 227), 2.87, 11.6, 38.8, 515, changes)


@pytest.mark.parametrize("name", [*UNLIKE, "slow and rough", "brake torque given"])
def test_the_mean_mesh_force_is_the_torque_less_what_friction_carries(name):
    """Balance of the moments on the pinion over a period: T_p = r_bp <N> + <sum F xi>."""
    if name == "brake torque given":
        pair = unlike_pair("larger_gear_drives_contact_lost").with_({"operating.brake_torque": 27.8})
    else:
        pair = slow_and_rough() if name == "slow and rough" else unlike_pair(name)
    prediction = predicted(pair)
    cycle = prediction.cycle
    carried = (cycle["friction_force"] * cycle["position"]).sum("pair").to_numpy().mean()
    torque = cycle.attrs["pinion_torque"]
    base_radius = pair.geometry.base_radius_pinion
    # Friction jumps between two samples: a mean of samples errs by a jump over their number.
    assert base_radius * prediction.mean_force == pytest.approx(torque - carried, rel=3e-4)
    assert abs(carried) > 1e-3 * torque
    assert prediction.least_force <= 1.0 <= prediction.dynamic_factor


def test_the_largest_force_of_a_slow_pair_is_below_the_torque_over_the_base_radius():
    """Why the dynamic factor is over the mean force of the motion, and not over T_p / r_bp."""
    prediction = predicted(slow_and_rough())
    assert prediction.mesh_force.max() < 0.997 * prediction.static_force
    assert prediction.dynamic_factor > 1.0


#: Drawn pair 967 of docs/verification/answers.md: 6,000 vibrations of the fastest mode in a mesh cycle.
SLOW = new_pair(
    (17, 15), 1.24, 7.1, 27.2, 26.2,
    {"mesh.stiffness.model": "parabolic", "pinion.profile_shift": 0.64, "gear.profile_shift": 0.47},
)  # fmt: skip


def test_a_slow_pair_has_the_motion_of_slow_rolling():
    """A start fades within a mesh cycle, so the run repeats, to the rounding of its 50,000 steps.

    So slow a pair moves as in the static and in the linear form but for the jerk of a tooth that enters:
    the total force within a hundredth, the transmission error within a third of its peak to peak. Between
    its 512 outputs lie a dozen vibrations, of which the outputs know nothing.
    """
    prediction = predicted(SLOW)
    assert prediction.motion is Motion.SETTLED
    assert prediction.stable
    linear = lumped.steady_state(SLOW)
    static = lumped.static_transmission_error(SLOW)
    force = linear["normal_load"].sum("pair")
    assert prediction.dynamic_factor == pytest.approx(float(force.max() / force.mean()), rel=0.01)
    assert prediction.peak_to_peak == pytest.approx(linear.attrs["dte_peak_to_peak"], rel=0.1)
    assert 1.0 < prediction.peak_to_peak / float(static["peak_to_peak"][0]) < 4.0 / 3.0
    sampled = float(np.ptp(prediction.plain.values["dte"]))
    assert sampled <= prediction.peak_to_peak < 1.1 * sampled


@pytest.mark.parametrize("name", ["larger_gear_drives_contact_lost", "unlike_teeth_finite_elements"])
def test_progress_is_told_while_the_motion_is_computed(name):
    told = []
    predict(unlike_pair(name), progress=told.append)
    assert told[0] == 0.0
    assert told[-1] == 1.0
    assert len(told) >= 4
    assert all(before < after for before, after in itertools.pairwise(told))


def test_a_stable_motion_beside_chaos_is_followed_and_said_to_be_one_of_several():
    """25/31 with little damping: runs from the linear motion do not settle, `tests/lumped/model`."""
    changes = {"mesh.damping_ratio": 0.00858, "operating.pinion_speed": "9560.63 rpm"}
    prediction = predicted(lumped.load_gear_pair("nasa_art_25_31").with_(changes))
    assert prediction.motion is Motion.FOLLOWED
    assert prediction.roams
    assert prediction.stable
    assert prediction.contact_lost
    assert not prediction.reason


def test_the_linear_motion_of_a_pair_that_roams_is_said_to_stand_in():
    changes = {"mesh.damping_ratio": 0.00742, "operating.pinion_speed": "4579.19 rpm"}
    pair = lumped.load_gear_pair("nasa_art_25_31").with_(changes)
    prediction = predicted(pair)
    assert (prediction.motion, prediction.roams) == (Motion.LINEAR, True)
    slow = predicted(loaded("nasa_28_28").with_({"operating.pinion_speed": "1 rpm"}))
    assert (slow.motion, slow.roams) == (Motion.LINEAR, False)
