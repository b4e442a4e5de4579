"""Is every law what its record says? One test for each property, for all registered laws and a user's table.

Fits, bounds and charts read these properties and know nothing else of a law. A law that is added to the
registry is tested here without another line. Where a test fails, mend the record or the law.
"""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from lumped.friction.average_coefficient import average_coefficient, longer_path, mean_of_law_two
from lumped.friction.base import fit_signed, mean_coefficient
from lumped.friction.registry import LAWS
from lumped.friction.table import FrictionTable
from lumped.path_of_contact.friction import friction_misfit, friction_path_function
from tests.unlike_pairs import UNLIKE, unlike_pair

PAIRS = {name: unlike_pair(name) for name in UNLIKE}
#: A user's table from far before to far behind any path, in mm.
TABLE = FrictionTable(points=(-500.0, 0.0, 10.0, 500.0), coefficient=(0.05, 0.07, 0.06, 0.04)).law
RECORDS = {**LAWS, "table": TABLE}
#: Oil from winter to summer, as the law of the viscosity has it [degC]; a parameter that falls or rises with
#: temperature is seen at both ends.
TEMPERATURES = (0.0, 20.0, 40.0, 90.0)
SPEEDS = (200.0, 1000.0, 6000.0)
#: Factors on mu: what a record says of the formula holds of mu with any of them.
FACTORS = (1.0, 0.63, 1.3, 0.8)

law_names = pytest.mark.parametrize("name", RECORDS)


def cases(name, coefficient=None):
    """Path, settings and positions of all pairs at all temperatures, with unlike speeds and factors."""
    for k, pair in enumerate(PAIRS.values()):
        for j, celsius in enumerate(TEMPERATURES):
            changes = {
                "lubricant.viscosity": None,
                "lubricant.viscosity_law": {"iso_vg": 68, "temperature": celsius},
                "friction.coefficient": coefficient,
                "operating.pinion_speed": SPEEDS[(k + j) % 3],
                "pinion.roughness": 0.3 + 0.1 * j,
            }
            varied = pair.with_(changes)
            path = replace(varied.nominal_contact, friction_factor=FACTORS[(k + 3 * j) % 4])
            # Off the pitch point and off the middle of the path, where rounding would hide a wrong sign.
            share = np.linspace(0.013, 0.987, 61)
            xi = path.L_XA + share * (path.L_XD - path.L_XA)
            yield path, varied.friction, xi[np.abs(xi - path.L_XP) > 1e-6]


def with_mean(path, mean):
    return replace(path, law_two_mean=mean)


@law_names
def test_mu_moves_with_mu_avg_no_more_than_average_slope_says(name):
    """|d mu/d mu_avg|: a proven bound of mu adds this slope times the error of the mean of law II."""
    law = RECORDS[name]
    reads = False
    for path, settings, xi in cases(name):
        mean = mean_of_law_two(path, settings)
        paths = [with_mean(path, mean * (1.0 + step)) for step in (-0.3, 0.0, 0.4)]
        averages = [average_coefficient(one, settings) for one in paths]
        mu = [law.signed(xi, one, settings) for one in paths]
        for k in (0, 2):
            change = np.abs(mu[k] - mu[1]).max()
            reads |= change > 0.0
            assert change <= law.change_by_average(path) * abs(averages[k] - averages[1]) * (1.0 + 1e-9)
    assert reads == (law.average_slope > 0.0), "average_slope is 0 for a law without mu_avg alone"
    assert reads == ("coefficient" in (law.reads or ()))


def test_mu_avg_is_proportional_to_the_mean_of_law_two():
    """The bound on the error of mu_avg is mu_avg of the bound: a factor may depend on all but the mean."""
    for path, settings, _ in cases("coulomb"):
        for mean in (1e-13, 0.02, 0.07):
            unit = average_coefficient(with_mean(path, 1.0), settings)
            assert average_coefficient(with_mean(path, mean), settings) == pytest.approx(
                mean * unit, rel=1e-12
            )
    for path, settings, _ in cases("coulomb", coefficient=0.05):
        assert average_coefficient(path, settings) == average_coefficient(with_mean(path, 0.9), settings)


@pytest.mark.parametrize("name", [name for name, law in RECORDS.items() if law.average_slope])
@pytest.mark.parametrize("coefficient", [None, 0.04])
def test_mu_avg_acts_once_on_a_path_that_is_longer(name, coefficient):
    """Loaded teeth touch before A and behind D. mu_avg is not taken once more from a mu that has it."""
    law = RECORDS[name]
    for path, settings, xi in cases(name, coefficient):
        more = 0.1 * (path.L_XD - path.L_XA)
        longer = longer_path(path, (path.L_XA - 0.2 * more, path.L_XD + more), law, settings)
        np.testing.assert_array_equal(law.signed(xi, longer, settings), law.signed(xi, path, settings))
        if law.reads_average(longer, settings):
            assert average_coefficient(longer, settings) == average_coefficient(path, settings)


@law_names
def test_coefficient_says_that_mu_is_one_number_far_from_the_pitch_point(name):
    law = RECORDS[name]
    for path, settings, xi in cases(name):
        far = np.abs(xi - path.L_XP) > 0.2 * (path.L_XD - path.L_XA)
        mu = np.abs(law.signed(xi, path, settings))[far]
        if law.coefficient:
            average = path.friction_factor * average_coefficient(path, settings)
            assert mu == pytest.approx(average, rel=1e-3)


@law_names
@pytest.mark.parametrize("coefficient", [None, 0.05])
def test_a_law_that_does_not_vary_has_the_same_mu_at_every_speed_load_and_oil(name, coefficient):
    law = RECORDS[name]
    varies = False
    for path, settings, xi in cases(name, coefficient):
        mu = law.signed(xi, path, settings)
        for other in (
            path.at_speed(0.37 * path.omega_pinion),
            replace(path, unit_load=2.0 * path.unit_load),
            replace(path, viscosity=0.3 * path.viscosity),
            replace(path, roughness=0.5 * path.roughness, composite_roughness=0.5 * path.composite_roughness),
        ):
            varies |= bool((mu != law.signed(xi, other, settings)).any())
    assert varies == (not law.is_constant(settings))


@law_names
def test_over_speed_mu_is_scaled_by_factor_or_raised_by_shift(name):
    """Between switches; of a law made of others where one of them has the whole path, as charts take it."""
    law = RECORDS[name]
    for path, settings, xi in cases(name):
        mu = law.signed(xi, path, settings)
        for ratio in (0.4, 0.93, 1.1, 3.0):
            other = path.at_speed(ratio * path.omega_pinion)
            used = parts_in_force(law, path, settings)
            if len(used) != 1 or parts_in_force(law, other, settings) != used:
                continue
            (part,) = used
            moved_mu = law.signed(xi, other, settings)
            if part.factor is not None:
                before, after = part.factor(path, settings), part.factor(other, settings)
                np.testing.assert_allclose(moved_mu * before, mu * after, rtol=1e-12, atol=1e-18)
            if part.shift is not None:
                size = part.rise(other, settings) - part.rise(path, settings)
                bound = path.friction_factor * settings.maximum
                inside = free(mu, bound) & free(moved_mu, bound)
                np.testing.assert_allclose(np.abs(moved_mu)[inside], (np.abs(mu) + size)[inside], rtol=1e-11)


def parts_in_force(law, path, settings):
    if law.parts is None:
        return [law]
    return [part for part, inside in law.parts(path.sampled_positions, path, settings) if inside.any()]


def free(mu, bound):
    """Where |mu| is between 0 and the bound of law II."""
    return (np.abs(mu) > 0.0) & (np.abs(mu) < bound * (1.0 - 1e-12))


@pytest.mark.parametrize("name", [name for name, law in RECORDS.items() if law.parts])
def test_parts_are_the_law_and_have_every_position_once(name):
    law = RECORDS[name]
    several = False
    for path, settings, xi in cases(name):
        parts = law.parts(xi, path, settings)
        assert (sum(inside.astype(int) for _, inside in parts) == 1).all()
        several |= sum(inside.any() for _, inside in parts) > 1
        mu = law.signed(xi, path, settings)
        for part, inside in parts:
            np.testing.assert_array_equal(mu[inside], part.signed(xi[inside], path, settings))
        assert law.average_slope >= max(part.average_slope for part, _ in parts)
        assert law.roundings >= max(part.roundings for part, _ in parts)
    assert several


@pytest.mark.parametrize("name", [name for name, law in RECORDS.items() if law.analytic])
def test_no_mu_is_larger_than_the_bound_in_its_ellipse(name):
    """On the real axis, for pieces at the pitch point and away from it; ellipses are in test_misfit."""
    law = RECORDS[name]
    for path, settings, _ in cases(name):
        fit = fit_signed(law, path, settings)
        low, high = fit.breaks[:-1], fit.breaks[1:]
        _, most = law.most_around(low, high, path, settings)
        share = np.linspace(0.001, 0.999, 31)[:, None]
        mu = law.signed((low + share * (high - low)).ravel(), path, settings).reshape(31, -1)
        assert (np.abs(mu).max(axis=0) <= most * (1.0 + 1e-12)).all()


@law_names
def test_between_switches_and_the_pitch_point_mu_has_no_jump(name):
    law = RECORDS[name]
    for path, settings, _ in cases(name):
        ends = [path.L_XA, path.L_XP, path.L_XD, *law.switches(path, settings)]
        ends = np.unique(np.clip([*ends, *law.joints(path)], path.L_XA, path.L_XD))
        for low, high in itertools.pairwise(ends):
            xi = np.linspace(low, high, 2002)[1:-1]
            steps = np.abs(np.diff(law.signed(xi, path, settings)))
            # A jump would be one step of its size among the small ones of a smooth curve. Next to the pitch
            # point law IV rises within 1/sharpness.
            rising = np.abs(xi[:-1] - path.L_XP) < 20.0 / settings.sharpness + 0.02 * (high - low)
            assert steps[~rising].max(initial=0.0) < 2e-3


@law_names
def test_mu_has_the_sign_of_the_sliding_velocity(name):
    for path, settings, xi in cases(name):
        assert (RECORDS[name].signed(xi, path, settings) * (xi - path.L_XP) >= 0.0).all()


@law_names
def test_beyond_the_edge_of_an_undercut_mu_is_that_at_the_edge(name):
    law = RECORDS[name]
    for path, settings, _ in cases(name):
        span = path.L_XD - path.L_XA
        cut = replace(path, edge_pinion=path.L_XA + 0.1 * span, edge_gear=path.L_XY - path.L_XD + 0.2 * span)
        xi = np.array([path.L_XA, cut.edge_pinion, path.L_XY - cut.edge_gear, path.L_XD])
        at_start, at_edge_pinion, at_edge_gear, at_end = law.signed(xi, cut, settings)
        assert (at_start, at_end) == (at_edge_pinion, at_edge_gear)


@pytest.mark.parametrize("celsius", TEMPERATURES)
@pytest.mark.parametrize("law", ["coulomb", "smoothed_coulomb", "composite"])
def test_the_bound_covers_the_error_of_the_mean_of_law_two(law, celsius):
    """The mean is computed once more with 2000 Gauss points a piece: it differs by less than its share."""
    for pair in PAIRS.values():
        varied = pair.with_({
            "friction.law": law, "friction.coefficient": None, "lubricant.viscosity": None,
            "lubricant.viscosity_law": {"iso_vg": 68, "temperature": celsius},
        })  # fmt: skip
        path = varied.nominal_contact
        settings = varied.friction
        if not LAWS[law].reads_average(path, settings):
            continue
        two = fit_signed(LAWS["benedict_kelley"], path, settings)
        nodes, weights = np.polynomial.legendre.leggauss(400)
        low, high = two.breaks[:-1, None], two.breaks[1:, None]
        xi = 0.5 * (low + high) + 0.5 * (high - low) * nodes
        exact = np.abs(LAWS["benedict_kelley"].signed(xi.ravel(), path, settings)).reshape(xi.shape)
        mean = float((0.5 * (high - low) * weights * exact).sum()) / (path.L_XD - path.L_XA)
        error = abs(mean - mean_coefficient(two)) / mean
        function = friction_path_function(varied, warn=False)
        bounds = friction_misfit(varied)
        middles = 0.5 * (function.breaks[:-1] + function.breaks[1:])
        far = np.abs(middles - path.L_XP) > 0.2 * (path.L_XD - path.L_XA)
        true_mean = with_mean(path, mean)
        change = np.abs(LAWS[law].signed(middles, true_mean, settings) - function(middles))
        assert (change <= bounds * (1.0 + 1e-9) + 1e-17)[far].all(), error
        assert math.isfinite(error)
