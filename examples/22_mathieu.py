"""
Does Mathieu's equation come out exactly?
=========================================

x″ + (a − 2q cos 2t) x = 0 grows between the characteristic values b_m(q) and a_m(q), green, which scipy
computes by a method of its own. Stable points have multipliers of modulus one here: the symmetry of the
equation proves it, so that they are neutral.
"""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from scipy.special import mathieu_a, mathieu_b

import floquet
from validation import plot


def system(point: dict[str, float]) -> floquet.SecondOrderSystem:
    """The equation for one a and q."""
    wave = floquet.FourierSeries(np.pi, 0.0, [1.0])  # cos 2t
    return floquet.from_second_order(
        1.0, 0.0, floquet.PeriodicMatrix(point["a"], (wave, -2.0 * point["q"])), np.pi
    )


def compute() -> xr.Dataset:
    """Chart over a and q."""
    axes = {"a": np.linspace(0.1, 5.0, 15), "q": np.linspace(0.2, 2.0, 7)}
    labels = {"a": ("1", "mean stiffness a"), "q": ("1", "half the variation of stiffness, q")}
    return floquet.scan(system, axes, labels=labels)


def draw(result: xr.Dataset) -> Figure:
    """Chart, unstable hatched and neutral with circles, with the exact boundaries over it."""
    figure = plot(result)
    q = np.linspace(0.0, 2.0, 101)
    axes = figure.axes[0]
    for order, value in [(m, mathieu_a) for m in range(3)] + [(m, mathieu_b) for m in range(1, 4)]:
        axes.plot(value(order, q), q, color="tab:green", linewidth=1.5)
    return figure


if __name__ == "__main__":
    draw(compute()).savefig("mathieu.png", dpi=150)
