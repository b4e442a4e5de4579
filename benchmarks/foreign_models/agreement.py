"""Agreement of the sound, fine motions of the users with ``lumped.steady_state``, at all operating points.

python -m benchmarks.foreign_models.agreement
"""

from __future__ import annotations

import warnings

import numpy as np

import lumped
from benchmarks.foreign_models.differences import orders_of
from benchmarks.foreign_models.recipe import Recipe, Settings
from benchmarks.foreign_models.sound import RUNS, changed_pair, is_torsional

SIX = ("dte", "x_p", "x_g", "y_p", "y_g", *(f"bearing_force_{a}_{e}" for a in "xy" for e in "pg"))


def main() -> None:
    """Print, for each operating point, how far complex orders and means are off [%]."""
    warnings.simplefilter("ignore")
    print("| pair | rpm | N m | contact | orders 1 to 40: largest | of dte | means: largest |")
    print("|---|---|---|---|---|---|---|")
    for run in RUNS:
        pair = changed_pair(run.pair, run.speed, run.torque)
        contact = "unilateral" if run.unilateral else "linear"
        ours = lumped.steady_state(pair, contact=contact, samples_per_cycle=512)
        torsional = is_torsional(run.pair)
        silent = ("y_p", "y_g", "bearing_force_y_p", "bearing_force_y_g")
        names = [name for name in SIX if pair["friction"]["law"] != "none" or name not in silent]
        names = ["dte"] if torsional else names
        recipe = Recipe(pair, Settings(channels=tuple(names)), run.unilateral, torsional).sound
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
        cells = (run.pair, f"{run.speed:.0f}", f"{run.torque:g}", contact)
        numbers = (max(off.values()), off["dte"], max(mean.values()))
        print("| " + " | ".join((*cells, *(f"{100 * one:.2f}" for one in numbers))) + " |", flush=True)


if __name__ == "__main__":
    main()
