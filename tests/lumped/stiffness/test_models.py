"""Do the stiffness models give the pair stiffness they promise over the path of contact?"""

import math

import numpy as np
import pytest

from lumped import ParameterError, geometry, load_gear_pair, plane_compliance
from lumped.path_of_contact import pair_stiffness
from lumped.stiffness import MODELS, iso6336
from lumped.stiffness.parabolic import parabola

LOW, HIGH, PEAK = 7.5e-3, 22.9e-3, 8e7
ROUNDING = 1e-12  # of polynomials of degree 8 at arguments of order one


def with_model(**model):
    return load_gear_pair("nasa_28_28").with_(mesh__stiffness=model)


@pytest.mark.parametrize("model", sorted(set(MODELS) - {"table"}))
def test_every_model_spans_the_path_of_contact_and_is_positive_inside(model):
    pair = with_model(model=model)
    g = geometry(pair)
    k = pair_stiffness(pair)
    assert k.interval == (g.L_XA, g.L_XD)
    inside = np.linspace(g.L_XA, g.L_XD, 400)[1:-1]
    assert np.all(k(inside) > 0.0)
    assert k(g.L_XA - 1e-6) == k(g.L_XD + 1e-6) == 0.0


def test_rectangular_takes_its_parameter():
    pair = with_model(model="rectangular", pair_stiffness=1.5e8)
    k = pair_stiffness(pair)
    assert np.all(k(np.linspace(*k.interval, 9)) == 1.5e8)


def test_rectangular_defaults_to_iso():
    pair = with_model(model="rectangular")
    # c' of 28/28 by hand times 6.35 mm: 12.5816 N/(mm um) * 6.35 mm = 79.89 N/um.
    by_hand = 0.8 * 0.975 / (0.04723 + 0.41342 / 28) * 6.35 * 1e6
    assert pair_stiffness(pair).mean() == pytest.approx(by_hand, rel=1e-12)


def test_parabola_has_its_peak_in_the_middle_and_its_ends():
    k = parabola(LOW, HIGH, PEAK, 0.6)
    middle = 0.5 * (LOW + HIGH)
    assert k(middle) == pytest.approx(PEAK, rel=ROUNDING)
    assert k.slope(middle) == pytest.approx(0.0, abs=ROUNDING * PEAK / (HIGH - LOW))
    assert k([LOW, HIGH]) == pytest.approx(0.6 * PEAK, rel=ROUNDING)
    offset = np.linspace(0.0, 0.99, 30) * (HIGH - LOW) / 2
    assert k(middle - offset) == pytest.approx(k(middle + offset), rel=ROUNDING)
    assert k.mean() == pytest.approx(PEAK * (2 + 0.6) / 3, rel=ROUNDING)  # mean of a parabola


@pytest.mark.parametrize("tip", [93.5, 95.25])
def test_default_parabola_has_the_mean_total_stiffness_of_iso(tip):
    # Sum of k_i averaged over the mesh cycle = integral of k over the path / base pitch.
    pair = with_model(model="parabolic").with_(
        pinion__tip_diameter=tip, gear__tip_diameter=tip, pinion__tip_relief=None, gear__tip_relief=None
    )
    g = geometry(pair)
    tau = (np.arange(2000) + 0.5) / 2000 * g.base_pitch
    k = pair_stiffness(pair)
    total = sum(k(g.L_XA + i * g.base_pitch + tau) for i in range(g.pairs)).mean()
    expected = iso6336.mean_mesh_stiffness(iso6336.pair_single_stiffness(pair), g.contact_ratio)
    # Midpoint rule over a jump at one of 2000 points: error up to half a point's share.
    assert total / (g.face_width * 1e9) == pytest.approx(expected, rel=5e-4)


@pytest.mark.parametrize("ramp", [0.3e-3, 2e-3, (HIGH - LOW) / 2])
def test_ramp_rises_from_zero_and_is_smooth(ramp):
    k = parabola(LOW, HIGH, PEAK, 0.7, ramp)
    slope = k.slope
    scale = PEAK / ramp
    edges = 1e-15
    assert k([LOW + edges, HIGH - edges]) == pytest.approx(0.0, abs=ROUNDING * PEAK)
    assert slope([LOW + edges, HIGH - edges]) == pytest.approx(0.0, abs=1e-9 * scale)
    for join in k.switches:
        left, right = join - 1e-12, join + 1e-12  # slopes of the two pieces: curvature * 2e-12 m apart
        assert k(left) == pytest.approx(float(k(right)), rel=1e-7)
        assert slope(left) == pytest.approx(float(slope(right)), abs=1e-7 * scale)
    plain = parabola(LOW, HIGH, PEAK, 0.7)
    between = np.linspace(LOW + ramp, HIGH - ramp, 11)
    assert k(between) == pytest.approx(plain(between), rel=1e-11)
    rising = np.linspace(LOW, LOW + 0.999 * min(ramp, 2e-3), 200)
    assert np.all(np.diff(k(rising)) > 0.0)
    # Half way up the ramp: smoothstep(1/2)^2 = 1/4 of the parabola.
    assert k(LOW + ramp / 2) == pytest.approx(plain(LOW + ramp / 2) / 4, rel=1e-11)


def test_too_long_a_ramp_is_refused():
    pair = with_model(model="parabolic", ramp_length=9.0)
    with pytest.raises(ParameterError, match="ramp_length") as refusal:
        pair_stiffness(pair)
    problem = refusal.value.problems[0]
    assert problem.value == "9 mm"
    # Half of the path of contact of the 28/28 pair: (22.8793 - 7.5263)/2 mm.
    assert "7.6765 mm" in problem.allowed


@pytest.mark.parametrize("model", ["parabolic", "energy"])
def test_a_ramp_too_short_to_resolve_is_refused(model):
    def stiffness(ramp):
        pair = with_model(model=model, ramp_length=ramp)
        return pair_stiffness(pair)

    with pytest.raises(ParameterError, match="Write 0 for a jump"):
        stiffness(1.5e-3)
    shortest, jump = stiffness(1.6e-3), stiffness(0.0)
    middle = np.linspace(LOW + 2e-6, HIGH - 2e-6, 50)
    np.testing.assert_allclose(shortest(middle), jump(middle), rtol=1e-10)


def test_square_root_of_the_ramp_is_smooth():
    # c_i = 2 zeta sqrt(k_i m_e): sqrt(k) must behave like s^2 at the start, so c/s^2 tends to a constant.
    ramp = 1e-3
    k = parabola(LOW, HIGH, PEAK, 1.0, ramp)
    s = np.array([1e-3, 2e-3])
    root = np.sqrt(k(LOW + s * ramp))
    # sqrt(RAMP) = 3 s^2 - 2 s^3
    assert root == pytest.approx(np.sqrt(PEAK) * (3 * s**2 - 2 * s**3), rel=1e-6)


def test_finite_elements_are_the_plane_compliance_at_any_torque():
    pair = with_model(model="finite_elements")
    xi = np.linspace(*pair_stiffness(pair).interval, 9)[1:-1]
    k, (w, *_) = pair_stiffness(pair)(xi), pair.mesh.stiffness.neighbours(pair)
    found = plane_compliance(pair, phases=3)
    both = found.position.values[0]
    assert found.compliance.values[0] == pytest.approx(
        np.array(
            [
                [1.0 / pair_stiffness(pair)(both[0]), w(both[0])],
                [w(both[0]), 1.0 / pair_stiffness(pair)(both[1])],
            ]
        ),
        rel=1e-6,  # w is one polynomial over a path that reaches beyond the flanks
    )
    # The contact widens with the root of the load: 1/k falls by D ln T.
    twice = pair.with_(operating__pinion_torque=2.0 * pair.operating.pinion_torque)
    softening = pair.mesh.stiffness.softening(pair)
    assert 1.0 / pair_stiffness(twice)(xi) == pytest.approx(1.0 / k - softening * np.log(2.0), rel=1e-9)
    # Twice as wide under the same load per width.
    wide = pair.with_(pinion__face_width=12.7, gear__face_width=12.7, operating__pinion_torque="113 N m")
    assert pair_stiffness(wide)(xi) == pytest.approx(2.0 * k, rel=1e-9)


def test_worked_example_of_the_standard():
    # ISO/TR 6336-30:2017, example 1: helical 17/103, m_n 8 mm, beta 15.8 deg, x 0.145/0, rack with h_fP 1.4,
    # centre distance 500 mm, virtual teeth 18.905/114.543; its c'_th 17.85584, c' 12.37047,
    # c_gamma_alpha 17.46485 N/(mm um). The numbers are those that a public program quotes from the report's
    # annex (gfsReboucas/Drivetrain, MATISO_6336.m, example_01); the report itself was not at hand.
    theory = iso6336.theoretical_single_stiffness(18.905, 114.543, 0.145, 0.0)
    rack = iso6336.basic_rack_factor(1.4, 20.0)
    single = iso6336.single_stiffness(theory, basic_rack=rack, helix=15.8)
    # Virtual tooth numbers are given to 5e-4, which moves q' = 0.056 mm um/N by C2/z^2 times that, 2e-7.
    assert theory == pytest.approx(17.85584, rel=5e-6)
    assert single == pytest.approx(12.37047, rel=5e-6)
    # The ratio does not carry them: c'/c'_th = 0.8 * 0.9 * cos(15.8 deg), to the printed digits.
    assert single / theory == pytest.approx(12.37047 / 17.85584, rel=2e-6)
    # Transverse contact ratio of the example's gears with standard addendum m_n (1 + x).
    beta, m = math.radians(15.8), 8.0
    alpha_t = math.atan(math.tan(math.radians(20.0)) / math.cos(beta))
    r = [0.5 * z * m / math.cos(beta) for z in (17, 103)]
    base = [value * math.cos(alpha_t) for value in r]
    tip = [r[0] + m * 1.145, r[1] + m]
    path = sum(math.sqrt(a**2 - b**2) for a, b in zip(tip, base, strict=True)) - math.sqrt(
        500.0**2 - sum(base) ** 2
    )
    contact_ratio = path / (math.pi * m / math.cos(beta) * math.cos(alpha_t))
    # The example's tip diameters are not quoted; the standard addendum gives 17.4672, 0.014 % more.
    assert iso6336.mean_mesh_stiffness(12.37047, contact_ratio) == pytest.approx(17.46485, rel=2e-4)


def test_the_standards_gear_one_is_the_smaller_whichever_drives():
    pair = load_gear_pair("nasa_28_28").with_(
        centre_distance=None, pinion__profile_shift=0.1, gear__teeth=40, gear__tip_relief=None
    )
    swapped = pair.with_(
        pinion__teeth=40, pinion__profile_shift=0.0, pinion__tip_relief=None, gear__teeth=28,
        gear__profile_shift=0.1,
    )  # fmt: skip
    assert iso6336.pair_single_stiffness(pair) == iso6336.pair_single_stiffness(swapped)
