"""Maximum-likelihood fit of one friction parameter to noisy forces, and the covariance of the fit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from lumped.errors import NumericalError
from lumped.typing import FloatArray


@dataclass(frozen=True)
class Samples:
    """Samples of all friction channels one after the other, each array (k,).

    Attributes
    ----------
    friction, normal : F, N [N]
    shape : g, what the identified parameter multiplies [-]
    noise_friction, noise_normal : standard deviations [N]
    channel, block : numbers of the friction channel and of the engagement
    """

    friction: FloatArray
    normal: FloatArray
    shape: FloatArray
    noise_friction: FloatArray
    noise_normal: FloatArray
    channel: NDArray[np.int64]
    block: NDArray[np.int64]


def misfit(s: Samples, parameters: FloatArray) -> FloatArray:
    """F - b - beta g N of every sample (k,) [N]; parameters: beta, then the zero error b of each channel."""
    zero = parameters[1:][s.channel] if parameters.size > 1 else 0.0
    return np.asarray(s.friction - zero - parameters[0] * s.shape * s.normal, dtype=np.float64)


def _variance(s: Samples, beta: float) -> FloatArray:
    return np.asarray(s.noise_friction**2 + (beta * s.shape * s.noise_normal) ** 2, dtype=np.float64)


def estimate_parameters(s: Samples, count: int) -> FloatArray:
    """Maximum-likelihood estimate (count,): beta, then the zero of each channel."""
    regressor = s.shape * s.normal
    power = float(regressor @ regressor)
    if not power > 0.0:
        raise NumericalError(
            "The samples carry no friction (normal load or law is zero); check the alignment."
        )
    start = np.zeros(count)
    start[0] = float(regressor @ s.friction) / power
    # Units: beta of order of start or 1, zeros in N.
    scale = np.ones(count)
    scale[0] = max(abs(start[0]), float(np.std(s.friction)) / float(np.sqrt(power / regressor.size)), 1e-12)
    scale[1:] = max(float(np.std(s.friction)), 1e-12)

    def residual(z: FloatArray) -> FloatArray:
        p = z * scale
        return np.asarray(misfit(s, p) / np.sqrt(_variance(s, float(p[0]))), dtype=np.float64)

    fit = least_squares(residual, start / scale, method="lm", xtol=1e-12, ftol=1e-12, gtol=1e-12)
    if not fit.success or not np.isfinite(fit.x).all():
        raise NumericalError(f"The least-squares fit failed ({fit.message}); check signs and units.")
    return np.asarray(fit.x * scale, dtype=np.float64)


def _scores(s: Samples, p: FloatArray) -> FloatArray:
    """Gradient (k, count) of every sample's term r^2 / (2 v)."""
    beta = float(p[0])
    r, v = misfit(s, p), _variance(s, beta)
    scores = np.empty((r.size, p.size))
    slope_v = 2.0 * beta * (s.shape * s.noise_normal) ** 2
    scores[:, 0] = -r * s.shape * s.normal / v - 0.5 * (r / v) ** 2 * slope_v
    for j in range(1, p.size):
        scores[:, j] = -np.where(s.channel == j - 1, r / v, 0.0)
    return scores


def sandwich(s: Samples, p: FloatArray) -> tuple[FloatArray, int]:
    """Sandwich covariance (count, count), and the number of lags over which the noise was correlated."""
    scores = _scores(s, p)
    hessian = np.empty((p.size, p.size))
    for j in range(p.size):  # the summed gradient is smooth in the parameters: central differences
        h = 1e-5 * (abs(p[j]) if p[j] != 0.0 else 1.0)
        up, down = p.copy(), p.copy()
        up[j] += h
        down[j] -= h
        hessian[:, j] = (_scores(s, up).sum(0) - _scores(s, down).sum(0)) / (2.0 * h)
    middle, lags = _long_run(scores, s.block)
    inverse = np.linalg.inv(hessian)
    return np.asarray(inverse @ middle @ inverse.T, dtype=np.float64), lags


def _long_run(scores: FloatArray, block: NDArray[np.int64]) -> tuple[FloatArray, int]:
    """Covariance (count, count) of the summed scores, correlated inside blocks, and the number of lags used.

    Prewhitened by the first-order autocorrelation of beta's scores (Andrews and Monahan 1992): Bartlett
    weights alone come out too small for strongly correlated noise.
    """
    same = block[1:] == block[:-1]
    rho = _first_autocorrelation(scores[:, 0], same)
    white = (scores[1:] - rho * scores[:-1])[same] if rho > 0.0 else scores
    where = block[1:][same] if rho > 0.0 else block
    left = _first_autocorrelation(white[:, 0], where[1:] == where[:-1])
    alpha = 4.0 * left**2 / ((1.0 - left) ** 2 * (1.0 + left) ** 2)
    shortest = int(np.bincount(where)[np.unique(where)].min())
    lags = min(int(np.ceil(1.1447 * (alpha * white.shape[0]) ** (1.0 / 3.0))), max(shortest - 1, 0))
    middle = white.T @ white
    for lag in range(1, lags + 1):
        pairs = where[lag:] == where[:-lag]
        cross = white[lag:][pairs].T @ white[:-lag][pairs]
        middle += (1.0 - lag / (lags + 1.0)) * (cross + cross.T)
    return middle * (scores.shape[0] / white.shape[0] / (1.0 - rho) ** 2), lags + int(rho > 0.0)


def _first_autocorrelation(values: FloatArray, same: NDArray[np.bool_]) -> float:
    """Lag-one autocorrelation inside blocks, 0 to 0.97; 0 where it is not two standard errors from zero."""
    power = float(values @ values)
    rho = float(values[1:][same] @ values[:-1][same]) / power if power > 0.0 else 0.0
    return min(rho, 0.97) if rho > 2.0 / np.sqrt(max(values.size, 1)) else 0.0
