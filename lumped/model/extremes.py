"""Peak to peak of a motion, from its samples and their rates: the same number whatever the sampling."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lumped.typing import FloatArray

if TYPE_CHECKING:
    import xarray as xr


def peak_to_peak(time: FloatArray, values: FloatArray, rates: FloatArray) -> float:
    """Largest minus smallest value, extremes between two samples included.

    Between samples the motion is the cubic with their values and rates. Its error falls with the fourth power
    of the interval; where a force jumps inside an interval, with the square.

    Parameters
    ----------
    time : (k,) increasing [s]
    values, rates : (k,) motion and its derivative
    """
    step = np.diff(time)
    rise, start, end = np.diff(values), rates[:-1] * step, rates[1:] * step
    # values[j] + start s + square s^2 + cube s^3 for s from 0 to 1
    square, cube = 3.0 * rise - 2.0 * start - end, start + end - 2.0 * rise
    root = np.sqrt(np.maximum(square**2 - 3.0 * cube * start, 0.0))
    sum_of = -(square + np.copysign(root, square))
    with np.errstate(divide="ignore", invalid="ignore"):
        places = np.stack([sum_of / (3.0 * cube), start / sum_of])
    places = np.clip(np.nan_to_num(places, nan=0.0, posinf=0.0, neginf=0.0), 0.0, 1.0)
    between = values[:-1] + places * (start + places * (square + places * cube))
    return float(max(values.max(), between.max()) - min(values.min(), between.min()))


def cycle_peak_to_peak(run: xr.Dataset, name: str, period: float | None = None) -> float:
    """Peak to peak of a displacement of a result.

    Parameters
    ----------
    run : result with ``name`` and ``name_dot`` over ``time``
    name : a displacement of ``lumped.model.results.VARIABLES``
    period : of a motion that closes and whose last sample is left out [s]
    """
    time, values, rates = (run[key].to_numpy() for key in ("time", name, f"{name}_dot"))
    if period is not None:
        time, values, rates = (
            np.append(time, time[0] + period),
            np.append(values, values[0]),
            np.append(rates, rates[0]),
        )
    return peak_to_peak(time, values, rates)
