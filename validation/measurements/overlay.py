"""A record laid over a prediction: sample by sample, and as metrics with uncertainty.

Sources: bootstrap of whole blocks, Davison and Hinkley, Bootstrap Methods and their Application,
1997, section 8.2.
"""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from lumped.arguments import whole_number
from lumped.errors import NumericalError
from lumped.labelling import labelled_dataset
from lumped.typing import FloatArray
from validation.measurements.alignment import Alignment
from validation.measurements.prediction import Prediction
from validation.measurements.record import Measurement
from validation.measurements.specification import PAIR_LABELS, QUANTITIES

#: Metric -> plain name. All but the correlation are in the channel's unit or relative to the predicted peak
#: to peak.
METRICS = {
    "bias": "mean of measured - predicted",
    "rms": "root mean square of measured - predicted",
    "relative_rms": "rms over the prediction's peak to peak",
    "mean_absolute": "mean of |measured - predicted|",
    "relative_mean_absolute": "mean of |measured - predicted| over the prediction's peak to peak",
    "correlation": "Pearson correlation of measured and predicted",
}
_RESAMPLES = 999


def overlay(
    measurement: Measurement, prediction: Prediction, alignment: Alignment, *, bins: int = 64
) -> xr.Dataset:
    """Measured and predicted values over one engagement (pair channels) or one mesh cycle.

    Parameters
    ----------
    measurement, prediction, alignment : the record, its prediction, its phase
    bins : equal phase bins of the band

    Returns
    -------
    Dataset over ``channel`` and ``bin`` with phase (middle of the bin, mesh cycles since A), measured (mean
    of the bin), predicted (likewise), scatter (standard deviation of measured - predicted in the bin),
    standard_error (of the bin's mean) and count; empty bins are NaN with count 0
    """
    bins = whole_number("bins", bins, 4, 4096)
    names = list(measurement.channels)
    rows = []
    for j, channel in enumerate(measurement.spec.channel):
        age, y, p, _ = _samples(measurement, prediction, alignment, j)
        reach = prediction.geometry.contact_ratio if channel.pair else 1.0
        place = np.minimum((age / reach * bins).astype(np.int64), bins - 1)
        count = np.bincount(place, minlength=bins)
        sums = np.stack([np.bincount(place, weights=v, minlength=bins) for v in (y, p, y - p, (y - p) ** 2)])
        with np.errstate(invalid="ignore"):  # an empty bin has no mean
            measured, predicted, error, square = sums / count
        scatter = np.sqrt(np.maximum((square - error**2) * count / np.maximum(count - 1, 1), 0.0))
        rows.append((measured, predicted, scatter, (np.arange(bins) + 0.5) * reach / bins, count))
    measured, predicted, scatter, phase, count = (np.stack(column) for column in zip(*rows, strict=True))
    dims, own = ("channel", "bin"), "SI, by channel"
    units = [QUANTITIES[c.quantity][0] for c in measurement.spec.channel]
    result = labelled_dataset(
        {
            "measured": (dims, measured, own, "mean of the measured values"),
            "predicted": (dims, predicted, own, "mean of the predicted values"),
            "scatter": (dims, scatter, own, "standard deviation of measured - predicted"),
            "phase": (dims, phase, "1", "mesh cycles since A"),
            "count": (dims, count, "1", "samples in the bin"),
            "units": ("channel", units, "1", "SI unit of the channel"),
        },
        {"channel": (names, "1", "channel")},
        {"record": measurement.spec.name, "source": measurement.spec.source},
    )
    result["standard_error"] = result["scatter"] / np.sqrt(result["count"].where(result["count"] > 0))
    return result


def overlay_metrics(measurement: Measurement, prediction: Prediction, alignment: Alignment) -> xr.Dataset:
    """How far a record is from its prediction, with 95 % percentile intervals of a bootstrap.

    Whole blocks are resampled with replacement (one engagement of a labelled pair or one mesh cycle each; a
    record with fewer than eight is cut into eight runs of samples), because neighbouring samples are not
    independent.

    Parameters
    ----------
    measurement, prediction, alignment : the record, its prediction, its phase

    Returns
    -------
    Dataset over ``channel``: each metric of ``METRICS``, with ``<metric>_low`` and ``<metric>_high``,
    largest (the largest |measured - predicted|) and the number of blocks; the relative ones are NaN where the
    prediction is constant

    Raises
    ------
    NumericalError : no sample of a channel is in contact
    """
    rng = np.random.default_rng(0)
    names = list(measurement.channels)
    one_turn = np.linspace(0.0, prediction.geometry.pairs, 2048, endpoint=False)
    columns: dict[str, list[float]] = {}
    for j, channel in enumerate(measurement.spec.channel):
        _, y, p, block = _samples(measurement, prediction, alignment, j)
        if np.unique(block).size < 8:
            block = np.arange(y.size) * 8 // y.size
        number = np.unique(block, return_inverse=True)[1]
        blocks = int(number.max()) + 1
        e = y - p
        terms = (np.ones(y.size), e, e**2, np.abs(e), y, p, y * p, y**2, p**2)
        sums = np.stack([np.bincount(number, weights=term, minlength=blocks) for term in terms])
        span = float(np.ptp(prediction.value(channel.quantity, one_turn, channel.pair)))
        draws = rng.integers(0, blocks, (_RESAMPLES, blocks))
        whole = _metrics(sums.sum(axis=1), span)
        spread = _metrics(sums[:, draws].sum(axis=2), span)
        for name, value in whole.items():
            low, high = np.percentile(spread[name], [2.5, 97.5])
            for key, number_ in ((name, value), (f"{name}_low", low), (f"{name}_high", high)):
                columns.setdefault(key, []).append(float(number_))
        columns.setdefault("largest", []).append(float(np.abs(e).max()))
        columns.setdefault("blocks", []).append(blocks)
    return xr.Dataset(
        {name: ("channel", values) for name, values in columns.items()},
        coords={"channel": names},
        attrs={"level": 0.95, "resamples": _RESAMPLES, "definitions": str(METRICS)},
    )


def _metrics(sums: FloatArray, span: float) -> dict[str, FloatArray]:
    n, e, e2, absolute, y, p, yp, y2, p2 = sums
    whole = span or np.nan  # a constant prediction, such as no friction, has no scale
    rms, mean_absolute = np.sqrt(e2 / n), absolute / n
    spread = np.sqrt(np.maximum(n * y2 - y**2, 0.0) * np.maximum(n * p2 - p**2, 0.0))
    correlation = np.where(spread > 0.0, (n * yp - y * p) / np.where(spread > 0.0, spread, 1.0), 0.0)
    return {
        "bias": e / n,
        "rms": rms,
        "relative_rms": rms / whole,
        "mean_absolute": mean_absolute,
        "relative_mean_absolute": mean_absolute / whole,
        "correlation": correlation,
    }


def _samples(
    measurement: Measurement, prediction: Prediction, alignment: Alignment, place: int
) -> tuple[FloatArray, FloatArray, FloatArray, NDArray[np.int64]]:
    """Phase since A, measured, predicted and block number of a channel's samples (pairs: in contact only)."""
    channel = measurement.spec.channel[place]
    u, y = alignment.cycles, measurement.channels[channel.name]
    if channel.pair is None:
        age, inside = np.mod(u, 1.0), np.ones(u.shape, dtype=bool)
        block = np.floor(u)
    else:
        age, inside = prediction.age(u, channel.pair), prediction.contact(u, channel.pair)
        block = np.floor((u - PAIR_LABELS.index(channel.pair)) / prediction.recurrence)
    if not inside.any():
        raise NumericalError(
            f"No sample of {channel.name} is in contact; check the abscissae, the shift and the pair labels."
        )
    p = prediction.value(channel.quantity, u, channel.pair)
    return age[inside], y[inside], p[inside], block[inside].astype(np.int64)
