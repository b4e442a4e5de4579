"""
Why does the vibration jump at resonance?
=========================================

The vibration of a lightly damped 50/50 pair differs between rising and falling speed. With falling speed the
large motion, in which teeth separate, continues to speeds at which a rising sweep still has the small motion.
The linear model has one motion at each speed. The same equations with unilateral contact have both motions
(grey), and unstable motions between them (dotted).
"""

from collections.abc import Sequence

import xarray as xr
from matplotlib.figure import Figure

import floquet
import lumped
import multibody


def compute(speeds: Sequence[float] = range(2340, 2661, 40)) -> xr.Dataset:
    """Root mean square transmission error for a rising and a falling sweep, beside the linear model's."""
    pair = lumped.load_gear_pair("kahraman_blankenship_50_50").with_(
        friction__law="none", mesh__stiffness={"model": "parabolic", "ramp_length": 2.0}
    )
    settings = {"settle": 40, "cycles": 10, "rtol": 1e-6, "samples_per_cycle": 64}
    up = multibody.speed_sweep(pair, speeds, **settings)
    down = multibody.speed_sweep(pair, speeds[::-1], **settings).sortby("speed")
    linear = lumped.speed_sweep(pair, speeds, samples_per_cycle=64)
    curves = {"rising": up["dte_rms"], "falling": down["dte_rms"], "linear": linear["dte_rms"]}
    branches = floquet.response_branches(pair, (2340.0, 2660.0), [1], seeds=0).dataset
    followed = branches[["speed_rpm", "dte_rms", "stable", "branch"]]
    return xr.merge([followed, xr.Dataset(curves | {"separated": up["separated"]})])


def draw(result: xr.Dataset) -> Figure:
    """The three curves over speed."""
    figure = Figure(figsize=(7, 4), layout="constrained")
    axes = figure.add_subplot()
    for _, one in result[["speed_rpm", "dte_rms", "stable"]].groupby(result["branch"]):
        for is_shown, style in ((one["stable"], "-"), (~one["stable"], ":")):
            axes.plot(one["speed_rpm"], one["dte_rms"].where(is_shown) * 1e6, style, color="0.5")
    for name, style in (("rising", "o"), ("falling", "s"), ("linear", "--")):
        axes.plot(result["speed"], result[name] * 1e6, style, markersize=4, label=name)
    axes.set(xlabel="pinion speed [rpm]", ylabel="transmission error, rms [µm]")
    axes.legend()
    return figure


if __name__ == "__main__":
    draw(compute()).savefig("jump.png", dpi=150)
