"""Synthetic records whose truth is known: tooth forces sampled as an instrumented tooth pair would."""

import numpy as np

from validation.check.curves import Channel, Curves
from validation.check.quantities import PAIR_LABELS


def tooth_force_record(
    truth,  # MotionCurves of the true pair
    *,
    seed,
    engagements=12,
    samples_per_cycle=100.3,  # not an integer, so that phases fill in
    noise=0.02,  # standard deviation over the largest value of the channel
    start=0.0,  # mesh cycles since pair A was at A
):
    rng = np.random.default_rng(seed)
    g = truth.pair.geometry
    u = np.arange(int(engagements * truth.recurrence * samples_per_cycle)) / samples_per_cycle
    channels = []
    for label in PAIR_LABELS[: g.pairs]:
        for quantity in ("normal_load", "friction_force"):
            values = truth.at(quantity, start + u, label)
            size = noise * float(np.abs(values).max())
            measured = values + size * rng.standard_normal(u.size)
            name = f"{quantity.split('_')[0]}_{label}"
            channels.append(Channel(name, quantity, measured, label, size or None))
    return Curves(
        name="synthetic tooth forces",
        abscissa="time",
        places=u * g.mesh_period,
        channels=tuple(channels),
        role="measurement",
        pinion_speed=truth.pair.operating.pinion_speed,
        pinion_torque=truth.pair.operating.pinion_torque,
        recurrence=truth.recurrence,
    )
