"""What holds for mu(xi) at any operating point: sign, bounds, switches, and the law itself."""

import math
import warnings

import numpy as np
import pytest
from hypothesis import given, reject, settings
from hypothesis import strategies as st

from lumped import load_gear_pair, preset_names
from lumped.errors import LawRangeWarning, ParameterError
from lumped.friction import LAWS
from lumped.path_of_contact import contact_path, friction_path_function

PAIRS = {name: load_gear_pair(name) for name in preset_names()}


def decades(low, high):
    return st.floats(math.log10(low), math.log10(high)).map(lambda x: 10.0**x)


@st.composite
def operating_points(draw):
    return PAIRS[draw(st.sampled_from(sorted(PAIRS)))].with_(
        operating__pinion_speed=draw(decades(10, 1e5)), operating__pinion_torque=draw(decades(0.1, 3e3)),
        lubricant__viscosity=draw(decades(1, 1e3)), pinion__roughness=draw(decades(0.02, 1.1)),
        gear__roughness=draw(decades(0.02, 1.1)), friction__maximum=draw(decades(0.01, 1)),
        friction__sharpness=draw(decades(1, 1e3)),
    )  # fmt: skip


@pytest.mark.parametrize("law", [name for name in LAWS if name != "none"])
@settings(max_examples=25)
@given(pair=operating_points(), where=st.lists(st.floats(-8.0, -2.2), min_size=5, max_size=30))
def test_any_operating_point(law, pair, where):
    path, parameters = contact_path(pair), pair.friction
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LawRangeWarning)  # the law is followed outside its range as well
        try:
            function = friction_path_function(pair, law=law)
        except ParameterError as error:
            if "mu up to" not in str(error):  # law III has no bound of its own and is refused above 1
                raise
            reject()
    assert ((function.switches > path.L_XA) & (function.switches < path.L_XD)).all()
    assert np.isin(function.switches, function.breaks).all()
    d = 10.0 ** np.array(where)
    xi = np.concatenate([path.L_XP - d, path.L_XP + d])
    xi = xi[(xi > path.L_XA) & (xi < path.L_XD)]
    near = np.abs(xi[:, None] - np.append(function.switches, path.L_XP)).min(axis=1) < 1e-11
    xi = xi[~near]
    mu = function(xi)
    # 1e-10 is the tolerance of the fit at its probes; its ripple between them may be twice that
    np.testing.assert_allclose(mu, LAWS[law].signed(xi, path, parameters), atol=2e-10, rtol=0)
    assert (mu * np.sign(xi - path.L_XP) >= -2e-10).all()  # never drives the sliding
    if law == "benedict_kelley":
        assert (np.abs(mu) <= parameters.maximum + 2e-10).all()
