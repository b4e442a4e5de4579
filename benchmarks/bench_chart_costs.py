"""What charts that refine themselves cost, beside the full grid and general solvers of the same run.

    python -m benchmarks.bench_chart_costs [ratio] [sizes] [matrices]

`ratio`: processor time of the full grid over that of the refined chart, same verdicts. `sizes`: processor
time of a refined chart per node over that of a node of the full grid, and memory per node, from 1e3 to 1e7
nodes. `matrices`: one monodromy matrix by the kernel, by scipy, and by heyoka where heyoka is installed.
Without arguments all three. Peak memory is that of numpy and Python (`tracemalloc`), in a run of its own.
"""

from __future__ import annotations

import sys
import time
import tracemalloc
import warnings
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from floquet import gear_block, stability_chart
from floquet.gear.axes import GearVariation, chart_axes
from floquet.rank_one.batch import fast_monodromies
from floquet.rank_one.system import RankOneSystem
from lumped import load_gear_pair
from tests.evidence.floquet.extended import as_periodic_system, state_matrix

NAMES = ("nasa_art_25_31", "fzg_c", "nasa_28_28", "kahraman_blankenship_50_50")
SPEEDS = (500.0, 20000.0)
DAMPING = (0.001, 0.1)
SIZES = ((40, 25), (125, 80), (400, 250), (1250, 800), (2500, 2000), (5000, 2000))
#: Tolerance of all solvers of one matrix.
RTOL = 1e-10


def processor_seconds(call: Callable[[], Any]) -> tuple[Any, float]:
    """Result and processor seconds of a call."""
    start = time.process_time()
    result = call()
    return result, time.process_time() - start


def fast_axes(speeds: int, dampings: int) -> dict[str, Any]:
    return {"speed_rpm": np.linspace(*SPEEDS, speeds), "damping_ratio": np.linspace(*DAMPING, dampings)}


def ratios() -> None:
    """Full grid over refined chart, 701 x 301 nodes; the best of three refined charts."""
    print("| pair | axes | evaluated | full grid s | refined s | ratio | verdicts that differ |")
    print("|---|---|---|---|---|---|---|")
    for name in NAMES:
        pair = load_gear_pair(name)
        for words, axes in (
            ("default", chart_axes(pair, 701, 301)),
            ("500 to 20000 rpm", fast_axes(701, 301)),
        ):
            stability_chart(pair, fast_axes(101, 61))
            runs = [processor_seconds(partial(stability_chart, pair, axes)) for _ in range(3)]
            refined = runs[0][0]
            seconds = min(run[1] for run in runs)
            full, full_seconds = processor_seconds(partial(stability_chart, pair, axes, refine=False))
            wrong = int((refined.verdict != full.verdict).sum())
            share = float(refined.known.mean())
            print(
                f"| {name} | {words} | {share:.1%} | {full_seconds:.2f} | {seconds:.2f} | "
                f"{full_seconds / seconds:.0f} | {wrong} |",
                flush=True,
            )


def by_size() -> None:
    """Time and memory of a node of a refined chart of 28/28, own law, beside a node of the full grid."""
    pair = load_gear_pair("nasa_28_28")
    stability_chart(pair, fast_axes(101, 61))
    _, full_seconds = processor_seconds(partial(stability_chart, pair, fast_axes(200, 100), refine=False))
    each = full_seconds / 20_000
    print(f"full grid: {1e6 * each:.1f} us a node")
    print("| nodes | evaluated | s | us a node | of a node of the full grid | peak MB | bytes a node |")
    print("|---|---|---|---|---|---|---|")
    for shape in SIZES:
        chart, seconds = processor_seconds(partial(stability_chart, pair, fast_axes(*shape)))
        known = float(chart.known.mean())
        del chart
        tracemalloc.start()
        stability_chart(pair, fast_axes(*shape))
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        nodes = shape[0] * shape[1]
        print(
            f"| {nodes:.0e} | {known:.2%} | {seconds:.2f} | {1e6 * seconds / nodes:.3f} | "
            f"{seconds / nodes / each:.4f} | {peak / 1e6:.0f} | {peak / nodes:.0f} |",
            flush=True,
        )


class Solved(NamedTuple):
    """Monodromy matrices (k, n, n) in (z, z') and processor seconds for one of them."""

    matrices: np.ndarray
    seconds: float


def by_kernel(system: RankOneSystem, periods: np.ndarray) -> Solved:
    """With bounds on the errors; 50 times as many matrices, because a batch has fixed costs."""
    many = np.repeat(periods, 50)
    flow, seconds = processor_seconds(partial(fast_monodromies, system, many, tolerance=2e-4 * RTOL))
    S = state_matrix(system.modal())
    return Solved(S @ flow.matrices[::50] @ np.linalg.inv(S), seconds / many.size)


def by_scipy(system: RankOneSystem, periods: np.ndarray) -> Solved:
    """DOP853 on the matrix equation, restarted at every switch."""
    n = 2 * system.v.size

    def matrix(T: float) -> np.ndarray:
        A = as_periodic_system(replace(system, period=T))
        X = np.eye(n)
        for start, end in pairwise((0.0, *A.breakpoints, T)):
            inset = 1e-12 * T  # A is not evaluated at its switches

            def rates(t: float, x: np.ndarray, low: float = start + inset, high: float = end - inset) -> Any:
                return (A.evaluate([min(max(t, low), high)])[0] @ x.reshape(n, n)).ravel()

            X = (
                solve_ivp(rates, (start, end), X.ravel(), "DOP853", rtol=RTOL, atol=RTOL)
                .y[:, -1]
                .reshape(n, n)
            )
        return X

    matrices, seconds = processor_seconds(lambda: np.array([matrix(T) for T in periods]))
    return Solved(matrices, seconds / periods.size)


def by_heyoka(system: RankOneSystem, periods: np.ndarray) -> Solved | None:
    """Taylor series of heyoka, four columns side by side, restarted at every switch; None: not installed.

    Of a system without gyroscopic terms.
    """
    try:
        import heyoka as hy
    except ImportError:
        return None
    m = system.v.size
    gains = system.total
    powers = max(gains.w.shape[2], gains.wd.shape[2])
    names = [f"{kind}{i}" for kind in ("z", "d") for i in range(m)]
    *states, u = hy.make_vars(*names, "u")
    z, d = states[:m], states[m:]
    C = system.damping
    deflection = hy.sum([float(system.v[i]) * z[i] for i in range(m)])
    rate = hy.sum([float(system.v[i]) * d[i] for i in range(m)])
    table = np.zeros((2 * m, powers))

    def polynomial(row: int) -> Any:
        result = hy.par[1 + row * powers + powers - 1]
        for j in range(powers - 2, -1, -1):
            result = result * u + hy.par[1 + row * powers + j]
        return result

    equations = [(z[i], d[i]) for i in range(m)]
    for i in range(m):
        constant = [float(-system.stiffness[i, j]) * z[j] for j in range(m)]
        constant += [float(-C[i, j]) * d[j] for j in range(m)]
        feedback = [-polynomial(i) * deflection, -polynomial(m + i) * rate]
        equations.append((d[i], hy.sum(constant + feedback)))
    equations.append((u, hy.par[0]))
    lanes = 4
    columns = -(-2 * m // lanes) * lanes
    integrator = hy.taylor_adaptive_batch(
        equations, np.zeros((2 * m + 1, lanes)), pars=np.zeros((1 + table.size, lanes)), tol=RTOL
    )

    def matrix(T: float) -> np.ndarray:
        X = np.eye(2 * m, columns)
        for piece, (low, high) in enumerate(pairwise(system.phases)):
            table[:m, : gains.w.shape[2]] = gains.w[piece]
            table[m:, : gains.wd.shape[2]] = gains.wd[piece]
            integrator.pars[0] = 2.0 / ((high - low) * T)
            integrator.pars[1:] = table.ravel()[:, None]
            for c in range(0, columns, lanes):
                integrator.state[:-1] = X[:, c : c + lanes]
                integrator.state[-1] = -1.0
                integrator.propagate_for([(high - low) * T] * lanes)
                X[:, c : c + lanes] = integrator.state[:-1]
        return X[:, : 2 * m].copy()

    matrix(float(periods[0]))
    matrices, seconds = processor_seconds(lambda: np.array([matrix(T) for T in periods]))
    return Solved(matrices, seconds / periods.size)


def matrices() -> None:
    """One matrix: the kernel with its bounds, scipy, heyoka; differences from the kernel."""
    print("| pair | states | kernel us | DOP853 / kernel, difference | heyoka / kernel, difference |")
    print("|---|---|---|---|---|")
    for name in NAMES[:2]:
        system = gear_block(GearVariation.of(load_gear_pair(name), "springs"))
        periods = system.period * np.linspace(0.4, 2.0, 12)
        by_kernel(system, periods)
        kernel = by_kernel(system, periods)
        words = []
        for solver in (by_scipy, by_heyoka):
            other = solver(system, periods)
            if other is None:
                words.append("not installed")
                continue
            scale = np.abs(kernel.matrices).max(axis=(1, 2), keepdims=True)
            difference = np.abs((other.matrices - kernel.matrices) / scale).max()
            words.append(f"{other.seconds / kernel.seconds:.0f}, {difference:.0e}")
        states = 2 * system.v.size
        print(f"| {name} | {states} | {1e6 * kernel.seconds:.1f} | {' | '.join(words)} |", flush=True)


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    parts = {"ratio": ratios, "sizes": by_size, "matrices": matrices}
    for chosen in sys.argv[1:] or parts:
        parts[chosen]()
