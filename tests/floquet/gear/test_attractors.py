"""Does the search find beats and chaos for any range of speeds, and are shares of motions right?"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import binomtest

import floquet
import lumped
from floquet.gear.motions import binomial_interval, start_of
from floquet.gear.unilateral import unilateral_system
from floquet.orbits.long_run import long_run
from floquet.orbits.response import lost_stability
from floquet.orbits.settling import settle
from lumped import ParameterError


@pytest.fixture(scope="module")
def pair():
    """19/41, module 2.5: chaos and beats from 20,000 to 33,130 rpm; up to 27,524 beside one stable motion."""
    both = {f"{gear}.face_width": "20 mm" for gear in ("pinion", "gear")}
    both |= {f"{gear}.tip_relief": None for gear in ("pinion", "gear")}
    return lumped.load_gear_pair("nasa_28_28").with_(both | {
        "centre_distance": None, "basic_rack.module": "2.5 mm", "basic_rack.fillet_radius_coefficient": 0.38,
        "pinion.teeth": 19, "gear.teeth": 41, "mesh.backlash": "0.115 mm", "mesh.contact": "prescribed",
        "mesh.damping_ratio": 0.04, "mesh.relief": "ignored", "friction.law": "none",
        "operating.pinion_torque": 80.0, "operating.pinion_speed": "26000 rpm",
    })  # fmt: skip


def at(pair, rpm):
    return pair.with_({"operating.pinion_speed": rpm})


@pytest.fixture(scope="module")
def branches(pair):
    return floquet.response_branches(pair, (25600.0, 28500.0))


def test_beats_beside_a_stable_motion_are_found_and_told(branches):
    """The only stable motion ends at a fold.

    There the pair jumps to beats, which exist below the fold too.
    """
    (up,) = [jump for jump in branches.jumps if jump.rising]
    assert up.after == "beats"
    assert up.speed_rpm == pytest.approx(27523.69, abs=0.01)
    (beats,) = branches.attractors
    assert (beats.low_rpm, beats.high_rpm) == branches.speeds_rpm
    assert beats.kind == "beats"
    assert beats.exponent_interval[0] < 0.0 < beats.exponent_interval[1] < 0.05
    assert any(o.stable for o in branches.at(26000.0))
    # A run of its own from each point stays there: the size is that of many more cycles.
    for point in beats.points[::2]:
        there = at(branches.pair, point.speed_rpm)
        state, torque = start_of(there, None)
        state[0] += 30e-6
        system = unilateral_system(there)
        T = there.geometry.mesh_period
        run = system.run(system.run(state, T, 1500, torque).end, T, 1500, torque)
        assert point.dte_rms == pytest.approx(run.rms, rel=0.02)
        assert point.dte_peak_to_peak == pytest.approx(run.most - run.least, rel=0.05)
    table = branches.dataset
    assert table["attractor_dte_rms"].to_numpy() == pytest.approx([point.dte_rms for point in beats.points])


def test_beats_begin_where_the_motion_that_repeats_loses_its_stability(pair):
    """At the Neimark-Sacker point at 33,129.5 rpm the beats shrink to the motion: an end, and no jump."""
    one = floquet.response_branches(pair, (32500.0, 33500.0))
    (point,) = [b for b in one.bifurcations if b.kind == "Neimark-Sacker" and b.n == 1]
    (beats,) = one.attractors
    assert beats.high_rpm == pytest.approx(point.speed_rpm, rel=1e-12)
    assert not one.jumps


def test_chaos_ends_in_a_jump_down(pair):
    """64 runs each: at 20,300 rpm all stay for 20,000 cycles, at 19,800 nearly all leave within 1000."""
    one = floquet.response_branches(pair, (19500.0, 20700.0), (1, 2, 3))
    (down,) = [jump for jump in one.jumps if not jump.rising]
    assert 19800.0 < down.speed_rpm < 20300.0
    assert down.n == 0
    assert down.after == "periodic"
    assert down.dte_rms > 6.0 * down.dte_rms_after
    (chaos,) = [a for a in one.attractors if a.high_rpm == 20700.0]
    assert chaos.kind == "chaos"
    assert chaos.exponent_interval[0] > 0.0
    assert chaos.low_rpm == down.speed_rpm
    low, high = sorted([chaos.rms[1], one.at(20500.0)[0].dte_rms])
    basins = one.basins(20500.0, starts=200)
    assert [basin.kind for basin in sorted(basins, key=lambda b: b.dte_rms)] == ["periodic", "chaos"]
    assert sum(basin.starts for basin in basins) == 200
    assert [min(b.dte_rms for b in basins), max(b.dte_rms for b in basins)] == pytest.approx(
        [low, high], rel=0.1
    )


@pytest.mark.parametrize("settle_cycles", [60, 200])
def test_a_run_is_followed_until_it_repeats_even_after_many_cycles(pair, settle_cycles):
    """At 18,400 rpm the motion of three cycles is stable: looked for with one, it is no beats."""
    there = at(pair, 18400.0)
    system = unilateral_system(there)
    T = there.geometry.mesh_period
    state, torque = start_of(there, None)
    run = long_run(system, state + 20e-6 * np.eye(6)[0], T, torque, settle=settle_cycles, most_cycles=1)
    assert run.kind == "periodic"


def test_stability_is_lost_on_one_side_only(pair):
    """A doubling and a Neimark-Sacker point lie 24 rpm apart: between them the motion is unstable already."""
    one = floquet.response_branches(pair, (15900.0, 16900.0), (1,))
    places = [(branch, b.orbit) for branch in one.branches for b, _ in lost_stability(branch)]
    points = [16061.78, 16820.95]
    assert sorted(one._rpm(orbit) for _, orbit in places if orbit.run.rms > 50e-6) == pytest.approx(
        points, abs=0.01
    )
    for branch, orbit in places:
        if orbit.run.rms > 50e-6:
            near = [branch.at(orbit.period * (1.0 + side)) for side in (-3e-4, 3e-4)]
            sides = [min(o, key=lambda o: abs(o.run.rms - orbit.run.rms)).stable for o in near]
            assert sorted(sides) == [False, True]


def test_shares_of_starts_are_those_of_plain_runs(branches):
    """The share with another seed lies in the interval. Starts settle one by one to the same motions."""
    basins = branches.basins(26000.0, starts=256)
    assert sum(basin.share for basin in basins) == pytest.approx(1.0)
    again = {basin.kind: basin for basin in branches.basins(26000.0, starts=256, seed=2)}
    for basin in basins:
        low, high = binomtest(basin.starts, 256).proportion_ci(0.95)
        assert basin.share_interval == pytest.approx((low, high), abs=1e-9)
        assert low < again[basin.kind].share < high
    rate = 26000.0 / (branches.pair.geometry.mesh_period * 26000.0)
    places = np.random.default_rng(1).uniform(size=(256, 2))
    starts = branches.member.apart(rate, places)[:24]
    states = np.array([s for _, s, _ in starts])
    torques = np.array([p for _, _, p in starts])
    periods = np.full(24, 1.0 / rate)
    settled = settle(branches.member.family, branches.member.limits, states, periods, torques)
    system = branches.member.family.at(1.0 / rate)
    for j, state in enumerate(states):
        run = system.run(system.run(state, 1.0 / rate, 200, torques[j]).end, 1.0 / rate, 128, torques[j])
        assert settled.rms[j] == pytest.approx(run.rms, rel=0.1), j
    assert binomial_interval(0, 50)[0] == 0.0
    assert binomial_interval(50, 50)[1] == 1.0
    with pytest.raises(ParameterError, match="starts"):
        branches.basins(26000.0, starts=0)


@pytest.fixture(scope="module")
def bouncing(pair):
    """A motion of one cycle of the unequal pair that loses contact, found by Newton's method."""
    there = at(pair, 16169.0)
    one = floquet.response_branches(there, (16000.0, 16300.0), (1,))
    orbit = max((o for o in one.at(16169.0) if o.stable), key=lambda o: o.dte_rms)
    assert orbit.contact_lost
    return orbit


def test_sizes_of_a_motion_are_those_of_its_samples(bouncing):
    """Extremes between samples by parabolas: at 4096 samples a cycle they differ by 1e-6 of the range."""
    motion = bouncing.sampled(4096)
    dte = motion["dte"].to_numpy()
    load = motion["normal_load"].to_numpy()
    assert np.ptp(bouncing.dte_range) == pytest.approx(np.ptp(dte), rel=1e-5)
    assert bouncing.dte_rms == pytest.approx(np.std(dte), rel=1e-5)
    assert bouncing.largest_load == pytest.approx(load.max(), rel=1e-2)
    assert bouncing.largest_load >= load.max() * (1.0 - 1e-12)


def test_the_mean_load_is_that_of_the_torque(bouncing):
    """Momentum of the pinion over a period without friction: the mean mesh force is T_p / r_bp."""
    load = bouncing.sampled(4096)["normal_load"].sum("pair").to_numpy()
    pair = bouncing.pair
    force = pair.operating.pinion_torque / pair.geometry.base_radius_pinion
    assert load.mean() == pytest.approx(force, rel=3e-3)  # a load that jumps, by the rectangular rule


def test_the_spectral_radius_is_that_of_runs_beside_the_motion(bouncing):
    """Central differences of runs without derivatives, through impacts."""
    o = bouncing.orbit
    steps = 1e-6 * np.repeat([np.abs(half).max() for half in (o.start[:3], o.start[3:])], 3)

    def end(change):
        return o.system.run(o.start + change, o.period, o.n, o.parameter).end

    columns = [(end(step) - end(-step)) / (2.0 * np.abs(step).max()) for step in np.diag(steps)]
    radius = np.abs(np.linalg.eigvals(np.array(columns).T)).max()
    assert bouncing.spectral_radius == pytest.approx(radius, rel=1e-5)
