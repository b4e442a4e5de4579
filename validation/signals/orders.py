"""Amplitudes of a motion over the orders of a shaft: mesh harmonics and sidebands.

A motion over N mesh cycles has the frequencies j f_m/N. The frequency j f_m/N is order j z/N of a shaft whose
gear has z teeth, and order j/N of the mesh. Sources: docs/theory/teeth.md, "Signals"; ISO 13373-2:2016, 5.4.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
import xarray as xr
from numpy.lib.stride_tricks import sliding_window_view
from scipy.interpolate import CubicSpline

from lumped.arguments import of_type, one_of, whole_number
from lumped.errors import refuse
from lumped.fields.text_file import parse_toml
from lumped.labelling import labelled_dataset
from lumped.schema.files import load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import ComplexArray, FloatArray

Shaft = Literal["pinion", "gear", "mesh"]
#: Relative error of the duration over whole mesh cycles, from rounded times.
_WHOLE = 1e-6


@dataclass(frozen=True, eq=False)
class Harmonics:
    """Complex amplitudes of one variable at j/``cycles`` of the mesh frequency, over whole mesh cycles."""

    pair: GearPair
    cycles: int
    values: ComplexArray
    unit: str
    words: str

    def teeth(self, shaft: Shaft) -> int:
        """Mesh cycles in a turn of the shaft; 1 for the mesh."""
        return {"pinion": self.pair.pinion.teeth, "gear": self.pair.gear.teeth, "mesh": 1}[shaft]

    def orders(self, shaft: Shaft) -> FloatArray:
        """Order of each component on a shaft."""
        return np.arange(self.values.size, dtype=np.float64) * (self.teeth(shaft) / self.cycles)

    def at(self, count: int) -> FloatArray:
        """Return the signal at ``count`` even times of the period, at most as many as the result has."""
        spectrum = 0.5 * count * self.values[: count // 2 + 1]
        spectrum[0] *= 2.0
        if count % 2 == 0:
            spectrum[-1] *= 2.0
        return np.fft.irfft(spectrum, count)


def harmonics(result: xr.Dataset, variable: str, derivative: int) -> Harmonics:
    """Return the harmonics of a variable or of a time derivative of the variable.

    The result must cover whole mesh cycles at even times; other results are refused.
    """
    of_type("result", result, xr.Dataset, "a dataset, as steady_state returns it")
    scalars = [str(name) for name, one in result.data_vars.items() if one.dims == ("time",)]
    one_of("variable", variable, scalars, "Choose a variable that depends on time alone.")
    whole_number("derivative", derivative, 0, 4)
    if "parameters" not in result.attrs:
        raise refuse("result", "no attribute 'parameters'", "a result of spurcheck", "Give it as computed.")
    pair = load_gear_pair(parse_toml(result.attrs["parameters"], "parameters of the result"))
    time = result["time"].to_numpy()
    signal = result[variable].to_numpy()
    if "pinion_turns" in result:  # a record whose speed changes: over the angle, not over time
        even = np.arange(time.size) * (float(result.attrs["turns"]) / time.size)
        signal = CubicSpline(result["pinion_turns"].to_numpy(), signal)(even)
        time = even * (2.0 * np.pi / pair.operating.pinion_speed)
    steps = np.diff(time)
    if time.size < 8 or np.ptp(steps) > _WHOLE * steps.mean():
        raise refuse("result", "uneven times", "times at even distances", "Use steady_state.")
    cycles = time.size * steps.mean() / pair.geometry.mesh_period
    if abs(cycles - round(cycles)) > _WHOLE * cycles:
        action = (
            "Use steady_state, or cut the run: a simulation ends one time late, result.isel(time=slice(-1))."
        )
        raise refuse("result", f"{cycles:.6g} mesh cycles", "a whole number of mesh cycles", action)
    values = np.fft.rfft(signal) / time.size
    values[1:] *= 2.0
    if time.size % 2 == 0:
        values[-1] *= 0.5
    rate = 2.0 * np.pi * np.arange(values.size) / (time.size * steps.mean())
    attributes: dict[Any, Any] = result[variable].attrs
    unit = str(attributes.get("units", "1")) + {0: "", 1: "/s"}.get(derivative, f"/s**{derivative}")
    words = str(attributes.get("long_name", variable))
    if derivative:
        words = f"{words}, derivative {derivative} by time"
    return Harmonics(pair, round(cycles), values * (1j * rate) ** derivative, unit, words)


def order_spectrum(
    result: xr.Dataset, shaft: Shaft = "mesh", *, variable: str = "dte", derivative: int = 0
) -> xr.Dataset:
    """Return the amplitudes of a motion over the orders of a shaft.

    Parameters
    ----------
    result : dataset of ``steady_state``, over one mesh cycle, or over the period of teeth that differ; or of
        ``synthetic_record``
    shaft : "pinion" or "gear", whose order 1 is once a turn; "mesh", whose order 1 is the mesh frequency
    variable : name of a variable that depends on time alone
    derivative : order of the time derivative; 2 gives the acceleration of a displacement

    Returns
    -------
    xarray.Dataset over ``order`` [1]: ``amplitude``, peak not peak to peak, in the variable's unit, per s to
    the power of ``derivative``; ``frequency`` [Hz]

    Raises
    ------
    ParameterError : a variable that is not there, or a result that does not cover whole mesh cycles
    """
    one_of("shaft", shaft, get_args(Shaft))
    components = harmonics(result, variable, derivative)
    frequency = np.arange(components.values.size) * (
        components.pair.geometry.mesh_frequency / components.cycles
    )
    return labelled_dataset(
        {
            "amplitude": (
                "order",
                np.abs(components.values),
                components.unit,
                f"amplitude of: {components.words}",
            ),
            "frequency": ("order", frequency, "Hz", "frequency"),
        },
        {"order": (components.orders(shaft), "1", f"order of the {shaft}")},
        result.attrs | {"shaft": shaft},
    )


def waterfall(
    result: xr.Dataset, shaft: Shaft = "mesh", *, variable: str = "dte", turns: int = 1
) -> xr.Dataset:
    """Return the amplitudes of a run-up over speed and order.

    The record has even steps of the angle, so that an order stays constant while the speed changes. The
    record is cut into blocks of whole turns; each block overlaps the next block by half. Each block is
    weighted by Hann's window. Amplitudes are exact for orders k/``turns`` of the pinion, k a whole number.

    Parameters
    ----------
    result : dataset of ``lumped.run_up``
    shaft : shaft to which the orders refer
    variable : name of a variable that depends on time alone
    turns : turns of the pinion in a block; more turns resolve orders better and speeds worse

    Returns
    -------
    xarray.Dataset over ``speed_rpm`` and ``order``: ``amplitude``, peak, in the variable's unit, and
    ``frequency`` [Hz]

    Raises
    ------
    ParameterError : no run-up, a variable that it lacks, or a run of less than one block
    """
    of_type("result", result, xr.Dataset, "a dataset, as run_up returns it")
    if "running_speed" not in result:
        raise refuse("result", "no variable 'running_speed'", "a result of run_up", "Give it as computed.")
    one_of("shaft", shaft, get_args(Shaft))
    scalars = [str(name) for name, one in result.data_vars.items() if one.dims == ("time",)]
    one_of("variable", variable, scalars, "Choose a variable that depends on time alone.")
    pair = load_gear_pair(parse_toml(result.attrs["parameters"], "parameters of the result"))
    size = round(whole_number("turns", turns, 1, 10_000) / float(result["pinion_turns"][1]))
    speed = result["running_speed"].to_numpy()
    signal = result[variable].to_numpy()
    if signal.size < size:
        allowed = f"at most {signal.size * turns / size:.3g} turns, the length of the run"
        raise refuse("turns", turns, allowed, "Give fewer turns, or a longer run.")
    first = np.arange(0, signal.size - size + 1, size // 2)
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(size) / size)
    blocks = sliding_window_view(signal, size)[first]
    amplitude = (
        2.0 / window.sum() * np.abs(np.fft.rfft((blocks - blocks.mean(axis=1, keepdims=True)) * window))
    )
    rpm = sliding_window_view(speed, size)[first].mean(axis=1)
    order = np.arange(amplitude.shape[1]) / turns
    teeth = {"pinion": 1.0, "gear": pair.gear.teeth / pair.pinion.teeth, "mesh": 1.0 / pair.pinion.teeth}
    attributes: dict[Any, Any] = result[variable].attrs
    words = f"amplitude of: {attributes['long_name']}"
    return labelled_dataset(
        {
            "amplitude": (("speed_rpm", "order"), amplitude, str(attributes["units"]), words),
            "frequency": (("speed_rpm", "order"), np.outer(rpm / 60.0, order), "Hz", "frequency"),
        },
        {
            "speed_rpm": (rpm, "rpm", "pinion speed"),
            "order": (order * teeth[shaft], "1", f"order of the {shaft}"),
        },
        result.attrs | {"shaft": shaft, "mesh_order": teeth[shaft] * pair.pinion.teeth},
    )
