"""The mesh along the path of contact: sliding, film, friction, stiffness, load sharing, losses."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from lumped import Geometry, MeshCycle
from lumped.quasi_static import OptimalRelief
from validation.plots.style import (
    BLACK,
    BLUE,
    DASHES,
    GREEN,
    GREY,
    IN_Y,
    LINES,
    ORANGE,
    PURPLE,
    RED,
    SKY,
    legend,
    legend_above,
    look,
    mark_operation,
    mark_switches,
    new_figure,
    one_panel,
    path_axis,
    path_marks,
    scale_y,
    scaled,
    switches_in_cycles,
    without_jumps,
    write_beside,
)

_POINTS = 801  # of a mesh cycle


def path_figure(g: Geometry, profile: xr.Dataset, thresholds: tuple[float, ...]) -> Figure:
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
        path_axis(ax, g, xi)
    return figure


def friction_laws_figure(g: Geometry, profile: xr.Dataset, chosen: str) -> Figure:
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
        curve = without_jumps(xi, mu, 0.3 * np.ptp(mu))
        ax.plot(*curve, **look(number), linewidth=weight, label=title, zorder=order)
    ax.axhline(0.0, color=GREY, linewidth=0.6)
    path_axis(ax, g, xi)
    ax.set_ylabel("friction coefficient, signed [-]")
    legend_above(ax, 3, letters=True)
    return figure


def stiffness_figure(cycle: MeshCycle) -> Figure:
    """Stiffness of every tooth pair and of the mesh over one mesh cycle, exact at its jumps."""
    figure, ax = one_panel(2.8)
    times, values = [], []
    for segment, (low, high) in enumerate(zip(cycle.edges[:-1], cycle.edges[1:], strict=True)):
        t = np.linspace(low, high, max(2, round(_POINTS * (high - low) / cycle.period)))
        times.append(t / cycle.period)
        values.append(cycle.sample(t, segment).stiffness)
    x, k = np.concatenate(times), np.concatenate(values, axis=1)
    factor = scale_y(ax, "stiffness", "N/m", k.sum(axis=0))
    ax.plot(x, k.sum(axis=0) / factor, color=BLACK, linewidth=1.8, label="all pairs")
    for i, row in enumerate(k):
        shown = np.where(row > 0, row, np.nan)
        ax.plot(x, shown / factor, color=LINES[i], linestyle=DASHES[i + 1], label=f"pair {i}")
    mark_switches(ax, switches_in_cycles(cycle))
    ax.set(xlim=(0.0, 1.0), ylim=(0.0, None), xlabel="time [mesh cycles]")
    legend_above(ax, len(k) + 1, letters=True)
    return figure


_PARTS = (("contact", GREY), ("bending", BLUE), ("shear", SKY), ("axial", ORANGE), ("foundation", GREEN))
_HATCHES = ("", "//", "", "xx", "..")


def stiffness_components_figure(g: Geometry, components: xr.Dataset) -> Figure:
    """Compliance of the parts of a tooth pair, stacked, and the pair's stiffness with ISO's c'.

    ``components``: dataset of ``lumped.stiffness_components``.
    """
    figure, axes = new_figure(1, 2, height=3.1)
    left, right = axes[0]
    xi = 1e3 * components["position"].to_numpy()
    names = components["component"].to_numpy().astype(str)
    compliance = components["compliance"].to_numpy()
    factor = scale_y(left, "compliance", "m/N", compliance.sum(axis=0))
    floor = np.zeros(xi.size)
    for (part, colour), hatch in zip(_PARTS, _HATCHES, strict=True):
        top = floor + compliance[np.char.startswith(names, part)].sum(axis=0) / factor
        style: dict[str, Any] = {"facecolor": colour, "hatch": hatch, "edgecolor": "white", "linewidth": 0.4}
        label = part if part == "contact" else f"{part}, both teeth"
        left.fill_between(xi, floor, top, **style, alpha=0.75, label=label)
        floor = top
    left.set_ylim(0.0, 1.45 * float(floor.max()))
    small = {"loc": "upper center", "fontsize": 7.0, "handlelength": 1.6, "columnspacing": 1.0}
    legend(left, reverse=True, ncols=2, **small)
    stiffness = components["stiffness"].to_numpy()
    factor = scale_y(right, "stiffness", "N/m", stiffness)
    right.plot(xi, stiffness / factor, color=BLACK, label="tooth pair, energy")
    iso = float(components.attrs["iso_single_stiffness"])
    right.axhline(iso / factor, color=RED, linestyle="--", label="ISO 6336-1, c' b")
    for which, colour, dashes in (("pinion", PURPLE, DASHES[2]), ("gear", BLUE, DASHES[3])):
        own = 1.0 / compliance[np.char.endswith(names, which)].sum(axis=0) / factor
        right.plot(xi, own, color=colour, linestyle=dashes, label=f"tooth and body of the {which}")
    right.set_ylim(0.0, 1.45 * right.get_ylim()[1])
    legend(right, loc="upper center", fontsize=7.5)
    for ax in (left, right):
        path_axis(ax, g, xi)
    return figure


def energy_mesh_figure(energy: xr.Dataset) -> Figure:
    """Total potential-energy mesh stiffness over the mesh cycle with its mean and ISO's.

    ``energy``: dataset of ``lumped.mesh_stiffness`` for the energy model.
    """
    figure, ax = one_panel(2.6)
    total = energy["mesh_stiffness"].to_numpy()
    factor = scale_y(ax, "mesh stiffness", "N/m", total)
    largest = float(total.max()) / factor
    curve = without_jumps(energy["phase"].to_numpy(), total / factor, 0.1 * largest)
    ax.plot(*curve, color=BLACK, linewidth=1.8, label="all pairs, energy")
    ax.axhline(energy.attrs["mean"] / factor, color=BLUE, linestyle="-.", label="its mean")
    ax.axhline(energy.attrs["iso_mean"] / factor, color=RED, linestyle="--", label="ISO 6336-1, c_γ b")
    ax.set(xlim=(0.0, 1.0), ylim=(0.0, 1.3 * largest), xlabel="time [mesh cycles after a pair was at A]")
    legend(ax, loc="upper right", ncols=3)
    return figure


def tooth_stiffness_figure(g: Geometry, curves: xr.Dataset) -> Figure:
    """Stiffness of a tooth pair alone over the path of contact by several ways.

    ``curves``: ``curves`` of ``validation.verification.tooth_stiffness.ToothStiffness``.
    """
    figure, ax = one_panel(2.8)
    stiffness = curves["stiffness"]
    factor = scale_y(ax, "stiffness", "N/m", stiffness)
    styles = zip((BLACK, GREY, BLUE, RED), ("-", "-", "--", "-."), strict=True)
    for name, (colour, dashes) in zip(map(str, curves["way"].to_numpy()), styles, strict=True):
        k = stiffness.sel(way=name).to_numpy() / factor
        ax.plot(curves["position"].to_numpy() * 1e3, k, color=colour, linestyle=dashes, label=name)
    path_axis(ax, g)
    ax.set_ylim(0.0, None)
    legend(ax, loc="lower center", ncols=2)
    return figure


def load_sharing_figure(g: Geometry, static: xr.Dataset) -> Figure:
    """Share of one tooth pair in the load over its position, beyond A and D where deflection lets it touch.

    ``static``: dataset of ``lumped.static_transmission_error`` over one mesh cycle.
    """
    figure, ax = one_panel(2.9)
    place = static["position"].to_numpy().ravel()
    order = np.argsort(place)
    place = place[order]
    near = (place > g.L_XA - 0.25 * g.base_pitch) & (place < g.L_XD + 0.25 * g.base_pitch)
    x, torques = 1e3 * place[near], static["torque"].to_numpy()
    for index, torque in enumerate(torques):
        share = static["load_share"].sel(torque=torque).to_numpy().ravel()[order]
        ax.plot(x, share[near], **look(index), label=f"{_written(torque)} N m")
    ax.set(ylim=(0.0, 1.05), xlim=(x[0], x[-1]), ylabel="share of one pair in the load [-]")
    ax.set_xlabel("distance from X along the line of action [mm]")
    mark_switches(ax, path_marks(g), letters=False)
    for letter, value in path_marks(g).items():
        write_beside(ax, letter, (value, 0.02), (2, 0))
    legend_above(ax, min(len(torques), 5))
    return figure


def harris_figure(static: xr.Dataset, harris: xr.Dataset) -> Figure:
    """Curves of static transmission error, and their peak to peak over torque for several flanks.

    ``static``: dataset of ``lumped.static_transmission_error``; ``harris``: ``peak_to_peak`` [m] over
    ``flank`` and ``torque`` [N m]; attribute ``operating_torque``.
    """
    figure, axes = new_figure(1, 2, height=3.3)
    left, right = axes[0]
    phase, te = static["phase"].to_numpy(), static["transmission_error"].to_numpy()
    factor = scale_y(left, "static transmission error", "m", te)
    cycles = np.concatenate([phase, phase + 1.0])
    for index, torque in enumerate(static["torque"].to_numpy()):
        left.plot(cycles, np.tile(te[index], 2) / factor, **look(index), label=f"{_written(torque)} N m")
    left.set(xlim=(0.0, 2.0), ylim=(0.0, 1.45 * float(te.max()) / factor))
    left.set_xlabel("mesh cycles after a pair was at A")
    legend(left, reverse=True, loc="upper right", ncols=2, fontsize=7.5)
    error = harris["peak_to_peak"].to_numpy()
    factor = scale_y(right, "peak to peak", "m", error)
    for index, flank in enumerate(harris["flank"].to_numpy()):
        width = 2.2 if index == 0 else 1.3
        right.plot(harris["torque"], error[index] / factor, **look(index), linewidth=width, label=str(flank))
    mark_operation(right, harris.attrs["operating_torque"], "operating torque")
    top = 1.6 * float(error.max()) / factor if error.max() > 0.0 else 1.0
    right.set(xlim=(0.0, float(harris["torque"].max())), ylim=(0.0, top), xlabel="pinion torque [N m]")
    # Lines run behind it; without a ground they would cross the words.
    box = {"frameon": True, "facecolor": "white", "edgecolor": "none", "framealpha": 1.0}
    legend(right, loc="upper left", fontsize=7.5, **box)
    return figure


def relief_figure(relief: xr.Dataset, optimum: OptimalRelief) -> Figure:
    """Peak to peak static transmission error over amount and length of tip relief, with the optimum.

    ``relief``: dataset of ``lumped.quasi_static.relief_map``; ``optimum``: record of
    ``lumped.optimal_relief``.
    """
    figure, ax = one_panel(3.3)
    values = relief["peak_to_peak"].to_numpy()
    factor, unit = scaled(values, unit="m")
    length, amount = 1e3 * relief["length"].to_numpy(), 1e6 * relief["amount"].to_numpy()
    filled = ax.contourf(length, amount, values / factor, levels=16, cmap="viridis")
    figure.colorbar(filled, ax=ax, label=f"peak to peak [{unit}]")
    best = (1e3 * optimum.length, 1e6 * optimum.amount)
    ax.plot(*best, "o", color="white", markeredgecolor="black")
    write_beside(ax, f"best: {best[1]:.3g} µm over {best[0]:.3g} mm", best, (8, 8), color="white")
    ax.grid(False)
    ax.set_xlabel("length of tip relief along the line of action, both gears [mm]")
    ax.set_ylabel("amount at the tip [µm]")
    return figure


def efficiency_figure(losses: xr.Dataset, chosen: str) -> Figure:
    """Relative loss of the mesh by friction law: closed form, quasi-static, periodic motion.

    ``losses``: ``mesh_efficiency``, ``mesh_efficiency_dynamic`` and ``mesh_efficiency_closed_form`` over
    ``law``.
    """
    laws = [str(name) for name in losses["law"].to_numpy()]
    figure, ax = one_panel(0.9 + 0.4 * max(len(laws), 2))
    place = np.arange(len(laws))
    for name, label, marker, colour, shift in (
        ("mesh_efficiency_closed_form", "mean |µ| times closed form", "s", BLACK, -0.18),
        ("mesh_efficiency", "quasi-static", "o", BLUE, 0.0),
        ("mesh_efficiency_dynamic", "periodic motion", "D", RED, 0.18),
    ):
        loss = 100.0 * (1.0 - losses[name].to_numpy())
        ax.plot(loss, place + shift, marker, markersize=5, color=colour, label=label)
    titles = [str(title) for title in losses["law_title"].to_numpy()]
    ax.set_yticks(place, [t + " (used)" * (n == chosen) for n, t in zip(laws, titles, strict=True)])
    ax.invert_yaxis()
    ax.set(xlim=(0.0, None), xlabel="loss of the mesh over input power [%]", ylabel="friction law")
    legend_above(ax, 3)
    return figure


def sliding_power_figure(
    g: Geometry, quasi_static: xr.Dataset, periodic: xr.Dataset, instants: tuple[xr.Dataset, xr.Dataset]
) -> Figure:
    """Local sliding power of one pair over the path, and instantaneous efficiency over the mesh cycle.

    quasi_static, periodic: datasets of ``lumped.losses.sliding_power_along_path``; ``instants``: datasets
    with ``instantaneous_efficiency`` over ``time``, quasi-static and periodic.
    """
    figure, axes = new_figure(1, 2, height=2.9)
    left, right = axes[0]
    paths = (quasi_static, periodic)
    factor = scale_y(left, "sliding power of one pair", "W", *(path["sliding_power"] for path in paths))
    looks = (("quasi-static", BLUE, "--"), ("periodic motion", RED, "-"))
    for path, instant, (label, colour, dashes) in zip(paths, instants, looks, strict=True):
        style: dict[str, Any] = {"color": colour, "linestyle": dashes, "label": label, "linewidth": 1.2}
        left.plot(1e3 * path["xi"], path["sliding_power"] / factor, **style)
        right.plot(instant["time"] / g.mesh_period, 100.0 * instant["instantaneous_efficiency"], **style)
    path_axis(left, g)
    right.axhline(100.0, color=GREY, linewidth=0.6)
    right.set(xlim=(0.0, 1.0), xlabel="time [mesh cycles]", ylabel="instantaneous efficiency [%]")
    legend_above(right, 2)
    return figure


def _written(torque: float) -> str:
    """A torque in four digits, never as 2e+04."""
    return f"{float(f'{torque:.4g}'):.12g}"
