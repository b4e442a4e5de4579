"""Does the contact core combine kinematics and element laws as the model says?"""

import itertools

import numpy as np
import pytest

import lumped
from lumped.friction.registry import law_of
from lumped.model.steady import periodic_solution
from lumped.path_of_contact.friction import contact_path
from multibody.contact import friction as fr
from multibody.contact import kinematics as kn
from multibody.contact.friction import nominal_friction, signed_friction
from multibody.contact.kernels import contact_forces
from multibody.contact.machine import machine
from multibody.run.effects import effect_flags
from multibody.run.model import accelerations, from_lumped_state
from multibody.run.setup import prepare

PAIR = lumped.load_gear_pair("nasa_28_28").with_(friction__law="coulomb", friction__coefficient=0.1)
UNEQUAL = PAIR.with_(
    gear__teeth=41, pinion__profile_shift=0.2, gear__profile_shift=0.1, centre_distance="110.5 mm"
)
ALL = effect_flags(None)


def make(pair):
    return machine(pair)


def forces(numbers, t, q, v, flags=ALL):
    state, contacts = np.array([q, v, np.zeros(6)]), np.zeros((2 * kn.MAX_PAIRS, kn.N_RECORD))
    count = contact_forces(t, state, numbers.parameters, flags, numbers.table, contacts)
    assert count >= 0
    return state[2], contacts[:count]


def pressed_state(numbers, rng, flank=1.0):
    """Bodies off their places by some 10 um, flanks pressed by some 10 um."""
    q, v = rng.normal(size=6) * 1e-5, rng.normal(size=6) * 0.01
    q[5] -= flank * 6e-5 / numbers.parameters[kn.RADIUS_G]
    v[[2, 5]] *= 10
    return q, v


@pytest.mark.parametrize("pair", [PAIR, UNEQUAL], ids=["equal", "unequal, shifted"])
@pytest.mark.parametrize("flags", [ALL, ALL & ~kn.MOVING_LINE, 0], ids=["all", "fixed line", "none"])
def test_wrench_power_is_what_the_contacts_take(pair, flags, rng):
    """Virtual power: forces times velocities of the bodies = -(load x closing + friction x sliding)."""
    numbers = make(pair)
    p = numbers.parameters
    for t in np.linspace(0, numbers.period, 7):
        q, v = pressed_state(numbers, rng)
        wrench, c = forces(numbers, t, q, v, flags)
        assert len(c) >= 1
        total = v.copy()
        total[2] -= p[kn.OMEGA_P]
        total[5] += p[kn.OMEGA_G]
        taken = c[:, kn.LOAD] @ c[:, kn.CLOSING] + c[:, kn.FRICTION_FORCE] @ c[:, kn.SLIDE]
        # Powers of single forces are some 20 kW here and cancel to watts.
        assert wrench @ total == pytest.approx(-taken, abs=1e-9 * np.abs(wrench * total).sum())


@pytest.mark.parametrize(
    "flags", [ALL, ALL & ~kn.ROTATION_PHASE & ~kn.MOVING_LINE, 0], ids=["all", "nominal", "none"]
)
def test_pressing_velocity_is_the_rate_of_the_pressed_overlap(flags, rng):
    """With a relief that varies along the path, d/dt (delta - e(xi)) along a motion of the bodies."""
    start = 12.0  # deg: early enough that the relief acts on the whole approach
    numbers = make(PAIR.with_(mesh__relief="static", pinion__tip_relief__start_roll_angle=start))
    h = 1e-7
    for t in np.linspace(0.05, 0.3, 4) * numbers.period:
        q, v = pressed_state(numbers, rng)
        q[[2, 5]] -= 1e-3
        _, c = forces(numbers, t, q, v, flags)
        _, after = forces(numbers, t + h, q + h * v, v, flags)
        _, before = forces(numbers, t - h, q - h * v, v, flags)
        rate = (after[:, kn.OVERLAP] - before[:, kn.OVERLAP]) / (2 * h)
        assert np.abs(c[:, kn.CLOSING] - c[:, kn.OVERLAP_RATE]).max() > 1e-3
        # Central difference of a length known to 1e-17 m.
        np.testing.assert_allclose(c[:, kn.OVERLAP_RATE], rate, rtol=1e-6, atol=1e-8)


def test_teeth_push_but_do_not_pull(rng):
    numbers = make(PAIR)
    q, v = np.zeros(6), np.zeros(6)
    q[2] = 2e-5 / numbers.parameters[kn.RADIUS_P]  # pinion 20 um behind: inside the backlash of 100 um
    wrench, _ = forces(numbers, 0.3 * numbers.period, q, v)
    np.testing.assert_array_equal(wrench, 0.0)
    wrench, _ = forces(numbers, 0.3 * numbers.period, q, v, effect_flags({"contact_loss": False}))
    assert wrench[0] > 0  # pulled


def test_entry_is_where_the_deflected_flank_crosses_the_tip_circle():
    """Pressed flanks enter half an overlap later: the gear's flank ends at its tip, xi = L_XA + delta/2."""
    numbers = make(PAIR)
    p, delta = numbers.parameters, 2e-5
    # Half the overlap from each gear, so that the contact point itself is not moved.
    q = np.array([0, 0, -delta / 2 / p[kn.RADIUS_P], 0, 0, -delta / 2 / p[kn.RADIUS_G]])
    t = np.linspace(0, 0.01, 2001) * numbers.period
    entered = []
    one_sided = ALL & ~kn.BACK_SIDE
    for flags in (one_sided, one_sided & ~kn.ENTRY_SHIFT):
        pairs = [len(forces(numbers, ti, q, np.zeros(6), flags)[1]) for ti in t]
        assert pairs[-1] == 2
        _, c = forces(numbers, t[pairs.index(2)], q, np.zeros(6), flags)
        entered.append(c[:, kn.XI].min() - p[kn.L_XA])
    step = p[kn.PITCH] * 0.01 / 2000
    assert entered[0] == pytest.approx(delta / 2, abs=step)
    assert entered[1] == pytest.approx(0.0, abs=step)


def lumped_forces(setup, motion, pair):
    """Forces of the lumped equations at the states of a motion, on the coordinates of ``from_lumped_state``.

    The friction coefficient is the law's own; the lumped model solves with a polynomial within 1e-10 of it.
    """
    s, mesh, states = setup.system.structure, setup.system.cycle.sample(motion.time), motion.states
    q, v, touch = states[:, :6], states[:, 6:], mesh.contact
    load = mesh.stiffness * (q @ s.deflection - mesh.error)
    load += mesh.damping * (v @ s.deflection - mesh.error_rate)
    friction, law = np.zeros(load.shape), law_of(pair.friction)
    friction[touch] = load[touch] * law.signed(mesh.position[touch], contact_path(pair), pair.friction)
    force = np.outer(load.sum(0), s.normal) + (friction[..., None] * s.friction(mesh.position)).sum(0)
    force += np.outer((load * (0.0 if mesh.tilt is None else mesh.tilt)).sum(0), s.apart)
    force -= s.stiffness * q + s.damping * v
    force[:, :2] += setup.machine.torque_pinion, -setup.machine.torque_gear
    return from_lumped_state(np.hstack([force, force]))[0]


@pytest.mark.parametrize("contact", ["prescribed", "loaded"])
@pytest.mark.parametrize("stiffness", ["energy", "rectangular"])
def test_with_all_effects_off_it_is_the_lumped_equations(stiffness, contact):
    """To rounding: of the static load 4e-14 at 500 to 4875 rpm, 2e-13 at 18000 rpm."""
    for preset, rpm in zip(lumped.preset_names(), itertools.cycle((500, 18000, 4875)), strict=False):
        pair = lumped.load_gear_pair(preset).with_(
            mesh__stiffness={"model": stiffness}, mesh__contact=contact, operating__pinion_speed=rpm
        )
        setup = prepare(pair, effects=())
        times = np.array([0.3, 0.55, 0.8]) * setup.system.period
        motion = periodic_solution(setup.system, times, estimate_error=False)
        q, v = from_lumped_state(motion.states)
        forces = accelerations(setup.model, motion.time, q, v) * setup.machine.bodies[0]
        radii = setup.machine.parameters[[kn.RADIUS_P, kn.RADIUS_G]]
        units = np.array([1.0, 1.0, 1.0 / radii[0], 1.0, 1.0, 1.0 / radii[1]])
        off = (forces - lumped_forces(setup, motion, pair)) * units
        static = setup.machine.torque_pinion / setup.machine.parameters[kn.RADIUS_P]
        assert np.abs(off).max() < 1e-12 * static, preset


#: Error of the lumped model's polynomials, which carry the law there.
FIT = 1e-10


@pytest.mark.parametrize("oil", [
    {"iso_vg": 100, "viscosity_index": 110.0, "temperature": "60 degC"},
    {"kinematic_viscosity_40": 95.0, "kinematic_viscosity_100": 10.5, "temperature": "75 degC"},
], ids=["grade", "two points"])  # fmt: skip
def test_viscosity_of_an_oil_is_that_of_the_lumped_model(oil):
    changes = {"lubricant.viscosity_law": oil, "friction.law": "benedict_kelley"}
    pair = lumped.load_gear_pair("fzg_c").with_(mesh__contact="prescribed").with_(changes)
    p, table = machine(pair).parameters, lumped.mesh_elements(pair).friction
    xi = 0.3 * p[kn.L_XA] + 0.7 * p[kn.L_XP]
    assert nominal_friction(p, xi) == pytest.approx(float(table(xi)), abs=FIT)


def test_jumps_and_kinks_are_found_where_the_lumped_law_has_them():
    """Law V at a speed where the film makes it mixed near A and fluid near D, and law II at its bounds."""
    pair = lumped.load_gear_pair("nasa_28_28").with_(
        mesh__contact="prescribed", operating__pinion_torque=22.6
    )
    found = 0
    for changes in (
        {"friction__law": "composite", "operating__pinion_speed": 2500},
        {"friction__law": "benedict_kelley", "friction__maximum": 0.05},
        {"friction__law": "xu_kahraman"},
    ):
        at = pair.with_(**changes)
        own, theirs = machine(at).switches, lumped.mesh_cycle(at).edges[:-1]
        np.testing.assert_allclose(own, theirs / lumped.geometry(at).mesh_period, rtol=0.0, atol=1e-9)
        found += own.size
    assert found > 10


def test_the_momentary_load_is_an_effect_of_its_own():
    """Off: w_n, whatever the load. On: load over face width, which law III feels and law I does not."""
    for law, feels in (("xu_kahraman", True), ("coulomb", False)):
        pair = lumped.load_gear_pair("fzg_c").with_(
            mesh__contact="prescribed", friction__law=law, friction__coefficient=0.05
        )
        p = machine(pair).parameters
        xi, w = p[kn.L_XP] + 2e-3, p[kn.FRICTION + fr.NOMINAL_LOAD] * pair.gear.face_width

        def mu(flags, normal, p=p, xi=xi):
            return signed_friction(p, flags, 1.0, xi, 1.0, 1.0, xi, p[kn.L_XY] - xi, normal)

        on = effect_flags({"friction_load"})
        assert mu(0, 0.5 * w) == mu(0, w) == pytest.approx(mu(on, w))
        assert (abs(mu(on, 0.5 * w) / mu(on, w) - 1.0) > 0.1) == feels


def test_the_contact_of_a_faster_machine_rolls_and_slides_as_at_that_speed():
    """Both gears turn by a half faster than nominal: in the contact core the law of that speed acts."""
    pair = lumped.load_gear_pair("fzg_c").with_(mesh__contact="prescribed", friction__law="xu_kahraman")
    faster = pair.with_(operating__pinion_speed=1.5 * pair.operating.pinion_speed * 30.0 / np.pi)
    numbers, flags = machine(pair), effect_flags({"sliding_velocity"})
    p = numbers.parameters
    state, contacts = np.zeros((3, 6)), np.zeros((2 * kn.MAX_PAIRS, kn.N_RECORD))
    state[0, 5] = -6e-5 / p[kn.RADIUS_G]  # presses the flanks
    state[1, [2, 5]] = -0.5 * p[kn.OMEGA_P], 0.5 * p[kn.OMEGA_G]
    count = contact_forces(0.3 * numbers.period, state, p, flags, numbers.table, contacts)
    found = contacts[:count]
    expected = lumped.mesh_elements(faster).friction(found[:, kn.XI])
    nominal = lumped.mesh_elements(pair).friction(found[:, kn.XI])
    np.testing.assert_allclose(found[:, kn.MU], expected, rtol=0.0, atol=FIT)
    assert (np.abs(expected - nominal) > 5e-4).all()
