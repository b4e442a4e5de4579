"""Picture of a calibration: what is left of the width of each input, and the first channel beside its fit."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from matplotlib.figure import Figure

from validation.plots.style import BLACK, BLUE, GREY, legend, new_figure, scaled
from validation.signals.fitted import Fitted

#: Height of a bar, and of the rest of a panel [inch].
_BAR = 0.24
_FRAME = 0.9
#: Height of the panel of orders over that of the bars.
_ORDERS = 3.0


def calibration_figure(shares: Mapping[str, float], known: Collection[str], channel: Fitted) -> Figure:
    """Draw the share of its width that the records leave of each input, and measured and fitted numbers.

    Bars in blue are inputs that the records know. Dots are the measured numbers of one channel, with two
    standard deviations of the noise; crosses are those of the best fit.

    Parameters
    ----------
    shares : input -> share of its width that is left
    known : inputs that the records know
    channel : numbers of the channel, and those of the best fit
    """
    rows = sorted(shares.items(), key=lambda row: -row[1])
    height = _FRAME + _BAR * len(rows) + _ORDERS
    ratios = [_BAR * len(rows) + _FRAME, _ORDERS]
    figure, axes = new_figure(2, 1, height=height, height_ratios=ratios)
    bars, numbers = axes[:, 0]
    colours = [BLUE if name in known else GREY for name, _ in rows]
    bars.barh(range(len(rows)), [100.0 * share for _, share in rows], color=colours, height=0.7)
    bars.set_yticks(range(len(rows)), [name for name, _ in rows])
    bars.set_ylabel("uncertain input")
    bars.set_xlim(0.0, 100.0)
    bars.set_xlabel("width that the records leave, % of the width before")
    factor, unit = scaled(channel.measured, channel.fitted, unit=channel.unit)
    numbers.errorbar(
        channel.places, channel.measured / factor, 2.0 * channel.noise / factor, linestyle="none",
        marker="o", color=BLACK, markersize=4.0, label="measured",
    )  # fmt: skip
    numbers.plot(channel.places, channel.fitted / factor, "x", color=BLUE, label="best fit")
    numbers.set_xlabel(channel.axis)
    numbers.set_ylabel(f"{channel.words} [{unit}]")
    legend(numbers)
    return figure
