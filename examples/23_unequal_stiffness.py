"""
Between which speeds is a shaft of two stiffnesses unstable?
============================================================

A flat or a keyway gives a shaft two stiffnesses that turn with it. Seen from the ground its stiffness changes
twice a turn, and between its two critical speeds a disc without damping whirls ever wider.
"""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

import floquet

MASS, SOFT, STIFF = 10.0, 0.9e6, 1.1e6  # kg, N/m
CRITICAL = np.sqrt(np.array([SOFT, STIFF]) / MASS)  # rad/s


def system(point: dict[str, float]) -> floquet.SecondOrderSystem:
    """Disc on a light shaft, seen from the ground, with damping by the air."""
    half = np.pi / point["speed"]  # the stiffness repeats after half a turn
    mean = 0.5 * (STIFF + SOFT)
    vary = 0.5 * (STIFF - SOFT)
    cos = floquet.FourierSeries(half, 0.0, [1.0])
    sin = floquet.FourierSeries(half, 0.0, [], [1.0])
    turning = (cos, vary * np.diag([1.0, -1.0])), (sin, vary * np.array([[0.0, 1.0], [1.0, 0.0]]))
    shaft = floquet.PeriodicMatrix(mean * np.eye(2), *turning)
    damping = 2.0 * point["ratio"] * np.sqrt(mean * MASS) * np.eye(2)
    return floquet.from_second_order(MASS * np.eye(2), damping, shaft, half)


def exact_growth(speed: np.ndarray) -> np.ndarray:
    """Growth s [1/s] without damping, turning with the shaft: (ω₁² − Ω² + s²)(ω₂² − Ω² + s²) + 4Ω²s² = 0."""
    first = CRITICAL[0] ** 2 - speed**2
    second = CRITICAL[1] ** 2 - speed**2
    half = 0.5 * (first + second + 4.0 * speed**2)
    return np.sqrt(np.maximum(np.sqrt(half**2 - first * second) - half, 0.0))


def compute() -> xr.Dataset:
    """Growth over speed for three damping ratios, and the exact one without damping."""
    axes = {"ratio": [0.0, 0.02, 0.06], "speed": np.linspace(280.0, 350.0, 26)}
    labels = {"ratio": ("1", "damping ratio"), "speed": ("rad/s", "speed of the shaft")}
    chart = floquet.scan(system, axes, labels=labels, rtol=1e-10)
    growth = np.log(chart["spectral_radius"]) * chart["speed"] / np.pi
    return chart.assign(growth=growth, exact=("speed", exact_growth(chart["speed"].to_numpy())))


def draw(result: xr.Dataset) -> Figure:
    """Growth over speed, with the critical speeds."""
    axes = Figure(figsize=(7, 3.5), layout="constrained").add_subplot()
    for ratio in result["ratio"].to_numpy():
        axes.plot(result["speed"], result["growth"].sel(ratio=ratio), label=f"damping ratio {ratio:g}")
    axes.plot(result["speed"], result["exact"], "k:", label="exact, undamped")
    axes.axhline(0.0, color="0.5", linewidth=0.8)
    axes.set(xlabel="speed of the shaft [rad/s]", ylabel="growth [1/s], unstable above 0")
    axes.legend()
    return axes.figure


if __name__ == "__main__":
    draw(compute()).savefig("unequal_stiffness.png", dpi=150)
