"""Claims of the paper, judged at the stated assumptions and over samples of everything it does not give."""

from __future__ import annotations

import lumped
from computed.markdown import Cell, greek, table, text
from reproductions.he_cho_singh_2008.claims.judge import claims

_SAMPLES = 40


def _range(low: float | None, high: float | None) -> str:
    return "–" if low is None or high is None else f"{text(low)} to {text(high)}"


def claims_table() -> str:
    """One row per statement of the paper."""
    found = claims(lumped.load_gear_pair("nasa_28_28"), samples=_SAMPLES)
    rows: list[tuple[Cell, ...]] = [
        (
            c.statement,
            c.definition,
            f"{text(float(c.value))} {'' if c.unit == '1' else c.unit}".strip(),
            _range(c.low, c.high),
            c.verdict,
            None if c.share is None else f"{100.0 * c.share:.0f} %",
        )
        for c in found.claims
    ]
    columns = ("the paper says", "computed as", "number", "5th to 95th percentile", "verdict", "share")
    ranges = "; ".join(f"{name}: {value}" for name, value in found.ranges.items())
    sampling = (
        f"{found.samples} samples (seed {found.seed}; {found.failed} had no periodic motion or law) over "
        f"{text(ranges)}."
    )
    return greek(f"{found.text}\n\n{table(columns, rows)}\n{sampling}\n")


FILES = {"claims.md": claims_table}
