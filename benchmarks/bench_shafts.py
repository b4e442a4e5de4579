"""Cost of a mesh cycle on elastic shafts, and what leaving out modes costs in accuracy.

    python -m benchmarks.bench_shafts [--cycles N] [--repeats N]

Each row keeps the modes of both shafts with their gears held up to another frequency. The motion is the
periodic one with the linear mesh, the pair of the 28/28 preset without relief, whose stiffness jumps: nothing
excites high modes more. The error is the largest difference of the transmission error to the last row's, and
of a bearing force over the largest one. CPU time without set-up at rtol 1e-8, the best of the repeats.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

import lumped
from multibody.run.setup import prepare
from multibody.run.simulation import record

FREQUENCIES = (10e3, 15e3, 20e3, None, 60e3, 80e3)


def shaft(diameter: float, gear: float, length: float) -> dict[str, object]:
    """A shaft in two bearings 120 mm apart, sizes in mm."""
    bearings = [{"position": z, "loa_stiffness": 2e8, "oloa_stiffness": 2e8} for z in (20, 140)]
    segments = [{"length": length, "diameter": diameter}]
    return {"segments": segments, "gear_position": gear, "bearings": bearings}


SETS = {
    "stiff: 60 mm, gears in the middle of 120 mm": (shaft(60, 80, 160), {}),
    "slender: 30 mm, gears 60 mm beyond the bearings": (shaft(30, 200, 220), {}),
    "slender, with motor and load": (
        shaft(30, 200, 220),
        {
            "motor": {"position": 0, "inertia": 0.004, "coupling_stiffness": 4e4},
            "load": {"position": 0, "inertia": 0.02, "coupling_stiffness": 2e4},
        },
    ),
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cycles", type=int, default=3, help="mesh cycles of a run")
    parser.add_argument("--repeats", type=int, default=3, help="runs of every row, in turns")
    arguments = parser.parse_args()
    base = lumped.load_gear_pair("nasa_28_28").with_(mesh__relief="ignored")
    print(f"{arguments.cycles} mesh cycles, best of {arguments.repeats}; * is what simulate keeps by itself")
    for name, (one, inertias) in SETS.items():
        pair = base.with_(shafts={"damping_ratio": 0.01, "pinion": one, "gear": one} | inertias)
        measure(name, pair, arguments.cycles, arguments.repeats)


def measure(name: str, pair: lumped.GearPair, cycles: int, repeats: int) -> None:
    """Print the table of one set of shafts."""
    pairs = [pair.with_({"shafts.max_frequency": f}) for f in FREQUENCIES]
    setups = [prepare(one, "linear", "periodic", supports="shafts") for one in pairs]
    runs = []
    calls = []
    seconds = [np.inf] * len(setups)
    for setup in setups:
        runs.append(record(setup, cycles, 256)[0])
        calls.append(setup.model.budget.calls)
    exact = prepare(pair, "exact", "periodic", supports="shafts")
    timed = [*setups, exact]
    best = [*seconds, np.inf]
    for _ in range(repeats):
        for i, setup in enumerate(timed):
            start = time.process_time()
            record(setup, cycles, 256)
            best[i] = min(best[i], time.process_time() - start)
    last = runs[-1]
    span = float(np.ptp(last["dte"].to_numpy()))
    largest = float(np.abs(last["bearing_force"]).max())
    print(f"\n{name}: transmission error {1e6 * span:.2f} um peak to peak")
    print("  up to kHz   coordinates  order  ms/cycle  calls/cycle  error nm  bearing force")
    for i, (setup, run) in enumerate(zip(setups, runs, strict=True)):
        train = setup.machine.train
        assert train is not None
        error = 1e9 * float(np.abs(run["dte"] - last["dte"]).max())
        force = float(np.abs(run["bearing_force"] - last["bearing_force"]).max()) / largest
        order = max(shaft.order for shaft in train.shafts)
        mark = "*" if FREQUENCIES[i] is None else " "
        print(
            f"  {train.highest / 1e3:8.1f}{mark} {train.size:12d} {order:6d} {1e3 * best[i] / cycles:9.1f}"
            f" {calls[i] / cycles:12.0f} {error:9.1f} {force:14.1e}"
        )
    print(f"  exact, *  {exact.machine.size:13d} {'':6} {1e3 * best[-1] / cycles:9.1f}")


if __name__ == "__main__":
    main()
