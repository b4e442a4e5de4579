"""The eighth set: 40 wrong models with one mistake each and 4 sound ones, drawn and written blind.

python -m benchmarks.foreign_models.eighth [agreement] [words]
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

import lumped
from benchmarks.foreign_models import eighth_mistakes as mistakes
from benchmarks.foreign_models.cases import Case as Record
from benchmarks.foreign_models.differences import orders_of
from benchmarks.foreign_models.drawing import drawing_of
from benchmarks.foreign_models.eighth_pairs import PAIRS
from benchmarks.foreign_models.eighth_runs import TORSIONAL, UNILATERAL, Made, effects
from benchmarks.foreign_models.recipe import Curves, Settings

#: Smallest effect of a wrong model, largest one of a sound model.
WRONG, SOUND = 0.06, 0.01

PLAIN = ("dte", "x_p", "y_p", "bearing_force_x_p", "bearing_force_y_p")
LOADS = (
    "dte",
    "mesh_force",
    "bearing_force_x_p",
    "bearing_force_y_p",
    "bearing_force_x_g",
    "bearing_force_y_g",
)
TURNS = ("theta_p", "theta_g", "dte", "mesh_force")
PLACES = ("dte", "x_p", "x_g", "y_p", "y_g")
ALL = ("dte", "theta_p", "theta_g", "x_p", "x_g", "y_p", "y_g", "mesh_force")
FEW = ("dte", "mesh_force", "y_p")
SUPPORTS = ("mesh_force", "bearing_force_x_p", "bearing_force_y_p", "dte")

RK4 = Settings("rk4", 512, 4, cycles=6)
ODD = Settings("rk4", 387.31, 6, cycles=7.4, phase=0.37)
NEWMARK = Settings("newmark", 512, 4, cycles=5, phase=0.12)
HEUN = Settings("heun", 256, 16, cycles=12, phase=0.7)
LSODA = Settings("lsoda", 300, 1, cycles=4, phase=0.61, rtol=1e-7)
MAPS = Settings("exponentials", 1024, 1, cycles=4)
REST = Settings("rk4", 512, 4, cycles=6, settle=160)
LATE = Settings("rk4", 412.7, 5, cycles=9.3, phase=0.55, origin=0.7312)
MEASURED = Settings("rk4", 512, 4, cycles=12, phase=0.2, noise=0.005, seed=8)


class Case(NamedTuple):
    """A model by another author: the file he says he modelled, his curves, the truth about them."""

    name: str
    truth: str
    made: Made
    sound: bool

    @property
    def pair(self) -> Mapping[str, Any]:
        return PAIRS[self.made.pair]

    def curves(self) -> Curves:
        return self.made.recipe()()


def _wrong() -> tuple[tuple[str, str, Made], ...]:
    m = mistakes
    at_rack_angle = m.line_at_rack_angle(drawing_of(PAIRS["tractor"]))
    return (
        (
            "shifts_left_out",
            "profile shifts are left out: standard gears at the standard centre distance",
            Made("gearbox", PLAIN, RK4, drawing=m.without_shifts),
        ),
        (
            "rack_angle",
            "pitch point and line of action come from the rack's pressure angle, not the operating one",
            Made("tractor", LOADS, NEWMARK, line=at_rack_angle),
        ),
        (
            "shifts_in_mm",
            "profile shifts in mm are entered as coefficients",
            Made("mower", PLAIN, ODD, drawing=m.shifts_in_mm),
        ),
        (
            "half_speed",
            "the speed in rpm is turned into rad/s with pi/60: half the speed",
            Made("robot", FEW, RK4, drawing=m.half_speed),
        ),
        (
            "speed_of_gear",
            "the speed of the gear's shaft is entered as that of the pinion",
            Made("tractor", PLACES, REST, drawing=m.speed_of_gear),
        ),
        (
            "torque_of_gear",
            "the torque of the gear's shaft is entered as that of the pinion",
            Made("mower", LOADS, NEWMARK, drawing=m.torque_of_gear),
        ),
        (
            "inertias_exchanged",
            "the moments of inertia of pinion and gear are exchanged",
            Made("robot", ALL, replace(RK4, substeps=16, phase=0.61), model=m.inertias_exchanged),
        ),
        (
            "inertias_solid",
            "the moments of inertia are those of solid discs though the gears have large bores",
            Made("winder", TURNS, RK4, model=m.inertias_solid),
        ),
        (
            "inertias_with_shafts",
            "the moments of inertia contain shaft and coupling hub: 2.5 times those of the gears",
            Made("office_linear", TURNS, ODD, model=m.inertias_with_shafts),
        ),
        (
            "relief_left_out",
            "the tip relief of both gears is left out",
            Made("office_linear", FEW, RK4, model=m.without_relief),
        ),
        (
            "relief_from_single_contact",
            "the tip relief starts where single contact ends, earlier than the drawing says",
            Made("office_parabolic", PLAIN, HEUN, model=m.relief_from_single_contact),
        ),
        (
            "relief_twice",
            "the tip relief is twice as large: the amount on the diameter is taken for that of the flank",
            Made("office_25_degrees", ("dte", "mesh_force", "x_p", "x_g"), MEASURED, model=m.relief_twice),
        ),
        (
            "bore_as_radius",
            "the moments of inertia of pinion and gear are too small: diameters of bores enter as radii",
            Made("winder", PLAIN, RK4, model=m.bore_as_radius),
        ),
        (
            "mean_stiffness",
            "the mesh stiffness does not vary: it is the mean over the cycle",
            Made("lathe", TURNS, RK4, model=m.mean_stiffness),
        ),
        (
            "iso_without_0_8",
            "the correction factor 0.8 of ISO 6336 is left out: the stiffness is 1.25 times too large",
            Made("press", PLAIN, LATE, drawing=lambda drawing: replace(drawing, stiffness_factor=1.25)),
        ),
        (
            "half_each",
            "pairs in double contact carry half of the load each, whatever their stiffness",
            Made("pump", ("dte", "mesh_force", "y_p", "y_g", "bearing_force_y_p"), RK4, model=m.half_each),
        ),
        (
            "friction_from_pitch_point",
            "the cycle of friction starts at the pitch point while that of the stiffness starts at A",
            Made("pump", PLACES, NEWMARK, model=m.friction_from_pitch_point),
        ),
        (
            "first_harmonic",
            "the mesh stiffness is its mean and its first harmonic alone",
            Made("long_teeth", SUPPORTS, RK4, model=m.first_harmonic),
        ),
        (
            "trapezoid",
            "a pair takes up and gives off its stiffness over a fifth of the path of contact, not at once",
            Made("long_teeth", PLAIN, ODD, model=m.trapezoid),
        ),
        (
            "contact_ratio_of_1_5",
            "the contact ratio is 1.5, a round number",
            Made("press", LOADS, NEWMARK, line=m.contact_ratio_of_1_5),
        ),
        (
            "friction_one_way",
            "friction does not turn round at the pitch point",
            Made("mower", PLACES, RK4, model=m.friction_one_way),
        ),
        (
            "friction_reversed",
            "friction has the wrong sign in all equations",
            Made("office_parabolic", LOADS, ODD, model=m.friction_reversed),
        ),
        (
            "arms_of_pitch_point",
            "the arms of friction are those of the pitch point at all times",
            Made("pump", ALL, HEUN, model=m.arms_of_pitch_point),
        ),
        (
            "friction_of_static_load",
            "friction is the coefficient times the static load, not the momentary one",
            Made("aero", LOADS, LSODA, model=m.friction_of_static_load),
        ),
        (
            "half_entrainment",
            "the friction law of Benedict and Kelley has the mean of the rolling velocities, not their sum",
            Made("tractor", PLACES, NEWMARK, model=m.half_entrainment),
        ),
        (
            "damping_of_translating_masses",
            "the damping ratio of the mesh is of the sum of the masses, not the effective mass of rotation",
            Made("aero", TURNS, ODD, model=m.damping_of_translating_masses),
        ),
        (
            "no_supports",
            "the model has the two rotations alone: the supports do not give",
            Made("press", TURNS, RK4, torsional=True),
        ),
        (
            "coarse_table",
            "stiffness and friction come from a table of 12 positions in a mesh cycle without interpolation",
            Made("lathe", TURNS, NEWMARK, model=m.coarse_table),
        ),
        (
            "smoothed",
            "the curves are smoothed by a moving average over an eighth of a mesh cycle",
            Made("long_teeth", LOADS, RK4, curves=m.smoothed),
        ),
        (
            "dte_at_reference",
            "the transmission error is the difference of rotations times reference radii, not base radii",
            Made("aero", ALL, RK4, curves=m.dte_at_reference),
        ),
        (
            "dte_of_rotations",
            "the transmission error is that of the rotations, without the displacements of the bearings",
            Made("robot", (*TURNS, "x_p", "x_g"), ODD, curves=m.dte_of_rotations),
        ),
        (
            "in_millimetres",
            "displacements and transmission error are in mm, not in m",
            Made("mower", (*PLACES, "mesh_force"), REST, curves=m.in_millimetres),
        ),
        (
            "without_means",
            "the mean is taken out of all curves",
            Made("aero", LOADS, NEWMARK, curves=m.without_means),
        ),
        (
            "on_housing",
            "bearing forces are those on the housing: the opposite sign",
            Made("gearbox", LOADS, MAPS, curves=m.on_housing),
        ),
        (
            "of_machine",
            "displacements and bearing forces are horizontal and vertical, not along and off the line",
            Made("tractor", PLAIN, MEASURED, curves=m.of_machine),
        ),
        (
            "forces_in_kilonewton",
            "forces are in kN, not in N",
            Made("pump", LOADS, LATE, curves=m.forces_in_kilonewton),
        ),
        (
            "in_degrees",
            "rotations are in degrees, not in radians",
            Made("lathe", TURNS, LATE, curves=m.in_degrees),
        ),
        (
            "period_from_gear",
            "the mesh frequency is the speed of the pinion times the teeth of the gear",
            Made("press", FEW, RK4, model=m.period_from_gear),
        ),
        (
            "other_way_off_line",
            "the direction off the line of action is positive the other way",
            Made("office_linear", PLACES, RK4, curves=m.other_way_off_line),
        ),
        (
            "dte_at_tip",
            "the transmission error is that of the tooth tips: times tip radius over base radius",
            Made("office_25_degrees", ("dte", "mesh_force", "theta_p", "theta_g"), ODD, curves=m.dte_at_tip),
        ),
    )


def _sound() -> tuple[tuple[str, str, Made], ...]:
    return (
        ("sound_gearbox", "sound", Made("gearbox", PLAIN, Settings("radau", 256, 1, cycles=4, rtol=1e-5))),
        ("sound_long_teeth", "sound", Made("long_teeth", (*TURNS[:2], *PLACES), replace(MAPS, phase=0.3))),
        ("sound_office_linear", "sound", Made("office_linear", PLAIN, HEUN)),
        ("sound_aero", "sound", Made("aero", TURNS, Settings("dop853", 333.3, 1, cycles=5.2, phase=0.8))),
    )


EIGHTH_WRONG = tuple(
    Case(f"eighth_{number:02d}_{name}", truth, made, sound=False)
    for number, (name, truth, made) in enumerate(_wrong(), 1)
)
EIGHTH_SOUND = tuple(Case(f"eighth_{name}", truth, made, sound=True) for name, truth, made in _sound())


def judging(kind: str | None = None) -> list[Record]:
    """Return the cases of the eighth set, of a kind ("sound" or "wrong") or all."""
    wrong = [Record(one.name, "wrong", (one.truth,), one.pair, one.curves) for one in EIGHTH_WRONG]
    sound = [Record(one.name, "sound", (), one.pair, one.curves) for one in EIGHTH_SOUND]
    return [record for record in (*sound, *wrong) if kind in (None, record.kind)]


def agreement() -> None:
    """Print how far the author's sound motion of each pair is from ``lumped.steady_state`` [%]."""
    print("| pair | teeth | largest of orders 1 to 40 | largest of means |")
    print("|---|---|---|---|")
    for name, pair in PAIRS.items():
        contact = "unilateral" if name in UNILATERAL else "linear"
        channels = TURNS[:3] if name in TORSIONAL else (*PLACES, *TURNS[:2])
        ours = lumped.steady_state(pair, contact=contact, samples_per_cycle=512)
        twin = Made(name, channels).twin()
        theirs, period = twin(), twin.user_model.period
        waves, means = [], []
        for channel in channels:
            mine = orders_of(theirs["time"], theirs[channel], period)[0]
            other = orders_of(ours["time"].to_numpy(), ours[channel].to_numpy(), period)[0]
            waves.append(np.linalg.norm((mine - other)[1:]) / np.linalg.norm(other[1:]))
            if not channel.startswith("theta"):
                means.append(abs(mine[0] - other[0]) / max(abs(other[0]), np.ptp(theirs[channel])))
        print(f"| {name} | {contact} | {100 * max(waves):.2f} | {100 * max(means):.2f} |", flush=True)


def main(arguments: list[str]) -> None:
    """Print the effect of each mistake on its channels [%]; exit with an error where one is too small."""
    warnings.simplefilter("ignore")
    if "agreement" in arguments:
        agreement()
        return
    bad = []
    print("| case | pair | largest in wave | largest in mean | in wave: dte or first | channels above 6 % |")
    print("|---|---|---|---|---|---|")
    for case in (*EIGHTH_WRONG, *EIGHTH_SOUND):
        if arguments and not any(word in case.name for word in arguments):
            continue
        found = effects(case.curves(), case.made)
        wave, mean = max(found, key=lambda one: found[one].wave), max(found, key=lambda one: found[one].mean)
        largest = max(found[wave].wave, found[mean].mean)
        if (largest > SOUND) if case.sound else (largest < WRONG):
            bad.append(case.name)
        above = sum(max(one) > WRONG for one in found.values())
        first = "dte" if "dte" in found else next(iter(found))
        cells = (
            case.name,
            case.made.pair,
            f"{100 * found[wave].wave:.1f} {wave}",
            f"{100 * found[mean].mean:.1f} {mean}",
            f"{100 * found[first].wave:.1f}",
            f"{above} of {len(found)}",
        )
        print("| " + " | ".join(cells) + " |", flush=True)
    if bad:
        raise SystemExit(f"effect too small of a wrong model, or too large of a sound one: {', '.join(bad)}")


if __name__ == "__main__":
    main(sys.argv[1:])
