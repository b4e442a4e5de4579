"""Is the element of the mesh a mechanical one: energy, symmetry, geometry of corners, powers, limits?"""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import minimize_scalar

from lumped.mesh.records import AT_REST, BY_APPROACH, BY_RATE
from lumped.model.equations import structure
from tests.lumped.mesh.element_calls import Mesh, corner_at

#: Unlike pairs whose loads move each other; the outer two are beyond the ends of their flanks, on corners.
COUPLED = {"stiffness": [2.4e8, 3.1e8, 2.7e8], "softening": 1.3e-10, "coupled": True, "lengthening": 3e-6}
WITH_CORNERS = [0.00795, 0.0150, 0.02358]
NEIGHBOURS = np.array([[0.0, 5e-10, 1e-10], [5e-10, 0.0, 7e-10], [1e-10, 7e-10, 0.0]])


def coupled(position=WITH_CORNERS, **more):
    return Mesh(position, NEIGHBOURS, **(COUPLED | more))


def complementary_energy(mesh, loads):
    """Sum of the integrals of N c(N), and of w_ij N_i N_j over pairs of neighbours."""
    law = mesh.law
    total = 0.5 * loads @ mesh.coupling @ loads
    for load, stiffness in zip(loads, mesh.pairs["stiffness"], strict=True):
        total += quad(
            lambda n, k=stiffness: n / k
            - 0.5 * n * law.softening * np.log((n**2 + law.linear_below**2) / law.force**2),
            0.0, load, epsrel=1e-13,
        )[0]  # fmt: skip
    return total


def energy(mesh, approach):
    """U = sum N p - C of all pairs, from loads and compressions of the element."""
    loads = mesh.loads(approach)
    return loads @ np.where(loads > 0.0, mesh.contacts["compression"], 0.0) - complementary_energy(
        mesh, loads
    )


@pytest.mark.parametrize("approach", [4e-6, 9e-6, 2e-5])
def test_loads_are_the_slope_of_an_energy(approach):
    """dU/ddelta = sum N_i dp_i/ddelta, with the corners' share of the compressions."""
    mesh = coupled()
    h = 1e-4 * approach
    slope = (energy(mesh, approach + h) - energy(mesh, approach - h)) / (2.0 * h)
    loads = mesh.loads(approach)
    assert (loads > 0.0).all()
    compression_share = 1.0 - mesh.contacts["gap_by_approach"]
    assert np.abs(compression_share - 1.0).max() > 1e-3
    # Central differences err with h^2: 1e-8, and by rounding of energies over h: 1e-12.
    assert slope == pytest.approx(loads @ compression_share, rel=1e-7)


def test_a_pair_moves_its_neighbour_as_this_one_moves_it():
    """dN_i/dp_j = dN_j/dp_i, and a common compression moves each pair by the sum of its row."""
    approach = 1.2e-5
    h = 1e-9
    matrix = np.empty((3, 3))
    for j in range(3):
        loads = []
        for sign in (1.0, -1.0):
            mesh = coupled()
            mesh.pairs["gap"][j] -= sign * h
            loads.append(mesh.loads(approach))
        matrix[:, j] = (loads[0] - loads[1]) / (2.0 * h)
    mesh = coupled()
    mesh.loads(approach)
    coupling = np.abs(matrix - np.diag(np.diag(matrix))).max()
    assert matrix == pytest.approx(matrix.T, abs=1e-6 * coupling)  # differences: h over 1e-5, squared
    assert matrix.sum(axis=1) == pytest.approx(mesh.contacts["tangent"], rel=1e-6)


def test_newton_steps_start_on_the_tangent():
    """The tangent errs with the square of a change of the approach, so one Newton step errs with the fourth
    power: half the change, a sixteenth of the error. From the former load it is a quarter.
    """
    approach = 1.2e-5
    inside = [0.0095, 0.0150, 0.0210]
    errors = []
    for change in (4e-7, 2e-7):
        mesh = coupled(inside)
        mesh.loads(approach)
        mesh.law = mesh.law._replace(converged=1e9)  # one step
        one_step = mesh.loads(approach + change)
        errors.append(np.abs(one_step - coupled(inside).loads(approach + change)).max())
    assert errors[0] / errors[1] == pytest.approx(16.0, rel=0.1)


@pytest.mark.parametrize("beyond", [2e-5, 3e-4, 9e-4])
@pytest.mark.parametrize("radii", [(0.040, 0.075), (0.075, 0.040)])
def test_corner_gap_is_the_distance_of_two_involutes(beyond, radii):
    """The corner of the mate against the nearest point of the flank, both drawn in the plane."""
    flank, tip = radii
    length = 0.042
    corner = 0.034
    # Axes from the flank's centre: n away from it through the tangent point, t along the line of action.
    mate = np.array([length, flank + tip])
    # The mate's flank crosses the line corner + beyond from its tangent point; its corner has turned on.
    turn = beyond / tip
    corner_arm = np.array([-corner, -tip])
    turned_arm = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]) @ corner_arm
    corner_point = mate + turned_arm

    def point(string, crossing):
        """Of the flank that crosses the line at ``crossing``: the end of a string of another length."""
        angle = (crossing - string) / flank  # by which the string's tangent point is ahead of the line
        n = np.cos(angle)
        t = np.sin(angle)
        return np.array([flank * t + string * n, flank * n - string * t])

    crossing = length - corner - beyond
    near = minimize_scalar(
        lambda string: np.hypot(*(point(string, crossing) - corner_point)),
        bounds=(0.5 * crossing, 2.0 * crossing), method="bounded", options={"xatol": 1e-14},
    )  # fmt: skip
    contact = corner_at(beyond, corner, length, flank, tip)
    assert contact.gap == pytest.approx(near.fun, rel=1e-6, abs=1e-12)
    # The normal of the flank is the string, which pushes the corner away from the mate's centre.
    assert contact.tilt == pytest.approx(np.sin((near.x - crossing) / flank), rel=1e-5)
    h = 1e-7
    ends = [corner_at(beyond + s, corner, length, flank, tip).gap for s in (h, -h)]
    assert contact.slope == pytest.approx((ends[0] - ends[1]) / (2.0 * h), rel=1e-5)


def test_deflected_teeth_touch_further_outside_by_half_of_what_approach_and_bearings_add():
    start, _, length = Mesh.ENDS[:3]
    radii = Mesh.LAW.radius_pinion, Mesh.LAW.radius_gear
    for inside in (100e-6, 60e-6):  # half of 140 and 20 um is 80 um
        mesh = Mesh([start + inside], lengthening=20e-6)
        mesh.loads(140e-6)
        beyond = 80e-6 - inside
        expected = corner_at(beyond, length - start, length + 20e-6, *radii)[0] if beyond > 0.0 else 0.0
        assert mesh.contacts["gap"][0] == pytest.approx(expected, rel=1e-9, abs=0.0)


@pytest.mark.parametrize("approach", [9e-6, 2e-5])
def test_slopes_of_the_gap_are_those_of_the_gap(approach):
    h = 1e-8
    for moves, field in ((0.0, "gap_by_approach"), (1.0, "gap_by_position")):
        ends = []
        for s in (h, -h):
            mesh = coupled(np.array(WITH_CORNERS) + moves * s)
            mesh.loads(approach + (1.0 - moves) * s)
            ends.append(mesh.contacts["gap"].copy())
        mesh = coupled()
        mesh.loads(approach)
        slope = (ends[0] - ends[1]) / (2.0 * h)
        assert np.abs(slope).max() > 1e-3
        assert mesh.contacts[field] == pytest.approx(slope, abs=1e-6 * np.abs(slope).max())


def test_forces_do_no_work_when_both_gears_move_as_one(unlike):
    """Newton's third law, of forces and moments: translations, and a rotation about the pinion's centre.

    The moment of the force of a tip corner is path work, which the lumped model leaves out.
    """
    s = structure(unlike)
    g = unlike.geometry
    turn = [1.0, -1.0, 0.0, g.base_radius_pinion + g.base_radius_gear, 0.0, -g.L_XY]
    rigid = np.array([[0.0, 0.0, 1.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0, 1.0, 1.0], turn])
    small = 1e-12 * g.L_XY
    assert rigid @ s.normal == pytest.approx(np.zeros(3), abs=small)
    assert rigid[:2] @ s.apart == pytest.approx(np.zeros(2), abs=small)
    for position in (g.L_XA, g.L_XP, g.L_XD):
        assert rigid @ s.friction(position) == pytest.approx(np.zeros(3), abs=small)
    assert rigid @ s.deflection == pytest.approx(np.zeros(3), abs=small)


class TestDampers:
    def test_what_they_take_is_what_a_bouncing_pair_loses(self):
        """m delta'' = F - N without rolling, so fast that the teeth part: N = 0 while they still expand."""
        mass = 2.0
        k = 3e8
        c = 6e3
        force = 3000.0
        speed = 1.0
        mesh = Mesh([0.015], stiffness=k, damping=c, full_damper=200.0, rolling_speed=0.0, force=force)
        state = np.array([force / k, speed])
        h = 1e-7
        lost = 0.0
        clipped = 0

        def rates(x):
            forces = mesh.force(*x)
            return np.array([x[1], (force - forces.normal) / mass]), forces.damper_power

        def stored(x):
            return 0.5 * mass * x[1] ** 2 + 0.5 * k * max(x[0], 0.0) ** 2 - force * x[0]

        start = stored(state)
        for _ in range(6000):
            stages = []
            powers = []
            for part in (0.0, 0.5, 0.5, 1.0):
                rate, power = rates(state + part * h * (stages[-1] if stages else 0.0))
                stages.append(rate)
                powers.append(power)
            clipped += mesh.contacts["load"][0] > 0.0 and mesh.normal[0] == 0.0
            weights = np.array([1.0, 2.0, 2.0, 1.0]) * h / 6.0
            state = state + weights @ np.array(stages)
            lost = lost + weights @ np.array(powers)
        assert clipped > 20
        # Kinks inside steps leave some 1e-5 of the loss.
        assert start - stored(state) == pytest.approx(lost, rel=1e-4)
        assert lost > 0.1 * 0.5 * mass * speed**2

    def test_they_begin_and_become_full_smoothly(self):
        mesh = Mesh([0.015], stiffness=1e8, damping=5e3, full_damper=200.0)
        load = np.array([1e-3, 50.0, 100.0, 200.0 - 1e-3, 300.0])
        at_zero, at_quarter, at_half, near_full, beyond = (
            (mesh.force(n / 1e8, 0.1).normal - n) / (5e3 * 0.1) for n in load
        )
        assert at_zero == pytest.approx(0.0, abs=1e-9)
        assert at_half == pytest.approx(0.5, rel=1e-9)  # the smooth step is odd about its middle
        assert at_quarter == pytest.approx(3.0 / 16.0 - 2.0 / 64.0, rel=1e-9)
        assert [near_full, beyond] == pytest.approx([1.0, 1.0], abs=1e-9)

    def test_they_act_on_the_rate_of_the_compression(self):
        """p' = d(delta - gap)/dt by differences of the gap, with approach and contact both moving."""
        rolling = 6.0
        approach_rate = 0.4
        approach = 2e-5
        h = 1e-9
        gaps = []
        for s in (h, -h):
            mesh = coupled(np.array(WITH_CORNERS) + rolling * s)
            mesh.loads(approach + approach_rate * s)
            gaps.append(mesh.contacts["gap"].copy())
        rate = approach_rate - (gaps[0] - gaps[1]) / (2.0 * h)
        mesh = coupled(damping=[3e3, 5e3, 2e3], rolling_speed=rolling)
        elastic = mesh.loads(approach)
        forces = mesh.force(approach, approach_rate)
        assert mesh.normal - elastic == pytest.approx(mesh.pairs["damping"] * rate, rel=1e-5)
        assert forces.damper_power == pytest.approx(mesh.pairs["damping"] @ rate**2, rel=1e-5)
        assert np.abs(rate / approach_rate - 1.0).max() > 0.04


def test_friction_is_mu_times_each_load_at_its_own_arm():
    mu = np.array([-0.05, 0.02, 0.07])
    mesh = coupled(mu=mu, damping=4e3)
    forces = mesh.force(1.5e-5, 0.2)
    assert forces.normal == pytest.approx(mesh.normal.sum())
    assert forces.friction_force == pytest.approx(mu @ mesh.normal)
    assert forces.friction_moment == pytest.approx((mu * WITH_CORNERS) @ mesh.normal)
    assert forces.separating == pytest.approx(mesh.contacts["tilt"] @ mesh.normal)
    assert mesh.contacts["tilt"][[0, 2]].min() > 0.0  # both corners push the gears apart
    assert mesh.contacts["tilt"][1] == 0.0


class TestLimits:
    def test_one_pair_without_softening_is_a_spring_that_pushes(self):
        mesh = Mesh([0.015], stiffness=2e8, force=3000.0)
        assert mesh.loads(1e-5) == pytest.approx([2000.0])
        assert mesh.loads(-1e-5) == [0.0]
        assert mesh.static() == pytest.approx(1.5e-5, rel=1e-12)
        forces, state, _ = mesh.linear()
        assert forces["normal"] == pytest.approx([2e8, 0.0, 0.0], abs=1e-6)
        assert state["approach"] == pytest.approx(1.5e-5, rel=1e-12)

    def test_in_its_window_a_pair_pulls_with_its_whole_damper(self):
        mesh = Mesh([0.001], stiffness=2e8, damping=5e3, gap=2e-6, prescribed=True)  # far outside its flanks
        assert mesh.loads(-1e-5) == pytest.approx([-2400.0])
        assert mesh.force(1.2e-5, 0.1).normal == pytest.approx(2000.0 + 500.0)
        assert mesh.force(1e-6, 0.1).normal == pytest.approx(300.0)
        assert mesh.force(-1e-5, 0.1).normal == 0.0  # the motion by momentary load does not pull
        forces, _, loads = mesh.linear()
        assert forces["normal"] == pytest.approx([2e8, 5e3, -400.0])
        assert loads["at_rest"] == pytest.approx([-400.0])

    def test_a_pair_that_carries_the_mean_load_has_the_stiffness_of_the_table(self):
        mesh = Mesh([0.015], stiffness=2e8, softening=2e-10, force=3000.0, linear_below=1e-3)
        assert mesh.static() == pytest.approx(3000.0 / 2e8, rel=1e-12)
        assert mesh.contacts["tangent"] == pytest.approx([1.0 / (1.0 / 2e8 - 2e-10)], rel=1e-9)

    def test_nothing_carries_the_force_without_pairs(self):
        assert np.isnan(Mesh([0.015], stiffness=0.0).static())


class TestLinearForm:
    def test_at_the_static_approach_it_is_the_force_itself(self):
        mesh = coupled(mu=[-0.05, 0.02, 0.07], damping=[3e3, 5e3, 2e3], rolling_speed=6.0)
        forces, state, loads = mesh.linear()
        for rate in (0.0, 0.02):
            exact = mesh.force(state["approach"], rate)
            for name in forces.dtype.names:
                by_approach, by_rate, at_rest = forces[name]
                linear = by_approach * state["approach"] + by_rate * rate + at_rest
                assert linear == pytest.approx(getattr(exact, name), rel=1e-9), name
            each = loads["by_approach"] * state["approach"] + loads["by_rate"] * rate + loads["at_rest"]
            assert each == pytest.approx(mesh.normal, rel=1e-9)
            taken = (state["damper_by_square"] * rate + state["damper_by_rate"]) * rate
            assert taken + state["damper_at_rest"] == pytest.approx(exact.damper_power, rel=1e-9)
        assert loads["static"].sum() == pytest.approx(mesh.law.force, rel=1e-12)

    def test_its_stiffness_is_the_slope_of_the_loads_over_a_common_compression(self):
        mesh = coupled(mu=[-0.05, 0.02, 0.07])
        h = 1e-9
        forces, state, _ = mesh.linear()
        ends = []
        for sign in (1.0, -1.0):
            compressed = coupled(mu=[-0.05, 0.02, 0.07])
            compressed.pairs["gap"] -= sign * h
            ends.append(compressed.force(state["approach"], 0.0))
        for name in forces.dtype.names:
            slope = (getattr(ends[0], name) - getattr(ends[1], name)) / (2.0 * h)
            assert forces[name][BY_APPROACH] == pytest.approx(slope, rel=1e-6), name
        assert forces["normal"][BY_RATE] == 0.0
        assert forces["normal"][AT_REST] < 0.0
