"""Figure 5: motions along and off the line of action, in time and by mesh order."""

from __future__ import annotations

import numpy as np
import xarray as xr

from validation.paper.figure_record import FigureRecord, Number
from validation.paper.operating_points import FIGURE_4, LAWS
from validation.paper.twins import agreement, mesh_orders, quality

MOTIONS = {"x_p": "LOA displacement of the pinion", "y_p": "OLOA displacement of the pinion"}


def histories_and_orders(runs: xr.Dataset, names: tuple[str, ...]) -> xr.Dataset:
    """Variables (law, model, phase) [m] and ``<name>_amplitude`` (law, model, order) [m]."""
    found: dict[str, xr.DataArray] = {name: runs[name] for name in names}
    found |= {f"{name}_amplitude": mesh_orders(runs[name]) for name in names}
    return xr.Dataset(found)


def motion_numbers(runs: xr.Dataset, data: xr.Dataset, names: tuple[str, ...]) -> dict[str, Number]:
    """Peak to peak of each law, spread of the laws by mesh order, agreement of the twins."""
    numbers: dict[str, Number] = {}
    for name in names:
        lumped = data.sel(model="lumped")
        for law, title in LAWS.items():
            span = float(np.ptp(lumped[name].sel(law=law).to_numpy()))
            numbers[f"{title}: {name}, peak to peak"] = Number(1e6 * span, "µm")
        amplitude = lumped[f"{name}_amplitude"]
        spread = amplitude.max("law") - amplitude.min("law")
        for order in (1, 2, 3):
            numbers[f"spread of the laws in {name} at mesh order {order}"] = Number(
                1e9 * float(spread.sel(order=order)), "nm"
            )
    if "multibody" in runs["model"]:
        for name, value in agreement(runs.rename(law="variant"), names).items():
            numbers[f"multibody twin, {name}: rms difference, worst law"] = Number(
                100 * value, "% of the peak to peak"
            )
    return numbers


def figure5(runs: xr.Dataset) -> FigureRecord:
    """Figure 5 with its data and numbers; ``runs`` of ``law_runs``."""
    names = tuple(MOTIONS)
    data = histories_and_orders(runs, names)
    return FigureRecord(
        number="5",
        title="Displacements along and off the line of action",
        text=(
            "Pinion displacements over one mesh cycle and their amplitudes by mesh order at "
            f"{FIGURE_4.torque:g} N m and {FIGURE_4.speed:g} rpm, laws I to IV, lumped model and its "
            f"multibody twin.{quality(runs)[1]}"
        ),
        numbers=motion_numbers(runs, data, names),
        data={"motions": data},
    )
