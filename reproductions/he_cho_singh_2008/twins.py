"""Periodic motion of the lumped model and of its multibody twin, side by side over one mesh cycle."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

import multibody
from lumped import GearPair, NumericalError, steady_state
from lumped.model.steady import UNSTABLE
from lumped.typing import FloatArray
from reproductions.he_cho_singh_2008.records import Number

MODELS = ("lumped", "multibody")
VARIABLES = ("dte", "x_p", "x_g", "y_p", "y_g", "normal_load", "friction_force", "contact")


#: A number that says how periodic the twin's motion is, and the unit of differences.
SETTLED = "multibody twin, change over one more cycle"
SPAN = "% of the peak to peak"


def twins(
    variants: Mapping[str, GearPair],
    *,
    samples: int = 256,
    with_multibody: bool = True,
) -> xr.Dataset:
    """Periodic motion of several variants in both models, each with the brake torque that balances it.

    A free run under the lumped model's torques would drift in speed: the two models lose different power, and
    after some cycles a phase that has slipped by a hundredth of a cycle looks like another motion. Where the
    multibody model has no periodic motion near the lumped one, its last cycle of a free run stands instead.

    Parameters
    ----------
    variants : name -> pair, all of the same geometry and speed
    samples : per mesh cycle
    with_multibody : without it only the lumped model is computed

    Returns
    -------
    Dataset over variant, model, pair (tooth pair, 0 is ahead) and phase (mesh cycles) with ``VARIABLES``;
    over variant: spectral_radius, largest multiplier of the lumped motion; and, for the multibody twin,
    unsettled: change of the DTE over one more mesh cycle over its peak to peak
    """
    models = MODELS if with_multibody else MODELS[:1]
    rows: list[xr.Dataset] = []
    unsettled: list[float] = []
    radii: list[float] = []
    for pair in variants.values():
        lumped = steady_state(pair, samples_per_cycle=samples)
        radii.append(float(lumped.attrs["spectral_radius"]))
        both = [_cycle(lumped, samples)]
        if with_multibody:
            run, change = _twin(pair, samples)
            both.append(_cycle(run, samples))
            unsettled.append(change)
        rows.append(xr.concat(both, dim=xr.DataArray(list(models), dims="model", name="model")))
    names = xr.DataArray(list(variants), dims="variant", name="variant")
    result = xr.concat(rows, dim=names)
    text = "largest Floquet multiplier of the lumped motion"
    result["spectral_radius"] = ("variant", radii, {"units": "1", "long_name": text})
    if with_multibody:
        text = "change of the multibody DTE over one more mesh cycle, over its peak to peak"
        result["unsettled"] = ("variant", unsettled, {"units": "1", "long_name": text})
    return result


def _twin(pair: GearPair, samples: int) -> tuple[xr.Dataset, float]:
    """One mesh cycle of the multibody model, and the change over one more, see ``twins``."""
    try:
        run = multibody.steady_state(pair, samples_per_cycle=samples)
        return run, float(run.attrs["closure"])
    except NumericalError:
        run = multibody.simulate(pair, samples_per_cycle=samples, initial="periodic")
        dte = run["dte"].to_numpy()
        last = dte[-samples - 1 : -1]
        before = dte[-2 * samples - 1 : -samples - 1]
        return run.isel(time=slice(-samples - 1, -1)), float(np.abs(last - before).max() / np.ptp(last))


def _cycle(data: xr.Dataset, samples: int) -> xr.Dataset:
    phase = xr.DataArray(
        np.arange(samples) / samples, dims="phase", attrs={"units": "1", "long_name": "mesh cycles"}
    )
    cycle = data[list(VARIABLES)].drop_vars("time").rename(time="phase").assign_coords(phase=phase)
    return cycle.drop_attrs(deep=False)


def agreement(result: xr.Dataset, names: Sequence[str]) -> dict[str, float]:
    """Root mean square difference of the twins over the lumped peak to peak, the worst of the variants.

    Parameters
    ----------
    result : of ``twins``, with both models
    names : variables; tooth forces are summed over the pairs
    """
    differences: dict[str, float] = {}
    for name in names:
        values = total(result[name])
        lumped_values, multibody_values = (values.sel(model=model) for model in ("lumped", "multibody"))
        axes = [axis for axis in lumped_values.dims if axis != "variant"]
        rms = np.sqrt(((multibody_values - lumped_values) ** 2).mean(axes))
        differences[name] = float((rms / (lumped_values.max(axes) - lumped_values.min(axes))).max())
    return differences


def quality(result: xr.Dataset) -> tuple[dict[str, Number], str]:
    """Return numbers that judge the motions, and a warning if a motion is unstable.

    Parameters
    ----------
    result : of ``twins``
    """
    radius = float(result["spectral_radius"].max())
    numbers = {"largest Floquet multiplier": Number(radius)}
    if "unsettled" in result:
        numbers[SETTLED] = Number(100.0 * float(result["unsettled"].max()), SPAN)
    warning = (
        f" Warning: a motion shown here is unstable (largest multiplier {radius:.3g}); a pair would leave it."
        if radius > UNSTABLE
        else ""
    )
    return numbers, warning


def total(values: xr.DataArray) -> xr.DataArray:
    """Sum over the tooth pairs, where there are any."""
    return values.sum("pair", keep_attrs=True) if "pair" in values.dims else values


def mesh_orders(values: xr.DataArray, highest: int = 10) -> xr.DataArray:
    """Amplitudes by mesh order of one cycle (..., phase) -> (..., order), orders 1 to ``highest``."""
    histories = values.transpose(..., "phase")
    amplitudes = 2.0 * np.abs(np.fft.rfft(histories.to_numpy())[..., 1 : highest + 1]) / values.sizes["phase"]
    dims = [*histories.dims[:-1], "order"]
    coords = {d: values[d] for d in dims if d in values.coords}
    order = xr.DataArray(np.arange(1, highest + 1), dims="order", attrs={"long_name": "mesh order"})
    return xr.DataArray(amplitudes, dims=dims, coords=coords | {"order": order}, attrs=values.attrs)


def continuous_labels(values: FloatArray, cycles: int) -> FloatArray:
    """One mesh cycle of tooth pairs by place (pairs, k) as histories of labelled pairs (pairs, cycles k).

    The pair that enters in cycle j keeps its label A, B, ... while it moves from the last place to the first;
    with P places the label comes round every P cycles.

    Parameters
    ----------
    values : by place, 0 is ahead, the last place enters at A
    cycles : mesh cycles to lay end to end
    """
    places, k = values.shape
    result = np.zeros((places, cycles * k))
    for j in range(cycles):
        for place in range(places):
            entered = j - (places - 1 - place)
            result[entered % places, j * k : (j + 1) * k] = values[place]
    return result


def roll_angle(pair: GearPair, cycles: FloatArray) -> FloatArray:
    """Pinion roll angle [deg] of the pair that was at A at zero, from mesh cycles."""
    g = pair.geometry
    return np.asarray(np.degrees((g.L_XA + cycles * g.base_pitch) / g.base_radius_pinion), dtype=np.float64)
