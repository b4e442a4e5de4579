"""Are span, dimension over balls and tooth thickness those of the flanks that the rack cuts?"""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq, minimize_scalar

from lumped import load_gear_pair
from lumped.gear_geometry.measures import (
    as_made,
    ball_touching_at,
    gear_table,
    over_balls,
    shift_from_balls,
    shift_from_span,
    span,
    teeth_spanned,
)
from lumped.gear_geometry.tooth_profile import ToothProfile
from tests.unlike_pairs import unlike_pair

ROUNDING = 1e-12  # relative, of lengths from a handful of operations


def teeth():
    """Gears of any size: numbers of teeth, module, pressure angle and shift."""
    return st.builds(
        ToothProfile,
        teeth=st.integers(17, 150),
        module=st.floats(0.3e-3, 30e-3),
        pressure_angle=st.floats(math.radians(17.0), math.radians(27.0)),
        profile_shift=st.floats(-0.3, 0.7),
        dedendum=st.just(1.25),
        fillet=st.just(0.2),
    )


def shifted_radius(tooth):
    return tooth.reference_radius + tooth.profile_shift * tooth.module


def flank(tooth, length):
    """Point of the right flank of a tooth on the u axis, at a length along the base tangent."""
    u, h, _, _ = tooth.involute_points(np.asarray(length))
    return float(u), float(h)


@settings(max_examples=60, deadline=None)
@given(teeth())
def test_span_is_the_distance_of_planes_that_touch_two_flanks(tooth):
    # The outer flanks of k teeth, turned so that both are cut at right angles by one line: the distance of
    # the two points is that of two planes that touch the flanks there.
    k = teeth_spanned(tooth, shifted_radius(tooth))
    half_turn = math.pi * (k - 1) / tooth.teeth

    def across(length):
        """Distance of a point of the outer flank from the symmetry line of the k teeth."""
        u, h = flank(tooth, length)
        return u * math.sin(half_turn) + h * math.cos(half_turn)

    # A plane parallel to the symmetry line touches the flank where it is farthest from that line.
    optimum = minimize_scalar(lambda s: -across(s), bounds=(0.0, 3.0 * tooth.base_radius), method="bounded",
                            options={"xatol": 1e-10 * tooth.module})  # fmt: skip
    assert 2.0 * across(optimum.x) == pytest.approx(span(tooth, k), rel=1e-10)
    # They touch where half the span is the length along the base tangent.
    assert optimum.x == pytest.approx(0.5 * span(tooth, k), rel=1e-4)  # of a flat optimum


@settings(max_examples=60, deadline=None)
@given(teeth(), st.floats(1.0, 1.2))
def test_a_ball_touches_both_flanks_of_a_space(tooth, larger):
    ball = larger * ball_touching_at(tooth, shifted_radius(tooth))
    centre = 0.5 * (over_balls(replace(tooth), ball) - ball)
    if tooth.teeth % 2:
        centre /= math.cos(0.5 * math.pi / tooth.teeth)
    turn = math.pi / tooth.teeth  # from the tooth's centre line to that of the space
    ball_centre = centre * math.cos(turn), centre * math.sin(turn)

    def distance(length):
        u, h = flank(tooth, length)
        return math.hypot(u - ball_centre[0], h - ball_centre[1])

    nearest = minimize_scalar(distance, bounds=(0.0, 2.0 * tooth.base_radius), method="bounded",
                            options={"xatol": 1e-10 * tooth.module})  # fmt: skip
    assert nearest.fun == pytest.approx(0.5 * ball, rel=1e-9)
    if larger == 1.0:
        touched = math.hypot(tooth.base_radius, nearest.x)
        assert touched == pytest.approx(shifted_radius(tooth), rel=1e-5)


def test_two_balls_are_as_far_apart_as_on_the_gear():
    for number in (24, 25, 37, 38):
        tooth = ToothProfile(number, 2e-3, math.radians(20.0), 0.2, 1.25, 0.38)
        ball = 4e-3
        radius = (
            0.5
            * (over_balls(tooth, ball) - ball)
            / (1.0 if number % 2 == 0 else math.cos(math.pi / 2 / number))
        )
        spaces = radius * np.exp(2j * math.pi * (np.arange(number) + 0.5) / number)
        farthest = np.abs(spaces[:, None] - spaces[None, :]).max() + ball
        assert over_balls(tooth, ball) == pytest.approx(farthest, rel=ROUNDING)


@settings(max_examples=60, deadline=None)
@given(teeth(), st.integers(2, 9), st.floats(1.0, 1.3))
def test_shifts_follow_from_what_was_measured(tooth, k, larger):
    unknown = replace(tooth, profile_shift=0.0)
    assert shift_from_span(unknown, k, span(tooth, k)) == pytest.approx(tooth.profile_shift, abs=1e-11)
    ball = larger * ball_touching_at(tooth, shifted_radius(tooth))
    assert shift_from_balls(unknown, ball, over_balls(tooth, ball)) == pytest.approx(
        tooth.profile_shift, abs=1e-10
    )


@settings(max_examples=60, deadline=None)
@given(teeth())
def test_the_span_over_these_teeth_touches_nearest_to_the_circle(tooth):
    radius = shifted_radius(tooth)
    wanted = 2.0 * math.sqrt(radius**2 - tooth.base_radius**2)
    k = teeth_spanned(tooth, radius)
    distances = {one: abs(span(tooth, one) - wanted) for one in (k - 1, k, k + 1) if one >= 2}
    assert min(distances.values()) == distances[k]


@pytest.mark.parametrize("name", ["contact_ratio_1_1_large_shifts", "larger_gear_drives_contact_lost",
                                  "rack_25_degrees_always_pushing"])  # fmt: skip
def test_each_gear_has_half_of_the_thinning(name):
    pair = unlike_pair(name)
    thin = pair.with_(mesh__backlash=0.06)
    full = gear_table(pair.with_(mesh__backlash=0.0))
    table = gear_table(thin, (full.pinion.teeth_spanned, full.gear.teeth_spanned))
    for one, other in ((table.pinion, full.pinion), (table.gear, full.gear)):
        assert other.span - one.span == pytest.approx(0.03e-3, abs=1e-15)
        arc = 0.03e-3 / math.cos(pair.basic_rack.pressure_angle)
        assert other.tooth_thickness - one.tooth_thickness == pytest.approx(arc, abs=1e-15)
        assert one.root_diameter == other.root_diameter  # the model thins flanks and leaves the root
    assert table.normal_backlash - full.normal_backlash == pytest.approx(0.06e-3, abs=1e-15)
    working = table.operating_pressure_angle
    assert table.circumferential_backlash * math.cos(working) == pytest.approx(
        table.normal_backlash, rel=ROUNDING
    )


def test_thicknesses_are_those_of_the_flanks():
    pair = unlike_pair("rack_25_degrees_always_pushing").with_(mesh__backlash=0.0)
    table = gear_table(pair)
    for wheel, one in zip(pair.wheels, (table.pinion, table.gear), strict=True):
        for diameter, arc in (
            (one.reference_diameter, one.tooth_thickness),
            (one.tip_diameter, one.tip_thickness),
        ):
            radius = 0.5 * diameter
            length = brentq(
                lambda s, w=wheel, r=radius: math.hypot(*flank(w.tooth, s)) - r, 0.0, radius, xtol=1e-16
            )
            u, h = flank(wheel.tooth, length)
            assert arc == pytest.approx(2.0 * radius * math.atan2(h, u), rel=1e-10)


def test_clearances_are_between_a_root_and_the_mates_tip():
    table = gear_table(load_gear_pair("fzg_c").with_(pinion__tip_diameter=82.0, gear__tip_diameter=118.0))
    for one, mate in ((table.pinion, table.gear), (table.gear, table.pinion)):
        assert one.tip_clearance == pytest.approx(
            table.centre_distance - 0.5 * (one.root_diameter + mate.tip_diameter), rel=ROUNDING
        )
    assert table.pinion.tip_clearance != table.gear.tip_clearance


def test_a_span_that_touches_no_involute_is_no_number():
    pair = load_gear_pair("nasa_28_28")
    table = gear_table(pair, (9, 4))
    assert table.pinion.span is None
    assert table.gear.span is not None
    row = next(row for row in table.rows() if row.symbol == "W_k")
    assert row.texts() == ("not measurable", f"{1e3 * table.gear.span:.3f}")


def test_balls_stand_out_of_the_tip_circle():
    # A contact ratio of 2.3 takes long teeth: a ball that touches on the shifted circle is below their tips.
    pair = unlike_pair("contact_ratio_2_3_on_shafts")
    table = gear_table(pair)
    for wheel, one in zip(pair.wheels, (table.pinion, table.gear), strict=True):
        made = as_made(wheel.tooth, 0.5 * pair.mesh.backlash)
        opposite = 1.0 if one.teeth % 2 == 0 else math.cos(0.5 * math.pi / one.teeth)
        assert (one.over_balls - one.ball_diameter) / opposite + one.ball_diameter > one.tip_diameter
        assert over_balls(made, one.ball_diameter) == one.over_balls


def test_the_text_has_a_line_for_every_row():
    table = gear_table(load_gear_pair("fzg_c"))
    lines = str(table).splitlines()
    assert len(lines) == 1 + len(table.rows())
    assert len({line[:40] for line in lines}) == len(lines)
    line = next(line for line in lines if "d_a" in line.split())
    assert line.split()[-3:] == ["mm", "82.636", "118.544"]
    assert all(row.unit in ("", "mm", "deg") and row.label and row.symbol for row in table.rows())


def test_a_row_knows_which_field_decides_it():
    # The tips of this pair are given; those of a pair without them are assumed, and change with their field.
    pair = load_gear_pair("fzg_c")
    free = load_gear_pair("nasa_28_28")
    for row in gear_table(pair).rows():
        assert len(row.decided_by) in (0, len(row.values)), row.label
        for path in row.decided_by:
            pair.state(path)  # raises for a name that is no field
    tips = next(row for row in gear_table(pair).rows() if row.symbol == "d_a")
    assert [pair.state(path).value for path in tips.decided_by] == ["known", "known"]
    assert [free.state(path).value for path in tips.decided_by] == ["assumed", "assumed"]
