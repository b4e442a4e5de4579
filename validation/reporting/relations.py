"""Relations that results must satisfy whatever the pair is; a report says which do not hold."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr

from lumped.outcomes import Absent
from validation.reporting.results import Results

#: Rounding that a relation may be off by.
_SLACK = 1e-9
#: A curve over speed passes through the table's value within this share: it is computed with other samples.
_SAME = 2e-3


def failed_checks(results: Results) -> tuple[str, ...]:
    """Return the checks of the program that fail: same equations, conservation, relations between results."""
    return (*(judgement.check for judgement in results.check.failures), *broken_relations(results))


def broken_relations(results: Results) -> tuple[str, ...]:
    """Return the relations between results that do not hold, as phrases."""
    return tuple(_broken(results))


def _broken(results: Results) -> Iterator[str]:
    prediction = results.prediction
    numbers = prediction.numbers
    if numbers["dynamic_factor"] < 1.0 - _SLACK:
        yield f"the dynamic factor {numbers['dynamic_factor']:.4g} is below 1"
    if not 0.0 <= numbers["least_force"] <= 1.0 + _SLACK:
        yield f"the smallest mesh force is {numbers['least_force']:.4g} of the static one"
    if not 0.0 < numbers["efficiency"] <= 1.0 + _SLACK:
        yield f"the efficiency is {numbers['efficiency']:.4g}"
    sampled = float(np.ptp(prediction.cycle["dte"].to_numpy()))
    if not sampled * (1.0 - _SLACK) <= prediction.peak_to_peak <= 1.05 * sampled + 1e-12:
        yield "the peak to peak is not that of the motion"
    rms, orders = numbers["bearing_rms"], prediction.bearing_orders
    if np.sum(orders**2) / 2.0 > rms**2 * (1.0 + 1e-6):
        yield "the orders of the bearing force carry more than its rms"
    linear = results.linear
    if not isinstance(linear, Absent) and results.pair.shafts is None:
        at = results.sweep.interp(speed=results.operating_rpm)["dte_peak_to_peak"]
        given = float(linear.attrs["dte_peak_to_peak"])
        if abs(float(at) / given - 1.0) > _SAME:
            yield "the curve over speed misses the value at the operating speed"
    found = results.uncertainty
    if isinstance(found, xr.Dataset):
        for name, value in numbers.items():
            if abs(found.attrs[f"given_{name}"] - value) > _SLACK * max(abs(value), 1e-300):
                yield f"the samples were taken about another {name}"
            low, middle, high = found[f"{name}_percentile"].to_numpy()
            if not low <= middle <= high:
                yield f"the percentiles of {name} are not in order"
