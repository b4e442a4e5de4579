"""Tongues of a gear pair: the mesh damping that closes each, and names for unstable regions of a chart.

Sources: docs/theory/floquet.md, "Where instability is, and what it is called".
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from scipy import ndimage

from floquet.engine.chart import Progress
from floquet.engine.tongues import Tongue, tongue_tip
from floquet.gear.axes import vary
from floquet.gear.boundaries import label_variation, stability_boundaries
from floquet.gear.chart import stability_chart
from lumped.arguments import real_numbers, whole_number
from lumped.errors import refuse, shown
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray

if TYPE_CHECKING:
    import xarray as xr

# From a tenth of what tongues of steel gears need to what no gear mesh reaches.
_DAMPING = (0.0, 3e-4, 6e-4, 1.2e-3, 2.5e-3, 5e-3, 1e-2, 2e-2, 4e-2, 8e-2, 0.16, 0.32)


def critical_damping(
    pair: GearPair,
    speed_rpm: tuple[float, float] = (500.0, 20000.0),
    *,
    friction_law: str | None = None,
    damping_ratios: npt.ArrayLike = _DAMPING,
    orders: int = 12,
    rtol: float = 1e-9,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Mesh damping ratio that closes each tongue of instability.

    The tongues are traced at a ladder of damping ratios (`stability_boundaries`); between the last ratio at
    which a tongue is met and the next, the root of max over speed of (spectral radius - 1) is where it
    closes. Bearing damping stays as the pair has it.

    Parameters
    ----------
    pair : the gear pair; its mesh damping ratio is ignored
    speed_rpm : range searched [rpm]
    friction_law : law to use instead of the pair's
    damping_ratios : increasing ladder of mesh damping ratios
    orders : largest order of the seeds of the search
    rtol : of the monodromy matrices
    progress : called with (steps done, steps in all)

    Returns
    -------
    Dataset over ``tongue`` (coordinates label, mode_i, mode_j, sign, order), by falling critical damping:
    ``critical_damping``; ``speed`` [rpm] at which the tongue closes; ``lower`` and ``upper`` [rpm] at the
    smallest damping of the ladder at which it is present, and ``peak_radius`` there. A tongue that is still
    open at the last ratio, or whose tip the range of speeds cuts off, has critical damping inf and ``closed``
    False.

    Raises
    ------
    ParameterError
        Unusable range, or a ladder that is not increasing.
    """
    import xarray as xr

    ladder = real_numbers("damping_ratios", damping_ratios, 0.0, increasing=True)
    if ladder.size < 2:
        raise refuse("damping_ratios", shown(damping_ratios), "two or more ratios", "Add a ratio.")
    if friction_law is not None:
        pair = pair.with_({"friction.law": friction_law})
    total = 2 * ladder.size
    found = stability_boundaries(
        pair,
        speed_rpm,
        {"damping_ratio": ladder},
        orders=orders,
        rtol=rtol,
        progress=None if progress is None else lambda done, _: progress(done, total),
    )

    def radius(speeds: FloatArray, damping: float) -> FloatArray:
        # Samples may fall together at the end of a search; the chart wants them different.
        unique, inverse = np.unique(speeds, return_inverse=True)
        chart = stability_chart(pair, {"speed_rpm": unique, "damping_ratio": [damping]}, rtol=rtol)
        return np.asarray(chart.spectral_radius.values[:, 0][inverse])

    count = found.sizes["tongue"]
    critical, place = np.full(count, np.inf), np.full(count, np.nan)
    first = np.empty((count, 3))
    for row in range(count):
        present = np.flatnonzero(found.present.values[row])
        here = int(present[-1])
        first[row] = [found[n].values[row, present[0]] for n in ("lower", "upper", "peak_radius")]
        place[row] = found.peak.values[row, here]
        if here + 1 < ladder.size and not found.open_end.values[row, here]:
            window = _window(found, row, here, speed_rpm)
            tip = tongue_tip(radius, window, (float(ladder[here]), float(ladder[here + 1])))
            critical[row], place[row] = tip.damping, tip.place
        if progress is not None:
            progress(ladder.size + round(ladder.size * (row + 1) / count), total)
    order = np.lexsort((place, -critical))
    result = xr.Dataset(
        {
            "critical_damping": (
                "tongue", critical, {"units": "1", "long_name": "mesh damping ratio that closes the tongue"}
            ),
            "speed": ("tongue", place, {"units": "rpm", "long_name": "pinion speed where the tongue closes"}),
            "lower": ("tongue", first[:, 0], {"units": "rpm", "long_name": "lower end at the least damping"}),
            "upper": ("tongue", first[:, 1], {"units": "rpm", "long_name": "upper end at the least damping"}),
            "peak_radius": (
                "tongue", first[:, 2], {"units": "1", "long_name": "spectral radius at the least damping"}
            ),
            "closed": (
                "tongue", np.isfinite(critical), {"units": "1", "long_name": "whether the tip was found"}
            ),
        },
        coords={n: found.coords[n] for n in ("label", "mode_i", "mode_j", "sign", "order")},
        attrs={"title": f"critical mesh damping of {pair.name}", "friction_law": pair.friction.law},
    )  # fmt: skip
    return result.isel(tongue=order)


def _window(found: xr.Dataset, row: int, column: int, limits: tuple[float, float]) -> tuple[float, float]:
    """Speeds around a tongue, a quarter of its width beyond its ends but short of its neighbours."""
    lower, upper = found.lower.values[:, column], found.upper.values[:, column]
    margin = 0.25 * (upper[row] - lower[row])
    low, high = max(lower[row] - margin, limits[0]), min(upper[row] + margin, limits[1])
    others = np.flatnonzero(found.present.values[:, column])
    for other in others[others != row]:
        if upper[other] < lower[row]:
            low = max(low, 0.5 * (upper[other] + lower[row]))
        if lower[other] > upper[row]:
            high = min(high, 0.5 * (lower[other] + upper[row]))
    return float(low), float(high)


@dataclass(frozen=True)
class LabelledRegion:
    """One connected unstable region of a chart.

    Attributes
    ----------
    label : tongue at the node of its largest spectral radius
    point : axis name -> value of that node
    radius : the spectral radius there
    nodes : number of unstable nodes of the region
    """

    label: Tongue
    point: dict[str, float]
    radius: float
    nodes: int


def label_regions(pair: GearPair, chart: xr.Dataset, min_nodes: int = 1) -> list[LabelledRegion]:
    """Name every connected unstable region of a chart by the mode shape at its most unstable node.

    Parameters
    ----------
    pair : the pair of the chart, with the friction law of the chart
    chart : dataset of `stability_chart` over any axes
    min_nodes : smaller regions are left out

    Returns
    -------
    regions, the largest first
    """
    min_nodes = whole_number("min_nodes", min_nodes, 1, 10**9)
    radius = chart["spectral_radius"]
    names = [str(n) for n in radius.dims]
    values = radius.to_numpy()
    numbered, count = ndimage.label(chart["verdict"].to_numpy() == -1, structure=np.ones((3,) * values.ndim))
    regions = []
    for index in range(1, count + 1):
        inside = numbered == index
        size = int(inside.sum())
        if size < min_nodes:
            continue
        node = np.unravel_index(int(np.argmax(np.where(inside, values, -np.inf))), values.shape)
        point = {n: float(chart[n].values[i]) for n, i in zip(names, node, strict=True)}
        label, _ = label_variation(vary(pair, point))
        regions.append(LabelledRegion(label, point, float(values[node]), size))
    return sorted(regions, key=lambda region: -region.nodes)
