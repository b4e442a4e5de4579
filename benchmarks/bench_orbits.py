"""Branches of motions beyond contact loss and jump maps beside plain runs of the same equations.

    python -m benchmarks.bench_orbits [--values 26] [--speeds 800]

Seconds of processor time of one core, after compilation. The baseline of a branch is to let a run settle at
each of its speeds, up and down, for 400 mesh cycles: it finds stable motions only and no multipliers. That of
the map is a branch for each value by itself.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import floquet
import lumped
from floquet.gear.unilateral import unilateral_system

SPEEDS = (1000.0, 21000.0)
PAIR = lumped.load_gear_pair("nasa_28_28").with_(friction__law="none")
PLAIN = PAIR.with_(mesh__relief="ignored")
SETTLE = 400


def cpu(work: Callable[[], Any]) -> tuple[Any, float]:
    start = time.process_time()
    result = work()
    return result, time.process_time() - start


def settled(count: int) -> None:
    """Runs at so many speeds, up and down, each from the end of the one before."""
    state = floquet.periodic_orbit(PLAIN.with_({"operating.pinion_speed": SPEEDS[0]})).orbit.start
    rising = np.linspace(*SPEEDS, count)
    system = unilateral_system(PLAIN)
    cycle = 60.0 / PLAIN.pinion.teeth
    for rpm in (*rising, *rising[::-1]):
        state = system.run(state, cycle / rpm, SETTLE).end


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--values", type=int, default=26, help="torques of the map")
    parser.add_argument("--speeds", type=int, default=800, help="speeds of the map")
    arguments = parser.parse_args()
    floquet.response_branches(PLAIN, (8000.0, 8500.0), [1], seeds=0)  # compiles
    found, took = cpu(lambda: floquet.response_branches(PLAIN, SPEEDS, [1], seeds=0))
    orbits = sum(len(branch.orbits) for branch in found.branches)
    _, baseline = cpu(lambda: settled(orbits // 20))
    baseline *= 20.0
    print(
        f"branch of {orbits} orbits: {took:.2f} s; runs that settle: {baseline:.0f} s, "
        f"{baseline / took:.0f} times"
    )
    speeds = np.linspace(*SPEEDS, arguments.speeds)
    torques = np.linspace(20.0, 300.0, arguments.values)
    for name, pair in (("without relief", PLAIN), ("with relief", PAIR)):
        axes = {"speed_rpm": speeds, "torque": torques}
        _, took = cpu(lambda pair=pair, axes=axes: floquet.jump_map(pair, axes))
        alone = sum(
            cpu(lambda t=t, pair=pair: floquet.response_branches(
                pair.with_(operating__pinion_torque=t), SPEEDS, (1, 2), seeds=0))[1]
            for t in torques[:: max(1, arguments.values // 4)]
        ) * arguments.values / len(torques[:: max(1, arguments.values // 4)])  # fmt: skip
        print(
            f"map {arguments.values} x {arguments.speeds}, {name}: {took:.1f} s; "
            f"{took / alone:.2f} times the branches alone"
        )
    branches = floquet.response_branches(PLAIN, SPEEDS, (1, 2), seeds=0)
    removed, took = cpu(lambda: floquet.jumps_removed_by(branches, "damping_ratio"))
    print(f"damping that removes all jumps, {removed[0].value:.4f}: {took:.1f} s")


if __name__ == "__main__":
    main()
