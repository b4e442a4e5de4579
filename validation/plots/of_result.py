"""The figure of a result: one function for the results of all main functions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from floquet.gear.response import ResponseBranches
from floquet.gear.tongues import StabilityMargins
from lumped.display.result import DisplayedResult
from lumped.errors import refuse
from lumped.fields.text_file import parse_toml
from lumped.fields.units import to_stated
from lumped.model.averaged import natural_frequencies
from lumped.schema.files import load_gear_pair
from lumped.schema.pair import GearPair
from validation.cross_check.comparison import CrossCheck
from validation.plots.axes import cycle_figure, label_axis
from validation.plots.compare import compare_figure
from validation.plots.contact_loss import jump_map_figure, response_figure
from validation.plots.maps import waterfall_figure
from validation.plots.motion import history_figure, overlay_figure, sweep_figure
from validation.plots.stability import boundaries_figure, campbell_figure, stability_figure
from validation.plots.style import BLUE, legend_above, look, mesh_cycles, one_panel, scale_y
from validation.prediction.motion import Prediction
from validation.signals.orders import waterfall


def _pair(result: xr.Dataset) -> GearPair:
    """Gear pair of a run."""
    return load_gear_pair(parse_toml(result.attrs["parameters"], "parameters of the result"))


def _sweep(result: xr.Dataset) -> Figure:
    if "normal_load_max" not in result:  # of the multibody model, which says how far the teeth are apart
        return _curves([result], None, [])
    pair = _pair(result)
    load = pair.operating.pinion_torque / pair.geometry.base_radius_pinion
    return sweep_figure(result, to_stated(pair.operating.pinion_speed, "rpm"), load)


def _chart(result: xr.Dataset) -> Figure:
    axes = list(map(str, result["spectral_radius"].dims))
    if len(axes) > 2:
        raise refuse("result", f"axes {', '.join(axes)}", "one or two axes", "Select with result.sel(...).")
    return stability_figure(result)


def _static(result: xr.Dataset) -> Figure:
    if "torque" not in result.dims:  # of static_sharing, at the operating torque
        return _curves([result], None, [])
    torques = result["torque"].to_numpy()
    return _curves([result.sel(torque=one) for one in torques], None, [f"{one:g} N m" for one in torques])


def _boundaries(result: xr.Dataset) -> Figure:
    if result["interval_lower"].ndim < 3:
        action = "Compute them over an axis: stability_boundaries(pair, axes={...})."
        raise refuse("result", "boundaries at one value", "boundaries over a second axis", action)
    return boundaries_figure(result)


def _waterfall(result: xr.Dataset) -> Figure:
    supports = result.attrs.get("supports")
    return waterfall_figure(result, natural_frequencies(_pair(result), supports=supports).values.tolist())


def _spectrum(result: xr.Dataset) -> Figure:
    if "speed_rpm" in result.dims:
        return _waterfall(result)
    within = result["frequency"] < (_MESH_ORDERS + 0.5) * _pair(result).geometry.mesh_frequency
    shown = result.sel(order=within & (result["order"] > 0.0))  # the mean would dwarf the rest
    figure, ax = one_panel(2.7)
    across = label_axis(ax, "x", shown["order"])
    up = label_axis(ax, "y", shown["amplitude"], text="amplitude")
    ax.vlines(shown["order"] / across, 0.0, shown["amplitude"] / up, color=BLUE)
    ax.set(xlim=(0.0, None), ylim=(0.0, None))
    return figure


#: Mesh orders in the figure of a spectrum.
_MESH_ORDERS = 10
#: Variable -> figure of a result with this variable. The first variable that a result has decides.
_FIGURES: dict[str, Callable[[xr.Dataset], Figure]] = {
    "holds": compare_figure,
    "contact_kept": jump_map_figure,
    "running_speed": lambda result: _waterfall(waterfall(result)),
    "branch": response_figure,
    "theirs": overlay_figure,
    "dte": lambda result: history_figure(_pair(result).geometry, result),
    "dte_peak_to_peak": _sweep,
    "mesh_frequency": lambda result: campbell_figure(
        result, to_stated(_pair(result).operating.pinion_speed, "rpm")
    ),
    "interval_lower": _boundaries,
    "verdict": _chart,
    "amplitude": _spectrum,
    "transmission_error": _static,
    "mesh_stiffness": lambda result: cycle_figure(result, ["mesh_stiffness"]),
}


#: Variable -> coordinate, words and unit of the main curve. The first variable that a result has decides.
_CURVES = {
    "dte": ("time", "transmission error", "m"),
    "dte_peak_to_peak": ("speed", "transmission error,\npeak to peak", "m"),
    "transmission_error": ("phase", "static transmission error", "m"),
    "mesh_stiffness": ("phase", "mesh stiffness", "N/m"),
    "spectral_radius": ("speed_rpm", "spectral radius", "1"),
}
_SPEED = "pinion speed [rpm]"
_ABSCISSA = {"time": "time [mesh cycles]", "phase": "mesh phase [-]", "speed": _SPEED, "speed_rpm": _SPEED}


def plot(result: Any, *, ax: Axes | None = None, labels: Sequence[str] = ()) -> Figure:
    """Draw a result as its figure, or the main curve of several results in one axes.

    Parameters
    ----------
    result : of ``predict``, ``crosscheck``, ``check``, ``reference`` or ``response_branches``; dataset of
        ``simulate`` or ``steady_state`` of either model, ``run_up``, ``waterfall``, ``order_spectrum``,
        ``speed_sweep``, ``mesh_stiffness``, ``static_transmission_error``, ``static_sharing``,
        ``stability_chart`` (one or two axes), ``stability_boundaries`` over an axis, ``campbell`` or
        ``jump_map``, or an ``overlay`` of a check. A list of results of one kind over time, phase or speed:
        their transmission errors, mesh stiffnesses or spectral radii
    ax : axes of yours to draw this curve into
    labels : of the results, for the legend; default the names of their pairs

    Returns
    -------
    matplotlib.figure.Figure: a notebook shows it, ``.savefig("name.png")`` writes it

    Raises
    ------
    ParameterError : another dataset, more axes than a figure has, or results that cannot share one axes
    """
    several = isinstance(result, (list, tuple))
    if isinstance(result, DisplayedResult) and type(result).plot is not DisplayedResult.plot and ax is None:
        return result.plot()  # of a package above this one
    if isinstance(result, CrossCheck) and ax is None:
        return _curves([result.lumped, *result.multibody.values()], None, ["lumped", *result.multibody])
    results = [_dataset(one) for one in (result if several else [result])]
    for one in results:
        if not isinstance(one, xr.Dataset):
            allowed = "a dataset, as simulate returns it, or a list of them"
            action = "Call it: plot(mesh_stiffness(pair))." if callable(one) else "Draw plot(predict(pair))."
            raise refuse("result", one, allowed, action)
    if several or ax is not None:
        return _curves(results, ax, labels)
    for variable, draw in _FIGURES.items():
        if variable in results[0] and _is_main(results[0], variable):
            return draw(results[0])
    allowed = "a result of simulate, steady_state, speed_sweep, stability_chart or campbell"
    raise refuse("result", ", ".join(map(str, one.data_vars)), allowed, "Draw it with xarray's own .plot().")


def _dataset(result: Any) -> Any:
    """Return the dataset that a result has for a figure; anything else as it is."""
    if isinstance(result, Prediction):
        return result.cycle
    return result.dataset if isinstance(result, (ResponseBranches, StabilityMargins)) else result


def _is_main(result: xr.Dataset, variable: str) -> bool:
    """Whether a variable has the coordinate of its figure. Samples of a number, for example, are no sweep."""
    if variable not in _CURVES:
        return True
    return set(result[variable].dims) <= {_CURVES[variable][0], "torque"}


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
        _, ax = one_panel(2.6)
    across, words, unit = _CURVES[name]
    factor = scale_y(ax, words, unit, *(one[name].to_numpy() for one in results))
    for number, one in enumerate(results):
        x = mesh_cycles(one, _pair(one).geometry) if across == "time" else one[across].to_numpy()
        label = (
            labels[number] if labels else str(one.attrs.get("gear_pair", one.attrs.get("pair", number + 1)))
        )
        ax.plot(x, one[name].to_numpy() / factor, **look(number), linewidth=1.0, label=label)
    ax.set_xlabel(_ABSCISSA[across])
    if len(results) > 1 or labels:
        legend_above(ax, min(len(results), 3))
    figure = ax.get_figure()
    assert isinstance(figure, Figure)  # of axes in a subfigure too
    return figure
