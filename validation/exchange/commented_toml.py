"""A parameter file as text to read and edit: units beside the values, assumptions marked."""

from __future__ import annotations

import re
import textwrap
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import tomli_w

from lumped.errors import ParameterError
from lumped.schema.pair import stated_unit
from validation.exchange.rexs.draft import DOUBTFUL

_SECTION = re.compile(r"(\[\[?)([\w.]+)\]\]?$")
_ENTRY = re.compile(r"(\w+) = ")
_COLUMN = 40


def parameter_text(mapping: Mapping[str, Any], notes: Sequence[str] = ()) -> str:
    """Write parameters as commented TOML.

    Parameters
    ----------
    mapping : nested parameters in file units, with ``sources``
    notes : put above as comments

    Returns
    -------
    TOML text; reading it gives ``mapping`` back
    """
    sources = mapping.get("sources", {})
    section = ""
    entries: Counter[str] = Counter()  # of a list of tables, those above
    lines = []
    for line in tomli_w.dumps(dict(mapping)).splitlines():
        if found := _SECTION.match(line):
            section = f"{found[2]}."
            if found[1] == "[[":
                section += f"{entries[section]}."
                entries[f"{found[2]}."] += 1
        elif section != "sources." and (entry := _ENTRY.match(line)):
            line = _commented(line, f"{section}{entry[1]}", sources)
        lines.append(line)
    head = [
        wrapped
        for note in notes
        for wrapped in textwrap.wrap(
            # A note may quote what a file from elsewhere says, control characters included.
            "".join(c if c.isprintable() else " " for c in note),
            100,
            initial_indent="# - ",
            subsequent_indent="#   ",
            break_long_words=False,
        )
    ]
    return "\n".join([*head, *([""] if head else []), *lines]) + "\n"


def _commented(line: str, path: str, sources: Mapping[str, str]) -> str:
    try:
        unit = stated_unit(path)
    except ParameterError:  # a member of a choice of sections
        unit = None
    remarks = (
        [] if unit in (None, "1") or line.endswith('"') else [str(unit).replace("**", "^").replace("*", " ")]
    )
    if sources.get(path, "").startswith("assumed"):
        remarks.append("assumed")
    if DOUBTFUL in sources.get(path, ""):
        remarks.append("doubtful")
    return f"{line:<{_COLUMN}} # {', '.join(remarks)}" if remarks else line
