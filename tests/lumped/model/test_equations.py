"""Are the equations solved the ones of the model page, in every form they take here?"""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from lumped import ParameterError, PathFunction, bodies, geometry, mesh_cycle, periodic_system
from lumped.model.equations import COORDINATES, structure
from lumped.model.solution import static_deflection

SEED = 20080614
# Sums of a dozen terms of mixed size: the terms of a row differ by up to four decades.
ROUNDING = 1e-11


@pytest.fixture(scope="module", params=["nasa", "unequal", "high_contact", "with_error"])
def case(request, nasa, unequal):
    """A pair, its mesh cycle and its absolute system, the last one with an unloaded tooth error."""
    if request.param == "with_error":
        pair = unequal
        cycle = mesh_cycle(pair)
        low, high = cycle.elements.stiffness.interval
        error = PathFunction.fit(lambda xi: 5e-6 * np.sin(300.0 * (xi - low)), [low, high], tolerance=1e-18)
        cycle = replace(cycle, elements=replace(cycle.elements, error=error))
    else:
        pair = request.getfixturevalue(request.param)
        cycle = mesh_cycle(pair)
    return SimpleNamespace(
        pair=pair, cycle=cycle, system=periodic_system(pair, "full", cycle=cycle), g=geometry(pair)
    )


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
    torque, brake = case.pair.operating.pinion_torque, 61.0
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
        left, right = rows @ full.A(t), reduced.A(t) @ rows
        np.testing.assert_allclose(left, right, atol=ROUNDING * np.abs(left).max(), rtol=0)
        a, b = rows @ full.b(t, 55.0), reduced.b(t, 55.0)
        np.testing.assert_allclose(a, b, rtol=ROUNDING, atol=ROUNDING * np.abs(a).max())
    np.testing.assert_allclose(reduced.deflection @ reduced.reduction, full.deflection, atol=1e-15)


def test_q_equation_of_the_model_page(case):
    """The row q'' written out: torques, normal loads over m_e, friction by its arms."""
    g, b = case.g, bodies(case.pair)
    system = periodic_system(case.pair, "elastic", cycle=case.cycle)
    r_bp, r_bg = g.base_radius_pinion, g.base_radius_gear
    rng = np.random.default_rng(SEED)
    for t in random_times(case.cycle, 20):
        x = rng.standard_normal(10) * np.array([1e-5] * 5 + [0.1] * 5)
        delta, rate = x[0] + x[1] - x[2], x[5] + x[6] - x[7]
        p = case.cycle.sample([t])
        load = (p.stiffness * (delta - p.error) + p.damping * (rate - p.error_rate))[:, 0]
        force, arm = p.friction[:, 0] * load, p.position[:, 0]
        brake = 58.0
        expected = (
            r_bp * case.pair.operating.pinion_torque / b.inertia_pinion
            + r_bg * brake / b.inertia_gear
            - load.sum() / b.effective_mass
            - (force * (r_bp * arm / b.inertia_pinion + r_bg * (g.L_XY - arm) / b.inertia_gear)).sum()
        )
        value = (system.A(t) @ x + system.b(t, brake))[5]
        assert value == pytest.approx(expected, rel=1e-11)


@pytest.mark.parametrize("mu", [0.0, 0.05, 0.1])
def test_unity_ratio_multiplies_each_pair_by_its_friction_factor(nasa, mu):
    """J_p = J_g, z_p = z_g: k_i and c_i enter the q equation times 1 + s_i mu tan(alpha), nothing else."""
    pair = nasa.with_(friction__law="coulomb", friction__coefficient=mu)
    system = periodic_system(pair, "elastic")
    g, m_e = geometry(pair), bodies(pair).effective_mass
    for t in random_times(system.cycle, 30):
        p = system.cycle.sample([t])
        s = np.sign(p.position - g.L_XP)
        factor = 1.0 + s * mu * math.tan(g.operating_pressure_angle)
        gain = system.gain([t])
        assert gain.stiffness[0, 0] == pytest.approx(-(factor * p.stiffness).sum() / m_e, rel=1e-13)
        assert gain.damping[0, 0] == pytest.approx(-(factor * p.damping).sum() / m_e, rel=1e-13)


def test_equal_pairs_cancel_in_double_contact(coulomb_pair):
    system = periodic_system(coulomb_pair, "elastic")
    p = system.cycle.sample(random_times(system.cycle, 200))
    times = random_times(system.cycle, 200)[p.contact.sum(axis=0) == 2]
    assert times.size > 20
    s = np.sign(p.position - geometry(coulomb_pair).L_XP)
    opposed = times[[(s[:, j].sum() == 0) for j in np.flatnonzero(p.contact.sum(axis=0) == 2)]]
    frictionless = periodic_system(coulomb_pair.with_(friction__law="none"), "elastic")
    np.testing.assert_allclose(
        system.gain(opposed).stiffness[:, 0], frictionless.gain(opposed).stiffness[:, 0], rtol=1e-13
    )


def test_forces_cancel_between_the_bodies(case):
    """Newton's third law, from the accelerations: bearing forces taken off, nothing is left in x and in y."""
    s = case.system.structure
    for t, state in zip(random_times(case.cycle, 20), random_states(20), strict=True):
        rate = case.system.A(t) @ state + case.system.b(t, 50.0)
        mesh = s.mass * rate[6:] + s.damping * state[6:] + s.stiffness * state[:6]
        for p, g in ((2, 3), (4, 5)):
            assert mesh[p] + mesh[g] == pytest.approx(0.0, abs=ROUNDING * max(abs(mesh[p]), 1.0))


def test_normal_loads_do_the_work_of_the_deflection(case):
    """The generalised force of a normal load is minus its deflection: the mesh stores what it is given."""
    s = case.system.structure
    np.testing.assert_array_equal(s.normal, -s.deflection)


def test_friction_moments_of_a_pair(case):
    """About the two centres friction has the arms X_p and L_XY - X_p, and no moment more."""
    g, s = case.g, case.system.structure
    xi = np.array([g.L_XA, g.L_XP, g.L_XD])
    arms = s.friction(xi)
    np.testing.assert_allclose(arms[:, 0], -xi, rtol=1e-15)
    np.testing.assert_allclose(arms[:, 1], g.L_XY - xi, rtol=1e-14)
    np.testing.assert_array_equal(arms[:, 2:], [[0, 0, 1, -1]] * 3)


def test_rigid_rotation_is_a_jordan_chain(case):
    """Turning both gears together does nothing, turning them steadily only turns them: A v = 0, A w = v."""
    g = case.g
    v, w = np.zeros(12), np.zeros(12)
    v[:2] = w[6:8] = 1 / g.base_radius_pinion, 1 / g.base_radius_gear
    for t in random_times(case.cycle, 20):
        a = case.system.A(t)
        scale = np.abs(a) @ np.abs(v) + 1.0
        assert np.abs(a @ v / scale).max() < 1e-14
        assert np.abs((a @ w - v) / (np.abs(a) @ np.abs(w) + 1.0)).max() < 1e-14


def test_static_deflection_is_an_equilibrium(unequal):
    """Without friction and with the mean stiffness for all times, every acceleration vanishes."""
    g, system = geometry(unequal), periodic_system(unequal, "full")
    k, s = system.cycle.mean_stiffness, system.structure
    state = static_deflection(system)
    load = k * (s.deflection @ state[:6])
    torque = unequal.operating.pinion_torque
    assert load == pytest.approx(torque / g.base_radius_pinion, rel=1e-13)
    external = np.array([torque, -torque * g.base_radius_gear / g.base_radius_pinion, 0, 0, 0, 0])
    residual = external + s.normal * load - s.stiffness * state[:6]
    assert np.abs(residual).max() < 1e-12 * load
    assert np.all(state[6:] == 0.0)
    b = bodies(unequal)
    assert b.inertia_pinion * state[0] / g.base_radius_pinion == pytest.approx(
        -b.inertia_gear * state[1] / g.base_radius_gear, rel=1e-12
    )


@pytest.mark.parametrize("number", [0, 3, 8, "1", None])
def test_only_repaired_equations_have_a_printed_sign(nasa, number):
    with pytest.raises(ParameterError, match="as_printed"):
        structure(nasa, (number,))


def test_unknown_form_is_refused(nasa):
    with pytest.raises(ParameterError, match="full, elastic, mesh"):
        periodic_system(nasa, "modal")
