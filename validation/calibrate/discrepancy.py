"""Covariance of the data of a fit: noise of the records, and the discrepancy of the model.

No model is exact: with the best inputs each order of each channel is still off. The discrepancy is a random
addition to every complex order. At the level s each part of order m has the variance

    s^2 (A^2 + |V_m|^2)/2,    A the largest order of the channel.

Half of the variance is common to all records of the same quantity, in the phase of each record: a model that
is too soft is too soft at every speed. The other half is independent. A value over speed has no phase: its
error is real, with the variance of one part. Of a peak to peak v, where A = v, this is s^2 v^2.

Sources: Kennedy and O'Hagan, J. R. Statist. Soc. B 63 (2001) 425, section 4 (a model is calibrated together
with its discrepancy); docs/how_to/calibrate.md.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from math import erf

import numpy as np
from scipy.linalg import block_diag

from lumped.typing import FloatArray, IntArray
from validation.calibrate.data import Data

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


def shown_results(records: Sequence[Data]) -> frozenset[str]:
    """Return the results of page 1 whose quantities are channels of the records."""
    recorded = frozenset().union(*(one.quantities for one in records))
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


def noise_covariance(records: Sequence[Data]) -> FloatArray:
    """Return the (n, n) covariance of all data by noise and numerics."""
    return np.asarray(block_diag(*(one.noise for one in records)))


def discrepancy_covariance(records: Sequence[Data]) -> FloatArray:
    """Return the (n, n) covariance of all data by a discrepancy of the level 1."""
    by_key: dict[tuple[str, ...], list[tuple[IntArray, FloatArray]]] = defaultdict(list)
    start = 0
    for record in records:
        for one in record.loadings:
            by_key[one.key].append((start + np.array(one.places), one.factors))
        start += record.values.size
    covariance = np.zeros((start, start))
    for same in by_key.values():
        for row, (rows, factors) in enumerate(same):
            for column, (columns, others) in enumerate(same):
                share = 1.0 if row == column else _COMMON
                covariance[np.ix_(rows, columns)] = share * factors @ others.T
    return covariance
