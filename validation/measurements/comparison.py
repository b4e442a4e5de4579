"""A record beside its prediction: read by mesh phase, aligned by it, sample by sample, and as metrics.

Sources: docs/theory/equations.md, "Frame", for what the phase is, "Periodic motion and the brake torque".
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

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

_SAMPLES = 1024  # of a prediction per mesh cycle
_COARSE = 32  # trial shifts per mesh cycle
_COARSE_SAMPLES = 2000
_ZOOM = 4
_FINEST = 1e-6  # mesh cycles
_FARTHEST = 1e9  # mesh cycles, where double precision still resolves the finest shift


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
        """Of the pair."""
        return self.pair.geometry

    def age(self, cycles: ArrayLike, label: str) -> FloatArray:
        """Mesh cycles since the labelled pair was last at A; in contact while below the contact ratio."""
        u = np.asarray(cycles, dtype=float) - PAIR_LABELS.index(label)
        return np.asarray(np.mod(u, self.recurrence), dtype=np.float64)

    def contact(self, cycles: ArrayLike, label: str) -> BoolArray:
        """Whether the labelled pair is in contact."""
        return np.asarray(self.age(cycles, label) < self.geometry.contact_ratio, dtype=np.bool_)

    @cached_property
    def ahead(self) -> IntArray:
        """Whole pitches by which each tooth pair of ``cycle`` is ahead of the one that is at A at the start.

        With loaded contact pairs touch before A and behind D, so the last is below 0.
        """
        g = self.geometry
        place = self.cycle["position"].to_numpy()[:, 0] - g.L_XA
        return np.asarray(np.round(place / g.base_pitch), dtype=np.int64)

    @property
    def life(self) -> tuple[float, float]:
        """Mesh cycles since A between which a tooth pair can carry load: wider than A to D if loaded."""
        if self.pair.mesh.contact == "loaded":
            return float(self.ahead.min()), float(self.ahead.max()) + 1.0
        return 0.0, self.geometry.contact_ratio

    def since(self, cycles: ArrayLike, label: str) -> FloatArray:
        """``age``, negative before A where a pair can touch there."""
        age = self.age(cycles, label)
        first = self.life[0]
        return np.asarray(np.where(age >= self.recurrence + first, age - self.recurrence, age))

    def value(self, quantity: str, cycles: ArrayLike, label: str | None = None) -> FloatArray:
        """A predicted quantity [SI] at mesh cycles u; of one labelled pair where it has pairs."""
        places, values = self._curves[quantity]
        if label is None:
            u = np.mod(np.asarray(cycles, dtype=float), 1.0)
            return np.asarray(np.interp(u, places, values, period=1.0), dtype=np.float64)
        age, (first, last) = self.since(cycles, label), self.life
        inside = (age >= first) & (age < last)
        return np.asarray(np.where(inside, np.interp(age, places, values), 0.0), dtype=np.float64)

    @cached_property
    def _curves(self) -> dict[str, tuple[FloatArray, FloatArray]]:
        """Quantity -> mesh cycles and values: over one cycle, or of one tooth pair over its life.

        Whole cycles after A a tooth pair is that many places ahead. Past the last sample of its life its
        value holds.
        """
        grid = self.cycle["time"].to_numpy() / self.geometry.mesh_period
        young = np.argsort(self.ahead)
        life = (self.ahead[young][:, None] + grid).ravel()
        first, last = self.life
        inside = (life >= first) & (life < last)
        found = {}
        for name, (_, paired) in QUANTITIES.items():
            values = self.cycle[name].to_numpy()
            found[name] = (life[inside], values[young].ravel()[inside]) if paired else (grid, values)
        return found


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
    """Mesh cycles of the samples before alignment, (k,) [-]: u = t/T_m at the record's speed."""
    g = pair.with_({"operating.pinion_speed": measurement.spec.pinion_speed}).geometry
    return np.asarray(measurement.abscissa / g.mesh_period, dtype=np.float64)


def align(measurement: Measurement, prediction: Prediction, *, shift: float | None = None) -> Alignment:
    """Find the mesh phase of a record by least squares against the prediction.

    For every trial shift each channel may have its own gain and zero, so that a calibration error does not
    move the phase. Normal loads hardly depend on friction, so where a record has them they alone are aligned:
    a friction coefficient found afterwards is not built into the alignment.

    ``shift``: a known one [mesh cycles], with which nothing is searched. A NumericalError says that the
    channels do not vary, or that the best shift explains less than half of their variation.
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
    """Measured and predicted values over one engagement (pair channels) or one mesh cycle, in phase bins.

    Returns a dataset over ``channel`` and ``bin``; empty bins are NaN with count 0. Metrics of
    all samples are over ``channel``; the relative one is NaN where the prediction is constant.
    """
    rows = []
    metrics = []
    one_turn = np.linspace(0.0, prediction.geometry.pairs, 2048, endpoint=False)
    for channel in measurement.spec.channel:
        age, y, p = _samples(measurement, prediction, alignment, channel)
        reach = prediction.geometry.contact_ratio if channel.pair else 1.0
        place = np.minimum((age / reach * bins).astype(np.int64), bins - 1)
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
    own = "SI, by channel"
    units = [QUANTITIES[c.quantity][0] for c in measurement.spec.channel]
    return labelled_dataset(
        {
            "measured": (dims, measured, own, "mean of the measured values"),
            "predicted": (dims, predicted, own, "mean of the predicted values"),
            "scatter": (dims, scatter, own, "standard deviation of measured - predicted in the bin"),
            "phase": (dims, phase, "1", "middle of the bin, mesh cycles since A"),
            "count": (dims, count, "1", "samples in the bin"),
            "units": ("channel", units, "1", "SI unit of the channel"),
            "bias": ("channel", bias, own, "mean of measured - predicted"),
            "rms": ("channel", rms, own, "root mean square of measured - predicted"),
            "relative_rms": ("channel", relative, "1", "rms over the prediction's peak to peak"),
            "correlation": ("channel", correlation, "1", "Pearson correlation of measured and predicted"),
        },
        {"channel": ([c.name for c in measurement.spec.channel], "1", "channel")},
        provenance(prediction.pair)
        | {name: prediction.cycle.attrs[name] for name in ("teeth", "contact", "supports")}
        | {"record": measurement.spec.name, "source": measurement.spec.source},
    )


def _samples(
    measurement: Measurement, prediction: Prediction, alignment: Alignment, channel: Channel
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Phase since A, measured and predicted of a channel's samples (pairs: in contact only)."""
    u, y = alignment.cycles, measurement.channels[channel.name]
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
    p = prediction.value(channel.quantity, u, channel.pair)
    return age[inside], y[inside], p[inside]
