"""Compute the evidence: ``python -m tests.evidence`` writes ``validation/evidence.json``."""

import argparse
import json
import sys

from tests.evidence.kinds import KINDS, TARGET, figures


def main(arguments: list[str] | None = None) -> int:
    """Print every check; write the file when no kind is named. 1 where a check fails."""
    parser = argparse.ArgumentParser(prog="python -m tests.evidence", description=__doc__)
    parser.add_argument("kinds", nargs="*", metavar="KIND", help=f"only these: {', '.join(KINDS)}")
    keys = parser.parse_args(arguments).kinds
    if unknown := [key for key in keys if key not in KINDS]:
        parser.error(f"no such kind: {', '.join(unknown)}")
    results = figures(keys or KINDS)
    failed = 0
    for kind in results["kinds"]:
        print(kind["title"])
        for row in kind["checks"]:
            fails = not abs(row["value"] - row.get("theory", 0.0)) <= row["limit"]
            failed += fails
            mark = "  FAILS" if fails else ""
            print(f"  {row['value']:9.3g}  limit {row['limit']:7.1g}  {row['subject']}{mark}")
    if not keys:
        TARGET.write_text(json.dumps(results, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
        print(f"Wrote {TARGET}.")
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
