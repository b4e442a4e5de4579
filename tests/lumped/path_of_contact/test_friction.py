"""Does mu_i(xi) of a pair carry the laws, their signs and their switches?"""

import warnings

import numpy as np
import pytest
from scipy.integrate import quad

from lumped import geometry, load_gear_pair
from lumped.errors import LawRangeWarning, ParameterError
from lumped.friction import LAWS, mean_coefficient
from lumped.friction.base import PITCH_RESOLUTION
from lumped.path_of_contact import (
    contact_path,
    friction_path_function,
    friction_profile,
    law_range_violations,
)
from lumped.ranges import warn_violations
from tests.unlike_pairs import unlike_pair

# The fits are asked for 1e-10; between the probes of the fit the error may be a few times that.
FIT = 1e-9


@pytest.fixture(scope="module")
def pair():
    return load_gear_pair("nasa_28_28")


@pytest.fixture(scope="module")
def free(unlike):
    """An unlike pair whose mean coefficient follows from law II."""
    return unlike.with_(friction__coefficient=None)


def direct(pair, law, xi):
    path = contact_path(pair)
    settings = pair.friction
    return LAWS[law].signed(xi, path, settings)


def test_average_of_coulomb_is_benedict_kelleys(free):
    # the paper's mu_avg; quadrature of the law itself, with the pitch point and the bounds as end points
    path = contact_path(free)
    g = geometry(free)

    def law(xi):
        return abs(float(direct(free, "benedict_kelley", np.array(xi))))

    parts = [
        quad(law, a, b, epsabs=1e-14, limit=200)[0]
        for a, b in ((g.L_XA, g.L_XP - PITCH_RESOLUTION), (g.L_XP + PITCH_RESOLUTION, g.L_XD))
    ]
    average = sum(parts) / (path.L_XD - path.L_XA)
    recess = max(g.L_XC, 0.5 * (g.L_XP + g.L_XD))  # C lies before P where the gear's shift is large
    mu = friction_path_function(free, law="coulomb")(np.array([g.L_XA, recess]))
    # the gap of 2e-8 m around P holds 1e-6 of the path with mu about 0.15
    np.testing.assert_allclose(mu, [-average, average], rtol=1e-5)


@pytest.mark.parametrize("law", ["coulomb", "smoothed_coulomb", "composite"])
def test_the_average_is_that_of_the_nominal_path_also_where_contact_is_longer(free, law):
    # boundary lubrication: law V is law IV
    slow = free.with_(operating__pinion_speed=10, lubricant={"viscosity": 5.0})
    low, high = friction_path_function(slow, law=law).interval
    longer = friction_path_function(slow, law=law, interval=(low - 5e-4, high + 3e-4))
    xi = np.linspace(low, high, 51)[1:-1]
    np.testing.assert_allclose(longer(xi), direct(slow, law, xi), atol=FIT, rtol=0)


def test_given_coefficient_replaces_the_average(unlike):
    g = geometry(unlike)
    fixed = unlike.with_(friction__coefficient=0.07)
    function = friction_path_function(fixed, law="coulomb")
    ends = [g.L_XA, g.L_XD - 1e-6]
    np.testing.assert_allclose(function(ends), [-0.07, 0.07], rtol=1e-12)  # rounding of the fit
    assert mean_coefficient(function) == pytest.approx(0.07, rel=1e-12)
    # law IV is within 4/(3 pi (Phi d)^3) of its coefficient: 5e-6 at Phi d = 31/mm * 1.4 mm
    smooth = friction_path_function(fixed, law="smoothed_coulomb")
    assert smooth(ends) == pytest.approx([-0.07, 0.07], rel=1e-5)


def test_switches_of_the_simple_laws(unlike):
    g = geometry(unlike)
    for law in ("coulomb", "xu_kahraman"):
        np.testing.assert_array_equal(friction_path_function(unlike, law=law).switches, [g.L_XP])
    assert friction_path_function(unlike, law="smoothed_coulomb").switches.size == 0
    assert friction_path_function(unlike, law="none").switches.size == 0


def test_composite_answers_for_the_laws_in_force_only(pair):
    # At 30000 rpm the film is thick: law V is III everywhere, and II's negative logarithm does not matter.
    fast = pair.with_(operating__pinion_speed=30000, operating__pinion_torque=10)
    assert (friction_profile(fast).film_parameter > 4).all()
    assert {v.law for v in law_range_violations(fast, "composite")} == {"V composite (III Xu-Kahraman)"}
    # Rough flanks at the same speed bring law II back, on part of the path or all of it.
    mixed = fast.with_(friction__composite_roughness=1.5)
    assert (friction_profile(mixed).regime == 1).all()
    (violation,) = law_range_violations(mixed, "composite")
    assert violation.law == "V composite (II Benedict-Kelley)"
    assert violation.share == law_range_violations(fast, "benedict_kelley")[0].share


@pytest.mark.parametrize("name", ["rack_25_degrees_always_pushing", "larger_gear_drives_contact_lost"])
def test_composite_switches_at_its_film_parameters(name):
    # Walk through the speeds where the path straddles a threshold and look at every switch but P.
    seen = set()
    smooth = unlike_pair(name).with_(friction__composite_roughness=0.2)
    for speed in np.geomspace(30, 8000, 20):
        pair = smooth.with_(operating__pinion_speed=float(speed))
        path = contact_path(pair)
        function = friction_path_function(pair, law="composite")
        film = path.film_parameter(function.switches)
        for limit in (1.0, 4.0):
            hits = np.abs(film - limit) < 1e-12  # roots are found to 1e-14 of their distance from P
            seen |= {limit} if hits.any() else set()
        values = path.film_parameter(np.linspace(path.L_XA, path.L_XD, 2001))
        crossings = sum(int(np.abs(np.diff(np.sign(values - limit))).sum() / 2) for limit in (1.0, 4.0))
        assert (np.abs(film[:, None] - [1.0, 4.0]).min(axis=1) < 1e-12).sum() == crossings
    assert seen == {1.0, 4.0}


def test_a_law_that_cannot_take_the_roughness_is_left_out_with_its_reason(pair):
    rough = pair.with_(pinion__roughness=1.3, gear__roughness=1.3, friction__coefficient=0.06)
    profile = friction_profile(rough)
    assert "benedict_kelley" not in profile.law
    # law V asks law II only where the film parameter does: at 0.144 um composite roughness it is III here
    assert "composite" in profile.law
    (reason,) = profile.attrs["left_out"]
    assert "1.13 um" in reason
    with pytest.raises(ParameterError, match="roughness"):
        friction_path_function(rough, law="benedict_kelley")


def test_unknown_law_is_refused_by_name(pair):
    with pytest.raises(ParameterError, match=r"friction.law = amontons: allowed one of none, coulomb"):
        friction_path_function(pair, law="amontons")


def test_thin_oil_leaves_the_range_of_law_three_and_says_so(pair):
    thin = pair.with_(lubricant__viscosity=0.5)
    violations = law_range_violations(thin, "xu_kahraman")
    assert [v.range.quantity for v in violations] == ["viscosity"]
    assert violations[0].share == 1.0
    with pytest.warns(LawRangeWarning, match="III Xu-Kahraman: viscosity"):
        warn_violations(violations)
    assert any("viscosity" in text for text in friction_profile(thin).attrs["range_warnings"])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert law_range_violations(pair, "xu_kahraman") == ()


def test_a_law_that_leaves_all_bounds_is_refused_with_its_reason(pair):
    # exp(-|SR| p_h log10(eta)) with eta < 1 mPa s: law III's double exponential, mu of 1e5 and more
    thin = pair.with_(lubricant__viscosity=0.15, operating__pinion_torque=3000)
    with pytest.raises(
        ParameterError, match=r"friction.law = xu_kahraman with mu up to .*viscosity >= 1 mPa s"
    ):
        friction_path_function(thin, law="xu_kahraman")
