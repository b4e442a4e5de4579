"""Figures 4 to 6: forces, displacements and transmission error under laws I to IV, lumped and multibody."""

from __future__ import annotations

import numpy as np
import xarray as xr

from lumped.schema.files import AnyPair
from reproductions.he_cho_singh_2008.operating_points import FIGURE_4, LAWS, papers_pair
from reproductions.he_cho_singh_2008.records import FigureRecord, Number
from reproductions.he_cho_singh_2008.twins import SPAN, agreement, mesh_orders, quality, total, twins


def law_runs(pair: AnyPair, *, with_multibody: bool = True) -> xr.Dataset:
    """Periodic motion under laws I to IV in both models, see ``twins``; ``variant`` is the law's name.

    Parameters
    ----------
    pair : the gear pair, which the operating point of figure 4 is given to
    with_multibody : whether the multibody twin is computed too
    """
    pair = papers_pair(pair)
    pair_at_point = FIGURE_4.of(pair)
    variants = {law: pair_at_point.with_({"friction.law": law}) for law in LAWS}
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


#: Figures of motions: number -> title, what is shown, name of its data, variables.
_MOTIONS = {
    "5": (
        "Displacements along and off the line of action",
        "Pinion displacements over one mesh cycle and their",
        "motions",
        ("x_p", "y_p"),
    ),
    "6": (
        "Dynamic transmission error",
        "DTE over one mesh cycle and its",
        "transmission_error",
        ("dte",),
    ),
}


def figure_of_motions(number: str, runs: xr.Dataset) -> FigureRecord:
    """Figure 5 or 6 with its data and numbers; ``runs`` of ``law_runs``.

    Its data are the variables (law, model, phase) [m] and ``<name>_amplitude`` (law, model, order) [m]; its
    numbers the peak to peak of each law, the spread of the laws by mesh order, the agreement of the twins.
    """
    title, what, part, names = _MOTIONS[number]
    data = xr.Dataset(
        {name: runs[name] for name in names}
        | {f"{name}_amplitude": mesh_orders(runs[name]) for name in names}
    )
    lumped = data.sel(model="lumped")
    numbers: dict[str, Number] = {}
    for name in names:
        for law, law_title in LAWS.items():
            span = float(np.ptp(lumped[name].sel(law=law).to_numpy()))
            numbers[f"{law_title}: {name}, peak to peak"] = Number(1e6 * span, "µm")
        amplitude = lumped[f"{name}_amplitude"]
        spread = amplitude.max("law") - amplitude.min("law")
        for order in (1, 2, 3):
            numbers[f"spread of the laws in {name} at mesh order {order}"] = Number(
                1e9 * float(spread.sel(order=order)), "nm"
            )
    return FigureRecord(
        number=number,
        title=title,
        text=(
            f"{what} amplitudes by mesh order at {FIGURE_4.torque:g} N m and {FIGURE_4.speed:g} rpm, laws I "
            f"to IV, lumped model and its multibody twin.{quality(runs)[1]}"
        ),
        numbers=numbers | _twin_numbers(runs, names),
        data={part: data},
    )


def _twin_numbers(runs: xr.Dataset, names: tuple[str, ...]) -> dict[str, Number]:
    """Agreement of the models in each quantity; empty without the multibody twin."""
    if "multibody" not in runs["model"]:
        return {}
    differences = agreement(runs.rename(law="variant"), names)
    words = {"normal_load": "normal load", "friction_force": "friction force"}
    return {
        f"multibody twin, {words.get(name, name)}: rms difference, worst law": Number(100 * value, SPAN)
        for name, value in differences.items()
    }
