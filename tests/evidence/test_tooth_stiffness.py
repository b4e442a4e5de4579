"""Does plane elasticity pass sound stiffness and notice a tenth too much or too little?"""

import numpy as np
import pytest

from lumped import load_gear_pair, plane_compliance, preset_names
from tests.evidence import tooth_stiffness as module
from tests.evidence.tooth_stiffness import tooth_stiffness

KEYS = ["energy_elastic", "standard_elastic", "free_elastic", "stiffness_read"]


def failing(found):
    return [check.key for check in found.checks if not check.passes]


@pytest.mark.parametrize("name", preset_names())
def test_presets_pass_and_a_tenth_of_the_energy_stiffness_is_seen(name, monkeypatch):
    pair = load_gear_pair(name)
    found = tooth_stiffness(pair)
    assert found.passes
    assert found.allowed is None
    assert found.off == 0.0
    assert found.error < 3e-3
    whole = module.energy_curve
    for factor in (0.9, 1.1):
        monkeypatch.setattr(module, "energy_curve", lambda p, factor=factor: whole(p).scaled(factor))
        assert failing(tooth_stiffness(pair)) == ["energy_elastic"]


def test_each_way_is_seen_to_be_wrong(pair, monkeypatch):
    for fault, target, name, seen in (
        (
            lambda whole: lambda p: 0.85 * whole(p),
            module.iso6336,
            "mean_of",
            ["standard_elastic", "stiffness_read"],
        ),
        (lambda whole: lambda p: whole(p).scaled(1.01), module, "pair_stiffness", ["stiffness_read"]),
    ):
        with monkeypatch.context() as change:
            change.setattr(target, name, fault(getattr(target, name)))
            assert failing(tooth_stiffness(pair)) == seen


def test_what_both_models_read_is_what_the_model_says(pair):
    for stiffness in (
        {"model": "energy"},
        {"model": "energy", "hertz": "linear"},
        {"model": "energy", "scale": "iso6336"},
        {"model": "parabolic"},
        {"model": "finite_elements"},
    ):
        found = tooth_stiffness(pair.with_(mesh__stiffness=stiffness))
        assert found.passes
        assert [check.key for check in found.checks] == KEYS
    assert found.ways[-1].mean == pytest.approx(found.ways[1].mean, rel=1e-4)  # midpoints


def test_a_stiffness_that_is_given_is_doubted_by_a_tenth(pair):
    # Of a pair alone, from plane stress to plane strain, where the same gears are held nowhere.
    stress, strain = (plane_compliance(pair, plane=plane, phases=1).attrs for plane in ("stress", "strain"))
    for size, off in ((0.9, -1), (1.0, 0), (1.03, 0), (1.1, 1)):
        k = size * stress["mean_alone"] / pair.geometry.contact_ratio
        given = pair.with_(mesh__stiffness={"model": "rectangular", "pair_stiffness": k})
        found = tooth_stiffness(given)
        assert [check.key for check in found.checks] == KEYS[:-1]
        assert found.passes
        assert np.sign(found.off) == off
        low, high = found.allowed
        assert low == pytest.approx(stress["mean_alone"] * (0.99 - stress["relative_error"]), rel=1e-12)
        assert high == pytest.approx(strain["mean_alone"] * (1.01 + strain["relative_error"]), rel=1e-12)
    assert found.off == pytest.approx(found.ways[-1].mean / high - 1.0, rel=1e-12)
    # A thin rim is as stiff as what holds it.
    thin = given.with_(pinion__bore=60.0, gear__bore=60.0)
    low, high = tooth_stiffness(thin).allowed
    assert low < 0.8 * stress["mean_alone"]
    assert high > strain["mean_alone"]


def test_poisson_and_soft_material_do_not_matter(pair):
    # The foundation's fit has no nu, the limit has; a soft gear under as small a load is the same gear.
    other = pair.with_(pinion__poisson_ratio=0.4, gear__poisson_ratio=0.4)
    assert tooth_stiffness(other).passes
    soft = pair.with_(pinion__youngs_modulus=2.06, gear__youngs_modulus=2.06, operating__pinion_torque=0.565)
    values, same = ([c.value for c in tooth_stiffness(p).checks] for p in (pair, soft))
    assert same == pytest.approx(values, rel=1e-9)
