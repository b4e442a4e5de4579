"""Drawings of the theory pages, to the scale of a gear pair where lengths matter."""

from __future__ import annotations

from collections.abc import Callable
from io import StringIO

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle

import lumped
from validation.plots.style import BLACK, BLUE, GREEN, GREY, ORANGE, RED

Point = tuple[float, float]


def svg(figure: Figure) -> str:
    """Text of a figure as SVG; the same figure gives the same text."""
    text = StringIO()
    with mpl.rc_context({"svg.fonttype": "path", "svg.hashsalt": "spurcheck"}):
        figure.savefig(text, format="svg", metadata={"Date": None})
    return text.getvalue()


def canvas(width: float, height: float, columns: int = 1) -> tuple[Figure, list[Axes]]:
    """Empty axes of equal scale, without frames."""
    figure = Figure(figsize=(width, height), layout="constrained")
    axes = list(figure.subplots(1, columns, squeeze=False)[0])
    for ax in axes:
        ax.set_aspect("equal")
        ax.axis("off")
    return figure, axes


def arrow(
    ax: Axes,
    start: Point,
    end: Point,
    label: str,
    colour: str,
    offset: Point = (0.0, 0.0),
    ha: str = "center",
) -> None:
    """An arrow with a label beside its tip, moved by ``offset`` in points."""
    ax.annotate("", end, start, arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 1.6})
    ax.annotate(label, end, offset, textcoords="offset points", color=colour, fontsize=10, ha=ha, va="center")


def line_of_action() -> str:
    """Base and tip circles of the 28/28 pair with X, A, B, P, C, D, Y, and one pair in contact."""
    g = lumped.geometry(lumped.load_gear_pair("nasa_28_28"))
    figure, (left, right) = canvas(7.2, 3.6, 2)
    # x along the line of action from X. The flank of the pinion moves along +x and -y where the pinion's
    # centre is below the line and turns clockwise; the gear's is above and turns the other way.
    length, rb, rg = (1e3 * v for v in (g.L_XY, g.base_radius_pinion, g.base_radius_gear))
    marks = {"A": g.L_XA, "B": g.L_XB, "P": g.L_XP, "C": g.L_XC, "D": g.L_XD}
    for ax in (left, right):
        for centre, base, tip, colour in (
            ((0.0, -rb), rb, 1e3 * g.tip_radius_pinion, BLUE),
            ((length, rg), rg, 1e3 * g.tip_radius_gear, RED),
        ):
            ax.add_patch(Circle(centre, base, fill=False, color=colour, lw=1.3))
            ax.add_patch(Circle(centre, tip, fill=False, color=colour, lw=0.8, ls=(0, (4, 3))))
            ax.plot(*centre, "+", color=colour)
        ax.plot([0, length], [0, 0], color=BLACK, lw=1.3)
    for name, place in {"X": 0.0, **marks, "Y": g.L_XY}.items():
        right.plot(1e3 * place, 0.0, "o", color=BLACK, ms=4)
        below = name in "BCY"
        right.annotate(
            name,
            (1e3 * place, 0),
            (0, -11 if below else 8),
            textcoords="offset points",
            ha="center",
            fontsize=10,
        )
    paper = {"facecolor": "white", "edgecolor": "none", "pad": 1.0}
    xi = 0.4e3 * g.L_XC + 0.6e3 * g.L_XD
    for (start, end), level, label in (
        ((0.0, xi), -5.2, "$\\xi$ = arm $X_p$"),
        ((xi, length), -5.2, "$L_{XY}-\\xi$ = arm $X_g$"),
    ):
        right.annotate("", (start, level), (end, level), arrowprops={"arrowstyle": "<->", "lw": 0.9})
        right.text(0.5 * (start + end), level - 0.5, label, ha="center", va="top", fontsize=9, bbox=paper)
    right.plot([xi, xi], [0, -5.6], color=GREY, lw=0.8, ls=":")
    right.plot(xi, 0, "D", color=GREEN, ms=6, zorder=3)
    right.set(xlim=(-2.5, length + 2.5), ylim=(-9, 5.5))
    left.set(xlim=(-rb - 6, length + rg + 6), ylim=(-2 * rb - 6, 2 * rg + 6))
    left.text(0.0, -rb + 2.5, "pinion", color=BLUE, ha="center", fontsize=9)
    left.text(length, rg + 2.5, "gear", color=RED, ha="center", fontsize=9)
    right.set_title("the line of action enlarged", fontsize=9)
    left.set_title("base circles (solid), tip circles (dashed)", fontsize=9)
    return svg(figure)


def free_body() -> str:
    """Forces and moments on both gears, in recess."""
    figure, (pinion, gear) = canvas(7.2, 4.2, 2)
    contact, load, friction = 0.66, 0.72, 0.5
    for ax, up, colour, radius, title in (
        (pinion, -1.0, BLUE, "$r_{bp}$", "on the pinion"),
        (gear, 1.0, RED, "$r_{bg}$", "on the gear"),
    ):
        ax.add_patch(Circle((0.0, up), 1.0, fill=False, color=colour, lw=1.4))
        ax.plot(0.0, up, "o", color=colour, ms=4)
        ax.plot([-1.3, 1.5], [0, 0], color=GREY, lw=0.8, ls=":")
        ax.plot([0, 0], [up, 0], color=GREY, lw=0.8)
        ax.text(0.05, -0.62 if up < 0 else 0.3, radius, ha="left", va="center", fontsize=10, color=GREY)
        ax.set_title(title, fontsize=10)
        # The bearing acts on the centre against displacement and velocity along x and y.
        arrow(ax, (0.0, up), (-0.4, up), "$K x+\\ldots\\dot x$", GREEN, (-14, 11))
        arrow(ax, (0.0, up), (0.0, up - 0.4), "$K y+\\ldots\\dot y$", GREEN, (6, 6), "left")
    arrow(pinion, (contact, 0), (contact - load, 0), "$N_i$", ORANGE, (-4, 9))
    arrow(pinion, (contact, 0), (contact, friction), "$F_i=\\mu_i N_i$", BLACK, (6, 4), "left")
    arrow(gear, (-contact, 0), (load - contact, 0), "$N_i$", ORANGE, (6, -9))
    arrow(gear, (-contact, 0), (-contact, -friction), "$F_i$", BLACK, (12, 0))
    _arm(pinion, 0.0, contact, -0.14, "$X_{pi}=\\xi_i$")
    _arm(gear, -contact, 0.0, 0.14, "$X_{gi}=L_{XY}-\\xi_i$")
    for ax, up, running, torque, colour in (
        (pinion, -1.0, "$\\Omega_p$", "$T_p$", BLUE),
        (gear, 1.0, "$\\Omega_g$", "$T_g$", RED),
    ):
        # Both torques turn clockwise: the pinion runs that way, the gear runs against its brake.
        _turn(ax, (0.0, up), 0.56, torque, colour, clockwise=True)
        _turn(ax, (0.0, up), 0.8, running, GREY, clockwise=ax is pinion)
        _axes(ax, (1.0, 0.75 if ax is pinion else -1.15))
    pinion.set(xlim=(-1.35, 1.6), ylim=(-2.1, 1.3))
    gear.set(xlim=(-1.35, 1.6), ylim=(-1.3, 2.1))
    return svg(figure)


def _arm(ax: Axes, start: float, end: float, level: float, label: str) -> None:
    ax.annotate("", (start, level), (end, level), arrowprops={"arrowstyle": "<->", "lw": 0.9, "color": GREY})
    above = level > 0
    ax.text(
        end if above else start + 0.06, level + (0.05 if above else -0.05), label,
        ha="right" if above else "left", va="bottom" if above else "top", fontsize=10, color=GREY,
    )  # fmt: skip


def _turn(ax: Axes, centre: Point, radius: float, label: str, colour: str, *, clockwise: bool) -> None:
    """A curved arrow on the far side of the gear's centre from the line of action."""
    far = 1.0 if centre[1] > 0 else -1.0
    angles = np.deg2rad(far * np.linspace(40.0, 140.0, 60))
    # With far = +1 rising angles run counter-clockwise, with far = -1 clockwise.
    if (far > 0) == clockwise:
        angles = angles[::-1]
    x, y = centre[0] + radius * np.cos(angles), centre[1] + radius * np.sin(angles)
    ax.plot(x, y, color=colour, lw=1.4)
    ax.annotate(
        "", (x[-1], y[-1]), (x[-4], y[-4]), arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 1.4}
    )
    ax.annotate(label, (x[-1], y[-1]), (8 * np.sign(x[-1]), 0), textcoords="offset points", color=colour,
                fontsize=10, ha="center", va="center")  # fmt: skip


def _axes(ax: Axes, origin: Point) -> None:
    x, y = origin
    arrow(ax, origin, (x + 0.42, y), "$x$", GREY, (7, 0))
    arrow(ax, origin, (x, y + 0.42), "$y$", GREY, (0, 7))


def actual_line() -> str:
    """Nominal and actual line of action where the centres have moved, strongly enlarged."""
    figure, (ax,) = canvas(6.4, 3.8)
    g = lumped.geometry(lumped.load_gear_pair("nasa_28_28"))
    r, s = g.base_radius_pinion, g.base_radius_gear
    nominal = (np.array([0.0, -r]), np.array([g.L_XY, s]))
    moved = (nominal[0] + 1e-3 * np.array([-2.4, 1.2]), nominal[1] + 1e-3 * np.array([2.6, 2.2]))
    for centres, style, name in ((nominal, ":", "nominal"), (moved, "-", "actual")):
        e, length = _tangent(*centres, r + s)
        n = np.array([-e[1], e[0]])
        start, end = centres[0] + r * n, centres[1] - s * n
        for centre, radius, colour in zip(centres, (r, s), (BLUE, RED), strict=True):
            ax.add_patch(Circle(1e3 * centre, 1e3 * radius, fill=False, color=colour, lw=1.2, ls=style))
            ax.plot(*(1e3 * centre), "o" if style == "-" else "x", color=colour, ms=5)
        ax.plot(
            *(1e3 * np.array([start, end])).T, color=BLACK, lw=1.4, ls=style, label=f"{name} line of action"
        )
        if style == "-":
            ax.plot(*(1e3 * np.array([centres[0], start])).T, color=GREY, lw=0.8)
            ax.plot(*(1e3 * np.array([centres[1], end])).T, color=GREY, lw=0.8)
            for point, label, offset in ((start, "X", (-8, 6)), (end, "Y", (8, -7))):
                ax.annotate(label, 1e3 * point, offset, textcoords="offset points", ha="center", va="center")
            tail, tip = (tuple(1e3 * (start + part * length * e)) for part in (0.25, 0.45))
            arrow(ax, tail, tip, "$e$", GREEN, (-2, 9))
            ax.annotate("$c_p$", 1e3 * centres[0], (12, -4), textcoords="offset points", color=BLUE)
            ax.annotate("$c_g$", 1e3 * centres[1], (8, 4), textcoords="offset points", color=RED)
    ax.legend(loc="lower right", frameon=False, fontsize=9)
    ax.set(xlim=(-48, 112), ylim=(-50, 62))
    return svg(figure)


def _tangent(pinion: np.ndarray, gear: np.ndarray, radii: float) -> tuple[np.ndarray, float]:
    """Unit vector and length of the crossed tangent, d = L e + R J e (drive flank)."""
    d = gear - pinion
    length = float(np.sqrt(d @ d - radii**2))
    turned = np.array([-d[1], d[0]])
    return (length * d - radii * turned) / (d @ d), length


FILES: dict[str, Callable[[], str]] = {
    "line_of_action.svg": line_of_action,
    "free_body.svg": free_body,
    "actual_line.svg": actual_line,
}
