"""The fourth set: 40 records with one mistake, 10 sound ones. The list of mistakes came before any code.

The list, in the order of the cases, is `fourth_truths.md`.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

from benchmarks.foreign_models import fourth_mistakes as f
from benchmarks.foreign_models import mistakes as m
from benchmarks.foreign_models.cases import Case, case_of
from benchmarks.foreign_models.fourth_pairs import at
from benchmarks.foreign_models.mistakes import Mistake, Wrong
from benchmarks.foreign_models.recipe import Recipe
from benchmarks.foreign_models.sound import FORMS

FORCES = ("bearing_force_x_p", "bearing_force_y_p", "bearing_force_x_g", "bearing_force_y_g")
ALONG = ("bearing_force_x_p", "bearing_force_x_g")
PLACES = ("x_p", "x_g", "y_p", "y_g")
FULL = ("dte", *PLACES, *FORCES)
PINION = ("dte", "bearing_force_x_p", "bearing_force_y_p")
GEAR = ("bearing_force_x_g", "bearing_force_y_g", "dte")
TURNS = ("theta_p", "theta_g", "dte")
LOADS = ("dte", "mesh_force")


class Point(NamedTuple):
    """Pair of the fourth set at a speed and torque [rpm, N m]; whether its teeth may lose contact."""

    pair: str
    speed: float
    torque: float
    unilateral: bool = False


def wrong(number: int, point: Point, channels: tuple[str, ...], mistake: Mistake) -> Wrong:
    """Return the record with the mistake of this number in the list."""
    pair = at(point.pair, point.speed, point.torque)
    return Wrong(f"fourth_{number:02d}", pair, channels, (mistake,), point.unilateral)


INPUTS = (
    wrong(
        1,
        Point("rack_25_26_45", 3900.0, 140.0),
        PINION,
        Mistake(
            "the pressure angle is typed as 20 degrees; the drawing says 25",
            drawing=f.retyped(basic_rack__pressure_angle=20.0),
        ),
    ),
    wrong(
        2,
        Point("up_58_23", 2300.0, 95.0),
        FULL,
        Mistake(
            "the profile shifts of pinion and gear are exchanged",
            drawing=f.exchanged_shifts,
        ),
    ),
    wrong(
        3,
        Point("bronze_19_67", 3300.0, 22.0),
        TURNS,
        Mistake(
            "the output torque is taken for the torque on the pinion: 3.5 times too much",
            drawing=f.torque_of_other_wheel,
        ),
    ),
    wrong(
        4,
        Point("up_37_21", 4100.0, 260.0),
        GEAR,
        Mistake(
            "the input speed is taken for the speed of the gear: the pinion turns at 21/37 of its speed",
            drawing=f.speed_of_other_wheel,
        ),
    ),
    wrong(
        5,
        Point("pitch_6", 3500.0, 180.0, unilateral=True),
        ("dte", *PLACES),
        Mistake(
            "the diametral pitch 6 of the drawing is rounded to the module 4 mm; it is 4.233 mm",
            drawing=f.retyped(basic_rack__module=4.0),
        ),
    ),
    wrong(
        6,
        Point("up_58_23", 4200.0, 70.0),
        ("dte",),
        Mistake(
            "the width of contact is that of the wider wheel, 20 mm; the teeth touch over 16 mm",
            drawing=f.wider_contact,
        ),
    ),
    wrong(
        7,
        Point("like_31_32", 3050.0, 200.0),
        ("dte", *ALONG),
        Mistake(
            "Young's modulus is that of grey iron, 110 GPa; the gears are steel, 206 GPa",
            drawing=f.retyped(pinion__youngs_modulus=110.0, gear__youngs_modulus=110.0),
        ),
    ),
    wrong(
        8,
        Point("rack_17_30_50", 2350.0, 170.0),
        FULL,
        Mistake(
            "the gear has 52 teeth; the drawing says 50",
            drawing=f.retyped(gear__teeth=52),
        ),
    ),
    wrong(
        9,
        Point("up_37_21", 2700.0, 340.0),
        TURNS,
        Mistake(
            "the masses and inertias of pinion and gear are exchanged",
            drawing=f.exchanged_weights,
        ),
    ),
)

GEOMETRY = (
    wrong(
        10,
        Point("plus_shifts_18_25", 5600.0, 110.0),
        PINION,
        Mistake(
            "the shifted gears stand at the reference centre distance and mesh at the angle of the rack",
            drawing=f.at_reference_centre_distance,
        ),
    ),
    wrong(
        11,
        Point("long_short_14_49", 2900.0, 420.0),
        ("dte", "bearing_force_y_p", "bearing_force_y_g"),
        Mistake(
            "the tip radii are those of gears without profile shift",
            drawing=f.tips_without_shift,
        ),
    ),
    wrong(
        12,
        Point("rack_25_26_45", 5200.0, 190.0, unilateral=True),
        FULL,
        Mistake(
            "pitch radii stand for base radii as the arms of the torques and of the rotations",
            model=f.pitch_radii,
        ),
    ),
    wrong(
        13,
        Point("fine_72_95", 1450.0, 75.0, unilateral=True),
        PINION,
        Mistake(
            "the contact ratio is a handbook value of 1.6; that of the gears is 1.82",
            line=f.contact_ratio(1.6),
        ),
    ),
    wrong(
        14,
        Point("pitch_6", 2450.0, 120.0),
        ("dte",),
        Mistake(
            "the long and the short zone are exchanged: two pairs carry for 2 - contact ratio of the cycle",
            line=f.exchanged_zones,
        ),
    ),
    wrong(
        15,
        Point("low_ratio_16_33", 2600.0, 480.0),
        FORCES,
        Mistake(
            "the lengths of approach and recess are exchanged",
            line=f.exchanged_approach,
        ),
    ),
)

STIFFNESS = (
    wrong(
        16,
        Point("rack_14_42_66", 1750.0, 150.0),
        ("x_p", "x_g", "dte"),
        Mistake(
            "each tooth pair has the stiffness c-gamma of ISO 6336-1, which is that of the mesh",
            model=f.mean_stiffness_for_each,
        ),
    ),
    wrong(
        17,
        Point("like_31_32", 4000.0, 260.0),
        PINION,
        Mistake(
            "the compliance of the Hertzian contact is a quarter of the right one",
            model=f.energy_stiffness(contact=0.25, pinion=1.0, gear=1.0, bodies=1.0),
        ),
    ),
    wrong(
        18,
        Point("high_ratio_41_59", 1900.0, 110.0),
        LOADS,
        Mistake(
            "the compliance of the pinion tooth alone counts: that of the gear tooth is left out",
            model=f.energy_stiffness(contact=1.0, pinion=1.0, gear=0.0, bodies=1.0),
        ),
    ),
    wrong(
        19,
        Point("up_58_23", 3050.0, 120.0),
        ("dte", *ALONG),
        Mistake(
            "the compliance of the gear bodies, the fillet foundation, is left out",
            model=f.energy_stiffness(contact=1.0, pinion=1.0, gear=1.0, bodies=0.0),
        ),
    ),
    wrong(
        20,
        Point("pitch_6", 4700.0, 250.0),
        PINION,
        Mistake(
            "the mesh stiffness comes from a table of 10 entries a mesh cycle, joined by straight lines",
            model=m.whole_mesh(m.coarse_samples(10)),
        ),
    ),
    wrong(
        21,
        Point("like_31_32", 2100.0, 150.0),
        ("dte", *PLACES),
        Mistake(
            "the mesh stiffness is constant, the mean over the mesh cycle",
            model=m.whole_mesh(m.mean_of_cycle),
        ),
    ),
    wrong(
        22,
        Point("light_27_29", 3700.0, 130.0, unilateral=True),
        ("dte", *ALONG),
        Mistake(
            "half of the variation of the mesh stiffness is read as its peak to peak",
            model=m.whole_mesh(f.scaled_swing(0.5)),
        ),
    ),
)

DAMPING = (
    wrong(
        23,
        Point("rack_25_26_45", 2700.0, 100.0),
        ("dte", "x_p", "x_g"),
        Mistake(
            "the damping of the mesh lacks the factor two of 2 zeta sqrt(k m)",
            drawing=m.mesh_damping(0.5),
        ),
    ),
    wrong(
        24,
        Point("low_ratio_16_33", 3850.0, 560.0, unilateral=True),
        LOADS,
        Mistake(
            "the damping ratio of the mesh is typed as 0.008 for 0.08",
            drawing=f.retyped(mesh__damping_ratio=0.008),
        ),
    ),
    wrong(
        25,
        Point("rack_14_42_66", 2450.0, 160.0),
        ("dte", *ALONG),
        Mistake(
            "the damping of the mesh takes the masses of translation for the effective mass of rotation",
            model=lambda model: model.but(damping=f.translation_mass_damping),
        ),
    ),
    wrong(
        26,
        Point("pitch_6", 5500.0, 310.0),
        ("dte", "mesh_force", "x_p"),
        Mistake(
            "the mesh has one constant damper by the mean stiffness; the file has one at each tooth pair",
            model=lambda model: model.but(damping=f.constant_mesh_damping),
        ),
    ),
)

WEIGHTS = (
    wrong(
        27,
        Point("rack_17_30_50", 3900.0, 230.0),
        PINION,
        Mistake(
            "the inertias are m r^2; those of discs are half of it",
            drawing=f.ring_inertia,
        ),
    ),
    wrong(
        28,
        Point("fine_72_95", 1050.0, 90.0),
        FULL,
        Mistake(
            "masses have the diameter for the radius: masses and inertias are four times too large",
            drawing=f.weights(4.0, 4.0, 4.0),
        ),
    ),
    wrong(
        29,
        Point("long_short_14_49", 4300.0, 500.0),
        ("theta_g", "theta_p", "dte", "x_g"),
        Mistake(
            "the inertia of the motor, four times that of the pinion, is added to that of the pinion",
            drawing=f.weights(1.0, 5.0, 1.0),
        ),
    ),
)

FRICTION = (
    wrong(
        30,
        Point("rack_14_42_66", 1300.0, 190.0),
        FORCES,
        Mistake(
            "friction does not change its direction at the pitch point",
            model=f.friction_without_reversal,
        ),
    ),
    wrong(
        31,
        Point("bronze_19_67", 2500.0, 16.0),
        PINION,
        Mistake(
            "friction has the opposite sign at all places",
            model=m.scaled_friction(-1.0),
        ),
    ),
    wrong(
        32,
        Point("low_ratio_16_33", 4900.0, 400.0),
        ("dte", "theta_p", "theta_g"),
        Mistake(
            "friction pushes the bearings, but its moments on the wheels are left out",
            model=m.sign(moment_sign_p=0.0, moment_sign_g=0.0),
        ),
    ),
    wrong(
        33,
        Point("rack_17_30_50", 1700.0, 140.0),
        ("bearing_force_y_p", "bearing_force_y_g", "dte"),
        Mistake(
            "friction of the mesh is computed at one place, that of the pair that came into contact last",
            model=f.one_place_of_friction,
        ),
    ),
    wrong(
        34,
        Point("up_37_21", 2400.0, 300.0),
        ("y_p", "y_g", "dte"),
        Mistake(
            "friction follows the static load T/r_b, not the dynamic load",
            model=f.static_friction,
        ),
    ),
    wrong(
        35,
        Point("like_31_32", 2600.0, 230.0),
        ("dte", *FORCES),
        Mistake(
            "the coefficient of friction is that of dry steel, 0.15, for 0.05",
            drawing=m.friction_settings(coefficient=0.15),
        ),
    ),
)

BEARINGS = (
    wrong(
        36,
        Point("fine_72_95", 820.0, 60.0),
        ("dte", *PLACES),
        Mistake(
            "one bearing of each shaft counts: all bearing stiffnesses are half of the right ones",
            drawing=f.bearing_springs(0.5),
        ),
    ),
    wrong(
        37,
        Point("rack_25_26_45", 4500.0, 160.0),
        PINION,
        Mistake(
            "the bearing stiffnesses along and across the line of action are exchanged",
            drawing=f.exchanged_springs,
        ),
    ),
)

RECORDS = (
    wrong(
        38,
        Point("light_27_29", 5300.0, 200.0),
        LOADS,
        Mistake(
            "the record begins three mesh cycles after the start, before the transient has died away",
            numerics=m.with_numerics(settle=3),
        ),
    ),
    wrong(
        39,
        Point("up_37_21", 3300.0, 280.0),
        ("dte", *FORCES),
        Mistake(
            "the bearing forces are along the line of centres and its normal, not on the line of action",
            curves=f.centre_frame,
        ),
    ),
    wrong(
        40,
        Point("high_ratio_41_59", 2650.0, 150.0),
        ("dte", *FORCES),
        Mistake(
            "the curves are smoothed by a moving average over 0.15 of a mesh cycle",
            curves=f.moving_average(0.15),
        ),
    ),
)

FOURTH_WRONG = (*INPUTS, *GEOMETRY, *STIFFNESS, *DAMPING, *WEIGHTS, *FRICTION, *BEARINGS, *RECORDS)


class Run(NamedTuple):
    """A sound record: operating point, form of the record by its name in ``FORMS``, channels."""

    point: Point
    form: str
    channels: tuple[str, ...]


FOURTH_SOUND = (
    Run(Point("rack_14_42_66", 2050.0, 210.0), "rk4", FULL),
    Run(Point("up_58_23", 3600.0, 85.0), "noisy_lsoda", PINION),
    Run(Point("bronze_19_67", 4300.0, 26.0), "rk4_odd_samples", ("theta_g", "theta_p", "dte")),
    Run(Point("high_ratio_41_59", 3300.0, 130.0), "newmark", ("dte", *PLACES)),
    Run(Point("plus_shifts_18_25", 7400.0, 150.0), "late_start", GEAR),
    Run(Point("light_27_29", 9900.0, 160.0, unilateral=True), "rk4_half_step", ("dte",)),
    Run(Point("long_short_14_49", 3600.0, 450.0), "noisy", FORCES),
    Run(Point("fine_72_95", 1700.0, 95.0), "heun_long", ("mesh_force", "dte")),
    Run(Point("like_31_32", 5100.0, 240.0), "harmonic_balance", ("y_g", "y_p", "x_g", "x_p")),
    Run(Point("rack_17_30_50", 2850.0, 190.0), "dop853", ("normal_load", "friction_force", "dte")),
)


def sound(number: int, run: Run) -> Case:
    """Return the sound record of a number."""
    pair = at(run.point.pair, run.point.speed, run.point.torque)
    settings = replace(FORMS[run.form], channels=run.channels)
    return Case(f"fourth_sound_{number:02d}", "sound", (), pair, Recipe(pair, settings, run.point.unilateral))


def judging(kind: str | None = None) -> list[Case]:
    """Return the cases of the fourth set of a kind, "sound" or "wrong", or all."""
    every = [sound(number, run) for number, run in enumerate(FOURTH_SOUND, 1)]
    every += [case_of(one, "wrong") for one in FOURTH_WRONG]
    return [case for case in every if kind in (None, case.kind)]
