"""Picture of a calibration: what is left of the width of each input, and the orders of the first record."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np
from matplotlib.figure import Figure

from lumped.typing import ComplexArray
from validation.plots.style import BLACK, BLUE, GREY, legend, new_figure, scaled
from validation.signals.complex_orders import ComplexOrders

#: Height of a bar, and of the rest of a panel [inch].
_BAR = 0.24
_FRAME = 0.9
#: Height of the panel of orders over that of the bars.
_ORDERS = 2.2


def calibration_figure(
    shares: Mapping[str, float],
    known: Collection[str],
    measured: ComplexOrders,
    fitted: ComplexArray,
    quantity: tuple[str, str],
) -> Figure:
    """Draw the share of its width that the records leave of each input, and measured and fitted orders.

    Bars in blue are inputs that the records know. Dots are the measured amplitudes of one channel, with two
    standard deviations of the noise; crosses are those of the best fit.

    Parameters
    ----------
    shares : input -> share of its width that is left
    known : inputs that the records know
    measured, fitted : orders of the channel, and those of the best fit
    quantity : plain name and SI unit of the channel
    """
    rows = sorted(shares.items(), key=lambda row: -row[1])
    height = _FRAME + _BAR * len(rows) + _ORDERS
    ratios = [_BAR * len(rows) + _FRAME, _ORDERS]
    figure, axes = new_figure(2, 1, height=height, height_ratios=ratios)
    bars, orders = axes[:, 0]
    colours = [BLUE if name in known else GREY for name, _ in rows]
    bars.barh(range(len(rows)), [100.0 * share for _, share in rows], color=colours, height=0.7)
    bars.set_yticks(range(len(rows)), [name for name, _ in rows])
    bars.set_ylabel("uncertain input")
    bars.set_xlim(0.0, 100.0)
    bars.set_xlabel("width that the records leave, % of the width before")
    count = measured.orders.size
    ours = np.abs(fitted)
    words, unit = quantity
    factor, unit = scaled(measured.amplitudes, ours, unit=unit)
    noise = 2.0 * np.sqrt([float(np.trace(measured.block(j))) / 2.0 for j in range(count)])
    orders.errorbar(
        measured.orders, measured.amplitudes / factor, noise / factor, linestyle="none",
        marker="o", color=BLACK, markersize=4.0, label="measured",
    )  # fmt: skip
    orders.plot(measured.orders, ours / factor, "x", color=BLUE, label="best fit")
    orders.set_xlabel("mesh order")
    orders.set_ylabel(f"{words} [{unit}]")
    legend(orders)
    return figure
