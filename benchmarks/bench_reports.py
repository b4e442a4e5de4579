"""Processor time of reports of drawn pairs, a third of them lightly damped, over that of one prediction.

    python -m benchmarks.bench_reports [--pairs 30] [--seed 1] [--quick] [--light] [--limit 600]

Pairs of 17 to 60 and 17 to 120 teeth, modules of 1 to 10 mm, with a pitch line velocity of 2 to 40 m/s; every
third has damping ratios below 0.01. The baseline is the prediction of the same pair in the same run. Beside
the whole time stand the search for jumps and the samples, which have limits, and what these left open. Each
report runs in a process of its own, which ends with the limit. The lines are the table of
docs/verification/reports.md.
"""

from __future__ import annotations

import argparse
import math
import random
import tempfile
import time
import warnings
from collections import defaultdict
from collections.abc import Iterator
from concurrent.futures import TimeoutError as FutureTimeout
from pathlib import Path
from unittest import mock

from pebble import ProcessPool

from lumped.errors import SpurcheckError
from lumped.outcomes import Absent
from lumped.schema.pair import GearPair
from validation.exchange.new_pair_file import new_pair
from validation.prediction.motion import predicted
from validation.reporting import build
from validation.reporting.results import Results


def drawn(count: int, seed: int) -> Iterator[GearPair]:
    """Random pairs that exist; every third is lightly damped."""
    rng = random.Random(seed)
    count_drawn = 0
    while count_drawn < count:
        teeth = rng.randint(17, 60), rng.randint(17, 120)
        module = rng.choice([1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0])
        width = module * rng.uniform(6.0, 14.0)
        velocity = math.exp(rng.uniform(math.log(2.0), math.log(40.0)))
        radius = 0.5e-3 * module * teeth[0]
        speed = velocity / radius * 30.0 / math.pi
        torque = rng.uniform(4e6, 3e7) * width * module * 1e-6 * radius
        try:
            pair = new_pair(
                teeth,
                module,
                round(width, 1),
                round(speed, 1),
                float(f"{torque:.3g}"),
                name=f"drawn_{count_drawn}",
            )
            if count_drawn % 3 == 2:
                ratio = rng.uniform(0.002, 0.01)
                pair = pair.with_(
                    {"mesh.damping_ratio": ratio, "mesh.contact": rng.choice(["prescribed", "loaded"])}
                )
                pair = pair.with_(
                    {
                        f"bearings.{g}.{w}_damping_ratio": ratio
                        for g in ("pinion", "gear")
                        for w in ("loa", "oloa")
                    }
                )
        except SpurcheckError:
            continue
        count_drawn += 1
        yield pair


def timed(pair: GearPair, *, quick: bool) -> str:
    """Return a line of the table: times of one report, results that the time limits left open, verdict."""
    warnings.simplefilter("ignore")
    name = f"{pair.pinion.teeth}/{pair.gear.teeth} | {pair.mesh.damping_ratio:.3f}"
    predicted(pair)  # compiles, and solves the finite elements
    started = time.process_time()
    predicted(pair)
    one = time.process_time() - started
    results_of_report: list[Results] = []

    def keep(*arguments: object, **options: object) -> Results:
        results_of_report.append(Results(*arguments, **options))  # type: ignore[arg-type]
        return results_of_report[-1]

    seconds: dict[str, float] = defaultdict(float)
    stage = ""
    since = time.process_time()

    def tell(_: float, new_stage: str = "", /) -> None:
        nonlocal stage, since
        if new_stage != stage:
            used = time.process_time()
            seconds[stage] += used - since
            stage = new_stage
            since = used

    with tempfile.TemporaryDirectory() as folder, mock.patch.object(build, "Results", keep):
        started = time.process_time()
        written = build.report(pair, Path(folder) / "r", quick=quick, progress=tell)
        used = time.process_time() - started
    results = results_of_report[0]
    search = results.jump_search
    ranges = results.uncertainty
    open_range = f"{sum(b - a for a, b in search.open):.0f} rpm" if search.open else ""
    samples = ""
    if not isinstance(ranges, Absent):
        samples = f"{ranges.attrs['taken']} of {ranges.attrs['asked']}"
    apart = f"{search.seconds:.1f} | {open_range} | {seconds['uncertain inputs']:.1f} | {samples}"
    return f"| {name} | {used:.1f} | {1e3 * one:.0f} | {apart} | {written.first.headline} |"


def main(count: int, seed: int, limit: float, *, quick: bool, light: bool) -> None:
    headings = (
        *("teeth", "damping", "report, s", "prediction, ms", "jumps, s", "left open", "samples, s", "taken"),
        "verdict",
    )
    print(f"| {' | '.join(headings)} |")
    print("|---|---|---|---|---|---|---|---|---|", flush=True)
    for number, pair in enumerate(drawn(count, seed)):
        if light and number % 3 != 2:
            continue
        with ProcessPool(max_workers=1) as pool:
            try:
                line = pool.schedule(timed, args=(pair,), kwargs={"quick": quick}, timeout=limit).result()
            except FutureTimeout:
                line = f"| {pair.pinion.teeth}/{pair.gear.teeth} | no report within {limit:.0f} s |"
            except SpurcheckError as error:
                line = f"| {pair.pinion.teeth}/{pair.gear.teeth} | no report: {error} |"
        print(line, flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pairs", type=int, default=30, help="how many are drawn")
    parser.add_argument("--seed", type=int, default=1, help="of their choice")
    parser.add_argument("--quick", action="store_true", help="quick reports")
    parser.add_argument("--light", action="store_true", help="those with little damping alone")
    parser.add_argument("--limit", type=float, default=600.0, help="time of each report [s]")
    given = parser.parse_args()
    main(given.pairs, given.seed, given.limit, quick=given.quick, light=given.light)
