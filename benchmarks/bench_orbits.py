"""Branches of motions beyond contact loss and jump maps beside plain runs of the same equations.

    python -m benchmarks.bench_orbits [--values 26] [--speeds 800]
    python -m benchmarks.bench_orbits --points    what docs/theory/orbits.md has of the 28/28 pair

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
from validation.exchange.new_pair_file import new_pair

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


def points() -> None:
    """Bifurcations of the 28/28 pair with prescribed contact, and what removes its last jump."""
    plain, relieved = (pair.with_(mesh__contact="prescribed") for pair in (PLAIN, PAIR))
    response = floquet.response_branches(plain, SPEEDS, (1, 2, 3))
    for one in sorted(response.bifurcations, key=lambda one: (one.n, one.speed_rpm)):
        if one.sharp and one.kind != "grazing":
            print(f"n = {one.n}, {one.kind}: {one.speed_rpm:.3f} rpm, rms {1e6 * one.dte_rms:.3f} um")
    struck = floquet.response_branches(plain, SPEEDS, [1], back_side=True)
    ends = sorted((one.speed_rpm, one.kind) for one in struck.bifurcations if one.sharp)
    print("with back sides:", ", ".join(f"{kind} {rpm:.0f} rpm" for rpm, kind in ends))
    print("no stable motion:", ", ".join(f"{low:.0f} to {high:.0f} rpm" for low, high in response.gaps))
    changed = relieved.with_(operating__pinion_torque=200.0)
    with_relief = floquet.response_branches(changed, SPEEDS, (1, 2), seeds=0)
    for branches, names in ((response, ["damping_ratio"]), (with_relief, ["tip_relief", "torque"])):
        for name in names:
            for end in floquet.jumps_removed_by(branches, name):
                print(f"no jump beyond {name} {end.value:.4f}, at {end.speed_rpm:.0f} rpm")


def attractors() -> None:
    """What does not repeat, of the 19/41 pair; of the longest one every point."""
    changes = {"mesh.stiffness": {"model": "rectangular"}, "mesh.damping_ratio": 0.04, "friction.law": "none"}
    pair = new_pair("19/41", 2.5, 20.0, 1450.0, 80.0, changes | {"mesh.contact": "prescribed"})
    attractors_of_pair = floquet.response_branches(pair, (12_000.0, 48_000.0)).attractors
    for one in attractors_of_pair:
        print(f"19/41, {one.kind}: {one.low_rpm:.1f} to {one.high_rpm:.1f} rpm")
    for point in max(attractors_of_pair, key=lambda one: one.high_rpm - one.low_rpm).points:
        error = f"{point.exponent:.3f} +- {point.uncertainty:.3f}"
        print(
            f"  {point.speed_rpm:.0f} rpm, {point.kind}: rms {1e6 * point.dte_rms:.1f} um, exponent {error}"
        )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--values", type=int, default=26, help="torques of the map")
    parser.add_argument("--speeds", type=int, default=800, help="speeds of the map")
    parser.add_argument("--points", action="store_true", help="bifurcations instead of times")
    arguments = parser.parse_args()
    if arguments.points:
        points()
        attractors()
        return
    floquet.response_branches(PLAIN, (8000.0, 8500.0), [1], seeds=0)  # compiles
    response, took = cpu(lambda: floquet.response_branches(PLAIN, SPEEDS, [1], seeds=0))
    orbits = sum(len(branch.orbits) for branch in response.branches)
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
