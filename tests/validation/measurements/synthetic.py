"""Synthetic records whose truth is known: tooth forces sampled as an instrumented tooth pair would."""

import numpy as np
import tomli_w
from scipy.signal import lfilter

from validation.measurements.record import PAIR_LABELS, Measurement, MeasurementSpec


def synthetic_measurement(
    truth,
    *,
    seed,
    engagements=12,
    samples_per_cycle=100.3,  # not an integer, so that phases fill in
    noise_normal=0.02,  # standard deviation over the mean mesh load
    noise_friction=0.02,  # over the largest friction force
    correlation=0.0,  # of neighbouring samples of the noise, as an anti-aliasing filter makes
    start=0.0,  # mesh cycles since pair A was at A
):
    rng = np.random.default_rng(seed)
    g = truth.geometry
    u = np.arange(int(engagements * truth.recurrence * samples_per_cycle)) / samples_per_cycle
    load = truth.pair.operating.pinion_torque / g.base_radius_pinion
    channels = {}
    entries = []
    for label in PAIR_LABELS[: g.pairs]:
        for quantity, share in (("normal_load", noise_normal), ("friction_force", noise_friction)):
            values = truth.value(quantity, start + u, label)
            size = share * (load if quantity == "normal_load" else float(np.abs(values).max()))
            name = f"{quantity.split('_')[0]}_{label}"
            channels[name] = values + size * _noise(rng, u.size, correlation)
            entry = {"name": name, "column": name, "quantity": quantity, "unit": "N", "pair": label}
            entries.append(entry | {"noise": size or None})
    spec = MeasurementSpec.model_validate({
        "name": "synthetic tooth forces", "source": f"computed, seed {seed}", "data": "tooth_forces.csv",
        "pinion_speed": repr(truth.pair.operating.pinion_speed),
        "pinion_torque": truth.pair.operating.pinion_torque, "recurrence": truth.recurrence,
        "abscissa": {"kind": "time", "column": "time", "unit": "s"}, "channel": entries,
    })  # fmt: skip
    return Measurement(spec, u * g.mesh_period, channels, {c.name: c.noise for c in spec.channel})


def _noise(rng, count, correlation):
    """Stationary normal noise of unit variance, first-order autoregressive."""
    white = rng.standard_normal(count)
    if correlation == 0.0:
        return white
    start = [correlation * rng.standard_normal()]
    return lfilter([np.sqrt(1.0 - correlation**2)], [1.0, -correlation], white, zi=start)[0]


def write_measurement(measurement, folder):
    """Write ``measurement.toml`` and its CSV; returns the path of the former."""
    spec = measurement.spec
    data = spec.model_dump(mode="json", exclude_none=True) | {"pinion_speed": repr(spec.pinion_speed)}
    (folder / "measurement.toml").write_text(tomli_w.dumps(data), encoding="utf-8")
    rows = np.column_stack([measurement.abscissa, *(measurement.channels[c.name] for c in spec.channel)])
    header = ",".join(["time", *(c.column for c in spec.channel)])
    np.savetxt(folder / spec.data, rows, delimiter=",", header=header, comments="", fmt="%.9g")
    return folder / "measurement.toml"
