"""Both shafts of a pair to scale with gears, bearings, motor and load."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from lumped import GearPair
from lumped.schema.shafts import CoupledInertia, Shaft
from validation.plots.style import BLUE, GREY, RED, WIDTH, new_figure, write_beside

_STEEL, _GEARS = "#dfe3e8", ("#c9d7e8", "#e8dcc3")
_COLOURS = (BLUE, RED)


def shafts_figure(pair: GearPair) -> Figure:
    """Side view of both shafts of a pair to scale."""
    assert pair.shafts is not None
    shafts = (pair.shafts.pinion, pair.shafts.gear)
    g, distance = pair.geometry, 1e3 * pair.geometry.centre_distance
    # The middles of both faces are one place; z is counted from the end of the pinion's shaft.
    starts = (0.0, 1e3 * (shafts[0].gear_position - shafts[1].gear_position))
    ends = [start + 1e3 * shaft.length for start, shaft in zip(starts, shafts, strict=True)]
    low, high = min(starts) - 0.75 * distance, max(ends) + 0.75 * distance
    bottom = -1e3 * g.tip_radius_pinion - 0.2 * distance
    top = distance + 1e3 * g.tip_radius_gear + 0.2 * distance
    tall = min(max(0.9 * WIDTH * (top - bottom) / (high - low), 2.0), 6.0)
    figure, axes = new_figure(1, 1, 0.6 + tall)
    view = axes[0, 0]
    view.grid(visible=False)
    view.set(xlim=(low, high), ylim=(bottom, top), ylabel="height [mm]")
    view.set_xlabel("along the shafts, from the end of the pinion's [mm]")
    view.set_aspect("equal", adjustable="box")
    coupled = (("motor", pair.shafts.motor), ("load", pair.shafts.load))
    gears = (("pinion", pair.pinion, g.tip_radius_pinion), ("gear", pair.gear, g.tip_radius_gear))
    for i, (shaft, start, (name, gear, tip)) in enumerate(zip(shafts, starts, gears, strict=True)):
        height, radius, face = i * distance, 1e3 * float(tip), 1e3 * gear.face_width
        _shaft(view, shaft, start, height)
        middle = start + 1e3 * shaft.gear_position
        _box(view, middle, height, face, 2.0 * radius, _GEARS[i], edgecolor=_COLOURS[i], zorder=3)
        sense, va = (1.0, "bottom") if i else (-1.0, "top")
        place, words = (middle, height + sense * radius), f"{name}, {gear.teeth} teeth"
        write_beside(view, words, place, (0, 3.0 * sense), ha="center", va=va, color=_COLOURS[i])
        word, inertia = coupled[i]
        if inertia is not None:
            _coupled(view, word, inertia, shaft, start, height, 0.32 * distance)
    return figure


def _box(ax: Axes, x: float, y: float, width: float, height: float, colour: str, **look: Any) -> None:
    """A rectangle about its middle."""
    style: dict[str, Any] = {"facecolor": colour, "edgecolor": "0.1", "linewidth": 0.9} | look
    ax.add_patch(Rectangle((x - 0.5 * width, y - 0.5 * height), width, height, **style))


def _shaft(ax: Axes, shaft: Shaft, start: float, height: float) -> None:
    """Outline of the segments, bores dashed, the axis, and a crossed box on both sides at each bearing."""
    z, ends, radii = start, list[float](), list[float]()
    for segment in shaft.segments:
        length, radius, bore = 1e3 * segment.length, 500.0 * segment.diameter, 500.0 * segment.bore
        _box(ax, z + 0.5 * length, height, length, 2.0 * radius, _STEEL, edgecolor="0.25", zorder=2)
        if bore > 0.0:
            for edge in (-bore, bore):
                ax.plot([z, z + length], [height + edge] * 2, color="0.25", linewidth=0.6, linestyle=":")
        z += length
        ends.append(z)
        radii.append(radius)
    axis = [start - 0.03 * (z - start), z + 0.03 * (z - start)]
    ax.plot(axis, [height] * 2, color=GREY, linewidth=0.6, linestyle=(0, (8, 2, 2, 2)), zorder=4)
    for number, bearing in enumerate(shaft.bearings):
        place = start + 1e3 * bearing.position
        radius = radii[min(int(np.searchsorted(ends, place - 1e-9 * z)), len(radii) - 1)]
        wide, tall = 0.25 * radius, 0.3 * radius
        for y in (height + radius + tall, height - radius - tall):
            _box(ax, place, y, 2.0 * wide, 2.0 * tall, "white", zorder=4)
            for up in (-tall, tall):
                ax.plot([place - wide, place + wide], [y - up, y + up], color="0.1", linewidth=0.7, zorder=5)
        above = (place, height + radius + 2.0 * tall)
        write_beside(ax, f"{number + 1}", above, (0, 2), ha="center", va="bottom", color="0.1")


def _coupled(
    ax: Axes, word: str, inertia: CoupledInertia, shaft: Shaft, start: float, height: float, size: float
) -> None:
    """A box beyond the nearer end of the shaft, tied to its station by a spring."""
    near_start = inertia.position < 0.5 * shaft.length
    near = start - 0.8 * size if near_start else start + 1e3 * shaft.length + 0.8 * size
    zigzag = np.linspace(start + 1e3 * inertia.position, near, 9)
    up = np.array([0, 0, 1, -1, 1, -1, 1, 0, 0]) * 0.18 * size
    ax.plot(zigzag, height + up, color="0.1", linewidth=1.0, zorder=6)
    middle = near - 0.5 * size if near_start else near + 0.5 * size
    _box(ax, middle, height, size, size, "white", zorder=6)
    ax.annotate(word, (middle, height), ha="center", va="center", fontsize=8.5, zorder=7)
