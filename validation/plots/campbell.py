"""Campbell diagram: frequencies over speed, orders of the mesh frequency, predicted tongues."""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure

from validation.plots.labels import WHITE_BOX, label_above
from validation.plots.stability import mark_operating_range
from validation.plots.style import BLACK, GREY, IN_X, RED, legend_above, look, new_figure, write_beside

#: Predicted lines up to this order are named.
_NAMED_ORDERS = 2


def campbell_figure(
    diagram: xr.Dataset,
    *,
    operating_rpm: float | None = None,
    operating_range: tuple[float, float] | None = None,
) -> Figure:
    """Frequencies of the Floquet solutions and their growth over pinion speed.

    Parameters
    ----------
    diagram : dataset of ``floquet.gear.campbell.campbell``
    operating_rpm : operating speed, marked [rpm]
    operating_range : speeds of operation [rpm]
    """
    figure, axes = new_figure(2, 1, height=5.2, sharex=True, gridspec_kw={"height_ratios": [2.2, 1.0]})
    top, bottom = axes[:, 0]
    speed = diagram["speed_rpm"].to_numpy()
    frequency = diagram["frequency"].to_numpy() / 1e3
    ceiling = 1.12 * float(frequency.max())
    for index, mode in enumerate(diagram["mode"].to_numpy()):
        top.plot(speed, frequency[:, index], label=f"mode {mode}", **look(index), linewidth=1.6)
        bottom.plot(speed, diagram["decay"].to_numpy()[:, index] / 1e3, **look(index), linewidth=1.6)
    for order, line in zip(
        diagram["mesh_order"].to_numpy(), diagram["mesh_frequency"].to_numpy().T / 1e3, strict=True
    ):
        top.plot(speed, line, color=GREY, linewidth=0.8)
        x = min(speed[-1], speed[-1] * ceiling / line[-1])
        if x > speed[0]:
            place = (x, min(line[-1], ceiling))
            write_beside(top, f"{order}×", place, (-2, -8), ha="right", fontsize=7.5, color=GREY)
    lines = list(zip(*(diagram[name].to_numpy() for name in ("line_speed", "order", "label")), strict=True))
    named = [(float(x), str(label), order) for x, order, label in lines if order <= _NAMED_ORDERS]
    for x, order, _ in lines:
        for ax in (top, bottom):
            ax.axvline(x, color=RED, linewidth=0.8 if order <= _NAMED_ORDERS else 0.3, alpha=0.5, zorder=0.5)
    unstable = diagram["decay"].to_numpy().min(axis=1) < 0.0
    bottom.fill_between(
        speed, 0, 1, where=unstable, transform=bottom.get_xaxis_transform(), color=RED, alpha=0.2, linewidth=0
    )
    bottom.axhline(0.0, color=BLACK, linewidth=0.8)
    top.set(ylim=(0.0, ceiling), xlim=(speed[0], speed[-1]))
    # Sums grow more easily than differences, which only friction makes unstable.
    weights = [1.0 / order - ("-" in label) for _, label, order in named]
    label_above(bottom, [label for _, label, _ in named], [x for x, _, _ in named], weights)
    top.set_ylabel("frequency [kHz]")
    bottom.set_ylabel("decay rate [1/ms]\n(< 0: unstable)")
    bottom.set_xlabel("pinion speed [rpm]; red: predicted tongues (ω$_i$ ± ω$_j$)/k")
    legend_above(top, 3)
    if operating_rpm is not None and speed[0] <= operating_rpm <= speed[-1]:
        for ax in (top, bottom):
            ax.axvline(operating_rpm, color=BLACK, linewidth=1.0, linestyle="--")
        place = (operating_rpm, 1.0)
        write_beside(top, "operating point", place, (3, -3), IN_X, va="top", rotation=90, bbox=WHITE_BOX)
    mark_operating_range(top, operating_range, lower=True)
    top.tick_params(labelbottom=False)
    return figure
