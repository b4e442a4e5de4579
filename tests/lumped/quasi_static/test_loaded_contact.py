"""Does the loaded contact carry the load, begin where the gap closes, and conserve energy?"""

import numpy as np
import pytest

import lumped
from lumped.model.mesh_cycle import mesh_cycle
from lumped.model.periodic_system import periodic_system
from lumped.model.powers import mean_powers
from lumped.model.steady import periodic_solution
from lumped.quasi_static.contacts import mesh_elements
from lumped.quasi_static.elements import at_rest
from lumped.quasi_static.loaded import StaticMesh, loaded_contact
from tests.unlike_pairs import UNLIKE, unlike_pair

PAIR = lumped.load_gear_pair("nasa_28_28").with_(
    mesh__relief="ignored", mesh__stiffness={"model": "energy"}, mesh__contact="loaded"
)
LARGER_DRIVES = unlike_pair("larger_gear_drives_contact_lost")
FORMS = {
    "linear": LARGER_DRIVES.with_(mesh__stiffness={"model": "energy", "hertz": "linear"}),
    "relief": PAIR.with_(mesh__relief="static"),
    "rectangular": PAIR.with_(mesh__stiffness={"model": "rectangular"}),
    **{name: unlike_pair(name).healthy.with_(shafts=None) for name in UNLIKE},
}


def solution(pair):
    return periodic_solution(periodic_system(pair, "full"), np.zeros(1), estimate_error=False)


@pytest.mark.parametrize("name", FORMS)
def test_the_loads_of_the_fitted_laws_make_the_mean_load(name):
    pair = FORMS[name]
    mesh = StaticMesh(pair)
    cycle = mesh_cycle(pair)
    g = lumped.geometry(pair)
    times = (np.arange(997) + 0.5) / 997 * cycle.period
    state = cycle.sample(times)
    delta = mesh.approach(g.L_XA + g.omega_pinion * g.base_radius_pinion * times)
    load = (state.stiffness * (delta - state.error)).sum(axis=0)
    assert np.abs(load / mesh.force - 1.0).max() < 1e-8
    assert state.contact.any(axis=0).all()


def test_pairs_two_pitches_apart_move_each_other_too():
    pair = FORMS["contact_ratio_2_3_on_shafts"].with_(mesh__stiffness={"model": "energy", "hertz": "linear"})
    mesh = StaticMesh(pair)
    g = lumped.geometry(pair)
    last = 0.5 * (g.L_XA + g.L_XD) - g.base_pitch
    xi = last + np.arange(3) * g.base_pitch
    three = mesh.static(xi)
    assert three.load.min() > 0.0
    w = mesh.neighbours[0](xi[:2])
    far = float(mesh.neighbours[1](xi[0]))
    compliance = np.diag(1.0 / mesh.stiffness_at(xi))
    compliance += np.array([[0.0, w[0], far], [w[0], 0.0, w[1]], [far, w[1], 0.0]])
    assert compliance @ three.load == pytest.approx(three.approach - three.gap, rel=1e-10)
    assert abs(far) > 1e-3 * w[0]


def damper_power(torque, rpm):
    """Of a linear pair with corners, and the pair; so damped that one corner's swing ends by the next."""
    pair = FORMS["rectangular"].with_(
        friction__law="none", mesh__damping_ratio=0.2, operating__pinion_torque=torque,
        operating__pinion_speed=rpm,
    )  # fmt: skip
    return mean_powers(solution(pair)).tooth_dampers, pair


def test_a_quarter_of_the_torque_at_half_the_speed_makes_a_quarter_of_the_motion():
    """The corner then closes in the same time; at one speed the order is 1.30 here, not 2.

    Corners are parabolas, to some 60 per metre of length: 0.1 mm here.
    """
    nominal, slower, softer = (
        damper_power(*operating_point)[0] for operating_point in ((1.0, 200.0), (0.25, 100.0), (0.25, 200.0))
    )
    assert nominal / slower == pytest.approx(32.0, rel=5e-3)  # 16 a mesh cycle
    assert np.log2(nominal / softer) / 2.0 < 1.4


def test_the_energy_residual_of_prescribed_contact_has_a_closed_form():
    """Where k jumps from 0 at A and to 0 at D, k delta^2/2 comes and goes without work."""
    pair = lumped.load_gear_pair("nasa_28_28").with_(
        mesh__contact="prescribed", mesh__relief="ignored", friction={"law": "coulomb", "coefficient": 0.0}
    )
    g = lumped.geometry(pair)
    k = float(mesh_elements(pair).stiffness(lumped.geometry(pair).L_XP))
    system = periodic_system(pair, "full")
    times = np.array([0.0, np.mod(g.contact_ratio, 1.0)]) * system.period
    motion = periodic_solution(system, times, estimate_error=False)
    at_a, at_d = motion.states[:, :6] @ system.structure.deflection
    powers = mean_powers(motion)
    assert powers.sliding == pytest.approx(0.0, abs=1e-9 * powers.driving)
    assert powers.energy_residual == pytest.approx(k * (at_a**2 - at_d**2) / 2 / system.period, rel=1e-6)
    assert powers.lost == pytest.approx(powers.energy_residual, rel=1e-6)


@pytest.mark.parametrize(
    ("rpm", "sliding", "dampers", "bearings"),
    [(500, 0.349, 0.058, 0.011), (4875, 0.293, 0.022, 0.042), (18000, 0.299, 0.127, 0.013)],
)
def test_losses_by_place_are_those_of_an_independent_program(rpm, sliding, dampers, bearings):
    """Per cent of the input, from a prototype that shares no code (docs/theory/contact_energy.md)."""
    powers = mean_powers(
        solution(
            lumped.load_gear_pair("nasa_28_28").with_(
                mesh__contact="prescribed", mesh__relief="ignored", operating__pinion_speed=float(rpm)
            )
        )
    )
    losses = np.array([powers.sliding, powers.tooth_dampers, powers.bearings]) / powers.driving * 100
    assert losses == pytest.approx([sliding, dampers, bearings], abs=1.1e-3)


@pytest.mark.parametrize("name", ["linear", "relief"])
def test_all_losses_are_paid_by_the_moments_and_the_force_along_the_path(name):
    """T_g = T_g(moments) + r_bg <sum H>: path forces by quadrature, losses by the power balance."""
    pair = FORMS[name].with_(mesh__stiffness={"model": "energy", "hertz": "linear"})
    g = lumped.geometry(pair)
    powers = mean_powers(solution(pair))
    motion = lumped.steady_state(pair, samples_per_cycle=65536)
    e = mesh_elements(pair)
    contact = loaded_contact(at_rest(pair))
    xi = motion["position"].to_numpy()
    pressed = motion["dte"].to_numpy() - contact.error(xi)
    touching = motion["contact"].to_numpy() > 0
    # Elastic loads follow e, the approach at which their tangents vanish; the dampers follow the gaps.
    elastic = e.stiffness(xi) * pressed
    path = elastic * contact.error.slope(xi) - 0.5 * e.stiffness.slope(xi) * pressed**2
    # Of what a damper does on the approach, it takes its load times the rate of the compression.
    speed = g.base_radius_pinion * g.omega_pinion
    rate = motion["dte_dot"].to_numpy()
    compressing = e.closing(xi) * (rate - e.error_slope(xi) * speed)
    path += (motion["normal_load"].to_numpy() - elastic) * (rate - compressing) / speed
    by_path = np.where(touching, path, 0.0).sum(axis=0).mean() * g.base_radius_pinion * g.omega_pinion
    # The motion swings about the static one: what is stored where a pair comes or goes jumps with all k_t.
    ends = contact.contact[0]
    times = np.sort(np.mod((ends - g.L_XA) / speed, g.mesh_period))
    periodic = periodic_solution(periodic_system(pair, "full"), times, estimate_error=False)
    dte = np.interp(np.mod((ends - g.L_XA) / speed, g.mesh_period), times, periodic.values["dte"])

    def stored(side):
        place = ends + np.arange(-2, 3)[:, None] * g.base_pitch + side * 1e-10
        return 0.5 * (e.stiffness(place) * (dte - contact.error(place)) ** 2).sum()

    by_jumps = (stored(1.0) - stored(-1.0)) / g.mesh_period
    assert by_jumps - by_path == pytest.approx(powers.energy_residual, rel=2e-3)
    assert motion.attrs["mesh_efficiency"] == pytest.approx(powers.efficiency, abs=1e-9)


@pytest.mark.parametrize("name", UNLIKE)
def test_the_brake_of_unequal_gears_takes_what_no_loss_takes(name):
    pair = FORMS[name]
    powers = mean_powers(solution(FORMS[name]))
    attributes = lumped.steady_state(pair, samples_per_cycle=16).attrs
    taken = attributes["brake_torque"] * lumped.geometry(pair).omega_gear
    assert attributes["power_energy_residual"] == 0.0
    assert taken == pytest.approx(powers.driving - powers.lost, rel=1e-9)


def test_the_damper_follows_the_gap_and_not_the_error_of_the_tangent():
    """Relief grows linearly over the roll angle, 23 um from 24 deg to the tip of the pinion."""
    pair = FORMS["relief"]
    g = lumped.geometry(FORMS["relief"])
    e = mesh_elements(pair)
    start = np.radians(24.0) * g.base_radius_pinion
    xi = start + 0.3 * (g.L_XD - start)
    slope = 23e-6 / (g.L_XD - start)
    assert e.error_slope(xi) == pytest.approx(slope, rel=1e-7)
    # Hertz's contact: the tangent's error falls with the load.
    assert abs(e.error.slope(xi) / slope - 1.0) > 0.01


@pytest.mark.parametrize("name", ["contact_ratio_1_1_large_shifts", "larger_gear_drives_contact_lost"])
def test_contact_is_computed_once_whatever_statics_does_not_read(name):
    pair = unlike_pair(name)
    contact = loaded_contact(at_rest(pair))
    unread = {
        "operating.pinion_speed": f"{0.9 * pair.operating.pinion_speed!r} rad/s",
        "mesh.damping_ratio": 0.03,
        "pinion.inertia": 0.5,
        "bearings.gear.loa_damping_ratio": 0.01,
        "lubricant.viscosity": "0.02 Pa s",
    }
    for path, value in unread.items():
        assert loaded_contact(at_rest(pair.with_({path: value}))) is contact, path
    read = {
        "operating.pinion_torque": f"{1.01 * pair.operating.pinion_torque!r} N m",
        "bearings.gear.loa_stiffness": f"{0.5 * pair.bearings.gear.loa_stiffness!r} N/m",
    }
    for path, value in read.items():
        assert loaded_contact(at_rest(pair.with_({path: value}))) is not contact, path
