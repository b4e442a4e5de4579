"""Does plane elasticity pass sound stiffness and notice a tenth too much or too little?"""

import pytest

from lumped import load_gear_pair, preset_names
from validation.verification import tooth_stiffness as module
from validation.verification.tooth_stiffness import tooth_stiffness


@pytest.mark.parametrize("name", preset_names())
def test_presets_pass_and_a_tenth_of_the_energy_stiffness_is_seen(name, monkeypatch):
    pair = load_gear_pair(name)
    found = tooth_stiffness(pair)
    assert found.passes
    assert found.plausible
    assert found.error < 3e-3
    whole = module.energy_curve
    for factor in (0.9, 1.1):
        monkeypatch.setattr(module, "energy_curve", lambda p, factor=factor: whole(p).scaled(factor))
        wrong = {check.key: check.passes for check in tooth_stiffness(pair).checks}
        assert wrong == {"energy_elastic": False, "standard_elastic": True}


def test_a_third_of_the_standard_and_a_stiffness_no_gear_has_are_seen(pair, monkeypatch):
    stiff = pair.with_(mesh__stiffness={"model": "rectangular", "pair_stiffness": 3e8})
    found = tooth_stiffness(stiff)
    assert found.passes
    assert not found.plausible
    assert found.own == pytest.approx(3e8 * pair.geometry.contact_ratio / found.ways[0].mean, rel=1e-12)
    mean = module.iso6336.mean_of
    monkeypatch.setattr(module.iso6336, "mean_of", lambda p: 0.7 * mean(p))
    wrong = {check.key: check.passes for check in tooth_stiffness(pair).checks}
    assert wrong == {"energy_elastic": True, "standard_elastic": False}


def test_poisson_and_soft_material_do_not_matter(pair):
    # The foundation's fit has no nu, the limit has; a soft gear under as small a load is the same gear.
    other = pair.with_(pinion__poisson_ratio=0.4, gear__poisson_ratio=0.4)
    assert tooth_stiffness(other).passes
    soft = pair.with_(pinion__youngs_modulus=2.06, gear__youngs_modulus=2.06, operating__pinion_torque=0.565)
    values, same = ([c.value for c in tooth_stiffness(p).checks] for p in (pair, soft))
    assert same == pytest.approx(values, rel=1e-9)
