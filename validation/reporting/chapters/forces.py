"""Forces on teeth and bearings, load sharing, and Hertzian pressure."""

from __future__ import annotations

from functools import partial

import numpy as np
import xarray as xr

from lumped.labelling import Variable, labelled_dataset
from lumped.path_of_contact import contact_path
from validation.files.formatting import number, quantity
from validation.plots.axes import cycle_figure, two_panels_figure
from validation.prediction.motion import Prediction
from validation.reporting.blocks import Content, NamedNumber, Picture, Table, named_numbers
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results

#: Variable of the motion -> name of the bearing force in the table and in the figure.
_BEARINGS = {
    "bearing_force_x_p": "pinion, along the line of action",
    "bearing_force_y_p": "pinion, off it",
    "bearing_force_x_g": "gear, along the line of action",
    "bearing_force_y_g": "gear, off it",
}
#: Most mesh cycles that a figure shows.
_MOST_SHOWN = 8


def write(results: Results) -> Content:
    """Write the chapter."""
    prediction = results.prediction
    drawn = shown(prediction)
    bearings = _over_cycle(
        drawn, results, {name: (drawn[name].to_numpy(), "N", words) for name, words in _BEARINGS.items()}
    )
    result = (
        f"The largest mesh force is {number(prediction.dynamic_factor, 3)} times the mean "
        f"{quantity(prediction.mean_force, 'N', 3)}; one tooth pair carries at most "
        f"{number(prediction.tooth_load, 3)} times the mean force."
    )
    forces = tooth_forces(results)
    pairs = [name for name in map(str, forces.data_vars) if name.startswith("load_")]
    frictions = [name for name in map(str, forces.data_vars) if name.startswith("friction_")]
    return Content(
        result,
        (
            Picture(
                "tooth_forces",
                "Normal load and friction force of each tooth pair, and the mesh force, over time.",
                forces,
                partial(
                    two_panels_figure,
                    top=["mesh_force", *pairs],
                    bottom=frictions,
                    texts=("normal load", "friction force"),
                ),
            ),
            Picture(
                "bearing_forces",
                "Bearing forces about their means.",
                _about_mean(bearings),
                partial(cycle_figure, names=list(_BEARINGS), text="bearing force about its mean"),
            ),
            _forces_table(results),
        ),
    )


def _forces_table(results: Results) -> Table:
    prediction = results.prediction
    cycle = prediction.cycle
    largest_load = float(cycle["normal_load"].max())
    numbers = [
        NamedNumber("static mesh force", prediction.static_force, "N", "torque over base radius"),
        NamedNumber("mean mesh force", prediction.mean_force, "N", "static less what friction carries"),
        NamedNumber("largest mesh force", float(prediction.mesh_force.max()), "N"),
        NamedNumber(
            "smallest mesh force", max(float(prediction.mesh_force.min()), 0.0), "N", "0 is contact loss"
        ),
        NamedNumber("largest load of one tooth pair", largest_load, "N"),
        NamedNumber("largest Hertzian pressure", _largest_pressure(results), "Pa"),
    ]
    for name, words in _BEARINGS.items():
        rms = quantity(float(cycle[name].std()), "N", 3)
        mean = float(cycle[name].mean())
        numbers.append(NamedNumber(f"bearing force, {words}, mean", mean, "N", f"rms about it {rms}"))
    return named_numbers("forces", "Forces at the operating point.", numbers)


def _largest_pressure(results: Results) -> float:
    """Largest Hertzian pressure of a tooth pair [Pa]. The pressure grows with the root of the load."""
    prediction = results.prediction
    path = contact_path(results.pair)
    load = prediction.cycle["normal_load"].to_numpy()
    touching = load > 0.0
    position = np.clip(prediction.cycle["position"].to_numpy()[touching], path.L_XA, path.L_XD)
    share = load[touching] / prediction.static_force
    return float((path.hertz_pressure(position) * np.sqrt(share)).max())


def tooth_forces(results: Results) -> xr.Dataset:
    """Mesh force, and normal load and friction force of each tooth pair, over time in mesh cycles."""
    cycle = shown(results.prediction)
    total = cycle["normal_load"].sum("pair").to_numpy()
    forces: dict[str, tuple[np.ndarray, str, str]] = {"mesh_force": (total, "N", "all pairs")}
    for kind, name in (("load", "normal_load"), ("friction", "friction_force")):
        for i, row in enumerate(cycle[name].to_numpy()):
            if np.any(cycle["normal_load"].to_numpy()[i] > 0.0):
                forces[f"{kind}_{i}"] = (row, "N", f"pair {i}")
    return _over_cycle(cycle, results, forces)


def shown(prediction: Prediction) -> xr.Dataset:
    """Return the part of the motion that figures show: at most 8 mesh cycles about the largest mesh force."""
    cycle = prediction.cycle
    if prediction.mesh_cycles <= _MOST_SHOWN:
        return cycle
    samples = cycle.sizes["time"] // prediction.mesh_cycles
    last = prediction.mesh_cycles - _MOST_SHOWN
    first = min(max(int(prediction.mesh_force.argmax()) // samples - _MOST_SHOWN // 2, 0), last)
    return cycle.isel(time=slice(first * samples, (first + _MOST_SHOWN) * samples))


def _over_cycle(
    cycle: xr.Dataset, results: Results, values: dict[str, tuple[np.ndarray, str, str]]
) -> xr.Dataset:
    """Dataset over time in mesh cycles. ``values``: variable -> values, unit, words of the curve."""
    time = cycle["time"].to_numpy() / results.pair.geometry.mesh_period
    variables: dict[str, Variable] = {
        name: ("cycles", array, unit, words) for name, (array, unit, words) in values.items()
    }
    return labelled_dataset(variables, {"cycles": (time, "mesh cycles", "time")})


def _about_mean(data: xr.Dataset) -> xr.Dataset:
    """Every variable less the mean of that variable."""
    return data.map(lambda one: (one - one.mean()).assign_attrs(one.attrs))


CHAPTER = Chapter("forces", "Forces", write, seconds=0.3)
