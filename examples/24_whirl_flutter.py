"""
When does a propeller with two blades flutter?
==============================================

A propeller on a soft nacelle can whirl ever wider. With two blades only its equations are periodic.
"""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from scipy.integrate import quad

import floquet
from validation import plot

R, OMEGA, MU, A = 0.152, 40.0, 1.1, 0.25  # m, rad/s, V/(Omega R), hub ahead of the pivot by A R; assumed
NACELLE, BLADES, DAMPING = 1.265e-4, 1.03e-4, 1e-3  # kg m^2, N m s
LIFT = 0.5 * 1.225 * 4 * 0.026 * 2 * np.pi * OMEGA * R**4  # rho c c_l' Omega R^4/2 of all blades
A1, A2, A3 = (quad(lambda x, m=m: MU ** (2 - m) * x ** (2 * m) / np.hypot(MU, x), 0, 1)[0] for m in range(3))
ONE, TURN = np.eye(2), OMEGA * np.array([[0, -1], [1, 0]])  # rate in space: on the blades + TURN angle


def two_blades(stiffness: dict[str, float]) -> floquet.SecondOrderSystem:
    """Angles about the blades' line and across it; strip theory on each blade."""
    drag = DAMPING * ONE + LIFT * np.array([[A**2 * A1, -A * A2], [-A * A2, A3]])
    wind = LIFT * OMEGA * MU * np.array([[A * A1, 0.0], [-A2, 0.0]])
    mean = 0.5 * (stiffness["pitch"] + stiffness["yaw"])
    vary = 0.5 * (stiffness["pitch"] - stiffness["yaw"])
    K = drag @ TURN - wind + mean * ONE + OMEGA**2 * np.diag([-NACELLE, BLADES - NACELLE])
    cos, sin = (floquet.FourierSeries(np.pi / OMEGA, 0.0, *row) for row in ([[vary]], [[], [-vary]]))
    mount = floquet.PeriodicMatrix(K, (cos, np.diag([1.0, -1.0])), (sin, ONE[::-1]))
    M = np.diag([NACELLE, NACELLE + BLADES])
    C = drag + 2.0 * NACELLE * TURN
    return floquet.from_second_order(M, C, mount, np.pi / OMEGA)


def growth_with_many_blades(pitch: float, yaw: float) -> float:
    """Largest growth [1/s], same area of blades all round (Houbolt and Reed, J. Aerospace Sci. 29, 1962)."""
    C = (DAMPING + 0.5 * LIFT * (A3 + A**2 * A1)) * ONE - BLADES * TURN
    K = np.diag([pitch, yaw]) - 0.5 * LIFT * MU * (OMEGA * A * A1 * ONE - A2 * TURN)
    state = np.vstack([np.eye(2, 4, 2), -np.hstack([K, C]) / (NACELLE + 0.5 * BLADES)])
    return float(np.linalg.eigvals(state).real.max())


def compute() -> xr.Dataset:
    """Chart over pitch and yaw stiffness of the mount."""
    values = np.linspace(0.05, 0.65, 9)
    labels = {name: ("N m/rad", f"{name} stiffness") for name in ("pitch", "yaw")}
    chart = floquet.scan(two_blades, dict.fromkeys(labels, values), labels=labels)
    return chart.assign(many=(tuple(labels), np.vectorize(growth_with_many_blades)(values[:, None], values)))


def draw(result: xr.Dataset) -> Figure:
    """Two blades: unstable mounts are hatched; many blades: those inside the dashed line."""
    figure = plot(result)
    figure.axes[0].contour(result["pitch"], result["yaw"], result["many"].T, levels=[0.0], linestyles="--")
    return figure


if __name__ == "__main__":
    draw(compute()).savefig("whirl_flutter.png", dpi=150)
