"""Pictures of the meshing teeth with their contact forces, drawn by matplotlib without a display.

The axes are those of the model: x along the nominal line of action from X, positive the way the pinion tooth
pushes, y off it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, FancyArrowPatch, Polygon, Rectangle

from lumped.errors import refuse
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from multibody.study.outline import gear_outline

if TYPE_CHECKING:
    import xarray as xr

_FACES, _EDGES = ("#c9d7e8", "#e8dcc3"), ("#37587f", "#7d6433")
_NORMAL, _FRICTION = "#b3261e", "#1b7a3d"
_LINE: dict[str, Any] = {"color": "0.25", "linewidth": 0.9, "linestyle": "--"}
#: Factors by which friction arrows may be longer than those of normal loads.
_ENLARGED = (1, 2, 5, 10, 20, 50, 100)


def gear_picture(pair: GearPair, run: xr.Dataset, index: int = 0) -> Figure:
    """Both gears and a close-up of the contacts at one output time of a run.

    Parameters
    ----------
    pair : the pair that was simulated
    run : result of ``multibody.simulate`` or ``lumped.simulate``
    index : number of the output time

    Returns
    -------
    matplotlib Figure: to scale, deflections included (they are micrometres). Arrows show the forces on the
    gear body with their values; one scale holds for the whole run, friction enlarged as the legend says

    Raises
    ------
    ParameterError : no such output time
    """
    count = run.sizes["time"]
    if not 0 <= index < count:
        raise refuse("index", index, f"0 to {count - 1}", "Name an output time of the run.")
    figure = Figure(figsize=(11.0, 5.2), layout="constrained")
    FigureCanvasAgg(figure)
    # The largest normal load and friction force of the run [N] fix the scale of the arrows.
    load, friction = (float(np.abs(run[name]).max()) for name in ("normal_load", "friction_force"))
    _draw(figure, pair, run.isel(time=index), (max(load, 1e-300), friction))
    return figure


def _draw(
    figure: Figure,
    pair: GearPair,
    now: xr.Dataset,
    largest: tuple[float, float],
) -> None:
    g, t = pair.geometry, float(now["time"])
    outlines = gear_outline(pair, "pinion"), gear_outline(pair, "gear")
    # Pinion clockwise, gear counter-clockwise; angles are nominal rotation plus deviation.
    angles = (-(g.omega_pinion * t + float(now["theta_p"])), g.omega_gear * t + float(now["theta_g"]))
    centres = (
        np.array([float(now["x_p"]), float(now["y_p"]) - g.base_radius_pinion]),
        np.array([float(now["x_g"]) + g.L_XY, float(now["y_g"]) + g.base_radius_gear]),
    )
    whole, close = figure.subplots(1, 2, width_ratios=[1.0, 1.35])
    for axes in (whole, close):
        for outline, angle, centre, face, edge in zip(outlines, angles, centres, _FACES, _EDGES, strict=True):
            c, s = np.cos(angle), np.sin(angle)
            xy = 1e3 * (outline @ np.array([[c, s], [-s, c]]) + centre)
            # Unlike axes.fill, without a long search for extremes of curves between the corners.
            axes.add_artist(Polygon(xy, facecolor=face, edgecolor=edge, linewidth=0.8))
            axes.update_datalim(xy)
        axes.axline((0.0, 0.0), slope=0.0, **_LINE)
        axes.set_aspect("equal")
        axes.set_xlabel("x along the line of action [mm]")
        axes.set_ylabel("y off the line of action [mm]")
    window = _window(pair)
    _whole_gears(whole, pair, centres, window)
    close.set_xlim(window[0], window[0] + window[2])
    close.set_ylim(window[1], window[1] + window[3])
    _forces(close, now, largest, 0.5 * window[2])
    _path_of_contact(close, pair)
    rpm = pair.operating.pinion_speed * 30.0 / np.pi
    figure.suptitle(
        f"{pair.name}: {rpm:.4g} rpm, {pair.operating.pinion_torque:.8g} N m, "
        f"after {t / g.mesh_period:.2f} mesh cycles",
        parse_math=False,  # a name is text, whatever it contains
    )


def _window(pair: GearPair) -> tuple[float, float, float, float]:
    """Left, bottom, width, height of the close-up [mm]."""
    g = pair.geometry
    reach = 1e3 * max(g.L_XD - g.L_XA, g.base_pitch)
    middle = 1e3 * 0.5 * (g.L_XA + g.L_XD)
    return middle - 0.9 * reach, -0.65 * reach, 2.0 * reach, 1.3 * reach


def _whole_gears(
    axes: Axes,
    pair: GearPair,
    centres: tuple[FloatArray, FloatArray],
    window: tuple[float, float, float, float],
) -> None:
    """Names, centres, base circles and senses of rotation, and the frame of the close-up."""
    g = pair.geometry
    radii = (g.base_radius_pinion, g.base_radius_gear)
    names = (f"pinion, {pair.pinion.teeth} teeth\ndrives", f"gear, {pair.gear.teeth} teeth\nis driven")
    for centre, radius, name, turn, edge in zip(centres, radii, names, (-1, 1), _EDGES, strict=True):
        x, y = 1e3 * centre
        r = 1e3 * radius
        axes.add_patch(Circle((x, y), r, fill=False, edgecolor=edge, linewidth=0.7, linestyle=":"))
        axes.plot([x], [y], marker="+", color=edge, markersize=7)
        axes.annotate(name, (x, y), (0, -7), textcoords="offset points", ha="center", va="top", fontsize=8)
        ends = [
            (x + 0.7 * r * np.cos(a), y + 0.7 * r * np.sin(a))
            for a in np.deg2rad((90 - turn * 30, 90 + turn * 30))
        ]
        axes.add_patch(
            FancyArrowPatch(
                *ends,
                connectionstyle=f"arc3,rad={turn * 0.28}",
                arrowstyle="-|>",
                mutation_scale=12,
                color=edge,
                linewidth=1.4,
            )
        )
    axes.add_patch(Rectangle(window[:2], *window[2:], fill=False, edgecolor="0.25", linewidth=0.8))
    axes.set_title("base circles dotted; frame: the close-up", fontsize=9)


def _path_of_contact(axes: Axes, pair: GearPair) -> None:
    """Ticks above the close-up where contact starts, changes and ends."""
    g = pair.geometry
    places = {name: 1e3 * getattr(g, f"L_X{name}") for name in "ABPCD"}
    for x in places.values():
        axes.plot([x], [0.0], marker="|", color="0.25", markersize=8)
    above = axes.secondary_xaxis("top")
    above.set_xticks(list(places.values()), list(places))
    above.set_xlabel("contact from A to D, fewest pairs of teeth from B to C, P pitch point", fontsize=9)


def _forces(axes: Axes, now: xr.Dataset, largest: tuple[float, float], longest: float) -> None:
    """Arrows of the forces on the gear at every contact, with their values."""
    scale = 0.5 * longest / largest[0]
    fitting = [f for f in _ENLARGED if f * largest[1] * scale <= 0.4 * longest]
    enlarged = max(fitting, default=1)
    for i in range(now.sizes["pair"]):
        if float(now["contact"][i]) == 0.0:
            continue
        x, load, friction = (float(now[name][i]) for name in ("position", "normal_load", "friction_force"))
        up = -friction * scale * enlarged
        for dx, dy, colour, value in (
            (load * scale, 0.0, _NORMAL, load),
            (0.0, up, _FRICTION, abs(friction)),
        ):
            end = (1e3 * x + dx, dy)
            axes.annotate(
                "",
                end,
                (1e3 * x, 0.0),
                arrowprops={
                    "arrowstyle": "-|>",
                    "color": colour,
                    "linewidth": 1.8,
                    "shrinkA": 0,
                    "shrinkB": 0,
                },
            )
            axes.annotate(
                f"{value:.0f} N",
                end,
                (4, 4 if dy == 0.0 else 0),
                textcoords="offset points",
                color=colour,
                fontsize=9,
                ha="left",
                va="top" if dy < 0.0 else "bottom",
                bbox={"facecolor": "white", "alpha": 0.75, "edgecolor": "none", "pad": 0.8},
            )
    how = "to the same scale" if enlarged == 1 else f"arrows {enlarged} times as long"
    handles = [
        Line2D([], [], color=_NORMAL, linewidth=1.8, label="normal load on the gear"),
        Line2D([], [], color=_FRICTION, linewidth=1.8, label=f"friction on the gear, {how}"),
        Line2D([], [], label="line of action", **_LINE),
    ]
    axes.legend(
        handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=3, fontsize=8, frameon=False
    )
