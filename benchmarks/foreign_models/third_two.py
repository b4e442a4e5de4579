"""Records of the third set with two mistakes that have nothing to do with each other."""

from __future__ import annotations

from benchmarks.foreign_models import mistakes as m
from benchmarks.foreign_models import third_mistakes as t
from benchmarks.foreign_models.mistakes import Mistake, Wrong
from benchmarks.foreign_models.recipe import Settings
from benchmarks.foreign_models.third_pairs import at

#: Rate that the user believed over the rate of the recorder, 51.2 kHz and 50 kHz.
RATES = 51.2 / 50.0

THIRD_TWO: list[Wrong] = [
    Wrong(
        "torque_and_direction_of_friction",
        at("pitch_8", 3500.0, 80.0),
        ("dte", "y_p", "y_g", "bearing_force_y_g"),
        (
            Mistake(
                "the torque of the pinion is the torque of the gear shaft",
                drawing=t.entered(operating__pinion_torque=t.times(40.0 / 24.0)),
            ),
            Mistake(
                "friction pushes both gears in the same direction",
                model=m.sign(force_sign_yg=-1.0),
            ),
        ),
        unilateral=True,
    ),
    Wrong(
        "theoretical_stiffness_and_bearing_damping",
        at("old_rack", 2800.0, 310.0),
        ("dte", "x_p", "y_p", "x_g", "y_g"),
        (
            Mistake(
                "the factor 0.8 of ISO 6336 between theory and measured stiffness is left out",
                model=m.scaled_stiffness(1.25),
            ),
            Mistake(
                "the damping of the bearings is in N s/mm, 1000 times too small",
                model=m.bearing_damping(1e-3),
            ),
        ),
    ),
    Wrong(
        "natural_logarithm_and_flywheel_effect",
        at("speed_up_51_19", 2300.0, 150.0),
        ("dte", "bearing_force_x_p", "bearing_force_y_p", "bearing_force_y_g"),
        (
            Mistake(
                "the logarithm in the law of Benedict and Kelley is the natural one",
                model=t.natural_logarithm(0.25),
            ),
            Mistake(
                "the moment of inertia of both gears is GD2, the flywheel effect, four times as large",
                model=t.flywheel_effect,
            ),
        ),
    ),
    Wrong(
        "iron_as_steel_and_window",
        at("iron_gear", 1750.0, 360.0),
        ("dte", "bearing_force_x_p", "bearing_force_y_p"),
        (
            Mistake(
                "Young's modulus of the gear is 206 GPa of steel; the gear is cast iron of 112 GPa",
                drawing=t.entered(gear__youngs_modulus=206.0),
            ),
            Mistake(
                "the curves were written with the mean taken out and a Hann window over the record left on",
                curves=t.window_left_on,
            ),
        ),
        settings=Settings(method="rk4", samples=400, substeps=5, cycles=12),
    ),
    Wrong(
        "default_addendum_and_exchanged_bearings",
        at("long_teeth", 1900.0, 105.0),
        ("dte", *t.FORCES),
        (
            Mistake(
                "the addendum coefficient is the default of 1; the rack has 1.3",
                drawing=t.entered(basic_rack__addendum_coefficient=1.0),
            ),
            Mistake(
                "the bearings of pinion and gear are exchanged",
                model=m.exchanged_bearings(m.PINION_AND_GEAR),
            ),
        ),
    ),
    Wrong(
        "peak_at_pitch_point_and_doubled_bearings",
        at("short_path", 4100.0, 330.0),
        ("dte", "x_p", "y_p", "bearing_force_x_g"),
        (
            Mistake(
                "the parabola of the stiffness has its peak at the pitch point, not in mid-path",
                model=m.other_stiffness(t.peak_at_pitch_point),
            ),
            Mistake(
                "the stiffness of the supports is taken for that of one of two bearings, and doubled",
                drawing=t.stiffness_of_all_bearings(2.0),
            ),
        ),
    ),
    Wrong(
        "hertz_twice_and_pounds",
        at("speed_up_44_27", 3600.0, 200.0),
        ("dte", "bearing_force_x_p", "bearing_force_y_p"),
        (
            Mistake(
                "the compliance of Hertz is added to a stiffness that contains it already",
                model=m.other_stiffness(t.hertz_in_series),
            ),
            Mistake(
                "the bearing forces are in pounds under a heading in newtons",
                curves=m.scaled(1.0 / t.NEWTONS_PER_POUND, *t.FORCES),
            ),
        ),
    ),
    Wrong(
        "one_harmonic_and_discs_to_tip",
        at("rack_22", 4800.0, 190.0),
        ("dte", "x_p", "mesh_force"),
        (
            Mistake(
                "the stiffness of the mesh is its mean and its first harmonic",
                model=m.whole_mesh(m.first_harmonic),
            ),
            Mistake(
                "mass and inertia of both gears are those of discs up to the tip circle",
                drawing=t.discs_to_tip,
            ),
        ),
    ),
    Wrong(
        "centre_distance_and_not_settled",
        at("light_damping", 4700.0, 110.0),
        ("dte", "x_p", "x_g"),
        (
            Mistake(
                "the centre distance is 90 mm, without backlash, instead of 90.22 mm",
                drawing=t.without_centre_distance,
            ),
            Mistake(
                "the record begins 4 mesh cycles after the start from rest: it is not settled",
                numerics=m.with_numerics(settle=4),
            ),
        ),
        unilateral=True,
        settings=Settings(method="rk4", samples=512, substeps=4, cycles=7),
    ),
    Wrong(
        "end_ratio_and_cold_oil",
        at("negative_shifts", 1900.0, 72.0),
        ("dte", "y_p", "y_g", "bearing_force_x_p"),
        (
            Mistake(
                "the end ratio of the parabola, 0.68, is taken as its drop: the ends have 0.32",
                drawing=t.entered(mesh__stiffness__end_ratio=lambda ratio: 1.0 - ratio),
            ),
            Mistake(
                "the viscosity is that at 40 degrees Celsius, 75 mPa s; the oil is hot and has 14 mPa s",
                drawing=t.entered(lubricant__viscosity=75.0),
            ),
        ),
    ),
    Wrong(
        "mesh_damping_each_and_rotations_written",
        at("fine_teeth", 2600.0, 62.0),
        ("dte", "x_p", "x_g", "mesh_force"),
        (
            Mistake(
                "every pair in contact has the constant damping of the mean stiffness of the whole mesh",
                model=t.damped_by(t.damping_of_mesh_each),
            ),
            Mistake(
                "the transmission error is that of the rotations, without the displacements of the gears",
                curves=t.rotations_alone,
            ),
        ),
        unilateral=True,
    ),
    Wrong(
        "bronze_as_steel_and_no_reversal",
        at("bronze_wheel", 2250.0, 120.0),
        ("dte", "y_p", "bearing_force_y_g"),
        (
            Mistake(
                "Young's modulus of the gear is 206 GPa of steel; the gear is bronze of 115 GPa",
                drawing=t.entered(gear__youngs_modulus=206.0),
            ),
            Mistake(
                "the coefficient of friction has one sign: friction does not reverse at the pitch point",
                model=m.other_friction(t.never_reversed),
            ),
        ),
    ),
    Wrong(
        "solid_gear_and_time_axis",
        at("iron_gear", 3150.0, 320.0),
        ("x_g", "bearing_force_x_g", "dte"),
        (
            Mistake(
                "the gear is a disc without its bore of 180 mm",
                drawing=t.entered(gear__bore=0.0),
            ),
            Mistake(
                "the time axis was made with 50 kHz, the sampling rate was 51.2 kHz",
                curves=m.stretched_time(RATES),
            ),
        ),
    ),
    Wrong(
        "ramps_and_recorder_filter",
        at("long_teeth", 3050.0, 88.0),
        ("dte", *t.FORCES),
        (
            Mistake(
                "the stiffness of a pair rises and falls over 12 % of the path, to spare the solver a step",
                model=m.other_stiffness(t.ramped(0.12)),
            ),
            Mistake(
                "the bearing forces went through a low-pass filter at twice the mesh frequency",
                curves=t.recorder_filter(2.0),
            ),
        ),
        settings=Settings(method="newmark", samples=512, substeps=4, cycles=8, phase=0.4),
    ),
    Wrong(
        "rack_angle_and_springs_written",
        at("speed_up_51_19", 3800.0, 130.0),
        ("dte", "x_p", *t.FORCES),
        (
            Mistake(
                "the line of action has the rack's pressure angle, 20 degrees, though the shifts alter it",
                line=t.line_at_rack_angle(20.0),
            ),
            Mistake(
                "the bearing forces are those of the springs; the dampers are left out",
                curves=t.springs_alone,
            ),
        ),
    ),
    Wrong(
        "static_error_twice_and_directions_exchanged",
        at("fine_teeth", 1650.0, 56.0),
        ("dte", "bearing_force_x_p", "bearing_force_y_p", "x_g"),
        (
            Mistake(
                "the static transmission error excites the mesh beside the varying stiffness that makes it",
                model=t.static_error_as_excitation,
            ),
            Mistake(
                "the bearings along and off the line of action are exchanged, on both gears",
                model=m.exchanged_bearings(m.ALONG_AND_ACROSS),
            ),
        ),
    ),
]
