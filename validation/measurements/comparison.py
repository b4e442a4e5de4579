"""A record beside its prediction over the mesh phase: alignment, samples, metrics.

Sources: docs/theory/equations.md, "Frame", for the mesh phase, and "Periodic motion and the brake torque".
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from lumped import Geometry, steady_state
from lumped.arguments import real_number, whole_number
from lumped.errors import NumericalError
from lumped.labelling import labelled_dataset, provenance
from lumped.model.periodic_system import Supports, supports_of
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import BoolArray, FloatArray, IntArray
from validation.measurements.record import PAIR_LABELS, QUANTITIES, Channel, Measurement

#: Samples of a prediction in a mesh cycle.
_SAMPLES = 1024
#: Trial shifts in a mesh cycle, and the most samples that they are tried with.
_COARSE = 32
_COARSE_SAMPLES = 2000
#: Factor between the steps of two searches for the shift.
_ZOOM = 4
#: Last step of the search for the shift [mesh cycles].
_FINEST = 1e-6
#: Largest mesh cycle of a record: double precision still resolves the finest shift there.
_FARTHEST = 1e9


@dataclass(frozen=True, eq=False)
class Prediction:
    """Periodic motion of a gear pair, read by mesh cycles u since pair A was at point A.

    Attributes
    ----------
    pair : the gear pair at the record's operating point
    cycle : one mesh cycle of results, ``lumped.steady_state``
    recurrence : mesh cycles after which the same labelled pair is in contact again
    """

    pair: GearPair
    cycle: xr.Dataset
    recurrence: int

    @property
    def geometry(self) -> Geometry:
        """Geometry of the pair."""
        return self.pair.geometry

    def age(self, cycles: ArrayLike, label: str) -> FloatArray:
        """Return the mesh cycles since the labelled pair was last at A."""
        u = np.asarray(cycles, dtype=float) - PAIR_LABELS.index(label)
        return np.asarray(np.mod(u, self.recurrence), dtype=np.float64)

    def contact(self, cycles: ArrayLike, label: str) -> BoolArray:
        """Return whether the labelled pair is in contact."""
        return np.asarray(self.age(cycles, label) < self.geometry.contact_ratio, dtype=np.bool_)

    @cached_property
    def ahead(self) -> IntArray:
        """Whole base pitches from the pair at A at the start to each tooth pair of ``cycle``.

        With loaded contact pairs touch before A and behind D, so the last number is negative.
        """
        g = self.geometry
        place = self.cycle["position"].to_numpy()[:, 0] - g.L_XA
        return np.asarray(np.round(place / g.base_pitch), dtype=np.int64)

    @property
    def life(self) -> tuple[float, float]:
        """First and last mesh cycle since A at which a tooth pair can carry load.

        With loaded contact this is more than the path from A to D.
        """
        if self.pair.mesh.contact == "loaded":
            return float(self.ahead.min()), float(self.ahead.max()) + 1.0
        return 0.0, self.geometry.contact_ratio

    def since(self, cycles: ArrayLike, label: str) -> FloatArray:
        """Return ``age``, but negative numbers before A where a pair can touch there."""
        age = self.age(cycles, label)
        first = self.life[0]
        return np.asarray(np.where(age >= self.recurrence + first, age - self.recurrence, age))

    def value(self, quantity: str, cycles: ArrayLike, label: str | None = None) -> FloatArray:
        """Return a predicted quantity [SI] at mesh cycles u; ``label``: tooth pair of the quantity."""
        places, values = self._curves[quantity]
        if label is None:
            u = np.mod(np.asarray(cycles, dtype=float), 1.0)
            return np.asarray(np.interp(u, places, values, period=1.0), dtype=np.float64)
        age = self.since(cycles, label)
        first, last = self.life
        inside = (age >= first) & (age < last)
        return np.asarray(np.where(inside, np.interp(age, places, values), 0.0), dtype=np.float64)

    @cached_property
    def _curves(self) -> dict[str, tuple[FloatArray, FloatArray]]:
        """Quantity -> mesh cycles and values: over a mesh cycle, or over the life of a tooth pair.

        A tooth pair that is n pitches ahead is n mesh cycles after A. Behind the last sample the last value
        holds.
        """
        grid = self.cycle["time"].to_numpy() / self.geometry.mesh_period
        young = np.argsort(self.ahead)
        life = (self.ahead[young][:, None] + grid).ravel()
        first, last = self.life
        inside = (life >= first) & (life < last)
        curves = {}
        for name, (_, paired) in QUANTITIES.items():
            values = self.cycle[name].to_numpy()
            curves[name] = (life[inside], values[young].ravel()[inside]) if paired else (grid, values)
        return curves


def predict(pair: AnyPair, *, recurrence: int | None = None, supports: Supports | None = None) -> Prediction:
    """Return the linear periodic motion of a pair; between samples it is interpolated linearly.

    Parameters
    ----------
    pair : a validated gear pair, at the operating point of the record: ``Measurement.at``
    recurrence : see ``Prediction``; default the pinion's number of teeth
    supports : "springs" or "shafts", as of ``lumped.steady_state``; by default the shafts of a pair that has
        them
    """
    pair = load_gear_pair(pair)
    again = pair.pinion.teeth
    if recurrence is not None:  # no fewer than the pairs in contact at once
        advice = "Count the mesh cycles until the same labelled pair is in contact again."
        again = whole_number("recurrence", recurrence, pair.geometry.pairs, 1_000_000, advice)
    motion = steady_state(pair, samples_per_cycle=_SAMPLES, supports=supports_of(pair, supports))
    return Prediction(pair, motion, again)


@dataclass(frozen=True, eq=False)
class Alignment:
    """Where the samples of a record lie in the mesh cycle.

    Attributes
    ----------
    cycles : (k,) mesh cycles since pair A was at point A
    shift : what was added to the record's own cycles [mesh cycles]
    standard_error : of the shift, for independent noise [mesh cycles]; 0 where the shift was given
    share_explained : 1 - residual sum of squares over total sum of squares at the best shift
    """

    cycles: FloatArray
    shift: float
    standard_error: float
    share_explained: float = 1.0


def mesh_cycles(measurement: Measurement, pair: GearPair) -> FloatArray:
    """Return the mesh cycles (k,) of the samples before alignment, u = t/T_m at the speed of the record."""
    g = pair.with_({"operating.pinion_speed": measurement.spec.pinion_speed}).geometry
    return np.asarray(measurement.abscissa / g.mesh_period, dtype=np.float64)


def align(measurement: Measurement, prediction: Prediction, *, shift: float | None = None) -> Alignment:
    """Find the mesh phase of a record by least squares against the prediction.

    Each channel has its own gain and zero at every trial shift: a calibration error does not move the
    phase. Normal loads hardly depend on friction. Where a record has normal loads, only these are aligned:
    the alignment then does not contain the friction that is identified later.

    ``shift``: known shift [mesh cycles]; then there is no search.

    Raises
    ------
    NumericalError : the channels do not vary, or the best shift explains less than half of their variation
    """
    raw = mesh_cycles(measurement, prediction.pair)
    advice = "Check its unit."
    farthest = float(np.abs(raw).max())
    real_number("abscissa", farthest, 0.0, _FARTHEST, unit="mesh cycles", action=advice)
    if shift is not None:
        shift = real_number("shift", shift, -_FARTHEST, _FARTHEST, unit="mesh cycles", action=advice)
        return Alignment(raw + shift, shift, 0.0)
    every = measurement.spec.channel
    chosen = [c for c in every if c.quantity == "normal_load"] or every
    values = np.array([measurement.channels[c.name] for c in chosen])
    values = values - values.mean(axis=1, keepdims=True)
    spread = np.sqrt((values**2).mean(axis=1))
    if not (spread > 0.0).all():
        raise NumericalError(
            "A channel to align by is constant: leave it out of the description, or give the shift."
        )
    values /= spread[:, None]

    def misfit(trial: float, step: int = 1) -> float:
        lost = 0.0
        for channel, measured in zip(chosen, values[:, ::step], strict=True):
            model = prediction.value(channel.quantity, raw[::step] + trial, channel.pair)
            model = model - model.mean()
            y = measured - measured.mean()
            power = float(model @ model)
            # A negative gain is the wrong phase, not a fit.
            gain = 0.0 if power == 0.0 else max(float(model @ y) / power, 0.0)
            lost += float(((y - gain * model) ** 2).sum())
        return lost

    coarse = max(raw.size // _COARSE_SAMPLES, 1)
    reach = prediction.recurrence if any(c.pair is not None for c in chosen) else 1
    trials = np.arange(reach * _COARSE) / _COARSE
    best = float(trials[np.argmin([misfit(t, coarse) for t in trials])])
    step = 1.0 / _COARSE
    while step > _FINEST:
        fine = best + step * np.linspace(-1.0, 1.0, 2 * _ZOOM + 1)
        losses = np.array([misfit(float(t)) for t in fine])
        # Sampled jumps make the misfit flat between samples: take the middle of the flat bottom.
        bottom = fine[losses <= losses.min() * (1.0 + 1e-12)]
        best = float(0.5 * (bottom[0] + bottom[-1]))
        step /= _ZOOM
    lost = misfit(best)
    explained = 1.0 - lost / values.size
    if explained < 0.5:
        raise NumericalError(
            f"The best shift explains only {100 * explained:.0f} % of the record's variation: check speed, "
            "pair labels, signs (gain) and recurrence, or give the shift."
        )
    h = max(float(np.median(np.diff(raw))), 1.0 / prediction.cycle["time"].size)
    rise = 0.5 * (misfit(best + h) + misfit(best - h)) - lost
    # The sum of squares over the noise variance rises by 1 at one standard error.
    error = h * float(np.sqrt(lost / values.size / rise)) if rise > 0.0 else h
    best = float(np.mod(best, reach))
    return Alignment(raw + best, best, error, explained)


def overlay(
    measurement: Measurement, prediction: Prediction, alignment: Alignment, *, bins: int = 64
) -> xr.Dataset:
    """Return measured and predicted values in phase bins, over one engagement or one mesh cycle.

    The dataset is over ``channel`` and ``bin``; empty bins are NaN with count 0. A channel is in the SI
    unit that the variable ``units`` names. Metrics of all samples are over ``channel``; the relative metric
    is NaN where the prediction is constant.
    """
    rows = []
    metrics = []
    one_turn = np.linspace(0.0, prediction.geometry.pairs, 2048, endpoint=False)
    for channel in measurement.spec.channel:
        samples = _samples(measurement, prediction, alignment, channel)
        y = samples.measured
        p = samples.predicted
        reach = prediction.geometry.contact_ratio if channel.pair else 1.0
        place = np.minimum((samples.phase / reach * bins).astype(np.int64), bins - 1)
        count = np.bincount(place, minlength=bins)
        sums = np.stack([np.bincount(place, weights=v, minlength=bins) for v in (y, p, y - p, (y - p) ** 2)])
        with np.errstate(invalid="ignore"):  # an empty bin has no mean
            measured, predicted, error, square = sums / count
        scatter = np.sqrt(np.maximum((square - error**2) * count / np.maximum(count - 1, 1), 0.0))
        rows.append((measured, predicted, scatter, (np.arange(bins) + 0.5) * reach / bins, count))
        # A constant prediction, such as no friction, has no scale.
        span = float(np.ptp(prediction.value(channel.quantity, one_turn, channel.pair))) or np.nan
        one = float(np.sqrt(np.mean((y - p) ** 2)))
        vary = bool(np.ptp(y) and np.ptp(p))
        metrics.append((float(np.mean(y - p)), one, one / span, np.corrcoef(y, p)[0, 1] if vary else 0.0))
    measured, predicted, scatter, phase, count = (np.stack(column) for column in zip(*rows, strict=True))
    bias, rms, relative, correlation = map(list, zip(*metrics, strict=True))
    dims = ("channel", "bin")
    by_channel = "SI, by channel"
    units = [QUANTITIES[c.quantity][0] for c in measurement.spec.channel]
    return labelled_dataset(
        {
            "measured": (dims, measured, by_channel, "mean of the measured values"),
            "predicted": (dims, predicted, by_channel, "mean of the predicted values"),
            "scatter": (dims, scatter, by_channel, "standard deviation of measured - predicted in the bin"),
            "phase": (dims, phase, "1", "middle of the bin, mesh cycles since A"),
            "count": (dims, count, "1", "samples in the bin"),
            "units": ("channel", units, "1", "SI unit of the channel"),
            "bias": ("channel", bias, by_channel, "mean of measured - predicted"),
            "rms": ("channel", rms, by_channel, "root mean square of measured - predicted"),
            "relative_rms": ("channel", relative, "1", "rms over the prediction's peak to peak"),
            "correlation": ("channel", correlation, "1", "Pearson correlation of measured and predicted"),
        },
        {"channel": ([c.name for c in measurement.spec.channel], "1", "channel")},
        provenance(prediction.pair)
        | {name: prediction.cycle.attrs[name] for name in ("teeth", "contact", "supports")}
        | {"record": measurement.spec.name, "source": measurement.spec.source},
    )


class _Samples(NamedTuple):
    """Samples (k,) of one channel.

    Attributes
    ----------
    phase : mesh cycles since A
    measured, predicted : values in the SI unit of the channel
    """

    phase: FloatArray
    measured: FloatArray
    predicted: FloatArray


def _samples(
    measurement: Measurement, prediction: Prediction, alignment: Alignment, channel: Channel
) -> _Samples:
    """Samples of one channel; for a channel of one tooth pair only the samples in contact."""
    u = alignment.cycles
    measured = measurement.channels[channel.name]
    if channel.pair is None:
        age = np.mod(u, 1.0)
        inside = np.ones(u.shape, dtype=bool)
    else:
        age = prediction.age(u, channel.pair)
        inside = prediction.contact(u, channel.pair)
    if not inside.any():
        raise NumericalError(
            f"No sample of {channel.name} is in contact; check the abscissae, the shift and the pair labels."
        )
    predicted = prediction.value(channel.quantity, u, channel.pair)
    return _Samples(age[inside], measured[inside], predicted[inside])
