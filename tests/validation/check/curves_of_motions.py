"""Curves of other models for tests: motions of altered pairs, sampled by an interpolation of their own."""

import numpy as np

from tests.validation.check.motions import predicted
from validation.check.curves import Channel, Curves
from validation.check.quantities import QUANTITIES


def sampled(
    pair, quantities, *, cycles=5, per_cycle=201.7, phase=0.37, noise=0.0, seed=1, change=None, role="model"
):
    """Curves of the motion of a pair; ``change(quantity, values, time)`` is a fault of the reading."""
    prediction = predicted(pair)
    period = prediction.mesh_cycles
    whole = cycles * period
    u = phase + np.arange(round(whole * per_cycle)) / per_cycle
    time = (u - phase) * pair.geometry.mesh_period
    rng = np.random.default_rng(seed)
    channels = []
    for name in quantities:
        kind = QUANTITIES[name]
        values = prediction.cycle[kind.variable].to_numpy()
        values = values.sum(axis=0) if kind.summed else values
        grid = np.arange(values.size) * (period / values.size)
        curve = np.interp(np.mod(u, period), grid, values, period=period)
        curve = curve if change is None else change(name, curve, time)
        channels.append(Channel(name, name, curve + noise * np.ptp(curve) * rng.normal(size=u.size)))
    return Curves("other", "time", time, tuple(channels), role)
