"""Are relief and the gap outside the path of contact what the flanks' geometry says?"""

import math

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from lumped import ParameterError, geometry, load_gear_pair
from lumped.quasi_static.tooth_error import corner_gap, error_function, relief_error
from tests.guards.by_hand import ByHand, Contact
from tests.unlike_pairs import unlike_pair

UNEQUAL = {"centre_distance": None, "gear.teeth": 40, "gear.tip_relief": None, "pinion.tip_relief": None}


def relieved(**changes):
    pair = load_gear_pair("nasa_28_28").with_({"pinion.tip_relief": None, "gear.tip_relief": None, **changes})
    return pair, geometry(pair)


def relief(shape, amount, start):
    return {"shape": shape, "amount": amount, "start_roll_angle": start}


@pytest.mark.parametrize(("shape", "half_way"), [("linear", 0.5), ("parabolic", 0.25)])
def test_tip_relief_of_the_pinion_ends_at_d(shape, half_way):
    pair, g = relieved(**{"pinion.tip_relief": relief(shape, 20.0, 24.0)})
    start = math.radians(24.0) * g.base_radius_pinion
    xi = np.array([g.L_XA, start, 0.5 * (start + g.L_XD), g.L_XD])
    assert relief_error(pair, xi) == pytest.approx([0.0, 0.0, half_way * 20e-6, 20e-6], abs=1e-18)


def test_error_function_is_the_relief_and_names_its_kinks():
    pair, g = relieved(
        **{
            "pinion.tip_relief": relief("linear", 20.0, 24.0),
            "pinion.root_relief": relief("parabolic", 5.0, 14.0),
            "gear.tip_relief": relief("parabolic", 15.0, 23.0),
        }
    )
    e = error_function(pair)
    xi = np.linspace(g.L_XA, g.L_XD, 400)[1:-1]
    assert e(xi) == pytest.approx(relief_error(pair, xi), abs=1e-13)  # a parabola through three points
    kinks = [math.radians(a) * g.base_radius_pinion for a in (14.0, 24.0)]
    kinks.append(g.L_XY - math.radians(23.0) * g.base_radius_gear)
    assert e.switches == pytest.approx(sorted(kinks), rel=1e-12)


@pytest.mark.parametrize(
    ("field", "start"), [("tip_relief", 40.0), ("tip_relief", 5.0), ("root_relief", 40.0)]
)
def test_relief_outside_the_active_flank_is_refused(field, start):
    pair, _ = relieved(**{f"pinion.{field}": relief("linear", 5.0, start)})
    with pytest.raises(ParameterError, match=rf"pinion\.{field}\.start_roll_angle"):
        error_function(pair)


def flank(radius, phase, length):
    """Involute that is at ``phase`` on the line of action; axes t along it, n away from the centre."""
    turn = (phase - length) / radius
    return (
        radius * np.sin(turn) + length * np.cos(turn),
        radius * np.cos(turn) - radius - length * np.sin(turn),
    )


@pytest.mark.parametrize("end", ["A", "D"])
@pytest.mark.parametrize("beyond", [0.05, 0.2, 0.4])
def test_the_gap_is_the_turn_that_brings_the_corner_onto_the_flank(end, beyond):
    _, g = relieved(**UNEQUAL)
    distance = beyond * g.base_pitch
    if end == "A":
        r_flank = g.base_radius_pinion
        r_tip = g.base_radius_gear
        start = g.L_XA
        xi = g.L_XA - distance
    else:
        r_flank = g.base_radius_gear
        r_tip = g.base_radius_pinion
        start = g.L_XY - g.L_XD
        xi = g.L_XD + distance
    gap = float(corner_gap(g, np.array([xi]))[0])
    assert gap > 0.0
    # The mate seen from its own tangent point: its corner is the point of its involute at the tip's length.
    corner_length = g.L_XY - start
    t, n = flank(r_tip, corner_length + distance, corner_length)
    corner = np.array([g.L_XY - t, -n])

    def nearest(turn):
        def distance_to(length):
            return math.dist(flank(r_flank, start - distance + turn, length), corner)

        minimum = minimize_scalar(
            distance_to, bounds=(0.1 * start, 2.0 * start), method="bounded", options={"xatol": 1e-12}
        )
        return minimum.fun

    # The flank turned forward by gap/r passes through that corner; one turned by 1 % more does not.
    assert nearest(gap) < 1e-4 * gap
    assert nearest(1.01 * gap) == pytest.approx(0.01 * gap, rel=0.05)


@pytest.mark.parametrize("name", ["heavily_relieved_under_load", "unlike_teeth_finite_elements"])
def test_the_reliefs_of_both_gears_over_their_own_roll_angles(name):
    """C s or C s^2, s from the start of the relief to the own tip; the gear's roll angle grows towards A."""
    pair = unlike_pair(name)
    xi = Contact(pair).xi
    expected = np.zeros(xi.size)
    for gear in ("pinion", "gear"):
        relief = getattr(pair, gear).tip_relief
        hand = ByHand(pair, gear)
        length = 1e3 * xi if gear == "pinion" else hand.line - 1e3 * xi
        start, end = math.degrees(relief.start_roll_angle), hand.roll(hand.tip_length)
        share = np.maximum((np.degrees(length / hand.r_b) - start) / (end - start), 0.0)
        expected += relief.amount * share ** {"linear": 1, "parabolic": 2}[relief.shape]
    np.testing.assert_allclose(relief_error(pair, xi), expected, rtol=1e-9, atol=1e-18)
