"""The sixth set: 40 wrong models and 4 sound ones, which judge once.

python -m benchmarks.foreign_models.sixth [words]
python -m benchmarks.foreign_models.sixth agreement

The first command prints how far each record is from the sound model of the author. It ends with an error if
a wrong model is too near to the sound one or a sound one too far from it. The second command prints how far
the sound model is from ``lumped.steady_state`` on each pair.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Literal

import numpy as np

import lumped
from benchmarks.foreign_models import sixth_mistakes as wrong
from benchmarks.foreign_models.differences import orders_of
from benchmarks.foreign_models.recipe import Settings
from benchmarks.foreign_models.sixth_pairs import SIXTH_PAIRS
from benchmarks.foreign_models.sixth_runs import Misfit, SixthCase, misfits, modelled

FORCES = ("bearing_force_x_p", "bearing_force_y_p", "bearing_force_x_g", "bearing_force_y_g")
ANGLES = ("theta_p", "theta_g")
PINION = ("x_p", "y_p")
GEAR = ("x_g", "y_g")


def written(*channels: str, **others: Any) -> Settings:
    """Channels of a record; other settings by name."""
    return Settings(channels=channels, **others)


#: Models with one mistake, in the order of ``sixth_truths.md``.
SIXTH_WRONG = (
    SixthCase(
        "gear_torque",
        "The torque of the gear's shaft was entered as the torque of the pinion.",
        "mixer",
        written("dte", "mesh_force", *PINION, samples=400, substeps=10),
        drawing=wrong.torque_of_gear_shaft,
    ),
    SixthCase(
        "gear_speed",
        "The speed of the gear's shaft was entered as the speed of the pinion.",
        "joint",
        written("dte", *PINION, *GEAR, "mesh_force", samples=300, substeps=14, cycles=6),
        drawing=wrong.speed_of_gear_shaft,
    ),
    SixthCase(
        "angle_20",
        "The pressure angle stayed at 20 degrees, though the rack has 25.",
        "excavator",
        written("dte", "x_p", "y_p", "mesh_force", method="newmark", samples=500, substeps=4),
        drawing=wrong.entered(basic_rack__pressure_angle=20.0),
    ),
    SixthCase(
        "no_shift",
        "The profile shifts were left out: standard gears at the standard centre distance.",
        "windmill",
        written("dte", *FORCES, samples=512, substeps=8),
        drawing=wrong.entered(pinion__profile_shift=0.0, gear__profile_shift=0.0),
    ),
    SixthCase(
        "wider_face",
        "The stiffness was computed with the wider face width instead of the common one.",
        "mixer",
        written("dte", "x_p", "x_g", "mesh_force", "theta_p", method="heun", samples=512, substeps=8),
        model=wrong.wider_face,
    ),
    SixthCase(
        "tips_without_shift",
        "The tip circles were computed without the profile shifts, r = m z/2 + m.",
        "rig",
        written("dte", "mesh_force", "x_p", "y_p", "y_g", samples=512, substeps=8, noise=0.005, seed=61),
        drawing=wrong.tips_without_shift,
    ),
    SixthCase(
        "addendum_1",
        "The addendum coefficient stayed at 1, though the teeth are long.",
        "press",
        written("dte", "x_p", "y_p", "mesh_force", samples=256, substeps=16, phase=0.3),
        drawing=wrong.entered(basic_rack__addendum_coefficient=1.0),
    ),
    SixthCase(
        "no_bores",
        "The bores were left out of mass and moment of inertia: solid discs.",
        "lathe",
        written("dte", "x_p", "x_g", "mesh_force", "theta_p", "theta_g", samples=512, substeps=8),
        drawing=wrong.entered(pinion__bore=0.0, gear__bore=0.0),
    ),
    SixthCase(
        "inertia_without_half",
        "The moment of inertia of both gears lacks the factor 1/2.",
        "turbine",
        written("dte", *ANGLES, "mesh_force", "x_p", samples=400, substeps=10, origin=0.5),
        model=wrong.double_inertia,
    ),
    SixthCase(
        "steel_for_bronze",
        "The gear of bronze has Young's modulus of steel.",
        "bronze",
        written("dte", "x_p", "x_g", "mesh_force", samples=512, substeps=8),
        drawing=wrong.entered(gear__youngs_modulus=206.0),
    ),
    SixthCase(
        "two_bearings",
        "The stiffness of the whole support was given to each of two bearings of a shaft: twice as stiff.",
        "joint",
        written("dte", *PINION, *GEAR, *FORCES, samples=360, substeps=12),
        model=wrong.two_bearings,
    ),
    SixthCase(
        "cold_oil",
        "The viscosity at 40 degrees was entered instead of that at operating temperature.",
        "windmill",
        written("dte", "y_p", "y_g", "bearing_force_y_p", "mesh_force", samples=512, substeps=8),
        drawing=wrong.entered(lubricant__viscosity=290.0),
    ),
    SixthCase(
        "pitch_radii",
        "Pitch radii stand in the equations of motion instead of base radii.",
        "student",
        written("dte", *ANGLES, "mesh_force", samples=512, substeps=8),
        torsional=True,
        model=wrong.pitch_radii_in_equations,
        exported=wrong.dte_by_pitch_radii,
    ),
    SixthCase(
        "one_way_friction",
        "The friction force keeps one direction: it does not reverse at the pitch point.",
        "old_mill",
        written("dte", "y_p", "y_g", "x_p", "bearing_force_y_p", method="newmark", samples=600, substeps=4),
        model=wrong.one_way_friction,
    ),
    SixthCase(
        "no_friction_moments",
        "Friction acts on the bearings only; its moments about the gear axes were left out.",
        "stub",
        written("dte", "x_p", "y_p", "mesh_force", *ANGLES, samples=512, substeps=8),
        model=wrong.no_friction_moments,
    ),
    SixthCase(
        "friction_reversed",
        "The friction force has the wrong sign on all teeth, as if the gear drove.",
        "excavator",
        written("dte", "y_p", "y_g", "x_p", "mesh_force", samples=512, substeps=8),
        model=wrong.reversed_friction,
    ),
    SixthCase(
        "equal_shares",
        "Friction takes the static load in equal parts on the pairs in contact.",
        "lathe",
        written("dte", "y_p", "y_g", "bearing_force_y_p", "bearing_force_y_g", samples=512, substeps=8),
        runs=wrong.equal_static_shares,
    ),
    SixthCase(
        "mean_stiffness",
        "The mesh stiffness is its mean: it does not vary with time.",
        "student",
        written("dte", *ANGLES, "mesh_force", samples=512, substeps=8),
        torsional=True,
        runs=wrong.mean_stiffness,
    ),
    SixthCase(
        "c_gamma_as_single",
        "The mesh stiffness c_gamma of ISO 6336-1 was used as the stiffness of a single pair.",
        "mixer",
        written("dte", "x_p", "mesh_force", "bearing_force_x_g", samples=640, substeps=7),
        model=wrong.mesh_stiffness_as_single,
    ),
    SixthCase(
        "no_series",
        "The stiffness of one tooth was used for the pair, so the pair is twice as stiff.",
        "student",
        written("dte", "theta_p", "mesh_force", method="heun", samples=1024, substeps=4, noise=0.01, seed=62),
        torsional=True,
        model=wrong.stiffer(2.0),
    ),
    SixthCase(
        "teeth_pull",
        "The teeth never part: the mesh pulls where contact is lost.",
        "howl",
        written("dte", "x_p", "x_g", "mesh_force", samples=512, substeps=8),
        unilateral=True,
        user_unilateral=False,
    ),
    SixthCase(
        "half_damping",
        "The mesh damping lacks the factor 2: c = zeta sqrt(k m_e).",
        "rig",
        written("dte", "mesh_force", *PINION, "x_g", samples=512, substeps=8),
        drawing=wrong.half_damping,
    ),
    SixthCase(
        "no_supports",
        "The supports were left out: the gears only turn.",
        "old_mill",
        written("dte", *ANGLES, "mesh_force", samples=512, substeps=8),
        user_torsional=True,
    ),
    SixthCase(
        "bearings_apart",
        "The displacements of the gears on their bearings do not enter the approach of the teeth.",
        "bronze",
        written("dte", "x_p", "x_g", "mesh_force", "theta_p", samples=512, substeps=8),
        model=wrong.bearings_apart,
        exported=wrong.dte_of_rotations,
    ),
    SixthCase(
        "no_relief",
        "The tip relief was left out: perfect involutes.",
        "relieved",
        written("dte", "x_p", "y_p", "mesh_force", samples=512, substeps=8),
        model=wrong.perfect_involutes,
    ),
    SixthCase(
        "static_error_added",
        "The static transmission error was added as an excitation, beside the stiffness that varies.",
        "rig",
        written("dte", "mesh_force", "x_p", "x_g", samples=512, substeps=8),
        model=wrong.static_error_added,
    ),
    SixthCase(
        "transient",
        "The record starts at rest: the transient is in it.",
        "stub",
        written("dte", "x_p", "y_p", "mesh_force", samples=256, substeps=16, cycles=5),
        runs=wrong.from_rest,
    ),
    SixthCase(
        "long_euler_steps",
        "Explicit Euler steps that are too long.",
        "turbine",
        written("dte", "x_p", "y_p", "mesh_force", method="euler", samples=200, substeps=1, settle=60),
    ),
    SixthCase(
        "coarse_stiffness",
        "The stiffness was read from a table of few points with straight lines between them.",
        "lathe",
        written("dte", "x_p", "mesh_force", "bearing_force_x_p", samples=512, substeps=8),
        runs=wrong.coarse_stiffness(10),
    ),
    SixthCase(
        "backward_euler",
        "Backward Euler with long steps: the integrator damps.",
        "joint",
        written("dte", *PINION, *GEAR, method="backward_euler", samples=100, substeps=1, settle=60),
    ),
    SixthCase(
        "first_harmonic",
        "The mesh stiffness has only its mean and its first harmonic.",
        "bronze",
        written("dte", "x_p", "x_g", "mesh_force", samples=512, substeps=8),
        runs=wrong.first_harmonic,
    ),
    SixthCase(
        "dte_of_rotations",
        "The transmission error was written from the rotations only.",
        "windmill",
        written("dte", "x_p", "x_g", "mesh_force", *ANGLES, samples=512, substeps=8),
        exported=wrong.dte_of_rotations,
    ),
    SixthCase(
        "line_of_centres",
        "Displacements and bearing forces were written along and across the line of centres.",
        "excavator",
        written("dte", *PINION, *GEAR, *FORCES, samples=512, substeps=8, noise=0.005, seed=63),
        exported=wrong.along_line_of_centres,
    ),
    SixthCase(
        "forces_on_housing",
        "The bearing forces were written as those on the housing: the opposite sign.",
        "press",
        written("dte", "x_p", *FORCES, samples=384, substeps=10),
        exported=wrong.on_the_housing,
    ),
    SixthCase(
        "micrometres",
        "The transmission error was written in micrometres.",
        "old_mill",
        written("dte", "x_p", "y_p", "mesh_force", samples=512, substeps=8),
        exported=wrong.in_micrometres,
    ),
    SixthCase(
        "sense_of_rotation",
        "The rotation of the gear was written with the opposite sign.",
        "lathe",
        written("dte", *ANGLES, "mesh_force", samples=512, substeps=8, phase=0.6),
        exported=wrong.one_sense_of_rotation,
    ),
    SixthCase(
        "one_pair",
        "The mesh force was written from one tooth pair only.",
        "press",
        written("dte", "x_p", "mesh_force", samples=512, substeps=8),
        exported=wrong.one_pair,
    ),
    SixthCase(
        "gear_teeth_in_frequency",
        "The mesh frequency was computed with the number of teeth of the gear.",
        "turbine",
        written("dte", "x_p", "y_p", "mesh_force", samples=512, substeps=20),
        model=wrong.gear_teeth_in_frequency,
    ),
    SixthCase(
        "moving_mean",
        "The curves were smoothed before export by a moving mean over a quarter of a mesh cycle.",
        "relieved",
        written("dte", "x_p", "mesh_force", "bearing_force_x_p", samples=512, substeps=8),
        exported=wrong.smoothed,
    ),
    SixthCase(
        "whole_angles",
        "The rotations were written as whole angles, with the uniform rotation in them.",
        "stub",
        written("dte", *ANGLES, "x_p", samples=512, substeps=8),
        exported=wrong.whole_angles,
    ),
)

#: Models without mistake, by other integrators and steps than the sound model of the author.
SIXTH_SOUND = (
    SixthCase(
        "sound_mixer",
        "Sound.",
        "mixer",
        written("dte", *PINION, *GEAR, "mesh_force", method="lsoda", samples=300, rtol=1e-8),
    ),
    SixthCase(
        "sound_press",
        "Sound.",
        "press",
        written("dte", "x_p", "y_p", *FORCES, method="exponentials", samples=600, phase=0.45, cycles=5),
    ),
    SixthCase(
        "sound_howl",
        "Sound.",
        "howl",
        written("dte", "x_p", "x_g", "mesh_force", method="heun", samples=800, substeps=4, origin=0.02),
        unilateral=True,
    ),
    SixthCase(
        "sound_relieved",
        "Sound.",
        "relieved",
        written("dte", *PINION, "mesh_force", method="newmark", samples=1000, substeps=4),
    ),
)

SIXTH = (*SIXTH_WRONG, *SIXTH_SOUND)


#: Smallest difference that some channel of a wrong model has, and largest of a sound one.
SMALLEST, LARGEST = 0.06, 0.01


def within_bounds(case: SixthCase, off: Mapping[str, Misfit]) -> bool:
    """Whether a case is what the set says: far enough from the sound model, or near enough to it.

    A wrong model counts by what a shift in time does not take away, or by a mean. The mean of an angle does
    not count, because both gears may be turned together.
    """
    if case in SIXTH_SOUND:
        return all(max(one) < LARGEST for one in off.values())
    means = [one.mean for name, one in off.items() if name not in ANGLES]
    return max(*(min(one.as_timed, one.shifted) for one in off.values()), *means) > SMALLEST


def agreement() -> None:
    """Print how far orders 1 to 40 and means of the sound model are from ``lumped.steady_state`` [%]."""
    for name, pair in SIXTH_PAIRS.items():
        first = next(case for case in SIXTH if case.on == name)
        silent = first.torsional or pair["friction"]["law"] == "none"
        channels = ("dte",) if first.torsional else ("dte", "x_p", "x_g", *(() if silent else ("y_p", "y_g")))
        case = replace(first, settings=written(*channels))
        contact: Literal["linear", "unilateral"] = "unilateral" if case.unilateral else "linear"
        ours, theirs = lumped.steady_state(pair, contact=contact, samples_per_cycle=512), case.sound()
        period = modelled(pair).period
        cells = []
        for channel in channels:
            reference = ours[channel].to_numpy()
            right = orders_of(ours["time"].to_numpy(), reference, period)[0]
            off = orders_of(theirs["time"], theirs[channel], period)[0] - right
            orders = np.linalg.norm(off[1:]) / np.linalg.norm(right[1:])
            mean = abs(off[0]) / max(abs(right[0]), np.ptp(reference))
            cells.append(f"{channel} {100 * orders:.2f}/{100 * mean:.2f}")
        print(f"{name:10} {contact:10} " + "  ".join(cells), flush=True)


def main(words: list[str]) -> None:
    """Print pair, seconds, and for each channel the three differences of ``Misfit`` [%]."""
    if words == ["agreement"]:
        agreement()
        return
    out_of_bounds = []
    for case in SIXTH:
        if words and not any(word in case.name for word in words):
            continue
        start = time.perf_counter()
        off = misfits(case)
        seconds = time.perf_counter() - start
        cells = (f"{name} " + "/".join(f"{100 * one:.2f}" for one in misfit) for name, misfit in off.items())
        print(f"{case.name:24} {case.on:10} {seconds:5.1f} s  " + "  ".join(cells), flush=True)
        if not within_bounds(case, off):
            out_of_bounds.append(case.name)
    if out_of_bounds:
        raise SystemExit("out of the bounds of the set: " + ", ".join(out_of_bounds))


if __name__ == "__main__":
    main(sys.argv[1:])
