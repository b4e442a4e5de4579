"""Time of single computations over that of a baseline, both in the same run.

    python -m benchmarks.bench_over_baseline --baseline FOLDER [--rows prediction_28_28,band] [--rounds 3]

FOLDER is a checkout of the commit that is the baseline (``git worktree add FOLDER c4723bf8``). Each row is
one computation by public functions that both have. It runs in a fresh process of each tree in turn,
``rounds`` times, after one run that compiles; the least processor time of a tree counts. The rows of the
commands are in `bench_first_report`.

- prediction_*: ``spurcheck.predict`` of 28/28, of 25/31, which loses contact, of 19/41, and of 28/28 on
  shafts; another torque in each, so that no result is kept
- samples: one of the samples of ``spurcheck.uncertainty`` of 28/28, in a batch of 128
- band: 128 samples at the operating point and 32 at 41 speeds, as in a report
- chart_fine: a chart of 28/28 with 1e7 nodes that refines itself; also the memory that it takes
- chart: the same of 25/31 with 701 x 301 nodes; chart_full: every node of it
- multibody: a mesh cycle of 28/28 with stiffness that jumps, relative tolerance 1e-8
- import: ``import spurcheck`` with the four packages
"""

from __future__ import annotations

import argparse
import json
import tempfile
from pathlib import Path

from benchmarks.bench_first_report import Tree

#: Before every row. ``timed`` returns the processor time [s] of ``computation(0)``, ``computation(1)``, ...
_PREPARED = """
import json, resource, sys, time, warnings
warnings.simplefilter("ignore")
begun = time.process_time()
import numpy as np
import spurcheck
from floquet import stability_chart
from multibody import simulate
from validation.prediction.uncertainty import speed_band

def timed(computation, repeats):
    computation(0)
    start = time.process_time()
    for i in range(1, repeats + 1):
        computation(i)
    return (time.process_time() - start) / repeats

def memory():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024

def prediction(pair):
    torque = float(pair.operating.pinion_torque)
    varied = [pair.with_(operating__pinion_torque=torque * (1.0 + 1e-6 * i)) for i in range(21)]
    return timed(lambda i: spurcheck.predict(varied[i]), 20)

def chart(pair, speeds, dampings, **options):
    axes = {"speed_rpm": np.linspace(500, 20000, speeds), "damping_ratio": np.linspace(0.001, 0.1, dampings)}
    return stability_chart(pair, axes, **options)

pair = spurcheck.load_gear_pair("nasa_28_28")
"""
ROWS = {
    "prediction_28_28": "seconds = prediction(pair)",
    "prediction_25_31": "seconds = prediction(spurcheck.load_gear_pair('nasa_art_25_31'))",
    "prediction_19_41": (
        "seconds = prediction(spurcheck.new_pair('19/41', module=2.5, face_width=20, speed=1450, torque=80))"
    ),
    "prediction_shafts": """
spring = {"loa_stiffness": 2e8, "oloa_stiffness": 2e8}
bearings = [spring | {"position": 30}, spring | {"position": 150}]
shaft = {"segments": [{"length": 300, "diameter": 30}], "gear_position": 90, "bearings": bearings}
train = {"position": 300, "inertia": 0.01, "coupling_stiffness": 1e5}
modes = {"damping_ratio": 0.02, "max_frequency": 8000}
shafts = {"pinion": shaft, "gear": shaft, "motor": train, "load": train}
seconds = prediction(pair.with_(shafts=shafts | modes))
""",
    "samples": "seconds = timed(lambda i: spurcheck.uncertainty(pair, 128, seed=i + 1), 2) / 128",
    "band": """
def band(i):
    found = spurcheck.uncertainty(pair, 128, seed=i + 1)
    speed_band(pair, np.linspace(490, 9800, 41), found, 32)
seconds = timed(band, 1)
""",
    "chart_fine": """
chart(pair, 20, 20)
before = memory()
start = time.process_time()
kept = chart(pair, 4000, 2500)
seconds = time.process_time() - start
extra = memory() - before
""",
    "chart": "seconds = timed(lambda i: chart(spurcheck.load_gear_pair('nasa_art_25_31'), 701, 301), 2)",
    "chart_full": """
seconds = timed(lambda i: chart(spurcheck.load_gear_pair('nasa_art_25_31'), 701, 301, refine=False), 1)
""",
    "multibody": """
jumps = pair.with_(friction__law="coulomb", friction__coefficient=0.05, mesh__relief="ignored")
def run(cycles):
    start = time.process_time()
    simulate(jumps, cycles, rtol=1e-8)
    return time.process_time() - start
run(2)
seconds = (run(22) - run(2)) / 20
""",
    "import": "seconds = time.process_time() - begun",
}


def measured(tree: Tree, row: str) -> dict[str, float]:
    """Seconds of a row and, where it measures them, bytes."""
    printed = "print(json.dumps({'seconds': seconds, 'bytes': globals().get('extra', 0)}), file=sys.stderr)"
    _, written = tree.run(f"{_PREPARED}\n{ROWS[row]}\n{printed}")
    return json.loads(written.splitlines()[-1])


def main(baseline: Path, rows: list[str], rounds: int) -> None:
    print(
        "| row | baseline, ms | here, ms | ratio | memory, MB: baseline, here |\n|---|---|---|---|---|",
        flush=True,
    )
    with tempfile.TemporaryDirectory() as folder:
        trees = [
            Tree(baseline, Path(folder, "baseline")),
            Tree(Path(__file__).parents[1], Path(folder, "here")),
        ]
        for row in rows:
            for tree in trees:
                measured(tree, row)  # compiles
            taken = [[measured(tree, row) for tree in trees] for _ in range(rounds)]
            old, new = (min(run["seconds"] for run in runs) for runs in zip(*taken, strict=True))
            memory = (
                ", ".join(f"{run['bytes'] / 1e6:.0f}" for run in taken[0]) if taken[0][0]["bytes"] else ""
            )
            print(f"| {row} | {1e3 * old:.3g} | {1e3 * new:.3g} | {new / old:.2f} | {memory} |", flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--baseline", type=Path, required=True, help="checkout of the baseline")
    parser.add_argument("--rows", default=",".join(ROWS), help="rows of the table, in this order")
    parser.add_argument("--rounds", type=int, default=3, help="runs of each tree")
    given = parser.parse_args()
    main(given.baseline, given.rows.split(","), given.rounds)
