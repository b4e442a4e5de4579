"""Every fault, by group: a TOML file a group, a table a fault, its name the key.

``without`` lists fields that the fault needs to be absent; all other entries are those of ``Fault``. A table
``on`` of the file itself holds for all its faults.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from importlib.resources import files

from validation.faults.fault import Fault


def _read(group: str) -> tuple[Fault, ...]:
    text = (files(__package__) / f"{group.replace(' ', '_')}.toml").read_text(encoding="utf-8")
    found, rows = [], tomllib.loads(text)
    common = rows.pop("on", {})
    for key, row in rows.items():
        on = common | row.pop("on", {}) | dict.fromkeys(row.pop("without", ()))
        found.append(Fault(key, on=on, **row))
    return tuple(found)


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
