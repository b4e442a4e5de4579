"""Is a model whose angles are in single precision told apart from a sound one, although both agree?"""

import numpy as np
import pytest

import lumped
from tests.validation.check.motions import lumped_motion
from tests.validation.check.test_explanations import COULOMB
from validation.check import check


@pytest.mark.parametrize("single", [True, False])
def test_angles_in_single_precision(single):
    """dte = r_p theta_p - r_g theta_g + x_p - x_g of angles with the rotation of two seconds in them."""
    pair = lumped.load_gear_pair("high_contact_ratio_29_47").with_(COULOMB)
    g = pair.geometry
    motion = lumped_motion(pair)
    place = 0.3 + np.arange(6 * 211) / 211
    time = place * g.mesh_period
    angles = {
        "p": motion.at("theta_p", place) + g.omega_pinion * (2.0 + time),
        "g": motion.at("theta_g", place) + g.omega_gear * (2.0 + time),
    }
    if single:
        angles = {end: angle.astype(np.float32).astype(float) for end, angle in angles.items()}
    dte = g.base_radius_pinion * angles["p"] - g.base_radius_gear * angles["g"]
    dte += motion.at("x_p", place) - motion.at("x_g", place)
    result = check(pair, {"time": time, "dte": dte, "x_p": motion.at("x_p", place)})
    assert result.agrees
    assert [step.name for step in result.explanations] == (["few digits"] if single else [])
    if single:
        assert result.explanations[0].factor == "dte"
        assert "single precision" in result.words
