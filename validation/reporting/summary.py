"""The report in a page of Markdown, for a pull request or a mail."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from validation.reporting.compare import Comparison
from validation.reporting.judged import failures

_MOST = 40


def summary(document: Mapping[str, Any], comparison: Comparison | None = None) -> str:
    """Return the summary.

    Parameters
    ----------
    document : data of report.json
    comparison : with an earlier report
    """
    lines = [f"# Verification report: {_text(document['gear_pair'])}", "", _text(document["verdict"]), ""]
    if document["doubts"]:
        lines += [*(f"- Check: {_text(doubt)}" for doubt in document["doubts"]), ""]
    lines += ["| question | verdict | answer |", "|---|---|---|"]
    lines += [
        f"| {_text(a['question'])} | **{_text(a['verdict']['text'])}** | {_text(a['text'])} |"
        for a in document["answers"]
    ]
    bad = failures(document)
    lines += ["", f"## Verdicts that fail: {len(bad)}", ""]
    lines += [f"- {_text(case.group)}: {_text(case.name)}: {_text(case.text)}" for case in bad[:_MOST]]
    if len(bad) > _MOST:
        lines.append(f"- and {len(bad) - _MOST} more, see report.junit.xml")
    if not bad:
        lines.append("None.")
    if comparison is not None:
        lines += ["", *_changes(comparison)]
    made = document["chapters"]["provenance"]["made_from"]["parameters_sha256"]["value"]
    versions = document["chapters"]["provenance"]["versions"]
    software = ", ".join(f"{_text(v['name'])} {_text(v['version'])}" for v in versions)
    lines += ["", "## Made from", "", f"Parameters SHA-256 `{made}`. {software}.", ""]
    lines.append("Everything else is in index.html, every number in report.json.")
    return "\n".join(lines) + "\n"


def _changes(comparison: Comparison) -> list[str]:
    failed = comparison.regressions
    lines = [
        f"## Changes against the earlier report: {len(failed)} past their tolerance",
        "",
        f"{comparison.compared} values compared, {len(comparison.changes)} changed; numbers may change by "
        f"{100 * comparison.tolerance:g} %.",
        "",
    ]
    shown = comparison.changes[:_MOST]
    if shown:
        lines += ["| value | before | now | change | past tolerance |", "|---|---|---|---|---|"]
    for change in shown:
        size = change.kind if change.size is None else f"{100 * change.size:.3g} %"
        row = (change.path, change.old, change.new, size, "**yes**" if change.fails else "no")
        lines.append("| " + " | ".join(map(_text, row[:4])) + f" | {row[4]} |")
    if len(comparison.changes) > _MOST:
        lines.append(f"\n{len(comparison.changes) - _MOST} more are in report.json, chapter changes.")
    return lines


def _text(value: Any) -> str:
    """Text that Markdown shows as it is."""
    text = re.sub(r"\s+", " ", str(value))
    return re.sub(r"([\\`*_<>|\[\]#])", r"\\\1", text)
