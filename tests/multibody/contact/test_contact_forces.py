"""Does the contact core combine kinematics and element laws as the model says?"""

import numpy as np
import pytest

import lumped
from lumped.friction.registry import law_of
from lumped.model.steady import periodic_solution
from lumped.path_of_contact.friction import contact_path
from multibody.contact import kinematics as kn
from multibody.contact.friction import SurfaceMotion, nominal_friction, signed_friction
from multibody.contact.kernels import tooth_forces
from multibody.contact.machine import machine
from multibody.contact.records import CONTACTS_SIZE, COORDINATES, PHI_G, PHI_P, RATES, WRENCH, opened_contacts
from multibody.run.effects import effect_flags
from multibody.run.model import accelerations, from_lumped_state
from multibody.run.setup import prepare
from tests.unlike_pairs import UNLIKE, unlike_pair

ALL = effect_flags(None)


def prescribed(name):
    return unlike_pair(name).with_(mesh__contact="prescribed")


LIKE_TEETH = [name for name in UNLIKE if unlike_pair(name).healthy is unlike_pair(name)]


def forces(numbers, t, q, v, flags=ALL):
    state = np.array([q, v, np.zeros(6)])
    contacts = np.zeros(CONTACTS_SIZE)
    count = tooth_forces(t, state, numbers.packed, flags, contacts)
    assert count >= 0
    return state[WRENCH], opened_contacts(contacts)[:count]


def pressed_state(numbers, rng, flank=1.0):
    """Bodies off their places by some 10 um, flanks pressed by some 10 um."""
    q = rng.normal(size=6) * 1e-5
    v = rng.normal(size=6) * 0.01
    q[PHI_G] -= flank * 6e-5 / numbers.record.geometry.radius_g
    v[[PHI_P, PHI_G]] *= 10
    return q, v


#: Of the pair whose gears differ most in radius, and that with the largest pressure angle, each combination.
@pytest.mark.parametrize(("name", "flags"), [
    ("larger_gear_drives_contact_lost", ALL),
    ("larger_gear_drives_contact_lost", 0),
    ("rack_25_degrees_always_pushing", ALL & ~kn.MOVING_LINE),
    ("contact_ratio_1_1_large_shifts", ALL),
    ("contact_ratio_2_3_on_shafts", 0),
], ids=["all", "none", "fixed line", "all, far from the rack's angle", "none, three pairs"])  # fmt: skip
def test_wrench_power_is_what_the_contacts_take(name, flags, rng):
    """Virtual power: forces times velocities of the bodies = -(load x closing + friction x sliding)."""
    numbers = machine(prescribed(name))
    p = numbers.record
    for t in np.linspace(0, numbers.period, 7):
        q, v = pressed_state(numbers, rng)
        wrench, c = forces(numbers, t, q, v, flags)
        assert len(c) >= 1
        total = v.copy()
        total[PHI_P] -= p.rolling.omega_p
        total[PHI_G] += p.rolling.omega_g
        taken = c["load"] @ c["approach_rate"] + c["friction_force"] @ c["sliding_velocity"]
        # Powers of single forces are some 20 kW here and cancel to watts.
        assert wrench @ total == pytest.approx(-taken, abs=1e-9 * np.abs(wrench * total).sum())


@pytest.mark.parametrize(
    "flags", [ALL, ALL & ~kn.ROTATION_PHASE & ~kn.MOVING_LINE, 0], ids=["all", "nominal", "none"]
)
def test_pressing_velocity_is_the_rate_of_the_pressed_overlap(flags, rng):
    """With a relief that varies along the path, d/dt (delta - e(xi)) along a motion of the bodies."""
    start = 13.0  # deg: early enough that the relief acts on the whole approach
    pair = prescribed("heavily_relieved_under_load")
    numbers = machine(pair.with_(pinion__tip_relief__start_roll_angle=start))
    h = 1e-7
    for t in np.linspace(0.05, 0.3, 4) * numbers.period:
        q, v = pressed_state(numbers, rng)
        q[[PHI_P, PHI_G]] -= 1e-3
        _, c = forces(numbers, t, q, v, flags)
        _, after = forces(numbers, t + h, q + h * v, v, flags)
        _, before = forces(numbers, t - h, q - h * v, v, flags)
        rate = (after["compression"] - before["compression"]) / (2 * h)
        assert np.abs(c["approach_rate"] - c["compression_rate"]).max() > 1e-3
        # Central difference of a length known to 1e-17 m.
        np.testing.assert_allclose(c["compression_rate"], rate, rtol=1e-6, atol=1e-8)


def test_teeth_push_but_do_not_pull(rng):
    numbers = machine(prescribed("larger_gear_drives_contact_lost"))
    q = np.zeros(6)
    v = np.zeros(6)
    q[PHI_P] = 2e-5 / numbers.record.geometry.radius_p  # pinion 20 um behind: inside the backlash of 110 um
    wrench, _ = forces(numbers, 0.3 * numbers.period, q, v)
    np.testing.assert_array_equal(wrench, 0.0)
    wrench, _ = forces(numbers, 0.3 * numbers.period, q, v, effect_flags({"contact_loss": False}))
    assert wrench[0] > 0  # pulled


def test_entry_is_where_the_deflected_flank_crosses_the_tip_circle():
    """Pressed flanks enter half an overlap later: the gear's flank ends at its tip, xi = L_XA + delta/2."""
    numbers = machine(prescribed("rack_25_degrees_always_pushing"))
    p = numbers.record
    delta = 2e-5
    # Half the overlap from each gear, so that the contact point itself is not moved.
    q = np.array([0, 0, -delta / 2 / p.geometry.radius_p, 0, 0, -delta / 2 / p.geometry.radius_g])
    t = np.linspace(0, 0.01, 2001) * numbers.period
    entered = []
    one_sided = ALL & ~kn.BACK_SIDE
    for flags in (one_sided, one_sided & ~kn.ENTRY_SHIFT):
        pairs = [len(forces(numbers, ti, q, np.zeros(6), flags)[1]) for ti in t]
        assert pairs[-1] == 2
        _, c = forces(numbers, t[pairs.index(2)], q, np.zeros(6), flags)
        entered.append(c["position"].min() - p.geometry.L_XA)
    step = p.geometry.pitch * 0.01 / 2000
    assert entered[0] == pytest.approx(delta / 2, abs=step)
    assert entered[1] == pytest.approx(0.0, abs=step)


def lumped_forces(setup, motion, pair):
    """Forces of the lumped equations at the states of a motion, on the coordinates of ``from_lumped_state``.

    The friction coefficient is the law's own; the lumped model solves with a polynomial within 1e-10 of it.
    """
    s = setup.system.structure
    mesh = setup.system.cycle.sample(motion.time)
    states = motion.states
    q = states[:, :6]
    v = states[:, 6:]
    touch = mesh.contact
    load = mesh.stiffness * (q @ s.deflection - mesh.error)
    load += mesh.damping * (v @ s.deflection - mesh.error_rate)
    friction = np.zeros(load.shape)
    law = law_of(pair.friction)
    friction[touch] = load[touch] * law.signed(mesh.position[touch], contact_path(pair), pair.friction)
    force = np.outer(load.sum(0), s.normal) + (friction[..., None] * s.friction(mesh.position)).sum(0)
    force += np.outer((load * (0.0 if mesh.tilt is None else mesh.tilt)).sum(0), s.apart)
    force -= s.stiffness * q + s.damping * v
    force[:, :2] += setup.machine.torque_pinion, -setup.machine.torque_gear
    return from_lumped_state(np.hstack([force, force]))[0]


@pytest.mark.parametrize("contact", ["prescribed", "loaded"])
@pytest.mark.parametrize("name", LIKE_TEETH)
def test_with_all_effects_off_it_is_the_lumped_equations(name, contact):
    """To rounding: of the static load some 1e-13, which grows with the speed."""
    pair = unlike_pair(name).with_(mesh__contact=contact)
    setup = prepare(pair, effects=())
    times = np.array([0.3, 0.55, 0.8]) * setup.system.period
    motion = periodic_solution(setup.system, times, estimate_error=False)
    q, v = from_lumped_state(motion.states)
    forces = accelerations(setup.model, motion.time, q, v) * setup.machine.bodies["inertia"]
    radii = setup.machine.base_radii
    units = np.array([1.0, 1.0, 1.0 / radii[0], 1.0, 1.0, 1.0 / radii[1]])
    errors = (forces - lumped_forces(setup, motion, pair)) * units
    static = setup.machine.torque_pinion / setup.machine.record.geometry.radius_p
    assert np.abs(errors).max() < 1e-12 * static


#: Error of the lumped model's polynomials, which carry the law there.
FIT = 1e-10


@pytest.mark.parametrize("oil", [
    {"iso_vg": 100, "viscosity_index": 110.0, "temperature": "60 degC"},
    {"kinematic_viscosity_40": 95.0, "kinematic_viscosity_100": 10.5, "temperature": "75 degC"},
], ids=["grade", "two points"])  # fmt: skip
def test_viscosity_of_an_oil_is_that_of_the_lumped_model(oil):
    changes = {"lubricant.viscosity_law": oil, "friction.law": "benedict_kelley"}
    pair = lumped.load_gear_pair("fzg_c").with_(mesh__contact="prescribed").with_(changes)
    numbers = machine(pair)
    p = numbers.record
    table = lumped.mesh_elements(pair).friction
    xi = 0.3 * p.geometry.L_XA + 0.7 * p.geometry.L_XP
    assert nominal_friction(numbers.packed, xi) == pytest.approx(float(table(xi)), abs=FIT)


def test_jumps_and_kinks_are_found_where_the_lumped_law_has_them():
    """Law V where its film thresholds lie on the path, law II at its bounds, and law III with none."""
    compared = 0
    for name, changes in (
        ("heavily_relieved_under_load", {}),
        ("rack_25_degrees_always_pushing", {"friction__maximum": 0.05}),
        ("contact_ratio_2_3_on_shafts", {}),
    ):
        pair = prescribed(name).with_(**changes)
        switches = machine(pair).switches
        theirs = lumped.mesh_cycle(pair).edges[:-1]
        np.testing.assert_allclose(switches, theirs / lumped.geometry(pair).mesh_period, rtol=0.0, atol=1e-9)
        compared += switches.size
    assert compared > 10


def test_the_momentary_load_is_an_effect_of_its_own():
    """Off: w_n, whatever the load. On: load over face width, which law III feels and law I does not."""
    for name, feels in (("contact_ratio_2_3_on_shafts", True), ("contact_ratio_1_1_large_shifts", False)):
        pair = prescribed(name)
        numbers = machine(pair)
        p = numbers.record
        # The line load is that of the narrower face, which is the gear's in both.
        xi = p.geometry.L_XP + 2e-3
        w = p.friction.nominal_load * pair.gear.face_width

        def mu(flags, normal, p=p, xi=xi):
            surface = SurfaceMotion(1.0, 1.0, xi, p.geometry.L_XY - xi)
            return signed_friction(p, np.zeros((0, 0)), flags, 1.0, xi, surface, normal)

        on = effect_flags({"friction_load"})
        assert mu(0, 0.5 * w) == mu(0, w) == pytest.approx(mu(on, w))
        assert (abs(mu(on, 0.5 * w) / mu(on, w) - 1.0) > 0.1) == feels


def test_the_contact_of_a_faster_machine_rolls_and_slides_as_at_that_speed():
    """Both gears turn by a half faster than nominal: in the contact core the law of that speed acts."""
    pair = prescribed("contact_ratio_2_3_on_shafts")
    faster = pair.with_(operating__pinion_speed=1.5 * pair.operating.pinion_speed * 30.0 / np.pi)
    numbers = machine(pair)
    flags = effect_flags({"sliding_velocity"})
    p = numbers.record
    state = np.zeros((3, 6))
    contacts = np.zeros(CONTACTS_SIZE)
    state[COORDINATES, PHI_G] = -6e-5 / p.geometry.radius_g  # presses the flanks
    state[RATES, [PHI_P, PHI_G]] = -0.5 * p.rolling.omega_p, 0.5 * p.rolling.omega_g
    count = tooth_forces(0.3 * numbers.period, state, numbers.packed, flags, contacts)
    records = opened_contacts(contacts)[:count]
    expected = lumped.mesh_elements(faster).friction(records["position"])
    nominal = lumped.mesh_elements(pair).friction(records["position"])
    np.testing.assert_allclose(records["friction_coefficient"], expected, rtol=0.0, atol=FIT)
    assert (np.abs(expected - nominal) > 5e-4).all()
