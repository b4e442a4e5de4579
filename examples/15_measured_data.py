"""
Which friction coefficient do my measurements show?
===================================================

A record of normal and friction forces of one gauged tooth pair is checked against the prediction: all mesh
cycles are laid over each other, and what would explain the difference is searched. The record is computed
with a coefficient of 0.04 and 2 % noise, so that the truth is known; the parameter file says 0.08. Yours is a
CSV file beside a small TOML file, or a mapping as here.
"""

import numpy as np
from matplotlib.figure import Figure

import lumped
import spurcheck
from validation.check import Check

TRUE_MU = 0.04
ASSUMED_MU = 0.08
#: Mesh cycles from A to the first sample, samples in a mesh cycle, revolutions.
PHASE, PER_CYCLE, REVOLUTIONS = 0.37, 100.3, 6


def gear_pair(mu: float) -> lumped.GearPair:
    """The 28/28 pair at 79.1 N m and 800 rpm, with a constant coefficient of friction."""
    pair = lumped.load_gear_pair("nasa_28_28")
    return pair.with_(torque=79.1, speed=800.0, friction={"law": "coulomb", "coefficient": mu})


def measured() -> dict[str, object]:
    """Forces of a pinion tooth while it is in contact; it comes again after 28 mesh cycles."""
    pair = gear_pair(TRUE_MU)
    motion = spurcheck.predict(pair).cycle
    teeth, period = pair.pinion.teeth, pair.geometry.mesh_period
    cycles = np.arange(0.0, REVOLUTIONS * teeth, 1.0 / PER_CYCLE)
    since_start = (cycles + PHASE) % teeth
    # With loaded contact a pair touches before A: its place on the path says which pitch it is in.
    pitches = (motion["position"].to_numpy() - pair.geometry.L_XA) / pair.geometry.base_pitch
    order = np.argsort(pitches.ravel())
    rng = np.random.default_rng(4)
    record: dict[str, object] = {
        "name": "tooth forces", "role": "measurement", "recurrence": teeth, "pinion_speed": "800 rpm",
        "pinion_torque": "79.1 N*m", "time [s]": cycles * period,
    }  # fmt: skip
    for name in ("normal_load", "friction_force"):
        life = motion[name].to_numpy().ravel()[order]
        force = np.interp(since_start, pitches.ravel()[order], life, left=0.0, right=0.0)
        noise = 0.02 * float(np.abs(force).max())
        record[f"{name}_A [N]"] = force + noise * rng.standard_normal(cycles.size)
    return record


def compute(budget: float = 30.0) -> Check:
    """The record beside the pair whose file says 0.08; explanations are searched for ``budget`` seconds."""
    return spurcheck.check(gear_pair(ASSUMED_MU), measured(), budget=budget)


def draw(check: Check) -> Figure:
    """Both forces over the mesh cycles since A, and their orders; the sentence says what differs."""
    return check.plot()


if __name__ == "__main__":
    result = compute()
    print(result)
    draw(result).savefig("measured_data.png", dpi=150)
