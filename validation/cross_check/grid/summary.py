"""What a regression grid says: verdict, worst points, and what broke a rule."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr

from validation.cross_check.grid.run import AXES, COMPARED, SCALING_TOLERANCE, SEPARATED, STICKING
from validation.cross_check.judgement import Verdict
from validation.cross_check.tolerances import LOST
from validation.validity.flags import LOAD_NOISE


@dataclass(frozen=True)
class GridSummary:
    """Verdict on a grid.

    Attributes
    ----------
    verdict : "not confirmed": a quantity disagrees at fidelity "linear", the law of torque is broken where it
        must hold, the exact transmission error differs by more than ``tolerances.LOST``, or what is left of
        an exact quantity exceeds its tolerance; else "confirmed"
    points : how many there are
    compared : of them judged by every rule
    parted : compared points with loss of contact
    separated, sticking, failed : how many are not compared, because no stable motion of teeth that part is
        found, because friction may hold the teeth (only fidelity "linear" is judged there), or because a
        model failed
    linear, exact : largest share of a tolerance that is used, over the compared points
    outside : compared points with an exact quantity outside its tolerance
    whole, left : largest relative L2 of the exact transmission error over the compared points, whole and
        after what is predicted is taken off
    scaling : largest departure from the law of torque where it is judged; NaN where it is nowhere
    scaled : points where it is judged
    worst : coordinates of the largest exact DTE difference over peak to peak, of all points where both models
        ran, judged or not
    largest, largest_judged : that difference, and the largest among the judged points
    """

    verdict: Verdict
    points: int
    compared: int
    parted: int
    separated: int
    sticking: int
    failed: int
    linear: float
    exact: float
    outside: int
    whole: float
    left: float
    scaling: float
    scaled: int
    worst: Mapping[str, str | float]
    largest: float
    largest_judged: float


def summarise_grid(result: xr.Dataset) -> GridSummary:
    """Apply the rules to the dataset of ``crosscheck_grid``."""
    status = result["status"]
    compared = status == COMPARED
    ran = compared | (status == STICKING)  # the equations must agree there all the same
    usage = result["difference"] / result["limit"]
    linear = float(usage.sel(fidelity="linear").where(ran).max())
    exact = usage.sel(fidelity="exact").max("quantity").where(compared)
    departure = abs(law_of_torque(result) - 1.0)
    dte = result["largest"].sel(fidelity="exact", quantity="dte").where(ran)
    whole, left = (
        result[name].sel(fidelity="exact", quantity="dte").where(compared) for name in ("total", "difference")
    )
    lost = whole > LOST
    broken = bool((departure > SCALING_TOLERANCE).any()) or bool(lost.any()) or not linear <= 1.0
    outside = int((exact > 1.0).sum())
    worst: dict[str, str | float] = {}
    if bool(ran.any()):
        worst = {axis: place.item() for axis, place in _place(dte).items()}
    return GridSummary(
        verdict="not confirmed" if broken or outside else "confirmed",
        points=int(status.size),
        compared=int(compared.sum()),
        parted=int((compared & _parts(result)).sum()),
        separated=int((status == SEPARATED).sum()),
        sticking=int((status == STICKING).sum()),
        failed=int((~ran & (status != SEPARATED)).sum()),
        linear=linear,
        exact=float(exact.max()),
        outside=outside,
        whole=float(whole.max()),
        left=float(left.max()),
        scaling=float(departure.max()),
        scaled=int(departure.notnull().sum()),
        worst=worst,
        largest=float(dte.max()),
        largest_judged=float(dte.where(compared).max()),
    )


def law_of_torque(result: xr.Dataset) -> xr.DataArray:
    """Fall with torque over the expected one, where judged.

    Judged are pairs of compared torques with constant coefficient and smooth stiffness, at which teeth push
    all the time: gaps may come with the torque. To first order the
    fall is that of the torque; what sliding reversal changes near P does not obey that law, but is expected.
    """
    compared = (result["status"] == COMPARED) & ~_parts(result)
    following = compared.shift(torque=-1, fill_value=False)
    ratio = result["ratio"] / result["ratio_expected"]
    return ratio.where((result["ratio_judged"] != 0) & compared & following)


def _parts(result: xr.Dataset) -> xr.DataArray:
    return result["load_min"] < -LOAD_NOISE


@dataclass(frozen=True)
class Outside:
    """A compared point with a quantity outside its tolerance.

    Attributes
    ----------
    point : its coordinates
    quantity : the one that uses most of its tolerance
    left, limit : what is left of the difference, and its tolerance
    whole : the difference before the predicted part is taken off
    """

    point: Mapping[str, str | float]
    quantity: str
    left: float
    limit: float
    whole: float


def outside_tolerance(result: xr.Dataset) -> tuple[Outside, ...]:
    """Compared points with an exact quantity outside its tolerance, the farthest first."""
    exact = result.sel(fidelity="exact")
    usage = (exact["difference"] / exact["limit"]).where(exact["status"] == COMPARED)
    found = []
    for index in np.ndindex(exact["status"].shape):
        used = usage[index].fillna(0.0)
        if not float(used.max()) > 1.0:
            continue
        quantity = str(used["quantity"][int(used.to_numpy().argmax())].item())
        left, limit, whole = (
            float(exact[name][index].sel(quantity=quantity)) for name in ("difference", "limit", "total")
        )
        point = {axis: exact[axis][place].item() for axis, place in zip(AXES, index, strict=True)}
        found.append(Outside(point, quantity, left, limit, whole))
    return tuple(sorted(found, key=lambda o: -o.left / o.limit))


def failures(result: xr.Dataset) -> list[tuple[dict[str, str | float], str]]:
    """Coordinates and reason of every point where a model failed."""
    found = []
    for index in np.ndindex(result["status"].shape):
        point = result["status"][index]
        reason = str(point.item())
        if reason not in (COMPARED, SEPARATED, STICKING):
            found.append(({axis: point[axis].item() for axis in AXES}, reason))
    return found


def _place(values: xr.DataArray) -> dict[str, xr.DataArray]:
    at = np.unravel_index(int(np.nanargmax(values.to_numpy())), values.shape)
    return {str(axis): values[axis][i] for axis, i in zip(values.dims, at, strict=True)}
