"""Both shafts of a pair to scale with gears, bearings, motor and load."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from lumped import GearPair
from lumped.schema.shafts import CoupledInertia, Shaft
from validation.plots.style import (
    BLUE,
    GREY,
    RED,
    WIDTH,
    new_figure,
    write_beside,
)

_STEEL, _GEARS = "#dfe3e8", ("#c9d7e8", "#e8dcc3")
_COLOURS = (BLUE, RED)


def shafts_figure(pair: GearPair) -> Figure:
    """Side view of both shafts of a pair to scale."""
    assert pair.shafts is not None
    shafts = (pair.shafts.pinion, pair.shafts.gear)
    # The middles of both faces are one place; z is counted from the end of the pinion's shaft.
    starts = (0.0, 1e3 * (shafts[0].gear_position - shafts[1].gear_position))
    distance = 1e3 * pair.geometry.centre_distance
    ends = [start + 1e3 * shaft.length for start, shaft in zip(starts, shafts, strict=True)]
    low, high = min(starts) - 0.75 * distance, max(ends) + 0.75 * distance
    bottom = -1e3 * pair.geometry.tip_radius_pinion - 0.2 * distance
    top = distance + 1e3 * pair.geometry.tip_radius_gear + 0.2 * distance
    tall = min(max(0.9 * WIDTH * (top - bottom) / (high - low), 2.0), 6.0)
    figure, axes = new_figure(1, 1, 0.6 + tall)
    view = axes[0, 0]
    view.grid(visible=False)
    view.set(xlim=(low, high), ylim=(bottom, top))
    view.set_aspect("equal", adjustable="box")
    coupled = (("motor", pair.shafts.motor), ("load", pair.shafts.load))
    gears = (("pinion", pair.pinion, "tip_radius_pinion"), ("gear", pair.gear, "tip_radius_gear"))
    for i, shaft in enumerate(shafts):
        height = i * distance
        _shaft(view, shaft, starts[i], height)
        name, gear, tip = gears[i]
        radius, face = 1e3 * float(getattr(pair.geometry, tip)), 1e3 * gear.face_width
        middle = starts[i] + 1e3 * shaft.gear_position
        view.add_patch(
            Rectangle(
                (middle - 0.5 * face, height - radius),
                face,
                2.0 * radius,
                facecolor=_GEARS[i],
                edgecolor=_COLOURS[i],
                linewidth=0.9,
                zorder=3,
            )
        )
        side = (1.0, "bottom", 3) if i else (-1.0, "top", -3)
        place = (middle, height + side[0] * radius)
        words = f"{name}, {gear.teeth} teeth"
        write_beside(view, words, place, (0, side[2]), ha="center", va=side[1], color=_COLOURS[i])
        _bearings(view, shaft, starts[i], height)
        word, inertia = coupled[i]
        if inertia is not None:
            _coupled(view, word, inertia, shaft, starts[i], height, distance)
    view.set_ylabel("height [mm]")
    view.set_xlabel("along the shafts, from the end of the pinion's [mm]")
    return figure


def _shaft(ax: Axes, shaft: Shaft, start: float, height: float) -> None:
    """Outline of the segments, bores dashed, and the axis."""
    z = start
    for segment in shaft.segments:
        length, radius, bore = (
            1e3 * size for size in (segment.length, 0.5 * segment.diameter, 0.5 * segment.bore)
        )
        box = Rectangle((z, height - radius), length, 2.0 * radius)
        box.set(facecolor=_STEEL, edgecolor="0.25", linewidth=0.8, zorder=2)
        ax.add_patch(box)
        if bore > 0.0:
            for edge in (-bore, bore):
                ax.plot([z, z + length], [height + edge] * 2, color="0.25", linewidth=0.6, linestyle=":")
        z += length
    ends = [start - 0.03 * (z - start), z + 0.03 * (z - start)]
    ax.plot(ends, [height] * 2, color=GREY, linewidth=0.6, linestyle=(0, (8, 2, 2, 2)), zorder=4)


def _bearings(ax: Axes, shaft: Shaft, start: float, height: float) -> None:
    """A crossed box on both sides of the shaft at each bearing."""
    for number, bearing in enumerate(shaft.bearings):
        z = start + 1e3 * bearing.position
        radius = 1e3 * 0.5 * _diameter_at(shaft, bearing.position)
        width, tall = 0.5 * radius, 0.6 * radius
        for sense in (-1.0, 1.0):
            low = height + sense * radius if sense > 0.0 else height - radius - tall
            left = z - 0.5 * width
            ax.add_patch(
                Rectangle(
                    (left, low), width, tall, facecolor="white", edgecolor="0.1", linewidth=0.9, zorder=4
                )
            )
            for ends in ((low, low + tall), (low + tall, low)):
                ax.plot([left, left + width], ends, color="0.1", linewidth=0.7, zorder=5)
        above = (z, height + radius + tall)
        write_beside(ax, f"{number + 1}", above, (0, 2), ha="center", va="bottom", color="0.1")


def _coupled(
    ax: Axes,
    word: str,
    inertia: CoupledInertia,
    shaft: Shaft,
    start: float,
    height: float,
    distance: float,
) -> None:
    """A box beyond the nearer end of the shaft, tied to its station by a spring."""
    length = 1e3 * shaft.length
    z = start + 1e3 * inertia.position
    sense = -1.0 if inertia.position < 0.5 * shaft.length else 1.0
    end = start if sense < 0.0 else start + length
    size = 0.32 * distance
    near = end + sense * 0.8 * size
    zigzag = np.linspace(z, near, 9)
    up = np.array([0, 0, 1, -1, 1, -1, 1, 0, 0]) * 0.18 * size
    ax.plot(zigzag, height + up, color="0.1", linewidth=1.0, zorder=6)
    left = near if sense > 0.0 else near - size
    box = Rectangle((left, height - 0.5 * size), size, size)
    box.set(facecolor="white", edgecolor="0.1", linewidth=1.0, zorder=6)
    ax.add_patch(box)
    middle = (left + 0.5 * size, height)
    ax.annotate(word, middle, ha="center", va="center", fontsize=8.5, zorder=7)


def _diameter_at(shaft: Shaft, position: float) -> float:
    ends = np.cumsum([segment.length for segment in shaft.segments])
    number = min(int(np.searchsorted(ends, position * (1.0 - 1e-12))), len(shaft.segments) - 1)
    return shaft.segments[number].diameter
