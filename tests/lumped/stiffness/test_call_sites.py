"""Does each stiffness formula get the right gear, rack and material? On pairs with unlike gears."""

import math

import numpy as np
import pytest

from lumped.stiffness import iso6336
from lumped.stiffness.energy import pair_compliance, weber_banaschek_softening
from lumped.stiffness.finite_elements import elastic_teeth, hertz_half_width
from lumped.stiffness.foundation import body_twist
from tests.guards.by_hand import ByHand, Contact
from tests.unlike_pairs import unlike_pair
from validation.exchange import new_pair

#: c'_th of ISO 6336-1, eqs (83) and (84): of z_1, z_2, x_1, x_2, gear 1 with fewer teeth.
C = (0.04723, 0.15551, 0.25791, -0.00635, -0.11654, -0.00193, -0.24188, 0.00529, 0.00182)


def theory(z_1, z_2, x_1, x_2):
    terms = (1.0, 1.0 / z_1, 1.0 / z_2, x_1, x_1 / z_1, x_2, x_2 / z_2, x_1**2, x_2**2)
    return 1.0 / sum(c * term for c, term in zip(C, terms, strict=True))


def test_iso_stiffness_of_a_25_degree_rack():
    """C_B = (1 + 0.5 (1.2 - h_fP/m)) (1 - 0.02 (20 - alpha)), ISO 6336-1, eq. (88).

    With h_fP = 1.2 m and 25 degrees it is 1 + 0.02 * 5 = 1.1: a larger pressure angle makes a thicker root.
    """
    pair = unlike_pair("rack_25_degrees_always_pushing")  # 23/38, x 0.34/-0.17, 206 and 172 GPa
    material = 2.0 * 206.0 * 172.0 / (206.0 + 172.0) / 206.0
    single = theory(23, 38, 0.34, -0.17) * 0.8 * 1.1 * material
    assert iso6336.pair_single_stiffness(pair) == pytest.approx(single, rel=1e-12)
    assert iso6336.single_of(pair) == pytest.approx(single * 1e9 * 18e-3, rel=1e-12)  # the narrower gear
    assert iso6336.basic_rack_factor(1.2, 25.0) == pytest.approx(1.1, rel=1e-14)
    assert iso6336.basic_rack_factor(1.4, 14.5) == pytest.approx(0.9 * 0.89, rel=1e-14)


def test_gear_one_of_the_standard_is_the_smaller_where_it_is_driven():
    pair = unlike_pair("larger_gear_drives_contact_lost")  # 43 teeth drive 22, x -0.21/-0.08, 206 and 210 GPa
    material = 2.0 * 206.0 * 210.0 / (206.0 + 210.0) / 206.0
    single = theory(22, 43, -0.08, -0.21) * 0.8 * 0.975 * material  # h_fP 1.25
    assert iso6336.pair_single_stiffness(pair) == pytest.approx(single, rel=1e-12)
    hand = ByHand(pair, "pinion")
    ratio = (hand.tip_length - hand.start_length) / hand.base_pitch
    mean = single * (0.75 * ratio + 0.25) * 1e9 * 15e-3
    assert iso6336.mean_of(pair) == pytest.approx(mean, rel=1e-9)


def test_the_contact_between_unlike_materials(unlike):
    """Linear: 2/pi sum((1 - nu^2)/E)/b. Weber and Banaschek: each gear with its own depth and material."""
    by_hand = Contact(unlike)
    gears = (unlike.pinion, unlike.gear)
    xi = by_hand.xi[::40]
    plane = [(1.0 - one.poisson_ratio**2) / one.youngs_modulus for one in gears]
    linear = pair_compliance(unlike, xi, hertz="linear").hertz
    np.testing.assert_allclose(linear, 2.0 / math.pi * sum(plane) / by_hand.width, rtol=1e-12)
    half = Contact(unlike, xi).half_width
    np.testing.assert_allclose(hertz_half_width(unlike, xi), half, rtol=1e-9)
    expected = np.zeros(xi.size)
    for gear, flexible, one in zip(("pinion", "gear"), plane, gears, strict=True):
        hand = ByHand(unlike, gear)
        length = xi if gear == "pinion" else 1e-3 * hand.line - xi
        # To the centre line along the load: from the flank, r_b tan(L/r_b - psi_b) is inside the tooth.
        angle = length / (1e-3 * hand.r_b) - hand.psi_b
        depth = length - 1e-3 * hand.r_b * np.tan(angle)
        nu = one.poisson_ratio
        shape = np.log(2.0 * depth / half) - nu / (2.0 * (1.0 - nu))
        expected += 2.0 / math.pi * flexible * shape / by_hand.width
    compliance = pair_compliance(unlike, xi, hertz="weber_banaschek").hertz
    np.testing.assert_allclose(compliance, expected, rtol=1e-9)
    assert weber_banaschek_softening(unlike) == pytest.approx(sum(plane) / math.pi / by_hand.width, rel=1e-12)


def test_each_body_twists_with_its_own_bore_width_and_material(unlike):
    """4 pi G b/(1/r_i^2 - 1/r_f^2), Lame."""
    for twist_stiffness, gear in zip(body_twist(unlike), ("pinion", "gear"), strict=True):
        wheel = getattr(unlike, gear)
        hand = ByHand(unlike, gear)
        shear = wheel.youngs_modulus / (2.0 * (1.0 + wheel.poisson_ratio))
        radii = (0.5 * wheel.bore) ** -2 - (1e-3 * hand.r_f) ** -2
        assert twist_stiffness == pytest.approx(4.0 * math.pi * shear * wheel.face_width / radii, rel=1e-9)


def test_plane_strain_is_plane_stress_of_another_material():
    """With nu/(1 - nu) in place of nu, and E/(1 - nu^2) for E, which the unit of the flank leaves out."""
    pair = unlike_pair("contact_ratio_1_1_large_shifts")
    strained = elastic_teeth(pair.with_(pinion__poisson_ratio=0.3), "strain")[0]
    stressed = elastic_teeth(pair.with_(pinion__poisson_ratio=0.3 / 0.7), "stress")[0]
    length = np.linspace(strained.wheel.tooth.form_length, 22e-3, 5)[1:-1] / strained.wheel.tooth.module
    deflection = strained.flank.deflection(length)
    expected = stressed.flank.deflection(length)
    assert deflection == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("change", "solved"),
    [
        # A flank's compliance over the modulus depends on its tooth, its bore and Poisson's ratio.
        ({"operating.pinion_torque": 70.0}, 0),
        ({"operating.pinion_speed": 2000.0}, 0),
        ({"mesh.damping_ratio": 0.08, "mesh.stiffness_factor": 1.05, "mesh.backlash": 0.1}, 0),
        ({"bearings.stiffness": 3e8, "lubricant.viscosity": 20.0, "gears.roughness": 0.6}, 0),
        ({"pinion.tip_relief": {"amount": 12.0, "start_roll_angle": 27.0}}, 0),
        ({"gears.face_width": 30.0, "gears.youngs_modulus": 190.0, "basic_rack.module": 4.0}, 0),
        ({"pinion.poisson_ratio": 0.25}, 1),
        ({"gear.bore": 25.0}, 1),
        ({"gears.bore": 12.0}, 2),
        ({"pinion.tip_diameter": 68.7}, 1),
        ({"pinion.profile_shift": 0.1}, 2),  # the tips of both keep their clearance
    ],
)
def test_a_variation_solves_again_only_the_gears_whose_form_it_changes(change, solved, monkeypatch):
    pair = new_pair("21/34", 3.0, 25.0, 1450.0, 80.0)
    pair.mesh.stiffness.curve(pair)
    count = []
    monkeypatch.setattr(
        "lumped.elasticity.gear.cached", lambda folder, sources, inputs, compute: count.append(1) or compute()
    )
    varied = pair.with_(change)
    varied.mesh.stiffness.curve(varied)
    varied.mesh.stiffness.neighbours(varied)
    assert len(count) == solved
