"""How often ranges of a calibration hold the truth, stored by ``python -m tests.evidence.calibration``."""

from __future__ import annotations

import json
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


def _machines() -> list[dict[str, Any]]:
    stored = json.loads(STORED.read_text(encoding="utf-8"))["machines"]
    return [row for row in stored if "with" in row]


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


FILES = {"calibration.md": calibration, "calibration_coverage.md": coverage}
