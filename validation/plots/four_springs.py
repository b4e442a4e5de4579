"""Four springs, shafts with their modes, and the machine, over speed."""

from __future__ import annotations

from matplotlib.figure import Figure

from validation.plots.style import BLACK, legend_outside, look, mark_operation, new_figure, scaled
from validation.validity.four_springs import LIMITS, MODELS, FourSprings

#: Quantity -> words of its axis.
_PANELS = {
    "dte": "transmission error,\npeak to peak",
    "force_p": "bearing forces, pinion,\nalong the LOA, p-p",
    "spectral_radius": "largest multiplier",
}


def four_springs_figure(found: FourSprings, operating_rpm: float) -> Figure:
    """Transmission error, bearing forces and largest multiplier of all models over speed.

    Shaded: speeds at which the springs of the parameters do not hold.

    Parameters
    ----------
    found : of ``four_springs``
    operating_rpm : marked [rpm]
    """
    figure, axes = new_figure(len(_PANELS), 1, height=5.6, sharex=True)
    speed = found.over_speed["speed"].to_numpy()
    handles = []
    for ax, (name, words) in zip(axes[:, 0], _PANELS.items(), strict=True):
        values = found.over_speed[name]
        factor, unit = (1.0, "-")
        if name != "spectral_radius":
            factor, unit = scaled(values.sel(model="shafts").to_numpy(), unit=str(values.attrs["units"]))
        lines = []
        for i, model in enumerate(("shafts", "springs", "condensed", "dynamic")):
            lines += ax.plot(speed, values.sel(model=model) / factor, **look(i), label=MODELS[model])
        machine = values.sel(model="machine") / factor  # it has no multipliers
        lines += ax.plot(speed, machine, "o", color=BLACK, markersize=4, label=MODELS["machine"])
        for low, high in found.ranges(hold=False):
            ax.axvspan(low, high, color="#f3ddd3", zorder=0, linewidth=0)
        top = float(values.sel(model=["shafts", "machine"]).max()) / factor
        # Springs may be far off: what the shafts do fills the panel.
        ax.set(ylabel=f"{words} [{unit}]", ylim=(0.0, 1.6 * top), xlim=(speed[0], speed[-1]))
        handles = lines
    mark_operation(axes[0, 0], operating_rpm, "operating point")
    axes[-1, 0].set_xlabel(
        f"pinion speed [rpm]; shaded: the given springs are off by more than {LIMITS[1]:.0%}"
    )
    legend_outside(figure, handles, 2)
    return figure
