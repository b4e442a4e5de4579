"""Do friction laws say what their sources say, under every name, and does mu(xi) of a pair follow them?"""

import math
import warnings

import numpy as np
import pytest
from hypothesis import given, reject, settings
from hypothesis import strategies as st

from lumped import load_gear_pair, preset_names
from lumped.errors import LawRangeWarning, ParameterError
from lumped.friction import LAWS, benedict_kelley, composite, coulomb, smoothed_coulomb, xu_kahraman
from lumped.friction.registry import file_name
from lumped.friction.xu_kahraman import B
from lumped.path_of_contact import contact_path, friction_path_function


def test_benedict_kelley_is_bounded():
    assert benedict_kelley(100, 10, 0.0, 10, 0.4) == 0.2  # pole at the pitch point: the visible bound
    assert benedict_kelley(100, 10, 0.0, 10, 0.4, maximum=0.1) == 0.1
    assert benedict_kelley(100, 10, 0.0, 10, 0.4, maximum=math.inf) == math.inf
    # the logarithm is negative where 29700 w < eta v_s v_e^2, here 2.97e6 < 4e6
    assert benedict_kelley(100, 100, 100, 20, 0.4) == 0.0


@pytest.mark.parametrize("roughness", [1.13, 1.5, 30.0])
def test_benedict_kelley_refuses_its_pole_in_roughness(roughness):
    with pytest.raises(ParameterError, match=r"roughness = .* um: allowed 0 <= S < 1.13 um .* smoother"):
        benedict_kelley(100, 10, 2, 10, roughness)


@pytest.mark.parametrize(("field", "arguments"), [
    ("unit_load", (-1, 10, 2, 10, 0.4)),
    ("viscosity", (100, 0, 2, 10, 0.4)),
    ("sliding_velocity", (100, 10, -2, 10, 0.4)),
    ("entraining_velocity", (100, 10, 2, math.nan, 0.4)),
    ("roughness", (100, 10, 2, 10, -0.1)),
])  # fmt: skip
def test_benedict_kelley_names_a_bad_argument(field, arguments):
    with pytest.raises(ParameterError, match=field):
        benedict_kelley(*arguments)


def test_xu_kahraman_vanishes_in_pure_rolling_with_the_power_of_its_regression():
    # SR -> 0: the exponential of f tends to exp(b1 + b5 + b9 exp(S)), so mu ~ |SR|^b3
    _, _, b3, *_ = B
    small, smaller = xu_kahraman(1.0, np.array([1e-8, 1e-9]), 10, 10, 0.3, 0.008)
    # the exponent's first correction is (b4 - b5) SR p_h log10(eta) = 3e-8, far below 1e-7
    assert math.log10(small / smaller) == pytest.approx(b3, abs=1e-7)
    assert xu_kahraman(1.0, 0.0, 10, 10, 0.3, 0.008) == 0.0


def test_coulomb_changes_sign_at_the_pitch_point():
    np.testing.assert_array_equal(coulomb(0.05, [-3.0, -1e-12, 0.0, 2.0]), [-0.05, -0.05, 0.0, 0.05])


def test_smoothed_coulomb_is_the_derivative_it_claims_to_be():
    mu = 0.06
    phi = 50.0
    d = np.linspace(-0.3, 0.3, 41)
    step = 1e-30  # complex step: the derivative without subtraction, exact to rounding
    potential = 2 * mu / np.pi * (d + 1j * step) * np.arctan(phi * (d + 1j * step))
    np.testing.assert_allclose(smoothed_coulomb(mu, d, phi), potential.imag / step, rtol=1e-13, atol=1e-18)


def test_composite_takes_the_law_of_each_regime():
    film = np.array([0.2, 0.999, 1.0, 3.999, 4.0, 9.999, 10.0, 50.0])
    chosen = composite(film, 4.0, 2.0, 3.0)
    np.testing.assert_array_equal(chosen, [4.0, 4.0, 2.0, 2.0, 3.0, 3.0, 3.0, 3.0])


def test_composite_thresholds_are_parameters():
    np.testing.assert_array_equal(composite([0.5, 1.5, 2.5], 4.0, 2.0, 3.0, (1.0, 2.0, 3.0)), [4.0, 2.0, 3.0])
    with pytest.raises(ParameterError, match="three increasing"):
        composite(1.0, 4.0, 2.0, 3.0, (4.0, 1.0, 10.0))


NAMES = [
    (law.name, spelled)
    for law in LAWS.values()
    for text in (law.name, law.label, law.numeral, law.title)
    for spelled in (text, text.upper(), text.lower(), text.replace("-", " "), f"law {text}")
    if text
]


@pytest.mark.parametrize(("name", "spelled"), NAMES)
def test_a_law_is_found_as_tables_and_reports_call_it(nasa, name, spelled):
    assert LAWS[file_name(spelled)] is LAWS[name]
    assert nasa.with_(friction__law=spelled).friction.law == name


@pytest.mark.parametrize("text", ["VI", "", "2", "coulombs law of 1785", "friction"])
def test_any_other_name_is_refused_with_the_list(nasa, text):
    with pytest.raises(ParameterError, match="one of none, coulomb"):
        nasa.with_(friction__law=text)


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
    path = contact_path(pair)
    parameters = pair.friction
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
