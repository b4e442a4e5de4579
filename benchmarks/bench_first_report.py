"""Time of compilation, of the first and second report, and of small commands, over a baseline.

    python -m benchmarks.bench_first_report --baseline FOLDER [--pair nasa_28_28] [--rows kernels,first]

FOLDER is a checkout of the commit that is the baseline (``git worktree add FOLDER c4723bf8``). Both run in
turn, in fresh processes with the same Python, each with cache folders of its own. Processor time is user and
system time of the process and its children. Wall time means something on a machine that nobody else uses.

- kernels: all compilations of a report in one process, from an empty cache
- first: the whole command with empty caches of kernels and finite elements, its second process included; it
  leaves the caches for the rows behind it
- second: the same command again
- version, presets, init: the least of five runs
"""

from __future__ import annotations

import argparse
import math
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

COMMAND = "from validation.cli import main; main()"
#: On one processor there is no second process. The sum is of compilations that no other compilation contains.
COMPILING = """
import os, sys, time
os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
from numba.core import event

class Sum(event.Listener):
    depth = 0
    start = 0.0
    seconds = 0.0

    def on_start(self, _):
        if self.depth == 0:
            self.start = time.process_time()
        self.depth += 1

    def on_end(self, _):
        self.depth -= 1
        if self.depth == 0:
            self.seconds += time.process_time() - self.start

total = Sum()
event.register("numba:compile", total)
from validation.cli import main
try:
    main()
except SystemExit:
    print(total.seconds, file=sys.stderr)
"""
ROWS = ("kernels", "first", "second", "version", "presets", "init")


class Seconds(NamedTuple):
    """Processor time and wall time of a row [s]; NaN: not measured."""

    processor: float
    wall: float = float("nan")


class Tree:
    """A checkout, with caches of its own in a folder."""

    def __init__(self, source: Path, folder: Path) -> None:
        self.folder = folder
        folder.mkdir()
        self.environment = {
            **os.environ,
            "PYTHONPATH": str(source.resolve()),
            "NUMBA_CACHE_DIR": str(folder / "kernels"),
            "XDG_CACHE_HOME": str(folder / "cache"),
            "OPENBLAS_NUM_THREADS": "1",
            "MPLBACKEND": "Agg",
        }
        # As for a user, the modules are compiled to bytecode once, not in every run.
        self.environment.pop("PYTHONDONTWRITEBYTECODE", None)

    def run(self, code: str, *arguments: str, **environment: str) -> tuple[Seconds, str]:
        """Time of a fresh process and its children, and what it wrote to stderr."""
        begun = time.perf_counter()
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run(
            [sys.executable, "-P", "-c", code, *arguments],
            env=self.environment | environment,
            cwd=self.folder,
            check=True,
            capture_output=True,
            text=True,
        )
        wall = time.perf_counter() - begun
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        return Seconds(processor, wall), done.stderr

    def row(self, name: str, pair: str) -> Seconds:
        """Time of one row."""
        if name == "kernels":
            _, written = self.run(
                COMPILING, "report", pair, "-o", "compiled", NUMBA_CACHE_DIR=str(self.folder / "one_process")
            )
            return Seconds(float(written.split()[-1]))
        if name == "second" and not (self.folder / "first").exists():
            self.run(COMMAND, "report", pair, "-o", "first")  # fills the caches
        if name in ("first", "second"):
            return self.run(COMMAND, "report", pair, "-o", name, "--force")[0]
        arguments = {
            "version": ("--version",),
            "presets": ("presets",),
            "init": ("init", "-o", "pair.toml", "--force"),
        }[name]
        return min(self.run(COMMAND, *arguments)[0] for _ in range(5))


def main(baseline: Path, pair: str, rows: list[str]) -> None:
    print("| time [s] | baseline | here | ratio |\n|---|---|---|---|", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        trees = [
            Tree(baseline, Path(folder, "baseline")),
            Tree(Path(__file__).parents[1], Path(folder, "here")),
        ]
        for name in rows:
            before, after = (tree.row(name, pair) for tree in trees)
            for kind, old, new in zip(Seconds._fields, before, after, strict=True):
                if math.isfinite(new):
                    print(f"| {name}, {kind} | {old:.2f} | {new:.2f} | {new / old:.2f} |", flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--baseline", type=Path, required=True, help="checkout of the baseline")
    parser.add_argument("--pair", default="nasa_28_28", help="preset or parameter file")
    parser.add_argument("--rows", default=",".join(ROWS), help="rows of the table, in this order")
    given = parser.parse_args()
    main(given.baseline, given.pair, given.rows.split(","))
