"""Sound records: the physics of the parameter file, by many integrators, in many forms of a record."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, NamedTuple

from benchmarks.foreign_models.pairs import PAIRS
from benchmarks.foreign_models.recipe import Recipe, Settings

FORCES = ("bearing_force_x_p", "bearing_force_y_p", "bearing_force_x_g", "bearing_force_y_g")
PLACES = ("x_p", "x_g", "y_p", "y_g")

#: Channels that a user with six degrees of freedom writes, in his order.
OF_SIX = (
    ("dte",),
    ("dte", "bearing_force_x_p", "bearing_force_y_p"),
    (*PLACES, "dte"),
    FORCES,
    ("theta_g", "theta_p", "dte"),
    ("mesh_force", "dte"),
    ("y_g", "y_p", "x_g", "x_p"),
    ("normal_load", "friction_force", "dte"),
    ("bearing_force_y_g", "dte", "x_p"),
    ("dte", *PLACES, *FORCES, "theta_p", "theta_g"),
    ("x_p", "bearing_force_x_g"),
    ("bearing_force_y_p",),
)
OF_SIX_WITHOUT_FRICTION = (
    ("dte",),
    ("dte", "bearing_force_x_p"),
    ("x_g", "x_p", "dte"),
    ("bearing_force_x_g", "bearing_force_x_p"),
    ("theta_g", "theta_p", "dte"),
    ("mesh_force", "dte", "x_p"),
)
OF_TWO = (
    ("dte",),
    ("theta_p", "theta_g"),
    ("theta_p", "dte", "theta_g"),
    ("mesh_force", "dte"),
    ("dte", "normal_load"),
)

#: Forms of a record. Samples and substeps are so fine that the error stays below 1 %.
FORMS: dict[str, Settings] = {
    "rk4": Settings("rk4", 512, 4),
    "rk4_half_step": Settings("rk4", 512, 8, cycles=4),
    "rk4_odd_samples": Settings("rk4", 387.31, 6, cycles=6.4, phase=0.37),
    "newmark": Settings("newmark", 512, 4, cycles=4, phase=0.12),
    "newmark_half_step": Settings("newmark", 512, 8, cycles=4, phase=0.12),
    "heun_long": Settings("heun", 256, 16, cycles=25),
    "lsoda": Settings("lsoda", 300, 1, cycles=4, phase=0.61, rtol=1e-7),
    "radau": Settings("radau", 256, 1, cycles=4, rtol=1e-5),
    "dop853": Settings("dop853", 333.3, 1, cycles=5.2, phase=0.8, rtol=1e-6),
    "exponentials": Settings("exponentials", 1024, 1, cycles=4),
    "harmonic_balance": Settings("harmonic_balance", 512, 1, cycles=4, orders=70, phase=0.25),
    "euler_cromer": Settings("euler_cromer", 512, 40, cycles=4),
    "from_rest": Settings("rk4", 512, 4, cycles=6, settle=160),
    "late_start": Settings("rk4", 412.7, 5, cycles=9.3, phase=0.55, origin=0.7312),
    "noisy": Settings("rk4", 512, 4, cycles=12, phase=0.2, noise=0.01, seed=3),
    "noisy_lsoda": Settings("lsoda", 271.9, 1, cycles=4.6, noise=0.01, seed=8, rtol=1e-7),
    "very_long": Settings("rk4", 288, 8, cycles=90, phase=0.9),
    "dense": Settings("rk4", 2048, 2, cycles=4),
}
#: Forms that compute teeth that pull, and therefore no loss of contact.
LINEAR_ONLY = {"exponentials", "harmonic_balance"}


class Run(NamedTuple):
    """Pair of ``PAIRS`` at a speed and torque [rpm, N m], and the forms in which it was recorded."""

    pair: str
    speed: float
    torque: float
    forms: tuple[str, ...]
    unilateral: bool = False


RUNS = (
    Run("nasa", 4875.0, 56.5, ("rk4", "newmark", "lsoda", "harmonic_balance", "from_rest")),
    Run("nasa", 1250.0, 22.6, ("rk4_odd_samples", "heun_long")),
    Run("nasa", 7312.0, 56.5, ("euler_cromer", "noisy", "exponentials")),
    Run("nasa", 8775.0, 56.5, ("rk4_half_step", "dop853"), unilateral=True),
    Run("nasa", 16800.0, 56.5, ("rk4", "heun_long", "late_start"), unilateral=True),
    Run("nasa_xk", 2200.0, 79.1, ("newmark_half_step", "late_start", "noisy")),
    Run("nasa_xk", 4840.0, 40.0, ("radau", "rk4_half_step")),
    Run("nasa_resonance", 6500.0, 56.5, ("rk4", "dop853", "exponentials", "noisy_lsoda")),
    Run("nasa_resonance", 9750.0, 56.5, ("heun_long", "newmark", "rk4_half_step")),
    Run("nasa_resonance", 17550.0, 56.5, ("rk4", "lsoda"), unilateral=True),
    Run("fzg_xk", 2170.0, 135.0, ("rk4", "radau", "very_long", "harmonic_balance")),
    Run("fzg_xk", 4774.0, 239.0, ("noisy", "lsoda", "euler_cromer")),
    Run("fzg_xk", 8680.0, 135.0, ("newmark", "rk4_odd_samples"), unilateral=True),
    Run("fzg_bk", 900.0, 302.0, ("dense", "newmark", "late_start")),
    Run("fzg_bk", 2970.0, 180.0, ("rk4_half_step",)),
    Run("kb_lost", 3400.0, 150.0, ("rk4", "late_start", "lsoda"), unilateral=True),
    Run("kb_lost", 5900.0, 150.0, ("newmark_half_step", "heun_long", "noisy"), unilateral=True),
    Run("kb_lost", 6120.0, 300.0, ("very_long",), unilateral=True),
    Run("kb_lost", 5100.0, 150.0, ("harmonic_balance", "rk4_half_step")),
    Run("kb_torsional", 3190.0, 150.0, ("rk4", "noisy", "radau")),
    Run("kb_torsional", 725.0, 80.0, ("heun_long", "exponentials")),
    Run("kb_torsional", 4785.0, 150.0, ("rk4_odd_samples",), unilateral=True),
    Run("hcr", 3200.0, 120.0, ("rk4", "dop853", "harmonic_balance")),
    Run("hcr", 1600.0, 190.0, ("newmark", "very_long")),
    Run("hcr", 5760.0, 120.0, ("from_rest", "noisy")),
    Run("art_energy", 3100.0, 250.0, ("rk4", "lsoda", "late_start")),
    Run("art_energy", 6820.0, 250.0, ("newmark", "rk4_odd_samples")),
    Run("art_energy", 930.0, 250.0, ("noisy",)),
    Run("low_contact", 900.0, 620.0, ("rk4_half_step", "radau")),
    Run("low_contact", 2430.0, 450.0, ("exponentials", "noisy")),
    Run("larger_drives", 4000.0, 55.0, ("rk4", "newmark")),
    Run("larger_drives", 2000.0, 55.0, ("late_start", "harmonic_balance")),
    Run("larger_drives", 8800.0, 55.0, ("rk4_half_step",), unilateral=True),
    Run("larger_drives", 16000.0, 55.0, ("rk4", "noisy"), unilateral=True),
    Run("rack_25", 2100.0, 240.0, ("rk4", "rk4_odd_samples", "lsoda")),
    Run("rack_25", 6930.0, 240.0, ("newmark_half_step", "from_rest")),
    Run("elements", 1700.0, 480.0, ("rk4", "dop853")),
    Run("elements", 5610.0, 480.0, ("late_start", "euler_cromer")),
    Run("thirds", 5400.0, 1500.0, ("rk4", "noisy")),
    Run("thirds", 3150.0, 1500.0, ("harmonic_balance",)),
    Run("springs_46", 2600.0, 210.0, ("rk4", "newmark")),
    Run("springs_46", 7020.0, 210.0, ("rk4_odd_samples",)),
    Run("torsional_drive", 3300.0, 240.0, ("rk4", "dop853")),
    Run("torsional_drive", 7260.0, 240.0, ("late_start",)),
    Run("torsional_drive", 13200.0, 240.0, ("rk4_half_step",), unilateral=True),
)


def changed_pair(name: str, speed: float, torque: float) -> dict[str, Any]:
    """Return a pair of ``PAIRS`` at another operating point."""
    pair = PAIRS[name]
    operating = dict(pair["operating"]) | {"pinion_speed": speed, "pinion_torque": torque}
    return {**pair, "operating": operating}


def channel_sets(pair: dict[str, Any], torsional: bool) -> tuple[tuple[str, ...], ...]:
    if torsional:
        return OF_TWO
    return OF_SIX_WITHOUT_FRICTION if pair["friction"]["law"] == "none" else OF_SIX


def is_torsional(pair_name: str) -> bool:
    """Whether the users of this pair leave out the bearings, which are nearly rigid in the file."""
    return "torsional" in pair_name


def sound_recipes() -> Iterator[tuple[str, Recipe]]:
    """Name and recipe of the sound records."""
    count = 0
    for run in RUNS:
        pair = changed_pair(run.pair, run.speed, run.torque)
        torsional = is_torsional(run.pair)
        sets = channel_sets(pair, torsional)
        for form in run.forms:
            settings = replace(FORMS[form], channels=sets[count % len(sets)])
            name = f"sound_{run.pair}_{run.speed:.0f}_{form}"
            yield name, Recipe(pair, settings, run.unilateral, torsional)
            count += 1
