"""The posterior of linear data has a closed form: the mixture must give it."""

import numpy as np
import pytest
from scipy.linalg import cholesky
from scipy.stats import multivariate_normal

from validation.calibrate.discrepancy import LEVELS, prior_of_levels
from validation.calibrate.fit import Minimum, Motions
from validation.calibrate.forms import Form
from validation.calibrate.mixture import by_levels, component, draws, mixture, moments, pareto_shape

FORM = Form((), 1.0)
RNG = np.random.default_rng(5)
SLOPES = RNG.standard_normal((6, 3))
DATA = RNG.standard_normal(6)
NOISE = 0.4 * np.eye(6) + 0.1


def _component(offset, level=0.0, prior=1.0, covariance=NOISE, at=None, slopes=SLOPES):
    """Component about a point: data = offset + slopes z."""
    z = np.zeros(3) if at is None else at
    motions = Motions(offset + slopes @ z, np.zeros((6, 0)))
    minimum = Minimum(z, motions, slopes, 0.0)
    return component(FORM, minimum, level, prior, cholesky(covariance, lower=True), DATA)


def test_mean_and_covariance_are_those_of_bayes_rule():
    # Data less offset = SLOPES z + noise, z standard normal: the posterior of linear regression.
    one = mixture([_component(np.zeros(6))])[0]
    information = np.eye(3) + SLOPES.T @ np.linalg.solve(NOISE, SLOPES)
    np.testing.assert_allclose(one.covariance, np.linalg.inv(information), rtol=1e-9)
    mean = np.linalg.solve(information, SLOPES.T @ np.linalg.solve(NOISE, DATA))
    np.testing.assert_allclose(one.z, mean, rtol=1e-9)


def test_the_mean_does_not_depend_on_the_point_where_the_slopes_were_taken():
    a = _component(np.zeros(6))
    b = _component(np.zeros(6), at=np.array([0.3, -0.2, 0.5]))
    np.testing.assert_allclose(a.z, b.z, atol=1e-12)
    assert a.weight == pytest.approx(b.weight, abs=1e-10)


def test_weights_are_the_evidence_of_two_forms():
    # The data of a form are normal with the covariance NOISE + slopes slopes^T about its offset.
    offsets = [np.zeros(6), np.full(6, 0.5)]
    priors = [0.7, 0.3]
    slopes = [SLOPES, 2.0 * SLOPES]
    forms = list(zip(offsets, priors, slopes, strict=True))
    evidence = [
        prior * multivariate_normal(offset, NOISE + of_form @ of_form.T).pdf(DATA)
        for offset, prior, of_form in forms
    ]
    found = mixture([_component(o, prior=p, slopes=one) for o, p, one in forms])
    by_size = sorted(np.array(evidence) / sum(evidence), reverse=True)
    assert [one.weight for one in found] == pytest.approx(by_size, rel=1e-9)


def test_a_larger_covariance_counts_against_a_level():
    # Residuals of the size of the noise: the level without a discrepancy is the more probable one.
    small = _component(DATA - SLOPES @ np.array([0.1, 0.0, -0.1]))
    large = _component(DATA - SLOPES @ np.array([0.1, 0.0, -0.1]), covariance=100.0 * NOISE)
    assert small.weight > large.weight + 3.0


def test_moments_and_draws_contain_the_distance_of_the_minima():
    found = mixture([_component(np.zeros(6)), _component(SLOPES @ np.array([3.0, 0.0, 0.0]))])
    mean, covariance = moments(found)
    places, z = draws(found, 4096, seed=1)
    np.testing.assert_allclose(z.mean(axis=0), mean, atol=0.05)
    np.testing.assert_allclose(np.cov(z.T), covariance, atol=0.1)
    share = np.mean(np.array(places) == 0)
    assert share == pytest.approx(found[0].weight, abs=0.01)


def test_prior_of_the_levels_is_half_normal():
    prior = prior_of_levels()
    assert prior.sum() == pytest.approx(1.0)
    # P(|s| < 1 %) = erf(0.01/(0.05 sqrt 2)) = 0.1585; P(|s| > 15 %) = 1 - erf(3/sqrt 2) = 0.0027.
    assert prior[0] == pytest.approx(0.1585, abs=1e-4)
    assert prior[-1] == pytest.approx(0.0027, abs=1e-4)
    assert len(prior) == len(LEVELS)


@pytest.mark.parametrize(("tail", "heavy"), [(0.1, False), (1.5, True)])
def test_the_shape_of_the_tail_tells_reliable_weights(tail, heavy):
    # Weights u^-k have a Pareto tail of the shape k.
    weights = (np.arange(1, 257) / 257.0) ** -tail
    assert (pareto_shape(np.log(weights)) > 0.7) is heavy


def test_levels_have_their_prior_where_the_data_fit():
    # Data that fit at every level: a good fit is no proof that the model is exact.
    small = _component(DATA - SLOPES @ np.array([0.1, 0.0, -0.1]), level=0.0)
    large = _component(DATA - SLOPES @ np.array([0.1, 0.0, -0.1]), level=0.1, covariance=100.0 * NOISE)
    found = mixture(by_levels([small, large], {0.0: 0.25, 0.1: 0.75}, 6))
    weights = {one.level: one.weight for one in found}
    assert weights[0.1] == pytest.approx(0.75, abs=0.01)


def test_a_level_at_which_the_data_do_not_fit_is_left_out():
    small = _component(DATA + 10.0, level=0.0)
    large = _component(DATA + 10.0, level=0.1, covariance=1e4 * NOISE)
    found = mixture(by_levels([small, large], {0.0: 0.75, 0.1: 0.25}, 6))
    assert [one.level for one in found] == [0.1]
    # Also where the misfit is so large that its probability is no float.
    far = _component(DATA + 1e4, level=0.0)
    assert np.isfinite(by_levels([far], {0.0: 1.0}, 6)[0].weight)
