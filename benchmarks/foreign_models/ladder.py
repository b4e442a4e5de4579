"""What the comparison says of the wrong models: the truth beside the ladder of explanations.

    python -m benchmarks.foreign_models.ladder first|second|third|fourth|fifth|sixth|seventh|eighth|ninth
        |tenth
        |eleventh [words]

A reader decides whether the first explanation is the truth in other words: the registry has no names of the
mistakes, and the mistakes have no names of the registry.
"""

from __future__ import annotations

import sys
import time
import warnings
from collections.abc import Callable, Mapping, Sequence

from benchmarks.foreign_models.cases import Case
from benchmarks.foreign_models.cases import cases as first_set
from benchmarks.foreign_models.eighth import judging as eighth_set
from benchmarks.foreign_models.eleventh import judging as eleventh_set
from benchmarks.foreign_models.fifth import judging as fifth_set
from benchmarks.foreign_models.fourth import judging as fourth_set
from benchmarks.foreign_models.ninth import judging as ninth_set
from benchmarks.foreign_models.second import held_back as second_set
from benchmarks.foreign_models.seventh import judging as seventh_set
from benchmarks.foreign_models.sixth import judging as sixth_set
from benchmarks.foreign_models.tenth import judging as tenth_set
from benchmarks.foreign_models.third import judging as third_set
from validation.check import check

SETS: Mapping[str, Callable[[str], Sequence[Case]]] = {
    "first": first_set,
    "second": second_set,
    "third": third_set,
    "fourth": fourth_set,
    "fifth": fifth_set,
    "sixth": sixth_set,
    "seventh": seventh_set,
    "eighth": eighth_set,
    "ninth": ninth_set,
    "tenth": tenth_set,
    "eleventh": eleventh_set,
}


def report(case: Case) -> None:
    """Print the truth of a case, and the first three steps with what does as well as each of them."""
    curves = case.curves()
    start = time.process_time()
    result = check(case.pair, curves)
    seconds = time.process_time() - start
    print(f"{case.name}: {'; '.join(case.truth)}")
    print(f"    {result.verdict.value}, misfit {result.misfit:.3f}, {seconds:.1f} s of a processor")
    for step in result.explanations[:3]:
        others = ", ".join(f"{other.name} {other.factor}" for other in step.alternatives[:2])
        print(
            f"    {step.name} {step.factor}: {step.misfit:.4f}{' or ' + others if others else ''}", flush=True
        )
        print(f"        {step.sentence}")
    for one in () if result.ladder is None else result.ladder.alone:
        print(f"    alone: {one.name} {one.factor}: {one.misfit:.4f}", flush=True)


def main(arguments: Sequence[str]) -> None:
    """Print the cases of a set whose names contain one of the words; without words all of them."""
    warnings.simplefilter("ignore")
    name, *words = arguments
    for case in SETS[name]("wrong"):
        if not words or any(word in case.name for word in words):
            report(case)


if __name__ == "__main__":
    main(sys.argv[1:])
