"""Judge the tests by drawn mutants: ``python -m tests.evidence.mutants``; see docs/verification/mutants.md.

Libraries that were looked at and not taken: ``mutmut`` leaves out every decorated function, so all compiled
kernels, cached functions and properties; ``cosmic-ray`` changes the files of the working tree, has one
command of tests for all modules and none of the operators of this field. What either would save, to run
pytest and look at its exit code, is short. Nothing is shared with ``tests/evidence/faults``: that changes
functions of the running program, where here a module may be changed so that it cannot be imported, in
another tree.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from dataclasses import asdict
from pathlib import Path

from tests.evidence.mutants.drawing import Mutant, draw
from tests.evidence.mutants.judging import Court, Limits
from tests.evidence.mutants.table import Row, Stored, argued, counts, library_digest, row, share_killed

ROOT = Path(__file__).parents[3]


def main(arguments: list[str] | None = None) -> int:
    """Judge mutants and print what became of each; 1 where one survives without an argument."""
    parser = argparse.ArgumentParser(prog="python -m tests.evidence.mutants", description=__doc__)
    parser.add_argument("--seed", type=int, default=1, help="draws the lines and their changes")
    parser.add_argument("--count", type=int, default=60, help="lines to draw")
    parser.add_argument(
        "--only", default="", metavar="FILE", help="draw from one file, as lumped/friction/base.py"
    )
    parser.add_argument("--tree", type=Path, default=ROOT, help="root of the tree to judge; default this one")
    parser.add_argument(
        "--again", type=Path, metavar="JSON", help="take over what was killed in an earlier table"
    )
    parser.add_argument("--list", action="store_true", help="print the mutants and judge none")
    parser.add_argument(
        "-o", "--output", type=Path, help="rows as .json; a run that was stopped goes on from .json.part"
    )
    options = parser.parse_args(arguments)
    tree = options.tree.resolve()
    limits = Limits()
    mutants = draw(tree, options.count, options.seed, options.only)
    if options.list:
        for one in mutants:
            print(f"{one.file}:{one.line} {one.operator}\n  - {one.before}\n  + {one.after}")
        return 0
    head = {"seed": options.seed, "count": options.count, "only": options.only, "limits": asdict(limits)}
    stored = Stored(options.output, head | {"library": library_digest(tree)})
    for earlier in _killed(options.again):
        if earlier["key"] not in stored.rows and any(_same(earlier, one) for one in mutants):
            stored.add(earlier)
    judge_all(mutants, tree, stored, limits)
    stored.finish()
    rows = argued(stored.rows.values())
    print(", ".join(f"{number} {name}" for name, number in counts(rows).items()), end="; ")
    print(f"{100.0 * share_killed(rows):.0f} % of those decided are killed")
    return int(counts(rows)["survived"] > 0)


def judge_all(mutants: list[Mutant], tree: Path, stored: Stored, limits: Limits) -> None:
    """Judge the mutants that are not stored yet."""
    remaining = [one for one in mutants if one.key not in stored.rows]
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder:
        court = Court(tree, Path(folder), limits)
        for one in remaining:
            verdict = court.judge(one)
            stored.add(row(one, verdict))
            place = f"[{len(stored.rows)}/{len(mutants)}] {one.file}:{one.line} {one.operator}"
            print(f"{place}: {verdict.verdict} {verdict.by} ({verdict.tests} tests, {verdict.seconds:.0f} s)")
            print(f"  - {one.before}\n  + {one.after}", flush=True)


def _killed(table: Path | None) -> list[Row]:
    """Rows of an earlier table that are killed; none without a table."""
    rows = json.loads(table.read_text(encoding="utf-8"))["mutants"] if table else []
    return [one for one in rows if one["verdict"] == "killed"]


def _same(known: Row, mutant: Mutant) -> bool:
    return (known["key"], known["before"], known["after"]) == (mutant.key, mutant.before, mutant.after)


if __name__ == "__main__":
    sys.exit(main())
