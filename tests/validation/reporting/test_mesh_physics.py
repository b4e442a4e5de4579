"""Does the mesh physics of a report say what its parts say, and survive pairs that a method refuses?"""

import numpy as np
import pytest

import lumped
from lumped.losses import ohlendorf_of
from lumped.path_of_contact import friction_profile
from validation.reporting.chapters.losses import losses_by_law
from validation.reporting.mesh_physics import mesh_physics


@pytest.fixture(scope="module")
def coulomb():
    return lumped.load_gear_pair("fzg_c").with_(friction__law="coulomb", friction__coefficient=0.05)


@pytest.fixture(scope="module")
def motion(coulomb):
    return lumped.steady_state(coulomb, samples_per_cycle=128)


@pytest.mark.filterwarnings("ignore::lumped.errors.LawRangeWarning")
def test_closed_form_is_ohlendorf_with_the_mean_coefficient(coulomb, motion):
    row = losses_by_law(coulomb, motion, friction_profile(coulomb), quick=False).sel(law="coulomb")
    expected = 1.0 - 0.05 * ohlendorf_of(coulomb)
    assert float(row["mesh_efficiency_closed_form"]) == pytest.approx(expected, rel=1e-12)
    # Friction in the torque balance is of second order: mu^2 H_v, 5 % of the loss at mu = 0.05.
    loss = 1.0 - float(row["mesh_efficiency"])
    assert loss == pytest.approx(1.0 - expected, rel=0.05)
    # One motion, solved twice with different output grids.
    assert float(row["mesh_efficiency_dynamic"]) == pytest.approx(motion.attrs["mesh_efficiency"], rel=1e-9)


@pytest.mark.filterwarnings("ignore::lumped.errors.LawRangeWarning")
def test_quick_losses_have_the_periodic_motion_of_the_own_law_alone(coulomb, motion):
    dynamic = losses_by_law(coulomb, motion, friction_profile(coulomb), quick=True)["mesh_efficiency_dynamic"]
    assert float(dynamic.sel(law="coulomb")) == motion.attrs["mesh_efficiency"]
    assert int(np.isnan(dynamic).sum()) == dynamic.size - 1


def test_harris_map_has_the_curves_and_the_optimum_at_the_design_torque(coulomb):
    found = mesh_physics(coulomb)
    assert list(found.harris["flank"].values) == [
        "flanks as given",
        "best linear tip relief",
        "as given, energy stiffness",
    ]  # FZG C teeth have no relief: no second curve for perfect involutes
    relieved = found.harris["peak_to_peak"].sel(flank="best linear tip relief")
    best = float(found.harris["torque"][int(relieved.argmin("torque"))])
    step = float(np.diff(found.harris["torque"])[0])
    assert best == pytest.approx(coulomb.operating.pinion_torque, abs=step)
    curve = found.curves.sel(torque=coulomb.operating.pinion_torque, method="nearest")
    at = (
        found.harris["peak_to_peak"]
        .sel(flank="flanks as given")
        .interp(torque=coulomb.operating.pinion_torque)
    )
    # Constant stiffness and perfect flanks, extended contact included: nearly linear between two torques.
    assert float(at) == pytest.approx(float(curve["peak_to_peak"]), rel=1e-3)
    # The map's grid has the optimum on a node.
    assert float(found.relief["peak_to_peak"].min()) == pytest.approx(found.optimum.peak_to_peak, rel=1e-9)


def test_a_pair_that_a_method_refuses_says_why():
    # So soft a mesh that teeth would touch half a pitch outside the path: the map refuses, the rest stands.
    soft = lumped.load_gear_pair("nasa_28_28").with_(
        mesh__stiffness={"model": "rectangular", "pair_stiffness": 2e6}
    )
    found = mesh_physics(soft, quick=True)
    assert found.curves is None
    assert found.harris is None
    assert any(text.startswith("Static transmission error: ") for text in found.refused)
    assert found.components is not None
    assert found.optimum is None
    assert found.relief is None
