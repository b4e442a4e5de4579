"""Processor time of variations, predictions, samples and the band over speed, over that of a baseline.

    python -m benchmarks.bench_prediction [PAIRS] [--rounds 8] [--samples 64]

prints the table of docs/verification/uncertainty.md. The baseline of a variation, which has other numbers in
all uncertain inputs, is the same pair read from its whole plain data. The baseline of a prediction and of a
sample is the time that the runs by momentary load take in their compiled kernel, ``run_cycles``, in the same
predictions: the rest is Python and the laws of the tooth pairs. The baseline of the band is one linear motion
with numerical error, by ``lumped.steady_state``. All kernels are loaded before.
"""

from __future__ import annotations

import argparse
import time
import warnings
from collections.abc import Callable, Sequence
from typing import Any
from unittest import mock

import numpy as np

import lumped
from benchmarks.bench_uncertainty import PAIRS, line, speeds_between
from floquet.gear.axes import speed_range
from lumped.model import momentary_load
from lumped.schema.changes import changed
from lumped.schema.pair import GearPair, validated
from validation.prediction.inputs import SEED_FIELDS, uncertain_inputs
from validation.prediction.motion import predicted
from validation.prediction.uncertainty import speed_band, uncertainty

#: Pairs of the table; the last one loses contact.
PREDICTED = {name: pair for name, (pair, _) in PAIRS.items()} | {
    "25/31": lumped.load_gear_pair("nasa_art_25_31")
}
#: Speeds and samples of the band over speed in a full report.
BAND_SPEEDS = 41
BAND_SAMPLES = 8
#: Variations of a pair.
_VARIATIONS = 200


class KernelClock:
    """Processor time inside ``run_cycles`` [s]."""

    def __init__(self) -> None:
        self.seconds = 0.0

    def timed(self, kernel: Callable[..., Any]) -> Callable[..., Any]:
        """Return the kernel, whose time counts."""

        def run(*arguments: Any) -> Any:
            start = time.process_time()
            result = kernel(*arguments)
            self.seconds += time.process_time() - start
            return result

        return run


def measured(work: Callable[[], object]) -> tuple[float, float]:
    """Processor time of some work, and of ``run_cycles`` in it [s]."""
    clock = KernelClock()
    with mock.patch.object(momentary_load, "run_cycles", clock.timed(momentary_load.run_cycles)):
        start = time.process_time()
        work()
        return time.process_time() - start, clock.seconds


def variations(pair: GearPair, count: int) -> tuple[float, float]:
    """Processor time of variations of a pair [s]: by ``with_``, and from the whole plain data."""
    rng = np.random.default_rng(1)
    numbers = [one for one in uncertain_inputs(pair) if not one.choices and one.field not in SEED_FIELDS]
    changes = [
        {path: value for one in numbers for path, value in one.changes(float(rng.random())).items()}
        for _ in range(count)
    ]
    seconds = [0.0, 0.0]
    for fields in changes:  # in turn, because other programs share the processor
        for place, vary in enumerate((pair.with_, lambda one: validated(changed(pair, one), "whole"))):
            start = time.process_time()
            vary(fields)
            seconds[place] += time.process_time() - start
    return seconds[0], seconds[1]


def report_of(name: str, rounds: int, samples: int) -> None:
    """Lines of one pair: a variation, a prediction, a sample, a speed of the band."""
    pair = PREDICTED[name]
    light, whole = variations(pair, _VARIATIONS)
    line(name, "a variation", 1e3 * light / _VARIATIONS, 1e3 * whole / _VARIATIONS, light / whole)
    torque = pair.operating.pinion_torque
    nearby = [pair.with_(torque=f"{torque * (1.0 + 1e-4 * k)!r} N m") for k in range(1, rounds + 1)]
    predicted(pair)
    alone, kernel = measured(lambda: [predicted(one) for one in nearby])
    line(name, "a prediction", 1e3 * alone / rounds, 1e3 * kernel / rounds, alone / kernel)
    known = uncertainty(pair, 16)
    total, kernel = measured(lambda: uncertainty(pair, samples, seed=2))
    count = samples + 2 * known.sizes["input"] + known.sizes["form"] + 1
    line(name, "a sample", 1e3 * total / count, 1e3 * kernel / count, total / kernel)
    low, high = speed_range(pair)
    speeds = speeds_between(low, high, BAND_SPEEDS)
    on_springs = pair.with_(shafts=None) if pair.shafts is not None else pair
    lumped.steady_state(on_springs)
    linear, _ = measured(lambda: [lumped.steady_state(on_springs) for _ in range(rounds)])
    total, _ = measured(lambda: speed_band(on_springs, speeds, known, BAND_SAMPLES))
    motions = BAND_SAMPLES * speeds.size
    line(name, "a speed of the band", 1e3 * total / motions, 1e3 * linear / rounds,
         total / motions / (linear / rounds))  # fmt: skip


def main(names: Sequence[str], rounds: int, samples: int) -> None:
    warnings.simplefilter("ignore")
    line("pair", "work", "time, ms", "baseline, ms", "ratio")
    for name in names or PREDICTED:
        report_of(name, rounds, samples)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="PAIR", help="default all")
    parser.add_argument("--rounds", type=int, default=8, help="predictions of the first line")
    parser.add_argument("--samples", type=int, default=64, help="samples of the second line")
    given = parser.parse_args()
    main(given.names, given.rounds, given.samples)
