"""Names for the unstable regions of a chart of a gear pair.

Sources: docs/theory/floquet.md, "Where instability is, and what it is called".
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import ndimage

from floquet.engine.tongues import Tongue
from floquet.gear.axes import vary
from floquet.gear.boundaries import label_variation
from lumped.schema.files import AnyPair, load_gear_pair

if TYPE_CHECKING:
    import xarray as xr


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


def label_regions(pair: AnyPair, chart: xr.Dataset) -> list[LabelledRegion]:
    """Name every connected unstable region of a chart by the mode shape at its most unstable node.

    Parameters
    ----------
    pair : the pair of the chart, with the friction law of the chart
    chart : dataset of `stability_chart` over any axes

    Returns
    -------
    regions, the largest first
    """
    pair = load_gear_pair(pair)
    radius = chart["spectral_radius"]
    names = [str(n) for n in radius.dims]
    values = radius.to_numpy()
    numbered, count = ndimage.label(chart["verdict"].to_numpy() == -1, structure=np.ones((3,) * values.ndim))
    regions = []
    for index in range(1, count + 1):
        inside = numbered == index
        node = np.unravel_index(int(np.argmax(np.where(inside, values, -np.inf))), values.shape)
        point = {n: float(chart[n].values[i]) for n, i in zip(names, node, strict=True)}
        label = label_variation(vary(pair, point))
        regions.append(LabelledRegion(label, point, float(values[node]), int(inside.sum())))
    return sorted(regions, key=lambda region: -region.nodes)
