"""Do the labelled views of the stiffness hold together?"""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
import pytest

from lumped import GearPair, geometry, load_gear_pair, mesh_stiffness, stiffness_components
from lumped.path_of_contact import pair_stiffness
from lumped.path_of_contact.stiffness import FACTORS, contact_softening, cross_compliances, stiffness_factor
from multibody.elasticity.pair import _factor_on_stiffness


def test_components_add_up_to_the_pair_of_the_energy_model(unlike):
    pair = unlike.with_(mesh__stiffness={"model": "energy"})
    data = stiffness_components(pair, 31)
    assert list(data.component.values[:2]) == ["contact", "bending pinion"]
    assert 1 / data.compliance.sum("component").values == pytest.approx(data.stiffness.values, rel=1e-12)
    k = pair_stiffness(pair)
    inner = data.position.values[1:-1]
    assert data.stiffness.values[1:-1] == pytest.approx(k(inner), rel=1e-9)  # fit tolerance 1e-10
    # Each gear drives once: what the pinion is at A, the same gear is at D where it is driven.
    swapped = pair.with_(pinion=pair.gear, gear=pair.pinion)
    mirrored = stiffness_components(swapped, 31).compliance.sel(component="bending gear").values[::-1]
    assert data.compliance.sel(component="bending pinion").values == pytest.approx(mirrored, rel=1e-9)
    assert data.compliance.attrs["units"] == "m/N"


def test_total_is_the_sum_of_the_pairs_and_has_the_stated_mean(unlike):
    pair = unlike.healthy.with_(mesh__contact="prescribed")
    data = mesh_stiffness(pair, 4000)
    assert data.mesh_stiffness.values == pytest.approx(data.pair_stiffness.sum("pair").values, rel=1e-12)
    # Midpoint rule of 4000 with one jump per cycle.
    assert float(data.mesh_stiffness.mean()) == pytest.approx(data.attrs["mean"], rel=2e-4)
    loaded = (data.pair_stiffness > 0).sum("pair").mean()
    assert float(loaded) == pytest.approx(geometry(pair).contact_ratio, abs=1 / 4000)


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


class Acting(NamedTuple):
    """Changes with which a factor acts, and this factor by hand, which may depend on the pair; far from 1."""

    changes: Mapping[str, Any]
    factor: Callable[[GearPair], float]


#: Field of each factor on k -> how it acts.
ACTING = {"mesh.stiffness_factor": Acting({"mesh.stiffness_factor": 0.83}, lambda pair: 0.83)}


@pytest.mark.parametrize("field", FACTORS)
def test_a_factor_is_its_number_by_hand_on_all_that_a_pair_gives_and_in_both_models(unlike, field):
    """k with it, the growth of k with load and the coupling of pairs, which are compliances, by it."""
    pair = unlike.with_({"mesh.stiffness": {"model": "finite_elements"}})
    other = pair.with_(ACTING[field].changes)
    by_hand = ACTING[field].factor(pair)
    assert by_hand != pytest.approx(1.0, abs=0.05)
    factor = stiffness_factor(other) / stiffness_factor(pair)
    assert factor == pytest.approx(by_hand, rel=1e-9)
    assert _factor_on_stiffness(other) / _factor_on_stiffness(pair) == pytest.approx(by_hand, rel=1e-9)
    k = pair_stiffness(pair)
    low, high = k.interval
    xi = low + (high - low) * np.linspace(0.01, 0.99, 23)
    assert pair_stiffness(other)(xi) == pytest.approx(by_hand * k(xi), rel=1e-9)
    assert contact_softening(other) == pytest.approx(contact_softening(pair) / by_hand, rel=1e-9)
    assert len(cross_compliances(pair)) > 0
    for before, after in zip(cross_compliances(pair), cross_compliances(other), strict=True):
        assert after(xi) == pytest.approx(before(xi) / by_hand, rel=1e-9, abs=1e-25)
