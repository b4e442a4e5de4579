"""Every fault: words, the line of code that it changes, and where its effect shows.

``catalogue/`` has a TOML file a group, in it a table a fault, its name the key. ``without`` lists fields that
the fault needs to be absent; a table ``on`` of the file itself holds for all its faults.
"""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Fault:
    """One fault."""

    key: str  # stable name
    words: str  # what is wrong
    target: str = ""  # function that is changed, "module:name" or "module:Class.name"
    old: str = ""  # text of the function that is replaced; it occurs once
    new: str = ""
    on: Mapping[str, Any] = field(default_factory=dict)
    input: Mapping[str, Any] = field(default_factory=dict)
    test: str = ""  # node of a test that sees it where no verdict does
    unseen: str = ""  # why only a measurement can tell; empty for a fault that the verdicts must see


def _read(group: str) -> tuple[Fault, ...]:
    file = Path(__file__).with_name("catalogue") / f"{group.replace(' ', '_')}.toml"
    faults = []
    rows = tomllib.loads(file.read_text(encoding="utf-8"))
    common = rows.pop("on", {})
    for key, row in rows.items():
        on = common | row.pop("on", {}) | dict.fromkeys(row.pop("without", ()))
        faults.append(Fault(key, on=on, **row))
    return tuple(faults)


#: Group in words -> its faults.
GROUPS: Mapping[str, tuple[Fault, ...]] = {
    group: _read(group)
    for group in (
        "equations of motion",
        "friction and film",
        "geometry",
        "bodies",
        "teeth",
        "elasticity",
        "contact",
        "contact loss",
        "integration",
        "stability",
        "multibody model",
        "shafts",
        "report",
        "input",
    )
}
#: Key -> fault.
FAULTS: Mapping[str, Fault] = {fault.key: fault for group in GROUPS.values() for fault in group}
#: Key -> fault in what the report shows: text, tables, figures. Checks of the report layer judge them.
REPORT_FAULTS: Mapping[str, Fault] = {fault.key: fault for fault in _read("report layer")}
