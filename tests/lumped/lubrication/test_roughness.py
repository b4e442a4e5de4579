"""Are the roughness conventions what their definitions make them?"""

import numpy as np
import pytest

from lumped import load_gear_pair
from lumped.errors import ParameterError
from lumped.lubrication.roughness import composite_roughness, mean_from_rms, mean_roughness, rms_from_mean
from lumped.path_of_contact import contact_path


def test_sine_profile():
    z = np.sin(np.linspace(0, 2 * np.pi, 10_000, endpoint=False))
    # the trapezoidal rule on |sin| has an error of 1/n^2, 1e-8
    assert rms_from_mean(np.abs(z).mean(), "sine") == pytest.approx(np.sqrt((z**2).mean()), rel=1e-7)


def test_gaussian_profile():
    seed = 3
    z = np.random.default_rng(seed).normal(size=2_000_000)
    # the ratio of the two sample means scatters by about 0.5/sqrt(2e6) = 4e-4 (seed 3); four times that
    assert np.sqrt((z**2).mean()) == pytest.approx(float(rms_from_mean(np.abs(z).mean())), rel=1.6e-3)


@pytest.mark.parametrize("profile", ["gaussian", "sine"])
def test_inverse(profile):
    assert mean_from_rms(rms_from_mean(0.4, profile), profile) == pytest.approx(0.4, rel=1e-15)


def test_two_surfaces():
    assert composite_roughness(0.3, 0.4) == pytest.approx(0.5, rel=1e-15)
    assert mean_roughness(0.3, 0.4) == pytest.approx(0.35, rel=1e-15)


def test_pair_uses_them_unless_told_otherwise():
    pair = load_gear_pair("fzg_c").with_(pinion__roughness=0.3, gear__roughness=0.4)
    assert contact_path(pair).composite_roughness == pytest.approx(0.5e-6, rel=1e-14)
    assert contact_path(pair).roughness == pytest.approx(0.35e-6, rel=1e-14)
    given = pair.with_(friction__composite_roughness=0.2)
    assert contact_path(given).composite_roughness == pytest.approx(0.2e-6, rel=1e-14)


def test_unknown_profile_is_refused():
    with pytest.raises(ParameterError, match="gaussian, sine"):
        rms_from_mean(0.4, "square")
