"""Global sensitivity indices of Sobol from the sampled cases of a study."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from lumped.typing import FloatArray
from validation.studies.cases import CaseList
from validation.studies.evaluate import Status

#: Resamplings of the confidence interval.
RESAMPLES = 200
CONFIDENCE = 0.95


def add_sensitivity(
    result: xr.Dataset, cases: CaseList, status: np.ndarray[Any, np.dtype[np.int8]], values: FloatArray
) -> xr.Dataset:
    """Add ``sobol_first`` and ``sobol_total`` over (output, axis) with their bootstrap intervals.

    The estimators are those of Saltelli et al., Comput. Phys. Commun. 181 (2010) 259-270, Table 2 (b) and
    (f), as in ``scipy.stats.sobol_indices``. A failed case would bias them, so they are left out then and
    the attribute ``sensitivity`` says why.

    Parameters
    ----------
    result : labelled results
    cases : the study's cases
    status : (cases,) status codes
    values : (outputs, cases)
    """
    if not cases.study.design.sensitivity:
        return result
    failed = int(np.count_nonzero(status >= Status.REFUSED))
    missing = int(np.count_nonzero(status == Status.MISSING))
    if failed or missing:
        return result.assign_attrs(
            sensitivity=f"no indices: {failed} of {status.size} cases failed, {missing} are not computed yet"
        )
    axes = [axis.label for axis in cases.study.axes]
    found = indices(values, len(axes), cases.study.design.seed)
    result = result.assign_coords(
        output=("output", np.array(cases.study.outputs, dtype=object)),
        axis=("axis", np.array(axes, dtype=object)),
    )
    words = {"sobol_first": "first-order Sobol index", "sobol_total": "total Sobol index"}
    for name, array in found.items():
        base, _, end = name.partition("_ci_")
        text = words[base] + (f", {end} end of its {100 * CONFIDENCE:g} % interval" if end else "")
        result[name] = (("output", "axis"), array, {"units": "1", "long_name": text})
    constant = [name for name, row in zip(cases.study.outputs, values, strict=True) if np.ptp(row) == 0.0]
    note = f"; not defined for the constant {', '.join(constant)}" if constant else ""
    return result.assign_attrs(sensitivity=f"scipy.stats.sobol_indices, bootstrap of {RESAMPLES}{note}")


def indices(values: FloatArray, axes: int, seed: int) -> dict[str, FloatArray]:
    """Sobol indices with percentile bootstrap intervals, each (outputs, axes); NaN for a constant output.

    Parameters
    ----------
    values : (outputs, n (axes + 2)) in the blocks A, B, AB_1 ... AB_axes
    axes : number of axes
    seed : of the bootstrap
    """
    from scipy import stats  # takes a third of a second, and most studies have no use for it

    names = ("sobol_first", "sobol_total")
    found = {
        f"{name}{end}": np.full((len(values), axes), np.nan)
        for name in names
        for end in ("", "_ci_low", "_ci_high")
    }
    varies = np.ptp(values, axis=1) > 0.0
    if not varies.any():
        return found
    # The estimators are invariant under shift and scale. About a zero mean they lose fewer digits, and their
    # squares of numbers of order 1 neither vanish nor overflow.
    values = values[varies]
    values = (values - values.mean(axis=1, keepdims=True)) / np.ptp(values, axis=1)[:, None]
    blocks = values.reshape(len(values), axes + 2, -1).transpose(1, 0, 2)
    n = blocks.shape[-1]

    def both(which: Any) -> FloatArray:
        func: Any = {"f_A": blocks[0][:, which], "f_B": blocks[1][:, which], "f_AB": blocks[2:][:, :, which]}
        with np.errstate(invalid="ignore", divide="ignore"):
            found: Any = stats.sobol_indices(func=func, n=n)
        return np.stack([found.first_order, found.total_order])

    # ``SobolResult.bootstrap`` takes no seed, and its BCa intervals n more evaluations.
    best = both(np.arange(n))
    options: Any = {"n_resamples": RESAMPLES, "confidence_level": CONFIDENCE, "batch": 1}
    interval: Any = stats.bootstrap(
        (np.arange(n),), both, vectorized=False, method="percentile", rng=seed, **options
    ).confidence_interval
    for j, name in enumerate(names):
        found[name][varies] = best[j]
        found[f"{name}_ci_low"][varies], found[f"{name}_ci_high"][varies] = interval.low[j], interval.high[j]
    return found
