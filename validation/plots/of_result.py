"""The figure of a result: one name for all results of the main functions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lumped.arguments import of_type
from lumped.errors import refuse
from lumped.fields.text_file import parse_toml
from lumped.fields.units import to_stated
from lumped.model.averaged import natural_frequencies
from lumped.schema.files import load_gear_pair
from lumped.schema.pair import GearPair
from validation.plots.contact_loss import jump_map_figure, response_figure
from validation.plots.maps import waterfall_figure
from validation.plots.motion import history_figure, overlay_figure, sweep_figure
from validation.plots.stability import boundaries_figure, campbell_figure, stability_figure
from validation.plots.style import legend_above, look, mesh_cycles, new_figure, scale_y
from validation.signals.orders import waterfall


def _pair(result: xr.Dataset) -> GearPair:
    """Gear pair that a run was made with."""
    return load_gear_pair(parse_toml(result.attrs["parameters"], "parameters of the result"))


def _sweep(result: xr.Dataset) -> Figure:
    pair = _pair(result)
    load = pair.operating.pinion_torque / pair.geometry.base_radius_pinion
    return sweep_figure(result, to_stated(pair.operating.pinion_speed, "rpm"), load)


def _chart(result: xr.Dataset) -> Figure:
    axes = list(map(str, result["spectral_radius"].dims))
    if len(axes) > 2:
        raise refuse("result", f"axes {', '.join(axes)}", "one or two axes", "Select with result.sel(...).")
    return stability_figure(result)


#: Variable that only one kind of result has -> its figure.
_FIGURES: dict[str, Callable[[xr.Dataset], Figure]] = {
    "contact_kept": jump_map_figure,
    "running_speed": lambda result: waterfall_figure(waterfall(result), natural_frequencies(_pair(result))),
    "branch": response_figure,
    "measured": overlay_figure,
    "dte": lambda result: history_figure(_pair(result).geometry, result),
    "dte_peak_to_peak": _sweep,
    "mesh_frequency": campbell_figure,
    "interval_lower": boundaries_figure,
    "verdict": _chart,
}


#: Variable -> its coordinate, words and units: what one curve of a result shows, the first that it has.
_CURVES = {
    "dte": ("time", "transmission error", "m"),
    "dte_peak_to_peak": ("speed", "transmission error,\npeak to peak", "m"),
    "spectral_radius": ("speed_rpm", "spectral radius", "1"),
}
_ABSCISSA = {"time": "time [mesh cycles]", "speed": "pinion speed [rpm]", "speed_rpm": "pinion speed [rpm]"}


def plot(
    result: xr.Dataset | Sequence[xr.Dataset], *, ax: Axes | None = None, labels: Sequence[str] = ()
) -> Figure:
    """Draw a result as its figure, or the main curve of several results in one axes.

    Parameters
    ----------
    result : dataset of ``simulate`` or ``steady_state`` of either model, ``run_up``, ``speed_sweep``,
        ``stability_chart`` (one or two axes), ``stability_boundaries``, ``campbell``, ``jump_map`` or
        ``response_branches``, or the ``points`` of an evaluated record. A list of datasets of one kind, of
        ``simulate``, ``steady_state``, ``speed_sweep`` or a chart over speed: their transmission errors or
        spectral radii
    ax : axes of yours to draw this curve into
    labels : of the results, for the legend; default the names of their pairs

    Returns
    -------
    matplotlib.figure.Figure: a notebook shows it, ``.savefig("name.png")`` writes it

    Raises
    ------
    ParameterError : another dataset, more axes than a figure has, or results that cannot share one axes
    """
    results: list[Any] = list(result) if isinstance(result, (list, tuple)) else [result]
    for one in results:
        of_type("result", one, xr.Dataset, "a dataset, as simulate returns it, or a list of them")
    if not isinstance(result, xr.Dataset) or ax is not None:
        return _curves(results, ax, labels)
    for variable, draw in _FIGURES.items():
        if variable in result:
            return draw(result)
    known = "a result of simulate, steady_state, speed_sweep, stability_chart or campbell"
    raise refuse("result", ", ".join(map(str, result.data_vars)), known, "Draw it with xarray's own .plot().")


def _curves(results: Sequence[xr.Dataset], ax: Axes | None, labels: Sequence[str]) -> Figure:
    """Draw the main curve of each result into one axes."""
    shown = [
        next((v for v, (x, *_) in _CURVES.items() if v in one and one[v].dims == (x,)), None)
        for one in results
    ]
    name = shown[0] if shown else None
    if name is None or len(set(shown)) > 1:
        kinds = "results over time, or over speed, all of one kind"
        raise refuse("result", ", ".join(map(str, shown)), kinds, "Draw each with plot(result).")
    if labels and len(labels) != len(results):
        raise refuse("labels", list(labels), f"{len(results)} texts, one a result", "Give one for each.")
    if ax is None:
        _, made = new_figure(1, 1, height=2.6)
        ax = made[0, 0]
    across, words, unit = _CURVES[name]
    factor = scale_y(ax, words, unit, *(one[name].to_numpy() for one in results))
    for number, one in enumerate(results):
        x = mesh_cycles(one, _pair(one).geometry) if across == "time" else one[across].to_numpy()
        label = labels[number] if labels else str(one.attrs.get("gear_pair", f"result {number + 1}"))
        ax.plot(x, one[name].to_numpy() / factor, **look(number), linewidth=1.0, label=label)
    ax.set_xlabel(_ABSCISSA[across])
    if len(results) > 1 or labels:
        legend_above(ax, min(len(results), 3))
    figure = ax.get_figure()
    assert isinstance(figure, Figure)  # of axes in a subfigure too
    return figure
