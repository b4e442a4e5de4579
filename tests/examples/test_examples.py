"""Does every example run, draw labelled axes, and show the fact it is there for?"""

import functools
import json
import re
from pathlib import Path

import distributed
import numpy as np
import pytest
import xarray as xr
from scipy.special import mathieu_a, mathieu_b

import floquet
import lumped
from floquet.gear.response import ResponseBranches
from validation.studies import load_study, read_results, run_sweep


def test_01_friction_laws_differ_where_theory_says(shown):
    _, result = shown(1)
    near = np.abs(result["xi"] - result.attrs["pitch_point"]) < 5e-5
    # Law III vanishes with the slide-to-roll ratio (its power b3 = 1.036), law II rises to its bound.
    assert float(np.abs(result["xu_kahraman"]).where(near).max()) < 1e-3
    rising = np.abs(result["benedict_kelley"])
    assert float(rising.where(near).max()) == float(rising.max())


def test_02_film_parameter_is_4_near_2500_rpm(shown):
    _, result = shown(2)
    mean = result["film_parameter"].mean("xi")
    switch = float(np.interp(4.0, mean, result["speed"]))
    # The paper's Fig. 2b puts the abrupt change "near 2500 rpm"; read off to about 5 %.
    assert switch == pytest.approx(2500.0, rel=0.05)


def test_03_the_largest_resonance_is_that_of_the_averaged_pair(shown):
    _, result = shown(3)
    speed = result["speed"].to_numpy()
    peak = speed[int(result["dte_peak_to_peak"].argmax("speed"))]
    # A stiffness that varies by 50 % bends the peak away from the averaged mode by a few per cent.
    assert peak == pytest.approx(result.attrs["resonant_speeds"][-1], rel=0.05)


def test_04_the_printed_sign_speeds_the_pair_up(shown):
    module, result = shown(4)
    pair = lumped.load_gear_pair("nasa_28_28").with_(friction__law="coulomb", friction__coefficient=0.05)
    steady, body = lumped.steady_state(pair), lumped.bodies(pair)
    moment = float((steady["position"] * steady["friction_force"]).sum("pair").mean())
    expected = 2.0 * moment / (body.inertia_pinion + body.inertia_gear)
    assert abs(module.drift(result["repaired"])) < 1e-6 * expected
    # First order in the friction coefficient: the forces themselves change by some 7 %.
    assert module.drift(result["printed"]) == pytest.approx(expected, rel=0.1)


def test_05_the_best_relief_is_best_near_its_design_torque(shown):
    _, result = shown(5)
    best = float(result["torque"][int(result["relieved"].argmin("torque"))])
    assert best == pytest.approx(result.attrs["design_torque"], rel=0.05)
    # The contact's compliance falls with the logarithm of the load, so the error grows less than the torque.
    assert (np.diff(result["involute"] / result["torque"]) < 0.0).all()


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
    # The branch of the small motion is the same model as the sweep, but for finite motions.
    speed, rms, stable = (result[name].to_numpy() for name in ("speed_rpm", "dte_rms", "stable"))
    small = np.flatnonzero(stable & (rms < 0.5 * float(at["falling"])))
    small = small[np.argsort(speed[small])]
    followed = np.interp(2460.0, speed[small], rms[small])
    assert followed == pytest.approx(float(at["rising"]), rel=0.05)


def test_07_energy_stiffness_lies_in_the_scatter_of_the_standard(shown):
    _, result = shown(7)
    # ISO 6336-1 states that its mean mesh stiffness deviates from measurements by +5 % to -8 %.
    assert 0.92 < 1.0 / result.attrs["mean_over_iso"] < 1.05
    # The linearised contact of much literature is some three times too stiff and leaves that scatter.
    assert result.attrs["linearised_over_iso"] > 1.15


def test_08_two_pairs_share_by_halves_in_the_middle_and_deflection_lengthens_the_contact(shown):
    _, result = shown(8)
    # Nearest sampled phase to the middle of double contact, where equal gears are symmetric.
    middle = result.sel(phase=(result.attrs["contact_ratio"] - 1.0) / 2.0, method="nearest")
    touching = middle["load_share"].where(middle["load_share"] > 0.0)
    # Half a step of 1/256 pitch off the middle, where the share turns by about 1 per path of contact.
    np.testing.assert_allclose(touching.sel(torque=56.5).dropna("pair"), 0.5, atol=1.0 / 512)
    # Beyond its ends the path's gap opens with the square of the distance, so the contact grows as the root
    # of the deflection: twice from 28.25 to 113 N m, as far as 1/256 pitch and a softening contact let see.
    longer = result["contact_ratio"] - result.attrs["contact_ratio"]
    assert float(longer.sel(torque=113.0) / longer.sel(torque=28.25)) == pytest.approx(2.0, rel=0.06)


def test_09_relief_shows_without_load_and_vanishes_at_its_torque(shown):
    _, result = shown(9)
    # No load: the pair with less relief touches. At worst, in the middle of double contact, both stand half
    # that length from their tips, with the relief C (1 - (eps - 1) p/2L) left there; 256 positions.
    left = 1.0 - 0.5 * result.attrs["double_contact"] / result.attrs["length"]
    unloaded = float(result["peak_to_peak"].sel(torque=0.0))
    assert unloaded == pytest.approx(result.attrs["amount"] * left, rel=1e-2)
    assert int(result["peak_to_peak"].argmin("torque")) == 3  # the design torque
    assert float(result["peak_to_peak"].min()) < 0.1 * unloaded


def test_10_loss_of_small_friction_is_the_published_loss_factor(shown):
    _, result = shown(10)
    # GEARpie's report of the FZG C14 gears prints H_V (Ohlendorf) = 0.1986; half its last place.
    assert result.attrs["ohlendorf"] == pytest.approx(0.1986, abs=5e-5)
    assert float(result["loss_over_mu"].sel(mu=1e-6)) == pytest.approx(result.attrs["ohlendorf"], rel=1e-5)
    # Vibration moves the loss of these gears, far below resonance, by less than a hundredth.
    quiet, shaken = 1 - result["mesh_efficiency"], 1 - result["mesh_efficiency_dynamic"]
    np.testing.assert_allclose(shaken, quiet, rtol=1e-2)
    thin = quiet.sel(law="xu_kahraman")
    assert bool((quiet.drop_sel(law="xu_kahraman") > 2.0 * thin).all())


def test_11_models_differ_by_the_square_of_the_torque(shown):
    _, result = shown(11)
    # Finite motions enter as deflection times force; contact loss, which does not, is switched off.
    for name in ("dte", "x_p", "y_p"):
        assert result.attrs[name] == pytest.approx(2.0, abs=0.05)


def test_12_tongues_stand_at_the_predicted_speeds(shown):
    _, result = shown(12)
    assert {"2w3/2", "2w3/5", "2w3/4"} <= set(result["label"].values)
    # The line is that of the averaged system; a variation of half the stiffness moves the tongue a little.
    peak = result["peak"].isel(damping_ratio=0)
    assert float(np.abs(peak / result["predicted"] - 1.0).max()) < 0.03
    width = (result["upper"] - result["lower"]).to_numpy()
    # All but the widest are closed by 1 % of damping, as the example says.
    heavy = result["damping_ratio"].to_numpy() > 0.01
    assert set(result["label"].to_numpy()[np.isfinite(width[:, heavy]).any(axis=1)]) == {"2w3/2"}
    # Damping narrows every tongue.
    assert (np.diff(width, axis=1)[np.isfinite(np.diff(width, axis=1))] < 0.0).all()


def test_13_half_a_period_each_needs_no_damping(shown):
    _, result = shown(13)
    quiet = result.attrs["quiet_contact_ratio"]
    # Both half periods return the mode, so there is no tongue. Exact for one mode; the mode's shapes at one
    # and at two tooth pairs differ only by how much the bearings move.
    assert float(result["critical_damping"].sel(contact_ratio=quiet)) < 1e-3
    # One degree of freedom on rigid bearings: twice the stiffness, so 1 + 1/(1 + sqrt 2).
    assert quiet == pytest.approx(1.0 + 1.0 / (1.0 + np.sqrt(2.0)), rel=0.01)
    assert float(result["critical_damping"].max()) > 0.02


def test_14_sensitivities_are_the_slopes_of_a_chart(shown):
    _, result = shown(14)
    pair = lumped.load_gear_pair("nasa_28_28").with_(
        operating__pinion_speed=16000.0, friction__law="coulomb", friction__coefficient=0.05
    )
    order = result["parameter"].to_numpy()[np.argsort(-np.abs(result["relative"].to_numpy()))]
    assert list(order[:2]) == ["speed_rpm", "bearing_stiffness"]
    for name, value, step in (("speed_rpm", 16000.0, 1.0), ("damping_ratio", pair.mesh.damping_ratio, 1e-5)):
        near = [value - step, value + step]
        radius = floquet.stability_chart(pair, {name: near}, rtol=1e-12)["spectral_radius"].to_numpy()
        # Central differences over 6e-5 and 2e-4 of the value: errors of the order of their squares.
        slope = value * np.diff(radius)[0] / (2.0 * step)
        assert float(result["relative"].sel(parameter=name)) == pytest.approx(slope, rel=1e-5)


def test_15_the_true_coefficient_lies_in_its_interval(shown):
    _, result = shown(15)
    (found,) = result.evaluation.found
    # Three standard errors: a right interval misses by this much once in 370 noise seeds; the seed is fixed.
    assert abs(found.estimate - result.truth) < 3.0 * found.standard_error
    assert found.standard_error < 0.01 * result.truth


def test_16_the_cluster_gives_the_file_of_one_process(example, labelled, tmp_path, monkeypatch):
    module = example(16)
    # Workers in this process: tests/validation/studies/test_cluster.py starts processes, and kills them.
    local = functools.partial(distributed.LocalCluster, processes=False)
    monkeypatch.setattr(distributed, "LocalCluster", local)
    result = module.compute()
    labelled(module.draw(result))
    run_sweep(load_study(module.STUDY), tmp_path / "alone", workers=0)
    xr.testing.assert_identical(result, read_results(tmp_path / "alone").load())


def test_18_neighbours_and_a_thin_rim_soften(example):
    module = example(18)
    result = module.compute()
    module.draw(result)
    (solid, alone), (bored, _), (thin, _) = result["mean_over_iso"].values
    assert 0.5 * solid < thin < 0.75 * solid
    assert 0.95 * solid < bored < solid < alone


def test_19_only_torques_far_from_that_of_the_relief_jump(example):
    module = example(19)
    result = module.compute([25.0, 70.0, 136.0])
    module.draw(result)
    assert set(result["jump_torque"].to_numpy()) == {25.0, 136.0}
    assert result["contact_kept"].all("speed_rpm").values.tolist() == [False, True, False]
    # Above the relief's torque the large motion, in which teeth part, ends more than ten times the small one.
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


def test_21_meissners_trace_is_that_of_the_multipliers(shown):
    _, result = shown(21)
    trace = result["multipliers"].sum("multiplier").real
    assert (
        np.abs(trace - result["exact"]) <= 2.0 * result["multiplier_errors"].max("multiplier") + 1e-13
    ).all()
    np.testing.assert_array_equal(result["verdict"] == -1, np.abs(result["exact"]) > 2.0)


def test_22_mathieus_equation_grows_between_the_characteristic_values(example):
    module = example(22)
    result = module.compute()
    assert "[" in module.draw(result).axes[0].get_xlabel()
    a, q = xr.broadcast(result["a"], result["q"])
    stable = [(mathieu_a(m, q) < a) & (a < mathieu_b(m + 1, q)) for m in range(3)]
    np.testing.assert_array_equal(result["verdict"] == 0, np.any(stable, axis=0))
    assert not (result["verdict"] == 1).any()
    assert result["proven"].all()


def test_23_a_shaft_of_two_stiffnesses_grows_between_its_critical_speeds(shown):
    module, result = shown(23)
    low, high = module.CRITICAL
    between = (low < result["speed"]) & (result["speed"] < high)
    np.testing.assert_array_equal(result["verdict"].sel(ratio=0.0), np.where(between, -1, 0))
    assert (result["verdict"].sel(ratio=0.06) == 1).all()
    undamped = result["growth"].sel(ratio=0.0)
    np.testing.assert_allclose(undamped, result["exact"], atol=1e-5 * float(undamped.max()))


def test_24_two_blades_are_the_published_propeller_on_the_mean_and_exact_on_an_equal_mount(example):
    module = example(24)
    result = module.compute()
    assert "[" in module.draw(result).axes[0].get_xlabel()
    # Turning with the blades an equal mount makes the equations constant: multipliers exp(s T).
    system = module.two_blades({"pitch": 0.3, "yaw": 0.3})
    found, s = floquet.monodromy(system), np.linalg.eigvals(system.evaluate([0.0])[0])
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
    system, mode = module.on_shafts(19000.0), 4544.12869547
    x, weights = np.polynomial.legendre.leggauss(8)
    start, width = system.edges[:-1, None], np.diff(system.edges)[:, None]
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


@pytest.mark.parametrize("source", [tutorial, notebook])
def test_it_runs(source, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    names = {}
    for code in source():
        exec(code, names)
    assert {path.name for path in tmp_path.iterdir()} == {"steady.png", "chart.png"}
    assert "4875.0" in capsys.readouterr().out


def test_the_notebook_is_the_tutorial():
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
    assert float(eccentric.sel(order=range(3, 27)).max()) < 1e-2 * float(eccentric.sel(order=[27, 29]).min())
    for fault, ratio in (("crack 1 mm", (0.0, 0.5)), ("spall", (0.8, 1.2)), ("chip", (0.8, 1.2))):
        one = amplitude.sel(fault=fault)
        low, high = ratio
        assert low < float(one.sel(order=27) / one.sel(order=1)) < high, fault
