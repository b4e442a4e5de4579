"""Pairs of the second, held-back set: the presets and unlike pairs in other settings than in ``pairs``."""

from __future__ import annotations

from typing import Any

from benchmarks.foreign_models.pairs import RIGID, bearings, pair_from

_PARABOLA = {"model": "parabolic"}
_STEPS = {"model": "rectangular"}
_NO_BEARINGS = bearings((RIGID, RIGID), (RIGID, RIGID), 0.05)


def _smoothed(coefficient: float, sharpness: float) -> dict[str, Any]:
    return {"law": "smoothed_coulomb", "coefficient": coefficient, "sharpness": sharpness}


def _coulomb(coefficient: float) -> dict[str, Any]:
    return {"law": "coulomb", "coefficient": coefficient}


SECOND_PAIRS: dict[str, dict[str, Any]] = {
    "nasa_smooth": pair_from(
        "nasa_28_28",
        "nasa_smooth",
        friction=_smoothed(0.07, 30.0),
        mesh__stiffness=_PARABOLA,
        mesh__damping_ratio=0.07,
        bearings=bearings((0.9e8, 1.3e8), (1.1e8, 0.7e8), 0.06),
    ),
    "nasa_torsional": pair_from(
        "nasa_28_28",
        "nasa_torsional",
        friction={"law": "none"},
        mesh__damping_ratio=0.06,
        bearings=_NO_BEARINGS,
    ),
    "fzg_coulomb": pair_from(
        "fzg_c",
        "fzg_coulomb",
        friction=_coulomb(0.09),
        mesh__stiffness=_PARABOLA,
        mesh__damping_ratio=0.07,
        bearings=bearings((2.2e8, 1.5e8), (1.2e8, 1.8e8), 0.08),
    ),
    "fzg_iso": pair_from("fzg_c", "fzg_iso", friction={"law": "iso_14179"}),
    "kb_bearings": pair_from(
        "kahraman_blankenship_50_50",
        "kb_bearings",
        friction=_coulomb(0.05),
        mesh__damping_ratio=0.06,
        bearings=bearings((4e8, 6e8), (3e8, 5e8), 0.04),
    ),
    "hcr_rough": pair_from("high_contact_ratio_29_47", "hcr_rough"),
    "art_parabola": pair_from(
        "nasa_art_25_31",
        "art_parabola",
        friction=_smoothed(0.05, 40.0),
        mesh__stiffness=_PARABOLA,
        mesh__damping_ratio=0.06,
        bearings=bearings((1.3e8, 2.1e8), (2.4e8, 1.2e8), 0.05),
    ),
    "art_torsional": pair_from(
        "nasa_art_25_31",
        "art_torsional",
        friction={"law": "none"},
        mesh__damping_ratio=0.07,
        bearings=_NO_BEARINGS,
    ),
    "low_benedict": pair_from(
        "contact_ratio_1_1_large_shifts",
        "low_benedict",
        friction={"law": "benedict_kelley", "maximum": 0.14},
    ),
    "larger_coulomb": pair_from(
        "larger_gear_drives_contact_lost",
        "larger_coulomb",
        friction=_coulomb(0.06),
        mesh__stiffness=_PARABOLA,
        mesh__damping_ratio=0.05,
    ),
    "rack_xu": pair_from(
        "rack_25_degrees_always_pushing",
        "rack_xu",
        friction={"law": "xu_kahraman"},
        mesh__stiffness=_PARABOLA,
        mesh__damping_ratio=0.06,
    ),
    "elements_smooth": pair_from(
        "unlike_teeth_finite_elements",
        "elements_smooth",
        friction=_smoothed(0.05, 20.0),
        mesh__stiffness=_PARABOLA,
        lubricant={"viscosity": 25.0},
    ),
    "thirds_coulomb": pair_from(
        "heavily_relieved_under_load",
        "thirds_coulomb",
        friction=_coulomb(0.055),
        mesh__stiffness=_STEPS,
        mesh__damping_ratio=0.07,
    ),
    "springs_parabola": pair_from(
        "contact_ratio_2_3_on_shafts",
        "springs_parabola",
        friction=_coulomb(0.07),
        mesh__stiffness=_PARABOLA,
    ),
}


def second_pair(name: str, speed: float, torque: float) -> dict[str, Any]:
    """Return a pair of ``SECOND_PAIRS`` at an operating point [rpm, N m]."""
    pair = SECOND_PAIRS[name]
    operating = dict(pair["operating"]) | {"pinion_speed": speed, "pinion_torque": torque}
    return {**pair, "operating": operating}
