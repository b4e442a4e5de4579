"""What a sweep costs beside its cases: overhead, store, workers, memory; and what that means for 1e8 cases.

    python benchmarks/bench_studies.py [--quick]

Prints one line a figure. The cases are geometries (below 1 ms) and, for the strong scaling, periodic
motions of the lumped model at 300 rpm to 1200 rpm, the kind of case a sweep is for. Overheads are processor
times; the speed-up is of wall times, so it needs a machine with nothing else to do: the load average is
printed with it.
"""

from __future__ import annotations

import argparse
import contextlib
import multiprocessing
import os
import resource
import tempfile
import time
from pathlib import Path

import numpy as np

from validation.studies import load_study, run_sweep
from validation.studies.cases import CaseList, StudyEvaluator
from validation.studies.cli_sweep import cores
from validation.studies.evaluate import Batch
from validation.studies.provenance import provenance
from validation.studies.results import results_dataset, write_results
from validation.studies.storage import STORE
from validation.studies.store import Store, read_table

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


def seconds_of(function, *arguments, clock=time.process_time, **options):
    """Processor time of a call (or another clock's), and its result."""
    start = clock()
    result = function(*arguments, **options)
    return clock() - start, result


def children_memory():
    """Resident memory [MB] of each worker process of this process."""
    found = {}
    for child in multiprocessing.active_children():
        with contextlib.suppress(FileNotFoundError, ProcessLookupError):
            pages = int(Path(f"/proc/{child.pid}/statm").read_text().split()[1])
            found[child.pid] = pages * resource.getpagesize() / 1e6
    return found


def overhead(count):
    """Time of a case in a sweep, less its time as a plain call [s]; the cost of a run by itself."""

    def times(number):
        study = study_of(number)
        evaluate, values = StudyEvaluator.of(study), CaseList(study).values(range(number))
        plain, swept = [], []
        for _ in range(RUNS):
            plain.append(seconds_of(lambda: [evaluate(v) for v in values])[0])
            with tempfile.TemporaryDirectory() as folder:
                swept.append(seconds_of(run_sweep, study, Path(folder, "out"))[0])
                size = Path(folder, "out", STORE).stat().st_size / number
        return min(plain), min(swept), size

    times(10)
    few, many = count // 5, count
    (plain_few, swept_few, _), (plain_many, swept_many, size) = times(few), times(many)
    plain = (plain_many - plain_few) / (many - few)
    swept = (swept_many - swept_few) / (many - few)
    print(f"plain call              {1e6 * plain:10.1f} us a case")
    print(f"sweep, 0 workers        {1e6 * swept:10.1f} us a case")
    print(f"overhead                {1e6 * (swept - plain):10.1f} us a case  ({few} and {many} cases)")
    print(f"store of that sweep     {size:10.1f} bytes a case, 2 outputs")
    print(f"run by itself           {1e3 * (swept_few - few * swept):10.1f} ms")
    return max(swept - plain, 0.0)


def store(count):
    """Cost of the store and of compiling the result; returns seconds a case, and its size over theirs."""
    cases = CaseList(study_of(count))
    with tempfile.TemporaryDirectory() as folder:

        def write(block):
            Path(folder, STORE).unlink(missing_ok=True)
            with Store(Path(folder), cases) as opened:
                for start in range(0, count, block):
                    numbers = range(start, min(start + block, count))
                    values = np.outer(numbers, [1.5, 0.25])
                    status = np.zeros(len(numbers), np.int8)
                    opened.add(Batch(numbers, status, values, {}, 1e-3, provenance()))

        for block in (1, 100):
            took, _ = seconds_of(write, block)
            size = Path(folder, STORE).stat().st_size / count
            print(f"store, {block:3d} a batch      {1e6 * took / count:10.2f} us, {size:.1f} bytes a case")
        record_seconds, share = took / count, size / (1 + 8 * len(cases.outputs))
        took, table = seconds_of(read_table, Path(folder), cases)
        print(f"read on resume          {1e6 * took / count:10.2f} us a case")
        took, written = seconds_of(lambda: write_results(Path(folder), results_dataset(cases, table)))
        print(f"compile to NetCDF       {1e6 * took / count:10.2f} us a case")
        print(f"result                  {written.stat().st_size / count:10.1f} bytes a case")
    return record_seconds, share


def scaling(count):
    """Strong scaling on the cores of this machine: the same cases with 1 to all workers."""
    outputs = ("dte_peak_to_peak", "mesh_efficiency", "error_estimate")
    study = study_of(count, "lumped", outputs, 300.0, 1200.0)
    best = dict.fromkeys(range(1, cores() + 1), 0.0)
    whole = dict(best)
    results = set()
    for workers in best:
        first = []

        def progress(done, total, failed, first=first):
            if not first:
                first.append((time.perf_counter(), done))

        with tempfile.TemporaryDirectory() as folder:
            start = time.perf_counter()
            summary = run_sweep(study, Path(folder, "out"), workers=workers, progress=progress)
            # From the first result on: starting workers (imports, compiled code) is a cost of its own.
            end, (begun, done) = time.perf_counter(), first[0]
            best[workers] = (end - begun) * count / (count - done)
            whole[workers] = end - start
            results.add(summary.results.read_bytes())
    for workers, took in best.items():
        print(
            f"lumped, {workers} worker(s)     {took:10.2f} s, speed-up {best[1] / took:.2f} ({count} cases); "
            f"with the start of the workers {whole[workers]:.2f} s, speed-up {whole[1] / whole[workers]:.2f}"
        )
    print(f"results                 {'the same bytes' if len(results) == 1 else 'DIFFERENT'}")
    print(f"load average            {os.getloadavg()[0]:10.2f} on {cores()} cores")


def memory(count):
    """Resident memory of the workers and of this process over many cases."""
    samples = []

    def progress(done, total, failed):
        own = int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize() / 1e6
        samples.append((done, own, children_memory()))

    with tempfile.TemporaryDirectory() as folder:
        run_sweep(study_of(count), Path(folder, "out"), workers=2, progress=progress)
    after = next(sample for sample in samples if sample[0] >= count // 10)
    for text, (done, own, workers) in (("early", after), ("end", samples[-1])):
        sizes = ", ".join(f"{size:.1f}" for size in workers.values())
        print(f"memory, {text:5s}           workers {sizes} MB, coordinator {own:.1f} MB after {done} cases")


def cluster(tasks):
    """Cost of a task of a Dask cluster, shared by a batch of cases [s]; None without dask."""
    try:
        import distributed
    except ImportError:
        print("dask.distributed        not installed")
        return None
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=":0", silence_logs=50
        ) as local,
        distributed.Client(local) as client,
    ):
        client.gather(client.map(abs, range(100), pure=False))
        took, _ = seconds_of(lambda: client.gather(client.map(abs, range(tasks), pure=False)))
    print(f"Dask task               {1e6 * took / tasks:10.1f} us of client and scheduler ({tasks} tasks)")
    return took / tasks


def project(overhead_seconds, record, task_seconds, case_seconds=20e-3, cases=1e8, outputs=4):
    """Print what 1e8 cases would take on N nodes, from the figures above.

    Assumptions: nodes of 64 cores as fast as one of this machine's; cases of ``case_seconds``; batches of
    half a second or, beyond 250 workers, of workers / 500 seconds; the coordinator and the scheduler share a
    core and do nothing in parallel; the network carries 1 kB a batch and 100 bytes a case, far below its
    limits.
    """
    record_seconds, share = record
    size = share * (1 + 8 * outputs) * cases
    held = 8 * outputs * cases
    print(f"1e8 cases of {1e3 * case_seconds:g} ms, {outputs} outputs: store {size / 1e9:.1f} GB, ", end="")
    print(f"result {held / 1e9:.1f} GB, {(held + 11 * cases) / 1e9:.1f} GB of memory to compile it")
    for nodes in (1, 4, 16, 64, 256):
        slots = 64 * nodes
        batch = max(0.5, slots / 500.0)
        batches = cases * case_seconds / batch
        working = cases * case_seconds / slots
        serial = cases * (overhead_seconds + record_seconds) + batches * (task_seconds or 0.0)
        bound = "workers" if working > serial else "coordinator"
        hours = max(working, serial) / 3600.0
        print(f"{nodes:4d} nodes              {hours:10.2f} h, bound by the {bound} ({batch:.1f} s a batch)")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="a tenth of the cases")
    share = 10 if parser.parse_args().quick else 1
    case = overhead(10_000 // share)
    record = store(100_000 // share)
    task = cluster(2000 // share)
    project(case, record, task)
    memory(10_000 // share)
    scaling(10_000 // share)


if __name__ == "__main__":
    main()
