"""Does a factor on mu act once, on mu of every law and on all bounds of mu, and does it read what it says?

A factor that is added to `lumped.schema.friction.FACTORS` is tested here by its entry in
`tests.friction_factors.ACTING`: changes of a pair with which it acts, and its number by hand.
"""

from __future__ import annotations

import numpy as np
import pytest

from floquet.gear.axes import GEAR_AXES, GearVariation
from lumped import ParameterError
from lumped.friction.base import mean_coefficient
from lumped.friction.misfit import fit_misfit
from lumped.friction.registry import FRICTIONAL, law_of
from lumped.path_of_contact.friction import fit_law, friction_misfit, friction_path_function
from lumped.schema import friction as schema
from lumped.schema.assumed import within
from lumped.schema.changes import fields_of
from lumped.schema.fields_read import fields_read
from lumped.schema.pair import leaf_paths
from tests.friction_factors import ACTING, EXAMPLE, example_factor, with_factor
from tests.unlike_pairs import UNLIKE, unlike_pair

pytestmark = pytest.mark.filterwarnings("ignore::lumped.errors.LawRangeWarning")

FACTOR = 0.63
TABLE = {"points": [-500.0, 0.0, 10.0, 500.0], "coefficient": [0.05, 0.07, 0.06, 0.04]}
laws = pytest.mark.parametrize("law", [*FRICTIONAL, "table"])


@pytest.fixture(autouse=True)
def factor():
    with example_factor():
        yield


def both(name, law, coefficient=None):
    """A pair without and with the factor; they differ by nothing else."""
    changes = {"friction.law": law, "friction.coefficient": coefficient}
    if law == "table":
        changes["friction.table"] = TABLE
    return [with_factor(unlike_pair(name), factor, **changes) for factor in (1.0, FACTOR)]


def inside(function):
    low, high = function.interval
    return low + (high - low) * np.linspace(0.003, 0.997, 301)


@laws
@pytest.mark.parametrize("coefficient", [None, 0.04])
@pytest.mark.parametrize("name", UNLIKE)
def test_mu_has_the_factor_once_and_switches_stay(name, coefficient, law):
    """mu_avg of laws I, IV and V is the mean of law II without the factor, else it would act twice."""
    mu, scaled = (friction_path_function(pair, warn=False) for pair in both(name, law, coefficient))
    xi = inside(mu)
    np.testing.assert_allclose(scaled(xi), FACTOR * mu(xi), rtol=0.0, atol=3e-10)
    np.testing.assert_array_equal(scaled.switches, mu.switches)


@laws
@pytest.mark.parametrize("name", UNLIKE)
def test_the_bound_of_mu_has_the_factor(name, law):
    """The bound covers the fit, and has the error of the mean of law II with the factor."""
    of_means = []
    for pair in both(name, law):
        record = law_of(pair.friction)
        path = pair.nominal_contact
        function = fit_law(path, pair.friction, record.name)
        bounds = friction_misfit(pair)
        low, high = function.breaks[:-1], function.breaks[1:]
        share = np.linspace(0.002, 0.998, 41)[:, None]
        xi = low + share * (high - low)
        errors = np.abs(record.signed(xi.ravel(), path, pair.friction).reshape(xi.shape) - function(xi))
        if record.analytic is not None:
            assert (errors.max(axis=0) <= bounds).all()
        of_means.append(float((bounds - fit_misfit(function, record, path, pair.friction)).max()))
    reads_average = record.reads_average(path, pair.friction)
    assert (of_means[0] > 0.0) == reads_average
    # The difference of two bounds near 1e-12 is known to few digits.
    assert of_means[1] == pytest.approx(FACTOR * of_means[0], rel=1e-3, abs=1e-18)


@pytest.mark.parametrize("name", UNLIKE)
@pytest.mark.parametrize("law", ["coulomb", "smoothed_coulomb", "benedict_kelley", "none"])
def test_a_mean_coefficient_that_is_asked_for_is_the_mean_of_mu(name, law):
    """An axis of a chart sets the mean of |mu|, whatever the factors of the file are."""
    pair = both(name, law)[1].healthy
    axis = GEAR_AXES["friction_coefficient"]
    function = axis.apply(GearVariation.of(pair, "springs"), 0.05).cycle().elements.friction
    mean = 0.05 if law != "smoothed_coulomb" else 0.05 * _mean_of_law_four(pair, function)
    assert mean_coefficient(function) == pytest.approx(mean, rel=1e-8)


def _mean_of_law_four(pair, function):
    """Mean of law IV over mu_avg, by the integral (2/pi) d arctan(Phi d), equation (19)."""
    phi = pair.friction.sharpness
    low, high = (abs(xi - pair.nominal_contact.L_XP) for xi in function.interval)
    integrals = [2.0 / np.pi * d * np.arctan(phi * d) for d in (low, high)]
    return sum(integrals) / (low + high)


@laws
def test_what_a_factor_reads_is_read_with_every_law(law):
    pair = both("rack_25_degrees_always_pushing", law, 0.04)[1]
    for one in (*schema.FACTORS, EXAMPLE):
        for field in one.reads:
            assert all(path in fields_read(pair) for path in leaves(pair, [field]))
    assert "lubricant.viscosity_law.viscosity_index" not in fields_read(pair.with_(friction__law="none"))


def leaves(pair, fields):
    paths = {path for field in fields for path in fields_of(field)}
    return [leaf for leaf in leaf_paths(pair) if any(within(leaf, path) for path in paths)]


def value(one, pair):
    return one.value((pair.pinion, pair.gear), pair.lubricant, pair.friction)


def acting(one):
    """Pairs on which a factor acts, and the factor by hand."""
    if one is EXAMPLE:
        return [with_factor(unlike_pair(name), FACTOR) for name in UNLIKE], FACTOR
    changes, factor = ACTING[one.reads[0]]
    return [unlike_pair(name).with_(dict(changes)) for name in UNLIKE], factor


@pytest.mark.parametrize("one", [*schema.FACTORS, EXAMPLE], ids=lambda one: one.reads[0])
def test_a_factor_is_its_number_by_hand_and_reads_what_it_says(one):
    """A change of a field that it reads changes it on some pair; a change of any other field on none."""
    changed = set()
    pairs, by_hand = acting(one)
    assert 0.0 < by_hand != pytest.approx(1.0, abs=0.05)
    for pair in pairs:
        assert value(one, pair) == pytest.approx(by_hand, rel=1e-9)
        read = leaves(pair, one.reads)
        for leaf, number in leaf_paths(pair).items():
            if isinstance(number, bool) or not isinstance(number, float):
                continue
            try:
                other = pair.with_({leaf: 0.97 * number + (0.003 if number == 0.0 else 0.0)})
            except ParameterError:
                continue
            if value(one, other) != value(one, pair):
                assert leaf in read
                changed.update(field for field in one.reads if leaf in leaves(pair, [field]))
    assert changed == {*one.reads}
