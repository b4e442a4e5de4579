"""Are alterations of the equations what their words say? Each is compared with a balance or a formula."""

from dataclasses import replace

import numpy as np
import pytest

import lumped
from lumped.schema.bodies import bodies_of
from lumped.stiffness.energy import pair_compliance
from tests.unlike_pairs import unlike_pair
from tests.validation.check.sampled_motions import COULOMB
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
        "of the pinion": (lambda xi: xi, lambda xi: xi),
        "of the gear": (lambda xi: g.L_XY - xi, lambda xi: g.L_XY - xi),
        "at the pitch point": (lambda xi: 0.0 * xi + g.L_XP, lambda xi: 0.0 * xi + g.L_XY - g.L_XP),
        "from A on the pinion": (lambda xi: xi - g.L_XA, lambda xi: g.L_XY - xi),
        "from both ends": (lambda xi: xi - g.L_XA, lambda xi: g.L_XD - xi),
        "from the pitch point": (lambda xi: xi - g.L_XP, lambda xi: g.L_XP - xi),
        "base radii": (
            lambda xi: 0.0 * xi + g.base_radius_pinion,
            lambda xi: 0.0 * xi + g.base_radius_gear,
        ),
        "line of the rack": (
            lambda xi: xi,
            lambda xi: (
                (g.base_radius_pinion + g.base_radius_gear) * np.tan(pair.basic_rack.pressure_angle) - xi
            ),
        ),
        "pitch radii": (
            lambda xi: 0.0 * xi + g.base_radius_pinion / cosine,
            lambda xi: 0.0 * xi + g.base_radius_gear / cosine,
        ),
        "mirrored path": (lambda xi: xi + shift, lambda xi: g.L_XY - xi - shift),
    }[name]


@pytest.mark.parametrize(
    "name",
    [
        "from A",
        "from A on the pinion",
        "from both ends",
        "of the pinion",
        "of the gear",
        "from the pitch point",
        "of the other gear",
        "at the pitch point",
        "pitch radii",
        "base radii",
        "line of the rack",
        "mirrored path",
    ],
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
    if name in ("line of the rack", "of the pinion"):  # only the arm on the gear is another one
        true_gear = (g.base_radius_gear * load + (g.L_XY - position) * friction).sum(axis=0).mean()
        assert abs(true_gear - motion.attrs["brake_torque"]) > 2.0 * abs(gear - motion.attrs["brake_torque"])
        return
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


def test_friction_reverses_at_the_pitch_point_of_the_rack(pair):
    """r_bp tan(alpha) with the pressure angle of the rack."""
    g = pair.geometry
    place = g.base_radius_pinion * np.tan(pair.basic_rack.pressure_angle)
    law = altered_elements(pair, Physics(course="line of the rack", path_start=-0.05)).friction
    xi = place + np.array([-1e-3, 1e-3]) * g.base_pitch
    assert law(xi) == pytest.approx([-0.06, 0.06], rel=1e-6)


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


@pytest.mark.parametrize("equal", [False, True])
def test_friction_by_the_static_load(pair, equal):
    """F_i = mu T_p/r_bp k_i/K, or in equal shares; the torque of the pinion balances its moments too."""
    g = pair.geometry
    course = "static load in equal shares" if equal else "static load"
    motion = motion_of(pair, Physics(course=course), None).motion
    load, friction = (motion[key].to_numpy() for key in ("normal_load", "friction_force"))
    position = motion["position"].to_numpy()
    laws = altered_elements(pair, Physics())
    inside = (position > g.L_XA) & (position < g.L_XD)
    weights = inside * (1.0 if equal else laws.stiffness(position))
    force = pair.operating.pinion_torque / g.base_radius_pinion
    expected = 0.06 * np.sign(position - g.L_XP) * force * weights / weights.sum(axis=0)
    away = np.abs(np.mod(motion["time"].to_numpy() / g.mesh_period + 0.5, 1.0) - 0.5) > 1e-3
    ends = [np.abs(position - place).min(axis=0) > 2e-3 * g.base_pitch for place in (g.L_XA, g.L_XP, g.L_XD)]
    away &= np.all(ends, axis=0)
    assert friction[:, away] == pytest.approx(expected[:, away], rel=1e-5, abs=1e-6 * force)
    torque = (g.base_radius_pinion * load + position * friction).sum(axis=0).mean()
    assert torque == pytest.approx(pair.operating.pinion_torque, rel=1e-3)
    # The load vibrates, and friction does not follow it.
    assert np.ptp(load.sum(axis=0)) > 0.02 * force


def test_the_stiffness_of_a_table(pair):
    """At the entries the mesh has its own stiffness; half-way between their mean, or the earlier one."""
    g = pair.geometry
    true = altered_elements(pair, Physics()).stiffness

    def total(law, phases):
        return sum(law(g.L_XA + (phases + number) * g.base_pitch) for number in range(3))

    entries = (np.arange(9) + 1e-5) / 9
    values = total(true, entries)
    lines = altered_elements(pair, Physics(table=9)).stiffness
    steps = altered_elements(pair, Physics(table=9, table_join="steps")).stiffness
    assert total(lines, entries) == pytest.approx(values, rel=1e-3)
    half = entries + 0.5 / 9
    assert total(lines, half) == pytest.approx(0.5 * (values + np.roll(values, -1)), rel=1e-3)
    assert total(steps, half) == pytest.approx(values, rel=1e-3)
    middles = altered_elements(pair, Physics(table=9, table_join="middles")).stiffness
    for place in (0.1 / 9, 0.9 / 9):  # the value of the middle, before and behind it
        assert total(middles, entries + place) == pytest.approx(total(true, half), rel=1e-3)


def test_a_path_of_contact_with_other_ends(pair):
    """The first place has the stiffness of A, the last one that of D, the middle one that of the middle."""
    g = pair.geometry
    true = altered_elements(pair, Physics())
    moved = altered_elements(pair, Physics(path_start=-0.1, path_end=0.25))
    low, high = moved.stiffness.interval
    assert low == pytest.approx(g.L_XA - 0.1 * g.base_pitch, rel=1e-12)
    assert high == pytest.approx(g.L_XD + 0.25 * g.base_pitch, rel=1e-12)
    share = np.array([0.01, 0.3, 0.5, 0.98])
    same = true.stiffness(g.L_XA + share * (g.L_XD - g.L_XA))
    assert moved.stiffness(low + share * (high - low)) == pytest.approx(same, rel=1e-5)
    places = np.array([low + 1e-3 * g.base_pitch, high - 1e-3 * g.base_pitch])
    assert moved.friction(places) == pytest.approx([-0.06, 0.06], rel=1e-6)
    ratio = np.sqrt(moved.stiffness(places) / moved.stiffness(places[::-1]))
    assert moved.damping(places) / moved.damping(places[::-1]) == pytest.approx(ratio, rel=1e-5)


def test_parts_of_the_compliance(pair):
    """1/k' = 1/k less the part of both teeth, by the parts of the energy method."""
    pair = pair.with_({"mesh.stiffness": {"model": "energy"}})
    xi = np.linspace(pair.geometry.L_XA, pair.geometry.L_XD, 12)[1:-1]
    parts = pair_compliance(pair, xi)
    true = 1.0 / altered_elements(pair, Physics()).stiffness(xi)
    left_out = {
        "no bending": parts.pinion.bending + parts.gear.bending,
        "no shear": parts.pinion.shear + parts.gear.shear,
        "no compression": parts.pinion.axial + parts.gear.axial,
        "no foundation": parts.pinion.foundation + parts.gear.foundation,
        "no contact": parts.hertz,
        "a quarter of the contact": 0.75 * parts.hertz,
        "four times the contact": -3.0 * parts.hertz,
        "half the contact": 0.5 * parts.hertz,
        "twice the contact": -parts.hertz,
        "the pinion's tooth alone": parts.gear.total,
        "the gear's tooth alone": parts.pinion.total,
        "two teeth of the pinion": parts.gear.total - parts.pinion.total,
        "two teeth of the gear": parts.pinion.total - parts.gear.total,
    }
    for name, part in left_out.items():
        changed = 1.0 / altered_elements(pair, Physics(compliance=name)).stiffness(xi)
        assert changed == pytest.approx(true - part, rel=1e-4), name


def test_the_peak_of_a_parabola(pair):
    """k = peak - (peak - end) (u - s)^2 with u from -1 to 1: a parabola about s."""
    pair = pair.with_({"mesh.stiffness": {"model": "parabolic"}})
    g = pair.geometry
    true = altered_elements(pair, Physics()).stiffness
    moved = altered_elements(pair, Physics(peak=0.3)).stiffness
    u = np.linspace(-0.6, 0.6, 7)

    def places(share):
        return 0.5 * (g.L_XA + g.L_XD) + 0.5 * (g.L_XD - g.L_XA) * share

    assert moved(places(u + 0.3)) == pytest.approx(true(places(u)), rel=1e-5)


def test_dampers_in_proportion_to_stiffness(pair):
    """Each damper is its stiffness times one time, 2 zeta sqrt(m_e/mean K) of the mesh."""
    laws = altered_elements(pair, Physics(damper="proportional"))
    xi = np.linspace(pair.geometry.L_XA, pair.geometry.L_XD, 9)[1:-1]
    time = laws.damping(xi) / laws.stiffness(xi)
    assert time == pytest.approx(time[0], rel=1e-5)
    bearings = altered_equations(pair, Physics(proportional_bearings=True))
    assert bearings.damping[2:] == pytest.approx(time[0] * bearings.stiffness[2:], rel=1e-5)
    of_frequency = altered_elements(pair, Physics(damper="proportional at the mesh frequency"))
    of_mesh = 2.0 * pair.mesh.damping_ratio / (2.0 * np.pi / pair.geometry.mesh_period)
    places = np.linspace(pair.geometry.L_XA, pair.geometry.L_XD, 33)[1:-1]
    assert of_frequency.damping(places) == pytest.approx(of_mesh * of_frequency.stiffness(places), rel=1e-6)
    both = Physics(damper="proportional at the mesh frequency", proportional_bearings=True)
    dampers = altered_equations(pair, both)
    assert dampers.damping == pytest.approx(of_mesh * dampers.stiffness)


def test_a_constant_damper_for_each_pair(pair):
    """2 zeta sqrt(mean K m_e) for each pair in contact."""
    damping = altered_elements(pair, Physics(damper="constant for each pair")).damping
    g = pair.geometry
    stiffness = altered_elements(pair, Physics()).stiffness
    mean = stiffness.mean() * g.contact_ratio
    xi = np.linspace(g.L_XA, g.L_XD, 9)[1:-1]
    expected = 2.0 * pair.mesh.damping_ratio * np.sqrt(mean * bodies_of(pair).effective_mass)
    assert damping(xi) == pytest.approx(expected, rel=1e-5)


def test_the_natural_logarithm_in_a_friction_law(pair):
    """ln(10) times the coefficient of Benedict and Kelley, at most the bound of the pair."""
    pair = pair.with_({"friction.law": "benedict_kelley", "friction.coefficient": None})
    g = pair.geometry
    xi = np.linspace(g.L_XA, g.L_XD, 41)[1:-1]
    true = altered_elements(pair, Physics()).friction(xi)
    natural = altered_elements(pair, Physics(course="natural logarithm")).friction(xi)
    expected = np.sign(true) * np.minimum(np.log(10.0) * np.abs(true), pair.friction.maximum)
    assert natural == pytest.approx(expected, rel=1e-4)
    assert (np.abs(natural) > 1.5 * np.abs(true)).any()


@pytest.mark.parametrize("held", ["rigid pinion", "rigid gear", "rigid along", "rigid across"])
def test_supports_of_which_a_part_is_rigid(pair, held):
    """Held gears do not move, the others do; a held bearing carries what the mesh gives it."""
    motion = motion_of(pair, Physics(bearings=held), None).motion
    names = {
        "rigid pinion": ("x_p", "y_p"),
        "rigid gear": ("x_g", "y_g"),
        "rigid along": ("x_p", "x_g"),
        "rigid across": ("y_p", "y_g"),
    }[held]
    load, friction = (motion[key].to_numpy().sum(axis=0) for key in ("normal_load", "friction_force"))
    on_gear = {"x_p": load, "x_g": -load, "y_p": -friction, "y_g": friction}
    for name, force in on_gear.items():
        if name in names:
            assert np.abs(motion[name].to_numpy()).max() == 0.0
            assert motion[f"bearing_force_{name}"].to_numpy() == pytest.approx(force, rel=1e-9, abs=1e-9)
        else:
            assert np.abs(motion[name].to_numpy()).max() > 0.0
