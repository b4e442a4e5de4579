"""What do teeth that differ look like, and how long does a hunting period take?

    python benchmarks/bench_teeth.py

The table: 19/41 with faults on the pinion, transmission error at orders of the pinion in nm, largest load
over the mean one, processor time.
"""

from __future__ import annotations

import math
import time

import numpy as np

import lumped

BASE = {"mesh.contact": "loaded", "operating.pinion_speed": 1450, "friction.law": "coulomb"}
BASE |= {
    "friction.coefficient": 0.0,
    "pinion.tip_relief": None,
    "gear.tip_relief": None,
    "centre_distance": None,
}
STAIRCASE = [20.0 / math.cos(math.radians(20.0)) * math.cos(2.0 * math.pi * j / 19) for j in range(19)]
CLASS_6 = {
    "pinion.deviations": {"tolerance_class": 6, "seed": 1},
    "gear.deviations": {"tolerance_class": 6, "seed": 2},
}
SPALL = {"kind": "spall", "tooth": 4, "start_roll_angle": 20, "end_roll_angle": 24.3, "width": 3.175}
CASES = {
    "healthy": {"pinion.deviations": {"index": [0.0] * 19, "first_order": "steps"}},
    "eccentric 20 um": {"pinion.mounting": {"eccentricity": 20}},
    "as index list": {"pinion.deviations": {"index": STAIRCASE, "first_order": "steps"}},
    "class 6, both": CLASS_6,
    "crack 1 mm": {"pinion.faults": [{"kind": "crack", "tooth": 4, "depth": 1.0}]},
    "spall, half width": {"pinion.faults": [SPALL]},
    "chip": {"pinion.faults": [{"kind": "chip", "tooth": 4, "roll_angle": 34.0}]},
}


def table(touch: str = "push_only") -> None:
    """Print a line for each case."""
    healthy = lumped.load_gear_pair("nasa_28_28").with_({**BASE, "pinion.teeth": 19, "gear.teeth": 41})
    force = 56.5 / healthy.geometry.base_radius_pinion
    orders = (1, 2, 17, 18, 19, 20, 21, 37, 39)
    print("orders", *orders, "load", "seconds", sep="\t")
    for name, changes in CASES.items():
        start = time.process_time()
        run = lumped.steady_state(healthy.with_(changes), touch=touch)
        took = time.process_time() - start
        turns = run.attrs["period_cycles"] // 19
        size = 2e9 * np.abs(np.fft.rfft(run.dte.values)) / run.dte.size
        values = [f"{size[order * turns]:.1f}" for order in orders]
        print(name, *values, f"{float(run.normal_load.max()) / force:.2f}", f"{took:.2f}", sep="\t")


def times() -> None:
    """Print the time of a hunting period, push-only and linear."""
    for teeth in ((19, 41), (37, 71)):
        pair = lumped.load_gear_pair("nasa_28_28").with_(
            {**BASE, "pinion.teeth": teeth[0], "gear.teeth": teeth[1]}
        )
        pair = pair.with_(CLASS_6)
        for contact, touch in (("loaded", "push_only"), ("loaded", "linear"), ("prescribed", "linear")):
            start = time.process_time()
            lumped.steady_state(pair.with_(mesh__contact=contact), touch=touch)
            print(*teeth, contact, touch, f"{time.process_time() - start:.2f} s")


if __name__ == "__main__":
    table()
    times()
