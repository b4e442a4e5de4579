"""The eleventh set: 40 wrong models with one mistake each and 4 sound ones, drawn by weight, blind.

python -m benchmarks.foreign_models.eleventh [agreement] [words]
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

import lumped
from benchmarks.foreign_models import eleventh_mistakes as m
from benchmarks.foreign_models.cases import Case as Record
from benchmarks.foreign_models.differences import orders_of
from benchmarks.foreign_models.drawing import drawing_of
from benchmarks.foreign_models.eighth_runs import effects
from benchmarks.foreign_models.eleventh_pairs import PAIRS, TORSIONAL, UNILATERAL
from benchmarks.foreign_models.eleventh_runs import Made
from benchmarks.foreign_models.recipe import Curves, Settings

#: Smallest effect of a wrong model, largest one of a sound model.
WRONG, SOUND = 0.06, 0.01

ON_PINION = ("bearing_force_x_p", "bearing_force_y_p")
FORCES = (*ON_PINION, "bearing_force_x_g", "bearing_force_y_g")
PLACES = ("x_p", "y_p", "x_g", "y_g")
TURNS = ("theta_p", "theta_g")
SHORT = ("dte", "mesh_force", "x_p")
TORSION = ("dte", "mesh_force", *TURNS)
BENCH = ("dte", *FORCES)
NOISE = ("dte", "mesh_force", *ON_PINION)
OFFICE = ("mesh_force", "dte", *FORCES)
THESIS = ("dte", *TURNS, *PLACES, "mesh_force")
MOTION = ("dte", *PLACES)
TEETH = ("dte", "mesh_force", "normal_load", "y_p")

RK4 = Settings("rk4", 480, 6, cycles=5, phase=0.2)
BRIEF = Settings("rk4", 400, 8, cycles=3, phase=0.85)
ODD = Settings("rk4", 413.7, 7, cycles=6.3, phase=0.62)
HEUN = Settings("heun", 600, 10, cycles=6, phase=0.1)
NEWMARK = Settings("newmark", 500, 6, cycles=4, phase=0.45)
LATE = Settings("rk4", 512, 5, cycles=8, phase=0.3, origin=0.5)
LONG = Settings("rk4", 512, 5, cycles=16, phase=0.7)
NOISY = Settings("rk4", 450, 6, cycles=12, phase=0.15, noise=0.005, seed=11)


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
            "pitch_radii",
            "the pitch radii are the arms of the normal load, in place of the base radii",
            Made("fan", TORSION, RK4, line=m.pitch_radii, model=m.period_of_drawing),
        ),
        (
            "torque_of_gear",
            "the torque of the gear shaft is applied to the pinion",
            Made("matlab", TORSION, BRIEF, drawing=m.torque_of_gear),
        ),
        (
            "inertia_about_diameter",
            "the moments of inertia are those about a diameter: half of the polar ones",
            Made("cast", THESIS, RK4, model=m.inertia_about_diameter),
        ),
        (
            "inertias_exchanged",
            "the moments of inertia of pinion and gear are exchanged",
            Made("robot", TORSION, LATE, model=m.inertias_exchanged),
        ),
        (
            "without_shifts",
            "the profile shifts are left out; centre distance and tips follow from zero shift",
            Made("tractor", OFFICE, RK4, drawing=m.without_shifts),
        ),
        (
            "plane_strain_twice",
            "the mesh stiffness is divided by 1 - nu^2: 10 % too large",
            Made("matlab", TORSION, RK4, drawing=m.plane_strain_twice),
        ),
        (
            "mesh_as_pair",
            "the stiffness of the mesh, c_gamma, is entered as that of one tooth pair",
            Made("student", SHORT, HEUN, drawing=m.mesh_as_pair),
        ),
        (
            "shifts_exchanged",
            "the profile shifts of pinion and gear are exchanged, and their tips with them",
            Made("hoist", NOISE, ODD, drawing=m.shifts_exchanged),
        ),
        (
            "contact_ratio_by_rule",
            "the contact ratio is that of a rule of thumb for 20 degrees: the path of contact ends too late",
            Made(
                "fan", NOISE, RK4, line=lambda line: m.contact_ratio_by_rule(drawing_of(PAIRS["fan"]), line)
            ),
        ),
        (
            "bearings_in_other_unit",
            "the bearing stiffness is a thousand times too large by its unit",
            Made("cast", MOTION, replace(RK4, substeps=12), model=m.bearings_in_other_unit),
        ),
        (
            "without_relief",
            "the tip relief of the drawing is left out",
            Made("spindle", OFFICE, LATE, model=m.without_relief),
        ),
        (
            "relief_by_height",
            "the length of the tip relief along the tooth height is taken as that along the path of contact",
            Made("reducer", ("dte", "mesh_force", "x_p", "x_g"), RK4, model=m.relief_by_height),
        ),
        (
            "with_motor",
            "the inertia of the motor, nine times that of the pinion, is added to the pinion",
            Made("spindle", TORSION, NOISY, model=m.with_motor),
        ),
    )


def _physics() -> tuple[tuple[str, str, Made], ...]:
    return (
        (
            "mean_stiffness",
            "the mesh stiffness is constant, its mean",
            Made("wind", NOISE, RK4, table=m.mean_stiffness),
        ),
        (
            "equal_shares",
            "in double contact each pair has half of the mesh force, whatever its stiffness",
            Made("hoist", TEETH, RK4, table=m.equal_shares),
        ),
        (
            "one_pair",
            "one pair at a time: a pair leaves contact when the next one enters, there is no double contact",
            Made("test", NOISE, BRIEF, table=m.one_pair),
        ),
        (
            "friction_one_way",
            "friction does not change its sign at the pitch point",
            Made("cast", BENCH, HEUN, model=m.friction_one_way),
        ),
        (
            "without_friction",
            "friction is left out",
            Made("student", (*TURNS, "dte", "x_p", "y_p"), RK4, model=m.without_friction),
        ),
        (
            "without_friction_moments",
            "friction acts on the bearings, its moments on the gears are left out",
            Made("robot", (*TURNS, "dte", "y_p", "y_g"), RK4, model=m.without_friction_moments),
        ),
        (
            "damping_by_sum_of_masses",
            "the mesh damping is by the sum of both masses in place of the effective mass: too large",
            Made("fan", SHORT, ODD, model=m.damping_by_sum_of_masses),
        ),
        (
            "damping_without_two",
            "the factor 2 is left out of the mesh damping: half of 2 zeta sqrt(k m)",
            Made("matlab", TORSION, NEWMARK, model=m.damping_without_two),
        ),
        (
            "without_mesh_damping",
            "there is no mesh damping",
            Made("test", MOTION, RK4, model=m.without_mesh_damping),
        ),
        (
            "offset_by_backlash",
            "the approach is zero in the middle of the backlash: half of it is in the transmission error",
            Made("reducer", NOISE, LATE, curves=m.offset_by_backlash),
        ),
        (
            "exponent",
            "the contact force grows with the exponent 1.5 of the approach, right at the mean load",
            Made("cast", ("dte", "mesh_force", *PLACES), RK4, model=m.exponent),
        ),
        (
            "directions_exchanged",
            "the bearing stiffness along and off the line of action are exchanged",
            Made("tractor", ("mesh_force", *PLACES), ODD, model=m.directions_exchanged),
        ),
        (
            "wide_reversal",
            "friction rises over sliding velocities up to 1 m/s, a wide zone about the pitch point",
            Made("hoist", ("dte", "mesh_force", "y_p", *ON_PINION), RK4, model=m.wide_reversal),
        ),
        (
            "stiffness_of_one_tooth",
            "the stiffness is that of one tooth, twice that of two teeth in series",
            Made("test", OFFICE, HEUN, drawing=m.stiffness_of_one_tooth),
        ),
    )


def _export() -> tuple[tuple[str, str, Made], ...]:
    return (
        (
            "explicit_euler",
            "explicit Euler with a step that is too long: it takes damping away",
            Made("matlab", TORSION, Settings("euler", 220, 1, cycles=6, settle=400)),
        ),
        (
            "backward_euler",
            "backward Euler with 90 steps in a mesh cycle: its numerical damping is large",
            Made("racing", NOISE, Settings("backward_euler", 90, 1, cycles=20, settle=300)),
        ),
        (
            "frequency_of_gear_teeth",
            "the mesh frequency is the speed of the pinion times the teeth of the gear",
            Made("robot", SHORT, replace(RK4, cycles=18), model=m.frequency_of_gear_teeth),
        ),
        (
            "dte_with_pitch_radii",
            "the transmission error is computed with pitch radii in place of base radii",
            Made("fan", ("dte", "x_p", "x_g", "mesh_force"), LATE, curves=m.dte_with_pitch_radii),
        ),
        (
            "dte_of_rotations",
            "the transmission error is that of the rotations, without the displacements of the bearings",
            Made("hoist", NOISE, NEWMARK, curves=m.dte_of_rotations),
        ),
        (
            "dte_in_micrometres",
            "the transmission error is in micrometres in a column of metres",
            Made("wind", ("dte", "mesh_force", "x_p", "x_g"), ODD, curves=m.dte_in_micrometres),
        ),
        (
            "on_housing",
            "the bearing forces are those on the housing, of opposite sign to those on the gear",
            Made("tractor", OFFICE, NOISY, curves=m.on_housing),
        ),
        (
            "axes_of_drawing",
            "displacements and bearing forces are in axes along and across the centre line",
            Made("spindle", ("dte", "x_p", "y_p", *ON_PINION), RK4, curves=m.axes_of_drawing),
        ),
        (
            "low_pass",
            "the curves are exported after a low-pass filter at three times the mesh frequency",
            Made("reducer", NOISE, LONG, curves=m.low_pass),
        ),
        (
            "without_means",
            "the means are subtracted from all curves",
            Made("tall", ("dte", "mesh_force", "x_p", "x_g"), RK4, curves=m.without_means),
        ),
        (
            "most_loaded_pair",
            "the mesh force is the load of the most loaded pair",
            Made("tall", NOISE, BRIEF, curves=m.most_loaded_pair),
        ),
        (
            "elastic_mesh_force",
            "the mesh force is without its damping part",
            Made("racing", TORSION, RK4, curves=m.elastic_mesh_force),
        ),
        (
            "forces_in_kilonewtons",
            "the forces are in kN",
            Made("fan", OFFICE, HEUN, curves=m.forces_in_kilonewtons),
        ),
    )


def _sound() -> tuple[tuple[str, Made], ...]:
    return (
        ("sound_tractor", Made("tractor", OFFICE, replace(NEWMARK, samples=2048, substeps=2))),
        ("sound_racing", Made("racing", NOISE, Settings("lsoda", 1600, 1, cycles=5, rtol=1e-7))),
        ("sound_wind", Made("wind", THESIS, Settings("dop853", 640, 1, cycles=5.5, phase=0.4, rtol=1e-7))),
        ("sound_reducer", Made("reducer", MOTION, replace(HEUN, cycles=7.2))),
    )


ELEVENTH_WRONG = tuple(
    Case(f"eleventh_{number:02d}_{name}", truth, made, sound=False)
    for number, (name, truth, made) in enumerate((*_inputs(), *_physics(), *_export()), 1)
)
ELEVENTH_SOUND = tuple(Case(f"eleventh_{name}", "sound", made, sound=True) for name, made in _sound())


def judging(kind: str | None = None) -> list[Record]:
    """Return the cases of the eleventh set, of a kind ("sound" or "wrong") or all."""
    wrong = [Record(one.name, "wrong", (one.truth,), one.pair, one.curves) for one in ELEVENTH_WRONG]
    sound = [Record(one.name, "sound", (), one.pair, one.curves) for one in ELEVENTH_SOUND]
    return [record for record in (*sound, *wrong) if kind in (None, record.kind)]


def agreement() -> None:
    """Print how far the author's sound motion of each pair is from ``lumped.steady_state`` [%]."""
    print("| pair | teeth | largest of orders 1 to 40 | largest of means |")
    print("|---|---|---|---|")
    for name, pair in PAIRS.items():
        contact = "unilateral" if name in UNILATERAL else "linear"
        channels = ("dte", *TURNS) if name in TORSIONAL else ("dte", *TURNS, *PLACES)
        ours = lumped.steady_state(pair, contact=contact, samples_per_cycle=512)
        twin = Made(name, channels).twin()
        theirs, period = twin(), twin.user_model.period
        waves, means = [], []
        for channel in channels:
            mine = orders_of(theirs["time"], theirs[channel], period)[0]
            other = orders_of(ours["time"].to_numpy(), ours[channel].to_numpy(), period)[0]
            size = max(np.linalg.norm(other[1:]), 1e-12 * abs(other[0]), 1e-18)
            waves.append(np.linalg.norm((mine - other)[1:]) / size)
            if not channel.startswith("theta"):
                means.append(abs(mine[0] - other[0]) / max(abs(other[0]), np.ptp(theirs[channel]), 1e-18))
        print(f"| {name} | {contact} | {100 * max(waves):.2f} | {100 * max(means):.2f} |", flush=True)


def main(arguments: list[str]) -> None:
    """Print the effect of each mistake on its channels [%]; exit with an error where one is too small."""
    warnings.simplefilter("ignore")
    if "agreement" in arguments:
        agreement()
        return
    bad = []
    print("| case | pair | largest in wave | largest in mean | in wave: dte | channels above 6 % |")
    print("|---|---|---|---|---|---|")
    for case in (*ELEVENTH_WRONG, *ELEVENTH_SOUND):
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
