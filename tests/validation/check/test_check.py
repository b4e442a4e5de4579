"""Does a check say agrees where models are alike, and name the first rung that fails where they are not?"""

import numpy as np
import pytest

import spurcheck
from lumped.errors import ParameterError
from tests.unlike_pairs import unlike_pair
from tests.validation.check.curves_of_motions import sampled
from tests.validation.check.motions import lumped_motion, multibody_motion
from validation.check import Verdict, check
from validation.check.check import Rung
from validation.check.curves import Channel, Curves
from validation.check.overlay import figure_data

SEVERAL = ("dte", "x_p", "y_g", "bearing_force_y_p")
NAMES = (
    "rack_25_degrees_always_pushing",
    "larger_gear_drives_contact_lost",
    "heavily_relieved_under_load",
    "contact_ratio_2_3_on_shafts",
)


@pytest.fixture(scope="module", params=NAMES)
def pair(request):
    return unlike_pair(request.param)


def test_the_same_motion_agrees_in_any_subset_and_order(pair):
    for quantities in (SEVERAL, SEVERAL[::-1], ("dte",), ("bearing_force_y_p", "x_p")):
        result = check(pair, sampled(pair, quantities))
        assert result.verdict is Verdict.AGREES, result.words
        assert result.failed is None
        assert result.ladder is None
        assert "agrees" in result.words


def test_noise_of_one_percent_changes_no_verdict(pair):
    for seed in range(3):
        assert check(pair, sampled(pair, SEVERAL, noise=0.01, cycles=8, seed=seed)).agrees
    wrong = pair.with_(torque=1.3 * pair.operating.pinion_torque)
    assert not check(pair, sampled(wrong, SEVERAL, noise=0.01, cycles=8), explain=False).agrees


def test_the_right_size_of_the_wrong_motion_differs(pair):
    def third(name, values, time):
        wave = np.sin(6.0 * np.pi * time / pair.geometry.mesh_period)
        return values.mean() + 0.5 * np.ptp(values) * wave

    result = check(pair, sampled(pair, ("dte",), change=third), explain=False)
    assert result.verdict is Verdict.DIFFERS
    rows = result.channels.sel(channel="dte")
    sizes = float(rows["their_peak_to_peak"]) / float(rows["our_peak_to_peak"])
    assert sizes == pytest.approx(1.0, abs=0.05)
    assert float(rows["misfit"]) > 0.5


def test_the_static_rung_comes_first(pair):
    curves = sampled(pair.with_(torque=1.3 * pair.operating.pinion_torque), SEVERAL)
    with_radius = {
        "time": curves.places,
        "base_radius_pinion": 1.05 * pair.geometry.base_radius_pinion,
        **{channel.name: channel.values for channel in curves.channels},
    }
    result = check(pair, with_radius, explain=False)
    assert result.failed is Rung.STATIC
    assert "base radius of the pinion" in result.words
    right = with_radius | {"base_radius_pinion": pair.geometry.base_radius_pinion}
    assert check(pair, right, explain=False).failed is Rung.MOTION


def test_static_quantities_alone_are_enough(pair):
    result = check(pair, {"contact_ratio": pair.geometry.contact_ratio})
    assert result.agrees
    assert np.isnan(result.misfit)
    with pytest.raises(ParameterError, match="static"):
        result.plot()


def test_curves_of_the_multibody_model_agree(pair):
    ours = lumped_motion(pair)
    second = multibody_motion(pair, ours)
    if second is None:
        assert pair.shafts is not None
        return
    cycles = np.arange(4 * 256) / 256
    channels = tuple(Channel(name, name, second.at(name, cycles)) for name in SEVERAL)
    curves = Curves("theirs", "time", cycles * pair.geometry.mesh_period, channels)
    result = check(pair, curves, explain=False)
    assert result.verdict is Verdict.AGREES
    assert result.second.value < 0.005
    # The lumped model alone would not always say so: friction acts on the path of contact there.
    assert result.problem.misfit.value == pytest.approx(result.discrepancy, rel=0.1, abs=0.002)


def test_between_both_programs_nothing_can_be_said():
    pair = unlike_pair("rack_25_degrees_always_pushing")
    ours = lumped_motion(pair)
    second = multibody_motion(pair, ours)
    cycles = np.arange(4 * 256) / 256
    mean = {name: 0.5 * (ours.at(name, cycles) + second.at(name, cycles)) for name in SEVERAL}
    result = check(pair, mean | {"time": cycles * pair.geometry.mesh_period}, explain=False)
    assert result.discrepancy > result.misfit > result.limit
    assert result.verdict is Verdict.NOT_COMPARABLE
    assert "both programs" in result.words


def test_a_model_that_can_be_called_is_checked_at_low_speed_and_with_half_the_step():
    pair = unlike_pair("heavily_relieved_under_load")
    called = []

    def model(parameters, refine=1):
        called.append((parameters["si"]["pinion_speed"], refine))
        speed = f"{parameters['si']['pinion_speed']!r} rad/s"
        stiffer = pair.with_({"mesh.stiffness_factor": 1.3, "operating.pinion_speed": speed})
        curves = sampled(stiffer, ("dte",))
        # A step that is too long, and half of it.
        error = 1.0 + (0.08 if refine == 1 else 0.02) * np.sin(7.0 * curves.places / curves.places[-1])
        return {"time": curves.places, "dte": curves.channels[0].values * error}

    result = check(pair, model, explain=False)
    assert result.failed is Rung.LOW_SPEED
    assert "transmission error differs" in result.words
    speeds = {speed for speed, _ in called}
    assert min(speeds) < 0.5 * pair.operating.pinion_speed
    assert {refine for _, refine in called} == {1, 2}
    assert any("step is too long" in remark for remark in result.remarks)


def test_times_in_milliseconds_differ_although_the_motion_agrees(pair):
    curves = sampled(pair, SEVERAL, cycles=20)
    named = {channel.name: channel.values for channel in curves.channels}
    result = check(pair, {"time": 1e3 * curves.places, **named}, explain=False)
    assert result.misfit < 0.01
    assert result.verdict is Verdict.DIFFERS


@pytest.mark.parametrize(("arguments", "field"), [
    ({"limit": 0.0}, "limit"), ({"limit": 2.0}, "limit"), ({"budget": -1.0}, "budget"),
    ({"phase": np.nan}, "phase"), ({"supports": "walls"}, "supports"),
])  # fmt: skip
def test_arguments_are_refused_before_work(arguments, field):
    curves = sampled(unlike_pair(NAMES[0]), ("dte",))
    with pytest.raises(ParameterError) as refusal:
        spurcheck.check(unlike_pair(NAMES[0]), curves, **arguments)
    assert refusal.value.problems[0].field == field


def test_one_channel_that_differs_is_explained_although_the_whole_agrees():
    pair = unlike_pair(NAMES[0])

    def change(name, values, time):
        mean = values.mean()
        return mean + 1.08 * (values - mean) if name == "y_g" else values

    curves = sampled(pair, SEVERAL, change=change)
    result = check(pair, curves, budget=2.0)
    rows = {row.channel.channel.name: row.total for row in result.nearer.channels}
    assert result.agrees, result.words
    assert rows["y_g"] > result.limit > result.misfit
    assert result.ladder is not None


def test_a_known_phase_is_used():
    pair = unlike_pair(NAMES[0])
    curves = sampled(pair, SEVERAL, phase=0.37)
    assert check(pair, curves, phase=0.37).agrees
    assert not check(pair, curves, phase=0.5, explain=False).agrees


def test_a_rotation_whose_torques_do_not_balance_drifts():
    pair = unlike_pair(NAMES[0])

    def drifting(name, values, time):
        return values + 3.0 * np.ptp(values) * (time / time[-1]) ** 2 if name == "theta_p" else values

    curves = sampled(pair, ("dte", "theta_p"), cycles=12, change=drifting)
    result = check(pair, curves)
    assert result.agrees, result.words
    (remark,) = result.remarks
    brake = float(result.problem.motion.motion.attrs["brake_torque"])
    assert "theta_p" in remark
    assert f"{brake:.5g} N m" in remark
    drawn = figure_data(result.problem).sel(channel="theta_p")
    assert np.ptp(drawn["theirs"].to_numpy()) == pytest.approx(np.ptp(drawn["ours"].to_numpy()), rel=0.1)
    assert np.nanmax(drawn["scatter"].to_numpy()) < 0.1 * np.ptp(drawn["ours"].to_numpy())
    assert not check(pair, sampled(pair, ("dte", "theta_p"), cycles=12)).remarks


def test_a_function_that_does_not_read_the_speed_has_no_rung_at_low_speed():
    pair = unlike_pair(NAMES[0])
    curves = sampled(pair, ("dte",))
    named = {"time": curves.places, "dte": curves.channels[0].values}
    result = check(pair, lambda parameters: named)
    assert result.low_speed is None
    assert result.agrees


def test_a_motion_that_has_not_settled_is_said(pair):
    def fading(name, values, time):
        period = pair.geometry.mesh_period
        wave = np.cos(12.3 * time / period)
        return values + 0.5 * np.ptp(values) * np.exp(-time / (4.0 * period)) * wave

    fades = check(pair, sampled(pair, ("dte", "x_p"), cycles=8, change=fading), explain=False)
    assert any(remark.startswith("The motion has not settled") for remark in fades.remarks)
    settled = check(pair, sampled(pair, ("dte", "x_p"), cycles=8), explain=False)
    assert not any(word in remark for remark in settled.remarks for word in ("settled", "transient"))


def test_a_transient_at_the_beginning_is_said_and_not_compared(pair):
    def begins(name, values, time):
        period = pair.geometry.mesh_period
        return values + 0.5 * np.ptp(values) * np.exp(-3.0 * time / period) * np.cos(12.3 * time / period)

    result = check(pair, sampled(pair, ("dte", "x_p"), cycles=8, change=begins), explain=False)
    assert result.agrees
    said = [remark for remark in result.remarks if remark.startswith("The curves begin with a transient")]
    assert len(said) == 1
    assert said[0].endswith(
        f"the last {4 * result.problem.motion.mesh_cycles} of "
        f"{8 * result.problem.motion.mesh_cycles} mesh cycles."
    )


@pytest.mark.parametrize("cycles", [1, 5])
def test_whole_angles_are_said(pair, cycles):
    def turning(name, values, time):
        speed = {"theta_p": 1.0, "theta_g": -pair.pinion.teeth / pair.gear.teeth}
        return values + speed.get(name, 0.0) * pair.geometry.omega_pinion * time

    names = ("dte", "theta_p", "theta_g")
    result = check(pair, sampled(pair, names, cycles=cycles, change=turning), explain=False)
    assert "Whole angles, compared without their uniform rotation: theta_p, theta_g." in result.remarks
    result = check(pair, sampled(pair, names, cycles=cycles), explain=False)
    assert not any(remark.startswith("Whole angles") for remark in result.remarks)
