"""Are alterations of the equations what their words say? Each is compared with a balance or a formula."""

from dataclasses import replace

import numpy as np
import pytest

import lumped
from lumped.schema.bodies import bodies_of
from tests.unlike_pairs import unlike_pair
from tests.validation.check.test_explanations import COULOMB
from validation.check.explanations.physics import Physics, altered_elements, altered_equations, motion_of


@pytest.fixture(scope="module", params=["high_contact_ratio_29_47", "contact_ratio_1_1_large_shifts"])
def pair(request):
    """Two pairs that are unlike each other, with Coulomb friction of 0.06."""
    if request.param.startswith("high"):
        return lumped.load_gear_pair(request.param).with_(COULOMB)
    return unlike_pair(request.param).with_(COULOMB)


def arms_of(pair, name):
    """Lever arms of friction on pinion and gear, as functions of the position xi, by their words."""
    g = pair.geometry
    cosine = np.cos(g.operating_pressure_angle)
    shift = g.L_XY - g.L_XD - g.L_XA
    return {
        "from A": (lambda xi: xi - g.L_XA, lambda xi: g.L_XY - (xi - g.L_XA)),
        "of the other gear": (lambda xi: g.L_XY - xi, lambda xi: xi),
        "at the pitch point": (lambda xi: 0.0 * xi + g.L_XP, lambda xi: 0.0 * xi + g.L_XY - g.L_XP),
        "pitch radii": (
            lambda xi: 0.0 * xi + g.base_radius_pinion / cosine,
            lambda xi: 0.0 * xi + g.base_radius_gear / cosine,
        ),
        "mirrored path": (lambda xi: xi + shift, lambda xi: g.L_XY - xi - shift),
    }[name]


@pytest.mark.parametrize(
    "name", ["from A", "of the other gear", "at the pitch point", "pitch radii", "mirrored path"]
)
def test_moments_of_friction_balance_the_torques(pair, name):
    """Over a mesh cycle inertia averages out: T_p = mean(r_bp N + X_p F), T_g = mean(r_bg N + X_g F).

    Friction does not reverse here, so that its moments do not average out too.
    """
    g = pair.geometry
    shift = (g.L_XY - g.L_XD - g.L_XA) / g.base_pitch
    physics = Physics(course="without reversal")
    physics = replace(physics, **({"path_shift": shift} if name == "mirrored path" else {"arms": name}))
    motion = motion_of(pair, physics, None).motion
    load, friction = (motion[key].to_numpy() for key in ("normal_load", "friction_force"))
    position = motion["position"].to_numpy()
    arm_pinion, arm_gear = arms_of(pair, name)
    pinion = (g.base_radius_pinion * load + arm_pinion(position) * friction).sum(axis=0).mean()
    gear = (g.base_radius_gear * load + arm_gear(position) * friction).sum(axis=0).mean()
    # Forces jump with a pair that comes or goes: a sum over 512 samples errs by up to a jump over 512.
    assert pinion == pytest.approx(pair.operating.pinion_torque, rel=1.5e-3)
    assert gear == pytest.approx(motion.attrs["brake_torque"], rel=1.5e-3)
    true_pinion = (g.base_radius_pinion * load + position * friction).sum(axis=0).mean()
    torque = pair.operating.pinion_torque
    assert abs(true_pinion - torque) > 2.0 * abs(pinion - torque)  # the true arms do not balance


def test_friction_reverses_where_the_line_of_a_mirrored_path_has_its_pitch_point(pair):
    g = pair.geometry
    shift = 0.15
    law = altered_elements(pair, Physics(path_shift=shift)).friction
    xi = np.linspace(g.L_XA, g.L_XD, 102)[1:-1]
    expected = 0.06 * np.sign(xi - (g.L_XP - shift * g.base_pitch))
    assert law(xi) == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize(("pinion", "gear"), [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (-1.0, 1.0)])
def test_the_approach_without_displacements(pair, pinion, gear):
    """At a crawl without friction the mesh force is F and the approach F/K in the altered equations too.

    r_p theta_p - r_g theta_g is then F/K less the displacements that the approach has, with x = -+F/k.
    """
    slow = pair.with_({"friction.law": "none", "operating.pinion_speed": "2 rpm", "bearings.stiffness": 6e7})
    motion = motion_of(slow, Physics(approach_pinion=pinion, approach_gear=gear), None).motion
    g = slow.geometry
    force = slow.operating.pinion_torque / g.base_radius_pinion
    stiffness = motion["mesh_stiffness"].to_numpy()
    turned = motion["theta_p"].to_numpy() * g.base_radius_pinion
    turned = turned - motion["theta_g"].to_numpy() * g.base_radius_gear
    displaced = pinion * (-force / 6e7) - gear * (force / 6e7)
    inside = (
        np.abs(np.gradient(stiffness)) < 1e-2 * stiffness
    )  # away from jumps, where the motion is no crawl
    middle = inside & np.roll(inside, 12) & np.roll(inside, -12)
    assert turned[middle].mean() == pytest.approx((force / stiffness[middle]).mean() - displaced, rel=5e-3)


@pytest.mark.parametrize("factor", [1.0, -1.0])
def test_the_static_error_beside_the_stiffness(pair, factor):
    """The error of all teeth is the static deflection F/K of the whole mesh, times the factor."""
    g = pair.geometry
    force = pair.operating.pinion_torque / g.base_radius_pinion
    xi = g.L_XA + (np.arange(64) + 0.5) / 64 * g.base_pitch
    laws = altered_elements(pair, Physics(static_error=factor))
    total = sum(laws.stiffness(xi + number * g.base_pitch) for number in range(3))
    true = altered_elements(pair, Physics()).error
    assert laws.error(xi) - true(xi) == pytest.approx(factor * force / total, rel=1e-4)


@pytest.mark.parametrize("lag", [0.11, -0.2])
def test_a_stiffness_that_comes_late(pair, lag):
    g = pair.geometry
    phase = (np.arange(300) + 0.5) / 300
    true, law = (altered_elements(pair, physics).stiffness for physics in (Physics(), Physics(lag=lag)))

    def total(one, places):
        within = np.mod(places, 1.0)
        return sum(one(g.L_XA + (within + number) * g.base_pitch) for number in range(3))

    assert total(law, phase) == pytest.approx(total(true, phase - lag), rel=2e-3)


def test_slope_curvature_and_ramps_of_the_stiffness(pair):
    """k(u) (1 + s u + c u^2) over the path, u from -1 to 1; ramps start at 0 and leave the middle alone."""
    g = pair.geometry
    true = altered_elements(pair, Physics()).stiffness
    low, high = true.interval
    u = np.linspace(-1.0, 1.0, 41)[1:-1]
    xi = 0.5 * (low + high) + 0.5 * (high - low) * u
    shaped = altered_elements(pair, Physics(slope=0.3, curvature=-0.4)).stiffness
    assert shaped(xi) == pytest.approx(true(xi) * (1.0 + 0.3 * u - 0.4 * u**2), rel=1e-5)
    ramped = altered_elements(pair, Physics(ramps=0.2)).stiffness
    middle = np.abs(u) < 1.0 - 2.0 * 0.2
    assert ramped(xi)[middle] == pytest.approx(true(xi)[middle], rel=1e-5)
    ends = ramped(np.array([low, high]) + 1e-4 * g.base_pitch * np.array([1.0, -1.0]))
    assert np.abs(ends).max() < 1e-3 * float(true(np.array([g.L_XP]))[0])
    outside = ~middle
    assert (ramped(xi)[outside] < true(xi)[outside]).all()


def test_dampers_in_proportion_to_the_masses(pair):
    """2 zeta omega m of each coordinate more, at the mesh frequency omega."""
    frequency = 2.0 * np.pi / pair.geometry.mesh_period
    more = altered_equations(pair, Physics(mass_damping=0.05)).damping
    more = more - altered_equations(pair, Physics()).damping
    bodies = bodies_of(pair)
    masses = [bodies.inertia_pinion, bodies.inertia_gear]
    masses += [bodies.mass_pinion, bodies.mass_gear, bodies.mass_pinion, bodies.mass_gear]
    assert more == pytest.approx(2.0 * 0.05 * frequency * np.array(masses), rel=1e-12)
