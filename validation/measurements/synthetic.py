"""Synthetic records whose truth is known, in the format of tooth-pair force measurements.

Sources: the tooth-pair records of Rebbechi, Oswald and Townsend 1996, whose form they take.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import tomli_w
from scipy.signal import lfilter

from lumped.arguments import file_path, real_number, whole_number
from lumped.typing import FloatArray
from validation.measurements.prediction import Prediction
from validation.measurements.record import PAIR_LABELS, Measurement, MeasurementSpec


def synthetic_measurement(
    truth: Prediction,
    *,
    seed: int,
    engagements: int = 12,
    samples_per_cycle: float = 100.3,
    noise_normal: float = 0.02,
    noise_friction: float = 0.02,
    correlation: float = 0.0,
    start: float = 0.0,
) -> Measurement:
    """Sample a prediction as an instrumented tooth pair would, and add sensor noise.

    Parameters
    ----------
    truth : the prediction that is the truth; its friction law is what identification should find
    seed : of the noise
    engagements : times each labelled pair passes through the mesh
    samples_per_cycle : samples per mesh cycle; not an integer, so that phases fill in
    noise_normal, noise_friction : standard deviations over the mean mesh load T_p/r_bp, and over the largest
        friction force
    correlation : of neighbouring noise samples (first-order autoregression), as an anti-aliasing filter makes
    start : mesh cycles since pair A was at A when the record starts; unknown to whoever aligns it

    Returns
    -------
    Measurement with time as abscissa, channels normal_A, friction_A, normal_B, ...
    """
    engagements = whole_number("engagements", engagements, 1, 1_000_000)
    real_number("correlation", correlation, 0.0, 1.0 - 1e-9)
    real_number("samples_per_cycle", samples_per_cycle, 4.0, 65536.0, above=True)
    for name, value in (("noise_normal", noise_normal), ("noise_friction", noise_friction)):
        real_number(name, value, 0.0)
    real_number("start", start)
    rng = np.random.default_rng(whole_number("seed", seed, 0, 2**63 - 1))
    g = truth.geometry
    count = int(engagements * truth.recurrence * samples_per_cycle)
    time = np.arange(count, dtype=np.float64) * (g.mesh_period / samples_per_cycle)
    u = start + np.arange(count, dtype=np.float64) / samples_per_cycle
    load = truth.pair.operating.pinion_torque / g.base_radius_pinion
    channels: dict[str, FloatArray] = {}
    entries: list[dict[str, Any]] = []
    for label in PAIR_LABELS[: g.pairs]:
        clean = {q: truth.value(q, u, label) for q in ("normal_load", "friction_force")}
        sizes = {
            "normal_load": noise_normal * load,
            "friction_force": noise_friction * float(np.abs(clean["friction_force"]).max()),
        }
        for quantity, values in clean.items():
            name = f"{quantity.split('_')[0]}_{label}"
            channels[name] = np.asarray(values + sizes[quantity] * _noise(rng, count, correlation))
            entry = {"name": name, "column": name, "quantity": quantity, "unit": "N", "pair": label}
            entries.append(entry | {"noise": sizes[quantity] or None})
    spec = MeasurementSpec.model_validate(
        {
            "name": "synthetic tooth forces",
            "source": f"computed, seed {seed}",
            "data": "tooth_forces.csv",
            "pinion_speed": repr(truth.pair.operating.pinion_speed),
            "pinion_torque": truth.pair.operating.pinion_torque,
            "recurrence": truth.recurrence,
            "abscissa": {"kind": "time", "column": "time", "unit": "s"},
            "channel": entries,
        }
    )
    noise = {c.name: c.noise for c in spec.channel}
    return Measurement(spec, np.asarray(time, dtype=np.float64), channels, noise)


def _noise(rng: np.random.Generator, count: int, correlation: float) -> FloatArray:
    """Stationary normal noise of unit variance, first-order autoregressive."""
    white = rng.standard_normal(count)
    if correlation == 0.0:
        return white
    shape = np.sqrt(1.0 - correlation**2)
    start = [correlation * rng.standard_normal()]
    noise, _ = lfilter([shape], [1.0, -correlation], white, zi=start)
    return np.asarray(noise, dtype=np.float64)


def write_measurement(measurement: Measurement, folder: str | Path) -> Path:
    """Write a record as ``measurement.toml`` and its CSV; returns the path of the former.

    Parameters
    ----------
    measurement : of ``synthetic_measurement``: SI values, gains 1 and zeros 0
    folder : created if it does not exist
    """
    spec = measurement.spec
    target = file_path("folder", folder)
    target.mkdir(parents=True, exist_ok=True)
    data = spec.model_dump(mode="json", exclude_none=True)
    data["pinion_speed"] = repr(spec.pinion_speed)
    (target / "measurement.toml").write_text(tomli_w.dumps(data), encoding="utf-8")
    headings = ["time", *(c.column for c in spec.channel)]
    rows = np.column_stack([measurement.abscissa, *(measurement.channels[c.name] for c in spec.channel)])
    np.savetxt(target / spec.data, rows, delimiter=",", header=",".join(headings), comments="", fmt="%.9g")
    return target / "measurement.toml"
