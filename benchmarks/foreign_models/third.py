"""The third set: 40 records with one mistake each. The list was written before any helper was chosen.

Inputs
 1. The module of a pair of diametral pitch 8 is entered as 3 mm.
 2. The pressure angle stays at the default of 20 degrees; the rack has 14.5 degrees.
 3. The speed of the gear shaft is entered as the speed of the pinion.
 4. The torque of the gear shaft is entered as the torque of the pinion.
 5. Young's modulus of steel is used for the gear of cast iron.
 6. The addendum coefficient stays at 1; the rack has long teeth.
 7. The viscosity of the cold oil, 40 degrees Celsius, is used.
Geometry
 8. The profile shift of the gear has the wrong sign.
 9. The tip circle of the pinion bounds the approach and that of the gear the recess.
10. The circular pitch is used in place of the base pitch: the overlap of the pairs is too short.
11. The pressure angle of the rack is used for the line of action of shifted teeth.
12. The moment arms of friction count from A, where contact starts.
Stiffness
13. The mean mesh stiffness c_gamma of ISO 6336 is used as the stiffness of each pair.
14. The end ratio of the parabola is used as its drop.
15. The parabola has its peak at the pitch point.
16. The mesh stiffness is cut after its first harmonic.
17. The compliance of Hertz is added to a stiffness that contains it.
18. Stiffness ramps up and down over a part of the path, as a correction against jumps.
19. The face width is that of the wider gear.
Damping
20. The effective mass of the damping is that of the two translating masses.
21. Damping in proportion to stiffness takes the natural frequency in Hz for rad/s.
22. The damping of bearings loses a factor of 1000 (N s/mm).
23. One constant mesh damping of the mean stiffness is given to every pair in contact.
Friction
24. The law of Benedict and Kelley has the natural logarithm.
25. The roughness is Rz, not Ra.
26. The friction moment on the gear is left out.
27. Friction reverses in the middle of the path, not at the pitch point.
Bodies
28. The flywheel effect GD2 is entered as the moment of inertia.
29. The inertia of the discs goes to the tip circle, and their mass too.
30. The bore of the gear is left out.
31. The inertia of the motor is lumped to the pinion.
Supports
32. The given stiffness is read as that of one of two bearings of a shaft: it is doubled.
33. Stiffness along and off the line of action are exchanged.
34. The bearings are left out; the file has soft ones.
35. The bearing of the gear is rigid; only the pinion moves. (First: x_g with the wrong sign in the
    approach. That motion diverges, and its owner would have seen it.)
Contact
36. The static transmission error is added as an error of the teeth to the stiffness that makes it.
37. Teeth pull at a speed at which contact is lost.
Integration and export
38. The implicit Euler method takes coarse steps.
39. The record begins a few cycles after the start from rest.
40. A low-pass filter of the recorder takes away the higher mesh orders of the bearing forces.
More for pairs of mistakes: dampers left out of bearing forces, the time axis of another sampling rate,
forces in pounds, transmission error without supports, a window left on, the factor 0.8 of ISO left out,
friction on both gears in the same direction, friction without reversal, bearings of pinion and gear
exchanged, and a centre distance rounded to the one without backlash.
"""

from __future__ import annotations

from benchmarks.foreign_models import mistakes as m
from benchmarks.foreign_models import third_mistakes as t
from benchmarks.foreign_models.cases import Case, case_of
from benchmarks.foreign_models.mistakes import Mistake, Wrong
from benchmarks.foreign_models.recipe import Settings
from benchmarks.foreign_models.third_pairs import at
from benchmarks.foreign_models.third_two import THIRD_TWO

INPUTS = [
    Wrong(
        "stock_module",
        at("pitch_8", 4100.0, 118.0),
        ("dte", "x_p", "x_g"),
        (
            Mistake(
                "the module is 3 mm, from the stock list, instead of 3.175 mm of diametral pitch 8",
                drawing=t.entered(basic_rack__module=3.0),
            ),
        ),
    ),
    Wrong(
        "default_pressure_angle",
        at("old_rack", 1700.0, 355.0),
        ("dte", "bearing_force_x_p", "bearing_force_x_g"),
        (
            Mistake(
                "the pressure angle is the default of 20 degrees; the rack has 14.5 degrees",
                drawing=t.entered(basic_rack__pressure_angle=20.0),
            ),
        ),
    ),
    Wrong(
        "speed_of_gear_shaft",
        at("speed_up_51_19", 1450.0, 160.0),
        ("theta_p", "theta_g", "dte"),
        (
            Mistake(
                "the speed of the pinion is the speed of the gear shaft",
                drawing=t.entered(operating__pinion_speed=t.times(51.0 / 19.0)),
            ),
        ),
    ),
    Wrong(
        "torque_of_gear_shaft",
        at("bronze_wheel", 3000.0, 60.0),
        ("dte", "mesh_force"),
        (
            Mistake(
                "the torque of the pinion is the torque of the gear shaft",
                drawing=t.entered(operating__pinion_torque=t.times(70.0 / 23.0)),
            ),
        ),
    ),
    Wrong(
        "iron_as_steel",
        at("iron_gear", 2050.0, 340.0),
        ("dte", "bearing_force_x_g", "bearing_force_y_g"),
        (
            Mistake(
                "Young's modulus of the gear is 206 GPa of steel; the gear is cast iron of 112 GPa",
                drawing=t.entered(gear__youngs_modulus=206.0),
            ),
        ),
    ),
    Wrong(
        "default_addendum",
        at("long_teeth", 2600.0, 94.0),
        ("dte", "x_p", "bearing_force_y_p"),
        (
            Mistake(
                "the addendum coefficient is the default of 1; the rack has 1.3",
                drawing=t.entered(basic_rack__addendum_coefficient=1.0),
            ),
        ),
    ),
    Wrong(
        "cold_oil",
        at("old_rack", 2350.0, 290.0),
        ("dte", "y_p", "y_g", "bearing_force_y_p"),
        (
            Mistake(
                "the viscosity is that at 40 degrees Celsius, 95 mPa s; the oil is hot and has 18 mPa s",
                drawing=t.entered(lubricant__viscosity=95.0),
            ),
        ),
    ),
]

GEOMETRY = [
    Wrong(
        "sign_of_shift",
        at("negative_shifts", 3050.0, 69.0),
        ("dte", "x_g", "y_g"),
        (
            Mistake(
                "the profile shift of the gear is +0.22 instead of -0.22",
                drawing=t.entered(gear__profile_shift=0.22),
            ),
        ),
    ),
    Wrong(
        "tips_exchanged",
        at("short_path", 3300.0, 350.0),
        ("dte", "y_p", "y_g", "bearing_force_y_g"),
        (
            Mistake(
                "contact starts at the tip circle of the pinion and ends at that of the gear: approach and "
                "recess are exchanged",
                line=t.exchanged_tips,
            ),
        ),
    ),
    Wrong(
        "circular_pitch",
        at("speed_up_44_27", 2100.0, 215.0),
        ("mesh_force", "dte"),
        (
            Mistake(
                "the contact ratio is the path over the circular pitch, not the base pitch: pairs end early",
                line=t.overlap_by_circular_pitch(25.0),
            ),
        ),
    ),
    Wrong(
        "rack_angle_on_line",
        at("negative_shifts", 1400.0, 60.0),
        ("dte", "bearing_force_x_p", "bearing_force_y_p"),
        (
            Mistake(
                "the line of action has the rack's pressure angle, 20 degrees, though the shifts alter it",
                line=t.line_at_rack_angle(20.0),
            ),
        ),
    ),
    Wrong(
        "arms_from_start",
        at("speed_up_51_19", 5400.0, 170.0),
        ("dte", "theta_p", "theta_g"),
        (
            Mistake(
                "the moment arms of friction count from the start of contact, not from the tangent point",
                model=t.arms_from_start,
            ),
        ),
    ),
]

STIFFNESS = [
    Wrong(
        "mesh_stiffness_each",
        at("pitch_8", 2900.0, 130.0),
        ("dte", "normal_load"),
        (
            Mistake(
                "the mean stiffness of the mesh, c_gamma of ISO 6336, is the stiffness of each pair",
                model=m.other_stiffness(t.mean_mesh_stiffness_each),
            ),
        ),
    ),
    Wrong(
        "end_ratio_as_drop",
        at("negative_shifts", 4300.0, 75.0),
        ("dte", "x_p", "bearing_force_x_g"),
        (
            Mistake(
                "the end ratio of the parabola, 0.68, is taken as its drop: the ends have 0.32",
                drawing=t.entered(mesh__stiffness__end_ratio=lambda ratio: 1.0 - ratio),
            ),
        ),
    ),
    Wrong(
        "peak_at_pitch_point",
        at("short_path", 1700.0, 340.0),
        ("dte", "bearing_force_x_p"),
        (
            Mistake(
                "the parabola of the stiffness has its peak at the pitch point, not in mid-path",
                model=m.other_stiffness(t.peak_at_pitch_point),
            ),
        ),
    ),
    Wrong(
        "one_harmonic",
        at("fine_teeth", 1250.0, 59.0),
        ("dte", "x_p", "x_g", "theta_g"),
        (
            Mistake(
                "the stiffness of the mesh is its mean and its first harmonic",
                model=m.whole_mesh(m.first_harmonic),
            ),
        ),
    ),
    Wrong(
        "hertz_twice",
        at("long_teeth", 3500.0, 80.0),
        ("dte", "bearing_force_x_g"),
        (
            Mistake(
                "the compliance of Hertz is added to a stiffness that contains it already",
                model=m.other_stiffness(t.hertz_in_series),
            ),
        ),
    ),
    Wrong(
        "ramps",
        at("rack_22", 3900.0, 168.0),
        ("dte", "mesh_force", "x_g"),
        (
            Mistake(
                "the stiffness of a pair rises and falls over 12 % of the path, to spare the solver a step",
                model=m.other_stiffness(t.ramped(0.12)),
            ),
        ),
    ),
    Wrong(
        "wider_width",
        at("speed_up_51_19", 3150.0, 140.0),
        ("dte", "bearing_force_x_p", "x_g"),
        (
            Mistake(
                "the face width of the mesh is that of the wider gear, 21 mm instead of 18 mm",
                model=m.scaled_stiffness(21.0 / 18.0),
            ),
        ),
    ),
]

DAMPING = [
    Wrong(
        "mass_of_damping",
        at("fine_teeth", 3700.0, 64.0),
        ("dte", "bearing_force_x_p"),
        (
            Mistake(
                "the mesh damping has the masses m_p m_g/(m_p + m_g) in place of the effective mass",
                model=t.damped_by(t.damping_of_translating_masses),
            ),
        ),
        unilateral=True,
    ),
    Wrong(
        "natural_frequency_in_hertz",
        at("fine_teeth", 2150.0, 66.0),
        ("dte", "mesh_force"),
        (
            Mistake(
                "damping in proportion to stiffness has the natural frequency in Hz for rad/s",
                model=t.damped_by(t.damping_by_hertz),
            ),
        ),
    ),
    Wrong(
        "bearing_damping_in_millimetres",
        at("bronze_wheel", 5400.0, 110.0),
        ("x_p", "y_p", "x_g", "y_g"),
        (
            Mistake(
                "the damping of the bearings is in N s/mm, 1000 times too small",
                model=m.bearing_damping(1e-3),
            ),
        ),
    ),
    Wrong(
        "mesh_damping_each",
        at("old_rack", 3350.0, 400.0),
        ("dte", "normal_load"),
        (
            Mistake(
                "every pair in contact has the constant damping of the mean stiffness of the whole mesh",
                model=t.damped_by(t.damping_of_mesh_each),
            ),
        ),
    ),
]

FRICTION = [
    Wrong(
        "natural_logarithm",
        at("rack_22", 2300.0, 180.0),
        ("dte", "bearing_force_y_p", "bearing_force_y_g"),
        (
            Mistake(
                "the logarithm in the law of Benedict and Kelley is the natural one",
                model=t.natural_logarithm(0.2),
            ),
        ),
    ),
    Wrong(
        "peak_to_valley_roughness",
        at("iron_gear", 1300.0, 420.0),
        ("dte", "x_p", "y_p", "y_g"),
        (
            Mistake(
                "the roughness is Rz, five times Ra",
                drawing=t.entered(pinion__roughness=t.times(5.0), gear__roughness=t.times(5.0)),
            ),
        ),
    ),
    Wrong(
        "no_friction_moment_on_gear",
        at("speed_up_51_19", 4600.0, 175.0),
        ("dte", "theta_g", "theta_p"),
        (
            Mistake(
                "friction has a moment on the pinion only; the moment on the gear is left out",
                model=m.sign(moment_sign_g=0.0),
            ),
        ),
    ),
    Wrong(
        "reversal_in_middle",
        at("short_path", 5200.0, 300.0),
        ("dte", "bearing_force_y_p", "bearing_force_y_g"),
        (
            Mistake(
                "friction reverses in the middle of the path of contact, not at the pitch point",
                model=m.other_friction(t.reversed_in_middle),
            ),
        ),
    ),
]

BODIES = [
    Wrong(
        "flywheel_effect",
        at("speed_up_44_27", 2900.0, 190.0),
        ("dte", "bearing_force_x_p", "bearing_force_x_g"),
        (
            Mistake(
                "the moment of inertia of both gears is GD2, the flywheel effect, four times as large",
                model=t.flywheel_effect,
            ),
        ),
    ),
    Wrong(
        "discs_to_tip",
        at("rack_22", 5600.0, 150.0),
        ("dte", "x_p", "bearing_force_x_g"),
        (
            Mistake(
                "mass and inertia of both gears are those of discs up to the tip circle",
                drawing=t.discs_to_tip,
            ),
        ),
    ),
    Wrong(
        "solid_gear",
        at("iron_gear", 2700.0, 380.0),
        ("x_g", "bearing_force_x_g", "y_g"),
        (
            Mistake(
                "the gear is a disc without its bore of 180 mm",
                drawing=t.entered(gear__bore=0.0),
            ),
        ),
    ),
    Wrong(
        "motor_on_pinion",
        at("fine_teeth", 3100.0, 50.0),
        ("dte", "theta_p", "theta_g"),
        (
            Mistake(
                "the inertia of the motor, 0.004 kg m2, is lumped to the pinion",
                model=t.motor_on_pinion(0.004),
            ),
        ),
        unilateral=True,
    ),
]

SUPPORTS = [
    Wrong(
        "doubled_bearings",
        at("negative_shifts", 2250.0, 80.0),
        ("dte", "x_p", "y_p", "x_g", "y_g"),
        (
            Mistake(
                "the stiffness of the supports is taken for that of one of two bearings, and doubled",
                drawing=t.stiffness_of_all_bearings(2.0),
            ),
        ),
    ),
    Wrong(
        "directions_exchanged",
        at("old_rack", 1150.0, 330.0),
        t.FORCES,
        (
            Mistake(
                "the bearings along and off the line of action are exchanged, on both gears",
                model=m.exchanged_bearings(m.ALONG_AND_ACROSS),
            ),
        ),
    ),
    Wrong(
        "rotations_only",
        at("short_path", 2450.0, 380.0),
        ("dte", "mesh_force"),
        (
            Mistake(
                "the model has the two rotations only, though the bearings are soft",
                torsional=True,
            ),
        ),
    ),
    Wrong(
        "rigid_gear_bearing",
        at("rack_22", 1500.0, 200.0),
        ("dte", "x_p", "bearing_force_x_g", "bearing_force_y_g"),
        (
            Mistake(
                "the bearing of the gear is rigid, 1e11 N/m in both directions; only the pinion moves",
                drawing=t.entered(bearings__gear__loa_stiffness=1e11, bearings__gear__oloa_stiffness=1e11),
            ),
        ),
    ),
]

CONTACT = [
    Wrong(
        "static_error_twice",
        at("speed_up_44_27", 1300.0, 230.0),
        ("dte", "bearing_force_x_g"),
        (
            Mistake(
                "the static transmission error excites the mesh beside the varying stiffness that makes it",
                model=t.static_error_as_excitation,
            ),
        ),
    ),
    Wrong(
        "teeth_pull",
        at("light_damping", 13000.0, 85.0),
        ("dte", "x_p", "x_g"),
        (
            Mistake(
                "teeth pull each other at a speed at which contact is lost",
                unilateral=False,
            ),
        ),
        unilateral=True,
    ),
]

EXPORT = [
    Wrong(
        "coarse_implicit_euler",
        at("light_damping", 3350.0, 100.0),
        ("dte", "bearing_force_x_p", "bearing_force_x_g"),
        (
            Mistake(
                "implicit Euler steps, 120 in a mesh cycle",
                numerics=m.with_numerics(method="backward_euler", samples=120, substeps=1),
            ),
        ),
        unilateral=True,
    ),
    Wrong(
        "not_settled",
        at("pitch_8", 5300.0, 95.0),
        ("dte", "x_p", "y_p", "bearing_force_x_g"),
        (
            Mistake(
                "the record begins 5 mesh cycles after the start from rest: it is not settled",
                numerics=m.with_numerics(method="rk4", samples=512, settle=5, cycles=6),
            ),
        ),
        settings=Settings(method="rk4", samples=512, substeps=4, cycles=6),
    ),
    Wrong(
        "recorder_filter",
        at("iron_gear", 900.0, 300.0),
        ("bearing_force_x_p", "bearing_force_y_p", "bearing_force_x_g", "bearing_force_y_g"),
        (
            Mistake(
                "the bearing forces went through a low-pass filter at 3 times the mesh frequency",
                curves=t.recorder_filter(3.0),
            ),
        ),
        settings=Settings(method="rk4", samples=400, substeps=5, cycles=9.5, phase=0.3, origin=0.2),
    ),
]

THIRD_WRONG: list[Wrong] = [
    *INPUTS,
    *GEOMETRY,
    *STIFFNESS,
    *DAMPING,
    *FRICTION,
    *BODIES,
    *SUPPORTS,
    *CONTACT,
    *EXPORT,
]


def judging(kind: str | None = None) -> list[Case]:
    """Return the cases "wrong" or "two" of the third set, or both."""
    every = [
        *(case_of(one, "wrong") for one in THIRD_WRONG),
        *(case_of(one, "two") for one in THIRD_TWO),
    ]
    cases = [case._replace(name=f"third_{case.name}") for case in every]
    return [case for case in cases if kind in (None, case.kind)]
