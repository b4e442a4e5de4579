"""Reading the report that a new one is compared with: refused before any work where it cannot serve."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Never

from lumped.arguments import file_path
from lumped.errors import refuse
from lumped.fields.text_file import read_text
from validation.files.folder import FORMAT, FORMAT_VERSION, REPORT
from validation.reporting.compare import leaves

_MAX_BYTES = 100_000_000
_ACTION = "Give the report.json of an earlier report."


def load_report(source: str | Path, *, quick: bool | None = None) -> dict[str, Any]:
    """Read report.json, or the one of a report folder.

    Parameters
    ----------
    source : file or folder
    quick : whether the report to be compared is a quick one; None does not ask

    Raises
    ------
    ParameterError : no such file, not a report, of another layout, or of other sampling
    """
    path = file_path("compare", source)
    if path.is_dir():
        path = path / REPORT.file
    text = read_text(path, _MAX_BYTES, field="--compare", kind="report.json", action=_ACTION)
    try:
        data = json.loads(text, parse_constant=_refuse_constant)
    except (ValueError, RecursionError) as error:
        why = f"This is no JSON, or only a part of it ({error}). {_ACTION}"
        raise refuse("--compare", source, "a report.json", why) from None
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        raise refuse("--compare", source, f'a JSON file of format "{FORMAT}"', _ACTION)
    if (version := data.get("format_version")) != FORMAT_VERSION:
        raise refuse(
            "--compare",
            source,
            f"a report of layout {FORMAT_VERSION}",
            f"This one has layout {version}: write the earlier report again with this version of spurcheck.",
        )
    try:
        dict(leaves(data))
        sampled = bool(data["quick"])
    except (AttributeError, KeyError, TypeError, ValueError, OverflowError):
        why = f"An entry is not as spurcheck writes it. {_ACTION}"
        raise refuse("--compare", source, "a report.json as it was written", why) from None
    if quick is not None and sampled != quick:
        words = {True: "a quick report", False: "a full report"}
        why = f"The earlier one is {words[sampled]}: sample both alike, with or without --quick."
        raise refuse("--compare", source, f"{words[quick]}, as the new one", why)
    return data


def _refuse_constant(name: str) -> Never:
    raise ValueError(f"{name} is no number")
