"""Are the equations solved the ones of the model page, in every form they take here?"""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import quad

from lumped import ParameterError, PathFunction, bodies, geometry, mesh_cycle, periodic_system
from lumped.model.equations import COORDINATES, structure
from lumped.model.periodic_system import LTVSystem
from lumped.model.solution import static_deflection

SEED = 20080614
# Sums of a dozen terms of mixed size: the terms of a row differ by up to four decades.
ROUNDING = 1e-11


@pytest.fixture(scope="module")
def case(published):
    """A pair, its mesh cycle and its absolute system, with an unloaded tooth error."""
    cycle = mesh_cycle(published)
    low, high = cycle.elements.stiffness.interval
    error = PathFunction.fit(lambda xi: 5e-6 * np.sin(300.0 * (xi - low)), [low, high], tolerance=1e-18)
    cycle = replace(cycle, elements=replace(cycle.elements, error=error))
    system = periodic_system(published, "full", cycle=cycle)
    return SimpleNamespace(pair=published, cycle=cycle, system=system, g=geometry(published))


def random_states(count):
    """States of the size that running gears have, each kind in its own unit."""
    rng = np.random.default_rng(SEED)
    size = np.array([1e-4, 1e-4, 1e-5, 1e-5, 1e-5, 1e-5, 5.0, 5.0, 0.1, 0.1, 0.1, 0.1])
    return rng.standard_normal((count, 12)) * size


def random_times(cycle, count):
    rng = np.random.default_rng(SEED + 1)
    return rng.uniform(0.0, cycle.period, count)


def test_matrix_form_and_the_page_agree(case, written_out):
    b = bodies(case.pair)
    masses = (b.mass_pinion, b.mass_gear, b.inertia_pinion, b.inertia_gear)
    torque = case.pair.operating.pinion_torque
    brake = 61.0
    for t, state in zip(random_times(case.cycle, 60), random_states(60), strict=True):
        expected = written_out(case.pair, case.g, masses, t, state, case.cycle.elements, torque, brake)
        matrix = case.system.A(t) @ state + case.system.b(t, brake)
        scale = np.abs(case.system.A(t)[6:]) @ np.abs(state) + np.abs(case.system.b(t, brake)[6:])
        np.testing.assert_array_equal(matrix[:6], state[6:])
        np.testing.assert_allclose(matrix[6:] / scale, expected / scale, atol=ROUNDING, rtol=0)


def test_batches_are_the_single_evaluations(case):
    times = random_times(case.cycle, 20)
    single = np.array([case.system.A(t) for t in times])
    # A BLAS may add the pairs of a batch in another order; 1e-12 leaves their sums room to cancel.
    np.testing.assert_allclose(case.system.matrices(times), single, rtol=1e-12)
    assert case.system.state_names == COORDINATES + tuple(f"{n}_dot" for n in COORDINATES)
    assert case.system.size == 12
    assert case.system.period == case.cycle.period


@pytest.mark.parametrize("printed", [(), (1,), (2,), (7,), (9,)])
@pytest.mark.parametrize("form", ["elastic", "mesh"])
def test_reduced_forms_are_exact(case, form, printed):
    """With P the rows that make (z, z') of the 12 states, P A = A_reduced P and P b = b_reduced."""
    full = periodic_system(case.pair, "full", cycle=case.cycle, as_printed=printed)
    reduced = periodic_system(case.pair, form, cycle=case.cycle, as_printed=printed)
    rows = np.kron(np.eye(2), reduced.reduction)
    for t in random_times(case.cycle, 12):
        product = rows @ full.A(t)
        reduced_product = reduced.A(t) @ rows
        np.testing.assert_allclose(product, reduced_product, atol=ROUNDING * np.abs(product).max(), rtol=0)
        a = rows @ full.b(t, 55.0)
        b = reduced.b(t, 55.0)
        np.testing.assert_allclose(a, b, rtol=ROUNDING, atol=ROUNDING * np.abs(a).max())
    np.testing.assert_allclose(reduced.deflection @ reduced.reduction, full.deflection, atol=1e-15)


def test_rigid_rotation_is_a_jordan_chain(case):
    """Turning both gears together does nothing, turning them steadily only turns them: A v = 0, A w = v."""
    g = case.g
    v = np.zeros(12)
    w = np.zeros(12)
    v[:2] = w[6:8] = 1 / g.base_radius_pinion, 1 / g.base_radius_gear
    for t in random_times(case.cycle, 20):
        a = case.system.A(t)
        scale = np.abs(a) @ np.abs(v) + 1.0
        assert np.abs(a @ v / scale).max() < 1e-14
        assert np.abs((a @ w - v) / (np.abs(a) @ np.abs(w) + 1.0)).max() < 1e-14


def test_static_deflection_is_an_equilibrium(published):
    """Without friction and with the mean stiffness for all times, every acceleration vanishes."""
    g = geometry(published)
    system = periodic_system(published, "full")
    k = system.cycle.mean_stiffness
    s = system.structure
    state = static_deflection(system)
    load = k * (s.deflection @ state[:6])
    torque = published.operating.pinion_torque
    assert load == pytest.approx(torque / g.base_radius_pinion, rel=1e-13)
    external = np.array([torque, -torque * g.base_radius_gear / g.base_radius_pinion, 0, 0, 0, 0])
    residual = external + s.normal * load - s.stiffness * state[:6]
    assert np.abs(residual).max() < 1e-12 * load
    assert np.all(state[6:] == 0.0)
    b = bodies(published)
    assert b.inertia_pinion * state[0] / g.base_radius_pinion == pytest.approx(
        -b.inertia_gear * state[1] / g.base_radius_gear, rel=1e-12
    )


def test_torques_on_rigid_bearings_speed_the_pinion_up_and_brake_the_gear(unlike):
    """J_p theta_p'' = T_p and J_g theta_g'' = -T_g, so q = r_p theta_p - r_g theta_g gets both with one sign.

    Torques that balance, T_g/r_g = T_p/r_p, then press the teeth by T_p/r_p: m_e q'' = T_p/r_p with the
    effective mass 1/m_e = r_p^2/J_p + r_g^2/J_g.
    """
    pair = unlike.healthy
    b, g = bodies(pair), geometry(pair)
    r_p, r_g = g.base_radius_pinion, g.base_radius_gear
    full = LTVSystem.of(pair, "full", supports="rigid")
    np.testing.assert_allclose(full.torque_pinion, [0.0, 0.0, 1.0 / b.inertia_pinion, 0.0], rtol=1e-15)
    np.testing.assert_allclose(full.torque_gear, [0.0, 0.0, 0.0, -1.0 / b.inertia_gear], rtol=1e-15)
    for form in ("elastic", "mesh"):
        relative = LTVSystem.of(pair, form, supports="rigid")
        np.testing.assert_allclose(relative.torque_pinion, [0.0, r_p / b.inertia_pinion], rtol=1e-14)
        np.testing.assert_allclose(relative.torque_gear, [0.0, r_g / b.inertia_gear], rtol=1e-14)
        balanced = r_p * relative.torque_pinion[1] + r_g * relative.torque_gear[1]
        assert balanced == pytest.approx(1.0 / b.effective_mass, rel=1e-13)


@pytest.mark.parametrize("number", [0, 3, 8, "1", None])
def test_only_repaired_equations_have_a_printed_sign(unequal, number):
    with pytest.raises(ParameterError, match="as_printed"):
        structure(unequal, (number,))


def test_unknown_form_is_refused(unequal):
    with pytest.raises(ParameterError, match="full, elastic, mesh"):
        periodic_system(unequal, "modal")


@pytest.mark.parametrize(("number", "axis"), [(7, (2, 3)), (9, (4, 5))])
def test_per_unit_load_the_forces_on_both_bodies_sum_to_zero_and_as_printed_to_two(unequal, number, axis):
    for printed, residual in (((), 0.0), ((number,), 2.0)):
        s = structure(unequal, printed)
        force = s.normal if number == 7 else s.friction(np.array(20e-3))
        assert abs(force[axis[0]] + force[axis[1]]) == residual


def test_printed_signs_change_only_their_own_rows(published):
    repaired = periodic_system(published, "full")
    t = 0.3 * repaired.period
    for number, row in {1: 6, 2: 7, 7: 9, 9: 11}.items():
        difference = periodic_system(published, "full", as_printed=(number,)).A(t) - repaired.A(t)
        assert set(np.flatnonzero(np.abs(difference).max(axis=1))) == {row}


@pytest.mark.parametrize("name", ["pinion", "gear"])
def test_disc_by_integration(unlike, name):
    """Discs of the reference circles, each with its own bore, width and density."""
    b = bodies(unlike)
    gear = getattr(unlike, name)
    radius = 0.5 * unlike.basic_rack.module * gear.teeth
    per_radius = gear.density * 2 * math.pi * gear.face_width
    mass, _ = quad(lambda r: per_radius * r, 0.5 * gear.bore, radius)
    inertia, _ = quad(lambda r: per_radius * r**3, 0.5 * gear.bore, radius)
    assert getattr(b, f"mass_{name}") == pytest.approx(mass, rel=1e-12)  # quadrature of a polynomial
    assert getattr(b, f"inertia_{name}") == pytest.approx(inertia, rel=1e-12)


def test_given_values_win_one_by_one(unequal):
    b = bodies(unequal.with_(pinion__mass=0.5, gear__inertia=1e-3))
    disc = bodies(unequal)
    assert (b.mass_pinion, b.inertia_gear) == (0.5, 1e-3)
    assert (b.mass_gear, b.inertia_pinion) == (disc.mass_gear, disc.inertia_pinion)
