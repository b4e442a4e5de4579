"""Pictures of the meshing teeth with their contact forces, drawn by matplotlib without a display.

The axes are those of the model: x along the line of action, positive the way the pinion tooth pushes, y off
it.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.animation import PillowWriter
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from lumped.errors import refuse
from lumped.gear_geometry import geometry
from lumped.parameters import GearPair
from multibody.outline import gear_outline

if TYPE_CHECKING:
    import xarray as xr

FloatArray = NDArray[np.float64]
_FACES, _EDGES = ("#c9d7e8", "#e8dcc3"), ("#37587f", "#7d6433")
_NORMAL, _FRICTION = "#b3261e", "#1b7a3d"


def gear_picture(pair: GearPair, run: xr.Dataset, index: int = 0) -> Figure:
    """Both gears and a close-up of the contacts at one output time of a run.

    Parameters
    ----------
    pair : the pair that was simulated
    run : result of ``multibody.simulate`` or ``lumped.simulate``
    index : number of the output time

    Returns
    -------
    matplotlib Figure: to scale, deflections included (they are micrometres); arrows show the forces on the
    gear body, all to one scale, normal load and friction enlarged alike

    Raises
    ------
    ParameterError : no such output time
    """
    count = run.sizes["time"]
    if not 0 <= index < count:
        raise refuse("index", index, f"0 to {count - 1}", "Name an output time of the run.")
    figure = Figure(figsize=(11.0, 5.2), layout="constrained")
    FigureCanvasAgg(figure)
    _draw(figure, pair, run, index, _outlines(pair), _largest(run))
    return figure


def gear_animation(
    pair: GearPair,
    run: xr.Dataset,
    path: str | Path,
    *,
    frames: int = 40,
    cycles: float = 2.0,
    per_second: int = 12,
    dpi: int = 80,
) -> Path:
    """Write a GIF of the last mesh cycles of a run; the file appears whole or not at all.

    Parameters
    ----------
    pair, run : as ``gear_picture``
    path : of the GIF
    frames : pictures
    cycles : mesh cycles shown, ending with the run
    per_second : pictures per second
    dpi : dots per inch

    Raises
    ------
    ParameterError : the path does not end in .gif
    """
    target = Path(path)
    if target.suffix.lower() != ".gif":
        raise refuse("path", target, "a name ending in .gif", "Rename the file.")
    time = run["time"].to_numpy()
    start = max(float(time[-1]) - cycles * geometry(pair).mesh_period, float(time[0]))
    wanted = start + (float(time[-1]) - start) * np.arange(frames) / frames
    outlines, largest = _outlines(pair), _largest(run)
    figure = Figure(figsize=(11.0, 5.2), layout="constrained")
    FigureCanvasAgg(figure)
    writer = PillowWriter(fps=per_second)
    partial = target.with_name(f".{target.name}.partial.gif")
    try:
        writer.setup(figure, str(partial), dpi)
        for index in np.searchsorted(time, wanted):
            figure.clear()
            _draw(figure, pair, run, int(index), outlines, largest)
            writer.grab_frame()
        writer.finish()  # writes the file; not reached when interrupted
        partial.replace(target)
    finally:
        partial.unlink(missing_ok=True)
    return target


def _outlines(pair: GearPair) -> tuple[FloatArray, FloatArray]:
    return gear_outline(pair, "pinion"), gear_outline(pair, "gear")


def _largest(run: xr.Dataset) -> float:
    """Largest normal load of the run [N]."""
    return max(float(np.abs(run["normal_load"]).max()), 1e-300)


def _draw(
    figure: Figure,
    pair: GearPair,
    run: xr.Dataset,
    index: int,
    outlines: tuple[FloatArray, FloatArray],
    largest: float,
) -> None:
    g, now = geometry(pair), run.isel(time=index)
    t = float(now["time"])
    # Pinion clockwise, gear counter-clockwise; angles are nominal rotation plus deviation.
    angles = (-(g.omega_pinion * t + float(now["theta_p"])), g.omega_gear * t + float(now["theta_g"]))
    centres = (
        np.array([float(now["x_p"]), float(now["y_p"]) - g.base_radius_pinion]),
        np.array([float(now["x_g"]) + g.L_XY, float(now["y_g"]) + g.base_radius_gear]),
    )
    whole, close = figure.subplots(1, 2, width_ratios=[1.0, 1.25])
    for axes in (whole, close):
        for outline, angle, centre, face, edge in zip(outlines, angles, centres, _FACES, _EDGES, strict=True):
            c, s = np.cos(angle), np.sin(angle)
            xy = 1e3 * (outline @ np.array([[c, s], [-s, c]]) + centre)
            axes.fill(xy[:, 0], xy[:, 1], facecolor=face, edgecolor=edge, linewidth=0.8)
        axes.axline((0.0, 0.0), slope=0.0, color="0.35", linewidth=0.7, linestyle="--")
        axes.set_aspect("equal")
        axes.set_xlabel("x along the line of action [mm]")
    whole.set_ylabel("y off the line of action [mm]")
    _close_up(close, pair, now, largest)
    rpm = pair.operating.pinion_speed * 30.0 / np.pi
    phase = t / g.mesh_period
    figure.suptitle(
        f"{pair.name}, {rpm:.4g} rpm, {pair.operating.pinion_torque:.4g} N m, mesh cycle {phase:.3f}",
        parse_math=False,  # a name is text, whatever it contains
    )


def _close_up(axes: Axes, pair: GearPair, now: xr.Dataset, largest: float) -> None:
    g = geometry(pair)
    reach = 1e3 * max(g.L_XD - g.L_XA, g.base_pitch)
    middle = 1e3 * 0.5 * (g.L_XA + g.L_XD)
    axes.set_xlim(middle - 0.9 * reach, middle + 1.1 * reach)
    axes.set_ylim(-0.65 * reach, 0.65 * reach)
    for name in "ABPCD":
        x = 1e3 * getattr(g, f"L_X{name}")
        axes.plot([x], [0.0], marker="|", color="0.2", markersize=9)
        axes.annotate(name, (x, 0.0), (0, -14), textcoords="offset points", ha="center", fontsize=8)
    scale = 0.5 * reach / largest
    for i in range(now.sizes["pair"]):
        if float(now["contact"][i]) == 0.0:
            continue
        x, load, friction = (float(now[name][i]) for name in ("position", "normal_load", "friction_force"))
        for dx, dy, colour in ((load * scale, 0.0, _NORMAL), (0.0, -friction * scale, _FRICTION)):
            axes.annotate(
                "",
                (1e3 * x + dx, dy),
                (1e3 * x, 0.0),
                arrowprops={
                    "arrowstyle": "-|>",
                    "color": colour,
                    "linewidth": 1.8,
                    "shrinkA": 0,
                    "shrinkB": 0,
                },
            )
    total, friction = (float(now[name].sum()) for name in ("normal_load", "friction_force"))
    axes.set_title(
        f"forces on the gear: normal {total:.0f} N (red), friction {round(-friction):d} N (green)", fontsize=9
    )
