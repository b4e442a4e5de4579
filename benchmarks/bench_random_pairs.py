"""Random pairs as users ask for them: how often, in what and why do the lumped and the exact model differ?

    python -m benchmarks.bench_random_pairs [--pairs 110] [--seed 9] [--write FOLDER]

The counts of docs/theory/multibody.md, "The verdict". --write only writes the pairs as parameter files.
"""

from __future__ import annotations

import argparse
import math
import re
import warnings
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from lumped import GearPair
from lumped.errors import NumericalError, ParameterError
from validation.cross_check.comparison import CrossCheck, crosscheck
from validation.cross_check.verdict import Verdict
from validation.cross_check.words import cause_of_difference
from validation.exchange.new_pair_file import new_pair, parameter_text

MODULES = (1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0)
#: Of eleven pairs eight are as `init` makes them; one each is on shafts, has shifts, has relief.
KINDS = ("plain",) * 8 + ("shafts", "shift", "relief")
FASTEST = 40.0  # at the reference circle, m/s


def drawn(count: int, seed: int) -> Iterator[tuple[str, GearPair]]:
    """Kind and pair; pairs that cannot exist are drawn again."""
    rng = np.random.default_rng(seed)
    drawn_count = 0
    while drawn_count < count:
        kind = KINDS[drawn_count * len(KINDS) // count]
        z1 = int(rng.integers(15, 41))
        z2 = round(z1 * rng.uniform(1, 4))
        m = float(rng.choice(MODULES))
        width = round(m * rng.uniform(6, 14), 1)
        d1 = m * z1
        most = min(15_000.0, FASTEST / (math.pi * d1 * 1e-3) * 60.0)
        speed = round(math.exp(rng.uniform(math.log(100.0), math.log(most))))
        load = math.exp(rng.uniform(math.log(20.0), math.log(300.0)))  # N/mm
        torque = float(f"{load * width * d1 / 2 * 1e-3:.3g}")
        try:
            pair = new_pair((z1, z2), m, width, speed, torque)
            pair = pair.with_(CHANGES[kind](pair, rng))
        except ParameterError:
            continue
        drawn_count += 1
        yield kind, pair


def shafts(pair: GearPair, rng: np.random.Generator) -> dict[str, Any]:
    """Each gear in the middle of a shaft of half its reference diameter, or so, in two bearings."""
    length = float(round(rng.uniform(2, 5) * 1e3 * pair.pinion.face_width + 60))
    changes: dict[str, Any] = {"damping_ratio": 0.03}
    for name, gear in (("pinion", pair.pinion), ("gear", pair.gear)):
        size = 1e3 * pair.basic_rack.module * gear.teeth
        half = {"length": length / 2, "diameter": float(round(max(10.0, size * rng.uniform(0.35, 0.55))))}
        ends = ({"position": z, "loa_stiffness": 2e8, "oloa_stiffness": 2e8} for z in (10.0, length - 10.0))
        changes[name] = {"gear_position": length / 2, "segments": [half, half], "bearings": list(ends)}
    return {"shafts": changes}


def shifts(pair: GearPair, rng: np.random.Generator) -> dict[str, Any]:
    one = round(float(rng.uniform(0.1, 0.5)), 2)
    other = round(float(rng.uniform(-0.2, 0.3)), 2)
    return {"pinion.profile_shift": one, "gear.profile_shift": other, "centre_distance": None}


def relief(pair: GearPair, rng: np.random.Generator) -> dict[str, Any]:
    """Of both tips, from within the double contact on."""
    amount = float(round(rng.uniform(5, 40)))
    g = pair.geometry
    start = g.base_pitch + rng.uniform(0.0, 0.5) * (g.L_XD - g.L_XA - g.base_pitch)
    angles = (g.L_XA + start) / g.base_radius_pinion, (g.L_XY - g.L_XD + start) / g.base_radius_gear
    return {
        f"{name}.tip_relief": {"amount": amount, "start_roll_angle": round(math.degrees(angle), 2)}
        for name, angle in zip(("pinion", "gear"), angles, strict=True)
    }


CHANGES: dict[str, Any] = {
    "plain": lambda pair, rng: {}, "shafts": shafts, "shift": shifts, "relief": relief,
}  # fmt: skip


def compared(pair: GearPair) -> CrossCheck:
    """Only what decides between "agrees" and "differs"."""
    return crosscheck(pair, cycles=6, fidelities=("exact",), supports="springs")


def cause(check: CrossCheck) -> tuple[str, str]:
    """Return the effect that the cross-check names, and the difference without this effect."""
    text = cause_of_difference(check)
    if text.startswith("No effect"):
        return "where teeth touch", ""
    remainder = re.search(r"differs by (.*?)\.(?: |$)", text)
    return "free shafts" if "free shafts" in text else "friction", remainder[1] if remainder else ""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pairs", type=int, default=110)
    parser.add_argument("--seed", type=int, default=9)
    parser.add_argument("--write", type=Path)
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")
    verdicts: Counter[str] = Counter()
    print("| pair | kind | m, mm | rpm | N m | quantity | %, limit | effect | without it | half torque, % |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for number, (kind, pair) in enumerate(drawn(arguments.pairs, arguments.seed)):
        if arguments.write is not None:
            arguments.write.mkdir(parents=True, exist_ok=True)
            (arguments.write / f"p{number:03d}.toml").write_text(parameter_text(pair.to_mapping()))
            continue
        try:
            check = compared(pair)
        except NumericalError:
            verdicts["not computed"] += 1
            continue
        word = check.verdict.word
        if check.verdict is Verdict.DIFFERS:
            (why, without) = cause(check)
            worst = check.worst("exact")
            torque = pair.operating.pinion_torque
            word += f": {why}"
            half = compared(pair.with_(operating__pinion_torque=0.5 * torque)).of("exact")
            remaining = next(a.difference for a in half if a.quantity == worst.quantity)
            rpm = pair.operating.pinion_speed * 30.0 / math.pi
            cells = f"{pair.pinion.teeth}/{pair.gear.teeth} | {kind} | {1e3 * pair.basic_rack.module:g} | "
            cells += f"{rpm:.0f} | {torque:g} | {worst.quantity} | {100 * worst.difference:.3g}, "
            cells += f"{100 * worst.limit:g} | {why} | {without} | {100 * remaining:.3g}"
            print(f"| {cells} |", flush=True)
        verdicts[word] += 1
    print(", ".join(f"{count} {word}" for word, count in sorted(verdicts.items())))


if __name__ == "__main__":
    main()
