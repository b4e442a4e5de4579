"""Does the static transmission error follow its closed forms over torque, relief and pitch error?"""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from lumped import NumericalError, ParameterError, geometry, load_gear_pair, mesh_elements, steady_state
from lumped.path_of_contact import pair_stiffness
from lumped.quasi_static import optimal_relief, share_load, static_transmission_error, with_tip_relief
from tests.unlike_pairs import unlike_pair

K = 1e8  # N/m per pair
ROUNDING = 1e-12


def plain(**model):
    """The 28/28 pair without relief, by default with one constant stiffness per pair."""
    return load_gear_pair("nasa_28_28").with_(
        mesh__contact="prescribed",
        pinion__tip_relief=None,
        gear__tip_relief=None,
        mesh__stiffness=model or {"model": "rectangular", "pair_stiffness": K},
    )


def deflection(pair, torque):
    """F/k of a single pair [m]."""
    return torque / geometry(pair).base_radius_pinion / K


@pytest.mark.parametrize("extended", [False, True])
def test_one_or_two_equal_pairs(extended):
    pair = plain()
    g = geometry(pair)
    data = static_transmission_error(pair, [56.5], extended=extended)
    single = deflection(pair, 56.5)
    assert float(data.transmission_error.max()) == pytest.approx(single, rel=ROUNDING)
    assert float(data.transmission_error.min()) == pytest.approx(single / 2, rel=ROUNDING)
    assert float(data.peak_to_peak[0]) == pytest.approx(single / 2, rel=ROUNDING)
    if extended:
        assert float(data.contact_ratio[0]) > g.contact_ratio + 0.02
    else:
        # Mean number of pairs over 256 positions: each end of contact is found to one position.
        assert float(data.contact_ratio[0]) == pytest.approx(g.contact_ratio, abs=1 / 256)


def test_contact_beyond_the_path_grows_with_torque_and_fills_the_jump():
    data = static_transmission_error(plain(), [1.0, 20.0, 100.0])
    ratio = data.contact_ratio.values
    assert np.all(np.diff(ratio) > 0.0)
    # Without extension the error jumps by F/2k within one step; with it the step is spread.
    sharp = static_transmission_error(plain(), [100.0], extended=False).transmission_error.values[0]
    smooth = data.transmission_error.values[2]
    assert np.abs(np.diff(smooth)).max() < 0.25 * np.abs(np.diff(sharp)).max()


def test_contact_ratio_above_two():
    pair = plain().with_(
        basic_rack__addendum_coefficient=1.3,
        basic_rack__dedendum_coefficient=1.5,
        basic_rack__fillet_radius_coefficient=0.2,
    )
    g = geometry(pair)
    assert 2.0 < g.contact_ratio < 3.0
    data = static_transmission_error(pair, [30.0], extended=False)
    single = deflection(pair, 30.0)
    assert float(data.transmission_error.max()) == pytest.approx(single / 2, rel=ROUNDING)
    assert float(data.transmission_error.min()) == pytest.approx(single / 3, rel=ROUNDING)


def test_ideal_linear_relief_makes_the_error_constant_at_its_torque():
    # Amount F/k over the whole double contact: the reliefs add to F/k everywhere, so (F + k F/k)/2k = F/k.
    pair = plain()
    g = geometry(pair)
    single = deflection(pair, 56.5)
    length = (g.contact_ratio - 1) * g.base_pitch
    roll = np.rad2deg((g.L_XD - length) / g.base_radius_pinion)
    ideal = {"shape": "linear", "amount": single * 1e6, "start_roll_angle": roll}
    relieved = pair.with_(pinion__tip_relief=ideal, gear__tip_relief=ideal)
    data = static_transmission_error(relieved, [28.25, 56.5, 113.0])
    below, at_its_torque, twice = data.peak_to_peak.values
    assert at_its_torque < 1e-9 * single
    assert data.transmission_error.values[1] == pytest.approx(single, rel=1e-9)
    # Off its torque it is not: at twice the load single contact gives 2F/k, double (2F + F)/2k.
    assert twice == pytest.approx(single / 2, rel=1e-9)
    assert below > 0.1 * single


def test_relief_optimum_of_constant_stiffness_is_the_closed_form():
    pair = plain()
    g = geometry(pair)
    relief = optimal_relief(pair, torque=56.5)
    # 256 positions see the double contact to 1/256 of a pitch.
    assert relief.amount == pytest.approx(deflection(pair, 56.5), rel=5e-3)
    assert relief.length == pytest.approx((g.contact_ratio - 1) * g.base_pitch, rel=5e-3)
    assert relief.peak_to_peak < 1e-3 * relief.unmodified
    data = static_transmission_error(with_tip_relief(pair, relief), [56.5])
    assert float(data.peak_to_peak[0]) == pytest.approx(relief.peak_to_peak, abs=1e-6 * relief.unmodified)


def test_relief_optimum_of_real_stiffness():
    pair = plain(model="energy").with_(operating__pinion_torque=56.5)
    relief = optimal_relief(pair)
    radii = pair.geometry.base_radius_pinion, pair.geometry.base_radius_gear
    assert relief.peak_to_peak < 0.25 * relief.unmodified
    # A minimum up to the preference for little material, 1e-2 of the amount's change.
    for more, longer in itertools.product((0.9, 1.0, 1.1), (-0.05, 0.0, 0.05)):
        starts = {
            f"start_roll_angle_{gear}": getattr(relief, f"start_roll_angle_{gear}")
            - longer * relief.length / r
            for gear, r in zip(("pinion", "gear"), radii, strict=True)
        }
        other = with_tip_relief(pair, replace(relief, amount=more * relief.amount, **starts))
        peak = float(static_transmission_error(other).peak_to_peak[0])
        assert peak > relief.peak_to_peak - 2e-3 * relief.amount
        if more == 1.0 and longer == 0.0:
            assert peak == pytest.approx(relief.peak_to_peak, rel=1e-9)


def test_published_relief_of_the_nasa_rig_suits_its_torque():
    # 0.023 mm from 24 deg roll angle on both 28/28 gears of the NASA gear-noise rig. With ISO's stiffness its
    # Harris map must have its valley within the paper's loads, 56.5 to 79.1 N m (one step of the map beyond).
    pair = load_gear_pair("nasa_28_28").with_(
        mesh__contact="prescribed", mesh__stiffness={"model": "parabolic"}
    )
    torques = np.linspace(5.0, 120.0, 116)
    error = static_transmission_error(pair, torques).peak_to_peak.values
    assert 55.5 < torques[np.argmin(error)] < 80.1


def test_elements_without_relief_have_the_stiffness_of_the_model():
    pair = plain(model="energy")
    coefficients = mesh_elements(pair).stiffness.coefficients
    assert coefficients == pytest.approx(pair_stiffness(pair).coefficients)


@pytest.mark.parametrize("share", [0.25, 2.5])
def test_loaded_mesh_reproduces_the_static_transmission_error(unlike, share):
    # The linear model's static answer, (F + sum k_i e_i)/sum k_i with k_i(xi; T), is the nonlinear solution.
    torque = share * unlike.operating.pinion_torque
    pair = unlike.healthy.with_(torque=torque, mesh__contact="prescribed")
    g = geometry(pair)
    mesh = mesh_elements(pair)
    data = static_transmission_error(pair, extended=False)
    xi = data.position.values
    k = np.where((xi > g.L_XA) & (xi < g.L_XD), mesh.stiffness(xi), 0.0)
    e = mesh.error(xi)
    linear = (torque / g.base_radius_pinion + (k * e).sum(axis=1)) / k.sum(axis=1)
    exact = data.transmission_error.values[0]
    at_ends = np.abs(xi[:, :, None] - [g.L_XA, g.L_XD]).min(axis=(1, 2)) < 1e-9  # position on a jump
    assert linear[~at_ends] == pytest.approx(exact[~at_ends], rel=1e-9)


@pytest.mark.parametrize("name", ["larger_gear_drives_contact_lost", "contact_ratio_2_3_on_shafts"])
def test_energy_stiffness_follows_the_torque(name):
    # Every row of the map must be what the pair gives when it operates at that torque.
    pair = unlike_pair(name).with_(torque=40.0, mesh__contact="prescribed")
    torques = [4.0, 40.0, 160.0]
    data = static_transmission_error(pair, torques, extended=False).transmission_error.values
    for row, torque in zip(data, torques, strict=True):
        loaded_pair = pair.with_(operating__pinion_torque=torque)
        exact = static_transmission_error(loaded_pair, extended=False).transmission_error.values[0]
        assert row == pytest.approx(exact, rel=1e-8)  # two fits of k at 1e-10 of the peak
    # Softer at low load: more than a tenth of the deflection's share would give.
    assert data[0].mean() * 10 > 1.02 * data[1].mean()


def test_no_load_leaves_relief_without_shares_or_warnings():
    # Sums of k_i e_i leave rounding in the loads of the pair that touches: no share may come of it.
    pair = unlike_pair("heavily_relieved_under_load").with_(mesh__contact="prescribed")
    data = static_transmission_error(pair, [0.0, 1.0])
    assert not data["load_share"].sel(torque=0.0).any()
    assert float(data["load_share"].sel(torque=1.0).sum("pair").min()) == pytest.approx(1.0, rel=1e-9)
    # The unloaded error is the least relief among the pairs within reach.
    assert data["transmission_error"].sel(torque=0.0).values == pytest.approx(
        data["error"].min("pair").values, abs=1e-15
    )


def test_bad_input_is_refused():
    with pytest.raises(ParameterError, match="torques"):
        static_transmission_error(plain(), [-1.0])
    with pytest.raises(ParameterError, match="phases"):
        static_transmission_error(plain(), [1.0], phases=1)
    with pytest.raises(ParameterError, match="torque"):
        optimal_relief(plain(), torque=0.0)
    with pytest.raises(NumericalError, match="outside the path"):
        static_transmission_error(plain(model="rectangular", pair_stiffness=1e6), [500.0])


def relieved(**changes):
    pair = unlike_pair("heavily_relieved_under_load")
    return pair.with_(
        {"mesh.contact": "prescribed", "mesh.relief": "static", "friction.law": "none", **changes}
    )


def test_elements_carry_the_error_and_the_loaded_contact():
    pair = relieved(**{"operating.pinion_torque": 300.0})
    g = geometry(pair)
    e = mesh_elements(pair)
    # Amounts of the pair's reliefs at both tips.
    assert float(e.error(g.L_XD)) == pytest.approx(40e-6, rel=1e-9)
    assert float(e.error(g.L_XA)) == pytest.approx(36e-6, rel=1e-9)
    assert float(e.stiffness(g.L_XA + 1e-6)) == 0.0  # 300 N m do not close 36 um
    assert float(e.damping(g.L_XA + 1e-6)) == pytest.approx(0.0, abs=1e-9)


def test_slow_running_is_quasi_static():
    # 300 N m do not close the relief at the tips: no pair jumps in at A, which would ring at every speed.
    pair = relieved(**{"operating.pinion_torque": 300.0})
    exact = static_transmission_error(pair, phases=512, extended=False).transmission_error.values[0]
    differences = []
    for rpm in (200.0, 50.0):
        dte = steady_state(pair.with_({"operating.pinion_speed": rpm}), samples_per_cycle=512).dte.values
        differences.append(np.sqrt(np.mean((dte[:512] - exact) ** 2)) / np.ptp(exact))
    # Inertia forces grow with the square of the speed and damping with the speed; kinks of k and e ring.
    assert differences[1] < 3e-3
    assert differences[1] < differences[0] / 4


def test_pairs_that_cannot_touch_carry_nothing():
    unloaded = share_load(np.full((2, 2), K), np.array([[1e-6, 3e-6], [4e-6, 2e-6]]), 0.0)
    assert unloaded.transmission_error == pytest.approx([1e-6, 2e-6], rel=1e-14)  # the first contact
    sharing = share_load(np.array([1e8, 1e8]), np.array([0.0, np.inf]), np.array([[10.0], [20.0]])[:, 0])
    assert sharing.load == pytest.approx(np.array([[10.0, 0.0], [20.0, 0.0]]), rel=1e-14)
    with pytest.raises(NumericalError, match="no tooth pair"):
        share_load([1e8], [np.inf], 1.0)


def test_a_coupling_too_small_to_matter_changes_nothing():
    k = np.array([[1.0, 2.0, 0.5, 0.0]])
    e = np.array([[0.3, 0.0, np.inf, 0.1]])
    alone, nearly = (share_load(k, e, [2.0], w) for w in (None, np.full((1, 4, 4), 1e-300)))
    assert nearly.load == pytest.approx(alone.load, rel=1e-14)
    assert nearly.transmission_error == pytest.approx(alone.transmission_error, rel=1e-14)
