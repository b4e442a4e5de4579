"""Floquet charts: points per second and accuracy, against general solvers in the same run.

    python benchmarks/bench_floquet.py [--size 400] [--pairs 200]

Rates are per second of processor time, times the cores of the machine, so that other work on the machine does
not enter; wall time is printed beside. The reference for accuracy integrates in extended precision the
piecewise polynomials k, c and mu themselves, in plain coordinates, and shares no code with the fast route.
"""

from __future__ import annotations

import argparse
import os
import resource
import time
import warnings
from collections.abc import Callable
from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp

from floquet import fast_multipliers, fast_periodic_motions, gear_block, stability_chart
from lumped import load_gear_pair
from lumped.errors import LawRangeWarning
from lumped.parameters import GearPair
from lumped.path_function import PathFunction
from lumped.periodic_system import periodic_system

LD = np.longdouble
PRESETS = ["nasa_28_28", "nasa_art_25_31", "kahraman_blankenship_50_50", "fzg_c"]
LAWS = ["none", "coulomb", "benedict_kelley", "xu_kahraman", "smoothed_coulomb", "composite"]
CORES = os.cpu_count() or 1


def timed(call: Callable[[], object]) -> tuple[object, float, float]:
    """Result, wall and processor seconds."""
    wall, cpu = time.perf_counter(), time.process_time()
    result = call()
    return result, time.perf_counter() - wall, time.process_time() - cpu


def taylor_at(function: PathFunction, start: float, middle: float) -> np.ndarray:
    """Powers of (xi - start), lowest first, of the piece that holds ``middle``."""
    j = int(np.clip(np.searchsorted(function.breaks, middle) - 1, 0, function.breaks.size - 2))
    poly = function.coefficients[::-1, j].astype(LD)
    shift = LD(start) - LD(function.breaks[j])
    for k in range(poly.size - 1):
        for i in range(poly.size - 2, k - 1, -1):
            poly[i] += shift * poly[i + 1]
    return poly


def reference(pair: GearPair) -> np.ndarray:
    """Monodromy matrix (6, 6) of (q, x_p, x_g) in extended precision; rates in units of 1e4/s."""
    system = periodic_system(pair, "feedback")
    cycle, s = system.cycle, system.structure
    e, g = cycle.elements, cycle.geometry
    speed = LD(g.omega_pinion * g.base_radius_pinion)
    normal = ((s.normal / s.mass) @ system.reduction.T).astype(LD)
    arm = [((s.friction_arm[:, i] / s.mass) @ system.reduction.T).astype(LD) for i in (0, 1)]
    L, D = -np.diag(system.constant[3:, :3]).astype(LD), -np.diag(system.constant[3:, 3:]).astype(LD)
    v, unit = system.deflection.astype(LD), LD(1e4)
    edges = np.unique(np.concatenate([[0.0], cycle.switch_times, cycle.knot_times, [cycle.period]]))
    M = np.eye(6, dtype=LD)
    for low, high in pairwise(edges):
        if high - low < 1e-13 * cycle.period:
            continue
        w, wd = [np.zeros((40, 3), dtype=LD) for _ in range(2)]
        for offset in cycle.offsets:
            start, middle = offset + float(speed) * low, offset + float(speed) * 0.5 * (low + high)
            if middle > g.L_XD:
                continue
            mu = taylor_at(e.friction, start, middle)
            moved = np.append(mu, LD(0)) * LD(start)
            moved[1:] += mu
            row = np.zeros((mu.size + 1, 3), dtype=LD)
            row[0] = normal
            row[: mu.size] += mu[:, None] * arm[0]
            row += moved[:, None] * arm[1]
            for target, function in ((w, e.stiffness), (wd, e.damping)):
                load = taylor_at(function, start, middle)
                for r in range(3):
                    product = np.convolve(load, row[:, r])
                    target[: product.size, r] -= product
        power = speed ** np.arange(40)
        w, wd = w * power[:, None], wd * power[:, None]
        rate = np.sqrt(float(np.abs(L).max() + 3 * np.abs(w[0]).max())) + float(np.abs(wd[0]).max())
        count = max(1, int(np.ceil((high - low) * rate)))
        h = (LD(high) - LD(low)) / count
        for k in range(count):
            M = taylor_step(M, shifted(w, h * k), shifted(wd, h * k), L, D, v, h, unit)
    return M.astype(float)


def shifted(poly: np.ndarray, by: float) -> np.ndarray:
    """Coefficients about a later time."""
    used = 1 + max(np.flatnonzero(np.abs(poly).max(axis=1)), default=0)
    out = poly[:used].copy()
    for k in range(used - 1):
        for i in range(used - 2, k - 1, -1):
            out[i] += by * out[i + 1]
    return out


def taylor_step(
    M: np.ndarray,
    w: np.ndarray,
    wd: np.ndarray,
    L: np.ndarray,
    D: np.ndarray,
    v: np.ndarray,
    h: float,
    unit: float,
) -> np.ndarray:
    """One step of z'' + D z' + L z + w (v.z) + wd (v.z') = 0 for six columns, 40 terms."""
    z = [M[:3], unit * M[3:]]
    for k in range(40):
        rate = (k + 1) * z[k + 1]
        total = L[:, None] * z[k] + D[:, None] * rate
        for i in range(min(k + 1, w.shape[0])):
            total = total + np.outer(w[i], v @ z[k - i])
        for i in range(min(k + 1, wd.shape[0])):
            total = total + np.outer(wd[i], (k + 1 - i) * (v @ z[k + 1 - i]))
        z.append(-total / LD((k + 1) * (k + 2)))
    position, rate = z[-1], (len(z) - 1) * z[-1]
    for k in range(len(z) - 2, 0, -1):
        position, rate = position * h + z[k], rate * h + k * z[k]
    return np.concatenate([position * h + z[0], rate / unit])


def random_pair(rng: np.random.Generator) -> GearPair:
    changes: dict[str, object] = {
        "operating.pinion_speed": float(np.exp(rng.uniform(np.log(500), np.log(20000)))),
        "operating.pinion_torque": float(rng.uniform(20, 200)),
        "mesh.damping_ratio": float(rng.choice([0.0, rng.uniform(0, 0.1)])),
        "friction.law": str(rng.choice(LAWS)),
    }
    for gear in ("pinion", "gear"):
        changes[f"bearings.{gear}.loa_stiffness"] = float(10 ** rng.uniform(7.3, 9))
        changes[f"bearings.{gear}.loa_damping_ratio"] = float(rng.uniform(0, 0.1))
    return load_gear_pair(str(rng.choice(PRESETS))).with_(changes)


def accuracy(pairs: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    errors, bounds, violations = [], [], 0
    for _ in range(pairs):
        pair = random_pair(rng)
        exact = np.linalg.eigvals(reference(pair))
        fast = fast_multipliers(gear_block(pair))
        distance = np.abs(fast.multipliers[0][:, None] - exact[None, :]).min(axis=1)
        # 1e-13: LAPACK's own error in the eigenvalues of the reference.
        violations += int((distance > fast.errors[0] + 1e-13).any())
        errors.append(distance.max())
        bounds.append(fast.errors[0].max())
    print(
        f"accuracy, {pairs} random gear pairs (seed {seed}), reference in extended precision: worst error "
        f"{max(errors):.1e}, median {np.median(errors):.1e}, largest bound {max(bounds):.1e}, bound violated "
        f"by {violations} pairs"
    )


def charts(size: int) -> float:
    """Print the rates of charts; return processor seconds per point of the direct one with constant mu."""
    axes = {"speed_rpm": np.linspace(500, 20000, size), "damping_ratio": np.linspace(0.0, 0.1, size)}
    small = {"speed_rpm": [900.0, 1000.0], "damping_ratio": [0.01, 0.02]}
    first = 0.0
    for law, method in [
        ("coulomb", "taylor"), ("xu_kahraman", "taylor"), ("benedict_kelley", "taylor"),
        ("coulomb", "chebyshev"), ("xu_kahraman", "chebyshev"),
    ]:  # fmt: skip
        changes: dict[str, object] = {"friction.law": law}
        if law == "coulomb":
            changes["friction.coefficient"] = 0.05
        pair = load_gear_pair("nasa_28_28").with_(changes)
        _, compiled, _ = timed(lambda p=pair, m=method: stability_chart(p, small, rtol=1e-8, method=m))
        chart, wall, cpu = timed(lambda p=pair, m=method: stability_chart(p, axes, rtol=1e-8, method=m))
        bound = chart.error.values
        first = first or cpu / size**2
        print(
            f"chart {size}x{size} {law:16s} {method:9s} {cpu / size**2 * 1e6:7.1f} us/point  "
            f"{CORES * size**2 / cpu:9.0f} points/s on {CORES} cores (wall {size**2 / wall:9.0f})  bound: "
            f"median {np.median(bound):.0e}, above 1e-8 at {np.mean(bound > 1e-8):.2%}  "
            f"first call {compiled:.2f} s"
        )
    return first


def matrices_of_pieces(pair: GearPair) -> tuple[np.ndarray, list[np.ndarray]]:
    """Piece ends as parts of the period, and A (d+1, 6, 6) in powers of u on each; rates in 1e4/s."""
    block = gear_block(pair)
    scale = np.repeat([1.0, 1e4], 3)
    degree = max(block.total.w.shape[2], block.total.wd.shape[2])
    pieces = []
    for i in range(block.phases.size - 1):
        A = np.zeros((degree, 6, 6))
        A[0, :3, 3:] = np.eye(3)
        A[0, 3:, :3] = -np.diag(block.stiffness)
        A[0, 3:, 3:] = -np.diag(block.damping)
        for j in range(block.total.w.shape[2]):
            A[j, 3:, :3] -= np.outer(block.total.w[i, :, j], block.v)
        for j in range(block.total.wd.shape[2]):
            A[j, 3:, 3:] -= np.outer(block.total.wd[i, :, j], block.v)
        pieces.append(A * scale[None, None, :] / scale[None, :, None])
    return block.phases, pieces


def by_solver(pair: GearPair, name: str, rtol: float, by_column: bool) -> np.ndarray:
    """Monodromy matrix by solve_ivp, restarted at the switches and given ready polynomials."""
    phases, pieces = matrices_of_pieces(pair)
    T = periodic_system(pair, "feedback").period
    M = np.eye(6)
    for (a, b), A in zip(pairwise(phases * T), pieces, strict=True):

        def rhs(t: float, y: np.ndarray, a: float = a, b: float = b, A: np.ndarray = A) -> np.ndarray:
            u = (2.0 * t - a - b) / (b - a)
            now = A[-1]
            for j in range(len(A) - 2, -1, -1):
                now = now * u + A[j]
            return (now @ y.reshape(6, -1)).ravel()

        starts = [M[:, i] for i in range(6)] if by_column else [M.ravel()]
        ends = [solve_ivp(rhs, (a, b), y, method=name, rtol=rtol, atol=1e-2 * rtol).y[:, -1] for y in starts]
        M = np.stack(ends, axis=1) if by_column else ends[0].reshape(6, 6)
    return M


def baselines(per_point: float) -> None:
    pair = load_gear_pair("nasa_28_28").with_({"friction.law": "coulomb", "friction.coefficient": 0.05})
    speeds = 500.0 + 19500.0 * (np.arange(6) + 0.5) / 6  # even over speed, as in the chart
    for name, rtol, by_column in (("DOP853", 1e-9, False), ("LSODA", 1e-9, False), ("RK45", 1e-8, True)):
        times, errors = [], []
        for rpm in speeds:
            here = pair.with_(operating__pinion_speed=float(rpm))
            exact = np.linalg.eigvals(reference(here))
            M, _, cpu = timed(lambda p=here, n=name, r=rtol, c=by_column: by_solver(p, n, r, c))
            times.append(cpu)
            errors.append(np.abs(np.linalg.eigvals(M)[:, None] - exact[None, :]).min(axis=1).max())
        mean = float(np.mean(times))
        print(
            f"solve_ivp {name:7s} rtol {rtol:.0e} {'by column' if by_column else 'matrix   '} "
            f"{mean * 1e3:8.1f} ms/point, {1.0 / mean:.1f} points/s per core, worst error {max(errors):.0e}; "
            f"direct chart is {mean / per_point:6.0f} times as fast per core"
        )


def steady(count: int) -> None:
    pair = load_gear_pair("nasa_28_28").with_({"friction.law": "coulomb", "friction.coefficient": 0.05})
    block = gear_block(pair, rtol=1e-10)
    speeds = np.linspace(500, 20000, count)
    periods = block.period * pair.operating.pinion_speed * 30 / np.pi / speeds
    fast_periodic_motions(block, periods[:4])
    motion, wall, cpu = timed(lambda: fast_periodic_motions(block, periods, tolerance=1e-10))
    worst = float((motion.errors / motion.energy_norm).max())
    print(
        f"steady state, DTE at 64 phases and brake torque: {cpu / count * 1e6:.1f} us/speed, "
        f"{CORES * count / cpu:.0f} speeds/s on {CORES} cores (wall {count / wall:.0f}), "
        f"largest relative bound {worst:.0e}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--size", type=int, default=400, help="points along each axis of the charts")
    parser.add_argument("--pairs", type=int, default=200, help="random gear pairs for the accuracy")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    warnings.simplefilter("ignore", LawRangeWarning)
    per_point = charts(arguments.size)
    steady(20_000)
    baselines(per_point)
    accuracy(arguments.pairs, arguments.seed)
    print(f"peak memory {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3:.0f} MB")


if __name__ == "__main__":
    main()
