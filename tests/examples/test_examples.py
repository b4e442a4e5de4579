"""Does every example run, draw labelled axes, and show the fact it is there for?"""

import json
import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import floquet
import spurcheck
from floquet.gear.response import ResponseBranches
from validation.studies import load_study, read_results, run_sweep

#: Examples of facts that tests of the packages hold.
SHORT = (1, 2, 4, 5, 7, 8, 9, 10, 12, 14, 18, 21, 22)


@pytest.mark.parametrize("number", SHORT)
def test_it_computes_and_draws(shown, number):
    shown(number)


def test_03_the_largest_resonance_is_that_of_the_averaged_pair(shown):
    _, result = shown(3)
    speed = result["speed"].to_numpy()
    peak = speed[int(result["dte_peak_to_peak"].argmax("speed"))]
    # A stiffness that varies by 50 % bends the peak away from the averaged mode by a few per cent.
    assert peak == pytest.approx(result.attrs["resonant_speeds"][-1], rel=0.05)


def test_06_the_separating_pair_has_two_motions_and_the_linear_one(example, labelled, monkeypatch):
    module = example(6)
    # Long runs, which the picture has no use for; tests/floquet/gear/test_orbits.py judges them.
    monkeypatch.setattr(ResponseBranches, "jumps", ())
    result = module.compute(speeds=[2460.0, 2540.0])
    labelled(module.draw(result))
    # Just below the jump of the rising sweep. How far down the large motion is kept hangs on rounding.
    at = result.sel(speed=2460.0)
    assert float(at["separated"]) == 0.0
    # In contact all the time the models differ by finite motions only, of the order of 1 %.
    assert float(at["rising"]) == pytest.approx(float(at["linear"]), rel=0.02)
    assert float(at["falling"]) > 2.0 * float(at["rising"])


def test_11_models_differ_by_the_square_of_the_torque(shown):
    _, result = shown(11)
    # Finite motions enter as deflection times force; contact loss, which does not, is switched off.
    for name in ("dte", "x_p", "y_p"):
        assert result.attrs[name] == pytest.approx(2.0, abs=0.05)


def test_13_half_a_period_each_needs_no_damping(shown):
    _, result = shown(13)
    quiet = result.attrs["quiet_contact_ratio"]
    # Both half periods return the mode, so there is no tongue. Exact for one mode; the mode's shapes at one
    # and at two tooth pairs differ only by how much the bearings move.
    assert float(result["critical_damping"].sel(contact_ratio=quiet)) < 1e-3
    # One degree of freedom on rigid bearings: twice the stiffness, so 1 + 1/(1 + sqrt 2).
    assert quiet == pytest.approx(1.0 + 1.0 / (1.0 + np.sqrt(2.0)), rel=0.01)
    assert float(result["critical_damping"].max()) > 0.02


def test_15_a_wrong_friction_coefficient_is_seen_in_the_friction_force(example, labelled):
    module = example(15)
    result = module.compute(budget=1.0)  # tests/validation/check judges explanations
    labelled(module.draw(result))
    rows = {row.channel.channel.quantity: row.total for row in result.nearer.channels}
    # mu enters the friction force by its factor, 2, and the normal load hardly.
    assert rows["friction_force"] > 10.0 * rows["normal_load"]
    assert not result.agrees


def test_16_the_cluster_gives_the_file_of_one_process(example, labelled, tmp_path):
    module = example(16)
    result = module.compute()
    labelled(module.draw(result))
    run_sweep(load_study(module.STUDY), tmp_path / "alone", workers=0)
    xr.testing.assert_identical(result, read_results(tmp_path / "alone").load())


def test_19_only_torques_far_from_that_of_the_relief_jump(example):
    module = example(19)
    result = module.compute([25.0, 70.0, 136.0])
    module.draw(result)
    assert set(result["jump_torque"].to_numpy()) == {25.0, 136.0}
    assert result["contact_kept"].all("speed_rpm").values.tolist() == [False, True, False]
    # Above the relief's torque the large motion, with contact loss, ends more than ten times the small one.
    falling = result.sel(jump=(result["jump_torque"] == 136.0) & ~result["jump_rising"])
    assert float((falling["jump_dte_rms"] / falling["jump_dte_rms_after"]).min()) > 10.0


def test_20_one_motion_is_chaotic_beside_a_periodic_one(shown):
    module, result = shown(20)
    assert result.attrs["kind"] == "chaos"
    # Growth of the distance of two runs over 6000 cycles, without derivatives: 0.138 per cycle.
    # Four times the standard error, 0.007 over 2000 cycles; which motion it is hangs on rounding.
    assert result.attrs["exponent"] == pytest.approx(0.138, abs=0.028)
    starts = result.isel(cycle=slice(None, None, module.SAMPLES))
    assert float(starts["periodic_dte"].std()) < 1e-12
    assert float(starts["chaotic_dte"].std()) > 1e-6
    assert float(result["periodic_load"].min()) > 0.0
    assert 0.2 < float((result["chaotic_load"] == 0.0).mean()) < 0.8


def test_23_a_shaft_of_two_stiffnesses_grows_between_its_critical_speeds(shown):
    module, result = shown(23)
    low, high = module.CRITICAL
    between = (low < result["speed"]) & (result["speed"] < high)
    # Without damping the shaft whirls on: neutral, proven.
    np.testing.assert_array_equal(result["verdict"].sel(ratio=0.0), np.where(between, -1, 2))
    assert (result["verdict"].sel(ratio=0.06) == 1).all()
    undamped = result["growth"].sel(ratio=0.0)
    np.testing.assert_allclose(undamped, result["exact"], atol=1e-5 * float(undamped.max()))


def test_24_two_blades_are_the_published_propeller_on_the_mean_and_exact_on_an_equal_mount(example):
    module = example(24)
    result = module.compute()
    assert "[" in module.draw(result).axes[0].get_xlabel()
    # Turning with the blades an equal mount makes the equations constant: multipliers exp(s T).
    system = module.two_blades({"pitch": 0.3, "yaw": 0.3})
    found = floquet.monodromy(system)
    s = np.linalg.eigvals(system.evaluate([0.0])[0])
    expected = np.exp(s * system.period)
    for z, error in zip(found.multipliers, found.multiplier_errors, strict=True):
        assert np.abs(expected - z).min() <= error + 1e-12
    # Pitch and yaw may change places: the mount is turned by a quarter.
    np.testing.assert_allclose(result["spectral_radius"], result["spectral_radius"].T, rtol=1e-8)
    # Two pairs of blades at right angles, each with half the area, are the published equations.
    Q = np.array([[0.0, -1.0], [1.0, 0.0]])
    T, P = system.coordinates, np.diag([module.NACELLE, module.NACELLE + module.BLADES])
    A = system.evaluate([0.0])[0]
    stiffness, damping = (-P @ T @ A[2:, part] @ np.linalg.inv(T) for part in (slice(2), slice(2, 4)))
    half = module.OMEGA * Q
    damping = damping - 2.0 * module.NACELLE * half
    stiffness = (
        stiffness
        - damping @ half
        - module.OMEGA**2 * np.diag([-module.NACELLE, module.BLADES - module.NACELLE])
    )
    K, C = (0.5 * (B + Q @ B @ Q.T) for B in (stiffness, damping))
    inertia = module.NACELLE + 0.5 * module.BLADES
    A = np.vstack([np.eye(2, 4, 2), -np.hstack([K, C - module.BLADES * half]) / inertia])
    assert np.linalg.eigvals(A).real.max() == pytest.approx(
        module.growth_with_many_blades(0.3, 0.3), rel=1e-9
    )


def test_25_the_mesh_drives_the_bending_shafts_at_twice_their_frequency(shown):
    module, result = shown(25)
    assert result.attrs["certificate"] == "proven"
    unstable = result["speed_rpm"].where(result["verdict"] == -1, drop=True)
    # Ninth mode of ross.MultiRotor (2.3.0) of both shafts without damping, with the mean mesh stiffness.
    system = module.on_shafts(19000.0)
    mode = 4544.12869547
    x, weights = np.polynomial.legendre.leggauss(8)
    start = system.edges[:-1, None]
    width = np.diff(system.edges)[:, None]
    A = system.evaluate((start + 0.5 * width * (x + 1.0)).ravel())
    mean = np.tensordot((0.5 * width * weights).ravel() / system.period, A, axes=1)
    frequencies = np.sqrt(np.sort(np.linalg.eigvals(-mean[9:, :9]).real)) / (2.0 * np.pi)
    assert frequencies[8] == pytest.approx(mode, rel=1e-7)
    # 28 teeth; the step is 375 rpm.
    assert float(unstable.mean()) == pytest.approx(2.0 * mode * 60.0 / 28.0, abs=190.0)
    assert unstable.size == 3


def test_26_springs_miss_what_the_modes_of_the_shafts_do(example, labelled):
    module = example(26)
    module.SPEEDS = np.array([2750.0, 4875.0])
    result = module.compute()
    labelled(module.draw(result))
    # The mode of the mesh on stiff shafts meets the mesh frequency at 4880 rpm.
    dte = result["dte"].sel(set="stiff")
    assert float(dte.sel(model="shafts", speed=4875.0)) > 3.0 * float(dte.sel(model="shafts", speed=2750.0))
    # What the machine has beside it is finite motions and exact contact, 2 % at 2750 rpm.
    assert float(dte.sel(model="machine", speed=2750.0)) == pytest.approx(
        float(dte.sel(model="shafts", speed=2750.0)), rel=0.1
    )
    # Springs that are right at rest have no mode of the shafts: at 2750 rpm they show less than half of it.
    assert float(dte.sel(model="condensed", speed=2750.0)) < 0.5 * float(
        dte.sel(model="shafts", speed=2750.0)
    )


ROOT = Path(__file__).parents[2]


def tutorial():
    text = (ROOT / "docs" / "tutorial" / "in_python.md").read_text(encoding="utf-8")
    return [code.strip() for code in re.findall(r"```python\n(.*?)```", text, re.DOTALL)]


def notebook():
    cells = json.loads((ROOT / "examples" / "first_session.ipynb").read_text(encoding="utf-8"))["cells"]
    return ["".join(cell["source"]).strip() for cell in cells if cell["cell_type"] == "code"]


def test_the_notebook_is_the_tutorial():
    """And so runs as the page does, see tests/docs/test_commands.py."""
    assert notebook() == tutorial()


def test_27_class_6_hides_a_crack(shown):
    module, result = shown(27)
    size = module.rms(result)
    assert size["crack"] < 0.2 * size["class 6"]
    assert size["class 6 and crack"] == pytest.approx(size["class 6"], rel=0.02)
    # Alone it is an event of one tooth: far from the 3 of noise.
    alone = result["signal"].sel(case="crack").to_numpy()
    assert np.mean(alone**4) / np.mean(alone**2) ** 2 > 50.0


def test_28_each_fault_has_its_own_orders(shown):
    _, result = shown(28)
    amplitude = result["amplitude"].assign_coords(order=np.round(result["order"]).astype(int))
    eccentric = amplitude.sel(fault="eccentric 20 µm")
    assert float(eccentric.sel(order=1)) == pytest.approx(20e-6, rel=1e-3)
    second, first, mesh = (float(eccentric.sel(order=order)) for order in (26, 27, 28))
    assert float(eccentric.sel(order=range(3, 26)).max()) < 1e-2 * first
    # A phase that turns once with the shaft: sidebands J_1 and J_2 of its index.
    assert second == pytest.approx(first**2 / (2.0 * mesh), rel=0.2)
    for fault, ratio in (("crack 1 mm", (0.0, 0.5)), ("spall", (0.8, 1.2)), ("chip", (0.8, 1.2))):
        one = amplitude.sel(fault=fault)
        low, high = ratio
        assert low < float(one.sel(order=27) / one.sel(order=1)) < high, fault


def test_29_the_bearing_hears_the_mesh_order_at_its_resonance(shown):
    module, result = shown(29)
    orders = result["amplitude"].sel(order=range(1, 6), method="nearest")
    loudest = orders.isel(orders.argmax(...))
    hertz = float(loudest["order"] * loudest["speed_rpm"]) * 28 / 60
    # A mesh stiffness that varies moves the peak from the averaged pair's frequency by some per cent.
    assert np.abs(spurcheck.natural_frequencies(module.PAIR) / hertz - 1.0).min() < 0.06
