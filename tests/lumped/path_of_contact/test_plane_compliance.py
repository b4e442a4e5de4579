"""Are the compliances of a mesh those of an independent computation, in the frames that it was made in?"""

import numpy as np
import pytest

from lumped import ParameterError, load_gear_pair, plane_compliance
from lumped.quasi_static import static_transmission_error
from lumped.quasi_static.loaded import StaticMesh
from lumped.stiffness.finite_elements import elastic_teeth, self_compliance

# of a mesh with half as many freedoms, between few loads; of other end positions
NEAR = 0.003
FAR = 0.008


@pytest.fixture(scope="module")
def free(nasa):
    return plane_compliance(nasa)


def test_stiffness_is_that_of_another_program(nasa, free):
    # Another mesh, other elements and loads, seven teeth on a ring: 1.187, 1.164, 1.093 of ISO 6336-1.
    attributes = free.attrs
    assert attributes["largest_alone"] / attributes["iso_single"] == pytest.approx(1.187, rel=NEAR)
    assert attributes["mean_alone"] / attributes["iso_mean"] == pytest.approx(1.164, rel=FAR)
    assert attributes["mean"] / attributes["iso_mean"] == pytest.approx(1.093, rel=FAR)
    assert attributes["relative_error"] < 2e-3


def test_the_matrix_is_symmetric_and_makes_the_mesh_stiffness(nasa, free):
    matrix = free.compliance.values
    both = free.compliance.values[:, 1, 1] > 0.0
    assert np.array_equal(matrix, matrix.transpose(0, 2, 1))
    (a, w), (_, d) = np.moveaxis(matrix[both], 0, -1)
    assert free.mesh_stiffness.values[both] == pytest.approx((a + d - 2.0 * w) / (a * d - w * w), rel=1e-12)
    assert free.mesh_stiffness_alone.values[both] == pytest.approx(1.0 / a + 1.0 / d, rel=1e-12)
    assert free.mesh_stiffness.values[~both] == pytest.approx(1.0 / matrix[~both, 0, 0], rel=1e-12)
    # Equal gears: the cycle reads the same backwards from the pitch point.
    g = nasa.geometry
    xi = np.linspace(g.L_XA, g.L_XD, 7)
    k = 1.0 / self_compliance(nasa, elastic_teeth(nasa), xi)
    assert k == pytest.approx(k[::-1], rel=1e-9)


def test_the_transmission_error_takes_the_whole_matrix(nasa, free):
    pair = nasa.with_(
        mesh__stiffness={"model": "finite_elements"}, mesh__contact="loaded", mesh__relief="ignored",
        pinion__tip_relief=None, gear__tip_relief=None,
    )  # fmt: skip
    force = pair.operating.pinion_torque / pair.geometry.base_radius_pinion
    phases = 2 * free.sizes["phase"]
    transmission_error = static_transmission_error(
        pair, extended=False, phases=phases
    ).transmission_error.values[0, 1::2]
    assert force / transmission_error == pytest.approx(free.mesh_stiffness.values, rel=1e-9)
    apart = static_transmission_error(pair.with_(mesh__contact="prescribed"), extended=False, phases=phases)
    alone = free.mesh_stiffness_alone.values
    assert force / apart.transmission_error.values[0, 1::2] == pytest.approx(alone, rel=1e-9)
    # Loaded contact, where no tip corner touches: one pair is the same; of two that share evenly each
    # contact is softer by D ln 2, as it is taken at half the load.
    mesh = StaticMesh(pair)
    one = free.compliance.values[:, 1, 1] == 0.0
    alone, evenly = (int(np.flatnonzero(row)[row.sum() // 2]) for row in (one, ~one))
    approach = mesh.approach(free.position.values[[alone, evenly], 0])
    softer = np.log(2.0) * mesh.law.softening / free.compliance.values[evenly, 0].sum()
    assert approach / transmission_error[[alone, evenly]] == pytest.approx([1.0, 1.0 + softer], rel=1e-4)


def test_a_bore_moves_the_clamped_gear_only(nasa, free):
    bored = nasa.with_(pinion__bore=15.0, gear__bore=15.0)
    means = {
        support: plane_compliance(bored, support=support, phases=16).attrs["mean_alone"]
        / free.attrs["iso_mean"]
        for support in ("free", "clamped", "untwisted")
    }
    # The other program: 0.616 and 1.068; free as without a bore.
    assert means["free"] == pytest.approx(free.attrs["mean_alone"] / free.attrs["iso_mean"], rel=0.01)
    assert means["clamped"] == pytest.approx(0.616, rel=FAR)
    assert means["untwisted"] == pytest.approx(1.068, rel=FAR)


def test_a_solid_gear_has_no_bore_to_be_held_at():
    with pytest.raises(ParameterError, match="no bore"):
        plane_compliance("nasa_28_28", support="clamped")


def test_a_thin_rim_is_named():
    pair = load_gear_pair("nasa_28_28").with_(gear__bore=50.0)
    assert any("rim of the gear" in text for text in plane_compliance(pair, phases=2).attrs["range_warnings"])
