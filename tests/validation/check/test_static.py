"""Does the static rung find what differs before anything moves, in any coordinates and units?"""

import numpy as np
import pytest

import lumped
from lumped.errors import ParameterError
from tests.unlike_pairs import unlike_pair
from validation.check.curves import Channel, Curves
from validation.check.static import static_rung
from validation.exchange.new_pair_file import new_pair

SPRING = 2e8
STEP = "variation in step, over the mean"
PAIRS = ("rack_25_degrees_always_pushing", "contact_ratio_1_1_large_shifts", "heavily_relieved_under_load")


def unequal_gears():
    """A pair whose stiffness runs backwards visibly, and whose frequencies are apart."""
    changes = {
        "bearings.stiffness": SPRING,
        "mesh.stiffness": {"model": "energy"},
        "mesh.contact": "prescribed",
        "mesh.relief": "ignored",
    }
    return new_pair("30/60", module=2, face_width=20, speed=1500, torque=50, changes=changes)


def stated(pair, **statics):
    arrays = {name: np.asarray(value, dtype=float) for name, value in statics.items()}
    return static_rung(Curves("other", "time", np.zeros(0), (), statics=arrays), pair)


def wrong(rung):
    return [row.name for row in rung.wrong]


@pytest.mark.parametrize("name", PAIRS)
def test_values_by_the_printed_formulas_agree_and_a_slip_is_named(name):
    # d_b = m z cos(alpha), a contact ratio by both tip circles: by hand, not from the geometry of the pair.
    pair = unlike_pair(name)
    g = pair.geometry
    module = pair.basic_rack.module
    angle = pair.basic_rack.pressure_angle
    base = [0.5 * module * gear.teeth * np.cos(angle) for gear in (pair.pinion, pair.gear)]
    force = pair.operating.pinion_torque / base[0]
    right = {"base_radius_pinion": base[0], "base_radius_gear": base[1], "static_force": force}
    assert stated(pair, **right, contact_ratio=round(g.contact_ratio, 2)).agrees
    pitch_radius = 0.5 * module * pair.pinion.teeth
    assert wrong(stated(pair, **right | {"base_radius_pinion": pitch_radius})) == [
        "base radius of the pinion"
    ]
    assert wrong(stated(pair, **right | {"static_force": pair.operating.pinion_torque / pitch_radius})) == [
        "static mesh force"
    ]


@pytest.mark.parametrize("name", PAIRS)
def test_a_solid_disc_by_hand(name):
    pair = unlike_pair(name).with_({"pinion.mass": None, "pinion.inertia": None, "pinion.bore": 0.0})
    gear = pair.pinion
    radius = 0.5 * pair.basic_rack.module * gear.teeth
    mass = gear.density * np.pi * radius**2 * gear.face_width
    bodies = lumped.bodies(pair)
    assert bodies.mass_pinion == pytest.approx(mass, rel=0.02)  # the body that the program takes
    assert stated(pair, mass_pinion=mass, inertia_pinion=0.5 * mass * radius**2).agrees
    assert wrong(stated(pair, inertia_pinion=mass * radius**2)) == ["moment of inertia of the pinion"]


@pytest.mark.parametrize(("change", "differs"), [
    (lambda values: values, set()),
    (lambda values: 0.8 * values, {"mean", "largest", "smallest"}),
    # The curve backwards in time is nearly the same curve in another phase; no mesh is less wavy by a tenth.
    (lambda values: values.mean() + 0.93 * (values - values.mean()), {STEP}),
])  # fmt: skip
def test_a_mesh_stiffness_in_any_phase(change, differs):
    pair = unequal_gears()
    cycle = lumped.mesh_cycle(pair)
    phase = np.arange(400) / 400
    values = cycle.sample(phase * cycle.period).stiffness.sum(axis=0)
    channel = Channel("k", "mesh_stiffness", np.roll(change(values), 57))
    rung = static_rung(Curves("other", "mesh_cycles", phase, (channel,)), pair)
    assert set(wrong(rung)) == {f"mesh stiffness, {which}" for which in differs}


@pytest.mark.parametrize(("change", "differs"), [
    (lambda M, K: (M, K), []),
    (lambda M, K: (M, K[::-1]), [f"sum of squared frequencies, {STEP}"]),
    (lambda M, K: (M[:4, :4], K[:, :4, :4]), ["number of natural frequencies"]),
    (lambda M, K: (M * np.array([1.2, 1, 1, 1, 1, 1]), K), ["natural frequency 5"]),
])  # fmt: skip
def test_matrices_are_compared_in_any_coordinates(change, differs):
    """M and K of the six displacements by hand: K(t) = k(t) v v^T and the bearings."""
    pair = unequal_gears()
    g = pair.geometry
    bodies = lumped.bodies(pair)
    masses = [bodies.inertia_pinion, bodies.inertia_gear, *[bodies.mass_pinion, bodies.mass_gear] * 2]
    v = np.array([g.base_radius_pinion, -g.base_radius_gear, 1.0, -1.0, 0.0, 0.0])
    cycle = lumped.mesh_cycle(pair)
    stiffness = cycle.sample(np.arange(64) * (cycle.period / 64)).stiffness.sum(axis=0)
    bearings = np.diag([0.0, 0.0, SPRING, SPRING, SPRING, SPRING])
    M, K = change(np.diag(masses), stiffness[:, None, None] * np.outer(v, v) + bearings)
    size = len(M)
    T = np.linalg.qr(np.random.default_rng(1).standard_normal((size, size)))[0] * np.array(
        [1e3, 1.0, 1e-3, 1.0, 1.0, 1.0][:size]
    )
    assert [name for name in wrong(stated(pair, M=T.T @ M @ T, K=T.T @ K @ T)) if name in differs] == differs
    assert bool(wrong(stated(pair, M=M, K=K))) == bool(differs)


@pytest.mark.parametrize(("statics", "field"), [
    ({"M": np.ones((2, 2)), "K": np.eye(2)}, "M, K"),
    ({"M": np.eye(2)}, "K"),
    ({"contact_ratio": [1.0, 2.0]}, "contact_ratio"),
])  # fmt: skip
def test_static_values_of_a_wrong_shape_are_refused(statics, field):
    with pytest.raises(ParameterError) as refusal:
        stated(lumped.load_gear_pair("fzg_c"), **statics)
    assert refusal.value.problems[0].field == field


def test_limits_of_static_quantities_from_both_sides_and_their_order():
    pair = unlike_pair("contact_ratio_1_1_large_shifts")
    g = pair.geometry
    mass = lumped.bodies(pair).mass_gear
    assert stated(pair, base_radius_gear=1.004 * g.base_radius_gear, mass_gear=0.985 * mass).agrees
    assert stated(pair, centre_distance=0.996 * g.centre_distance).agrees
    assert wrong(stated(pair, centre_distance=1.006 * g.centre_distance)) == ["centre distance"]
    # 2 % of a radius is four times its limit, 5 % of a mass two and a half times.
    both = stated(pair, mass_gear=1.05 * mass, base_radius_gear=0.98 * g.base_radius_gear)
    assert wrong(both) == ["base radius of the gear", "mass of the gear"]


@pytest.mark.parametrize("name", PAIRS)
def test_natural_frequencies_with_those_of_rigid_motions(name):
    pair = unlike_pair(name)
    ours = lumped.natural_frequencies(pair.healthy).to_numpy()
    assert stated(pair, natural_frequencies=[1e-4, *ours[::-1], 0.0]).agrees
    assert wrong(stated(pair, natural_frequencies=ours[:-1])) == ["number of natural frequencies"]
    shifted = [*ours[:-1], 1.04 * ours[-1]]
    assert wrong(stated(pair, natural_frequencies=shifted)) == [f"natural frequency {len(ours)}"]
