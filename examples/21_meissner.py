"""
Does Meissner's equation come out exactly?
==========================================

x″ + (δ ± ε) x = 0, the sign changing every half period: two harmonic motions in turn. So the trace of the
monodromy matrix is known by hand, and where it is beyond ±2 vibration grows.
"""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

import floquet

PERIOD = 2.0 * np.pi
EPSILON = 0.4


def system(point: dict[str, float]) -> floquet.SecondOrderSystem:
    """The equation for one δ."""
    sign = floquet.PiecewisePolynomial([0.0, PERIOD / 2, PERIOD], [[1.0], [-1.0]])
    return floquet.from_second_order(
        1.0, 0.0, floquet.PeriodicMatrix(point["delta"], (sign, EPSILON)), PERIOD
    )


def exact_trace(delta: np.ndarray) -> np.ndarray:
    """2 cos p₁ cos p₂ − (ω₁/ω₂ + ω₂/ω₁) sin p₁ sin p₂, ω² = δ ± ε, p = ωT/2 (Meissner 1918)."""
    first = np.sqrt(delta + EPSILON)
    second = np.sqrt(delta - EPSILON)
    p = first * PERIOD / 2
    q = second * PERIOD / 2
    return 2 * np.cos(p) * np.cos(q) - (first / second + second / first) * np.sin(p) * np.sin(q)


def compute() -> xr.Dataset:
    """Multipliers over δ by proven bounds, and the trace by hand."""
    delta = np.linspace(0.5, 4.5, 61)
    labels = {"delta": ("1", "mean stiffness δ")}
    chart = floquet.scan(system, {"delta": delta}, labels=labels, rtol=1e-10)
    return chart.assign(exact=("delta", exact_trace(delta)))


def draw(result: xr.Dataset) -> Figure:
    """Computed trace on the exact one, and where the multipliers say that vibration grows."""
    axes = Figure(figsize=(7, 3.5), layout="constrained").add_subplot()
    delta = result["delta"]
    trace = result["multipliers"].sum("multiplier").real
    axes.plot(delta, result["exact"], label="exact trace")
    axes.plot(delta, trace, ".", markersize=4, label="sum of the multipliers")
    grows = result["verdict"] == -1
    axes.fill_between(
        delta, 0.0, 1.0, where=grows, transform=axes.get_xaxis_transform(), alpha=0.3, label="unstable"
    )
    axes.axhline(2.0, color="0.5", linewidth=0.8)
    axes.axhline(-2.0, color="0.5", linewidth=0.8)
    axes.set(xlabel="mean stiffness δ [-]", ylabel="trace of the monodromy matrix [-]")
    axes.legend()
    return axes.figure


if __name__ == "__main__":
    draw(compute()).savefig("meissner.png", dpi=150)
