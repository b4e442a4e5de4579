"""Alignment of a record with a prediction by mesh phase.

Sources: least squares over the phase; docs/theory/equations.md, "Frame", for what the phase is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lumped.arguments import real_number, some_of
from lumped.errors import NumericalError, refuse
from lumped.schema.pair import GearPair
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
    channels : the channels it was found from; empty where the shift was given
    gain : factor from prediction to record of each of these channels, in the least-squares sense
    share_explained : 1 - residual sum of squares over total sum of squares at the best shift
    """

    cycles: FloatArray
    shift: float
    standard_error: float
    channels: tuple[str, ...] = ()
    gain: tuple[float, ...] = ()
    share_explained: float = 1.0

    @property
    def sample_spacing(self) -> float:
        """Median distance of the samples [mesh cycles]."""
        return float(np.median(np.diff(self.cycles)))


def mesh_cycles(measurement: Measurement, pair: GearPair) -> FloatArray:
    """Mesh cycles of the samples before alignment, (k,) [-].

    From roll angles eps of pair A's contact on the pinion, xi = r_bp eps and u = (xi - L_XA)/lambda; from
    times, u = t/T_m at the record's speed.

    Parameters
    ----------
    measurement : the record
    pair : the gear pair
    """
    at = pair.with_({"operating.pinion_speed": f"{measurement.spec.pinion_speed!r} rad/s"})
    g = at.geometry
    if measurement.spec.abscissa.kind == "roll_angle":
        return np.asarray(
            (g.base_radius_pinion * measurement.abscissa - g.L_XA) / g.base_pitch, dtype=np.float64
        )
    return np.asarray(measurement.abscissa / g.mesh_period, dtype=np.float64)


def align(
    measurement: Measurement,
    prediction: Prediction,
    *,
    shift: float | None = None,
    channels: Sequence[str] | None = None,
) -> Alignment:
    """Find the mesh phase of a record by least squares against the prediction.

    For every trial shift each channel may have its own gain and zero, so that a calibration error does not
    move the phase. The default channels are the normal loads: they hardly depend on friction, so a friction
    coefficient found afterwards is not built into the alignment.

    Parameters
    ----------
    measurement : the record
    prediction : at the record's operating point
    shift : a known shift [mesh cycles], e.g. 0 for exact roll angles; then nothing is searched
    channels : names of the channels to align by; default all normal loads, else all channels

    Raises
    ------
    ParameterError : unknown channel names, or a shift or abscissae beyond 1e9 mesh cycles
    NumericalError : the channels do not vary, or the best shift explains less than half of their variation
    """
    raw = mesh_cycles(measurement, prediction.pair)
    farthest = float(np.abs(raw).max())
    real_number("abscissa", farthest, 0.0, _FARTHEST, unit="mesh cycles", action="Check its unit.")
    if shift is not None:
        advice = "Check its unit."
        shift = real_number("shift", shift, -_FARTHEST, _FARTHEST, unit="mesh cycles", action=advice)
        return Alignment(raw + shift, shift, 0.0)
    chosen = _chosen(measurement, channels)
    labels = {c.name: (c.quantity, c.pair) for c in measurement.spec.channel}
    values = np.array([measurement.channels[name] for name in chosen])
    values = values - values.mean(axis=1, keepdims=True)
    spread = np.sqrt((values**2).mean(axis=1))
    if not (spread > 0.0).all():
        raise NumericalError(
            "A channel to align by is constant; name channels that vary over the mesh cycle."
        )
    values /= spread[:, None]

    def misfit(trial: float, take: slice) -> tuple[float, FloatArray]:
        lost, gains = 0.0, np.zeros(len(chosen))
        for j, name in enumerate(chosen):
            model = prediction.value(labels[name][0], raw[take] + trial, labels[name][1])
            model = model - model.mean()
            y = values[j, take] - values[j, take].mean()
            power = float(model @ model)
            gains[j] = 0.0 if power == 0.0 else float(model @ y) / power
            # A negative gain is the wrong phase, not a fit.
            lost += float(((y - max(gains[j], 0.0) * model) ** 2).sum())
        return lost, gains * spread

    every = slice(None, None, max(raw.size // _COARSE_SAMPLES, 1))
    paired = any(labels[name][1] is not None for name in chosen)
    reach = prediction.recurrence if paired else 1
    trials = np.arange(reach * _COARSE) / _COARSE
    best = float(trials[np.argmin([misfit(t, every)[0] for t in trials])])
    step = 1.0 / _COARSE
    while step > _FINEST:
        fine = best + step * np.linspace(-1.0, 1.0, 2 * _ZOOM + 1)
        losses = np.array([misfit(float(t), slice(None))[0] for t in fine])
        # Sampled jumps make the misfit flat between samples: take the middle of the flat bottom.
        bottom = fine[losses <= losses.min() * (1.0 + 1e-12)]
        best = float(0.5 * (bottom[0] + bottom[-1]))
        step /= _ZOOM
    lost, gains = misfit(best, slice(None))
    explained = 1.0 - lost / values.size
    if explained < 0.5:
        raise NumericalError(
            f"The best shift explains only {100 * explained:.0f} % of the record's variation: check speed, "
            "pair labels, signs (gain) and recurrence, or give the shift."
        )
    h = max(float(np.median(np.diff(raw))), 1.0 / prediction.cycle["time"].size)
    rise = 0.5 * (misfit(best + h, slice(None))[0] + misfit(best - h, slice(None))[0]) - lost
    # The sum of squares over the noise variance rises by 1 at one standard error.
    error = h * float(np.sqrt(lost / values.size / rise)) if rise > 0.0 else h
    best = float(np.mod(best, reach))
    return Alignment(raw + best, best, error, tuple(chosen), tuple(float(x) for x in gains), explained)


def _chosen(measurement: Measurement, channels: Sequence[str] | None) -> list[str]:
    known = list(measurement.channels)
    if channels is None:
        loads = [name for name, _ in measurement.named("normal_load")]
        return loads or known
    chosen = some_of("channels", channels, known)
    if not chosen:
        raise refuse("channels", "none", "names out of " + ", ".join(known), "Name a channel, or a shift.")
    return list(chosen)
