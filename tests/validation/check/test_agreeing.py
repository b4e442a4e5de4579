"""Curves that agree: is what the comparison leaves out told apart from a sound model?"""

import warnings

import numpy as np
import pytest

import lumped
from lumped.schema.bodies import bodies_of
from tests.validation.check.motions import lumped_motion
from tests.validation.check.sampled_motions import COULOMB
from validation.check import check
from validation.check.ladder_data import ladder_data
from validation.plots.check import ladder_figure


@pytest.mark.parametrize("single", [True, False])
def test_angles_in_single_precision(single):
    """dte = r_p theta_p - r_g theta_g + x_p - x_g of angles with the rotation of two seconds in them."""
    pair = lumped.load_gear_pair("high_contact_ratio_29_47").with_(COULOMB)
    g = pair.geometry
    motion = lumped_motion(pair)
    place = 0.3 + np.arange(6 * 211) / 211
    time = place * g.mesh_period
    angles = {
        "p": motion.at("theta_p", place) + g.omega_pinion * (2.0 + time),
        "g": motion.at("theta_g", place) + g.omega_gear * (2.0 + time),
    }
    if single:
        angles = {end: angle.astype(np.float32).astype(float) for end, angle in angles.items()}
    dte = g.base_radius_pinion * angles["p"] - g.base_radius_gear * angles["g"]
    dte += motion.at("x_p", place) - motion.at("x_g", place)
    result = check(pair, {"time": time, "dte": dte, "x_p": motion.at("x_p", place)})
    assert result.agrees
    assert [step.name for step in result.explanations] == (["few digits"] if single else [])
    if single:
        assert result.explanations[0].factor == "dte"
        assert "single precision" in result.words


@pytest.fixture(scope="module")
def pair():
    """A pair with friction, prescribed contact."""
    return lumped.load_gear_pair("high_contact_ratio_29_47").with_(COULOMB)


def explained(pair, curves):
    """Names of the explanations of curves that agree."""
    result = check(pair, curves)
    assert result.agrees, result.words
    return [step.name for step in result.explanations], result


def records(pair, cycles=16, per_cycle=211):
    """Times, mesh cycles, and the sound curves of a pair."""
    motion = lumped_motion(pair)
    place = 0.3 + np.arange(cycles * per_cycle) / per_cycle
    time = place * pair.geometry.mesh_period
    names = ("theta_p", "theta_g", "x_p", "mesh_force")
    return time, place - place[0], {name: motion.at(name, place) for name in names}


def test_a_brake_torque_without_the_loss_of_friction(pair):
    """Both gears slow down by the loss over the inertia of both at the gear: a parabola of the rotations."""
    time, _, values = records(pair)
    assert explained(pair, {"time": time, **values})[0] == []
    held = float(lumped_motion(pair).motion.attrs["brake_torque"])
    ratio = pair.gear.teeth / pair.pinion.teeth
    without = pair.operating.pinion_torque * ratio
    bodies = bodies_of(pair)
    slowing = (held - without) / (bodies.inertia_gear + bodies.inertia_pinion * ratio**2)
    drifting = values | {
        "theta_p": values["theta_p"] + 0.5 * ratio * slowing * time**2,
        "theta_g": values["theta_g"] + 0.5 * slowing * time**2,
    }
    names, result = explained(pair, {"time": time, **drifting})
    assert names == ["brake torque"]
    assert result.explanations[0].factor == pytest.approx(without, rel=1e-3)
    assert "loss of friction is forgotten" in result.words


def test_a_transient_before_the_compared_half(pair):
    """A vibration at 2.37 mesh orders that falls to 0.02 % after half of the curves."""
    time, cycles, values = records(pair)
    wave = np.exp(-cycles) * np.cos(2.0 * np.pi * 2.37 * cycles)
    curves = {"time": time, **{name: v + 0.5 * np.ptp(v) * wave for name, v in values.items()}}
    names, result = explained(pair, curves)
    assert names == ["not settled"]
    assert result.explanations[0].factor == "at the start"


@pytest.mark.parametrize(("decay", "name"), [(0.0, "errors of the integration"), (0.12, "not settled")])
def test_a_motion_at_no_mesh_order(pair, decay, name):
    """A vibration at 5.37 orders that stays is an error of an integration; one that decays is a transient."""
    time, cycles, values = records(pair)
    wave = 0.2 * np.exp(-decay * (cycles - 8.0)) * np.cos(2.0 * np.pi * 5.37 * cycles)
    curves = {"time": time, **values, "x_p": values["x_p"] + np.ptp(values["x_p"]) * wave}
    assert explained(pair, curves)[0] == [name]


def test_displacements_in_coarse_steps(pair):
    """Values in steps of a fifth of their peak to peak differ at the orders; our motion so rounded agrees."""
    time, _, values = records(pair)
    step = 0.2 * np.ptp(values["x_p"])
    curves = {"time": time, "x_p": step * np.round(values["x_p"] / step), "mesh_force": values["mesh_force"]}
    result = check(pair, curves, limit=0.02)
    assert not result.agrees
    assert [step.name for step in result.explanations] == ["few digits"]
    assert result.explanations[0].misfit < 0.3 * result.misfit


def test_means_that_the_export_has_removed(pair):
    """Displacements and forces less their means are no difference, and the page has a picture of it."""
    time, _, values = records(pair, cycles=4)
    centred = {name: v - v.mean() for name, v in values.items() if not name.startswith("theta")}
    names, result = explained(pair, {"time": time, **centred})
    assert names == ["form of the export"]
    assert result.explanations[0].factor == "without means"
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # what lies outside of the axes leaves no room for them
        figure = ladder_figure(ladder_data(result.problem, result.ladder, result.limit))
        figure.canvas.draw()
    assert figure.axes[0].get_xlim()[1] >= 100.0 * result.limit


def test_whole_angles_are_no_mistake(pair):
    time, _, values = records(pair, cycles=4)
    g = pair.geometry
    turned = values | {
        "theta_p": values["theta_p"] + g.omega_pinion * time,
        "theta_g": values["theta_g"] + g.omega_gear * time,
    }
    names, result = explained(pair, {"time": time, **turned})
    assert names == []
    assert any("without their uniform rotation" in remark for remark in result.remarks)
