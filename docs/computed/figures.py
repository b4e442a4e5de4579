"""Curves of the theory pages: friction and film, multipliers and tongues, where the linear model ends."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import lumped
from computed import GENERATED
from computed.agreement import torque_series
from computed.diagrams import svg
from floquet import gear_pair_multipliers, stability_chart
from floquet.gear.tongues import stability_margins
from lumped import GearPair, Geometry
from lumped.path_of_contact import friction_profile
from lumped.typing import FloatArray
from reproductions.he_cho_singh_2008.plots import mark_switches, path_marks
from validation import report
from validation.files.output import write_dataset
from validation.interactive.page import render
from validation.interactive.results import compute
from validation.plots.stability import stability_figure
from validation.plots.style import (
    BLUE,
    DASHES,
    GREY,
    IN_Y,
    LINES,
    RED,
    legend,
    legend_above,
    look,
    new_figure,
    one_panel,
    write_beside,
)  # fmt: skip


def _pair() -> GearPair:
    """The pair of the theory pages: without relief."""
    return lumped.load_gear_pair("nasa_28_28").with_(mesh__relief="ignored")


@cache
def _profile() -> xr.Dataset:
    return friction_profile(_pair())


def _path_axis(ax: Axes, g: Geometry, ends: FloatArray | None = None) -> None:
    """Label an x axis along the path of contact and mark its letters; ``ends`` [mm]: default A and D."""
    marks = path_marks(g)
    ax.set_xlabel("distance from X along the line of action [mm]")
    ax.set_xlim(*((marks["A"], marks["D"]) if ends is None else (ends[0], ends[-1])))
    mark_switches(ax, marks)


def _without_jumps(x: FloatArray, y: FloatArray, largest: float) -> tuple[FloatArray, FloatArray]:
    """Curve with a gap wherever neighbours differ by more than ``largest``, so that no line joins a jump."""
    places = np.flatnonzero(np.abs(np.diff(y)) > largest) + 1
    return np.insert(x, places, np.nan), np.insert(y, places, np.nan)


def _path_figure(g: Geometry, profile: xr.Dataset, thresholds: tuple[float, ...]) -> Figure:
    """Sliding and entraining velocity and film parameter along the path of contact.

    ``profile``: dataset of ``lumped.path_of_contact.friction_profile``; ``thresholds``: film parameters at
    which the lubrication regime changes.
    """
    figure, axes = new_figure(1, 2, height=2.7)
    xi, film = 1e3 * profile["xi"].to_numpy(), profile["film_parameter"].to_numpy()
    left, right = axes[0]
    left.plot(xi, profile["entraining_velocity"], color=BLUE, linestyle=DASHES[0], label="entraining (sum)")
    left.plot(xi, profile["sliding_velocity"], color=RED, linestyle=DASHES[1], label="sliding")
    left.set(ylabel="velocity [m/s]", ylim=(0.0, None))
    legend_above(left, 2, letters=True)
    top = 1.25 * float(film.max())
    right.plot(xi, film, color=BLUE)
    right.set(ylabel="film parameter [-]", ylim=(0.0, top))
    edges = (0.0, *thresholds, np.inf)
    for index, name in enumerate(str(profile["regime"].attrs["flag_meanings"]).split(", ")):
        low, high = edges[index], min(edges[index + 1], top)
        if low < top:
            right.axhspan(low, high, color=GREY, alpha=0.08 * index, linewidth=0)
            write_beside(right, name, (0.01, high), (0, -2), IN_Y, va="top", fontsize=7.5, color="#404040")
    for ax in (left, right):
        _path_axis(ax, g, xi)
    return figure


def _friction_laws_figure(g: Geometry, profile: xr.Dataset, chosen: str) -> Figure:
    """Signed friction coefficient of all laws along the path of contact, the pair's own drawn strongest.

    ``profile``: dataset of ``lumped.path_of_contact.friction_profile``.
    """
    figure, ax = one_panel(3.3)
    xi = 1e3 * profile["xi"].to_numpy()
    for number, law in enumerate(profile["law"].to_numpy()):
        mu = profile["mu"].sel(law=law).to_numpy()
        own = str(law) == chosen
        title = str(profile["law_title"].sel(law=law).item()) + (" (used)" if own else "")
        weight, order = (2.4, 3) if own else (1.2, 2)
        curve = _without_jumps(xi, mu, 0.3 * np.ptp(mu))
        ax.plot(*curve, **look(number), linewidth=weight, label=title, zorder=order)
    ax.axhline(0.0, color=GREY, linewidth=0.6)
    _path_axis(ax, g, xi)
    ax.set_ylabel("friction coefficient, signed [-]")
    legend_above(ax, 3, letters=True)
    return figure


def friction_laws() -> str:
    """All laws along the path of contact."""
    return svg(_friction_laws_figure(lumped.geometry(_pair()), _profile(), _pair().friction.law))


def film() -> str:
    """Velocities and film parameter along the path of contact."""
    return svg(_path_figure(_pair().geometry, _profile(), _pair().friction.thresholds))


def multipliers() -> str:
    """Multipliers through the main tongue of a lightly damped pair, in the complex plane and over speed."""
    pair, speeds = _pair().with_(mesh__damping_ratio=0.01), np.linspace(16000.0, 20000.0, 161)
    found = [gear_pair_multipliers(pair.with_(operating__pinion_speed=rpm)).feedback for rpm in speeds]
    values, turn = np.concatenate(found), np.linspace(0.0, 2.0 * np.pi, 361)
    rpm, outside = np.repeat(speeds, len(found[0])), np.abs(values) > 1.0
    figure, ((left, right),) = new_figure(1, 2, height=3.4)
    left.plot(np.cos(turn), np.sin(turn), color=GREY, lw=0.9)
    for part, colour in ((~outside, BLUE), (outside, RED)):
        left.plot(values[part].real, values[part].imag, ".", color=colour, markersize=3)
        right.plot(rpm[part], np.abs(values[part]), ".", color=colour, markersize=3)
    right.axhline(1.0, color=GREY, lw=0.9)
    left.set(xlabel="real part [-]", ylabel="imaginary part [-]", aspect="equal")
    right.set(xlabel="pinion speed [rpm]", ylabel="modulus [-], red: unstable")
    return svg(figure)


def tongues() -> str:
    """Stability chart over speed and mesh damping."""
    pair = _pair().with_(friction__law="coulomb", friction__coefficient=0.05)
    axes = {"speed_rpm": np.linspace(2000.0, 20000.0, 361), "damping_ratio": np.linspace(0.002, 0.06, 59)}
    at = {"speed_rpm": 4875.0, "damping_ratio": pair.mesh.damping_ratio}
    traced = stability_margins(pair, (2000.0, 20000.0)).tongues
    chart = stability_chart(pair, axes, rtol=1e-8)
    return svg(stability_figure(chart, at, traced))


def torque_law() -> str:
    """Differences of the models over torque, with the slopes that theory gives."""
    series = torque_series()
    figure, axes = new_figure(1, 2, height=3.0)
    left, right = axes[0]
    torque = series["torque"].to_numpy()
    for j, name in enumerate(("dte", "x_p", "y_p")):
        left.loglog(torque, 1e6 * series[name], "os^"[j], color=LINES[j], label=name)
    last = 1e6 * float(series["dte"][0])
    left.loglog(torque, last * (torque / torque[0]) ** 2, color=GREY, lw=0.9, label="slope 2")
    left.set(xlabel="pinion torque [N m]", ylabel="largest difference [µm]")
    right.loglog(torque, series["monodromy"], "o", color=BLUE, label="monodromy matrix")
    first = float(series["monodromy"][-1])
    right.loglog(torque, first * torque / torque[-1], color=GREY, lw=0.9, label="slope 1")
    right.set(xlabel="pinion torque [N m]", ylabel="relative difference [-]")
    for ax in (left, right):
        legend(ax)
    return svg(figure)


def validity() -> str:
    """Smallest normal load in contact and reach of reversed sliding over speed, at two mesh dampings."""
    figure, axes = new_figure(1, 2, height=3.0)
    left, right = axes[0]
    speeds = np.linspace(600.0, 9000.0, 85)
    g = lumped.geometry(_pair())
    static = _pair().operating.pinion_torque / g.base_radius_pinion
    for j, damping in enumerate((0.02, 0.05)):
        sweep = lumped.speed_sweep(_pair().with_(mesh__damping_ratio=damping), speeds, samples_per_cycle=512)
        style = {"color": LINES[j], "linestyle": DASHES[j], "label": f"mesh damping {100 * damping:g} %"}
        left.plot(speeds, sweep["normal_load_min"] / static, **style)
        right.plot(speeds, 1e3 * sweep["sliding_reversal"], **style)
    left.axhline(0.0, color=RED, lw=0.9)
    left.text(3000.0, -0.9, "below 0 the teeth\nwould separate", color=RED, fontsize=8.5, va="top")
    left.set(xlabel="pinion speed [rpm]", ylabel="smallest load of a pair over\nthe static mesh force [-]")
    right.set(
        xlabel="pinion speed [rpm]", ylabel="sliding reversed up to this far\nfrom the pitch point [mm]"
    )
    for ax in (left, right):
        legend(ax)
    return svg(figure)


def built_in_report() -> str:
    """The report of the built-in pair, whole, as a page of the site."""
    folder = GENERATED / "pages" / "report"
    report("nasa_28_28", folder, force=True)
    return (folder / "index.html").read_text(encoding="utf-8")


def explore() -> str:
    """The interactive page; its numbers are written beside it."""
    results = compute(lumped.load_gear_pair("nasa_28_28"))
    write_dataset(results.dataset(), GENERATED / "pages" / "explore.nc")
    return render(results, "explore.nc")


FILES: dict[str, Callable[[], str]] = {
    "friction_laws.svg": friction_laws,
    "film.svg": film,
    "multipliers.svg": multipliers,
    "tongues.svg": tongues,
    "torque_law.svg": torque_law,
    "validity.svg": validity,
    "pages/explore.html": explore,
    "pages/report/index.html": built_in_report,
}
