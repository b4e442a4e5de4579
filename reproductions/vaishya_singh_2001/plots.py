"""Figures: the coefficient k(t), the motions by both loads of friction, and the chart over speed and mu."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

import floquet
from reproductions.vaishya_singh_2001.gears import MU, Gears, with_friction
from validation.plots.stability import stability_figure
from validation.plots.style import legend_above, look, new_figure

#: Pair of the figures: its arms of friction change most.
_NAME = "fzg_c"


def coefficients_and_motions(ratio: float = 0.37) -> Figure:
    """k(t) with and without friction, and delta by friction of the dynamic and of the mean load."""
    gears = Gears(_NAME)
    models = {"μ = 0": gears.at_ratio(ratio, mu=0.0), f"μ = {MU:g}": gears.at_ratio(ratio)}
    figure, axes = new_figure(rows=2, height=4.6, sharex=True)
    upper, lower = axes[:, 0]
    for number, (label, model) in enumerate(models.items()):
        time = model.period * np.arange(2048) / 2048
        upper.plot(time / model.period, model.stiffness(time) / 1e6, label=label, **look(number))
    upper.set(ylabel="k [N/µm]")
    legend_above(upper, 2)
    rough = models[f"μ = {MU:g}"]
    forms = {
        "without friction": models["μ = 0"].closed_form(),
        "friction of the mean load": rough.closed_form(friction_load="mean"),
        "friction of the dynamic load": rough.closed_form(damper_friction=False),
    }
    for number, (label, form) in enumerate(forms.items()):
        time = form.period * np.arange(2048) / 2048
        lower.plot(time / form.period, 1e6 * form.motion(time).dte, label=label, **look(number))
    lower.set(xlabel="time [mesh cycles]", ylabel="δ [µm]", xlim=(0.0, 1.0))
    legend_above(lower, 3)
    return figure


def chart_over_friction() -> Figure:
    """Stability over speed and friction coefficient, mesh damping 0.2 %."""
    gears = Gears(_NAME)
    pair = with_friction(_NAME, MU, 0.002).with_(speed=gears.speed_rpm(1.0))
    axes = {
        "speed_rpm": np.linspace(gears.speed_rpm(0.45), gears.speed_rpm(2.4), 401),
        "friction_coefficient": np.linspace(0.0, 0.3, 61),
    }
    chart = floquet.single_degree_chart(pair, axes, stiffness="rectangular", refine=False)
    return stability_figure(chart)


#: Name of a picture -> function that draws it.
DRAW = {"motions": coefficients_and_motions, "chart": chart_over_friction}
