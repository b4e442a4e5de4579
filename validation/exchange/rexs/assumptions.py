"""What stands in for parameters that a REXS file does not have, each marked as assumed."""

from __future__ import annotations

from typing import Any

from lumped.fields.units import to_si
from lumped.schema.files import load_gear_pair
from lumped.schema.pair import GearPair, leaf_paths
from validation.exchange.rexs.said import Said

ASSUMED = "assumed"
#: Assumptions that say more than the word.
_BECAUSE = {
    "operating.pinion_torque": "assumed: tangential load over face width and module of 20 N/mm^2",
    "operating.pinion_speed": "assumed: a round number",
}
#: Tangential load over face width and module where a file has no torque [N/m^2]: a moderate load of hardened
#: steel gears of any size.
_LOAD_INTENSITY = 20e6
_BEARING = {
    "loa_stiffness": 1e8,
    "oloa_stiffness": 1e8,
    "loa_damping_ratio": 0.05,
    "oloa_damping_ratio": 0.05,
}
_FIXED: dict[str, Any] = {
    "pinion.roughness": 0.4,
    "gear.roughness": 0.4,
    **{f"bearings.{which}.{key}": value for which in ("pinion", "gear") for key, value in _BEARING.items()},
    "mesh.damping_ratio": 0.05,
    "mesh.stiffness.model": "rectangular",
    "friction.law": "xu_kahraman",
    "operating.pinion_speed": 1000.0,
}
#: Oil temperature where a file has viscosities but no temperature [degC], and dynamic viscosity where it has
#: none [mPa s].
_TEMPERATURE, _VISCOSITY = 70.0, 10.0


def completed(values: dict[str, Any]) -> dict[str, Any]:
    """Return a full parameter mapping, name and description apart, from what a file says.

    Parameters
    ----------
    values : field path -> value in file units
    """
    full = dict(values)
    for path, value in _FIXED.items():
        full.setdefault(path, value)
    law = "lubricant.viscosity_law"
    if any(path.startswith(law) for path in full):
        full.setdefault(f"{law}.temperature", _TEMPERATURE)
    else:
        full.setdefault("lubricant.viscosity", _VISCOSITY)
    if "operating.pinion_torque" not in full:
        full["operating.pinion_torque"] = _torque(full)
    return nested(full)


def _torque(full: dict[str, Any]) -> float:
    """Torque of the load intensity on the pinion's reference circle, three digits [N m]."""
    module, width = (to_si(full[path], "mm") for path in ("basic_rack.module", "pinion.face_width"))
    radius = 0.5 * module * full["pinion.teeth"]
    return float(f"{_LOAD_INTENSITY * width * module * radius:.3g}")


def nested(values: dict[str, Any]) -> dict[str, Any]:
    """Turn dotted paths into nested mappings."""
    root: dict[str, Any] = {}
    for path, value in values.items():
        *parents, leaf = path.split(".")
        node = root
        for parent in parents:
            node = node.setdefault(parent, {})
        node[leaf] = value
    return root


def with_sources(pair: GearPair, said: Said) -> GearPair:
    """Return the pair with a source for every value: its place in the file, or "assumed".

    Parameters
    ----------
    pair : validated
    said : what the file says, with its sources
    """
    sources = {
        path: said.sources.get(path) or _BECAUSE.get(path, ASSUMED)
        for path in sorted(leaf_paths(pair))
        if path not in ("name", "description")
    }
    return load_gear_pair(pair.to_mapping() | {"sources": sources})
