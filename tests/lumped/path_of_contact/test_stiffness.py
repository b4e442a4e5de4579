"""Do the labelled views of the stiffness hold together?"""

import numpy as np
import pytest

from lumped import geometry, load_gear_pair, mesh_stiffness, preset_names, stiffness_components
from lumped.path_of_contact import pair_stiffness
from lumped.path_of_contact.stiffness import iso_comparison
from lumped.stiffness.energy import EnergyStiffness


def test_components_add_up_to_the_pair_of_the_energy_model():
    pair = load_gear_pair("nasa_28_28").with_(mesh__stiffness={"model": "energy"})
    data = stiffness_components(pair, 31)
    assert list(data.component.values[:2]) == ["contact", "bending pinion"]
    assert 1 / data.compliance.sum("component").values == pytest.approx(data.stiffness.values, rel=1e-12)
    k = pair_stiffness(pair)
    inner = data.position.values[1:-1]
    assert data.stiffness.values[1:-1] == pytest.approx(k(inner), rel=1e-9)  # fit tolerance 1e-10
    # Equal gears: what the pinion is at A the gear is at D.
    mirrored = data.compliance.sel(component="bending gear").values[::-1]
    assert data.compliance.sel(component="bending pinion").values == pytest.approx(mirrored, rel=1e-9)
    assert data.compliance.attrs["units"] == "m/N"


@pytest.mark.parametrize("name", ["nasa_28_28", "fzg_c"])
def test_total_is_the_sum_of_the_pairs_and_has_the_stated_mean(name):
    pair = load_gear_pair(name).with_(mesh__stiffness={"model": "energy"})
    data = mesh_stiffness(pair, 4000)
    assert data.mesh_stiffness.values == pytest.approx(data.pair_stiffness.sum("pair").values, rel=1e-12)
    # Midpoint rule of 4000 with one jump per cycle.
    assert float(data.mesh_stiffness.mean()) == pytest.approx(data.attrs["mean"], rel=2e-4)
    loaded = (data.pair_stiffness > 0).sum("pair").mean()
    assert float(loaded) == pytest.approx(geometry(pair).contact_ratio, abs=1 / 4000)


@pytest.mark.parametrize("name", preset_names())
def test_difference_from_iso_splits_into_size_and_shape(name):
    pair = load_gear_pair(name)
    data = iso_comparison(pair)
    np.testing.assert_allclose(data.mean_ratio, data.single_ratio * data.shape_ratio, rtol=1e-14)
    own = mesh_stiffness(pair.with_(mesh__stiffness={"model": "energy"})).attrs
    assert float(data.mean_ratio.sel(variant="as given")) == pytest.approx(
        own["mean"] / own["iso_mean"], rel=1e-12
    )
    # The standard's straight line 0.75 eps + 0.25 follows the shape of the curve to a few per cent, so the
    # difference between both methods is one of size.
    assert float(data.shape_ratio.sel(variant="as given")) == pytest.approx(1.0, abs=0.03)


@pytest.mark.parametrize("name", preset_names())
def test_load_stiffens_the_contact_by_the_logarithm(name):
    # 1/k falls by D ln(1600/100) at every position, D of EnergyStiffness.softening: seen in the largest
    # stiffness, at one position for both loads but for its flat top.
    pair = load_gear_pair(name)
    data = iso_comparison(pair)
    low, high = (
        float(data.single_ratio.sel(variant=v)) * data.attrs["iso_single"] for v in ("100 N/mm", "1600 N/mm")
    )
    softening = EnergyStiffness().softening(pair)
    assert 1 / low - 1 / high == pytest.approx(softening * np.log(16.0), rel=1e-3)


@pytest.mark.parametrize("stiffness", [
    {"model": "energy"},
    {"model": "energy", "scale": "iso6336"},
    {"model": "rectangular"},
    {"model": "parabolic"},
])  # fmt: skip
def test_a_thin_rim_is_flagged_once_by_every_computed_stiffness(stiffness):
    # Root circle of 50 teeth of 3 mm: 142.5 mm.
    pair = load_gear_pair("kahraman_blankenship_50_50").with_(mesh__stiffness=stiffness, gear__bore=71.0)
    assert pair.mesh.stiffness.violations(pair) == ()
    thin = pair.with_(gear__bore=72.0)
    (rim,) = thin.mesh.stiffness.violations(thin)
    assert rim.law == "rim of the gear"
