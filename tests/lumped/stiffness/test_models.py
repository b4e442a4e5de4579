"""Do the stiffness models give the pair stiffness they promise over the path of contact?"""

import math

import numpy as np
import pytest

from lumped import ParameterError, geometry, load_gear_pair, mesh_stiffness, plane_compliance
from lumped.fields.tables import read_columns
from lumped.path_of_contact import pair_stiffness
from lumped.stiffness import MODELS, iso6336
from lumped.stiffness.parabolic import parabola
from lumped.stiffness.table import STIFFNESS
from tests.unlike_pairs import unlike_pair

#: On whose path of contact the tables are.
BASE = unlike_pair("larger_gear_drives_contact_lost")
LOW = 7.5e-3
HIGH = 22.9e-3
PEAK = 8e7
ROUNDING = 1e-12  # of polynomials of degree 8 at arguments of order one


def with_model(**model):
    return load_gear_pair("nasa_28_28").with_(mesh__stiffness=model)


@pytest.mark.parametrize("model", sorted(set(MODELS) - {"table"}))
def test_every_model_spans_the_path_of_contact_and_is_positive_inside(unlike, model):
    pair = unlike.healthy.with_(mesh__stiffness={"model": model})
    g = geometry(pair)
    k = pair_stiffness(pair)
    assert k.interval == (g.L_XA, g.L_XD)
    inside = np.linspace(g.L_XA, g.L_XD, 400)[1:-1]
    assert np.all(k(inside) > 0.0)
    assert k(g.L_XA - 1e-6) == k(g.L_XD + 1e-6) == 0.0


def test_rectangular_takes_its_parameter_or_isos():
    k = pair_stiffness(with_model(model="rectangular", pair_stiffness=1.5e8))
    assert np.all(k(np.linspace(*k.interval, 9)) == 1.5e8)
    pair = unlike_pair("rack_25_degrees_always_pushing")
    # ISO 6336-1:2006, 9.3: q' of 23/38 with x 0.34/-0.17, C_B of a 25-degree rack with h_fP = 1.2 m,
    # E of a steel and a nodular iron gear, the smaller of the widths, 18 mm.
    q = (
        0.04723 + 0.15551 / 23 + 0.25791 / 38 - 0.00635 * 0.34 - 0.11654 * 0.34 / 23 - 0.00193 * -0.17
        - 0.24188 * -0.17 / 38 + 0.00529 * 0.34**2 + 0.00182 * 0.17**2
    )  # fmt: skip
    basic_rack = 1.0 + 0.02 * 5.0
    moduli = 2 * 206 * 172 / (206 + 172) / 206
    by_hand = 0.8 * basic_rack * moduli / q * 18 * 1e6
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


def test_default_parabola_has_the_mean_total_stiffness_of_iso(unlike):
    attributes = mesh_stiffness(unlike.healthy.with_(mesh__stiffness={"model": "parabolic"})).attrs
    assert attributes["mean"] == pytest.approx(attributes["iso_mean"], rel=1e-12)


@pytest.mark.parametrize("ramp", [0.3e-3, 2e-3, (HIGH - LOW) / 2])
def test_ramp_rises_from_zero_and_is_smooth(ramp):
    k = parabola(LOW, HIGH, PEAK, 0.7, ramp)
    slope = k.slope
    scale = PEAK / ramp
    edges = 1e-15
    assert k([LOW + edges, HIGH - edges]) == pytest.approx(0.0, abs=ROUNDING * PEAK)
    assert slope([LOW + edges, HIGH - edges]) == pytest.approx(0.0, abs=1e-9 * scale)
    for join in k.switches:
        # slopes of the two pieces: curvature * 2e-12 m apart
        before = join - 1e-12
        after = join + 1e-12
        assert k(before) == pytest.approx(float(k(after)), rel=1e-7)
        assert slope(before) == pytest.approx(float(slope(after)), abs=1e-7 * scale)
    plain = parabola(LOW, HIGH, PEAK, 0.7)
    between = np.linspace(LOW + ramp, HIGH - ramp, 11)
    assert k(between) == pytest.approx(plain(between), rel=1e-11)
    rising = np.linspace(LOW, LOW + 0.999 * min(ramp, 2e-3), 200)
    assert np.all(np.diff(k(rising)) > 0.0)
    # Half way up the ramp: smoothstep(1/2)^2 = 1/4 of the parabola.
    assert k(LOW + ramp / 2) == pytest.approx(plain(LOW + ramp / 2) / 4, rel=1e-11)


@pytest.mark.parametrize("model", ["parabolic", "energy"])
def test_the_shortest_ramp_is_all_but_a_jump(model):
    def stiffness(ramp):
        pair = with_model(model=model, ramp_length=ramp)
        return pair_stiffness(pair)

    shortest = stiffness(1.6e-3)
    jump = stiffness(0.0)
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
    k = pair_stiffness(pair)(xi)
    w, *_ = pair.mesh.stiffness.neighbours(pair)
    plane = plane_compliance(pair, phases=3)
    both = plane.position.values[0]
    assert plane.compliance.values[0] == pytest.approx(
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
    wide_gears = pair.with_(
        pinion__face_width=12.7, gear__face_width=12.7, operating__pinion_torque="113 N m"
    )
    assert pair_stiffness(wide_gears)(xi) == pytest.approx(2.0 * k, rel=1e-9)


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
    beta = math.radians(15.8)
    m = 8.0
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


def curve(xi, g):
    """A smooth pair stiffness [N/m]."""
    return 8e7 * (1.0 - 0.3 * ((xi - g.L_XP) / (g.L_XD - g.L_XA)) ** 2 + 0.02 * np.sin(xi / 1e-3))


def periodic(xi, g):
    """A smooth total stiffness with the period of a mesh cycle [N/m]."""
    turn = 2 * np.pi * (xi - g.L_XA) / g.base_pitch
    return 1.4e8 + 2e7 * np.cos(turn) + 5e6 * np.sin(3 * turn)


def pair_with(**table):
    return BASE.with_(mesh__stiffness={"model": "table", **table})


def pair_table(points, axis="position_mm", **more):
    g = geometry(BASE)
    xi = np.linspace(g.L_XA, g.L_XD, points)
    place = {
        "position_mm": xi * 1e3,
        "roll_angle_deg": np.rad2deg(xi / g.base_radius_pinion),
        "phase": (xi - g.L_XA) / g.base_pitch,
    }[axis]
    return pair_with(axis=axis, points=place.tolist(), stiffness=curve(xi, g).tolist(), **more)


@pytest.mark.parametrize("axis", ["position_mm", "roll_angle_deg", "phase"])
def test_every_axis_gives_the_same_curve(axis):
    pair = pair_table(41, axis)
    g = geometry(pair)
    xi = np.linspace(g.L_XA, g.L_XD, 41)
    assert pair_stiffness(pair)(xi) == pytest.approx(curve(xi, g), rel=1e-9)  # interpolation meets its points
    assert pair_stiffness(pair).switches.size == 0


@pytest.mark.parametrize(("interpolation", "order"), [("monotone", 2.0), ("cubic", 4.0)])
def test_order_of_interpolation(interpolation, order):
    g = geometry(BASE)
    xi = np.linspace(g.L_XA, g.L_XD, 3001)[1:-1]
    errors = []
    for points in (81, 161):
        pair = pair_table(points, interpolation=interpolation)
        errors.append(np.abs(pair_stiffness(pair)(xi) - curve(xi, g)).max())
    # Monotone interpolation falls to second order at the curve's own extremes.
    assert np.log2(errors[0] / errors[1]) > order - 0.5


def total_pair(phase, **more):
    pair = BASE
    g = geometry(pair)
    total = periodic(g.L_XA + phase * g.base_pitch, g)
    return pair_with(kind="total", axis="phase", points=phase.tolist(), stiffness=total.tolist(), **more)


SAMPLINGS = {
    "one period, open": np.arange(60) / 60,
    "one period, closed": np.linspace(0.0, 1.0, 61),
    "two periods, shifted": np.linspace(-0.3, 1.7, 121),
    "uneven": np.sort(np.mod(0.618033988749895 * np.arange(120), 1.0)),
}


@pytest.mark.parametrize("phase", SAMPLINGS.values(), ids=SAMPLINGS.keys())
@pytest.mark.parametrize("ramp", [0.0, 0.8])
def test_pairs_add_up_to_the_total_at_any_sampling(phase, ramp):
    pair = total_pair(phase, interpolation="cubic", ramp_length=ramp)
    g = geometry(pair)
    k = pair_stiffness(pair)
    tau = np.linspace(0.0, g.base_pitch, 501)[1:-1]
    total = sum(k(g.L_XA + i * g.base_pitch + tau) for i in range(g.pairs))
    # Cubic splines of 60 points on the third harmonic: (2 pi 3/60)^4/384 of 5e6, plus uneven gaps.
    assert total == pytest.approx(periodic(g.L_XA + tau, g), rel=2e-5)
    assert np.all(k(np.linspace(g.L_XA, g.L_XD, 300)[1:-1]) > 0.0)
    single = np.linspace(g.L_XB, g.L_XC, 20)[1:-1]  # one pair alone carries the total
    assert k(single) == pytest.approx(periodic(single, g), rel=2e-5)


def write(tmp_path, text):
    (tmp_path / "curve.csv").write_text(text, encoding="utf-8")
    return tmp_path / "curve.csv"


def test_csv_beside_the_parameter_file(tmp_path):
    g = geometry(BASE)
    xi = np.linspace(g.L_XA, g.L_XD, 30)
    rows = "\n".join(f"{k / 1e6:.12g}, {x / 0.0254:.12g}" for x, k in zip(xi, curve(xi, g), strict=True))
    write(tmp_path, f"# from finite elements\nstiffness [N/um], position [inch]\n{rows}\n")
    base = BASE.with_(mesh__stiffness={"model": "rectangular"}, name="with table")
    text = base.to_toml()
    cut = text.index("[mesh.stiffness]")
    end = text.index("\n[", cut + 1)
    section = '[mesh.stiffness]\nmodel = "table"\nfile = "curve.csv"\n'
    (tmp_path / "pair.toml").write_text(text[:cut] + section + text[end:], encoding="utf-8")
    pair = load_gear_pair(tmp_path / "pair.toml")
    assert pair.mesh.stiffness.axis == "position_mm"
    assert pair_stiffness(pair)(xi) == pytest.approx(curve(xi, g), rel=1e-9)
    # The pair carries the table itself: the round trip needs no file, and the hash covers the numbers.
    again = load_gear_pair(pair.to_mapping())
    assert again == pair
    assert hash(again) == hash(pair)


@pytest.mark.parametrize(("text", "match"), [
    ("", "two columns"),
    ("a,b\n1,2\n", "header"),
    ("position [mm], stiffness [kg]\n1,2\n3,4\n", "stiffness with its unit"),
    ("position [N], stiffness [N/m]\n1,2\n3,4\n", "position with its unit"),
    ("phase [mm], stiffness [N/m]\n1,2\n3,4\n", "phase without a unit"),
    ("position [mm], stiffness [N/m]\n1,two\n", "pair of numbers"),
    ("position [mm], stiffness [N/m]\n1,2,3\n1,2\n", "pair of numbers"),
    ("position [mm], stiffness [N/m]\n1,2,3\n1,2,3\n", "pair of numbers"),
    ("position [mm], stiffness [N/m]\n", "two columns"),
])  # fmt: skip
def test_wrong_files_are_refused(tmp_path, text, match):
    with pytest.raises(ParameterError, match=match):
        read_columns(write(tmp_path, text).name, tmp_path, STIFFNESS)
    with pytest.raises(ParameterError, match="CSV file that exists"):
        read_columns("none.csv", tmp_path, STIFFNESS)
