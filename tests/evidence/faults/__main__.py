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
    options = parser.parse_args(arguments)
    if options.sound is not None:
        return sound_pairs(
            options.sound, options.seed, options.output, relief=options.relief, loaded=options.loaded
        )
    if options.report:
        return report_faults(options.keys, options.output)
    if unknown := [key for key in options.keys if key not in FAULTS]:
        parser.error(f"no such fault: {', '.join(unknown)}")
    chosen = [FAULTS[key] for key in options.keys] or list(FAULTS.values())
    if options.sample is not None:
        chosen = list(sample(options.sample, options.seed))
    rows = stored(options.output)
    for fault in chosen:
        outcome = judge(fault, thorough=options.thorough)
        rows[fault.key] = row(fault, outcome)
        verdict_text = outcome.first or verdict(fault, outcome)
        print(
            f"{fault.key:24} {100.0 * outcome.size:9.3g} % {outcome.quantity:32.32} {verdict_text}",
            flush=True,
        )
        if options.output is not None:
            save(rows, options.output)
    numbers_by_verdict = counts(rows[fault.key] for fault in chosen)
    print(", ".join(f"{number} {name}" for name, number in numbers_by_verdict.items()))
    return int(numbers_by_verdict.get("missed", 0) > 0)


if __name__ == "__main__":
    sys.exit(main())
