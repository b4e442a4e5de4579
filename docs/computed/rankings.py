"""Shares of compared variants beside plain Monte Carlo, stored by ``python -m tests.evidence.rankings``."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from computed.markdown import must_pass, table
from validation.prediction.compare import OF_TEETH, RESULTS, as_read

STORED = Path(__file__).resolve().parents[1] / "verification" / "rankings.json"


def rankings() -> str:
    """How far the shares differ, and every one of them."""
    stored = json.loads(STORED.read_text(encoding="utf-8"))
    rows = [row for case in stored["cases"] for row in case["results"].values()]
    columns = ("variants A or B", "result", "A, B as given", "compare", "plain", f"first {stored['few']}")
    return f"{_summary(stored, rows)}\n\n{table(columns, _cells(stored['cases']))}"


def _summary(stored: Mapping[str, Any], rows: list[dict[str, Any]]) -> str:
    off = {name: [100.0 * abs(row[name] - row["plain"]) for row in rows] for name in ("compare", "first")}
    must_pass("shares of compared variants", max(off["compare"]) <= stored["limit"])
    square = {name: (sum(one**2 for one in values) / len(values)) ** 0.5 for name, values in off.items()}
    clear = sum(max(row["compare"], 1.0 - row["compare"]) >= 0.95 for row in rows)
    open_ = sum(0.2 < row["compare"] < 0.8 for row in rows)
    sizes = {name: f"{max(values):.1f} points of 100" for name, values in off.items()}
    return (
        f"*compare* has {stored['samples']} samples, *plain* {stored['plain']}. The shares of {len(rows)} "
        f"comparisons differ by at most {sizes['compare']} (limit {stored['limit']:g}), root mean square "
        f"{square['compare']:.1f}; those of the first {stored['few']} samples, as many as the command has by "
        f"default, by at most {sizes['first']}, root mean square {square['first']:.1f}. In {clear} "
        "comparisons one variant is better in at least 95 of 100 machines; "
        f"in {open_} the inputs show no difference."
    )


def _cells(cases: list[dict[str, Any]]) -> Iterator[tuple[str, ...]]:
    """A line for each result of each case; numbers of 100 machines in which B is better."""
    for case in cases:
        text = case["text"]
        for name, row in case["results"].items():
            numbers, unit = as_read(name, np.array(row["given"]))
            shares = (f"{100.0 * row[key]:.1f}" for key in ("compare", "plain", "first"))
            yield text, (RESULTS | OF_TEETH)[name], f"{', '.join(numbers)}{unit}", *shares
            text = ""


FILES = {"rankings.md": rankings}
