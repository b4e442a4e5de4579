"""Is the contact force the gradient of an energy, and do dampers take no more than they turn to heat?"""

from functools import partial

import numpy as np
import pytest
from scipy.special import lambertw

import lumped
import multibody
from lumped.quasi_static.loaded import StaticMesh
from lumped.quasi_static.tooth_error import corner_gap as lumped_corner_gap
from multibody.contact import kinematics as kn
from multibody.contact.elements import GRADUAL, ContactLaw, elastic_load, shared_loads, stored_energy
from multibody.contact.kernels import tooth_forces
from multibody.contact.machine import machine
from multibody.contact.records import (
    CONTACTS_SIZE,
    PAIR,
    PHI_G,
    PHI_P,
    WRENCH,
    X_G,
    X_P,
    Y_G,
    Y_P,
    opened_contacts,
)
from multibody.run.effects import effect_flags
from tests.lumped.mesh.element_calls import Mesh
from tests.unlike_pairs import unlike_pair

ALL = effect_flags(None, "loaded")
#: Neither friction nor dampers, so that all forces come from the energy.
BARE = {
    "friction": {"law": "coulomb", "coefficient": 0.0},
    "mesh.damping_ratio": 0.0,
    "mesh.contact": "loaded",
}


def bare(name, **changes):
    return unlike_pair(name).with_(BARE | changes)


#: Every stiffness model, Hertz's contact with and without its law, relief, and teeth that differ.
PAIRS = {
    "Hertz": bare("larger_gear_drives_contact_lost"),
    "linear": bare(
        "contact_ratio_2_3_on_shafts", **{"mesh.stiffness": {"model": "energy", "hertz": "linear"}}
    ),
    "relief": bare("heavily_relieved_under_load", **{"gear.tip_relief.shape": "parabolic"}),
    "rectangular": bare("rack_25_degrees_always_pushing"),
    "parabolic": bare("contact_ratio_1_1_large_shifts"),
    "unlike teeth": bare("unlike_teeth_finite_elements"),
}

#: Every law on the driving flanks, one on the back sides.
FLANKS = [*((name, kn.DRIVE) for name in PAIRS), ("parabolic", kn.COAST)]
#: States, at least, in which a corner carries. Relief of 14 to 40 um holds corners back from flanks that are
#: pressed by 5 to 30 um.
WITH_CORNERS = dict.fromkeys(PAIRS, 11) | {"relief": 0, "unlike teeth": 1}


def contact(numbers, t, q, v=None, flags=ALL):
    contacts = np.zeros(CONTACTS_SIZE)
    state = np.array([q, np.zeros(6) if v is None else v, np.zeros(6)])
    count = tooth_forces(t, state, numbers.packed, flags, contacts)
    return state[WRENCH], opened_contacts(contacts)[:count]


def states(numbers, number, flank=kn.DRIVE):
    """Times and states with the flanks pressed by 5 to 30 um and the centres off by some um."""
    rng = np.random.default_rng(4)
    p = numbers.record
    backlash = 0.0 if flank == kn.DRIVE else PAIRS["parabolic"].geometry.normal_backlash
    for _ in range(number):
        q = rng.uniform(-3e-6, 3e-6, 6)
        q[[PHI_P, PHI_G]] = -flank * (backlash + rng.uniform(5e-6, 3e-5)) / p.geometry.radius_p, 0.0
        yield rng.uniform() * numbers.period, q


@pytest.mark.parametrize(("name", "flank"), FLANKS)
def test_the_wrench_is_minus_the_gradient_of_the_energy(name, flank):
    numbers = machine(PAIRS[name], ALL)
    length = np.array([1.0, 1.0, numbers.record.geometry.radius_p] * 2)
    length[PHI_G] = numbers.record.geometry.radius_g
    beyond = 0
    worst = []
    pressing = []
    for t, q in states(numbers, 150, flank):
        wrench, contacts = contact(numbers, t, q)
        pressing += np.unique(contacts["flank"][contacts["load"] > 0.0]).tolist()
        step = np.diag(2e-9 / length)
        up, down = (
            np.array([contact(numbers, t, q + s * one)[1]["energy"].sum() for one in step])
            for s in (1.0, -1.0)
        )
        scale = max(contacts["load"].sum(), 1.0)
        worst.append(np.abs((wrench + (up - down) / (4e-9 / length)) / length).max() / scale)
        xi = contacts["position"]
        beyond += np.any((xi < numbers.record.geometry.L_XA) | (xi > numbers.record.geometry.L_XD))
    # Central differences: a curvature of some 1/um over 2 nm, and kinks (first touch, ends of the path).
    assert np.quantile(worst, 0.9) < 1e-6
    assert max(worst) < 3e-4
    assert beyond >= WITH_CORNERS[name]
    assert set(pressing) == {flank}


@pytest.mark.parametrize(("name", "flank"), FLANKS)
def test_action_is_reaction_in_force_and_moment(name, flank):
    numbers = machine(PAIRS[name], ALL)
    p = numbers.record
    p.pair_law.damping = 30.0
    for t, q in states(numbers, 40, flank):
        w, contacts = contact(numbers, t, q, np.random.default_rng(1).normal(size=6) * 0.01)
        px = p.geometry.centre_p_x + q[X_P]
        py = p.geometry.centre_p_y + q[Y_P]
        gx = p.geometry.centre_g_x + q[X_G]
        gy = p.geometry.centre_g_y + q[Y_G]
        moment = w[PHI_P] + w[PHI_G] + px * w[Y_P] - py * w[X_P] + gx * w[Y_G] - gy * w[X_G]
        scale = max(contacts["load"].sum(), 1.0)
        assert np.abs(w[:2] + w[3:5]).max() <= 1e-13 * scale  # 0 where deviations keep the teeth apart
        assert abs(moment) <= 1e-12 * scale * p.geometry.radius_p


@pytest.mark.parametrize("beyond", [1e-5, 3e-4, 1.5e-3])
def test_corner_gap_has_its_derivatives_its_inverse_and_the_lumped_value(beyond):
    pair = PAIRS["parabolic"]
    numbers = machine(pair)
    p = numbers.record
    g = lumped.geometry(pair)
    arguments = p.geometry.tip_g, p.geometry.L_XY, p.geometry.radius_g, p.geometry.radius_p
    gap, slope, by_length = kn.corner_gap(beyond, *arguments)
    assert gap == pytest.approx(float(lumped_corner_gap(g, np.array(g.L_XA - beyond))), rel=1e-9, abs=2e-17)
    assert kn.corner_reach(gap, *arguments) == pytest.approx(beyond, rel=1e-9)
    h = 1e-7
    tip, length, *radii = arguments
    ends = [kn.corner_gap(beyond + s, *arguments)[0] for s in (h, -h)]
    longer = [kn.corner_gap(beyond, tip, length + s, *radii)[0] for s in (h, -h)]
    assert slope == pytest.approx((ends[0] - ends[1]) / (2 * h), rel=1e-6)
    assert by_length == pytest.approx((longer[0] - longer[1]) / (2 * h), rel=1e-4, abs=1e-10)
    # The corner is cut from the mate's involute: the leading term of the gap is half its curvature there.
    # The next one is its share by the radius of curvature of the mate, the smaller of both, or less.
    leading = (tip / radii[0]) ** 2 * (1.0 / tip + 1.0 / (length - tip)) * beyond**2 / 2
    assert gap == pytest.approx(leading, rel=beyond / (length - tip))


@pytest.mark.parametrize("gear", ["pinion", "gear"])
@pytest.mark.parametrize("beyond", [1e-5, 3e-4, 1.5e-3])
def test_a_corner_pushes_with_its_load_along_a_tangent_of_the_mates_base_circle(gear, beyond):
    """The normal of the flank that a corner touches is a tangent of the base circle of this flank."""
    numbers = machine(PAIRS["parabolic"])
    p = numbers.record
    radii = numbers.base_radii
    tips = np.array([p.geometry.tip_p, p.geometry.tip_g])
    length = p.geometry.L_XY + 1e-5
    number = 0 if gear == "pinion" else 1
    rho = np.full(2, length - tips[number] - beyond)
    rho[number] = tips[number] + beyond
    line = kn.Line(1.0, 0.0, length, kn.DRIVE, *radii)
    wrench = np.zeros(6)
    corners = kn.corners_at(line, *rho, tuple(tips), (0.0, 0.0))
    kn.add_wrench(wrench, line, 1.0, 0.0, 0.0, 0.0)
    kn.add_gradient(wrench, line, corners.by_p, corners.by_g, corners.by_length)
    turn = beyond / radii[number]  # of the corner, from where it leaves the line of action
    along = radii[number] * np.sin(turn) + tips[number] * np.cos(turn)
    distance = radii[number] * (1.0 - np.cos(turn)) + tips[number] * np.sin(turn)
    corner = np.array([length - along, distance] if number else [along, -distance])
    centres = np.array([[0.0, -radii[0]], [length, radii[1]]])
    for (fx, fy, moment), (x, y) in zip(wrench.reshape(2, 3), corner - centres, strict=True):
        assert np.hypot(fx, fy) == pytest.approx(1.0, rel=1e-12)
        assert moment == pytest.approx(x * fy - y * fx, rel=1e-10)
    assert wrench[5 - 3 * number] == pytest.approx(radii[1 - number], rel=1e-12)


def test_a_damper_dissipates_takes_hold_with_the_load_and_leaves_the_energy_alone():
    """Also where it would pull: then the load is zero, and what the teeth store stays."""
    numbers = machine(PAIRS["relief"].with_(mesh__damping_ratio=0.1), ALL)
    seen = set()
    p = numbers.record
    rng = np.random.default_rng(2)
    full = GRADUAL * p.pair_law.nominal_force
    for t, q in states(numbers, 200):
        q[PHI_P] *= rng.uniform(0.1, 1.0)
        v = rng.normal(size=6) * 0.3
        v[[PHI_P, PHI_G]] /= p.geometry.radius_p
        still = contact(numbers, t, q)[1]
        contacts = contact(numbers, t, q, v)[1]
        for field in ("elastic_load", "energy"):
            assert np.array_equal(contacts[field], still[field])
        by_damper = contacts["load"] - contacts["elastic_load"]
        share = contacts["elastic_load"] / full
        assert np.all(by_damper * contacts["compression_rate"] >= 0.0)
        assert contacts["load"].min(initial=0.0) >= 0.0
        full_force = (
            p.pair_law.damping * np.sqrt(contacts["stiffness"]) * np.abs(contacts["compression_rate"])
        )
        assert np.all(np.abs(by_damper) <= np.minimum(1.0, 3.0 * share**2) * full_force * (1.0 + 1e-12))
        seen |= {"gradual"} if np.any((share > 0.0) & (share < 0.5)) else set()
        seen |= {"clipped"} if np.any((share > 0.0) & (contacts["load"] == 0.0)) else set()
    assert seen == {"gradual", "clipped"}


@pytest.mark.parametrize(("name", "flank"), FLANKS)
def test_a_damper_takes_from_the_bodies_what_its_own_compression_does_on_it(name, flank):
    """A damper follows the rate of the compression, and pushes along the gradient of the compression.

    The compression contains relief, corners and lengths. So the wrench of the dampers times the velocities of
    the bodies, with the rotation, is minus the sum of N_d p'.
    """
    elastic, numbers = (machine(PAIRS[name].with_(mesh__damping_ratio=ratio), ALL) for ratio in (0.0, 0.1))
    p = numbers.record
    rng = np.random.default_rng(3)
    h = 1e-8
    beyond = 0
    running = np.array([0.0, 0.0, -p.rolling.omega_p, 0.0, 0.0, p.rolling.omega_g])
    for t, q in states(numbers, 150, flank):
        v = rng.normal(size=6) * ([2.0, 2.0, 0.03 / p.geometry.radius_p] * 2)
        (without, _), (wrench, contacts) = (contact(one, t, q, v) for one in (elastic, numbers))
        by_damper = contacts["load"] - contacts["elastic_load"]
        taken = (by_damper * contacts["compression_rate"]).sum()
        assert (wrench - without) @ (v + running) == pytest.approx(-taken, rel=1e-9, abs=1e-9)
        ends = [contact(numbers, t + s, q + s * v)[1] for s in (h, -h)]
        if len(ends[0]) == len(ends[1]) == len(contacts):
            rate = (ends[0]["compression"] - ends[1]["compression"]) / (2 * h)
            assert contacts["compression_rate"] == pytest.approx(rate, rel=1e-5, abs=1e-5)
        xi = contacts["position"][contacts["load"] > 0.0]
        beyond += np.any((xi < p.geometry.L_XA) | (xi > p.geometry.L_XD))
    assert beyond >= WITH_CORNERS[name]


@pytest.mark.parametrize("share", [1e-4, 0.01, 0.3, 1.0, 5.0])
def test_hertz_law_is_the_derivative_of_its_energy_and_lamberts_function(share):
    k = 8e7
    d = 4.4e-10
    nominal = 1353.0
    pressed = share * nominal / k

    law = ContactLaw(d, nominal)

    def energy(p, k):
        return stored_energy(elastic_load(p, k, law), k, 2e9, law)

    load = elastic_load(pressed, k, law)
    slope = energy(pressed, k)[1]
    h = 1e-6 * pressed
    up, down = (energy(pressed + s, k)[0] for s in (h, -h))
    assert (up - down) / (2 * h) == pytest.approx(load, rel=1e-7)
    softer, stiffer = (energy(pressed, k + s)[0] for s in (-1e3, 1e3))
    assert slope == pytest.approx((stiffer - softer) / 2e3 * 2e9, rel=1e-6)
    # The lumped model's own evaluation: load, and its slope as the tangent.
    one = Mesh([0.015], stiffness=k, softening=d, force=nominal, linear_below=1e-3 * nominal)
    (further,) = one.loads(pressed + h)
    (at_approach,) = one.loads(pressed)
    tangent = one.contacts["tangent"][0]
    assert at_approach == pytest.approx(load, rel=1e-12)
    assert tangent == pytest.approx((further - at_approach) / h, rel=1e-5)
    assert stored_energy(1e-9, k, 2e9, law)[0] == pytest.approx(0.0, abs=1e-20)  # no load, no energy
    if share >= 0.3:  # far above the load below which the law is held linear
        w = lambertw(-pressed * np.exp(-1.0 / (k * d)) / (d * nominal), -1).real
        assert load == pytest.approx(-pressed / (d * w), rel=1e-6)


def test_the_stiffness_of_the_table_holds_at_the_mean_load():
    """The torque over the base radius of the pinion; the logarithm is cut off a thousandth below."""
    pair = PAIRS["Hertz"]
    numbers = machine(pair, ALL)
    q = np.zeros(6)
    load = pair.operating.pinion_torque / numbers.record.geometry.radius_p
    for _ in range(5):
        (record,) = contact(numbers, 0.85 * numbers.period, q)[1]
        q[PHI_P] = -load / record["stiffness"] / numbers.record.geometry.radius_p
    assert record["load"] == pytest.approx(load, rel=1e-6)


def test_slow_gears_speed_up_and_slow_down_with_their_own_deflection():
    """Half of what the torques do over a deflection is stored, the other half speeds the free gears up.

    dv/v = F (delta - mean)/(2 m_r v^2) with m_r = J_p/r_bp^2 + J_g/r_bg^2. Without path work no normal load
    changes the momentum J_p omega_p/r_bp + J_g omega_g/r_bg. Stiffness grows from zero: no corners touch.
    """
    ramp = {"mesh.stiffness": {"model": "parabolic", "ramp_length": 3.0}}
    # The formula is of first order in dv/v, which is 0.7 % here; with four times the torque it is 3 % off.
    slow = {"operating.pinion_speed": 300.0, "operating.pinion_torque": 60.0, "mesh.damping_ratio": 0.2}
    pair = bare("rack_25_degrees_always_pushing", **ramp, **slow)
    numbers = machine(pair)
    mesh = StaticMesh(pair)
    p = numbers.record
    radii = numbers.base_radii
    speed = p.rolling.omega_p * radii[0]
    mass = (numbers.inertia / radii**2).sum()
    ripple = {}
    for acts in (False, True):  # the momentum stays in any motion, so the first one need not repeat
        move = multibody.steady_state if acts else partial(multibody.simulate, cycles=1)
        run = move(pair, effects={"path_work": acts}, samples_per_cycle=64)
        rates = np.stack([run["theta_p_dot"], run["theta_g_dot"]], axis=1)
        ripple[acts] = rates @ (numbers.inertia / radii) / mass / speed
    delta = mesh.approach(p.geometry.L_XA + speed * run["time"].to_numpy())
    expected = mesh.force * (delta - delta.mean()) / (2.0 * mass * speed**2)
    assert ripple[True] - ripple[True].mean() == pytest.approx(expected, abs=0.02 * np.ptp(expected))
    assert np.ptp(ripple[False]) < 1e-9 * np.ptp(expected)


def loads_of(compression, stiffness, couplings, law, pulls=0):
    """Loads of pairs that move each other. With ``pulls`` 1 the pairs cannot lose contact."""
    pairs = np.zeros(len(compression), PAIR)
    pairs["compression"] = compression
    pairs["stiffness"] = stiffness
    pairs["couplings"][:, : len(compression)] = couplings
    pairs["may_pull"] = pulls
    shared_loads(len(compression), pairs, law)
    return pairs["elastic_load"]


@pytest.mark.parametrize("softening", [0.0, 4.4e-10])
def test_neighbours_share_the_load_in_both_models(softening):
    """Each solves by its own means; and the conditions of contact themselves."""
    rng = np.random.default_rng(7)
    seen = set()
    for _ in range(2000):
        n = int(rng.integers(1, 5))
        nominal = 1353.0
        k = rng.uniform(5e7, 1e8, n)
        pressed = rng.uniform(-5e-6, 2e-5, n)
        w = rng.uniform(-1.5e-9, 4e-9, (n, n))
        w = np.tril(w, -1) + np.tril(w, -1).T
        loads = loads_of(pressed, k, w, ContactLaw(softening, nominal))
        law = {"softening": softening, "force": nominal, "linear_below": 1e-3 * nominal, "coupled": True}
        law["apart_below"] = -1.0  # neighbours may bring any pair into contact
        theirs = Mesh(np.full(n, 0.015), w, stiffness=k, gap=-pressed, **law).loads(0.0)
        assert loads == pytest.approx(theirs, rel=1e-11, abs=1e-9)
        compressions = pressed - w @ loads
        touch = loads > 0.0
        multibody_loads = [
            elastic_load(one, stiffness, ContactLaw(softening, nominal))
            for one, stiffness in zip(compressions, k, strict=True)
        ]
        assert loads[touch] == pytest.approx(np.array(multibody_loads)[touch], rel=1e-10)
        assert np.all(compressions[~touch] <= 1e-20)
        seen.add((n, int(touch.sum())))
    assert {(4, 1), (4, 3), (4, 4), (2, 1)} <= seen


def test_a_pair_that_cannot_lose_contact_pulls_and_still_moves_its_neighbour():
    w = np.array([[0.0, 2e-9], [2e-9, 0.0]])
    k = np.array([8e7, 6e7])
    pressed = np.array([1e-5, -4e-6])
    loads = loads_of(pressed, k, w, ContactLaw(0.0, 1353.0), pulls=1)
    assert loads == pytest.approx(np.linalg.solve(np.diag(1.0 / k) + w, pressed), rel=1e-12)
    assert loads[1] < 0.0
