"""Parameter files of older formats: what a field that they do not write meant then.

Format 1, up to release 0.9: a profile shift that is not written is 0, also beside a centre distance, and tips
are not altered. Since format 2 the shift follows from the centre distance, and tips keep the clearance of the
basic rack.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Any

from lumped.errors import refuse

#: Format of parameter files; a change that older programs would misread, or a new default, raises it.
FORMAT = 2
_FIRST = 1
#: What a field of a gear meant in format 1 where it was not written -> fields that say it instead.
_OF_FORMAT_1 = {"profile_shift": (), "tip_alteration": ("addendum", "tip_diameter")}


def upgraded(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return the plain data of a parameter file in today's format, without the entry ``format``.

    A field that is not in the file gets the default of the older format, and is recorded as assumed.

    Raises
    ------
    ParameterError : a format that this release does not know
    """
    fields = {key: value for key, value in data.items() if key != "format"}
    file_format = data.get("format", FORMAT)
    if file_format == FORMAT and type(file_format) is int:
        return fields
    if file_format != _FIRST or type(file_format) is not int:
        action = "Use a later release of spurcheck, or correct the number."
        raise refuse("format", file_format, f"{_FIRST} or {FORMAT}, the formats of this release", action)
    fields = copy.deepcopy(fields)
    added: dict[str, float] = {}
    for name in ("pinion", "gear"):
        gear = fields.get(name)
        if isinstance(gear, dict):
            for key, instead in _OF_FORMAT_1.items():
                if not any(one in gear for one in (key, *instead)):
                    gear[key] = added[f"{name}.{key}"] = 0.0
    assumed = fields.setdefault("assumed", {})
    if isinstance(assumed, dict):
        fields["assumed"] = added | assumed
    return fields
