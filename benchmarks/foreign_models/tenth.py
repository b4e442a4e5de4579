"""The tenth set: 40 wrong models with one mistake each and 4 sound ones, drawn by weight and written blind.

python -m benchmarks.foreign_models.tenth [agreement] [words]
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

import lumped
from benchmarks.foreign_models import tenth_mistakes as m
from benchmarks.foreign_models.cases import Case as Record
from benchmarks.foreign_models.differences import orders_of
from benchmarks.foreign_models.eighth_runs import effects
from benchmarks.foreign_models.recipe import Curves, Settings
from benchmarks.foreign_models.tenth_pairs import PAIRS, TORSIONAL, UNILATERAL
from benchmarks.foreign_models.tenth_runs import Made

#: Smallest effect of a wrong model, largest one of a sound model.
WRONG, SOUND = 0.06, 0.01

FORCES = ("bearing_force_x_p", "bearing_force_y_p", "bearing_force_x_g", "bearing_force_y_g")
PLACES = ("x_p", "x_g", "y_p", "y_g")
TURNS = ("theta_p", "theta_g")
USUAL = ("dte", "mesh_force", "x_p", "y_p")
PINION = ("dte", "bearing_force_x_p", "bearing_force_y_p")
HOUSING = ("mesh_force", *FORCES)
MOTION = ("dte", *PLACES)
DRIVE = (*TURNS, "dte", "mesh_force")
STATES = (*TURNS, *PLACES, "dte", "mesh_force")
RUBBING = ("dte", "mesh_force", "y_p", "y_g", "bearing_force_y_p")

RK4 = Settings("rk4", 500, 5, cycles=5, phase=0.3)
SHORT = Settings("rk4", 360, 8, cycles=3, phase=0.9)
ODD = Settings("rk4", 441.3, 6, cycles=7.7, phase=0.58)
HEUN = Settings("heun", 640, 8, cycles=8, phase=0.05)
NEWMARK = Settings("newmark", 480, 5, cycles=4, phase=0.74)
LATE = Settings("rk4", 512, 4, cycles=9, phase=0.4, origin=0.35)
NOISY = Settings("rk4", 512, 4, cycles=12, phase=0.1, noise=0.005, seed=10)
SETTLED = Settings("rk4", 400, 6, cycles=6, settle=180)


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
        return self.made.handed_in()


def _inputs() -> tuple[tuple[str, str, Made], ...]:
    return (
        (
            "inertias_exchanged",
            "the moments of inertia of pinion and gear are exchanged",
            Made("press", DRIVE, replace(RK4, substeps=16), model=m.inertias_exchanged),
        ),
        (
            "angle_of_20",
            "the pressure angle is 20 degrees though the pair has 25",
            Made("aero", PINION, ODD, drawing=m.angle_of_20),
        ),
        (
            "standard_distance",
            "the centre distance is the standard one, and so is the operating pressure angle, though the sum "
            "of shifts is not zero",
            Made("mill", MOTION, RK4, drawing=m.standard_distance),
        ),
        (
            "standard_tips",
            "the tip diameters are m (z + 2): the profile shifts are forgotten there",
            Made("winch", USUAL, HEUN, drawing=m.standard_tips),
        ),
        (
            "speed_of_gear",
            "the speed of the gear is entered as the speed of the pinion",
            Made("increaser", USUAL, RK4, drawing=m.speed_of_gear),
        ),
        (
            "wider_width",
            "the face width is that of the wider pinion, not the common width",
            Made("mill", USUAL, LATE, model=m.wider_width),
        ),
        (
            "solid_discs",
            "the masses and inertias are those of solid discs; the bores are forgotten",
            Made("lathe", MOTION, ODD, drawing=m.solid_discs),
        ),
        (
            "with_rotor",
            "the inertia of the motor's rotor is added to the pinion, nine times the pinion's inertia in all",
            Made("axle", DRIVE, RK4, model=m.with_rotor),
        ),
        (
            "pitch_radii",
            "pitch radii are used in place of base radii in the equations of motion",
            Made("aero", DRIVE, NEWMARK, line=m.pitch_radii, model=m.same_period),
        ),
        (
            "circular_pitch",
            "the circular pitch pi m is used in place of the base pitch",
            Made("feeder", USUAL, RK4, line=m.circular_pitch),
        ),
        (
            "sum_of_roughness",
            "the roughness in the friction law is the sum of the two Ra, not their mean",
            Made("increaser", MOTION, RK4, drawing=m.sum_of_roughness),
        ),
        (
            "cold_oil",
            "the viscosity is that at 40 degrees, not that at running temperature",
            Made("axle", ("dte", *FORCES), ODD, drawing=m.cold_oil),
        ),
        (
            "mesh_for_pair",
            "the mean stiffness of the mesh, c_gamma, is used as the stiffness of one tooth pair",
            Made("feeder", ("dte", "mesh_force", "x_p"), SETTLED, model=m.mesh_for_pair),
        ),
    )


def _physics() -> tuple[tuple[str, str, Made], ...]:
    return (
        (
            "rectangular",
            "the stiffness of a tooth pair is constant over the path of contact, a rectangular wave, in "
            "place of its curve",
            Made("winch", PINION, RK4, model=m.rectangular),
        ),
        (
            "without_foundation",
            "the compliance of the gear bodies (foundation) is left out of the stiffness of a tooth pair",
            Made("mill", USUAL, NOISY, model=m.without_foundation),
        ),
        (
            "equal_halves",
            "two pairs carry equal halves of the load whatever their stiffness",
            Made("winch", RUBBING, ODD, table=m.equal_halves),
        ),
        (
            "static_friction",
            "friction comes from the static load, not from the dynamic one",
            Made("scooter", RUBBING, RK4, model=m.static_friction),
        ),
        (
            "friction_one_way",
            "friction does not change its sign at the pitch point",
            Made("feeder", MOTION, NEWMARK, model=m.friction_one_way),
        ),
        (
            "friction_reversed",
            "friction acts the wrong way in approach and in recess",
            Made("winch", ("dte", *FORCES), SETTLED, model=m.friction_reversed),
        ),
        (
            "sum_of_velocities",
            "the friction law has the sum of the rolling velocities in place of their mean, the entraining "
            "velocity, also in the slide-to-roll ratio",
            Made("increaser", RUBBING, HEUN, model=m.sum_of_velocities),
        ),
        (
            "radius_in_mm",
            "the equivalent radius is in millimetres in the friction law, not in metres",
            Made("aero", USUAL, ODD, model=m.radius_in_mm),
        ),
        (
            "damping_of_one_pair",
            "mesh damping is constant, that of one pair whatever the number of pairs in contact",
            Made("lathe", ("dte", "mesh_force", "x_p", "x_g"), RK4, table=m.damping_of_one_pair),
        ),
        (
            "without_factor_two",
            "the factor 2 is forgotten in the mesh damping: it is half of 2 zeta sqrt(k m)",
            Made("scooter", DRIVE, SHORT, model=m.without_factor_two),
        ),
        (
            "rigid_bearings",
            "the bearings are rigid: a torsional model, though the bearings are soft",
            Made("feeder", DRIVE, RK4, torsional=True),
        ),
        (
            "mesh_without_bearings",
            "the displacements of the bearings are left out of the approach of the flanks, so that they do "
            "not act on the mesh",
            Made("pump", STATES, RK4, model=m.mesh_without_bearings, curves=m.dte_of_rotations),
        ),
        (
            "relief_twice",
            "the relief is twice as large: pinion's and gear's are both counted on each flank",
            Made("lathe", USUAL, NEWMARK, model=m.relief_twice),
        ),
        (
            "few_harmonics",
            "the mesh stiffness is a Fourier series of two harmonics, not the rectangular wave",
            Made("press", PINION, RK4, model=m.few_harmonics),
        ),
    )


def _export() -> tuple[tuple[str, str, Made], ...]:
    return (
        (
            "explicit_euler",
            "explicit Euler with a step that is too long: it takes damping away",
            Made("tester", DRIVE, Settings("euler", 200, 1, cycles=6, settle=300)),
        ),
        (
            "coarse_table",
            "the mesh stiffness comes from a table of eight points in a mesh cycle, straight lines between",
            Made("tall", USUAL, LATE, model=m.coarse_table),
        ),
        (
            "from_rest",
            "the record begins with the start from rest: it ends before the transient is over",
            Made("old", USUAL, replace(RK4, cycles=8), from_rest=True),
        ),
        (
            "dte_in_radians",
            "the transmission error is an angle of the gear in radians, not a length on the line of action",
            Made("axle", ("dte", *TURNS), RK4, curves=m.dte_in_radians),
        ),
        (
            "dte_reversed",
            "the transmission error has the opposite sign",
            Made("increaser", ("dte", "mesh_force", *FORCES), NOISY, curves=m.dte_reversed),
        ),
        (
            "dte_without_mean",
            "the transmission error is without its mean",
            Made("tall", ("dte", "mesh_force", "x_p", "x_g"), NEWMARK, curves=m.dte_without_mean),
        ),
        (
            "dte_of_rotations",
            "the transmission error is that of the rotations alone, without displacements of the bearings",
            Made("pump", ("dte", "mesh_force", *FORCES[:2]), ODD, curves=m.dte_of_rotations),
        ),
        (
            "in_degrees",
            "the rotations are in degrees, not in radians",
            Made("tester", DRIVE, ODD, curves=m.in_degrees),
        ),
        (
            "on_housing",
            "the bearing forces are those on the housing, of opposite sign to those on the shaft",
            Made("press", HOUSING, HEUN, curves=m.on_housing),
        ),
        (
            "of_springs",
            "the bearing forces are those of the springs alone, without the dampers",
            Made("axle", ("dte", *FORCES), NEWMARK, curves=m.of_springs),
        ),
        (
            "over_angle",
            "the column of time has the angle of the pinion in radians",
            Made("old", PINION, RK4, curves=m.over_angle),
        ),
        (
            "gear_in_sense_of_pinion",
            "the angle of the gear is positive in the sense of the pinion: it has the opposite sign",
            Made("winch", STATES, LATE, curves=m.gear_in_sense_of_pinion),
        ),
        (
            "period_of_gear",
            "the mesh frequency is the speed of the gear times the teeth of the pinion",
            Made("old", USUAL, SETTLED, model=m.period_of_gear),
        ),
    )


def _sound() -> tuple[tuple[str, str, Made], ...]:
    return (
        ("sound_mill", "sound", Made("mill", USUAL, replace(NEWMARK, samples=1536, substeps=2))),
        ("sound_scooter", "sound", Made("scooter", DRIVE, Settings("lsoda", 1024, 1, cycles=5, rtol=1e-7))),
        ("sound_pump", "sound", Made("pump", STATES, replace(HEUN, cycles=6.4))),
        (
            "sound_axle",
            "sound",
            Made("axle", MOTION, Settings("dop853", 500, 1, cycles=6.4, phase=0.2, rtol=1e-7)),
        ),
    )


TENTH_WRONG = tuple(
    Case(f"tenth_{number:02d}_{name}", truth, made, sound=False)
    for number, (name, truth, made) in enumerate((*_inputs(), *_physics(), *_export()), 1)
)
TENTH_SOUND = tuple(Case(f"tenth_{name}", truth, made, sound=True) for name, truth, made in _sound())


def judging(kind: str | None = None) -> list[Record]:
    """Return the cases of the tenth set, of a kind ("sound" or "wrong") or all."""
    wrong = [Record(one.name, "wrong", (one.truth,), one.pair, one.curves) for one in TENTH_WRONG]
    sound = [Record(one.name, "sound", (), one.pair, one.curves) for one in TENTH_SOUND]
    return [record for record in (*sound, *wrong) if kind in (None, record.kind)]


def agreement() -> None:
    """Print how far the author's sound motion of each pair is from ``lumped.steady_state`` [%]."""
    print("| pair | teeth | largest of orders 1 to 40 | largest of means |")
    print("|---|---|---|---|")
    for name, pair in PAIRS.items():
        contact = "unilateral" if name in UNILATERAL else "linear"
        channels = DRIVE[:3] if name in TORSIONAL else (*TURNS, *MOTION)
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
    for case in (*TENTH_WRONG, *TENTH_SOUND):
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
