"""Synthetic records of a predicted motion: noise, another phase, samples at no whole number a mesh cycle.

They read the motion by an interpolation of their own, not by what reads it in the program.
"""

import numpy as np

from validation.check.curves import Channel, Curves
from validation.check.quantities import QUANTITIES


def motion(prediction, quantity, cycles):
    """A quantity of the whole period of a prediction at mesh cycles; of tooth pair A where it has pairs."""
    values = prediction.cycle[quantity].to_numpy()
    count = prediction.mesh_cycles
    if values.ndim == 1:
        grid = np.arange(values.size) * (count / values.size)
        return np.interp(cycles, grid, values, period=count)
    # Like teeth. A pair that touches before A is one place behind that at A, which is two from the first
    # where the contact ratio is below 2.
    places = len(values)
    age = np.mod(cycles + (places - 2), prediction.pair.pinion.teeth)
    place = np.minimum((np.mod(age, 1.0) * values.shape[1]).astype(int), values.shape[1] - 1)
    slot = places - 1 - np.floor(age).astype(int)
    return np.where(slot >= 0, values[np.maximum(slot, 0), place], 0.0)


def dynamic_record(
    prediction,
    quantities=("dte",),
    *,
    noise=0.01,
    cycles=60,
    per_cycle=50.317,
    phase=0.37,
    seed=1,
    change=None,
    **spec,
):
    """A record of quantities; ``noise`` over the peak to peak; ``change(quantity, values, u)`` is a fault.

    ``u`` are mesh cycles since pair A was at A.
    """
    rng = np.random.default_rng(seed)
    u = np.arange(int(cycles * per_cycle)) / per_cycle + phase
    channels = []
    for quantity in quantities:
        values = motion(prediction, quantity, u)
        values = values if change is None else change(quantity, values, u)
        measured = values + noise * np.ptp(values) * rng.normal(size=u.size)
        tooth_pair = "A" if QUANTITIES[quantity].of_tooth_pair else None
        channels.append(Channel(quantity, quantity, measured, tooth_pair))
    operating = prediction.pair.operating
    stated = {"pinion_speed": operating.pinion_speed, "pinion_torque": operating.pinion_torque}
    return Curves(
        name="made",
        abscissa="time",
        places=(u - phase) * prediction.pair.geometry.mesh_period,
        channels=tuple(channels),
        role="measurement",
        **(stated | spec),
    )
