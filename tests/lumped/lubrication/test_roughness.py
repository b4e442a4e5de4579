"""Are the roughness conventions what their definitions make them?"""

import pytest

from lumped import load_gear_pair
from lumped.lubrication.film import composite_roughness, mean_roughness
from lumped.path_of_contact import contact_path


def test_two_surfaces():
    assert composite_roughness(0.3, 0.4) == pytest.approx(0.5, rel=1e-15)
    assert mean_roughness(0.3, 0.4) == pytest.approx(0.35, rel=1e-15)


def test_pair_uses_them_unless_told_otherwise():
    pair = load_gear_pair("fzg_c").with_(pinion__roughness=0.3, gear__roughness=0.4)
    assert contact_path(pair).composite_roughness == pytest.approx(0.5e-6, rel=1e-14)
    assert contact_path(pair).roughness == pytest.approx(0.35e-6, rel=1e-14)
    given = pair.with_(friction__composite_roughness=0.2)
    assert contact_path(given).composite_roughness == pytest.approx(0.2e-6, rel=1e-14)
