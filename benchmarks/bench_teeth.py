"""Teeth that differ: which form of contact is right, what do faults look like, how long does a period take?

    python -m benchmarks.bench_teeth [forms] [classes] [cracks] [faults] [times] [seeds]

The tables of docs/verification/teeth.md; all of them takes five minutes. No friction, rectangular stiffness.
The table of seeds is that of docs/verification/uncertainty.md: all of the pair as `spurcheck init` makes it.
"""

from __future__ import annotations

import math
import sys
import time
import warnings
from collections.abc import Sequence

import numpy as np
import xarray as xr

import lumped
from lumped.model.tooth_laws import ToothLaws
from validation.exchange.new_pair_file import new_pair
from validation.signals import indicators
from validation.signals.averages import sidebands

BASE = {"mesh.contact": "loaded", "operating.pinion_speed": 1450, "friction.law": "coulomb"}
BASE |= {"friction.coefficient": 0.0, "mesh.relief": "ignored"}
OTHER = {"pinion.teeth": 19, "gear.teeth": 41, "centre_distance": None}
OTHER |= {f"{gear}.{what}": None for gear in ("pinion", "gear") for what in ("tip_relief", "tip_diameter")}
ALIKE, UNLIKE = (lumped.load_gear_pair("nasa_28_28").with_(BASE | more) for more in ({}, OTHER))
FORMS = {"k": ("prescribed", "linear"), "o": ("loaded", "linear"), "x": ("loaded", "unilateral")}


def classed(number: int, first_seed: int = 1) -> dict[str, dict[str, int]]:
    """Both gears drawn within a tolerance class."""
    seeds = {"pinion": first_seed, "gear": first_seed + 1}
    return {f"{gear}.deviations": {"tolerance_class": number, "seed": seed} for gear, seed in seeds.items()}


STAIRCASE = [20.0 / math.cos(math.radians(20.0)) * math.cos(2.0 * math.pi * j / 19) for j in range(19)]
# 2 mm of the path round the pitch point, and 1.5 mm before its end.
_RADIUS = UNLIKE.geometry.base_radius_pinion
_G = UNLIKE.geometry
LOW, HIGH, END = np.degrees(np.array([_G.L_XP - 1e-3, _G.L_XP + 1e-3, _G.L_XD - 1.5e-3]) / _RADIUS)
SPALL = {"kind": "spall", "tooth": 4, "start_roll_angle": LOW, "end_roll_angle": HIGH, "width": 3.175}
CASES = {
    "like teeth": {"pinion.deviations": {"index": [0.0] * 19, "first_order": "steps"}},
    "eccentric 20 um": {"pinion.mounting": {"eccentricity": 20}},
    "as index list": {"pinion.deviations": {"index": STAIRCASE, "first_order": "steps"}},
    "class 6, both": classed(6),
    "crack 1 mm": {"pinion.faults": [{"kind": "crack", "tooth": 4, "depth": 1.0}]},
    "spall 2 mm, half width": {"pinion.faults": [SPALL]},
    "chip 1.5 mm": {"pinion.faults": [{"kind": "chip", "tooth": 4, "roll_angle": END}]},
}


def line(*cells: object) -> None:
    """A line of a table."""
    print(
        "|",
        " | ".join(f"{one:.3g}" if isinstance(one, float) else str(one) for one in cells),
        "|",
        flush=True,
    )


def motion(pair: lumped.GearPair, form: str) -> xr.Dataset:
    """Motion in one of ``FORMS``."""
    contact, touch = FORMS[form]
    return lumped.steady_state(pair.with_(mesh__contact=contact), contact=touch, samples_per_cycle=64)


def forms() -> None:
    """Effect of one late tooth of 28/28: error of the linear forms over the largest effect."""
    line("rpm", "e, um", *(f"({form})" for form in "ko"))
    for rpm, sizes in ((500, (1, 5, 20)), (1500, (5, 20, -20)), (4875, (5, -5, 20))):
        caused: dict[tuple[str, int], np.ndarray] = {}
        for form in FORMS:
            for size in (0, *sizes):
                index = [size / math.cos(math.radians(20.0))] + [0.0] * 27
                pair = ALIKE.with_(operating__pinion_speed=rpm)
                one = pair.with_({"pinion.deviations": {"index": index, "first_order": "steps"}})
                caused[form, size] = motion(one, form)["dte"].to_numpy()
        for size in sizes:
            effects = {form: caused[form, size] - caused[form, 0] for form in FORMS}
            wanted = effects["x"]
            line(rpm, size, *(float(np.abs(effects[f] - wanted).max() / np.abs(wanted).max()) for f in "ko"))


def classes() -> None:
    """Error of the transmission error of random 19/41 over its peak to peak; largest load over the mean."""
    force = UNLIKE.operating.pinion_torque / UNLIKE.geometry.base_radius_pinion
    line("class", "rpm", "(k)", "(o)", "load (k)", "load (x)", "lost, %")
    for number in (4, 6, 8):
        for rpm in (1450, 4000, 9000, 15000):
            pair = UNLIKE.with_(classed(number) | {"operating.pinion_speed": rpm})
            runs = {form: motion(pair, form) for form in FORMS}
            wanted = runs["x"]["dte"].to_numpy()
            errors = [float(np.abs(runs[f]["dte"].to_numpy() - wanted).max() / np.ptp(wanted)) for f in "ko"]
            loads = [float(runs[f]["normal_load"].max()) / force for f in "kx"]
            apart = runs["x"]["normal_load"].sum("pair").to_numpy() <= 0.0
            line(number, rpm, *errors, *loads, float(100.0 * apart.mean()))


def cracks() -> None:
    """Crack in 28/28: loss of stiffness at P and D, and E b times the added compliance at D."""
    line("q, mm", "E b x compliance", "over plane elements", "loss of k at P, %", "at D, %")
    g = ALIKE.geometry
    gear = ALIKE.pinion
    for depth, elements in ((0.5, 0.623), (1.0, 1.963), (2.0, 6.561), (3.0, 15.68)):
        faults = [{"kind": "crack", "tooth": 1, "depth": depth, "angle": 90}]
        laws = ToothLaws(ALIKE.with_({"pinion.faults": faults}))
        places = np.array([g.L_XP, g.L_XD - 1e-9])
        sound, cracked = (laws.of_kind(kind, places)["stiffness"] for kind in (0, 1))
        added_compliance = float((1.0 / cracked - 1.0 / sound)[1]) * gear.youngs_modulus * g.face_width
        line(
            depth, added_compliance, added_compliance / elements, *(100.0 * (1.0 - cracked / sound)).tolist()
        )


def faults() -> None:
    """19/41 with faults on the pinion: transmission error at its orders, residual and FM4 of x_p''."""
    orders = (1, 2, 17, 18, 19, 20, 21, 37, 39)
    line("", *orders, "residual", "FM4", "load", "s")
    force = UNLIKE.operating.pinion_torque / UNLIKE.geometry.base_radius_pinion
    for name, changes in CASES.items():
        start = time.process_time()
        run = lumped.steady_state(UNLIKE.with_(changes), contact="unilateral")
        took = time.process_time() - start
        turns = run.attrs["period_cycles"] // 19
        size = 2e9 * np.abs(np.fft.rfft(run.dte.values)) / run.dte.size
        signal = indicators(run)["value"].sel(record="pair")
        shown = [float(signal.sel(indicator=one)) for one in ("RMS_residual", "FM4")]
        load = float(run.normal_load.max()) / force
        line(name, *(f"{size[n * turns]:.1f}" for n in orders), *shown, load, took)


def times() -> None:
    """Wall and processor time of a hunting period of class 6, the best of six."""
    line("pair", "contact", "touch", "wall, s", "processor, s")
    for teeth in ((19, 41), (37, 71)):
        pair = UNLIKE.with_(classed(6) | {"pinion.teeth": teeth[0], "gear.teeth": teeth[1]})
        for contact, touch in (("loaded", "unilateral"), ("loaded", "linear"), ("prescribed", "linear")):
            took = []
            for _ in range(6):
                start = time.perf_counter(), time.process_time()
                lumped.steady_state(pair.with_(mesh__contact=contact), contact=touch)
                took.append((time.perf_counter() - start[0], time.process_time() - start[1]))
            line(f"{teeth[0]}/{teeth[1]}", contact, touch, *map(min, zip(*took, strict=True)))


def seeds() -> None:
    """64 pairs of seeds of class 6 on 19/41, 1450 rpm, 80 N m: 5, 50 and 95 % of a linear hunting period."""
    pair = new_pair("19/41", 2.5, 20.0, 1450.0, 80.0)
    percentages = []
    start = time.process_time()
    for seed in range(1, 129, 2):
        run = lumped.steady_state(pair.with_(classed(6, seed)), contact="linear", samples_per_cycle=32)
        row = {"peak to peak, um": 1e6 * run.attrs["dte_peak_to_peak"]}
        mesh = np.fft.rfft(run["dte"].to_numpy())[run.attrs["period_cycles"]]
        row["mesh order, um"] = 2e6 * float(np.abs(mesh)) / run.sizes["time"]
        for gear in ("pinion", "gear"):
            beside = sidebands(run, gear, most=1)
            for side in (-1, 1):
                row[f"{gear}, z{side:+d}, %"] = 100.0 * float(beside["ratio"][0].sel(sideband=side))
        percentages.append(row)
    for name in percentages[0]:
        line(name, *np.percentile([row[name] for row in percentages], (5, 50, 95)).tolist())
    line("processor seconds a pair", (time.process_time() - start) / len(percentages))


def main(names: Sequence[str]) -> None:
    """Print the tables of these names, or all."""
    warnings.simplefilter("ignore")
    tables = (forms, classes, cracks, faults, times, seeds)
    for table in tables:
        if not names or table.__name__ in names:
            print(f"\n{table.__doc__}\n")
            table()


if __name__ == "__main__":
    main(sys.argv[1:])
