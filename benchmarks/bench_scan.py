"""Charts of any system by `floquet.scan`, beside DOP853 on the matrix and RK4 of all nodes at once in numpy.

    python -m benchmarks.bench_scan [--nodes 2000] [--largest 1000000]    prints the table

Times are of the processor, in the same run, so that other work on the machine hardly enters; ratios are the
result. RK4 has as many steps of a period, a power of two, as the wanted error needs. Errors are of the sum of
the multipliers, the trace, which is smooth where two multipliers meet; the reference is `scan` with proven
bounds at rtol 1e-11.
"""

from __future__ import annotations

import argparse
import math
import os
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from scipy.integrate import solve_ivp

from floquet import FourierSeries, PeriodicMatrix, PeriodicSystems, SecondOrderSystem, from_second_order, scan

#: Mean stiffness and shape of its variation of one oscillator, and of three.
OSCILLATORS = (
    (np.array([[3.0]]), np.array([[1.0]])),
    (np.diag([1.0, 2.9, 9.6]), np.array([[1.0, 0.5, -0.3], [0.5, -0.8, 0.6], [-0.3, 0.6, 0.4]])),
)


def oscillators(mean: np.ndarray, shape: np.ndarray) -> Callable[[dict[str, float]], SecondOrderSystem]:
    """The family x'' + (mean + depth shape cos(frequency t)) x = 0."""
    none = np.zeros_like(mean)

    def at(point: dict[str, float]) -> SecondOrderSystem:
        period = 2.0 * math.pi / point["frequency"]
        wave = FourierSeries(period, 0.0, [point["depth"]])
        return from_second_order(np.eye(len(mean)), none, PeriodicMatrix(mean, (wave, shape)), period)

    return at


def monodromy_by_solver(mean: np.ndarray, shape: np.ndarray, point: dict[str, float]) -> np.ndarray:
    """Monodromy matrix of `oscillators` by DOP853 on the matrix."""
    m = len(mean)

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        X = y.reshape(2 * m, 2 * m)
        K = mean + point["depth"] * math.cos(point["frequency"] * t) * shape
        return np.concatenate([X[m:], -K @ X[:m]]).ravel()

    period = 2.0 * math.pi / point["frequency"]
    end = solve_ivp(rates, (0.0, period), np.eye(2 * m).ravel(), method="DOP853", rtol=1e-9, atol=1e-11)
    return np.asarray(end.y[:, -1].reshape(2 * m, 2 * m))


def in_one_call(mean: np.ndarray, shape: np.ndarray) -> Callable[[dict[str, np.ndarray]], PeriodicSystems]:
    """The family `oscillators` as arrays of its parameters."""
    m = len(mean)

    def at(points: dict[str, np.ndarray]) -> PeriodicSystems:
        def A(phases: np.ndarray) -> np.ndarray:
            out = np.zeros((points["depth"].size, phases.size, 2 * m, 2 * m))
            out[..., :m, m:] = np.eye(m)
            depth = points["depth"][:, None] * np.cos(2.0 * np.pi * phases)
            out[..., m:, :m] = -mean - depth[..., None, None] * shape
            return out

        return PeriodicSystems(A, 2.0 * np.pi / points["frequency"])

    return at


def matrices_by_rk4(systems: PeriodicSystems, count: int, steps: int, states: int) -> np.ndarray:
    """Monodromy matrices (count, n, n) by the classical Runge-Kutta method, all nodes in each operation."""
    h = (np.asarray(systems.period) / steps)[:, None, None]
    X = np.broadcast_to(np.eye(states), (count, states, states)).copy()
    A = np.asarray(systems.A(np.arange(2 * steps + 1) / (2 * steps)))
    for k in range(steps):
        first, middle, last = (A[:, 2 * k + j] for j in range(3))
        slope_1 = first @ X
        slope_2 = middle @ (X + 0.5 * h * slope_1)
        slope_3 = middle @ (X + 0.5 * h * slope_2)
        slope_4 = last @ (X + h * slope_3)
        X += h / 6.0 * (slope_1 + 2.0 * slope_2 + 2.0 * slope_3 + slope_4)
    return X


class Timed(NamedTuple):
    """A result, and processor seconds of its computation."""

    result: Any
    seconds: float


def timed(call: Callable[[], Any]) -> Timed:
    """Run a call and measure its processor time."""
    start = time.process_time()
    result = call()
    return Timed(result, time.process_time() - start)


def row(*cells: str) -> None:
    """Print a row of the table."""
    print("| " + " | ".join(cells) + " |", flush=True)


def points_of(axes: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Parameters of all nodes of a grid."""
    grid = np.meshgrid(*axes.values(), indexing="ij")
    return {name: values.ravel() for name, values in zip(axes, grid, strict=True)}


def largest_error(multipliers: np.ndarray, exact: np.ndarray) -> float:
    """Largest error of the trace over all nodes, of multipliers (nodes, n)."""
    return float(np.abs(multipliers.sum(axis=1) - exact.sum(axis=1)).max())


def compared(mean: np.ndarray, shape: np.ndarray, nodes: int) -> None:
    """One family by each method."""
    side = math.isqrt(nodes)
    axes = {"frequency": np.linspace(0.8, 5.0, side), "depth": np.linspace(0.05, 0.6, side)}
    few = {name: values[:2] for name, values in axes.items()}
    single, together = oscillators(mean, shape), in_one_call(mean, shape)
    states = 2 * len(mean)
    exact = scan(single, axes, rtol=1e-11)["multipliers"].to_numpy().reshape(-1, states)
    points = points_of(axes)
    some = range(0, side * side, max(1, side * side // 60))
    solved = timed(
        lambda: [
            monodromy_by_solver(mean, shape, {name: float(v[k]) for name, v in points.items()}) for k in some
        ]
    )
    base = solved.seconds / len(some)
    error = largest_error(np.linalg.eigvals(np.array(solved.result)), exact[list(some)])
    results = [("DOP853 on the matrix, rtol 1e-9", base, error, "estimate: none")]
    for title, call, bounds in (
        ("scan, one by one", lambda axes: scan(single, axes), "proven"),
        ("scan, batched", lambda axes: scan(together, axes, batched=True), "estimate"),
    ):
        call(few)  # compiled code is loaded
        chart: Timed = timed(lambda call=call: call(axes))
        multipliers = chart.result["multipliers"].to_numpy().reshape(-1, states)
        results.append((title, chart.seconds / side**2, largest_error(multipliers, exact), bounds))
    for wanted in (1e-4, 1e-7):
        results.append(rk4_to(wanted, together(points), exact, states))
    for title, seconds, error, bounds in results:
        row(
            f"{states} states: {title}", f"{seconds * 1e3:.4f} ms", f"{seconds / base:.5f}", f"{error:.0e}",
            bounds,
        )  # fmt: skip


def rk4_to(
    wanted: float, systems: PeriodicSystems, exact: np.ndarray, states: int
) -> tuple[str, float, float, str]:
    """RK4 with as many steps, a power of two, as the wanted error of the trace needs."""

    def multipliers(steps: int) -> np.ndarray:
        return np.linalg.eigvals(matrices_by_rk4(systems, len(exact), steps, states))

    for steps in 2 ** np.arange(4, 15):
        run = timed(lambda steps=steps: multipliers(int(steps)))
        error = largest_error(run.result, exact)
        if error <= wanted:
            break
    return f"RK4 in numpy, {steps} steps", run.seconds / len(exact), error, "none"


def child(which: int, nodes: int, store: str) -> list[float]:
    """Processor time a node [s], peak memory [MB] and memory before the chart [MB], of another process."""
    command = [sys.executable, "-m", "benchmarks.bench_scan", "--child", str(which), str(nodes), store]
    run = subprocess.run(command, env=dict(os.environ), check=True, capture_output=True, text=True)
    return [float(word) for word in run.stdout.split()]


def measured(which: int, nodes: int, store: str) -> None:
    """Print what `child` returns."""
    import resource

    def peak() -> float:
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3

    mean, shape = OSCILLATORS[which]
    family = in_one_call(mean, shape)
    side = math.isqrt(nodes)
    axes = {"frequency": np.linspace(0.8, 5.0, side), "depth": np.linspace(0.05, 0.6, side)}
    scan(family, {name: values[:30] for name, values in axes.items()}, batched=True)
    before = peak()
    chart: Timed = timed(lambda: scan(family, axes, batched=True, store=store))
    assert isinstance(chart.result, xr.Dataset)
    print(chart.seconds / side**2, peak(), before, chart.result.nbytes / 1e6)


def sizes(largest: int) -> None:
    """Time a node and peak memory over the number of nodes."""
    row("batched nodes", "ms/node", "peak above the start, MB", "result, MB")
    row("---", "---", "---", "---")
    for which, store in ((0, "all"), (1, "radius")):
        nodes = 10_000
        while nodes <= largest:
            seconds, peak, before, result = child(which, nodes, store)
            states = 2 * len(OSCILLATORS[which][0])
            row(
                f"{nodes:.0e}, {states} states, store {store}", f"{seconds * 1e3:.4f}",
                f"{peak - before:.0f}", f"{result:.0f}",
            )  # fmt: skip
            nodes *= 10


def main(words: Sequence[str] | None = None) -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--nodes", type=int, default=2000, help="nodes of the charts that are compared")
    parser.add_argument("--largest", type=int, default=1_000_000, help="nodes of the largest chart")
    parser.add_argument("--child", nargs=3, help=argparse.SUPPRESS)
    arguments = parser.parse_args(words)
    if arguments.child:
        which, nodes, store = arguments.child
        measured(int(which), int(nodes), store)
        return
    row("method", "a node", "of DOP853", "largest error", "bounds")
    row("---", "---", "---", "---", "---")
    for mean, shape in OSCILLATORS:
        compared(mean, shape, arguments.nodes)
    sizes(arguments.largest)


if __name__ == "__main__":
    main()
