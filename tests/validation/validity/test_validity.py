"""Do the validity flags notice what breaks the model, and say where?"""

import numpy as np
import pytest
from typer.testing import CliRunner

import lumped
from floquet.gear.multipliers import gear_pair_multipliers
from lumped import load_gear_pair, preset_names
from validation.cli import app
from validation.commands.options import gear_pair
from validation.validity import flags as validity
from validation.validity.flags import validity_state
from validation.validity.plausibility import parameter_warnings


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


def test_state_over_speed_is_the_worse_of_contact_and_sliding():
    lowest = np.array([0.5, 0.5, 0.5, -0.1, np.nan])
    reversal = np.array([0.0, 0.03, 0.06, 0.0, 0.0])
    assert validity_state(lowest, reversal).tolist() == [0, 1, 2, 2, 3]


@pytest.mark.parametrize("name", preset_names())
@pytest.mark.parametrize("speed", [0.2, 1.0, 2.0])
def test_a_sensible_pair_raises_no_doubt(name, speed):
    pair = load_gear_pair(name)
    rpm = speed * pair.operating.pinion_speed.to("rpm")
    assert parameter_warnings(pair.with_(operating__pinion_speed=rpm)) == ()


@pytest.mark.parametrize(("changes", "words"), [
    ({"bearings.gear.loa_stiffness": 300}, "Given in N/um? Then write '300 N/um'."),
    ({"operating.pinion_torque": 4875, "operating.pinion_speed": 56.5}, "Speed and torque swapped?"),
    ({"operating.pinion_speed": 1.45}, "Then write 1450."),
    ({"operating.pinion_speed": 24}, "Then write '24 Hz'."),
    ({"operating.pinion_speed": "1450 Hz"}, "Is 1450 the speed in rpm?"),
    ({"pinion.roughness": "0.4 pm"}, "pinion.roughness = 4e-07 um is that of no flank"),
    ({"gear.tip_relief": {"amount": 0.02, "start_roll_angle": 24.0}}, "Then write '0.02 mm'."),
])  # fmt: skip
def test_a_value_that_hardly_can_be_meant_is_named_with_its_cause(nasa_pair, changes, words):
    warnings = parameter_warnings(nasa_pair.with_(changes))
    assert any(words in one for one in warnings), warnings


def test_no_backlash_but_for_rounding_is_not_doubted():
    """The centre distance of standard gears is the mean of their pitch circles: 0.5 (17 + 53) / 2 mm."""
    small_pair = {
        "basic_rack.module": 0.5,
        "pinion.teeth": 17,
        "gear.teeth": 53,
        "operating.pinion_torque": 0.15,
    }
    small_pair |= {
        f"{gear}.{key}": None for gear in ("pinion", "gear") for key in ("tip_relief", "mass", "inertia")
    }
    small_pair |= {"description": "", "mesh.backlash": 0, "operating.speed_range": None}
    for centre_distance in (None, 17.5):
        pair = load_gear_pair("nasa_28_28").with_(small_pair | {"centre_distance": centre_distance})
        assert not any("backlash" in one for one in parameter_warnings(pair))


@pytest.fixture(scope="module")
def nasa_pair():
    return load_gear_pair("nasa_28_28")


def test_commands_say_it_and_go_on():
    result = CliRunner().invoke(
        app, ["simulate", "--law", "none", "--set", "friction.composite_roughness=0.8", "--cycles", "2"]
    )
    assert result.exit_code == 0
    assert "note: no gear pair is named, so this is the example nasa_28_28" in result.stderr
    changed = "note: --set friction.composite_roughness = 0.8 changes nothing in the motion: the law is none."
    assert changed in result.stderr
    assert "note: friction.composite_roughness = 0.8 um is used for the film" in result.stderr


@pytest.mark.parametrize(("changes", "unread"), [
    ({"friction.law": "xu_kahraman", "friction.coefficient": "0.1"}, "friction.coefficient"),
    ({"friction.law": "none", "viscosity": "8"}, "viscosity"),
    ({"friction.law": "benedict_kelley", "lubricant.viscosity": "8"}, None),
    ({"friction.law": "none", "mesh.relief": "static", "pinion.tip_relief.amount": "12"}, None),
    ({"mesh.relief": "ignored", "pinion.tip_relief.amount": "12"}, "pinion.tip_relief.amount"),
])  # fmt: skip
def test_a_value_that_no_law_of_the_pair_reads_is_named(changes, unread, capsys):
    gear_pair("nasa_28_28", settings=[f"{path}={value}" for path, value in changes.items()])
    notes = capsys.readouterr().err
    assert ("changes nothing" in notes) == (unread is not None)
    assert unread is None or f"--set {unread} = " in notes
