"""Is every tooth pair where it should be, and does every coefficient switch when it should?"""

import math

import numpy as np
import pytest

from lumped import geometry, mesh_cycle
from validation.exchange.new_pair_file import new_pair


@pytest.fixture(scope="module")
def cycle(published):
    return mesh_cycle(published)


def test_number_of_pairs_in_contact(cycle):
    """floor(eps) + 1 pairs for the fraction eps - floor(eps) of a cycle, floor(eps) for the rest."""
    g = cycle.geometry
    n = math.floor(g.contact_ratio)
    middles = 0.5 * (cycle.edges[1:] + cycle.edges[:-1])
    count = cycle.sample(middles).contact.sum(axis=0)
    assert set(count) == {n, n + 1}
    share = np.diff(cycle.edges)[count == n + 1].sum() / cycle.period
    assert share == pytest.approx(g.contact_ratio - n, rel=1e-12)
    # The mean number of pairs is the contact ratio.
    assert (count * np.diff(cycle.edges)).sum() / cycle.period == pytest.approx(g.contact_ratio, rel=1e-12)


def test_the_pitch_point_is_a_switch_also_without_friction(published):
    """Sliding reverses there whatever the law: results are one-sided at it."""
    cycle = mesh_cycle(published.with_(friction__law="none"))
    g = published.geometry
    at_pitch_point = (g.L_XP - g.L_XA) / g.base_pitch % 1.0
    assert np.abs(cycle.switch_times / cycle.period - at_pitch_point).min() < 1e-12


def test_ends_of_a_segment_are_its_one_sided_limits(cycle):
    for segment, (low, high) in enumerate(zip(cycle.edges[:-1], cycle.edges[1:], strict=True)):
        nudge = max(1e-9 * (high - low), 1e-10 * cycle.period)  # nearer would count as at the switch
        segment_ends = cycle.sample([low, high], segment)
        near = cycle.sample([low + nudge, high - nudge])
        for name in ("stiffness", "damping", "friction"):
            a = getattr(segment_ends, name)
            b = getattr(near, name)
            # The slope of the law over that way: law II is steep beside its bound at the pitch point.
            law = getattr(cycle.elements, name)
            g = cycle.geometry
            travel = g.base_radius_pinion * g.omega_pinion * nudge
            change = np.where(near.contact, np.abs(law.slope(near.position)) * travel, 0.0)
            assert (np.abs(a - b) <= 1.1 * change + 1e-9 * np.abs(a).max()).all(), name


@pytest.mark.parametrize("teeth", [(58, 58), (19, 41), (23, 23)])
def test_no_two_breaks_differ_by_rounding(teeth):
    """Both gears alike: many breaks of a law have a mirror image, whose phase is that of the break."""
    pair = new_pair(teeth, 2.3, 13.5, 910, 120)
    cycle = mesh_cycle(pair)
    assert np.diff(cycle.breaks).min() > 1e-13 * cycle.period
    assert np.isin(cycle.edges, cycle.breaks).all()
    for name in ("stiffness", "damping", "friction", "error"):
        law = getattr(cycle.elements, name)
        low, high = law.interval
        assert np.diff(law.breaks).min() > 1e-13 * (high - low), name


class TestManyCycles:
    def test_right_continuous_at_the_start_of_every_cycle(self, cycle):
        """A multiple of the period rounds to either side of itself: it counts as the next cycle's start."""
        starts = cycle.sample(np.arange(1, 60) * cycle.period)
        first = cycle.sample([0.0])
        assert (starts.contact == first.contact).all()
        assert np.abs(starts.position - first.position).max() < 1e-12 * first.position.max()
        assert np.abs(starts.stiffness - first.stiffness).max() < 1e-9 * first.stiffness.max()

    def test_right_continuous_at_every_switch(self, cycle):
        times = cycle.switch_times
        for j in range(times.size):
            after = cycle.sample(times[j : j + 1], j + 1)
            switch_sample = cycle.sample(times[j] + np.arange(60) * cycle.period)
            for name in ("stiffness", "damping", "friction", "contact"):
                quantity, expected = (
                    np.asarray(getattr(s, name), dtype=float) for s in (switch_sample, after)
                )
                # A law has no slope that would show over the rounding of 60 periods, 1e-14 of one.
                assert np.abs(quantity - expected).max() <= 1e-9 * np.abs(expected).max(), name


def at_contact_ratio(nasa, ratio):
    """28/28 with tip circles that give the contact ratio to rounding."""
    slim = nasa.with_(
        {"basic_rack.dedendum_coefficient": 1.6, "basic_rack.fillet_radius_coefficient": 0.1}
    ).with_(
        pinion__teeth=50, gear__teeth=50, centre_distance=None, pinion__tip_relief=None, gear__tip_relief=None
    )
    g = geometry(slim)
    length = 0.5 * (ratio * g.base_pitch + g.L_XY)
    tip = f"{2 * math.hypot(g.base_radius_pinion, length)!r} m"
    return slim.with_(pinion__tip_diameter=tip, gear__tip_diameter=tip)


@pytest.mark.parametrize(
    "excess", [0.0, 1e-15, -1e-15, 1e-12, -1e-12, 1e-10, -1e-10, 1e-8, -1e-8, 1e-5, -1e-5]
)
def test_an_integer_contact_ratio_is_no_special_place(nasa, excess):
    cycle = mesh_cycle(at_contact_ratio(nasa, 2.0 + excess))
    assert cycle.geometry.contact_ratio == pytest.approx(2.0 + excess, abs=1e-13)
    middles = 0.5 * (cycle.edges[1:] + cycle.edges[:-1])
    count = cycle.sample(middles).contact.sum(axis=0)
    mean = (count * np.diff(cycle.edges)).sum() / cycle.period
    # Switches closer than 1e-10 of a cycle count as one, at most two of them; so do those beside its ends.
    assert np.diff(cycle.edges).min() > 0.99e-10 * cycle.period  # 1 % for rounding
    assert mean == pytest.approx(2.0 + excess, abs=3e-10)
    assert np.all(np.isfinite(cycle.sample(np.linspace(0, cycle.period, 101)).stiffness))


@pytest.mark.parametrize("excess", [1e-12, 1e-6])
def test_the_least_contact_ratio(nasa, excess):
    cycle = mesh_cycle(at_contact_ratio(nasa, 1.0 + excess))
    times = np.linspace(0, cycle.period, 1001)
    assert cycle.sample(times).contact.any(axis=0).all()


@pytest.mark.parametrize("cycles", [0, 1, 1000, 100_000])
def test_no_more_than_rounding_counts_as_at_a_switch(cycle, cycles):
    """Behind it where a switch is hit but for the rounding of the time; the law before it just before."""
    places = cycle.edges[1:-1]
    segments = np.arange(cycle.edges.size - 2)
    jumps = []
    for time, segment in ((places * (1.0 - 2e-12), segments), (places + cycles * cycle.period, segments + 1)):
        sample = cycle.sample(time)
        expected = cycle.sample(places, segment=segment)
        for name in ("stiffness", "damping", "friction", "error"):
            sampled = getattr(sample, name)
            exact = getattr(expected, name)
            # A law has no slope that would show over the rounding of 1e5 periods, 1e-11 of one.
            np.testing.assert_allclose(
                sampled, exact, rtol=0.0, atol=1e-6 * np.abs(exact).max(), err_msg=name
            )
        jumps.append(expected.stiffness)
    assert (np.abs(jumps[1] - jumps[0]).max(axis=0) > 1e-3 * np.abs(jumps[0]).max()).any()
