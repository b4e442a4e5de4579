"""Processor time of reports of drawn pairs, a third of them lightly damped, over that of one prediction.

    python -m benchmarks.bench_reports [--pairs 30] [--seed 1] [--quick] [--light]

Pairs of 17 to 60 and 17 to 120 teeth, modules of 1 to 10 mm, with a pitch line velocity of 2 to 40 m/s; every
third has damping ratios below 0.01. The baseline is the prediction of the same pair in the same run. The last
column is the time of the search for jumps, which has a limit, and what it left open.
"""

from __future__ import annotations

import argparse
import math
import random
import tempfile
import time
import warnings
from collections.abc import Iterator
from pathlib import Path
from unittest import mock

from lumped.errors import SpurcheckError
from lumped.schema.pair import GearPair
from validation.exchange.new_pair_file import new_pair
from validation.prediction.motion import predicted
from validation.reporting import build
from validation.reporting.results import Results


def drawn(count: int, seed: int) -> Iterator[GearPair]:
    """Random pairs that exist; every third is lightly damped."""
    rng, found = random.Random(seed), 0
    while found < count:
        teeth = rng.randint(17, 60), rng.randint(17, 120)
        module = rng.choice([1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0])
        width, velocity = (
            module * rng.uniform(6.0, 14.0),
            math.exp(rng.uniform(math.log(2.0), math.log(40.0))),
        )
        radius = 0.5e-3 * module * teeth[0]
        speed = velocity / radius * 30.0 / math.pi
        torque = rng.uniform(4e6, 3e7) * width * module * 1e-6 * radius
        try:
            pair = new_pair(
                teeth, module, round(width, 1), round(speed, 1), float(f"{torque:.3g}"), name=f"drawn_{found}"
            )
            if found % 3 == 2:
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
        found += 1
        yield pair


def timed(pair: GearPair, *, quick: bool) -> str:
    """Seconds of a report, over those of a prediction, and of the search for jumps; with the verdict."""
    started = time.process_time()
    try:
        predicted(pair)
    except SpurcheckError as error:
        return f"{pair.name}: no prediction, {error}"
    one = time.process_time() - started
    kept: list[Results] = []

    def keep(*arguments: object, **options: object) -> Results:
        kept.append(Results(*arguments, **options))  # type: ignore[arg-type]
        return kept[-1]

    with tempfile.TemporaryDirectory() as folder, mock.patch.object(build, "Results", keep):
        started = time.process_time()
        try:
            written = build.report(pair, Path(folder) / "r", quick=quick)
        except SpurcheckError as error:
            return f"{pair.name}: no report after {time.process_time() - started:.1f} s, {error}"
        used = time.process_time() - started
    search = kept[0].jump_search
    left = f", open {sum(b - a for a, b in search.open):.0f} rpm" if search.open else ""
    damping = pair.mesh.damping_ratio
    name = f"{pair.name:9} {pair.pinion.teeth}/{pair.gear.teeth} damping {damping:.3f}"
    jumps = f"jumps {search.seconds:4.1f} s in {len(search.windows)} windows{left}"
    whole = f"{used:6.1f} s, {used / max(one, 1e-3):5.0f} predictions"
    return f"{name}: {whole}; {jumps}; {written.first.headline[:70]}"


def main(count: int, seed: int, *, quick: bool, light: bool) -> None:
    warnings.simplefilter("ignore")
    for number, pair in enumerate(drawn(count, seed)):
        if not light or number % 3 == 2:
            print(timed(pair, quick=quick), flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pairs", type=int, default=30, help="how many are drawn")
    parser.add_argument("--seed", type=int, default=1, help="of their choice")
    parser.add_argument("--quick", action="store_true", help="quick reports")
    parser.add_argument("--light", action="store_true", help="those with little damping alone")
    given = parser.parse_args()
    main(given.pairs, given.seed, quick=given.quick, light=given.light)
