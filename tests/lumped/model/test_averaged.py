"""Do averaged modes, state space and the dynamic factor of ISO 6336-1 agree with closed forms?"""

import math

import numpy as np
import pytest

import lumped
from lumped.errors import ParameterError
from lumped.model.averaged import averaged_state_space, modes
from lumped.model.dynamic_factor import _factors, iso_dynamic_factor


@pytest.fixture(scope="module")
def symmetric():
    """28/28 pair without friction: the averaged system splits in closed form."""
    return lumped.load_gear_pair("nasa_28_28").with_(
        mesh__contact="prescribed", friction__law="none", mesh__damping_ratio=0.0
    )


def closed_form(pair):
    """For equal gears x_p + x_g sees the bearing only; (q, d = x_p - x_g) is a 2x2 eigenproblem."""
    body = lumped.bodies(pair)
    g = lumped.geometry(pair)
    k = lumped.mesh_elements(pair).stiffness.mean() * g.contact_ratio
    bearing = pair.bearings.pinion.loa_stiffness
    m = body.mass_pinion
    # q'' = -k/m_e (q + d);  d'' = -2k/m (q + d) - K/m d
    reduced = np.array(
        [[k / body.effective_mass, k / body.effective_mass], [2 * k / m, 2 * k / m + bearing / m]]
    )
    coupled = np.sqrt(np.linalg.eigvals(reduced).real)
    return np.sort(np.concatenate([coupled, np.full(3, np.sqrt(bearing / m))])) / (2 * np.pi)


def test_natural_frequencies_of_the_symmetric_pair(symmetric):
    frequencies = np.array([m.natural_frequency for m in modes(symmetric)])
    # Bearing damping of 5 % leaves |eigenvalue| of a decoupled mode unchanged; the two coupled ones shift by
    # the order of zeta^2 = 0.0025.
    np.testing.assert_allclose(frequencies, closed_form(symmetric), rtol=2.5e-3)
    undamped = symmetric.with_(
        {f"bearings.{g}.{d}_damping_ratio": 0.0 for g in ("pinion", "gear") for d in ("loa", "oloa")}
    )
    exact = np.array([m.natural_frequency for m in modes(undamped)])
    np.testing.assert_allclose(exact, closed_form(undamped), rtol=1e-9)  # rounding of the eigenproblem


def test_bearing_mode_keeps_its_damping_ratio(symmetric):
    bearing = [m for m in modes(symmetric) if abs(m.damping_ratio - 0.05) < 1e-9]
    assert len(bearing) == 3  # y_p, y_g and x_p + x_g


def test_static_receptance_is_the_mesh_deflection(symmetric):
    plant = averaged_state_space(symmetric, "mesh")
    static = -plant.C @ np.linalg.solve(plant.A, plant.B)
    k = lumped.mesh_elements(symmetric).stiffness.mean() * lumped.geometry(symmetric).contact_ratio
    body = lumped.bodies(symmetric)
    g = lumped.geometry(symmetric)
    # q'' = 0: r_bp T_p / J_p = k delta / m_e
    assert static[0, 0] == pytest.approx(
        g.base_radius_pinion / body.inertia_pinion * body.effective_mass / k, rel=1e-9
    )


def test_the_rigid_form_is_refused(symmetric):
    with pytest.raises(ParameterError, match="form"):
        averaged_state_space(symmetric, "full")


def test_a_dot_in_the_name_of_a_pair_is_no_matter(symmetric):
    """python-control reads a dot in a system's name as that of a subsystem, and refuses it."""
    named = symmetric.with_(name="stage 1.5")
    assert averaged_state_space(named).name == "stage 1_5"
    assert modes(named) == modes(symmetric)


PAIR = lumped.load_gear_pair("fzg_c")


@pytest.mark.parametrize(
    ("eps", "expected"),
    [
        (1.4, (0.32, 0.34, 0.23, 0.90, 0.47, 0.47, 0.75)),
        (2.0, (0.32, 0.34, 0.23, 0.90, 0.47, 0.47, 0.875)),
        # ISO 6336-1:2006, table 8, by hand at 2.5
        (2.5, (0.32, 0.57 / 2.2, 0.096 / 0.94, 0.445 / 1.06, 0.47, 0.12 / 0.76, 1.0)),
    ],
)
def test_factors_of_the_table(eps, expected):
    assert _factors(eps) == pytest.approx(expected)


def test_the_resonance_speed_is_that_of_the_reduced_mass_on_the_mean_stiffness():
    """N = 1 where z omega = sqrt(c_gamma b/m_red): the formula with 30000/pi is that in rpm."""
    from lumped.stiffness.iso6336 import mean_of

    bodies = lumped.bodies(PAIR)
    natural = math.sqrt(mean_of(PAIR) / bodies.effective_mass)  # rad/s
    speed = natural / PAIR.pinion.teeth
    dynamic_factor = iso_dynamic_factor(PAIR.with_({"operating.pinion_speed": f"{speed!r} rad/s"}))
    assert dynamic_factor.resonance_ratio == pytest.approx(1.0, rel=1e-9)
    assert dynamic_factor.zone == "main resonance"


def test_it_is_one_at_rest_and_continuous_between_the_zones():
    def factor_at(ratio: float):
        base = iso_dynamic_factor(PAIR).resonance_ratio
        speed = PAIR.operating.pinion_speed * ratio / base
        return iso_dynamic_factor(PAIR.with_({"operating.pinion_speed": f"{speed!r} rad/s"}))

    assert factor_at(1e-4).factor == pytest.approx(1.0, abs=1e-3)
    assert factor_at(1.15 + 1e-9).factor == pytest.approx(factor_at(1.15 - 1e-9).factor, rel=1e-6)
    assert factor_at(1.5 + 1e-9).factor == pytest.approx(factor_at(1.5 - 1e-9).factor, rel=1e-6)
    assert [factor_at(n).zone for n in (0.5, 1.0, 1.3, 2.0)] == [
        "subcritical",
        "main resonance",
        "intermediate",
        "supercritical",
    ]


def test_a_coarser_class_raises_it():
    fine = iso_dynamic_factor(PAIR, 4).factor
    coarse = iso_dynamic_factor(PAIR, 8).factor
    # Pitch and profile tolerances grow by sqrt(2) a class: B_p and B_f by 4 from class 4 to 8.
    relief = max((r.amount for r in (PAIR.pinion.tip_relief, PAIR.gear.tip_relief) if r), default=0.0)
    assert coarse > fine
    if relief == 0.0:
        n = iso_dynamic_factor(PAIR).resonance_ratio
        c3 = 0.23
        assert (coarse - 1.0 - n * c3) / (fine - 1.0 - n * c3) == pytest.approx(4.0, rel=1e-6)
