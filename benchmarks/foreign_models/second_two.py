"""Records of the second, held-back set with two mistakes that have nothing to do with each other."""

from __future__ import annotations

from benchmarks.foreign_models import mistakes as m
from benchmarks.foreign_models import second_mistakes as s
from benchmarks.foreign_models.mistakes import Mistake, Wrong
from benchmarks.foreign_models.recipe import Settings
from benchmarks.foreign_models.second_pairs import second_pair
from benchmarks.foreign_models.sound import changed_pair

FORCES = ("bearing_force_x_p", "bearing_force_y_p", "bearing_force_x_g", "bearing_force_y_g")

SECOND_TWO: list[Wrong] = [
    Wrong(
        "soft_teeth_and_sign_of_one_force",
        second_pair("hcr_rough", 3500.0, 140.0),
        (*FORCES, "dte"),
        (
            Mistake("the stiffness of the tooth pairs is 25 % too small", model=m.scaled_stiffness(0.75)),
            Mistake(
                "the force off the line of action on the gear has the wrong sign",
                curves=m.scaled(-1.0, "bearing_force_y_g"),
            ),
        ),
    ),
    Wrong(
        "much_damping_and_micrometres",
        changed_pair("kb_lost", 3300.0, 190.0),
        ("dte", "x_p", "x_g", "mesh_force"),
        (
            Mistake("the damping of the mesh is 2.5 times too large", drawing=m.mesh_damping(2.5)),
            Mistake("the transmission error is in micrometres", curves=m.scaled(1e6, "dte")),
        ),
        unilateral=True,
    ),
    Wrong(
        "no_friction_and_stiff_bearings",
        second_pair("fzg_coulomb", 2500.0, 240.0),
        ("dte", "x_p", "y_p", *FORCES),
        (
            Mistake("friction is left out", model=s.without_friction),
            Mistake(
                "all bearings are 10 times too stiff",
                model=m.bearing_stiffness(10.0, "xp", "yp", "xg", "yg"),
            ),
        ),
    ),
    Wrong(
        "torque_of_the_gear_and_millimetres",
        second_pair("rack_xu", 2050.0, 150.0),
        ("x_p", "y_p", "x_g", "dte", "bearing_force_x_g"),
        (
            Mistake(
                "the torque at the gear acts on the pinion: loads 65 % too large",
                drawing=m.scaled_torque(38 / 23),
            ),
            Mistake(
                "displacements of the gears are in millimetres", curves=m.scaled(1e3, "x_p", "y_p", "x_g")
            ),
        ),
    ),
    Wrong(
        "flywheel_moment_and_degrees",
        second_pair("nasa_torsional", 4500.0, 75.0),
        ("theta_p", "theta_g", "dte"),
        (
            Mistake("G D^2 is used for the inertia: 4 times too large", model=m.inertia(4.0, 4.0)),
            Mistake("the angles are in degrees", curves=m.scaled(57.29578, "theta_p", "theta_g")),
        ),
        torsional=True,
    ),
    Wrong(
        "decrement_and_aluminium",
        second_pair("art_parabola", 4800.0, 200.0),
        ("dte", "x_p", "x_g", "bearing_force_y_p"),
        (
            Mistake(
                "the damping ratio is taken for a logarithmic decrement: damping 6.3 times too small",
                drawing=m.mesh_damping(0.159),
            ),
            Mistake("both gears have the density of aluminium, 2700 kg/m^3", drawing=s.density(2700.0)),
        ),
    ),
    Wrong(
        "one_tooth_more_and_friction_twice",
        second_pair("elements_smooth", 1850.0, 360.0),
        ("dte", "y_p", "y_g", "bearing_force_x_p", "bearing_force_y_p"),
        (
            Mistake("the gear has 31 teeth instead of 30", drawing=s.teeth_of_gear(31)),
            Mistake("the coefficient of friction is twice too large", model=m.scaled_friction(2.0)),
        ),
    ),
    Wrong(
        "textbook_error_and_columns",
        second_pair("springs_parabola", 2700.0, 200.0),
        ("x_p", "y_p", "x_g", "y_g", "dte"),
        (
            Mistake(
                "an error of 2 um times the cosine of the mesh frequency, which the file does not have",
                model=s.harmonic_error(2e-6),
            ),
            Mistake(
                "the columns of pinion and gear off the line of action are exchanged",
                curves=m.renamed({"y_p": "y_g", "y_g": "y_p"}),
            ),
        ),
    ),
    Wrong(
        "equal_shares_and_stiff_teeth",
        second_pair("rack_xu", 3200.0, 220.0),
        ("normal_load", "friction_force", "dte"),
        (
            Mistake("the stiffness of the tooth pairs is 40 % too large", model=m.scaled_stiffness(1.4)),
            Mistake(
                "the load of a pair is the mesh force over the number of pairs in contact",
                curves=s.equal_shares,
            ),
        ),
    ),
    Wrong(
        "speed_of_the_gear_and_rz",
        second_pair("fzg_iso", 3300.0, 220.0),
        ("dte", "x_p", "bearing_force_y_p", "bearing_force_y_g"),
        (
            Mistake("the speed in the file is taken for that of the gear", drawing=m.scaled_speed(24 / 16)),
            Mistake(
                "Rz is taken for Ra in the friction law: roughness 6 times too large",
                drawing=s.roughness(6.0),
            ),
        ),
    ),
    Wrong(
        "no_bearings_and_slope",
        second_pair("larger_coulomb", 2650.0, 60.0),
        ("dte", "theta_p", "theta_g", "mesh_force"),
        (
            Mistake("the bearings are left out: rotations alone", torsional=True),
            Mistake(
                "the flanks have a slope error of 3 um along the profile, which the file does not have",
                model=s.slope_error(3e-6),
            ),
        ),
    ),
    Wrong(
        "clipped_and_soft_bearings_of_gear",
        second_pair("nasa_smooth", 3650.0, 100.0),
        ("dte", "x_p", "x_g", "bearing_force_x_p", "bearing_force_x_g"),
        (
            Mistake(
                "the bearing forces are cut off at 55 % of their peaks: the recorder was out of its range",
                curves=s.each_channel(s.clipped(0.55), "bearing_force_x_p", "bearing_force_x_g"),
            ),
            Mistake(
                "the bearings of the gear are 2.5 times too soft", model=m.bearing_stiffness(0.4, "xg", "yg")
            ),
        ),
    ),
    Wrong(
        "two_harmonics_and_stiff_teeth",
        second_pair("nasa_smooth", 1250.0, 130.0),
        ("dte", "x_p", "theta_p", "mesh_force"),
        (
            Mistake(
                "harmonic balance with 2 orders of the mesh frequency",
                numerics=m.with_numerics(method="harmonic_balance", orders=2, samples=512),
            ),
            Mistake("the stiffness of the tooth pairs is 25 % too large", model=m.scaled_stiffness(1.25)),
        ),
        settings=Settings(method="rk4", samples=512, substeps=4, cycles=6, phase=0.6),
    ),
    Wrong(
        "window_and_moment_on_gear",
        second_pair("low_benedict", 2150.0, 480.0),
        ("dte", "x_p", "theta_g", "bearing_force_x_p"),
        (
            Mistake(
                "the window of Hann of the spectrum is left on the record",
                curves=s.each_channel(s.hann_window),
            ),
            Mistake(
                "the moment of friction on the gear has the wrong sign", model=m.sign(moment_sign_g=-1.0)
            ),
        ),
    ),
    Wrong(
        "late_channel_and_heavy_shafts",
        second_pair("fzg_iso", 2300.0, 150.0),
        ("dte", "x_p", "x_g", "bearing_force_y_p"),
        (
            Mistake(
                "the transmission error comes 0.12 mesh cycles late: its filter delays it",
                curves=s.delayed(0.12, "dte"),
            ),
            Mistake(
                "masses of the shafts are in the gears: 2 times the mass, with the right inertia",
                model=s.moved_masses(2.0),
            ),
        ),
    ),
    Wrong(
        "thumb_and_cold_oil",
        second_pair("hcr_rough", 2250.0, 170.0),
        ("dte", "x_p", "y_p", "bearing_force_x_g", "bearing_force_y_g"),
        (
            Mistake(
                "the stiffness is that of the rule of thumb, 14 N/(mm um)",
                model=s.rule_of_thumb,
            ),
            Mistake("the oil is cold: 45 instead of 14 mPa s", drawing=s.viscosity(0.045)),
        ),
    ),
    Wrong(
        "old_rack_and_milliseconds",
        second_pair("kb_bearings", 1250.0, 240.0),
        ("dte", "x_p", "bearing_force_x_p", "bearing_force_y_p"),
        (
            Mistake("the pressure angle is 14.5 degrees instead of 20", drawing=m.other_pressure_angle(14.5)),
            Mistake("the time is in milliseconds", curves=m.stretched_time(1e3)),
        ),
    ),
    Wrong(
        "magnitudes_and_smooth_stiffness",
        second_pair("larger_coulomb", 4300.0, 50.0),
        (*FORCES, "dte"),
        (
            Mistake("bearing forces are written as magnitudes", curves=s.each_channel(s.magnitude, *FORCES)),
            Mistake(
                "the mesh stiffness is smoothed over half a cycle",
                model=m.whole_mesh(s.averaged_stiffness(0.5)),
            ),
        ),
    ),
    Wrong(
        "springs_alone_and_safety_factor",
        second_pair("springs_parabola", 5300.0, 150.0),
        (*FORCES, "dte", "x_p"),
        (
            Mistake("bearing forces are those of the springs, without dampers", curves=s.springs_alone),
            Mistake("the torque has an application factor of 1.5 in it", drawing=m.scaled_torque(1.5)),
        ),
    ),
    Wrong(
        "relief_of_pinion_and_one_bearing_of_two",
        second_pair("thirds_coulomb", 2500.0, 1000.0),
        ("dte", "x_p", *FORCES),
        (
            Mistake(
                "the pinion's tip is relieved by 12 um, which the file does not have",
                model=s.relief_of_pinion(12e-6, 0.3),
            ),
            Mistake(
                "the forces are those of one of the two bearings of a shaft: a half",
                curves=m.scaled(0.5, *FORCES),
            ),
        ),
    ),
]
