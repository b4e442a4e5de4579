"""
What does a gear mesh do to my ROSS rotors?
===========================================

ROSS makes finite elements of shafts on bearings. A mesh joins two of them and excites the mode at 4544 Hz.
"""

from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from scipy.linalg import block_diag, eigh

import floquet
import lumped

PAIR = lumped.load_gear_pair("nasa_28_28")
PAIR = PAIR.with_(mesh__contact="prescribed", mesh__relief="ignored", mesh__damping_ratio=0.002)


def over_time(cycle, law: str) -> floquet.PiecewisePolynomial:
    """Sum of a law over all tooth pairs as polynomials of degree 8 between its breaks, by values there."""
    u = 0.5 - 0.5 * np.cos(np.pi * (np.arange(9) + 0.5) / 9)
    width = np.diff(cycle.breaks)[:, None]
    values = getattr(cycle.sample((cycle.breaks[:-1, None] + width * u).ravel()), law).sum(axis=0)
    rows = np.linalg.solve(np.vander(u, increasing=True), values.reshape(-1, 9).T).T
    return floquet.PiecewisePolynomial(cycle.breaks, rows / width ** np.arange(9))


def joined(pair, M, C, K, stations, modes: int = 9, angle: float = 0.0) -> floquet.SecondOrderSystem:
    """Rotors and mesh; stations: x, y and rotation of the pinion and of the gear, which is at this angle."""
    cycle = lumped.mesh_cycle(pair)
    g = pair.geometry
    push = 0.5 * np.pi - g.operating_pressure_angle + angle
    v = np.zeros(len(M))
    v[stations[0]] = np.cos(push), np.sin(push), g.base_radius_pinion
    v[stations[1]] = -np.cos(push), -np.sin(push), g.base_radius_gear
    squares, shapes = eigh(K + cycle.mean_stiffness * np.outer(v, v), M)
    T = shapes[:, squares > 1e-9 * squares[-1]][:, :modes]  # free motions meet no spring
    M, C, K, mesh = T.T @ M @ T, T.T @ C @ T, T.T @ K @ T, np.outer(v @ T, v @ T)
    C = floquet.PeriodicMatrix(C, (over_time(cycle, "damping"), mesh))
    K = floquet.PeriodicMatrix(K, (over_time(cycle, "stiffness"), mesh))
    return floquet.from_second_order(M, C, K, cycle.period)


def on_shafts(rpm: float) -> floquet.SecondOrderSystem:
    """Shafts of 30 mm, 240 mm between bearings of 2e8 N/m, gears at node 2, turning opposite ways."""
    # M(), C(0), K(0) and G() of ross.Rotor (2.3.0).
    with np.load(Path(on_shafts.__code__.co_filename).with_name("25_rotor.npz")) as file:
        M, C, K, G = (file[name] for name in "MCKG")
    stations, G = np.add.outer([0, len(M)], [12, 13, 17]), np.pi / 30.0 * rpm * G
    rotors = block_diag(M, M), block_diag(C + G, C - G), block_diag(K, K)
    return joined(PAIR.with_(operating__pinion_speed=f"{rpm} rpm"), *rotors, stations)


def compute() -> xr.Dataset:
    """Spectral radius over speed."""
    return floquet.scan(lambda at: on_shafts(at["speed_rpm"]), {"speed_rpm": np.linspace(18e3, 21e3, 9)})


def draw(result: xr.Dataset) -> Figure:
    """Show the range of speeds in which vibration grows."""
    axes = Figure(figsize=(7, 3.5), layout="constrained").add_subplot()
    axes.set(xlabel="pinion speed [rpm]", ylabel="spectral radius [-], unstable above 1")
    axes.plot(result["speed_rpm"], result["spectral_radius"], marker=".")
    axes.axhline(1.0, color="0.5", linewidth=0.8)
    return axes.figure


if __name__ == "__main__":
    draw(compute()).savefig("gears_on_rotors.png", dpi=150)
