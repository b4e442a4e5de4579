"""Alignment of a record with a prediction by mesh phase.

Sources: least squares over the phase; docs/theory/equations.md, "Frame", for what the phase is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lumped.arguments import real_number
from lumped.errors import NumericalError
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.typing import FloatArray
from validation.measurements.prediction import Prediction
from validation.measurements.record import Measurement

_COARSE = 32  # trial shifts per mesh cycle
_COARSE_SAMPLES = 2000
_ZOOM = 4
_FINEST = 1e-6  # mesh cycles
_FARTHEST = 1e9  # mesh cycles, where double precision still resolves the finest shift


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

    @property
    def sample_spacing(self) -> float:
        """Median distance of the samples [mesh cycles]."""
        return float(np.median(np.diff(self.cycles)))


def mesh_cycles(measurement: Measurement, pair: AnyPair) -> FloatArray:
    """Mesh cycles of the samples before alignment, (k,) [-].

    From roll angles eps of pair A's contact on the pinion, xi = r_bp eps and u = (xi - L_XA)/lambda; from
    times, u = t/T_m at the record's speed.

    Parameters
    ----------
    measurement : the record
    pair : the gear pair
    """
    pair = load_gear_pair(pair)
    at = pair.with_({"operating.pinion_speed": measurement.spec.pinion_speed})
    g = at.geometry
    if measurement.spec.abscissa.kind == "roll_angle":
        return np.asarray(
            (g.base_radius_pinion * measurement.abscissa - g.L_XA) / g.base_pitch, dtype=np.float64
        )
    return np.asarray(measurement.abscissa / g.mesh_period, dtype=np.float64)


def align(measurement: Measurement, prediction: Prediction, *, shift: float | None = None) -> Alignment:
    """Find the mesh phase of a record by least squares against the prediction.

    For every trial shift each channel may have its own gain and zero, so that a calibration error does not
    move the phase. Normal loads hardly depend on friction, so where a record has them they alone are aligned:
    a friction coefficient found afterwards is not built into the alignment.

    Parameters
    ----------
    measurement : the record
    prediction : at the record's operating point
    shift : a known shift [mesh cycles], e.g. 0 for exact roll angles; then nothing is searched

    Raises
    ------
    ParameterError : a shift or abscissae beyond 1e9 mesh cycles
    NumericalError : the channels do not vary, or the best shift explains less than half of their variation
    """
    raw = mesh_cycles(measurement, prediction.pair)
    farthest = float(np.abs(raw).max())
    real_number("abscissa", farthest, 0.0, _FARTHEST, unit="mesh cycles", action="Check its unit.")
    if shift is not None:
        advice = "Check its unit."
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
