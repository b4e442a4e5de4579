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
from flint import acb, ctx

from floquet import fast_multipliers, gear_block, gear_pair_multipliers, stability_chart
from floquet.gear.axes import GearVariation, operating_rpm, vary
from floquet.gear.block import feedback_system
from floquet.gear.multipliers import OffLineOfAction
from lumped import GearPair
from lumped.errors import LawRangeWarning, NumericalError, ParameterError
from lumped.model.periodic_system import periodic_system

sys.path.insert(0, str(Path(__file__).parent))

from balls import BITS, exact_multipliers
from findings import Disks, Finding, finding
from formulas import black_box, formula, matrices
from gears import MODELS, ball, pieces, random_pair

SPECIAL = ("tongue edge", "collision", "low speed")
KINDS = (
    *MODELS, *SPECIAL, "stiffness variation", "law over speed", "speeds", "bearings",
    "formula", "black box", "matrices",
)  # fmt: skip


def judge(kind: str, seed: int) -> list[Finding]:
    """Findings on one random system.

    Raises
    ------
    ValueError : ball arithmetic does not tell its multipliers apart
    """
    rng = np.random.default_rng([seed, KINDS.index(kind)])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LawRangeWarning)
        if kind == "formula":
            return formula(rng)
        if kind == "matrices":
            return matrices(rng)
        if kind == "black box":
            return black_box(rng)
        if kind in _OF_PAIRS:
            return _OF_PAIRS[kind](rng)
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
    own = operating_rpm(pair)
    speeds = own * np.exp(np.linspace(-0.7, 0.7, 400))

    def measure(speed: np.ndarray) -> np.ndarray:
        found = fast_multipliers(block, block.period * own / speed).multipliers
        return np.asarray(np.abs(found).max(axis=1) - 1.0 - (1e-6 if kind == "collision" else 0.0))

    values = measure(speeds)
    changes_at = np.flatnonzero(values[1:] * values[:-1] < 0.0)
    if changes_at.size == 0:
        raise NumericalError("no tongue is near")
    at = int(rng.choice(changes_at))
    low, high = speeds[at], speeds[at + 1]
    for _ in range(int(rng.choice([15, 30, 45]))):
        middle = 0.5 * (low + high)
        if measure(np.array([middle]))[0] * values[at] > 0.0:
            low = middle
        else:
            high = middle
    return pair.with_({"operating.pinion_speed": float(low)})  # [rpm], as in files


def _routes(kind: str, pair: GearPair, truth: Disks) -> list[Finding]:
    found = fast_multipliers(gear_block(pair))
    chart = stability_chart(pair, {"speed_rpm": [operating_rpm(pair)]}, rtol=1e-8, store="all", refine=False)
    own = gear_pair_multipliers(pair, 1e-9)
    return [
        finding(kind, "kernel", found.multipliers[0], found.errors[0], truth, "proven"),
        *_of_ten(kind, "chart", chart.isel(speed_rpm=0), own.oloa, truth),
        *_of_ten(kind, "pair", own, own.oloa, truth),
    ]


def _of_ten(kind: str, route: str, found: Any, oloa: np.ndarray, truth: Disks) -> list[Finding]:
    """Finding on the six multipliers that are not the bearings' off the line of action, if they differ."""
    values, errors = np.asarray(found.multipliers), np.asarray(found.multiplier_errors)
    certificate = found.attrs["certificate"] if route.startswith("chart") else found.certificate
    feedback = np.abs(values[:, None] - oloa).min(axis=1) > 1e-12 * (1.0 + np.abs(values))
    if feedback.sum() != 6:
        return []
    return [finding(kind, route, values[feedback], errors[feedback], truth, certificate)]


def _stiffness_variation(rng: np.random.Generator) -> list[Finding]:
    """A chart over the variation of the total stiffness about its mean."""
    kind = "stiffness variation"
    while True:
        pair, factor = _pair(rng, str(rng.choice(MODELS))), float(rng.uniform(0.0, 1.6))
        point = {"speed_rpm": operating_rpm(pair), "stiffness_variation": factor}
        try:
            chart = stability_chart(
                pair, {name: [value] for name, value in point.items()}, rtol=1e-8, store="all", refine=False
            )
            own = gear_pair_multipliers(vary(pair, point), 1e-9)
        except NumericalError:  # a stiffness that is not positive
            continue
        there = pair.with_({"operating.pinion_speed": point["speed_rpm"]})
        truth = exact_multipliers(partial(pieces, there, factor=factor), 6)
        found = chart.isel(speed_rpm=0, stiffness_variation=0)
        return [*_of_ten(kind, "chart", found, own.oloa, truth), *_of_ten(kind, "pair", own, own.oloa, truth)]


def _over_speeds(kind: str, count: int, rng: np.random.Generator) -> list[Finding]:
    """A chart whose speeds share one friction law: exactly, or for "law over speed" to a tolerance."""
    while True:
        pair = _pair(rng, str(rng.choice(MODELS)))
        if (pair.friction.law in ("none", "coulomb")) == (kind == "speeds"):
            break
    rpm = operating_rpm(pair)
    axes = {"speed_rpm": rpm * np.linspace(0.8, 1.6, count), "damping_ratio": np.linspace(0.0, 0.1, 9)}
    chart = stability_chart(pair, axes, rtol=1e-8, store="all", refine=False)
    findings = []
    for i, j in zip(rng.integers(0, count, 3), rng.integers(0, 9, 3), strict=True):
        there = pair.with_(
            {
                "operating.pinion_speed": float(axes["speed_rpm"][i]),
                "mesh.damping_ratio": float(axes["damping_ratio"][j]),
            }
        )
        truth = exact_multipliers(partial(pieces, there), 6)
        found = chart.isel(speed_rpm=i, damping_ratio=j)
        findings += _of_ten(kind, "chart", found, gear_pair_multipliers(there, 1e-6).oloa, truth)
    return findings


def _bearings(rng: np.random.Generator) -> list[Finding]:
    """The bearings off the line of action, some of them at critical damping."""
    pair = _pair(rng, "rectangular")
    changes = {}
    for gear in ("pinion", "gear"):
        changes[f"bearings.{gear}.oloa_stiffness"] = float(10 ** rng.uniform(6.0, 10.0))
        ratio = float(rng.choice([0.0, 1.0, rng.uniform(0.0, 1.0), 1.0 - 10.0 ** rng.uniform(-14.0, -2.0)]))
        changes[f"bearings.{gear}.oloa_damping_ratio"] = ratio
    pair = pair.with_(changes)
    system = periodic_system(pair, "elastic")
    ctx.prec, s, truth = BITS, system.structure, []
    for mass, damping, stiffness in zip(s.mass[4:], s.damping[4:], s.stiffness[4:], strict=True):
        decay = ball(damping) / (2 * ball(mass))
        root = acb(decay * decay - ball(stiffness) / ball(mass)).sqrt()
        truth += [((sign * root - decay) * ball(pair.geometry.mesh_period)).exp() for sign in (1, -1)]
    disks = [(complex(x.mid()), float((x - acb(complex(x.mid()))).abs_upper())) for x in truth]
    values, errors = OffLineOfAction.of(feedback_system(GearVariation(pair))).multipliers(
        np.array([system.period])
    )
    return [finding("bearings", "closed form", values[0], errors[0], disks, "proven")]


_OF_PAIRS = {
    "stiffness variation": _stiffness_variation,
    "law over speed": partial(_over_speeds, "law over speed", 12),
    "speeds": partial(_over_speeds, "speeds", 130),
    "bearings": _bearings,
}


def table(findings: Sequence[Finding]) -> str:
    """Markdown table of all findings, one row for each kind and route."""
    lines = [
        "| system | route | certificate | count | worst error/bound | false | wrong verdicts | undecided |",
        "|---|---|---|---|---|---|---|---|",
    ]
    keys = dict.fromkeys((f.kind, f.route, f.certificate) for f in findings)
    for kind, route, certificate in sorted(keys, key=lambda k: (KINDS.index(k[0]), k[1], k[2])):
        here = [f for f in findings if (f.kind, f.route, f.certificate) == (kind, route, certificate)]
        false = sum(f.ratio > 1.0 for f in here)
        wrong, undecided = sum(f.wrong for f in here), sum(f.undecided for f in here)
        worst = max(f.ratio for f in here)
        cells = (kind, route, certificate, len(here), f"{worst:.1e}", false, wrong, undecided)
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
    given = parser.parse_args()
    tasks = [(kind, given.seed * 100_000 + i) for i in range(given.count) for kind in given.kind]
    findings: list[Finding] = []
    with ProcessPoolExecutor(given.jobs) as pool:
        waiting = {pool.submit(judge, *task): task for task in tasks}
        end = time.monotonic() + 60.0 * given.minutes
        for future in as_completed(waiting):
            if time.monotonic() > end:
                pool.shutdown(wait=False, cancel_futures=True)
                break
            try:
                found = future.result()
            except ValueError as error:
                print(*waiting[future], error, file=sys.stderr, flush=True)
                continue
            findings += found
            for one in found:
                if one.ratio > 1.0 or one.wrong:
                    print(*waiting[future], one, file=sys.stderr, flush=True)
    print(table(findings))


if __name__ == "__main__":
    main()
