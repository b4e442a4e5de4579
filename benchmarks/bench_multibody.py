"""Cost of a multibody mesh cycle at rtol 1e-8, beside scipy's DOP853 on the lumped equations in the same run.

    python -m benchmarks.bench_multibody [--cycles N] [--repeats N]

DOP853 gets every help: the right-hand side is compiled, and the integration restarts at the switches of the
element laws (without that it would lose its order). All solvers take turns, so that a busy machine slows all
of them alike; CPU time without set-up, the best of the repeats counts. The aim is an exact cycle, with the
contact's energy and all effects (loaded contact) too, within twice DOP853's.

The last row is DOP853 on the right-hand side of the row above, without any help but the compiled force of the
teeth: what the multibody run would cost without exudyn and without events.

The last column is what that time buys: the largest error of the transmission error at the ends of the mesh
cycles, against the same model at rtol 1e-11, over its range there from rest (a start that vibrates).
"""

from __future__ import annotations

import argparse
import itertools
import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import solve_ivp

import lumped
from multibody.contact.kernels import tooth_forces
from multibody.contact.records import CONTACTS_SIZE, PHI_G, PHI_P, WRENCH, X_G, X_P, opened
from multibody.run.integration import Segment
from multibody.run.setup import Setup, prepare
from multibody.run.simulation import record

RTOL = 1e-8
TIGHT = 1e-11
JUMPS = lumped.load_gear_pair("nasa_28_28").with_(
    friction__law="coulomb", friction__coefficient=0.05, mesh__relief="ignored"
)
PAIRS = {
    "stiffness jumps": JUMPS,
    "smooth stiffness": JUMPS.with_(mesh__stiffness={"model": "parabolic", "ramp_length": 3.0}),
    "relieved, 28/28": lumped.load_gear_pair("nasa_28_28"),
    "energy stiffness": JUMPS.with_(mesh__stiffness={"model": "energy"}),
}


def right_hand_side(setup: Setup, packed: np.ndarray) -> Callable[[float, np.ndarray], np.ndarray]:
    """Return the rates of a state q, v (12,) of the gears on springs, by the compiled force of the teeth."""
    gears = np.empty((3, 6))
    contacts = np.zeros(CONTACTS_SIZE)
    bodies = setup.machine.bodies
    inertia, stiffness, damping, load = (bodies[name] for name in bodies.dtype.names)

    def rates(t: float, state: np.ndarray) -> np.ndarray:
        q = state[:6]
        v = state[6:]
        gears[:2] = q, v
        tooth_forces(t, gears, packed, setup.model.flags, contacts)
        return np.concatenate([v, (gears[WRENCH] + load - stiffness * q - damping * v) / inertia])

    return rates


def plain_dop853(setup: Setup, cycles: int) -> tuple[int, np.ndarray]:
    """Integrate the exact model without events; force evaluations, and q at the ends of the cycles."""
    ends = np.arange(1, cycles + 1) * setup.machine.period
    rates = right_hand_side(setup, setup.machine.packed)
    start = np.concatenate([setup.q, setup.v])
    run = solve_ivp(
        rates, (0.0, ends[-1]), start, method="DOP853", t_eval=ends, rtol=setup.rtol, atol=setup.atol
    )
    return run.nfev, run.y[:6].T


def dop853(setup: Setup, cycles: int) -> tuple[int, np.ndarray]:
    """Integrate the lumped equations between switches; force evaluations, and q at the ends of the cycles."""
    m = setup.machine
    packed = m.packed.copy()
    rolling = opened(packed).rolling
    rates = right_hand_side(setup, packed)
    edges = (np.arange(cycles)[:, None] + m.switches).ravel()
    edges = np.append(edges, float(cycles)) * m.period
    state = np.concatenate([setup.q, setup.v])
    calls = 0
    margin = 1e-12 * m.period
    ends = []
    for number, (start, stop) in enumerate(itertools.pairwise(edges)):
        rolling.earliest = start + margin
        rolling.latest = stop - margin
        solution = solve_ivp(rates, (start, stop), state, method="DOP853", rtol=setup.rtol, atol=setup.atol)
        state = solution.y[:, -1]
        calls = calls + solution.nfev
        if (number + 1) % m.switches.size == 0:
            ends.append(state[:6])
    return calls, np.array(ends)


def multibody_run(setup: Setup, cycles: int) -> tuple[int, np.ndarray]:
    """Integrate without output; force evaluations and q (cycles, 6) at the cycles' ends."""
    before = setup.model.budget.calls
    edges = setup.edges(cycles)
    ends = []
    per_cycle = (edges.size - 1) // cycles

    def visit(number: int, segment: Segment) -> None:
        if (number + 1) % per_cycle == 0:
            ends.append(segment.q[-1])

    setup.run(edges, visit)
    return setup.model.budget.calls - before, np.array(ends)


def with_outputs(setup: Setup, cycles: int) -> tuple[int, np.ndarray]:
    """Integrate and keep 256 times per mesh cycle of all variables."""
    before = setup.model.budget.calls
    record(setup, cycles, 256)
    return setup.model.budget.calls - before, np.empty((0, 6))


#: What an exact cycle of loaded contact is measured by.
PAPER = "multibody exact"
#: Name -> (form of the contact, fidelity, run); the first is the base of the ratios.
SOLVERS: dict[str, tuple[str, str, Callable[[Setup, int], tuple[int, np.ndarray]]]] = {
    "scipy DOP853, lumped equations": ("prescribed", "linear", dop853),
    "multibody linear": ("prescribed", "linear", multibody_run),
    PAPER: ("prescribed", "exact", multibody_run),
    "multibody exact, 256 outputs": ("prescribed", "exact", with_outputs),
    "multibody exact, loaded contact": ("loaded", "exact", multibody_run),
    "scipy DOP853, exact, loaded contact": ("loaded", "exact", plain_dop853),
}


@dataclass
class Row:
    """One solver on one pair: CPU seconds of every turn, force evaluations, error."""

    seconds: list[float] = field(default_factory=list)
    calls: int = 0
    error: float = np.nan


def transmission_error(setup: Setup, q: np.ndarray) -> np.ndarray:
    p = setup.machine.record
    return q[:, X_P] - q[:, X_G] - p.geometry.radius_p * q[:, PHI_P] - p.geometry.radius_g * q[:, PHI_G]


def measure(pair: lumped.GearPair, cycles: int, repeats: int) -> dict[str, Row]:
    """Run all solvers on one pair, in turns."""
    rows = {name: Row() for name in SOLVERS}
    setups = {}
    for name, (form, fidelity, run) in SOLVERS.items():
        one = pair.with_(mesh__contact=form)
        setups[name] = prepare(one, fidelity=fidelity, rtol=RTOL)
        tight = prepare(one, fidelity=fidelity, rtol=TIGHT)
        reference = transmission_error(tight, multibody_run(tight, cycles)[1])
        motion = run(setups[name], cycles)[1]  # compiles, too
        if motion.size:
            error = np.abs(transmission_error(tight, motion) - reference)
            rows[name].error = float(error.max() / np.ptp(reference))
    for _ in range(repeats):
        for name, (_, _, run) in SOLVERS.items():
            started = time.process_time()
            rows[name].calls, _ = run(setups[name], cycles)
            rows[name].seconds.append(time.process_time() - started)
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cycles", type=int, default=20, help="mesh cycles of a run")
    parser.add_argument("--repeats", type=int, default=7, help="turns of every solver")
    arguments = parser.parse_args()
    cycles = arguments.cycles
    repeats = arguments.repeats
    print(f"{cycles} mesh cycles from rest, rtol {RTOL:g}, best of {repeats}")
    for name, pair in PAIRS.items():
        rows = measure(pair, cycles, repeats)
        base = min(next(iter(rows.values())).seconds)
        paper = min(rows[PAPER].seconds)
        heads = f"{'ms/cycle':>10s}{'calls/cycle':>13s}{'of DOP853':>11s}{'of exact':>10s}{'error':>10s}"
        print(f"\n{name}\n{'':34s}{heads}")
        for label, row in rows.items():
            seconds = min(row.seconds)
            error = "" if np.isnan(row.error) else f"{row.error:.1e}"
            cost = f"{1e3 * seconds / cycles:10.2f}{row.calls / cycles:13.0f}"
            cost += f"{seconds / base:11.2f}{seconds / paper:10.2f}"
            print(f"{label:34s}{cost}{error:>10s}")


if __name__ == "__main__":
    main()
