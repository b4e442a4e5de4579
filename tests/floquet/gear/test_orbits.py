"""Are motions beyond contact loss what a closed fact, a symmetry or the linear model says?"""

import numpy as np
import pytest

import floquet
import lumped
from floquet.gear.unilateral import _coast_flank, unilateral_family, unilateral_system
from lumped import NumericalError, ParameterError
from lumped.model.equations import structure
from lumped.model.mesh_cycle import MeshCycle
from tests.unlike_pairs import UNLIKE, unlike_pair
from validation.exchange.new_pair_file import new_pair


@pytest.fixture(scope="module")
def frictionless():
    return lumped.load_gear_pair("nasa_28_28").with_(
        mesh__contact="prescribed", mesh__damping_ratio=0.05, mesh__relief="ignored", friction__law="none"
    )


def at(pair, rpm):
    return pair.with_({"operating.pinion_speed": rpm})


@pytest.mark.parametrize(("name", "brake"), [
    ("rack_25_degrees_always_pushing", "balanced"), ("larger_gear_drives_contact_lost", 27.8),
])  # fmt: skip
def test_where_contact_holds_it_is_the_linear_motion(name, brake):
    """With friction that depends on speed, and with either torque as the unknown."""
    pair = unlike_pair(name).with_(mesh__contact="prescribed", operating__brake_torque=brake)
    orbit = floquet.periodic_orbit(pair)
    linear = lumped.steady_state(pair, samples_per_cycle=256)
    assert not orbit.contact_lost
    span = float(np.ptp(linear.dte.values))
    # Rounding of the states, larger by the cycles in which a disturbance decays: 2e-11 with light damping.
    assert orbit.motion.dte.values == pytest.approx(linear.dte.values[:256], abs=1e-10 * span)
    assert orbit.motion.attrs["dte_peak_to_peak"] == pytest.approx(linear.attrs["dte_peak_to_peak"], rel=1e-6)
    for name in ("y_p", "y_g", "bearing_force_y_g", "friction_force"):
        values = orbit.motion[name].values
        expected = linear[name].values[..., :256]
        assert values == pytest.approx(expected, abs=1e-9 * np.ptp(expected)), name
    assert orbit.motion.normal_load.sum("pair").values == pytest.approx(
        linear.normal_load.sum("pair").values[:256], rel=1e-9
    )
    multipliers = floquet.monodromy(floquet.gear_pair_system(pair, "mesh")).multipliers
    assert orbit.spectral_radius == pytest.approx(np.abs(multipliers).max(), abs=1e-9)
    torque = linear.attrs["brake_torque" if brake == "balanced" else "pinion_torque"]
    assert orbit.orbit.parameter == pytest.approx(torque, rel=1e-10)


def test_a_motion_changes_little_with_the_torque():
    """58/58 at 120 N m: a piece of a law as short as rounding once let a contact change its state for ever.

    Between torques 1 % apart nothing happens, so the largest multiplier and the motion lie between those of
    the neighbours.
    """
    pair = new_pair((58, 58), 2.3, 13.5, 910, 120)
    below, orbit, above = (
        floquet.periodic_orbit(pair.with_(operating__pinion_torque=torque))
        for torque in (119.0, 120.0, 121.0)
    )
    assert orbit.contact_lost
    assert orbit.stable
    middle = 0.5 * (below.spectral_radius + above.spectral_radius)
    assert orbit.spectral_radius == pytest.approx(middle, abs=1e-5)
    assert orbit.dte_rms == pytest.approx(0.5 * (below.dte_rms + above.dte_rms), rel=1e-4)
    assert floquet.long_run(pair).kind == "periodic"


def test_without_clearance_motions_are_proportional_to_the_torque(frictionless):
    """Gaps and impacts included: the model is homogeneous, so multipliers stay."""
    pair = at(frictionless, 8000.0)
    one = floquet.periodic_orbit(pair)
    two = floquet.periodic_orbit(pair.with_(operating__pinion_torque=3.0 * 56.5))
    assert one.contact_lost
    assert one.spectral_radius == pytest.approx(two.spectral_radius, rel=1e-9)
    assert two.dte_rms == pytest.approx(3.0 * one.dte_rms, rel=1e-9)
    assert one.events[:, 1:] == pytest.approx(two.events[:, 1:])


def test_slow_motion_with_relief_is_the_static_transmission_error():
    """Clearance decides about contact itself; the static model knows which pairs touch."""
    changes = {"mesh.contact": "prescribed", "mesh.relief": "static", "friction.law": "none"}
    changes |= {"operating.pinion_speed": 10.0, "mesh.damping_ratio": 0.05}
    pair = lumped.load_gear_pair("nasa_28_28").with_(changes)
    static = lumped.static_transmission_error(pair)["transmission_error"].values
    assert floquet.periodic_orbit(pair).dte_rms == pytest.approx(np.std(static), rel=2e-3)
    # In a long cycle the rigid rotation gathers more rounding of the torque than a state may be off.
    assert floquet.periodic_orbit(pair.with_(friction__law="coulomb")).stable


@pytest.fixture(scope="module")
def branches(frictionless):
    return floquet.response_branches(frictionless, (8400.0, 19500.0), (1, 2), seeds=0)


def test_one_switch_in_contact_repeats_as_two_cycles_at_twice_the_speed(branches):
    """The single jump of the stiffness in contact does not decide to which cycle the jump belongs."""
    bifurcations = [b for b in branches.bifurcations if b.sharp]
    for kind in ("fold", "period doubling"):
        single = max((b for b in bifurcations if (b.n, b.kind) == (1, kind)), key=lambda b: b.dte_rms)
        double = [b for b in bifurcations if (b.n, b.kind) == (2, kind)]
        nearest = min(double, key=lambda b: abs(b.speed_rpm - 2.0 * single.speed_rpm))
        assert nearest.speed_rpm == pytest.approx(2.0 * single.speed_rpm, rel=1e-9)
        assert nearest.dte_rms == pytest.approx(single.dte_rms, rel=1e-8)


def test_all_motions_at_a_speed_and_their_stability(branches):
    """Between the folds there are three motions of one cycle, the middle one unstable."""
    folds = sorted(b.speed_rpm for b in branches.bifurcations if b.kind == "fold" and b.n == 1)
    assert len(folds) == 2
    inside, outside = ([o for o in branches.at(rpm) if o.n == 1] for rpm in (np.mean(folds), folds[1] + 300))
    assert len(inside) == 3
    assert len(outside) == 1
    assert not sorted(inside, key=lambda o: o.dte_rms)[1].stable
    again = floquet.periodic_orbit(inside[0].pair, start=inside[0].states[0])
    assert again.dte_rms == pytest.approx(inside[0].dte_rms, rel=1e-9)
    table = branches.dataset
    assert table.sizes["point"] == sum(len(branch.orbits) for branch in branches.branches)
    assert {"m", "rpm", "N", "1"} >= {table[name].attrs["units"] for name in table}


def test_between_the_neimark_sacker_points_the_run_beats(branches, frictionless):
    points = sorted(b.speed_rpm for b in branches.bifurcations if b.kind == "Neimark-Sacker" and b.n == 1)
    assert len(points) == 2
    run = floquet.long_run(at(frictionless, np.mean(points)), settle_cycles=50, cycles=400)
    assert run.kind == "beats"
    assert abs(run.exponent) < 3.0 * run.uncertainty + 5e-3
    settled = floquet.long_run(at(frictionless, points[1] + 700.0), settle_cycles=50)
    assert settled.kind == "periodic"
    assert settled.orbit.stable


@pytest.mark.parametrize("name", [n for n in UNLIKE if unlike_pair(n).healthy is unlike_pair(n)])
def test_friction_over_speed_is_that_fitted_at_each_speed(name):
    """Each pair has a law of its own."""
    pair = unlike_pair(name)
    family = unilateral_family(pair, 1000.0, 21000.0)
    there = at(pair, 7890.0)
    T = there.geometry.mesh_period
    state = np.array([3e-6, 1e-6, -1e-6, 1e-5, 2e-5, 0.0])
    one, two = (s.run(state, T, 1, 56.0, derivatives=True) for s in (family.at(T), unilateral_system(there)))
    assert one.end == pytest.approx(two.end, rel=1e-10)
    assert one.derivative == pytest.approx(two.derivative, rel=1e-9, abs=1e-9 * np.abs(two.derivative).max())


def test_what_is_no_start_or_range_is_refused(frictionless):
    with pytest.raises(ParameterError, match="12 states"):
        floquet.periodic_orbit(frictionless, start=[1.0, 2.0])
    with pytest.raises(ParameterError, match="slowest and fastest"):
        floquet.response_branches(frictionless, (3000.0, 1000.0))
    with pytest.raises(ParameterError, match="periods"):
        floquet.response_branches(frictionless, (1000.0, 3000.0), (0,))
    with pytest.raises(NumericalError, match="no motion of 3 cycles"):
        floquet.periodic_orbit(at(frictionless, 8600.0), 3, start=np.eye(12)[0] * 2.4e-3)


def test_a_jump_leads_from_one_branch_to_another(branches):
    """On running down the pair falls onto the small motion, which ends at the fold on running up."""
    (down,) = [j for j in branches.jumps if not j.rising and j.speed_rpm < 10000.0]
    (up,) = [j for j in branches.jumps if j.rising and j.n == 1]
    low = min(o.dte_rms for o in branches.at(down.speed_rpm * 0.999) if o.stable)
    # The run behind the jump is at T 0.1 % longer, this one at a speed 0.1 % lower.
    assert down.dte_rms_after == pytest.approx(low, rel=1e-5)
    assert down.dte_rms > 5.0 * down.dte_rms_after
    assert up.speed_rpm == pytest.approx(
        max(b.speed_rpm for b in branches.bifurcations if b.kind == "fold" and b.n == 1)
    )


def test_back_sides_push_as_the_mirror_image_of_the_driving_flanks_in_the_line_of_centres(frictionless):
    pair = frictionless.with_(centre_distance=89.7)
    angle = pair.geometry.operating_pressure_angle
    cycle = MeshCycle.of(pair)
    drive = structure(pair)
    centres = np.array([np.sin(angle), np.cos(angle)])
    mirror = 2.0 * np.outer(centres, centres) - np.eye(2)
    coast = _coast_flank(pair, cycle, np.eye(6))
    for driving, coasting in ((drive.normal, coast.normal), (drive.apart, coast.apart)):
        for gear in ([2, 4], [3, 5]):
            assert coasting[gear] == pytest.approx(mirror @ driving[gear], abs=1e-12)


def test_with_back_sides_a_motion_larger_than_the_backlash_is_another(frictionless):
    """The large motion strikes both flanks. A motion within the backlash does not depend on back sides."""
    small = floquet.periodic_orbit(at(frictionless, 8000.0), back_side=True)
    assert small.dte_rms == pytest.approx(floquet.periodic_orbit(small.pair).dte_rms, rel=1e-9)
    assert small.multipliers.size == 10
    # At 10000 rpm both gears can be thrown from flank to flank (docs/theory/orbits.md).
    start = np.zeros(12)
    start[[0, 6]] = np.array([5e-4, 3.0]) / small.pair.geometry.base_radius_pinion
    run = floquet.long_run(at(frictionless, 10000.0), start, settle_cycles=100, cycles=64, back_side=True)
    assert run.kind == "periodic"
    assert run.run.least < -small.pair.geometry.normal_backlash


@pytest.fixture(scope="module")
def over_torque(frictionless):
    axes = {"speed_rpm": np.linspace(8400.0, 19500.0, 75), "torque": [30.0, 90.0]}
    return floquet.jump_map(frictionless, axes)


def test_without_clearance_the_jump_map_does_not_depend_on_torque(over_torque):
    """The model is homogeneous: the same motions at the same speeds, in proportion to the torque."""
    one, two = (over_torque.isel(torque=j) for j in (0, 1))
    assert one["motions"].to_numpy() == pytest.approx(two["motions"].to_numpy())
    assert one["contact_kept"].to_numpy() == pytest.approx(two["contact_kept"].to_numpy())
    # Interpolated along a branch whose motions need not be at the same speeds; beats are other runs.
    periodic = one["motions"].to_numpy() > 0
    for name in ("dte_rms_smallest", "dte_rms_largest", "largest_load"):
        assert two[name].to_numpy()[periodic] == pytest.approx(3.0 * one[name].to_numpy()[periodic], rel=1e-3)
    speeds = [over_torque["jump_speed_rpm"][over_torque["jump_torque"] == t] for t in (30.0, 90.0)]
    assert speeds[0].to_numpy() == pytest.approx(speeds[1].to_numpy(), rel=1e-9)


def test_a_jump_map_has_the_motions_and_jumps_of_the_branches(over_torque, branches, frictionless):
    row = over_torque.isel(torque=1)
    for j in (6, 20, 36, 70):  # one motion, two, beats, two of which one repeats after two cycles
        stable_orbits = [o for o in branches.at(float(row["speed_rpm"][j])) if o.stable]
        assert int(row["motions"][j]) == len(stable_orbits)
        if stable_orbits:
            sizes = [o.dte_rms * 90.0 / 56.5 for o in stable_orbits]
            assert float(row["dte_rms_smallest"][j]) == pytest.approx(min(sizes), rel=1e-4)
            assert float(row["dte_rms_largest"][j]) == pytest.approx(max(sizes), rel=1e-4)
    jumps = over_torque["jump_speed_rpm"][over_torque["jump_torque"] == 90.0].to_numpy()
    assert jumps == pytest.approx([jump.speed_rpm for jump in branches.jumps], rel=1e-9)
    # Where there is one motion, it keeps contact just where the linear one needs no pull.
    one = row["motions"].to_numpy() == 1
    pull = lumped.speed_sweep(frictionless, row["speed_rpm"].to_numpy())["normal_load_min"].to_numpy() < 0.0
    assert row["contact_kept"].to_numpy()[one].tolist() == (~pull[one]).tolist()
    assert 0 < pull[one].sum() < one.sum()


def test_what_a_jump_map_cannot_vary_is_refused(frictionless):
    speeds = [1000.0, 2000.0]
    for axes, text in (
        ({"speed_rpm": speeds}, "speed_rpm and one of torque"),
        ({"speed_rpm": speeds, "contact_ratio": [1.5]}, "speed_rpm and one of torque"),
        ({"speed_rpm": speeds, "damping_ratio": [1.5]}, "damping_ratio"),
        ({"speed_rpm": speeds, "tip_relief": [10.0]}, "tip relief that acts"),
        ({"speed_rpm": [1000.0], "torque": [10.0]}, "two or more"),
    ):
        with pytest.raises(ParameterError, match=text):
            floquet.jump_map(frictionless, axes)


def test_contact_is_kept_where_all_motions_and_all_runs_keep_it(frictionless):
    with_contact = floquet.response_branches(frictionless, (4400.0, 4600.0), (1,), seeds=2)
    assert with_contact.contact_kept
    assert with_contact.response.runs == 32
    assert not floquet.response_branches(frictionless, (8000.0, 8100.0), (1,), seeds=0).contact_kept
