"""Short names of fields, and names that stand for several: ``with_``, ``new_pair`` and --set take them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from lumped.errors import refuse

_GEARS = ("pinion", "gear")
#: Short name -> the fields that it sets.
SHORT_NAMES = {
    "speed": ("operating.pinion_speed",),
    "torque": ("operating.pinion_torque",),
    "range": ("operating.speed_range",),
    "law": ("friction.law",),
    "stiffness": ("mesh.stiffness",),
    "damping": ("mesh.damping_ratio",),
    "module": ("basic_rack.module",),
    "viscosity": ("lubricant.viscosity",),
    "oil": ("lubricant.viscosity_law.iso_vg",),
    "temperature": ("lubricant.viscosity_law.temperature",),
    "teeth": tuple(f"{gear}.teeth" for gear in _GEARS),
    "face_width": tuple(f"{gear}.face_width" for gear in _GEARS),
    "roughness": tuple(f"{gear}.roughness" for gear in _GEARS),
    **{
        f"bearings.{key}": tuple(f"bearings.{g}.{line}_{key}" for g in _GEARS for line in ("loa", "oloa"))
        for key in ("stiffness", "damping_ratio")
    },
}
_TEETH = re.compile(r"\s*[(\[]?\s*(\d{1,4})\s*[/:x,]\s*(\d{1,4})\s*[)\]]?\s*")
_OIL = re.compile(r"\s*(?:iso)?[\s_-]*(?:vg)?[\s_-]*(\d{1,4})\s*", re.IGNORECASE)


def fields_of(name: str) -> tuple[str, ...]:
    """Return the fields that a short name or a path sets; ``gears.`` in front means both gears."""
    section, _, key = name.partition(".")
    return SHORT_NAMES.get(name) or (
        tuple(f"{gear}.{key}" for gear in _GEARS) if section == "gears" and key else (name,)
    )


def by_fields(request: Mapping[str, Any]) -> dict[str, Any]:
    """Return field path -> value; teeth may be "19/41" or a tuple, oil "vg220" or 220."""
    values: dict[str, Any] = {}
    for name, value in request.items():
        if name == "teeth":
            if (teeth := _TEETH.fullmatch(str(value))) is None:
                raise refuse("teeth", value, "PINION/GEAR", "For example 19/41.")
            values |= dict(zip(fields_of(name), map(int, teeth.groups()), strict=True))
        elif name == "oil":
            if (grade := _OIL.fullmatch(str(value))) is None:
                raise refuse("oil", value, "an ISO viscosity grade", "For example vg220.")
            values[SHORT_NAMES[name][0]] = int(grade[1])
        else:
            values |= dict.fromkeys(fields_of(name), value)
    return values
