"""The Floquet engine beside general solvers of the same run: rates, accuracy, memory, compile time.

    python -m benchmarks.bench_floquet [--size 400] [--pairs 200]    prints the table
    pytest benchmarks/bench_floquet.py --benchmark-only              the rates alone, by pytest-benchmark

Rates are per second of processor time, times the cores of the machine, so that other work on the machine does
not enter. The solvers get every help they can use on the same points: polynomials ready to evaluate, and
restarts at the switches (without that they would lose their order). Accuracy is measured in extended
precision (`tests.evidence.floquet.extended`).
"""

from __future__ import annotations

import argparse
import math
import os
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import lumped
from floquet import fast_multipliers, gear_block, stability_chart
from lumped.errors import LawRangeWarning
from lumped.model.periodic_system import Supports
from lumped.schema.pair import GearPair
from tests.evidence.floquet.extended import extended_matrix, stress_test

CORES = os.cpu_count() or 1
SPEEDS = (500.0, 20000.0)
PAIR = lumped.load_gear_pair("nasa_28_28").with_({"friction.law": "coulomb", "friction.coefficient": 0.05})
LAWS = ("coulomb", "smoothed_coulomb", "xu_kahraman", "benedict_kelley", "composite")
SOLVERS = (
    ("hard baseline, DOP853 on the matrix", "DOP853", 1e-9, False),
    ("LSODA on the matrix", "LSODA", 1e-9, False),
    ("easy baseline, RK45 by column", "RK45", 1e-8, True),
)
CHILD = """
import resource, sys, time
import numpy as np
start = time.perf_counter()
from floquet import stability_chart
from lumped import load_gear_pair
imported = time.perf_counter() - start
size, store = int(sys.argv[1]), sys.argv[2]
pair = load_gear_pair("nasa_28_28").with_({"friction.law": "coulomb", "friction.coefficient": 0.05})
axes = {"speed_rpm": np.linspace(500, 20000, size), "damping_ratio": np.linspace(0, 0.1, size)}
start = time.perf_counter()
stability_chart(pair, axes, rtol=1e-8, store=store, refine=False)
took = time.perf_counter() - start
print(imported, took, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3)
"""


def cpu(call: Callable[[], Any]) -> tuple[Any, float]:
    """Result and processor seconds of a call."""
    start = time.process_time()
    result = call()
    return result, time.process_time() - start


def row(what: str, value: str, remark: str = "") -> None:
    print(f"| {what:58s} | {value:>22s} | {remark} |", flush=True)


def dense(law: str, size: int) -> Callable[[], Any]:
    """A chart over speed and damping, warm."""
    pair = PAIR if law == "coulomb" else PAIR.with_({"friction.law": law, "friction.coefficient": None})
    small = {"speed_rpm": np.linspace(900, 1800, 70), "damping_ratio": np.linspace(0.01, 0.02, 5)}
    stability_chart(pair, small, rtol=1e-8)
    axes = {"speed_rpm": np.linspace(*SPEEDS, size), "damping_ratio": np.linspace(0.0, 0.1, size)}
    return lambda: stability_chart(pair, axes, rtol=1e-8, refine=False)


def charts(size: int) -> float:
    """Return processor seconds per point of the direct chart with constant mu."""
    first = math.nan
    for law in LAWS:
        chart, seconds = cpu(dense(law, size))
        first = seconds / size**2 if math.isnan(first) else first
        error = chart.error.values
        row(
            f"chart {size} x {size}, {law}",
            f"{CORES * size**2 / seconds:.0f} points/s",
            f"{seconds / size**2 * 1e6:.1f} us/point; bound: median {np.median(error):.0e}, above "
            f"1e-8 at {np.mean(error > 1e-8):.2%}",
        )
    return first


def forms(size: int) -> None:
    """Charts in both forms of contact, of energy stiffness; prescribed contact is the base of the ratio."""
    base = math.nan
    for form in ("prescribed", "loaded"):
        pair = PAIR.with_({"mesh.stiffness": {"model": "energy"}, "mesh.contact": form})
        energy_chart(pair, size)()
        seconds = min(cpu(energy_chart(pair, size))[1] for _ in range(3))
        base = seconds if math.isnan(base) else base
        row(
            f"chart {size} x {size}, energy stiffness, {form} form",
            f"{CORES * size**2 / seconds:.0f} points/s",
            f"{seconds / size**2 * 1e6:.1f} us/point, {seconds / base:.2f} of prescribed contact",
        )


def energy_chart(pair: GearPair, size: int) -> Callable[[], Any]:
    """A chart over speed and damping by the direct route."""
    axes = {"speed_rpm": np.linspace(*SPEEDS, size), "damping_ratio": np.linspace(0.0, 0.1, size)}
    return lambda: stability_chart(pair, axes, rtol=1e-8, refine=False)


def by_turning(points: int) -> None:
    """Cost of the direct route over omega_max T_m."""
    block = gear_block(PAIR, rtol=1e-10)
    omega = float(block.modal().omega.max())
    operating_rpm = PAIR.operating.pinion_speed * 30 / np.pi
    for rpm in (500, 1000, 2000, 5000, 10000, 20000):
        T = np.full(points, block.period * operating_rpm / rpm)
        _, seconds = cpu(lambda T=T: fast_multipliers(block, T, tolerance=2e-11))
        row(
            f"direct at {rpm} rpm, omega_max T_m = {omega * T[0]:.0f} rad",
            f"{CORES * points / seconds:.0f} points/s",
            f"{seconds / points * 1e6:.1f} us/point",
        )


def by_solver(
    pair: GearPair, name: str, rtol: float, by_column: bool, supports: Supports = "springs"
) -> np.ndarray:
    """Monodromy matrix of the feedback block by solve_ivp, rates in units of 1e4/s."""
    block = gear_block(pair, supports=supports)
    m = block.v.size
    C = block.damping if block.gyroscopic is None else block.damping + block.gyroscopic / block.period
    scale = np.repeat([1.0, 1e4], m)
    degree = max(block.total.w.shape[2], block.total.wd.shape[2])
    M = np.eye(2 * m)
    for i, (a, b) in enumerate(pairwise(block.phases * block.period)):
        A = np.zeros((degree, 2 * m, 2 * m))
        A[0, :m, m:] = np.eye(m)
        A[0, m:, :m] = -block.stiffness
        A[0, m:, m:] = -C
        for j in range(block.total.w.shape[2]):
            A[j, m:, :m] -= np.outer(block.total.w[i, :, j], block.v)
        for j in range(block.total.wd.shape[2]):
            A[j, m:, m:] -= np.outer(block.total.wd[i, :, j], block.v)
        A *= scale[None, None, :] / scale[None, :, None]

        def rates(t: float, y: np.ndarray, a: float = a, b: float = b, A: np.ndarray = A) -> np.ndarray:
            u = (2.0 * t - a - b) / (b - a)
            polynomial = A[-1]
            for j in range(len(A) - 2, -1, -1):
                polynomial = polynomial * u + A[j]
            return (polynomial @ y.reshape(2 * m, -1)).ravel()

        starts = list(M.T) if by_column else [M.ravel()]
        ends = [
            solve_ivp(rates, (a, b), y, method=name, rtol=rtol, atol=1e-2 * rtol).y[:, -1] for y in starts
        ]
        M = np.stack(ends, axis=1) if by_column else ends[0].reshape(2 * m, 2 * m)
    return M


def baselines(per_point: float, points: int) -> None:
    speeds = SPEEDS[0] + (SPEEDS[1] - SPEEDS[0]) * (np.arange(points) + 0.5) / points  # as in the chart
    pairs = [PAIR.with_(operating__pinion_speed=float(rpm)) for rpm in speeds]
    exact = [np.linalg.eigvals(extended_matrix(gear_block(pair)).astype(float)) for pair in pairs]

    def worst(multipliers: list[np.ndarray]) -> float:
        return max(
            float(np.abs(a[:, None] - b).min(axis=1).max()) for a, b in zip(multipliers, exact, strict=True)
        )

    chart = stability_chart(PAIR, {"speed_rpm": speeds}, rtol=1e-8)
    ours = [
        m[np.abs(m[:, None] - e).min(axis=1) < 1e-6]
        for m, e in zip(chart.multipliers.values, exact, strict=True)
    ]
    row(f"direct chart at these {points} speeds", "", f"worst error {worst(ours):.0e}")
    for title, name, rtol, by_column in SOLVERS:
        monodromies, seconds = cpu(lambda n=name, r=rtol, c=by_column: [by_solver(p, n, r, c) for p in pairs])
        row(
            f"{title}, rtol {rtol:.0e}",
            f"{points / seconds:.1f} points/s per core",
            f"worst error {worst([np.linalg.eigvals(M) for M in monodromies]):.0e}; the direct chart is "
            f"{seconds / points / per_point:.0f} times as fast per core",
        )


def on_shafts(size: int, points: int) -> None:
    """A chart of the pair on slender shafts, and DOP853 on the same modes at some of its speeds."""
    shaft = {
        "segments": [{"length": 220, "diameter": 30}],
        "gear_position": 200,
        "bearings": [{"position": z, "loa_stiffness": 2e8, "oloa_stiffness": 2e8} for z in (20, 140)],
    }
    pair = PAIR.with_(shafts={"damping_ratio": 0.01, "pinion": shaft, "gear": shaft})
    axes = {"speed_rpm": np.linspace(2000.0, 20000.0, size), "damping_ratio": np.linspace(0.0, 0.1, size)}
    modes = gear_block(pair, supports="shafts").v.size
    stability_chart(pair, {"speed_rpm": [9000.0]}, supports="shafts", rtol=1e-8)
    chart, seconds = cpu(lambda: stability_chart(pair, axes, rtol=1e-8, refine=False, supports="shafts"))
    each = seconds / size**2
    row(
        f"chart {size} x {size} on shafts, {modes} modes coupled",
        f"{CORES / each:.0f} points/s",
        f"{each * 1e6:.0f} us/point; bound: median {float(chart.error.median()):.0e}",
    )
    speeds = axes["speed_rpm"][size // (2 * points) :: size // points][:points]
    pairs = [pair.with_(operating__pinion_speed=float(rpm)) for rpm in speeds]
    monodromies, seconds = cpu(lambda: [by_solver(p, "DOP853", 1e-9, False, "shafts") for p in pairs])
    ours = [fast_multipliers(gear_block(p, supports="shafts")).multipliers[0] for p in pairs]
    worst = max(
        float(np.abs(a[:, None] - np.linalg.eigvals(M)).min(axis=1).max())
        for a, M in zip(ours, monodromies, strict=True)
    )
    row(
        f"DOP853 on the matrix of {modes} modes, rtol 1e-09",
        f"{points / seconds:.2f} points/s per core",
        f"differs by {worst:.0e}; the chart is {seconds / points / each:.0f} times as fast per core",
    )


def child(size: int, store: str, **environment: str) -> list[float]:
    """Import time, wall time and peak memory of a chart in a fresh process."""
    run = subprocess.run(
        [sys.executable, "-c", CHILD, str(size), store],
        env={**os.environ, **environment}, check=True, capture_output=True, text=True,
    )  # fmt: skip
    return [float(word) for word in run.stdout.split()]


def processes() -> None:
    with tempfile.TemporaryDirectory() as folder:
        for name in ("compiled now", "compiled code from the cache"):
            imported, took, _ = child(2, "all", NUMBA_CACHE_DIR=folder)
            row(
                f"first chart of a process, {name}",
                f"{took:.2f} s",
                f"import of floquet {imported:.2f} s, wall",
            )
    _, _, base = child(2, "all")
    for store in ("radius", "all"):
        _, took, memory = child(1000, store)
        row(
            f"chart 1000 x 1000, store {store}, in a fresh process",
            f"{memory:.0f} MB at most",
            f"{base:.0f} MB of it without a chart; {took:.1f} s wall",
        )


def accuracy(pairs: int, seed: int) -> None:
    (error, bound, excess), seconds = cpu(lambda: stress_test(pairs, seed))
    row(
        f"{pairs} random gear pairs (seed {seed})",
        f"worst error {error.max():.1e}",
        f"median {np.median(error):.0e}; bound: median {np.median(bound):.0e}, largest {bound.max():.0e}, "
        f"exceeded by {(excess > 1.0).sum()} pairs; {seconds:.0f} s with the reference",
    )


@pytest.mark.parametrize("law", ["coulomb", "xu_kahraman", "benedict_kelley"])
def test_chart(benchmark: Any, law: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LawRangeWarning)
        benchmark.pedantic(dense(law, 200), rounds=3)
    benchmark.extra_info["points"] = 200**2


@pytest.mark.parametrize(("name", "rtol", "by_column"), [solver[1:] for solver in SOLVERS])
def test_solver(benchmark: Any, name: str, rtol: float, by_column: bool) -> None:
    pair = PAIR.with_(operating__pinion_speed=8000.0)
    benchmark.pedantic(lambda: by_solver(pair, name, rtol, by_column), rounds=2)
    benchmark.extra_info["points"] = 1


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--size", type=int, default=400, help="points along each axis of the charts")
    parser.add_argument("--pairs", type=int, default=200, help="random gear pairs for the accuracy")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    warnings.simplefilter("ignore", LawRangeWarning)
    row("what", "result", f"{CORES} cores, {os.uname().machine}")
    row("-" * 58, "-" * 22, "---")
    per_point = charts(arguments.size)
    forms(arguments.size // 2)
    by_turning(4000)
    on_shafts(arguments.size // 8, 3)
    baselines(per_point, 6)
    processes()
    accuracy(arguments.pairs, arguments.seed)


if __name__ == "__main__":
    main()
