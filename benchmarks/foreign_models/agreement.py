"""Agreement of the sound, fine motions of the users with ``lumped.steady_state``, at all operating points.

python -m benchmarks.foreign_models.agreement [judging|fourth]
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

import lumped
from benchmarks.foreign_models.differences import orders_of
from benchmarks.foreign_models.fourth import FOURTH_SOUND, FOURTH_WRONG
from benchmarks.foreign_models.fourth_pairs import at
from benchmarks.foreign_models.recipe import Recipe, Settings
from benchmarks.foreign_models.sound import RUNS, changed_pair, is_torsional
from benchmarks.foreign_models.third import THIRD_WRONG
from benchmarks.foreign_models.third_two import THIRD_TWO

SIX = ("dte", "x_p", "x_g", "y_p", "y_g", *(f"bearing_force_{a}_{e}" for a in "xy" for e in "pg"))


class Point(NamedTuple):
    """Operating point: a pair as a mapping, and what the sound user of it models."""

    pair: Mapping[str, Any]
    unilateral: bool
    torsional: bool


def operating_points(arguments: list[str]) -> Iterator[Point]:
    """Operating points of the first set; of the third with "judging", of the fourth with "fourth"."""
    if "fourth" in arguments:
        for case in FOURTH_WRONG:
            yield Point(case.pair, case.unilateral, case.torsional)
        for name, speed, torque, unilateral in (one.point for one in FOURTH_SOUND):
            yield Point(at(name, speed, torque), unilateral, torsional=False)
        return
    if "judging" in arguments:
        for one in (*THIRD_WRONG, *THIRD_TWO):
            yield Point(one.pair, one.unilateral, one.torsional)
        return
    for run in RUNS:
        pair = changed_pair(run.pair, run.speed, run.torque)
        yield Point(pair, run.unilateral, is_torsional(run.pair))


def main(arguments: list[str]) -> None:
    """Print, for each operating point, how far complex orders and means are off [%].

    The argument "judging" takes the third set, "fourth" the fourth.
    """
    warnings.simplefilter("ignore")
    print("| pair | rpm | N m | contact | orders 1 to 40: largest | of dte | means: largest |")
    print("|---|---|---|---|---|---|---|")
    for pair, unilateral, torsional in operating_points(arguments):
        contact = "unilateral" if unilateral else "linear"
        ours = lumped.steady_state(pair, contact=contact, samples_per_cycle=512)
        silent = ("y_p", "y_g", "bearing_force_y_p", "bearing_force_y_g")
        names = [name for name in SIX if pair["friction"]["law"] != "none" or name not in silent]
        names = ["dte"] if torsional else names
        recipe = Recipe(pair, Settings(channels=tuple(names)), unilateral, torsional).sound
        theirs = recipe()
        period = recipe.user_model.period
        off, mean = {}, {}
        for name in names:
            mine = orders_of(theirs["time"], theirs[name], period)[0]
            reference = orders_of(ours["time"].to_numpy(), ours[name].to_numpy(), period)[0]
            off[name] = np.linalg.norm((mine - reference)[1:]) / np.linalg.norm(reference[1:])
            mean[name] = abs((mine[0] - reference[0]).real) / max(
                abs(reference[0]), np.ptp(ours[name].to_numpy())
            )
        point = pair["operating"]
        cells = (pair["name"], f"{point['pinion_speed']:.0f}", f"{point['pinion_torque']:g}", contact)
        numbers = (max(off.values()), off["dte"], max(mean.values()))
        print("| " + " | ".join((*cells, *(f"{100 * one:.2f}" for one in numbers))) + " |", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
