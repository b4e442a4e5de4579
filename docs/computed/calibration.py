"""How often ranges of a calibration hold the truth, stored by ``python -m tests.evidence.calibration``."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from computed.markdown import table
from validation.prediction.motion import QUANTITIES

STORED = Path(__file__).resolve().parents[1] / "verification" / "calibration.json"
_KINDS = {
    "same": "the same model",
    "stiffness": "other stiffness model",
    "contact": "prescribed contact",
    "multibody": "record of the multibody model",
    "teeth": "teeth of its own (class 6)",
}
#: A promise is kept where at most this share more or less is left.
KEPT = 0.3
_RESULTS = ("dte_peak_to_peak", "dynamic_factor", "tooth_load", "bearing_rms")


def calibration() -> str:
    """Coverage by kind, and by result."""
    machines = _machines()
    columns = ("kind of rig", "machines", "with discrepancy", "without", "refused with, without")
    by_result = [
        (QUANTITIES[name][1], *(_share(machines, key, (name,)) for key in ("with", "without")))
        for name in _RESULTS
    ]
    return (
        f"{coverage()}\n\n{table(columns, list(_rows(machines)))}\n\n"
        f"{table(('result', 'with discrepancy', 'without'), by_result)}"
    )


def coverage() -> str:
    """One sentence: how often the ranges hold."""
    machines = _machines()
    with_, without = (_share(machines, key, _RESULTS) for key in ("with", "without"))
    return (
        f"Ranges from 5 to 95 % hold the truth in {with_} with the discrepancy and in {without} without, "
        f"over {len(machines)} computed rigs of five kinds and four results."
    )


def promises() -> str:
    """Promised and left of the next test, and how many promises are kept."""
    rows = [row for row in _stored()["promises"] if "promised" in row]
    results = tuple(rows[0]["promised"])
    columns = ("rig", "discrepancy", "test", *(QUANTITIES[name][1] for name in results), "mean")
    lines = []
    for row in rows:
        pairs = [(row["promised"][name], row["left"][name]) for name in results]
        cells = (f"{100.0 * promised:.0f}, {100.0 * left:.0f} %" for promised, left in (*pairs, _mean(row)))
        allowed = "yes" if row["kind"] == "promise" else "no"
        lines.append((str(row["number"]), allowed, row["test"], *cells))
    return f"{_kept(rows, results)}\n\n{table(columns, lines)}"


def _kept(rows: Sequence[dict[str, Any]], results: Sequence[str]) -> str:
    """How many promises are kept, with the discrepancy and without."""
    sentences = []
    for kind, words in (("promise", "With the discrepancy"), ("promise-exact", "Without it")):
        if not (of_kind := [row for row in rows if row["kind"] == kind]):
            continue
        mean = sum(_within(*_mean(row)) for row in of_kind)
        each, ranges = (
            sum(_within(row["promised"][name], row[key][name]) for row in of_kind for name in results)
            for key in ("left", "left_of_range")
        )
        sentences.append(
            f"{words}, {mean} of {len(of_kind)} tests leave what was promised as the mean over the results, "
            f"and {each} of {len(of_kind) * len(results)} single shares are kept; of the ranges from 5 "
            f"to 95 %, which 64 machines know less well, {ranges} are left as promised."
        )
    return f"Each cell: promised, left; the mean is geometric. {' '.join(sentences)}"


def _mean(row: dict[str, Any]) -> tuple[float, float]:
    """Geometric mean over the results, promised and left."""
    return tuple(
        math.exp(sum(map(math.log, row[key].values())) / len(row[key])) for key in ("promised", "left")
    )


def _within(promised: float, left: float) -> bool:
    return abs(left - promised) <= KEPT * promised


def _stored() -> dict[str, Any]:
    return json.loads(STORED.read_text(encoding="utf-8"))


def _machines() -> list[dict[str, Any]]:
    return [row for row in _stored()["machines"] if "with" in row]


def _rows(machines: Sequence[dict[str, Any]]) -> Iterator[tuple[str, ...]]:
    for kind, words in _KINDS.items():
        of_kind = [row for row in machines if row["kind"] == kind]
        refused = ", ".join(str(sum("refused" in row[key] for row in of_kind)) for key in ("with", "without"))
        shares = (_share(of_kind, key, _RESULTS) for key in ("with", "without"))
        yield words, str(len(of_kind)), *shares, refused


def _share(machines: Sequence[dict[str, Any]], key: str, results: Sequence[str]) -> str:
    """Number of ranges that hold, of how many: "31 of 36 (86 %)"."""
    held = [row[key]["holds"][name] for row in machines if "holds" in row[key] for name in results]
    share = f" ({100.0 * sum(held) / len(held):.0f} %)" if held else ""
    return f"{sum(held)} of {len(held)}{share}"


FILES = {
    "calibration.md": calibration,
    "calibration_coverage.md": coverage,
    "calibration_promises.md": promises,
}
