"""What a sweep costs beside its cases.

    python -m benchmarks.bench_studies [--quick]

Prints one line a figure. The cases are geometries (below 1 ms) and, for the strong scaling, periodic motions
of the lumped model at 300 rpm to 1200 rpm. Overheads are processor times; the speed-up is of wall times, so
it needs a machine with nothing else to do: the load average is printed with it.
"""

from __future__ import annotations

import argparse
import os
import tempfile
import time
from pathlib import Path

from lumped.cache import cores
from validation.studies import load_study, run_sweep
from validation.studies.cases import CaseList, StudyEvaluator
from validation.studies.store import STORE

RUNS = 3


def study_of(count, analysis="geometry", outputs=("contact_ratio", "mesh_frequency"), low=500.0, high=9000.0):
    """A study of one axis, the speed."""
    return load_study(
        {
            "name": "benchmark",
            "gear_pair": "nasa_28_28",
            "analysis": analysis,
            "outputs": list(outputs),
            "axes": [{"field": "operating.pinion_speed", "low": low, "high": high, "count": count}],
        }
    )


def processor_seconds(function, *arguments):
    """Processor time of a call."""
    start = time.process_time()
    function(*arguments)
    return time.process_time() - start


def overhead(count):
    """Time of a case in a sweep, less its time as a plain call; the cost of a run by itself."""

    def times(number):
        study = study_of(number)
        evaluate = StudyEvaluator.of(study)
        values = CaseList(study).values(range(number))
        plain = []
        swept = []
        for _ in range(RUNS):
            plain.append(processor_seconds(lambda: [evaluate(v) for v in values]))
            with tempfile.TemporaryDirectory() as folder:
                swept.append(processor_seconds(run_sweep, study, Path(folder, "out")))
                size = Path(folder, "out", STORE).stat().st_size / number
        return min(plain), min(swept), size

    times(10)
    few = count // 5
    many = count
    (plain_few, swept_few, _) = times(few)
    (plain_many, swept_many, size) = times(many)
    plain = (plain_many - plain_few) / (many - few)
    swept = (swept_many - swept_few) / (many - few)
    print(f"plain call              {1e6 * plain:10.1f} us a case")
    print(f"sweep, 0 workers        {1e6 * swept:10.1f} us a case")
    print(f"overhead                {1e6 * (swept - plain):10.1f} us a case  ({few} and {many} cases)")
    print(f"store of that sweep     {size:10.1f} bytes a case, 2 outputs")
    print(f"run by itself           {1e3 * (swept_few - few * swept):10.1f} ms")


def scaling(count):
    """Strong scaling on the cores of this machine: the same cases with 1 to all workers."""
    study = study_of(
        count, "lumped", ("dte_peak_to_peak", "mesh_efficiency", "error_estimate"), 300.0, 1200.0
    )
    seconds = {}
    results = set()
    many = cores()
    for workers in range(1, many + 1):
        with tempfile.TemporaryDirectory() as folder:
            summary = run_sweep(study, Path(folder, "out"), workers=workers)
            seconds[workers] = summary.seconds
            results.add(summary.results.read_bytes())
    for workers, took in seconds.items():
        speed_up = seconds[1] / took
        print(f"lumped, {workers} worker(s)     {took:10.2f} s, speed-up {speed_up:.2f} ({count} cases)")
    print(f"results                 {'the same bytes' if len(results) == 1 else 'DIFFERENT'}")
    print(f"load average            {os.getloadavg()[0]:10.2f} on {many} cores")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="a tenth of the cases")
    share = 10 if parser.parse_args().quick else 1
    overhead(10_000 // share)
    scaling(10_000 // share)


if __name__ == "__main__":
    main()
