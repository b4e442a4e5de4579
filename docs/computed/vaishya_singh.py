"""Statements of Vaishya and Singh, judged on three gear pairs."""

from __future__ import annotations

from computed.markdown import Cell, greek, must_pass, table, text
from reproductions.vaishya_singh_2001.gears import PAIRS
from reproductions.vaishya_singh_2001.judge import statements


def statements_table() -> str:
    """One row per statement or question of the abstracts."""
    judged = statements()
    rows: list[tuple[Cell, ...]] = []
    for one in judged:
        rule = one.rule
        must_pass(rule.name, one.verdict in ("reproduced", "answered"))
        unit = "" if rule.unit == "1" else f" {rule.unit}"
        values = [f"{text(float(one.values[name]))}{unit}" for name in PAIRS]
        rows.append((rule.text, rule.source, rule.definition, rule.criterion, *values, one.verdict))
    columns = ("statement or question", "source", "computed as", "criterion", *PAIRS, "verdict")
    remarks = "\n".join(f"- {one.rule.name}: {one.rule.remark}" for one in judged if one.rule.remark)
    return greek(f"{table(columns, rows)}\n{remarks}\n")


FILES = {"vaishya_singh.md": statements_table}
