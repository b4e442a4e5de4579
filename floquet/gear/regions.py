"""Unstable regions of a stability chart: their names, their widths, the nearest edge.

Sources: docs/theory/floquet.md, "Where instability is, and what it is called".
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy import ndimage

from floquet.engine.tongues import Tongue, label_tongue
from floquet.gear.axes import GEAR_AXES, GearVariation, vary
from floquet.gear.multipliers import gear_block
from floquet.rank_one.batch import fast_monodromies
from lumped.errors import LawRangeWarning
from lumped.labelling import Variable, labelled_dataset
from lumped.schema.files import AnyPair

if TYPE_CHECKING:
    import xarray as xr

_NAMED = 200  # regions that are named at most, the largest


def label_variation(variation: GearVariation) -> Tongue:
    """Label the fastest growing motion of a pair by its mode shape, see `label_tongue`."""
    block = gear_block(variation, supports=variation.supports)
    matrix = fast_monodromies(block).matrices[0]
    return label_tongue(matrix, block.modal().omega, 2.0 * np.pi / block.period)


@dataclass(frozen=True)
class LabelledRegion:
    """One connected unstable region of a chart.

    Attributes
    ----------
    label : tongue at the evaluated node of its largest spectral radius
    point : axis name -> value of that node
    radius : the spectral radius there
    nodes : number of unstable nodes of the region
    width : largest width along the speed, or else the first axis, in its unit
    """

    label: Tongue
    point: dict[str, float]
    radius: float
    nodes: int
    width: float


def label_regions(pair: AnyPair | GearVariation, chart: xr.Dataset) -> list[LabelledRegion]:
    """Name every connected unstable region of a chart by the mode shape at its most unstable node.

    Parameters
    ----------
    pair : the pair of the chart, with the friction law of the chart
    chart : dataset of `stability_chart` over any axes

    Returns
    -------
    regions, the largest first; of more than 200 the largest 200
    """
    variation = GearVariation.of(pair)
    if variation is not pair:
        variation = replace(variation, supports=chart.attrs.get("supports", "springs"))
    radius = chart["spectral_radius"]
    names = list(map(str, radius.dims))
    values = np.where(chart["known"].to_numpy(), radius.to_numpy(), -np.inf)
    along = names.index("speed_rpm") if "speed_rpm" in names else 0
    axis = chart[names[along]].to_numpy()
    cells = np.abs(np.gradient(axis)) if axis.size > 1 else np.zeros(1)
    numbered, count = ndimage.label(chart["verdict"].to_numpy() == -1, structure=np.ones((3,) * values.ndim))
    nodes = np.bincount(numbered.ravel(), minlength=count + 1)[1:]
    boxes, regions = ndimage.find_objects(numbered), []
    for index in np.argsort(-nodes, kind="stable")[:_NAMED]:
        box = boxes[index]
        inside = numbered[box] == index + 1
        place = np.unravel_index(int(np.argmax(np.where(inside, values[box], -np.inf))), inside.shape)
        point = {
            n: float(chart[n].to_numpy()[part.start + i])
            for n, part, i in zip(names, box, place, strict=True)
        }
        width = float((np.moveaxis(inside, along, -1) @ cells[box[along]]).max())
        top = float(values[box][place])
        with warnings.catch_warnings():  # the chart has told where its law leaves its range
            warnings.simplefilter("ignore", LawRangeWarning)
            label = label_variation(vary(variation, point))
        regions.append(LabelledRegion(label, point, top, int(nodes[index]), width))
    return regions


def with_regions(variation: GearVariation, chart: xr.Dataset) -> xr.Dataset:
    """Add the unstable regions of a chart over ``region``, and where the edges next to the pair are.

    The attribute ``nearest_edge_<axis>`` is the value nearest to the pair's own at which its stability
    changes, all else as near as the nodes come; NaN: there is none.
    """
    regions, names = label_regions(variation, chart), list(map(str, chart["spectral_radius"].dims))
    along = "speed_rpm" if "speed_rpm" in names else names[0]
    each: dict[str, Variable] = {
        "region_radius": ("region", np.array([r.radius for r in regions]), "1", "largest multiplier"),
        "region_nodes": ("region", np.array([r.nodes for r in regions], dtype=int), "1", "unstable nodes"),
    }
    widths = np.array([r.width for r in regions])
    each["region_width"] = "region", widths, GEAR_AXES[along].units, f"largest width in {along}"
    for name in names:
        values = np.array([r.point[name] for r in regions])
        each[f"region_{name}"] = "region", values, GEAR_AXES[name].units, GEAR_AXES[name].long_name
    result = labelled_dataset(each, {})
    labels = np.array([str(r.label) for r in regions], dtype=object)
    result = result.assign_coords(region_label=("region", labels))
    attrs = {"thinnest_width": float(widths.min(initial=np.inf)) if regions else np.nan}
    attrs |= {f"nearest_edge_{name}": _edge(variation, chart, name) for name in names}
    return chart.merge(result, combine_attrs="override").assign_attrs(attrs)


def _edge(variation: GearVariation, chart: xr.Dataset, name: str) -> float:
    """Value of an axis nearest to the pair's own where its stability changes, see `with_regions`."""
    own = {n: GEAR_AXES[n].own(variation.pair) for n in map(str, chart["verdict"].dims)}
    others = {n: value for n, value in own.items() if n != name}
    if any(not chart[n].min() <= value <= chart[n].max() for n, value in others.items()):
        return float("nan")
    nearest = {n: int(np.abs(chart[n].to_numpy() - value).argmin()) for n, value in others.items()}
    line = chart["verdict"].isel(nearest).sortby(name)
    at, unstable = line[name].to_numpy(), line.to_numpy() < 0
    edges = 0.5 * (at[1:] + at[:-1])[unstable[1:] != unstable[:-1]]
    return float(edges[np.argmin(np.abs(edges - own[name]))]) if edges.size else float("nan")
