"""The parameter file of somebody's own gear pair, from what is on the drawing."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from lumped.errors import refuse
from lumped.friction.registry import LAWS
from lumped.schema.files import load_gear_pair
from lumped.schema.pair import leaf_paths
from validation.exchange.commented_toml import parameter_text
from validation.exchange.rexs.assumptions import completed

GIVEN = "given by the user"
#: End of a field's path -> why its assumed value was chosen; the first that fits.
_WHY = {
    "_stiffness": "of rolling bearing, shaft and housing together; see the guide on bearings",
    "mesh.damping_ratio": "usual for steel gears, 0.03 to 0.17",
    "damping_ratio": "shaft on rolling bearings; see the guide on bearings",
    "roughness": "ground flanks, Ra 0.4 um",
    "pressure_angle": "standard basic rack, ISO 53",
    "addendum_coefficient": "standard basic rack, ISO 53",
    "dedendum_coefficient": "standard basic rack, ISO 53",
    "fillet_radius_coefficient": "standard basic rack, ISO 53",
    "profile_shift": "no shift",
    "bore": "solid disc",
    "viscosity_law.density": "mineral oil",
    "density": "steel",
    "youngs_modulus": "steel",
    "poisson_ratio": "steel",
    "stiffness.model": "constant stiffness by ISO 6336-1; 'energy' computes it from the tooth form",
    "backlash": "none beyond that of the centre distance",
    "viscosity": "oil warm from running",
    "temperature": "sump of an enclosed gear",
    "viscosity_index": "mineral oil",
    "pressure_viscosity_k": "mineral oil",
    "pressure_viscosity_s": "mineral oil",
    "law": f"law {LAWS['xu_kahraman'].title}, which knows load, speed, oil and roughness",
    "relief": "perfect involutes",
    "contact": "a tooth pair touches where the mean load closes its gap",
    "sharpness": "read by law IV alone",
    "maximum": "bounds law II near the pitch point",
    "thresholds": "read by law V alone",
    "film_length": "usual cut-off",
    "brake_torque": "steady mean speed",
}
_TEETH = re.compile(r"\s*(\d{1,4})\s*[/:x]\s*(\d{1,4})\s*")
_OIL = re.compile(r"\s*(?:iso)?[\s_-]*(?:vg)?[\s_-]*(\d{1,4})\s*", re.IGNORECASE)


def own_pair_text(name: str, given: Mapping[str, Any]) -> str:
    """Return a complete parameter file; every value says whether it was given or why it is assumed.

    Parameters
    ----------
    name : of the pair
    given : ``teeth`` ("19/41"), ``oil`` ("vg220") and field paths -> values; ``gears.`` and ``bearings.``
        in front of a field mean both gears, all four bearing directions

    Raises
    ------
    ParameterError : what is malformed, or a pair that cannot exist
    """
    values = _values(given)
    pair = load_gear_pair({"name": name} | completed(values))
    paths = [path for path in leaf_paths(pair) if path not in ("name", "description")]
    sources = {path: GIVEN if path in values else f"assumed: {_why(path)}" for path in paths}
    assumed = set(paths) - set(values)
    notes = [
        "A bare number means the unit in the comment; text may carry any unit of that kind: '700 in-lb'.",
        f"{len(values)} values are given, {len(assumed)} assumed: replace what you know, first the bearings.",
    ]
    return parameter_text(load_gear_pair(pair.to_mapping() | {"sources": sources}).to_mapping(), notes)


def _values(given: Mapping[str, Any]) -> dict[str, Any]:
    values: dict[str, Any] = {}
    for path, value in given.items():
        if path == "teeth":
            found = _TEETH.fullmatch(str(value))
            if found is None:
                raise refuse("--teeth", value, "PINION/GEAR", "For example --teeth 19/41.")
            values |= {"pinion.teeth": int(found[1]), "gear.teeth": int(found[2])}
        elif path == "oil":
            found = _OIL.fullmatch(str(value))
            if found is None:
                raise refuse("--oil", value, "an ISO viscosity grade", "For example --oil vg220.")
            values |= dict.fromkeys(fields_of(path), int(found[1]))
        else:
            values |= dict.fromkeys(fields_of(path), value)
    return values


def fields_of(path: str) -> list[str]:
    """Fields that one entry of ``own_pair_text`` sets."""
    section, _, key = path.partition(".")
    if path == "oil":
        return ["lubricant.viscosity_law.iso_vg"]
    if section == "bearings":
        return [f"bearings.{gear}.{line}_{key}" for gear in ("pinion", "gear") for line in ("loa", "oloa")]
    return [f"{gear}.{key}" for gear in ("pinion", "gear")] if section == "gears" else [path]


def _why(path: str) -> str:
    return next(why for end, why in _WHY.items() if path.endswith(end))
