"""The figure of a result: one name for all results of the main functions."""

from __future__ import annotations

from collections.abc import Callable

import xarray as xr
from matplotlib.figure import Figure

from lumped.arguments import of_type
from lumped.errors import refuse
from lumped.fields.text_file import parse_toml
from lumped.fields.units import to_stated
from lumped.schema.files import load_gear_pair
from lumped.schema.pair import GearPair
from validation.plots.contact_loss import jump_map_figure, response_figure
from validation.plots.motion import history_figure, sweep_figure
from validation.plots.stability import boundaries_figure, campbell_figure, stability_figure


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
    "branch": response_figure,
    "dte": lambda result: history_figure(_pair(result).geometry, result),
    "dte_peak_to_peak": _sweep,
    "mesh_frequency": campbell_figure,
    "interval_lower": boundaries_figure,
    "verdict": _chart,
}


def plot(result: xr.Dataset) -> Figure:
    """Draw a result as its figure.

    Parameters
    ----------
    result : dataset of ``simulate`` or ``steady_state`` of either model, ``speed_sweep``, ``stability_chart``
        (one or two axes), ``stability_boundaries``, ``campbell``, ``jump_map`` or ``response_branches``

    Returns
    -------
    matplotlib.figure.Figure: a notebook shows it, ``.savefig("name.png")`` writes it

    Raises
    ------
    ParameterError : another dataset, or more axes than a figure has
    """
    of_type("result", result, xr.Dataset, "a dataset, as simulate returns it")
    for variable, draw in _FIGURES.items():
        if variable in result:
            return draw(result)
    known = "a result of simulate, steady_state, speed_sweep, stability_chart or campbell"
    raise refuse("result", ", ".join(map(str, result.data_vars)), known, "Draw it with xarray's own .plot().")
