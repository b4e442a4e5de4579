"""Synthetic sensor records: a periodic motion over many turns, with noise and a changing speed.

The motion at constant nominal speed is read over the angle. A changing speed stretches the time and excites
no vibration. A record is a test of signal processing, not a simulation of a run-up.

Source: docs/theory/teeth.md, "Signals".
"""

from __future__ import annotations

import numpy as np
import xarray as xr
from scipy.interpolate import CubicSpline

from lumped.arguments import real_number, whole_number
from lumped.errors import refuse
from lumped.labelling import labelled_dataset
from validation.signals.orders import harmonics

#: Most samples of a record.
_MOST = 20_000_000


def synthetic_record(
    result: xr.Dataset,
    turns: int,
    *,
    variable: str = "x_p",
    derivative: int = 2,
    noise: float = 0.0,
    speed_change: float = 0.0,
    seed: int = 1,
) -> xr.Dataset:
    """Return a record of many turns of the pinion, with white noise and a linear change of speed.

    Parameters
    ----------
    result : dataset of ``lumped.steady_state``
    turns : of the pinion; the record is cut to whole periods of the motion, at least one
    variable, derivative : as ``order_spectrum``
    noise : root mean square, in the unit of the derivative
    speed_change : of the pinion from the first to the last turn over its nominal speed: 0.02 is 2 % faster
    seed : of the noise

    Returns
    -------
    xarray.Dataset over ``time`` [s]: ``signal``, in the variable's unit per s to the power of ``derivative``;
    ``pinion_turns`` [1], what a tachometer gives

    Raises
    ------
    ParameterError : as ``order_spectrum``; a record of more than 20 million samples
    """
    components = harmonics(result, variable, derivative)
    count = whole_number("turns", turns, 1, 1_000_000)
    change = real_number("speed_change", speed_change, -0.9, 9.0, action="0.02 is 2 % faster at the end.")
    noise_level = real_number("noise", noise, 0.0, action="Give a root mean square.")
    generator = np.random.default_rng(whole_number("seed", seed, 0, 2**31))
    samples = result.sizes["time"]
    teeth = components.pair.pinion.teeth
    rate = components.pair.operating.pinion_speed / (2.0 * np.pi)
    repeats = max(count * teeth // components.cycles, 1)
    if repeats * samples > _MOST:
        raise refuse("turns", turns, f"records of at most {_MOST} samples", "Ask for fewer turns.")
    turns_of_record = repeats * components.cycles / teeth
    # The speed rate (1 + change t/T) makes rate T (1 + change/2) turns in the time T.
    duration = turns_of_record / (rate * (1.0 + 0.5 * change))
    time = np.arange(repeats * samples) * (duration / (repeats * samples))
    angle = rate * time * (1.0 + 0.5 * change * time / duration)
    period = components.at(samples)
    places = np.arange(samples + 1) * (turns_of_record / repeats / samples)
    curve = CubicSpline(places, np.append(period, period[0]), bc_type="periodic")
    signal = curve(np.mod(angle, turns_of_record / repeats)) + noise_level * generator.standard_normal(
        time.size
    )
    return labelled_dataset(
        {
            "signal": ("time", signal, components.unit, components.words),
            "pinion_turns": ("time", angle, "1", "turns of the pinion"),
        },
        {"time": (time, "s", "time")},
        result.attrs | {"noise": noise_level, "speed_change": change, "seed": seed, "turns": turns_of_record},
    )
