"""Is the prediction the best motion there is, and are its numbers those of that motion?"""

import tomllib

import numpy as np
import pytest

import floquet
import lumped
import multibody
from lumped.model.equations import COORDINATES
from validation.exchange.new_pair_file import new_pair_text
from validation.prediction.motion import Motion, predicted, unilateral_motion

PRESETS = ("fzg_c", "high_contact_ratio_29_47", "kahraman_blankenship_50_50", "nasa_28_28", "nasa_art_25_31")


def loaded(name: str) -> lumped.GearPair:
    return lumped.load_gear_pair(name).with_({"mesh.contact": "loaded"})


@pytest.mark.parametrize("name", PRESETS)
def test_it_is_within_one_percent_of_the_exact_multibody_motion(name):
    """What is left are finite motions: 0.02 to 0.7 % of the peak to peak on these pairs."""
    pair = loaded(name)
    exact = float(np.ptp(multibody.steady_state(pair)["dte"].to_numpy()))
    assert predicted(pair).peak_to_peak == pytest.approx(exact, rel=0.01)


def test_teeth_that_push_all_the_time_keep_the_linear_motion():
    changes = {"mesh.contact": "prescribed", "operating.pinion_speed": 800.0, "mesh.relief": "ignored"}
    pair = lumped.load_gear_pair("nasa_28_28").with_(changes | {"friction.law": "none"})
    found, linear = predicted(pair), lumped.steady_state(pair)
    assert float(linear["normal_load"].where(linear["contact"] > 0).min()) > 0.0
    assert found.motion is Motion.LINEAR
    assert found.peak_to_peak == pytest.approx(float(linear.attrs["dte_peak_to_peak"]), rel=1e-6)


def test_contact_loss_is_that_of_the_total_mesh_force():
    """One relieved pair begins to carry late: that is load sharing, and no contact loss."""
    pair = loaded("nasa_28_28")
    found = predicted(pair)
    loads = found.cycle["normal_load"].to_numpy()
    assert loads.min() == 0.0  # a pair is apart while it is on the path
    assert found.least_force > 0.7
    assert not found.contact_lost
    # Friction that varies in a long cycle swings a free train about its mean speed, at which it loses power.
    slow = predicted(pair.with_({"operating.pinion_speed": 30.0})).cycle
    sliding = -float(slow["friction_power"].sum("pair").mean())
    assert slow.attrs["power_sliding"] == pytest.approx(sliding, rel=1e-4)


def test_losses_of_the_motion_with_unilateral_contact_are_those_of_the_linear_one_where_they_agree():
    """With prescribed contact and no relief, at a speed where every pair pushes, both are one motion."""
    pair = loaded("kahraman_blankenship_50_50").with_({"operating.pinion_speed": 700.0})
    found, linear = predicted(pair), lumped.steady_state(pair)
    lost = sum(float(linear.attrs[k]) for k in ("power_sliding", "power_tooth_dampers", "power_bearings"))
    power = pair.operating.pinion_torque * pair.operating.pinion_speed
    assert 1.0 - found.efficiency == pytest.approx(lost / power, rel=0.02)


def test_losses_of_fast_gears_are_those_of_the_torques_of_the_multibody_model():
    """What a pair that leaves loses while it still expands, but does not pull, is 5 % of the losses here.

    Both models differ by finite motions, 0.1 % of the losses.
    """
    tips = {f"{gear}.{one}": None for gear in ("pinion", "gear") for one in ("tip_relief", "tip_diameter")}
    sizes = {"pinion.teeth": 31, "gear.teeth": 57, "centre_distance": None, "operating.pinion_speed": 29500}
    found = predicted(loaded("nasa_28_28").with_(tips | sizes))
    names = [f"{name}{rate}" for rate in ("", "_dot") for name in COORDINATES]
    start = np.array([found.cycle[name].values[0] for name in names])
    exact = multibody.steady_state(found.pair, initial=start)
    assert 1.0 - found.efficiency == pytest.approx(1.0 - exact.attrs["mesh_efficiency"], rel=5e-3)


def test_a_motion_that_newton_does_not_find_is_the_one_a_run_settles_to():
    text = new_pair_text(
        "fast",
        {
            "teeth": "31/57", "basic_rack.module": 3.0, "gears.face_width": 25.0,
            "operating.pinion_speed": 12000.0, "operating.pinion_torque": 150.0,
            "mesh.stiffness.model": "rectangular",
        },
    )  # fmt: skip
    pair = lumped.load_gear_pair(tomllib.loads(text))
    found = predicted(pair)
    assert found.motion is Motion.SETTLED
    assert found.contact_lost
    assert found.stable
    # Continued along its branch from 13000 rpm, where Newton finds it, the motion is the same.
    start = floquet.periodic_orbit(pair.with_({"operating.pinion_speed": 13000.0}))
    for rpm in np.linspace(13000.0, 12000.0, 11)[1:]:
        start = floquet.periodic_orbit(pair.with_({"operating.pinion_speed": float(rpm)}), start=start)
    low, high = start.dte_range
    assert np.diff(unilateral_motion(pair)[0].dte_range) == pytest.approx(high - low, rel=1e-6)
    # Contact and dampers that follow the momentary load move it by 0.2 %.
    assert found.peak_to_peak == pytest.approx(high - low, rel=0.005)


def test_an_unstable_motion_of_one_cycle_is_left_for_the_one_a_run_settles_to():
    changes = {"operating.pinion_speed": 4550.0, "mesh.damping_ratio": 0.02}
    pair = lumped.load_gear_pair("nasa_art_25_31").with_(changes)
    assert not floquet.periodic_orbit(pair).stable
    found = predicted(pair)
    assert (found.motion, found.mesh_cycles, found.stable) == (Motion.SETTLED, 2, True)
