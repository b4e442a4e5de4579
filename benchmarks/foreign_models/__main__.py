"""Print the trial set: name, kind, truth, pair, channels, seconds, differences from the sound record."""

from __future__ import annotations

import sys
import time
import warnings

from benchmarks.foreign_models.cases import KINDS, cases
from benchmarks.foreign_models.differences import differences
from benchmarks.foreign_models.fifth import judging as fifth
from benchmarks.foreign_models.fourth import judging as fourth
from benchmarks.foreign_models.recipe import Recipe
from benchmarks.foreign_models.second import held_back
from benchmarks.foreign_models.third import judging

#: The argument that takes another set than the first, and what lists its cases.
OTHER_SETS = {"held_back": held_back, "judging": judging, "fourth": fourth, "fifth": fifth}


def main(arguments: list[str]) -> None:
    """Print a line for every case of the kinds, or whose name has a word of the arguments in it.

    The argument "held_back" takes the second set instead of the first, "judging" the third, "fourth" the
    fourth and "fifth" the fifth.
    """
    warnings.simplefilter("ignore")
    kinds = [word for word in arguments if word in KINDS]
    words = [word for word in arguments if word not in (*KINDS, *OTHER_SETS)]
    every = next((listed for name, listed in OTHER_SETS.items() if name in arguments), cases)
    print("| name | kind | truth | pair | channels | s | off as written, off in shape [%] |")
    print("|---|---|---|---|---|---|---|")
    for case in every():
        if (kinds and case.kind not in kinds) or (words and not any(word in case.name for word in words)):
            continue
        start = time.perf_counter()
        record = case.curves()
        seconds = time.perf_counter() - start
        assert isinstance(case.curves, Recipe)
        off = differences(record, case.curves)
        cells = ", ".join(f"{name} {100 * d.as_written:.2g} {100 * d.shape:.2g}" for name, d in off.items())
        row = (
            case.name,
            case.kind,
            "; ".join(case.truth),
            case.pair["name"],
            len(record) - 1,
            f"{seconds:.2f}",
            cells,
        )
        print("| " + " | ".join(map(str, row)) + " |", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
