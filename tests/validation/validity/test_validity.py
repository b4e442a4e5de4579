"""Do the validity flags notice what breaks the model, and say where?"""

import numpy as np
import pytest

import lumped
from floquet.gear.multipliers import gear_pair_multipliers
from validation.validity import flags as validity
from validation.validity.flags import validity_state, worst_state


@pytest.fixture(scope="module")
def motion(pair):
    return lumped.steady_state(pair, samples_per_cycle=256)


def _flag(flags, key):
    return next(flag for flag in flags if flag.key == key)


def test_a_motion_with_positive_loads_keeps_contact(pair, motion):
    flag = _flag(validity.validity_flags(pair, motion), "contact_loss")
    assert flag.state == "ok"
    assert flag.action == ""
    assert flag.value == motion["normal_load"].to_numpy()[motion["contact"].to_numpy() > 0].min()


def test_a_negative_load_is_contact_loss_with_its_place(pair, motion):
    g = lumped.geometry(pair)
    pulled = motion.copy(deep=True)
    row = 10
    pulled["normal_load"].to_numpy()[1, row] = -55.0
    flag = _flag(validity.validity_flags(pair, pulled), "contact_loss")
    assert flag.state == "violated"
    assert flag.value == -55.0
    distance = 1e3 * (float(motion["position"][1, row]) - g.L_XA)
    assert f"{distance:.3f} mm after A, between A and B" in flag.detail
    assert flag.action


def test_a_negative_number_of_a_pair_out_of_contact_does_not_matter(pair, motion):
    outside = motion.copy(deep=True)
    apart = np.argwhere(motion["contact"].to_numpy() == 0)[0]
    outside["normal_load"].to_numpy()[tuple(apart)] = -55.0
    assert _flag(validity.validity_flags(pair, outside), "contact_loss").state == "ok"


@pytest.mark.parametrize(("share", "state"), [(0.01, "ok"), (0.03, "warning"), (0.2, "violated")])
def test_sliding_reversal_is_measured_from_the_pitch_point(pair, motion, share, state):
    g = lumped.geometry(pair)
    turned = motion.copy(deep=True)
    position = motion["position"].to_numpy()
    nominal = position - g.L_XP
    # Sliding reversed exactly within this share of a base pitch after P.
    reverse = (nominal > 0) & (nominal < share * g.base_pitch)
    turned["sliding_velocity"].to_numpy()[:] = np.where(reverse, -1.0, 1.0) * np.sign(nominal)
    flag = _flag(validity.validity_flags(pair, turned), "sliding_reversal")
    assert flag.state == state
    spacing = g.base_pitch / 256
    assert abs(flag.value - share * g.base_pitch) <= spacing  # the jump is between two samples


def test_a_wrong_brake_torque_is_noticed_with_the_torque_that_would_balance(pair):
    braked = pair.with_({"operating.brake_torque": 50.0})
    flag = _flag(validity.validity_flags(braked, lumped.steady_state(braked)), "torque_balance")
    assert flag.state == "violated"
    # T_p of the balance is T_g over the efficiency 0.997: 50.15 N m, 11 % below the 56.5 N m given.
    assert flag.value == pytest.approx(1 - 50.0 / 0.9971 / 56.5, rel=1e-3)


def test_drift_is_relative_to_the_nominal_speed(pair):
    run = lumped.simulate(pair, cycles=4, samples_per_cycle=64, initial="periodic")
    drifting = run.copy(deep=True)
    period = lumped.geometry(pair).mesh_period
    drifting["theta_p_dot"] = run["theta_p_dot"] + 0.02 * pair.operating.pinion_speed * run["time"] / (
        3 * period
    )
    assert _flag(validity.validity_flags(pair, run), "speed_drift").state == "ok"
    flag = _flag(validity.validity_flags(pair, drifting), "speed_drift")
    assert flag.state == "violated"
    assert flag.value == pytest.approx(0.02, rel=0.05)  # means over cycles 1 and 4, three periods apart


def test_friction_in_boundary_lubrication_is_flagged(pair):
    rough = pair.with_({"friction.composite_roughness": 2.0})
    assert validity.film_regime(rough).state == "warning"
    assert validity.film_regime(rough.with_({"friction.law": "composite"})).state == "ok"


def test_an_undamped_tongue_is_unstable(pair):
    # 2 omega_3/2 lies near 18000 rpm; the exact speed does not matter for a pair without any damping there.
    free = pair.with_(
        {
            "mesh.damping_ratio": 0.0,
            "operating.pinion_speed": 18000.0,
            **{f"bearings.{g}.{d}_damping_ratio": 0.0 for g in ("pinion", "gear") for d in ("loa", "oloa")},
        }
    )
    assert validity.stability(gear_pair_multipliers(free)).state == "violated"
    assert validity.stability(gear_pair_multipliers(pair)).state == "ok"


def test_the_worst_state_wins(pair):
    calm = validity.contact_ratio(lumped.geometry(pair))
    warned = validity.film_regime(pair.with_({"friction.composite_roughness": 2.0}))
    assert worst_state([]) == "ok"
    assert worst_state([calm, warned, calm]) == "warning"


def test_a_stiffness_model_outside_its_fit_is_said():
    # 340 teeth: half a tooth on the root circle spans 0.009 rad, fitted from 0.01 rad (Sainsot et al. 2004).
    wide = lumped.load_gear_pair("nasa_28_28").with_(
        mesh__contact="prescribed", gear__teeth=340, centre_distance=None, mesh__stiffness={"model": "energy"}
    )
    flag = validity.stiffness_ranges(wide)
    assert (flag.state, flag.value) == ("warning", 1.0)
    assert "fillet foundation of the gear" in flag.detail
    assert flag.action
    # A constant given by the user stands on no fit.
    own = wide.with_(mesh__stiffness={"model": "rectangular", "pair_stiffness": 3e8})
    flag = validity.stiffness_ranges(own)
    assert (flag.state, flag.value, flag.action) == ("ok", 0.0, "")


def test_state_over_speed_is_the_worse_of_contact_and_sliding():
    lowest, reversal = np.array([0.5, 0.5, 0.5, -0.1, np.nan]), np.array([0.0, 0.03, 0.06, 0.0, 0.0])
    assert validity_state(lowest, reversal).tolist() == [0, 1, 2, 2, 3]
