"""Are the lengths on the line of action those of two involute gears on their centres?"""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.optimize import brentq

from lumped import ParameterError, geometry, load_gear_pair
from multibody.gears.undercut import undercut_edge
from tests.unlike_pairs import UNLIKE, unlike_pair

ROUNDING = 1e-13  # relative, of lengths from a handful of operations in double precision


def test_28_28_is_the_table_of_the_model_page(nasa):
    g = geometry(nasa)
    printed = {
        "base_radius_pinion": 41.7693, "base_pitch": 9.3730, "L_XY": 30.4056, "L_XA": 7.5263,
        "L_XB": 13.5063, "L_XP": 15.2028, "L_XC": 16.8993, "L_XD": 22.8793,
    }  # fmt: skip
    for name, value in printed.items():
        assert getattr(g, name) * 1e3 == pytest.approx(value, abs=0.51e-4), name  # printed to 0.1 um
    assert g.contact_ratio == pytest.approx(1.6380, abs=0.51e-4)
    assert g.pairs == 2
    # T_m = 60/(n z): one tooth passes.
    assert g.mesh_period == pytest.approx(60 / (4875 * 28), rel=ROUNDING)
    assert g.mesh_frequency == pytest.approx(4875 * 28 / 60, rel=ROUNDING)


def by_construction(pair):
    """The points A, P, D and Y measured from X, by intersecting circles with a line instead of by formula."""
    g = geometry(pair)
    a = g.centre_distance
    r_bp = g.base_radius_pinion
    r_bg = g.base_radius_gear
    pinion, gear = np.array([0.0, 0.0]), np.array([0.0, a])

    # The internal common tangent of the base circles: its normal makes an angle with the centre line such
    # that both circles touch it from opposite sides.
    def gap(angle):
        normal = np.array([math.sin(angle), math.cos(angle)])
        return float(normal @ (gear - pinion)) - (r_bp + r_bg)

    angle = brentq(gap, 0.0, math.pi / 2 - 1e-9, xtol=1e-15)
    normal = np.array([math.sin(angle), math.cos(angle)])
    along = np.array([-math.cos(angle), math.sin(angle)])
    x = pinion + r_bp * normal
    y = gear - r_bg * normal
    if (y - x) @ along < 0:
        along = -along
    reach = 10 * a

    def crossing(centre, radius, start, sign):
        return brentq(
            lambda s: float(np.hypot(*(x + s * along - centre))) - radius,
            start,
            start + sign * reach,
            xtol=1e-16,
        )

    length = float((y - x) @ along)
    assert np.linalg.norm(y - x) == pytest.approx(length, rel=1e-12)
    # A rack that undercuts ends the flank of the mate before its tip; drawn once more by the other model.
    rack = pair.basic_rack
    edges = []
    for one in (pair.pinion, pair.gear):
        edges.append(undercut_edge(rack, one.teeth, one.profile_shift))
    return {
        "L_XA": max(crossing(gear, g.tip_radius_gear, length, -1), edges[0]),
        "L_XD": min(crossing(pinion, g.tip_radius_pinion, 0.0, +1), length - edges[1]),
        # The line of action crosses the line of centres (x = 0) at P.
        "L_XP": brentq(lambda s: float((x + s * along)[0]), -reach, reach, xtol=1e-16),
        "L_XY": length,
    }


def test_the_pitch_line_is_that_of_the_operating_circles():
    # FZG A/8.3/90: 8.3 m/s at 2170 rpm of the pinion with 16 teeth to 24 and 91.5 mm between the centres; the
    # reference circle of the pinion has 72 mm and 8.18 m/s.
    pair = load_gear_pair("fzg_c").with_(operating__pinion_speed=2170)
    g = geometry(pair)
    expected = 2170 * 2.0 * math.pi / 60.0 * 91.5e-3 * 16 / 40
    assert round(expected, 1) == 8.3
    assert g.pitch_line_velocity == pytest.approx(expected, rel=ROUNDING)


def test_fzg_c_shifts_and_centre_distance_belong_together():
    pair = load_gear_pair("fzg_c")
    free = geometry(pair.with_(centre_distance=None, mesh__backlash=0))
    # 91.5 mm with four-digit shifts: the centre distance free of backlash agrees to about a micrometre.
    assert free.centre_distance == pytest.approx(91.5e-3, abs=2e-6)
    assert free.normal_backlash == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("spread", [0.05e-3, 0.5e-3])
def test_backlash_grows_with_the_centre_distance(nasa, spread):
    start = nasa.with_(mesh__backlash=0, pinion__profile_shift=0, gear__profile_shift=0)
    a = geometry(start).centre_distance
    base = geometry(start).base_radius_pinion + geometry(start).base_radius_gear
    # Moving the centres apart by da opens the normal gap of both flanks together by 2 sin(alpha_w) da.
    expected, _ = quad(lambda c: 2.0 * math.sin(math.acos(base / c)), a, a + spread)
    spread_pair = start.with_(centre_distance=f"{a + spread!r} m")
    assert geometry(spread_pair).normal_backlash == pytest.approx(expected, rel=1e-9)  # difference of angles
    thinned = spread_pair.with_(mesh__backlash=0.2)
    assert geometry(thinned).normal_backlash == pytest.approx(expected + 0.2e-3, rel=1e-9)


def swapped(pair):
    """The same gears with their roles exchanged; the new pinion turns as the gear did."""
    data = pair.to_mapping()
    data["pinion"], data["gear"] = data["gear"], data["pinion"]
    return load_gear_pair(data)


def random_pair(teeth, shifts, addendum, angle, spread):
    base = load_gear_pair("nasa_28_28")
    changes = {
        "pinion.teeth": teeth[0], "gear.teeth": teeth[1], "pinion.profile_shift": shifts[0],
        "gear.profile_shift": shifts[1], "basic_rack.pressure_angle": angle,
        "basic_rack.addendum_coefficient": addendum, "basic_rack.dedendum_coefficient": addendum + 0.25,
        "basic_rack.fillet_radius_coefficient": 0.2, "centre_distance": None, "mesh.backlash": 0.0,
        "pinion.tip_relief": None, "gear.tip_relief": None,
    }  # fmt: skip
    try:
        pair = base.with_(changes)
        return pair.with_(centre_distance=f"{geometry(pair).centre_distance * (1 + spread)!r} m")
    except ParameterError:
        return None


pairs = st.builds(
    random_pair,
    st.tuples(st.integers(17, 90), st.integers(17, 90)),
    st.tuples(st.floats(-0.3, 0.6), st.floats(-0.3, 0.6)),
    st.floats(0.7, 1.3),
    st.floats(17.0, 25.0),
    st.floats(0.0, 0.004),
)


@settings(max_examples=60)
@given(pair=pairs)
def test_any_pair_that_exists(pair):
    assume(pair is not None)
    g = geometry(pair)
    assert 1.0 <= g.contact_ratio <= 3.0
    assert 0.0 <= g.L_XA < g.L_XC <= g.L_XD + g.base_pitch
    assert g.L_XA < g.L_XD <= g.L_XY
    for name, value in by_construction(pair).items():
        assert getattr(g, name) == pytest.approx(value, rel=1e-9, abs=1e-12), name
    # No involute is used where the rack has not made one.
    assert math.hypot(g.base_radius_pinion, g.L_XA) >= g.form_radius_pinion - 1e-11
    assert math.hypot(g.base_radius_gear, g.L_XY - g.L_XD) >= g.form_radius_gear - 1e-11
    assert g.normal_backlash >= 0.0


@settings(max_examples=40)
@given(pair=pairs)
def test_exchanging_the_gears_mirrors_the_line_of_action(pair):
    assume(pair is not None)
    g = geometry(pair)
    h = geometry(swapped(pair))
    close = {"rel": 1e-12, "abs": 1e-15}  # differences of lengths near 0.03 m
    assert pytest.approx(g.L_XY, **close) == h.L_XY
    for mine, theirs in (("L_XA", "L_XD"), ("L_XB", "L_XC"), ("L_XP", "L_XP"), ("L_XD", "L_XA")):
        assert getattr(h, mine) == pytest.approx(g.L_XY - getattr(g, theirs), **close)
    assert h.contact_ratio == pytest.approx(g.contact_ratio, rel=1e-12)
    assert h.normal_backlash == pytest.approx(g.normal_backlash, rel=1e-12, abs=1e-15)
    assert (h.form_radius_pinion, h.root_radius_gear) == (g.form_radius_gear, g.root_radius_pinion)


@pytest.mark.parametrize("name", UNLIKE)
def test_geometry_at_another_speed_is_that_of_a_file_with_this_speed(name):
    pair = unlike_pair(name).with_(range=None, speed="700 rpm")
    g = pair.at_speed(777.0).geometry
    assert g == pair.with_(speed="777 rpm").geometry
    assert g.mesh_period == pytest.approx(60 / (777 * pair.pinion.teeth), rel=ROUNDING)
