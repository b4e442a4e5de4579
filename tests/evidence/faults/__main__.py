"""Judge the verdicts: ``python -m tests.evidence.faults``; see docs/verification/faults.md."""

import argparse
import sys
from pathlib import Path

from tests.evidence.faults.fault import FAULTS
from tests.evidence.faults.judging import judge
from tests.evidence.faults.report_layer import report_faults
from tests.evidence.faults.sound import sound_pairs
from tests.evidence.faults.table import counts, row, sample, save, stored, verdict


def main(arguments: list[str] | None = None) -> int:
    """Run faults, or sound pairs, and print what the verdicts say; 1 where one is wrong."""
    parser = argparse.ArgumentParser(prog="python -m tests.evidence.faults", description=__doc__)
    parser.add_argument("keys", nargs="*", metavar="FAULT", help="faults to run; default all")
    parser.add_argument("--sample", type=int, metavar="N", help="only N faults, chosen by --seed")
    parser.add_argument("--seed", default="0", help="text that chooses the sample or the sound pairs")
    parser.add_argument("--sound", type=int, metavar="N", help="cross-check N random sound pairs instead")
    parser.add_argument("--relief", action="store_true", help="only sound pairs whose tip relief acts")
    parser.add_argument("--loaded", action="store_true", help="sound pairs with loaded contact")
    parser.add_argument(
        "--thorough", action="store_true", help="ask every part, also after the first that sees it"
    )
    parser.add_argument("--report", action="store_true", help="faults in what the report shows instead")
    parser.add_argument("-o", "--output", type=Path, help="rows as .json; those of other faults stay")
    given = parser.parse_args(arguments)
    if given.sound is not None:
        return sound_pairs(given.sound, given.seed, given.output, relief=given.relief, loaded=given.loaded)
    if given.report:
        return report_faults(given.keys, given.output)
    if unknown := [key for key in given.keys if key not in FAULTS]:
        parser.error(f"no such fault: {', '.join(unknown)}")
    chosen = [FAULTS[key] for key in given.keys] or list(FAULTS.values())
    if given.sample is not None:
        chosen = list(sample(given.sample, given.seed))
    rows = stored(given.output)
    for fault in chosen:
        outcome = judge(fault, thorough=given.thorough)
        rows[fault.key] = row(fault, outcome)
        said = outcome.first or verdict(fault, outcome)
        print(f"{fault.key:24} {100.0 * outcome.size:9.3g} % {outcome.quantity:32.32} {said}", flush=True)
        if given.output is not None:
            save(rows, given.output)
    found = counts(rows[fault.key] for fault in chosen)
    print(", ".join(f"{number} {name}" for name, number in found.items()))
    return int(found.get("missed", 0) > 0)


if __name__ == "__main__":
    sys.exit(main())
