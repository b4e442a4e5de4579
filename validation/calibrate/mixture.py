"""The posterior as a mixture: a normal distribution about each minimum, form, law and level of discrepancy.

About a minimum the data are linear in the normal scores. The posterior there is normal with the information
H = 1 + J^T C^-1 J, and the evidence of the component is

    -2 ln E = chi^2 + ln det H + ln det C + const.

Source: Laplace's method, MacKay, Information Theory, Inference, and Learning Algorithms, 2003, chapter 27.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cholesky
from scipy.special import logsumexp, ndtri
from scipy.stats import chi2, genpareto, qmc

from lumped.typing import FloatArray
from validation.calibrate.fit import Minimum, whitened
from validation.calibrate.forms import LIMIT, Form

#: Components with a smaller weight are left out.
_LEAST = 1e-4
#: Share of the samples in the tail of which the shape is fitted.
_TAIL = 0.2


@dataclass(frozen=True, eq=False)
class Component:
    """One normal distribution of the mixture.

    Attributes
    ----------
    form : form of the model
    level : level of the discrepancy
    z : (input,) mean
    covariance : (input, input)
    weight : probability
    chi_squared : misfit at the mean, by the linear data
    minimum : minimum about which the data are linear
    """

    form: Form
    level: float
    z: FloatArray
    covariance: FloatArray
    weight: float
    chi_squared: float
    minimum: Minimum


def component(
    form: Form, minimum: Minimum, level: float, prior: float, factor: FloatArray, data: FloatArray
) -> Component:
    """Return the component of a minimum, with the logarithm of its evidence times its prior as weight.

    Parameters
    ----------
    prior : probability of form and level before the records
    factor : lower Cholesky factor of the covariance of the data at this level
    """
    white = whitened(factor, data, minimum.motions, minimum.slopes)
    information = white.slopes.T @ white.slopes + np.eye(minimum.z.size)
    covariance = np.asarray(np.linalg.inv(information), dtype=np.float64)
    step = -covariance @ (white.slopes.T @ white.residuals + minimum.z)
    z = minimum.z + step
    residuals = white.residuals + white.slopes @ step
    misfit = float(residuals @ residuals + z @ z)
    log_evidence = -0.5 * (
        misfit + np.linalg.slogdet(information)[1] + 2.0 * np.log(np.diag(factor)).sum() + white.log_shifts
    )
    weight = log_evidence + np.log(prior)
    return Component(form, level, np.clip(z, -LIMIT, LIMIT), covariance, float(weight), misfit, minimum)


def by_levels(components: Sequence[Component], levels: Mapping[float, float], data: int) -> list[Component]:
    """Return the components with the weights of the levels set by their prior and by the size of the misfit.

    Within a level the evidence decides between forms and minima. Between levels it does not: orders that fit
    would prove that the model is exact in all other results too, which is what made ranges wrong for records
    of the multibody model. A level has its prior probability, times the probability that so large a misfit
    happens by chance.

    Parameters
    ----------
    levels : level -> prior probability
    data : number of data
    """
    result = []
    for level, prior in levels.items():
        same = [one for one in components if one.level == level]
        if not same:
            continue
        total = float(logsumexp([one.weight for one in same]))
        misfit = min(one.chi_squared for one in same)
        chance = max(float(chi2.logsf(misfit, data)), -0.5 * misfit)  # -inf for a misfit of many thousands
        result += [replace(one, weight=one.weight - total + np.log(prior) + chance) for one in same]
    return result


def mixture(components: Sequence[Component]) -> tuple[Component, ...]:
    """Return the components with their probabilities as weights, the most probable one first."""
    logs = np.array([one.weight for one in components])
    weights = np.exp(logs - logs.max())
    weights /= weights.sum()
    kept = [(one, weight) for one, weight in zip(components, weights, strict=True) if weight > _LEAST]
    total = sum(weight for _, weight in kept)
    kept.sort(key=lambda row: -row[1])
    return tuple(
        Component(
            one.form, one.level, one.z, one.covariance, float(weight / total), one.chi_squared, one.minimum
        )
        for one, weight in kept
    )


def draws(components: Sequence[Component], count: int, seed: int) -> tuple[list[int], FloatArray]:
    """Return the component of each draw, and the draws (count, input) themselves.

    Each component has its share of the draws to a whole number, and fills it with Sobol points.
    """
    inputs = components[0].z.size
    points = qmc.Sobol(inputs + 1, rng=np.random.default_rng(seed)).random(count)
    ends = np.cumsum([one.weight for one in components])
    places = np.minimum(np.searchsorted(ends, points[:, 0] * ends[-1]), len(components) - 1)
    scores = ndtri(np.clip(points[:, 1:], 1e-6, 1.0 - 1e-6))
    z = np.zeros((count, inputs))
    for j, place in enumerate(places):
        one = components[int(place)]
        z[j] = one.z + cholesky(one.covariance, lower=True) @ scores[j]
    return [int(place) for place in places], np.clip(z, -LIMIT, LIMIT)


def moments(components: Sequence[Component]) -> tuple[FloatArray, FloatArray]:
    """Return mean (input,) and covariance (input, input) of the normal scores of the mixture."""
    weights = np.array([one.weight for one in components])
    means = np.array([one.z for one in components])
    mean = weights @ means
    inside = sum(one.weight * one.covariance for one in components)
    apart = means - mean
    return np.asarray(mean), np.asarray(inside + (weights[:, None] * apart).T @ apart)


def pareto_shape(log_weights: FloatArray) -> float:
    """Return the shape k of the tail of importance weights; above 0.7 the weights are not reliable.

    Source: Vehtari, Simpson, Gelman, Yao and Gabry, J. Mach. Learn. Res. 25 (2024), section 2.
    """
    weights = np.sort(np.exp(log_weights - log_weights.max()))
    tail = max(int(_TAIL * weights.size), 5)
    threshold = weights[-tail - 1]
    above = weights[-tail:] - threshold
    if not above.max() > 1e-12:
        return 0.0
    return float(genpareto.fit(above, floc=0.0)[0])
