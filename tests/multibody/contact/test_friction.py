"""Are the multibody model's own friction laws the published ones, and those of the lumped model?"""

import numpy as np
import pytest

import lumped
from multibody.contact import friction as fr
from multibody.contact import layout as kn
from multibody.contact.kernels import nominal_friction, signed_friction
from multibody.contact.machine import machine
from multibody.run.effects import effect_flags

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


def test_actual_rolling_velocities_belong_to_the_sliding_velocity():
    pair = lumped.load_gear_pair("fzg_c").with_(mesh__contact="prescribed", friction__law="xu_kahraman")
    p = machine(pair).parameters
    xi = p[kn.L_XP] + 2e-3
    rolling = p[kn.OMEGA_P] * xi + p[kn.OMEGA_G] * (p[kn.L_XY] - xi)
    slide = 2e-3 * (p[kn.OMEGA_P] + p[kn.OMEGA_G])

    def mu(flags, factor):
        return signed_friction(p, flags, 1.0, xi, slide, factor * rolling, xi, p[kn.L_XY] - xi, 1.0)

    on = effect_flags({"sliding_velocity"})
    assert mu(on, 1.0) == pytest.approx(nominal_friction(p, xi), rel=1e-12)
    assert mu(0, 2.0) == mu(0, 1.0)
    assert mu(on, 2.0) < 0.7 * mu(on, 1.0)
