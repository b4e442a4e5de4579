"""Where the panels of a figure lie: as large as the words around them allow, which are measured once."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec
from matplotlib.layout_engine import LayoutEngine
from matplotlib.transforms import Bbox, ScaledTranslation

from lumped.typing import FloatArray

_PAD = 3.0 / 72.0  # around every panel with its words [inch]
_LEAST = 0.2  # of the figure that its panels keep, however much room the words want


class MeasuredLayout(LayoutEngine):
    """Panels of one grid, in equal gaps that hold what stands around them, with axis labels in line.

    The ticks must not depend on the size of a panel. The constrained layout of matplotlib needs neither this
    nor a single grid, but measures all tick labels eight times: half of the time that a figure takes.
    """

    _adjust_compatible = True
    _colorbar_gridspec = True

    def execute(self, fig: Figure) -> None:
        """Place the panels of a figure."""
        fig.subplots_adjust(0.09, 0.15, 0.98, 0.9, 0.22, 0.25)  # about: a legend hangs over by what is left
        renderer = _renderer(fig.dpi)
        panels = {ax: spec for ax in fig.axes if (spec := ax.get_subplotspec()) is not None}
        for ax in panels:
            ax.apply_aspect()
        ticks = {axis: _without_label(axis, renderer) for ax in panels for axis in _ruled(ax)}
        cells = {ax: spec.get_topmost_subplotspec() for ax, spec in panels.items()}
        _line_up(cells, ticks)
        rows, columns = next(iter(cells.values())).get_gridspec().get_geometry()
        left, right, bottom, top = (
            np.full(count, _PAD * fig.dpi) for count in (columns, columns, rows, rows)
        )
        for ax, cell in cells.items():
            # A panel shares its cell with a colour bar; of fixed aspect, it does not fill it.
            own = ax.bbox if cell is panels[ax] else cell.get_position(fig).transformed(fig.transFigure)
            box = _with_words(ax, ticks, renderer)
            for margin, place, reach in (
                (left, cell.colspan[0], own.x0 - box.x0),
                (right, cell.colspan[-1], box.x1 - own.x1),
                (bottom, cell.rowspan[-1], own.y0 - box.y0),
                (top, cell.rowspan[0], box.y1 - own.y1),
            ):
                margin[place] = max(margin[place], reach + _PAD * fig.dpi)
        top[0] += sum(fig.bbox.y1 - one.get_window_extent(renderer).y0 for one in fig.legends)
        start, end, wspace = _share(fig.bbox.width, left, right)
        low, high, hspace = _share(fig.bbox.height, bottom[::-1], top[::-1])
        fig.subplots_adjust(start, low, end, high, wspace, hspace)


@lru_cache(maxsize=4)
def _renderer(dpi: float) -> RendererAgg:
    """Only measures; one for all figures, since it remembers the sizes of words."""
    return RendererAgg(1, 1, dpi)  # type: ignore[no-untyped-call]


def _ruled(ax: Axes) -> list[Axis]:
    """The axes of a panel whose labels stand below or left of it; what stands elsewhere matplotlib places."""
    return [
        axis for axis in (ax.xaxis, ax.yaxis) if axis.get_label_position() in {"bottom", "left"} and ax.axison
    ]


def _without_label(axis: Axis, renderer: RendererAgg) -> Bbox:
    """Box of an axis's tick labels [pixel], or of its panel when there are none."""
    axis.set_label_coords(0.5, 0.0)  # or else matplotlib measures the tick labels to place the label
    axis.label.set_visible(False)
    box = axis.get_tightbbox(renderer)
    axis.label.set_visible(True)
    return axis.axes.bbox if box is None else box


def _line_up(cells: Mapping[Axes, SubplotSpec], ticks: Mapping[Axis, Bbox]) -> None:
    """Place axis labels beside the longest tick labels of a row or column of panels."""
    longest: dict[tuple[bool, int], float] = {}
    places: dict[Axis, tuple[bool, int]] = {}
    for ax, cell in cells.items():
        for axis in _ruled(ax):
            below = axis is ax.xaxis
            places[axis] = below, cell.rowspan.stop if below else cell.colspan.start
            reach = ax.bbox.y0 - ticks[axis].y0 if below else ax.bbox.x0 - ticks[axis].x0
            longest[places[axis]] = max(longest.get(places[axis], 0.0), reach)
    for axis, place in places.items():
        figure, below = axis.axes.figure, place[0]
        shift = -longest[place] / figure.dpi - axis.labelpad / 72.0
        moved = ScaledTranslation(*((0.0, shift) if below else (shift, 0.0)), figure.dpi_scale_trans)
        axis.set_label_coords(*((0.5, 0.0) if below else (0.0, 0.5)), axis.axes.transAxes + moved)


def _with_words(ax: Axes, ticks: Mapping[Axis, Bbox], renderer: RendererAgg) -> Bbox:
    """Box of a panel with all that stands around it [pixel]; lengths of axis labels do not count."""
    boxes = [ticks[axis] for axis in _ruled(ax)]
    for axis in _ruled(ax):
        label = axis.label.get_window_extent(renderer)
        if axis.label.get_text():
            start = (ax.bbox.x0, label.y0) if axis is ax.xaxis else (label.x0, ax.bbox.y0)
            boxes.append(Bbox([start, ax.bbox.max]))
        axis.set_in_layout(False)
    boxes.append(ax.get_tightbbox(renderer, for_layout_only=True) or ax.bbox)
    for axis in _ruled(ax):
        axis.set_in_layout(True)
    return Bbox.union(boxes)


def _share(length: float, before: FloatArray, after: FloatArray) -> tuple[float, float, float]:
    """Start and end of a line of panels with margins [pixel], over its length, and its gaps, over a panel.

    Where the figure is too small for its words they lie over panels or leave the figure.
    """
    gap = float(np.max(after[:-1] + before[1:], initial=0.0))
    start, end = float(before[0]), float(after[-1])
    margins = start + end + gap * (before.size - 1)
    short = min(1.0, (1.0 - _LEAST) * length / margins)
    panel = (length - short * margins) / before.size
    return short * start / length, 1.0 - short * end / length, short * gap / panel
