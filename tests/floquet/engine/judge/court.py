"""Every bound and verdict against ball arithmetic.

    python tests/floquet/engine/judge/court.py [--count 40] [--kind KIND ...] [--seed 1] [--jobs 2]

It prints a table; `tests/floquet/engine/judge/test_judge.py` runs a sample of it with the suite.
"""

import argparse
import math
import sys
import time
import warnings
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from floquet import fast_multipliers, gear_block, gear_pair_multipliers, stability_chart
from floquet.gear.axes import operating_rpm
from lumped import GearPair
from lumped.errors import LawRangeWarning, NumericalError, ParameterError

sys.path.insert(0, str(Path(__file__).parent))

from balls import exact_multipliers
from findings import Disks, Finding, finding
from formulas import formula
from gears import MODELS, pieces, random_pair

SPECIAL = ("tongue edge", "collision", "low speed")
KINDS = (*MODELS, *SPECIAL, "formula")


def judge(kind: str, seed: int) -> list[Finding]:
    """Findings on one random system."""
    rng = np.random.default_rng([seed, KINDS.index(kind)])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LawRangeWarning)
        if kind == "formula":
            return formula(rng)
        pair = _pair(rng, kind)
        return _routes(kind, pair, exact_multipliers(partial(pieces, pair), 6))


def _pair(rng: np.random.Generator, kind: str) -> GearPair:
    while True:
        try:
            pair = random_pair(rng, kind if kind in MODELS else str(rng.choice(MODELS)))
            if kind == "low speed":
                return pair.with_({"operating.pinion_speed": float(rng.uniform(100.0, 500.0))})
            return _special(rng, kind, pair) if kind in SPECIAL else _checked(pair)
        except (ParameterError, NumericalError):  # a law refuses the operating point, or no tongue is near
            continue


def _checked(pair: GearPair) -> GearPair:
    gear_block(pair)
    return pair


def _special(rng: np.random.Generator, kind: str, pair: GearPair) -> GearPair:
    """Speed at which rho = 1 to rounding, or two multipliers nearly meet."""
    changes: dict[str, object] = {"mesh.damping_ratio": 0.0 if kind == "collision" else 0.002}
    for gear in ("pinion", "gear"):
        changes[f"bearings.{gear}.loa_damping_ratio"] = 0.0 if kind == "collision" else 0.002
    if kind == "collision":
        changes["friction.law"] = "none"
    pair = pair.with_(changes)
    block = gear_block(pair)
    operating_speed = operating_rpm(pair)
    speeds = operating_speed * np.exp(np.linspace(-0.7, 0.7, 400))

    def measure(speed: np.ndarray) -> np.ndarray:
        multipliers = fast_multipliers(block, block.period * operating_speed / speed).multipliers
        return np.asarray(np.abs(multipliers).max(axis=1) - 1.0 - (1e-6 if kind == "collision" else 0.0))

    values = measure(speeds)
    changes_at = np.flatnonzero(values[1:] * values[:-1] < 0.0)
    if changes_at.size == 0:
        raise NumericalError("no tongue is near")
    chosen = int(rng.choice(changes_at))
    low, high = speeds[chosen], speeds[chosen + 1]
    for _ in range(int(rng.choice([15, 30, 45]))):
        middle = 0.5 * (low + high)
        if measure(np.array([middle]))[0] * values[chosen] > 0.0:
            low = middle
        else:
            high = middle
    return pair.with_({"operating.pinion_speed": float(low)})  # [rpm], as in files


def _routes(kind: str, pair: GearPair, truth: Disks) -> list[Finding]:
    fast = fast_multipliers(gear_block(pair))
    chart = stability_chart(pair, {"speed_rpm": [operating_rpm(pair)]}, rtol=1e-8, store="all", refine=False)
    general = gear_pair_multipliers(pair, 1e-9)
    return [
        finding(kind, "kernel", fast.multipliers[0], fast.errors[0], truth, "proven"),
        *_of_ten(kind, "chart", chart.isel(speed_rpm=0), general.oloa, truth),
        *_of_ten(kind, "pair", general, general.oloa, truth),
    ]


def _of_ten(kind: str, route: str, result: Any, oloa: np.ndarray, truth: Disks) -> list[Finding]:
    """Finding on the six multipliers that are not the bearings' off the line of action, if they differ."""
    values = np.asarray(result.multipliers)
    errors = np.asarray(result.multiplier_errors)
    certificate = result.attrs["certificate"] if route.startswith("chart") else result.certificate
    feedback = np.abs(values[:, None] - oloa).min(axis=1) > 1e-12 * (1.0 + np.abs(values))
    if feedback.sum() != 6:
        return []
    return [finding(kind, route, values[feedback], errors[feedback], truth, certificate)]


def table(findings: Sequence[Finding]) -> str:
    """Markdown table of all findings, one row for each kind and route."""
    lines = [
        "| system | route | certificate | count | worst error/bound | false | wrong verdicts | undecided |",
        "|---|---|---|---|---|---|---|---|",
    ]
    keys = dict.fromkeys((f.kind, f.route, f.certificate) for f in findings)

    def place(key):
        kind, route, certificate = key
        return KINDS.index(kind), route, certificate

    for kind, route, certificate in sorted(keys, key=place):
        group = [f for f in findings if (f.kind, f.route, f.certificate) == (kind, route, certificate)]
        false = sum(f.ratio > 1.0 for f in group)
        wrong = sum(f.wrong for f in group)
        undecided = sum(f.undecided for f in group)
        worst = max(f.ratio for f in group)
        cells = (kind, route, certificate, len(group), f"{worst:.1e}", false, wrong, undecided)
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=40, help="random systems of each kind")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kind", choices=KINDS, nargs="+", default=KINDS)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--minutes", type=float, default=math.inf, help="end with what is done by then")
    arguments = parser.parse_args()
    tasks = [(kind, arguments.seed * 100_000 + i) for i in range(arguments.count) for kind in arguments.kind]
    findings: list[Finding] = []
    with ProcessPoolExecutor(arguments.jobs) as pool:
        waiting = {pool.submit(judge, *task): task for task in tasks}
        end = time.monotonic() + 60.0 * arguments.minutes
        for future in as_completed(waiting):
            if time.monotonic() > end:
                pool.shutdown(wait=False, cancel_futures=True)
                break
            try:
                findings_of_pair = future.result()
            except ValueError as error:
                print(*waiting[future], error, file=sys.stderr, flush=True)
                continue
            findings += findings_of_pair
            for one in findings_of_pair:
                if one.ratio > 1.0 or one.wrong:
                    print(*waiting[future], one, file=sys.stderr, flush=True)
    print(table(findings))


if __name__ == "__main__":
    main()
