"""The three figures of page 1: over speed, orders of the bearing force, and what the result depends on."""

from __future__ import annotations

from functools import partial

import numpy as np
import xarray as xr

from lumped.labelling import Variable, labelled_dataset
from lumped.outcomes import Absent
from validation.plots.axes import cycle_figure
from validation.plots.prediction import SMALL, orders_figure, over_speed_figure, swings_figure
from validation.reporting.blocks import Picture
from validation.reporting.chapters.contact_loss import linear_over_speed, motions
from validation.reporting.chapters.forces import tooth_forces
from validation.reporting.results import Results

#: Most inputs in the figure of swings.
_MOST = 6
#: Mesh orders in the figure of the bearing force.
_ORDERS = 8


def first_figures(results: Results) -> tuple[Picture, ...]:
    """Return the figures of page 1. Where contact is lost, the mesh force stands in place of the swings."""
    over = motions(results) if results.jump_search.branches else linear_over_speed(results)
    pictures = [
        Picture(
            "over_speed",
            f"Transmission error over speed{results.on_springs}",
            over,
            partial(over_speed_figure, operating_rpm=results.operating_rpm),
        ),
        Picture("bearing_orders", "Force on the pinion bearings", bearing_orders(results), orders_figure),
    ]
    if results.prediction.contact_lost:
        pictures.append(
            Picture(
                "mesh_force",
                "The teeth leave contact",
                tooth_forces(results)[["mesh_force"]],
                partial(cycle_figure, names=["mesh_force"], text="mesh force", size=SMALL),
            )
        )
    elif isinstance(results.uncertainty, xr.Dataset):
        pictures.append(
            Picture("swings", "What the result depends on", swings(results.uncertainty), swings_figure)
        )
    return tuple(pictures)


def bearing_orders(results: Results) -> xr.Dataset:
    """Return the orders of the pinion bearing force, with ranges where the inputs were varied."""
    amplitude = results.prediction.bearing_orders[:_ORDERS]
    order = np.arange(1, amplitude.size + 1)
    text = "force on the pinion bearings"
    variables: dict[str, Variable] = {"amplitude": ("order", amplitude, "N", text)}
    samples = results.uncertainty
    if results.teeth is None and not isinstance(samples, Absent):  # samples are of like teeth
        ends = np.array([samples[f"bearing_order_{m}_percentile"].to_numpy()[[0, -1]] for m in order])
        if np.isfinite(ends).all():  # else too few for a range
            variables["low"] = ("order", ends[:, 0], "N", f"{text}, 5 % of the samples")
            variables["high"] = ("order", ends[:, 1], "N", f"{text}, 95 % of the samples")
    return labelled_dataset(
        variables,
        {"order": (order, "1", "mesh order")},
        {"mesh_frequency": results.pair.geometry.mesh_frequency},
    )


def swings(samples: xr.Dataset) -> xr.Dataset:
    """Return the inputs with the largest swing of the transmission error, the largest first."""
    swing = samples["dte_peak_to_peak_swing"].to_numpy()
    order = np.argsort(-np.nan_to_num(np.ptp(swing, axis=1)), kind="stable")[:_MOST]
    order = order[np.isfinite(swing[order]).all(axis=1)]
    names = [str(samples["input"].to_numpy()[j]) for j in order]
    text = "transmission error, p-p"
    return labelled_dataset(
        {
            "low": ("input", swing[order].min(axis=1), "m", f"{text}, smallest"),
            "high": ("input", swing[order].max(axis=1), "m", f"{text}, largest"),
        },
        {"input": (names, "1", "uncertain input")},
        {
            "names": [plain_name(name) for name in names],
            "quantity": text,
            "given": float(samples.attrs["given_dte_peak_to_peak"]),
        },
    )


def plain_name(field: str) -> str:
    """Return a field in words: ``bearings.pinion.loa_stiffness`` as "pinion bearing, stiffness along ..."."""
    if field in _WHOLE:
        return _WHOLE[field]
    *place, what = field.split(".")
    if "bearings" in place:
        number = place[-1] if place[0] == "shafts" else ""
        owner = f"bearing {int(number) + 1} of the {place[1]} shaft" if number else f"{place[1]} bearing"
        kind = "damping" if "damping" in what else "stiffness"
        line = {"loa": "along", "oloa": "off"}.get(what.partition("_")[0])
        tilting = " against tilting" if "tilt" in what else ""
        return f"{owner}, {kind}{f' {line} the line of action' if line else tilting}"
    return field.replace(".", " ").replace("_", " ")


#: Field -> words, where the words differ from the path.
_WHOLE = {
    "mesh.stiffness": "tooth stiffness model",
    "mesh.stiffness_factor": "tooth stiffness",
    "lubricant.viscosity_law.temperature": "oil temperature",
    "operating.pinion_torque": "torque",
    "gears.roughness": "roughness of all flanks",
    "pinion.tip_alteration": "pinion, tip diameter",
    "gear.tip_alteration": "gear, tip diameter",
    "pinion.inertia": "pinion, mass and inertia",
    "gear.inertia": "gear, mass and inertia",
}
