"""Covariance of the data of a fit: noise of the records, and the discrepancy of the model.

No model is exact: with the best inputs each order of each channel is still off. The discrepancy is a random
addition to every complex order. At the level s each part of order m has the variance

    s^2 (A^2 + |V_m|^2)/2,    A the largest order of the channel.

Half of the variance is common to all records of the same quantity, in the phase of each record: a model that
is too soft is too soft at every speed. The other half is independent.

Sources: Kennedy and O'Hagan, J. R. Statist. Soc. B 63 (2001) 425, section 4 (a model is calibrated together
with its discrepancy); docs/how_to/calibrate.md.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from math import erf

import numpy as np
from scipy.linalg import block_diag

from lumped.typing import FloatArray
from validation.calibrate.measured import Measured

#: Levels of the discrepancy over which a posterior is summed; the prior of a level is half-normal.
LEVELS = (0.0, 0.02, 0.05, 0.10, 0.20)
DEVIATION = 0.05
#: Share of the variance that is common to all records.
_COMMON = 0.5
#: Result of page 1 -> the quantities whose records show it.
_SHOWN_BY = {
    "dte_peak_to_peak": {"dte"},
    "dynamic_factor": {"mesh_force"},
    "bearing_rms": {"bearing_force_x_p", "bearing_force_y_p"},
}


def prior_of_levels() -> FloatArray:
    """Return the (level,) prior probabilities of ``LEVELS``: the half-normal prior between their middles."""
    middles = 0.5 * (np.array(LEVELS[1:]) + np.array(LEVELS[:-1]))
    below = np.array([0.0, *(erf(one / (DEVIATION * np.sqrt(2.0))) for one in middles), 1.0])
    return np.diff(below)


def shown_results(records: Sequence[Measured]) -> frozenset[str]:
    """Return the results of page 1 whose quantities are channels of the records."""
    recorded = {channel.key[0] for one in records for channel in one.channels}
    return frozenset(name for name, needed in _SHOWN_BY.items() if needed <= recorded)


def variance_of_error(level: float, shown: bool) -> float:
    """Return the variance of the error of a result by the model, as a share of the result.

    ``shown``: a record shows the result, and the error has the level of the discrepancy. Else the level is at
    least that of the half-normal prior s |N|, N standard normal: E[max(level, s |N|)^2], with a = level/s

        level^2 erf(a/sqrt 2) + s^2 (1 - erf(a/sqrt 2) + a sqrt(2/pi) exp(-a^2/2)).
    """
    if shown:
        return level**2
    a = level / DEVIATION
    below = erf(a / np.sqrt(2.0))
    tail = 1.0 - below + a * np.sqrt(2.0 / np.pi) * np.exp(-0.5 * a**2)
    return float(level**2 * below + DEVIATION**2 * tail)


def noise_covariance(records: Sequence[Measured]) -> FloatArray:
    """Return the (n, n) covariance of all data by noise and numerics."""
    return np.asarray(block_diag(*(channel.noise for one in records for channel in one.channels)))


def discrepancy_covariance(records: Sequence[Measured]) -> FloatArray:
    """Return the (n, n) covariance of all data by a discrepancy of the level 1."""
    places: dict[tuple[str, str | None, float], list[tuple[int, int, complex]]] = defaultdict(list)
    start = 0
    for one in records:
        for channel in one.channels:
            values = channel.orders.values
            count = values.size
            for j, (order, value) in enumerate(zip(channel.orders.orders, values, strict=True)):
                size = np.sqrt(0.5 * (channel.scale**2 + abs(value) ** 2))
                turn = value / abs(value) if abs(value) > 0.0 else 1.0
                places[(*channel.key, float(order))].append((start + j, start + j + count, size * turn))
            start += 2 * count
    covariance = np.zeros((start, start))
    for same in places.values():
        for row, (real, imaginary, size) in enumerate(same):
            for column, (other_real, other_imaginary, other) in enumerate(same):
                share = 1.0 if row == column else _COMMON
                product = share * size * np.conj(other)
                covariance[real, other_real] = covariance[imaginary, other_imaginary] = product.real
                covariance[imaginary, other_real] = product.imag
                covariance[real, other_imaginary] = -product.imag
    return covariance
