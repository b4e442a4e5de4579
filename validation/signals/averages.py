"""The time-synchronous average of a shaft, its residual and difference signals, and condition indicators.

The average over all turns contains only orders that are whole numbers. The residual signal is the average
without the mesh harmonics m z. The difference signal is the residual signal without the first sidebands
m z - 1 and m z + 1.

Sources: McFadden, Mech. Syst. Signal Process. 1 (1987) 83-95 (average); Stewart, University of Southampton,
MHM/R/10/77, 1977 (FM0, FM4); Martin 1989 (M6A); Zakrajsek, Townsend and Decker, NASA TM-105950, 1993 (NA4).
"""

from __future__ import annotations

from typing import Literal

import numpy as np
import xarray as xr

import lumped
from lumped.arguments import of_type, one_of, real_number, whole_number
from lumped.errors import refuse
from lumped.labelling import labelled_dataset
from lumped.typing import BoolArray, FloatArray
from validation.signals.orders import Harmonics, harmonics

Gear = Literal["pinion", "gear"]
GEARS: tuple[Gear, Gear] = ("pinion", "gear")
#: An order closer than this to a whole number counts as whole: the distance is rounding.
_WHOLE = 1e-6
#: A signal below this share of the root mean square of the average is rounding. Its moments are NaN.
_NOTHING = 1e-9


def time_synchronous_average(
    result: xr.Dataset, shaft: Gear = "pinion", *, variable: str = "x_p", derivative: int = 2
) -> xr.Dataset:
    """Return the mean of a motion over the turns of a shaft.

    Parameters
    ----------
    result : dataset of ``steady_state`` or ``synthetic_record``
    shaft : "pinion" or "gear"
    variable : name of a variable that depends on time alone
    derivative : order of the time derivative; an accelerometer measures derivative 2 of a displacement

    Returns
    -------
    xarray.Dataset over ``turn``, 0 to 1, of ``average``, with the variable's unit, per s to the power of
    ``derivative``; the attribute ``teeth`` is the number of teeth of the shaft's gear

    Raises
    ------
    ParameterError : as ``order_spectrum``
    """
    one_of("shaft", shaft, ("pinion", "gear"))
    components = harmonics(result, variable, derivative)
    return labelled_dataset(
        {
            "average": (
                "turn",
                _average(components, shaft),
                components.unit,
                f"average over turns of: {components.words}",
            )
        },
        {"turn": (_turn(_count(components, shaft)), "1", f"turn of the {shaft}")},
        result.attrs | {"shaft": shaft, "teeth": components.teeth(shaft)},
    )


def _count(components: Harmonics, shaft: Gear) -> int:
    """Return the number of samples in a turn, with the samples per mesh cycle of the result."""
    return components.teeth(shaft) * max(2 * (components.values.size - 1) // components.cycles, 2)


def _turn(count: int) -> FloatArray:
    return np.arange(count) / count


def _average(components: Harmonics, shaft: Gear) -> FloatArray:
    orders = components.orders(shaft)
    count = _count(components, shaft)
    is_whole = (np.abs(orders - np.round(orders)) < _WHOLE) & (orders < count / 2 - 0.5)
    spectrum = np.zeros(count // 2 + 1, dtype=np.complex128)
    spectrum[np.round(orders[is_whole]).astype(int)] = 0.5 * count * components.values[is_whole]
    spectrum[0] *= 2.0
    return np.fft.irfft(spectrum, count)


def residual(average: xr.Dataset) -> xr.Dataset:
    """Return a time-synchronous average without mean and mesh harmonics m z, in the same unit."""
    return _without(average, 0)


def difference(average: xr.Dataset) -> xr.Dataset:
    """Return a time-synchronous average without mean and orders m z, m z - 1, m z + 1, in the same unit."""
    return _without(average, 1)


def _without(average: xr.Dataset, sidebands: int) -> xr.Dataset:
    of_type("average", average, xr.Dataset, "a dataset of time_synchronous_average")
    if "average" not in average or "teeth" not in average.attrs:
        allowed = "a dataset of time_synchronous_average"
        raise refuse("average", ", ".join(map(str, average.data_vars)), allowed, "Compute it first.")
    values = average["average"].to_numpy()
    filtered = _filtered(values, int(average.attrs["teeth"]), sidebands)
    return average.assign(average=average["average"].copy(data=filtered))


def _mesh_orders(count: int, teeth: int, sidebands: int) -> BoolArray:
    orders = np.arange(count // 2 + 1)
    distance = np.abs(orders - teeth * np.round(orders / teeth))
    is_mesh_order: BoolArray = np.where(orders < teeth / 2, orders == 0, distance <= sidebands)
    return is_mesh_order


def _filtered(values: FloatArray, teeth: int, sidebands: int) -> FloatArray:
    spectrum = np.fft.rfft(values)
    spectrum[_mesh_orders(values.size, teeth, sidebands)] = 0.0
    return np.fft.irfft(spectrum, values.size)


def sidebands(
    result: xr.Dataset, shaft: Gear = "pinion", *, variable: str = "dte", derivative: int = 0, most: int = 5
) -> xr.Dataset:
    """Return the amplitude of each sideband over the amplitude of its mesh harmonic, a(m z + k)/a(m z).

    Parameters
    ----------
    result, shaft, variable, derivative : as ``time_synchronous_average``
    most : sidebands on each side

    Returns
    -------
    xarray.Dataset over ``mesh_order`` m = 1, 2, 3 and ``sideband`` k from -most to most: ``ratio`` [1]

    Raises
    ------
    ParameterError : as ``order_spectrum``
    """
    one_of("shaft", shaft, ("pinion", "gear"))
    components = harmonics(result, variable, derivative)
    teeth = components.teeth(shaft)
    most_sidebands = whole_number("most", most, 1, max(teeth // 2, 1))
    amplitudes = np.abs(components.values)
    k = np.arange(-most_sidebands, most_sidebands + 1)
    rows = []
    for m in (1, 2, 3):
        component_number = (m * teeth + k) * components.cycles / teeth
        index = np.minimum(np.round(component_number).astype(int), amplitudes.size - 1)
        is_component = np.abs(component_number - index) < _WHOLE
        mesh_amplitude = amplitudes[min(m * components.cycles, amplitudes.size - 1)]
        rows.append(np.where(is_component, amplitudes[index], 0.0) / mesh_amplitude)
    return labelled_dataset(
        {"ratio": (("mesh_order", "sideband"), np.stack(rows), "1", "amplitude over the mesh harmonic's")},
        {
            "mesh_order": (np.arange(1, 4), "1", "mesh order"),
            "sideband": (k, "1", f"orders of the {shaft} from the mesh harmonic"),
        },
        result.attrs | {"shaft": shaft, "teeth": teeth},
    )


#: Indicator -> its words.
_INDICATORS = {
    "RMS": "root mean square of the average",
    "Kurtosis": "fourth moment of the average over its squared variance",
    "CrestFactor": "largest value of the average over its root mean square",
    "FM0": "peak to peak of the average over the sum of its mesh harmonics",
    "RMS_residual": "root mean square of the residual signal",
    "FM4": "fourth moment of the difference signal over its squared variance",
    "M6A": "sixth moment of the difference signal over its cubed variance",
    "NA4": "fourth moment of the residual signal over the squared mean variance of both records",
}


def indicators(
    result: xr.Dataset,
    shaft: Gear = "pinion",
    *,
    variable: str = "x_p",
    derivative: int = 2,
    noise_floor: float = 0.0,
    seed: int = 1,
) -> xr.Dataset:
    """Return condition indicators of the time-synchronous average, of the pair and the twin with like teeth.

    An indicator is judged by comparison with the twin. Without noise the residual signal of the twin is zero,
    so that FM4, M6A and NA4 of the twin are 0/0 (NaN here). Therefore both signals get noise of the stated
    level.

    Parameters
    ----------
    result : dataset of ``lumped.steady_state``
    shaft, variable, derivative : as ``time_synchronous_average``
    noise_floor : root mean square of white noise in the average, in the unit of the average
    seed : of the noise

    Returns
    -------
    xarray.Dataset over ``indicator`` and ``record``, "pair" and "healthy twin": ``value``; root mean squares
    in the unit of the average, the others without unit

    Raises
    ------
    ParameterError : as ``order_spectrum``
    NumericalError : the twin has no periodic motion
    """
    one_of("shaft", shaft, ("pinion", "gear"))
    floor = real_number("noise_floor", noise_floor, 0.0, action="Give a root mean square.")
    draw = np.random.default_rng(whole_number("seed", seed, 0, 2**31))
    components = harmonics(result, variable, derivative)
    samples = max(2 * (components.values.size - 1) // components.cycles, 8)
    healthy = lumped.steady_state(
        components.pair.healthy,
        contact=result.attrs.get("contact", "unilateral"),
        supports=result.attrs.get("supports"),
        samples_per_cycle=samples,
    )
    twin = harmonics(healthy, variable, derivative)
    averages = [_average(components, shaft), _average(twin, shaft)]
    averages = [average + floor * draw.standard_normal(average.size) for average in averages]
    teeth = components.teeth(shaft)
    spread = [float(np.var(_filtered(average, teeth, 0))) for average in averages]
    table = [
        _numbers(average, teeth, 0.5 * (spread[1] + variance))
        for average, variance in zip(averages, spread, strict=True)
    ]
    return labelled_dataset(
        {"value": (("indicator", "record"), np.array(table).T, "1", "condition indicator")},
        {"indicator": (list(_INDICATORS), "1", "name"), "record": (["pair", "healthy twin"], "1", "record")},
        result.attrs | {"shaft": shaft, "teeth": teeth, "noise_floor": floor, "unit": components.unit},
    )


def _numbers(values: FloatArray, teeth: int, variance: float) -> list[float]:
    """Return the indicators in the order of ``_INDICATORS``.

    ``variance``: mean of the variances of the residual signals of both records.
    """
    centred = values - values.mean()
    rms = float(np.sqrt(np.mean(values**2)))
    amplitudes = 2.0 * np.abs(np.fft.rfft(values)) / values.size
    mesh_sum = float(amplitudes[teeth::teeth].sum())
    residual_signal, difference_signal = (_filtered(values, teeth, number) for number in (0, 1))
    rounding = _NOTHING * float(centred.std())

    def moment(signal: FloatArray, power: int, over: float) -> float:
        return float(np.mean(signal**power) / over) if np.sqrt(np.mean(signal**2)) > rounding else np.nan

    return [
        rms,
        moment(centred, 4, float(np.var(centred)) ** 2),
        float(np.abs(values).max()) / rms,
        float(np.ptp(values)) / mesh_sum,
        float(residual_signal.std()),
        moment(difference_signal, 4, float(np.var(difference_signal)) ** 2),
        moment(difference_signal, 6, float(np.var(difference_signal)) ** 3),
        moment(residual_signal, 4, variance**2),
    ]
