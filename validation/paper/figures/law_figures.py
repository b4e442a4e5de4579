"""Figures 4 to 6: forces, displacements and transmission error under laws I to IV, lumped and multibody."""

from __future__ import annotations

import numpy as np
import xarray as xr

from lumped import GearPair
from validation.paper.operating_points import FIGURE_4, LAWS
from validation.paper.records import FigureRecord, Number
from validation.paper.twins import SPAN, agreement, mesh_orders, quality, total, twins


def law_runs(pair: GearPair, *, with_multibody: bool = True) -> xr.Dataset:
    """Periodic motion under laws I to IV in both models, see ``twins``; ``variant`` is the law's name.

    Parameters
    ----------
    pair : the gear pair, which the operating point of figure 4 is given to
    with_multibody : whether the multibody twin is computed too
    """
    at = FIGURE_4.of(pair)
    variants = {law: at.with_({"friction.law": law}) for law in LAWS}
    return twins(variants, with_multibody=with_multibody).rename(variant="law")


def figure4(runs: xr.Dataset) -> FigureRecord:
    """Figure 4 with its data and numbers; ``runs`` of ``law_runs``."""
    # Sums over the tooth pairs, (law, model, phase) [N].
    data = xr.Dataset({f"total_{name}": total(runs[name]) for name in ("normal_load", "friction_force")})
    numbers: dict[str, Number] = {}
    for law, title in LAWS.items():
        one = data.sel(law=law, model="lumped")
        load, friction = (one[name].to_numpy() for name in ("total_normal_load", "total_friction_force"))
        numbers[f"{title}: normal load, mean"] = Number(float(load.mean()), "N")
        numbers[f"{title}: normal load, peak to peak"] = Number(float(np.ptp(load)), "N")
        numbers[f"{title}: friction force, peak to peak"] = Number(float(np.ptp(friction)), "N")
    numbers |= _twin_numbers(runs, ("normal_load", "friction_force"))
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
    return numbers | _twin_numbers(runs, names)


def _twin_numbers(runs: xr.Dataset, names: tuple[str, ...]) -> dict[str, Number]:
    """Agreement of the models in each quantity; empty without the multibody twin."""
    if "multibody" not in runs["model"]:
        return {}
    found = agreement(runs.rename(law="variant"), names)
    return {
        f"multibody twin, {_words(name)}: rms difference, worst law": Number(100 * value, SPAN)
        for name, value in found.items()
    }


def _words(name: str) -> str:
    return name.replace("_", " ") if name in ("normal_load", "friction_force") else name


def figure5(runs: xr.Dataset) -> FigureRecord:
    """Figure 5 with its data and numbers; ``runs`` of ``law_runs``."""
    names = ("x_p", "y_p")
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


def figure6(runs: xr.Dataset) -> FigureRecord:
    """Figure 6 with its data and numbers; ``runs`` of ``law_runs``."""
    data = histories_and_orders(runs, ("dte",))
    return FigureRecord(
        number="6",
        title="Dynamic transmission error",
        text=(
            f"DTE over one mesh cycle and its amplitudes by mesh order at {FIGURE_4.torque:g} N m and "
            f"{FIGURE_4.speed:g} rpm, laws I to IV, lumped model and its multibody twin.{quality(runs)[1]}"
        ),
        numbers=motion_numbers(runs, data, ("dte",)),
        data={"transmission_error": data},
    )
