"""What plane finite elements of a pair cost, and how far k(t) is from that of finer meshes.

    python -m benchmarks.bench_elasticity [PAIRS]

prints the table of docs/theory/elasticity.md, "Cost and error". Times are processor seconds without the
cache, the median of five. The baseline, in the same run, is one dense linear solve with 1000 unknowns on one
thread (``numpy.linalg.solve``). The error is the largest over the mesh cycle, beside elements of a third of
the size; the last column has that of elements of half the size.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable
from contextlib import contextmanager
from unittest import mock

import numpy as np

from lumped import GearPair, plane_compliance
from lumped.elasticity.blas import one_thread
from lumped.elasticity.gear import FINE, flank_compliance
from lumped.stiffness import finite_elements
from lumped.stiffness.finite_elements import elastic_teeth
from validation.exchange import new_pair

RUNS = 5
UNKNOWNS = 1000
PHASES = 200
_LONG = {"basic_rack.fillet_radius_coefficient": 0.3}
#: Teeth, module, face width, speed, torque, what else is known: shifts, bores, long teeth, a wide angle.
DRAWN = [
    ("17/103", 4.0, 40.0, 1500.0, 300.0, {"pinion.profile_shift": 0.35}),
    ("19/41", 3.0, 25.0, 1500.0, 100.0, {"pinion.bore": 20.0, "gear.bore": 40.0}),
    ("23/81", 2.0, 20.0, 3000.0, 60.0, {"pinion.profile_shift": 0.4, "gear.profile_shift": -0.2}),
    ("25/103", 2.5, 30.0, 1500.0, 150.0, {"gear.bore": 80.0}),
    ("28/29", 3.175, 6.35, 4000.0, 56.0, {}),
    ("31/67", 1.5, 15.0, 6000.0, 20.0, _LONG | {
        "basic_rack.addendum_coefficient": 1.25, "basic_rack.dedendum_coefficient": 1.5}),
    ("40/97", 5.0, 60.0, 900.0, 2000.0, {"pinion.bore": 90.0, "gear.bore": 300.0}),
    ("21/34", 6.0, 70.0, 1200.0, 1500.0, {
        "pinion.profile_shift": 0.5, "gear.profile_shift": 0.3, "pinion.bore": 50.0}),
    ("53/59", 1.0, 8.0, 2000.0, 5.0, _LONG | {
        "basic_rack.addendum_coefficient": 1.3, "basic_rack.dedendum_coefficient": 1.55}),
    ("18/22", 0.5, 5.0, 10000.0, 0.2, _LONG | {"basic_rack.pressure_angle": 25.0}),
]  # fmt: skip


@contextmanager
def solved_again():
    """No results of earlier calls, neither of this process nor from the disk."""
    flank_compliance.cache_clear()
    with mock.patch("lumped.elasticity.gear.cached", lambda folder, sources, inputs, compute: compute()):
        yield


def seconds(call: Callable[[], object]) -> float:
    """Median of the processor time of some calls."""
    durations = []
    for _ in range(RUNS):
        start = time.process_time()
        call()
        durations.append(time.process_time() - start)
    return statistics.median(durations)


def solve(pair: GearPair) -> None:
    """Both gears of a pair."""
    with solved_again():
        for tooth in elastic_teeth(pair):
            tooth.flank.deflection(tooth.flank.interval[0])


def mesh_stiffness(pair: GearPair, size: float) -> np.ndarray:
    """k(t) with neighbours, by elements of a size at the surface [N/m]."""
    one = lambda gear, _=FINE: flank_compliance(gear, size)  # noqa: E731
    with solved_again(), mock.patch.object(finite_elements, "flank_compliance", one):
        return plane_compliance(pair, phases=PHASES).mesh_stiffness.to_numpy()


def baseline() -> float:
    """Processor time of the dense solve."""
    rng = np.random.default_rng(1)
    matrix = rng.standard_normal((UNKNOWNS, UNKNOWNS))
    right = rng.standard_normal(UNKNOWNS)
    with one_thread():
        return seconds(lambda: np.linalg.solve(matrix, right))


def main(count: int) -> None:
    print("| pair | contact ratio | s | over a dense solve | error of k(t) | of the finer mesh |")
    print("|---|---|---|---|---|---|")
    for teeth, *drawing, changes in DRAWN[:count]:
        pair = new_pair(teeth, *drawing, changes=changes)
        dense = baseline()
        solve_seconds = seconds(lambda pair=pair: solve(pair))
        fine, half, third = (mesh_stiffness(pair, FINE / n) for n in (1, 2, 3))
        error, rest = (float(np.abs(k / third - 1.0).max()) for k in (fine, half))
        ratio = f"{pair.geometry.contact_ratio:.2f}"
        print(
            f"| {teeth} | {ratio} | {solve_seconds:.2f} | {solve_seconds / dense:.0f} | {error:.1e} "
            f"| {rest:.0e} |",
            flush=True,
        )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else len(DRAWN))
