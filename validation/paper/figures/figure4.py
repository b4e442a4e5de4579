"""Figure 4: total normal load and total friction force under laws I to IV."""

from __future__ import annotations

import numpy as np
import xarray as xr

from validation.paper.figure_record import FigureRecord, Number
from validation.paper.operating_points import FIGURE_4, LAWS
from validation.paper.twins import agreement, quality, total


def total_forces(runs: xr.Dataset) -> xr.Dataset:
    """Sums over the tooth pairs of normal load and friction force, (law, model, phase) [N]."""
    return xr.Dataset({f"total_{name}": total(runs[name]) for name in ("normal_load", "friction_force")})


def figure4(runs: xr.Dataset) -> FigureRecord:
    """Figure 4 with its data and numbers; ``runs`` of ``law_runs``."""
    data = total_forces(runs)
    numbers: dict[str, Number] = {}
    for law, title in LAWS.items():
        one = data.sel(law=law, model="lumped")
        load, friction = (one[name].to_numpy() for name in ("total_normal_load", "total_friction_force"))
        numbers[f"{title}: normal load, mean"] = Number(float(load.mean()), "N")
        numbers[f"{title}: normal load, peak to peak"] = Number(float(np.ptp(load)), "N")
        numbers[f"{title}: friction force, peak to peak"] = Number(float(np.ptp(friction)), "N")
    if "multibody" in runs["model"]:
        for name, value in agreement(runs.rename(law="variant"), ("normal_load", "friction_force")).items():
            text = name.replace("_", " ")
            numbers[f"multibody twin, {text}: rms difference, worst law"] = Number(
                100 * value, "% of the peak to peak"
            )
    trust, warning = quality(runs)
    return FigureRecord(
        number="4",
        title="Total normal load and friction force under laws I to IV",
        text=(
            f"Sum over the tooth pairs in contact over one mesh cycle at {FIGURE_4.torque:g} N m and "
            f"{FIGURE_4.speed:g} rpm, lumped model and its multibody twin.{warning}"
        ),
        numbers=numbers | trust,
        data={"total_forces": data},
    )
