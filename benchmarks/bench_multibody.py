"""Cost of a multibody mesh cycle at rtol 1e-8, beside scipy's DOP853 on the lumped equations in the same run.

    python benchmarks/bench_multibody.py [--cycles N] [--repeats N]

DOP853 gets every help: the right-hand side is compiled, and the integration restarts at the switches of the
element laws (without that it would lose its order). All solvers take turns, so that a busy machine slows all
of them alike; the best of the repeats counts. The aim is an exact cycle within twice DOP853's.
"""

from __future__ import annotations

import argparse
import itertools
import time
from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp

import lumped
import multibody
from multibody import kernels as kn
from multibody.kernels_linear import linear_forces
from multibody.kinematics import MAX_PAIRS
from multibody.setup import Setup, prepare

RTOL = 1e-8
REFERENCE = "scipy DOP853, lumped equations"
JUMPS = lumped.load_gear_pair("nasa_28_28").with_(friction__law="coulomb", friction__coefficient=0.05)
PAIRS = {
    "stiffness jumps": JUMPS,
    "smooth stiffness": JUMPS.with_(mesh__stiffness={"model": "parabolic", "ramp_length": 3.0}),
}


def dop853(setup: Setup, cycles: int) -> int:
    """Integrate the lumped equations segment by segment; returns the number of force evaluations."""
    m, p = setup.machine, setup.machine.parameters.copy()
    wrench, contacts = np.empty(6), np.zeros((2 * MAX_PAIRS, kn.N_RECORD))
    inertia = np.array([m.mass[0], m.mass[0], m.inertia[0], m.mass[1], m.mass[1], m.inertia[1]])
    stiffness, damping, torque = np.zeros(6), np.zeros(6), np.zeros(6)
    stiffness[[0, 1, 3, 4]], damping[[0, 1, 3, 4]] = m.bearing_stiffness.ravel(), m.bearing_damping.ravel()
    torque[[2, 5]] = -m.torque_pinion, -m.torque_gear

    def rates(t: float, state: np.ndarray) -> np.ndarray:
        q, v = state[:6], state[6:]
        linear_forces(t, q, v, p, 0, m.table, m.offsets, wrench, contacts)
        return np.concatenate([v, (wrench + torque - stiffness * q - damping * v) / inertia])

    edges = (np.arange(cycles)[:, None] + m.switches).ravel()
    edges = np.append(edges, float(cycles)) * m.period
    state, calls, margin = np.concatenate([setup.q, setup.v]), 0, 1e-12 * m.period
    atol = np.repeat([setup.atol, setup.atol], 6)
    for start, stop in itertools.pairwise(edges):
        p[kn.T_LOW], p[kn.T_HIGH] = start + margin, stop - margin
        found = solve_ivp(rates, (start, stop), state, method="DOP853", rtol=RTOL, atol=atol)
        state, calls = found.y[:, -1], calls + found.nfev
    return calls


def timed(run: Callable[[], int]) -> tuple[float, int]:
    """CPU seconds and number of force evaluations of one run."""
    started = time.process_time()
    calls = run()
    return time.process_time() - started, calls


def multibody_run(pair: lumped.GearPair, fidelity: str, cycles: int) -> int:
    """Integrate without output; returns the number of force evaluations."""
    setup = prepare(pair, fidelity=fidelity, initial="periodic", rtol=RTOL)
    setup.run(setup.edges(cycles), lambda *_: None)
    return setup.model.budget.calls


def solvers(pair: lumped.GearPair, cycles: int) -> dict[str, Callable[[], int]]:
    """Everything that is compared, ready to run."""
    output = {"samples_per_cycle": 256, "initial": "periodic", "rtol": RTOL}
    return {
        REFERENCE: lambda: dop853(prepare(pair, fidelity="linear", initial="periodic", rtol=RTOL), cycles),
        "multibody linear": lambda: multibody_run(pair, "linear", cycles),
        "multibody exact": lambda: multibody_run(pair, "exact", cycles),
        "multibody exact, 256 outputs": lambda: int(
            multibody.simulate(pair, cycles, **output).attrs["force_evaluations"]
        ),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cycles", type=int, default=20, help="mesh cycles of a run")
    parser.add_argument("--repeats", type=int, default=7, help="turns of every solver")
    arguments = parser.parse_args()
    cycles, repeats = arguments.cycles, arguments.repeats
    print(f"{cycles} mesh cycles from the periodic motion, rtol {RTOL:g}, best of {repeats}")
    for name, pair in PAIRS.items():
        runs = solvers(pair, cycles)
        best = dict.fromkeys(runs, (np.inf, 0))
        for run in runs.values():
            run()  # compiles
        for _ in range(repeats):
            for label, run in runs.items():
                best[label] = min(best[label], timed(run))
        base = best[REFERENCE][0]
        print(f"\n{name}\n{'':34s}{'ms/cycle':>10s}{'calls/cycle':>13s}{'of DOP853':>11s}")
        for label, (seconds, calls) in best.items():
            per_cycle = 1e3 * seconds / cycles
            print(f"{label:34s}{per_cycle:10.2f}{calls / cycles:13.0f}{seconds / base:11.2f}")


if __name__ == "__main__":
    main()
