"""Pairs that the users modelled: presets and unlike pairs in settings that a textbook model has.

Contact is prescribed and relief is left out, because the users' teeth touch from A to D.
"""

from __future__ import annotations

import copy
import tomllib
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

_ROOT = Path(__file__).resolve().parents[2]
_FOLDERS = (_ROOT / "lumped" / "presets", _ROOT / "tests" / "unlike_pairs")


@cache
def _file(name: str) -> dict[str, Any]:
    path = next(folder / f"{name}.toml" for folder in _FOLDERS if (folder / f"{name}.toml").exists())
    return tomllib.loads(path.read_text(encoding="utf-8"))


def pair_from(name: str, title: str, **changes: Any) -> dict[str, Any]:
    """Parameter file as a mapping; a change is named by its path, with two underscores for a point."""
    pair = copy.deepcopy(_file(name))
    for section in ("assumed", "sources", "shafts", "uncertainty"):
        pair.pop(section, None)
    for gear in ("pinion", "gear"):
        for field in ("tip_relief", "root_relief", "deviations"):
            pair[gear].pop(field, None)
    pair |= {"name": title, "description": f"{name} as a user modelled it"}
    pair["mesh"] |= {"contact": "prescribed", "relief": "ignored"}
    for path, value in changes.items():
        *sections, last = path.split("__")
        inside = pair
        for section in sections:
            inside = inside.setdefault(section, {})
        inside[last] = value
    return pair


def bearings(loa: tuple[float, float], oloa: tuple[float, float], damping: float) -> dict[str, Any]:
    """Bearings of pinion and gear [N/m]."""
    return {
        gear: {
            "loa_stiffness": loa[end],
            "oloa_stiffness": oloa[end],
            "loa_damping_ratio": damping,
            "oloa_damping_ratio": damping,
        }
        for end, gear in enumerate(("pinion", "gear"))
    }


def _text(value: Any) -> str:
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key} = {_text(one)}" for key, one in value.items()) + " }"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_text(one) for one in value) + "]"
    return repr(value)


def as_toml(pair: Mapping[str, Any]) -> str:
    """Return the mapping as the text of a parameter file."""
    return "\n".join(f"{key} = {_text(value)}" for key, value in pair.items())


RIGID = 1e12

PAIRS: dict[str, dict[str, Any]] = {
    "nasa": pair_from("nasa_28_28", "nasa", friction={"law": "coulomb", "coefficient": 0.05}),
    "nasa_xk": pair_from(
        "nasa_28_28", "nasa_xk", operating__pinion_speed=2200.0, operating__pinion_torque=79.1
    ),
    "nasa_resonance": pair_from(
        "nasa_28_28",
        "nasa_resonance",
        operating__pinion_speed=6500.0,
        mesh__damping_ratio=0.08,
        friction={"law": "none"},
    ),
    "fzg_xk": pair_from("fzg_c", "fzg_xk"),
    "fzg_bk": pair_from(
        "fzg_c",
        "fzg_bk",
        friction={"law": "benedict_kelley", "maximum": 0.12},
        operating__pinion_speed=900.0,
        operating__pinion_torque=302.0,
        lubricant__viscosity=40.0,
    ),
    "kb_lost": pair_from(
        "kahraman_blankenship_50_50",
        "kb_lost",
        operating__pinion_speed=3400.0,
        mesh__damping_ratio=0.02,
        friction={"law": "none"},
    ),
    "kb_torsional": pair_from(
        "kahraman_blankenship_50_50",
        "kb_torsional",
        friction={"law": "none"},
        mesh__damping_ratio=0.09,
        bearings=bearings((RIGID, RIGID), (RIGID, RIGID), 0.05),
        operating__pinion_speed=1450.0,
    ),
    "hcr": pair_from(
        "high_contact_ratio_29_47",
        "hcr",
        friction={"law": "smoothed_coulomb", "coefficient": 0.06, "sharpness": 25.0},
    ),
    "art_energy": pair_from(
        "nasa_art_25_31",
        "art_energy",
        mesh__stiffness={"model": "energy"},
        operating__pinion_torque=250.0,
        friction={"law": "coulomb", "coefficient": 0.07},
        operating__pinion_speed=3100.0,
        bearings=bearings((2.5e8, 1.6e8), (1.9e8, 2.9e8), 0.04),
    ),
    "low_contact": pair_from("contact_ratio_1_1_large_shifts", "low_contact"),
    "larger_drives": pair_from(
        "larger_gear_drives_contact_lost",
        "larger_drives",
        mesh__damping_ratio=0.03,
        operating__pinion_speed=4000.0,
    ),
    "rack_25": pair_from("rack_25_degrees_always_pushing", "rack_25"),
    "elements": pair_from(
        "unlike_teeth_finite_elements",
        "elements",
        friction={"law": "coulomb", "coefficient": 0.04},
        lubricant={"viscosity": 30.0},
    ),
    "thirds": pair_from(
        "heavily_relieved_under_load",
        "thirds",
        friction={"law": "iso_14179"},
        mesh__damping_ratio=0.08,
    ),
    "springs_46": pair_from("contact_ratio_2_3_on_shafts", "springs_46"),
    "torsional_drive": pair_from(
        "rack_25_degrees_always_pushing",
        "torsional_drive",
        operating__pinion_speed=3300.0,
        friction={"law": "coulomb", "coefficient": 0.08},
        mesh__stiffness={"model": "parabolic"},
        bearings=bearings((RIGID, RIGID), (RIGID, RIGID), 0.05),
    ),
}
