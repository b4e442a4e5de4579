"""Parameter files of older formats: what a field that they do not write meant then.

Format 1, up to release 0.9: a profile shift that is not written is 0, also beside a centre distance, and tips
are not altered. Since format 2 the shift follows from the centre distance, and tips keep the clearance of the
basic rack.
"""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from lumped.errors import refuse
from lumped.fields.units import to_file

if TYPE_CHECKING:
    from lumped.schema.pair import GearPair

#: Format of parameter files; a change that older programs would misread, or a new default, raises it.
FORMAT = 2
_FIRST = 1
#: What a field of a gear meant in format 1 where it was not written -> fields that say it instead.
_OF_FORMAT_1 = {"profile_shift": (), "tip_alteration": ("addendum", "tip_diameter")}
#: Alteration over module that changes no result anybody reads.
_SMALL = 1e-3


def upgraded(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return the plain data of a parameter file in today's format, without the entry ``format``.

    What an older format meant by leaving a field out is written, and recorded as assumed.

    Raises
    ------
    ParameterError : a format that this release does not know
    """
    fields = {key: value for key, value in data.items() if key != "format"}
    given = data.get("format", FORMAT)
    if given == FORMAT and type(given) is int:
        return fields
    if given != _FIRST or type(given) is not int:
        action = "Use a later release of spurcheck, or correct the number."
        raise refuse("format", given, f"{_FIRST} or {FORMAT}, the formats of this release", action)
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


def changes_since(data: Mapping[str, Any], pair: GearPair) -> Iterator[str]:
    """Yield what a file of format 1 means that the same file of today's format would not, one sentence each.

    Parameters
    ----------
    data : the file as it was read
    pair : the pair that was made of it
    """
    written = {name: data[name] for name in ("pinion", "gear")}
    if pair.centre_distance is not None and not any("profile_shift" in gear for gear in written.values()):
        today = pair.with_({f"{name}.profile_shift": None for name in written})
        if any(abs(one) > _SMALL for one in today.profile_shifts):
            shifts = " and ".join(f"{one:.4f}" for one in today.profile_shifts)
            yield f"no profile shifts are written and 0 is taken; the centre distance asks for {shifts}"
    unwritten = [
        name
        for name, gear in written.items()
        if not any(key in gear for key in ("tip_alteration", "tip_diameter", "addendum"))
    ]
    alteration = pair.tip_alteration
    if unwritten and abs(alteration) > _SMALL * pair.basic_rack.module:
        fields = " and ".join(f"{name}.tip_alteration" for name in unwritten)
        value = to_file(alteration, "mm")
        yield f"tips are not altered; to keep the clearance takes {fields} = {value:.4g} mm"
