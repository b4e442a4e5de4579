"""Every fault, by group: a TOML file a group, a table a fault, its name the key.

``without`` lists fields that the fault needs to be absent; all other entries are those of ``Fault``.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from importlib.resources import files

from validation.faults.fault import Fault


def _read(group: str) -> tuple[Fault, ...]:
    text = (files(__package__) / f"{group.replace(' ', '_')}.toml").read_text(encoding="utf-8")
    found = []
    for key, row in tomllib.loads(text).items():
        on = row.pop("on", {}) | dict.fromkeys(row.pop("without", ()))
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
        "report",
        "input",
    )
}
#: Key -> fault.
FAULTS: Mapping[str, Fault] = {fault.key: fault for group in GROUPS.values() for fault in group}
