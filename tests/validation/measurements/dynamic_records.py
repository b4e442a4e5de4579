"""Synthetic records of a predicted motion: noise, another phase, samples at no whole number a mesh cycle.

They read the motion by an interpolation of their own, not by what reads it in the program.
"""

import numpy as np

from validation.measurements.record import QUANTITIES, Measurement, MeasurementSpec


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
    channels = {}
    entries = []
    for quantity in quantities:
        values = motion(prediction, quantity, u)
        values = values if change is None else change(quantity, values, u)
        channels[quantity] = values + noise * np.ptp(values) * rng.normal(size=u.size)
        entry = {"name": quantity, "column": quantity, "quantity": quantity, "unit": QUANTITIES[quantity][0]}
        entries.append(entry | ({"pair": "A"} if QUANTITIES[quantity][1] else {}))
    own = prediction.pair.operating
    given = {
        "name": "made", "source": f"computed, seed {seed}", "data": "made.csv",
        "pinion_speed": repr(own.pinion_speed), "pinion_torque": own.pinion_torque,
        "abscissa": {"kind": "time", "column": "time", "unit": "s"}, "channel": entries,
    }  # fmt: skip
    described = MeasurementSpec.model_validate(given | spec)
    time = (u - phase) * prediction.pair.geometry.mesh_period
    return Measurement(described, time, channels, dict.fromkeys(quantities))
