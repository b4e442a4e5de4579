"""The second, held-back set: records with one mistake, and with two, on other pairs and operating points.

It was written without sight of the explanations that the comparison knows, and of judgements of the first
set.
"""

from __future__ import annotations

from benchmarks.foreign_models import mistakes as m
from benchmarks.foreign_models import second_mistakes as s
from benchmarks.foreign_models.cases import Case, case_of
from benchmarks.foreign_models.mistakes import Mistake, Wrong
from benchmarks.foreign_models.recipe import Settings
from benchmarks.foreign_models.second_pairs import second_pair
from benchmarks.foreign_models.second_two import SECOND_TWO
from benchmarks.foreign_models.sound import changed_pair

FORCES = ("bearing_force_x_p", "bearing_force_y_p", "bearing_force_x_g", "bearing_force_y_g")
TURNS = ("dte", "theta_p", "theta_g")

SECOND_WRONG: list[Wrong] = [
    Wrong(
        "a_third_of_stiffness_lost",
        second_pair("kb_bearings", 1400.0, 200.0),
        ("dte", "x_p", "x_g", "mesh_force"),
        (Mistake("the stiffness of the tooth pairs is 35 % too small", model=m.scaled_stiffness(0.65)),),
    ),
    Wrong(
        "plane_strain_for_stiffness",
        second_pair("art_parabola", 2050.0, 180.0),
        ("dte", "x_p", "bearing_force_x_p"),
        (
            Mistake(
                "E/(1 - nu^2) is used in the place of E: stiffness of the teeth 10 % too large",
                model=m.scaled_stiffness(1.0 / (1.0 - 0.3**2)),
            ),
        ),
    ),
    Wrong(
        "rule_of_thumb_stiffness",
        second_pair("hcr_rough", 2750.0, 150.0),
        ("x_p", "x_g", "dte", "mesh_force"),
        (
            Mistake(
                "the stiffness is that of the rule of thumb, 14 N/(mm um), without the factor of the rack",
                model=s.rule_of_thumb,
            ),
        ),
    ),
    Wrong(
        "single_and_double_exchanged",
        second_pair("fzg_iso", 1900.0, 250.0),
        ("dte", "bearing_force_x_p", "bearing_force_x_g", "x_g"),
        (
            Mistake(
                "the mesh is soft in double contact and stiff in single contact",
                model=m.whole_mesh(s.exchanged_levels),
            ),
        ),
    ),
    Wrong(
        "half_the_variation",
        second_pair("nasa_torsional", 2850.0, 90.0),
        TURNS,
        (
            Mistake(
                "the variation of the mesh stiffness about its mean is half of what it should be",
                model=m.whole_mesh(s.scaled_variation(0.5)),
            ),
        ),
        torsional=True,
    ),
    Wrong(
        "soft_entry_of_teeth",
        second_pair("larger_coulomb", 2900.0, 48.0),
        ("dte", "x_p", "bearing_force_x_g", "theta_p"),
        (
            Mistake(
                "the mesh stiffness is smoothed over 0.35 of the cycle so that the integrator runs",
                model=m.whole_mesh(s.averaged_stiffness(0.35)),
            ),
        ),
    ),
    Wrong(
        "three_times_the_damping",
        changed_pair("larger_drives", 15200.0, 60.0),
        ("dte", "x_p", "x_g", "mesh_force"),
        (Mistake("the damping of the mesh is 3 times too large", drawing=m.mesh_damping(3.0)),),
        unilateral=True,
    ),
    Wrong(
        "logarithmic_decrement",
        second_pair("elements_smooth", 3050.0, 390.0),
        ("dte", "bearing_force_x_p", "bearing_force_y_p"),
        (
            Mistake(
                "the damping ratio is taken for a logarithmic decrement: damping 6.3 times too small",
                drawing=m.mesh_damping(0.159),
            ),
        ),
    ),
    Wrong(
        "damper_by_mesh_frequency",
        second_pair("nasa_smooth", 2150.0, 110.0),
        ("dte", "x_p", "y_p", "bearing_force_x_g"),
        (
            Mistake(
                "the mesh damper is 2 zeta k / omega with the mesh frequency, not the natural frequency",
                model=s.damper_of_mesh_frequency,
            ),
        ),
    ),
    Wrong(
        "bearings_ten_times",
        second_pair("art_parabola", 2950.0, 220.0),
        ("dte", "x_p", "y_p", "bearing_force_x_p", "bearing_force_y_p"),
        (
            Mistake(
                "all bearings are 10 times too stiff",
                model=m.bearing_stiffness(10.0, "xp", "yp", "xg", "yg"),
            ),
        ),
    ),
    Wrong(
        "gear_bearings_of_catalogue",
        second_pair("low_benedict", 1250.0, 520.0),
        ("x_p", "x_g", "y_g", "dte"),
        (
            Mistake(
                "the bearings of the gear are 5 times too stiff; those of the pinion are right",
                model=m.bearing_stiffness(5.0, "xg", "yg"),
            ),
        ),
    ),
    Wrong(
        "bearing_dampers_ten_times",
        second_pair("kb_bearings", 3900.0, 230.0),
        (*FORCES, "x_p"),
        (Mistake("the damping of the bearings is 10 times too large", model=m.bearing_damping(10.0)),),
    ),
    Wrong(
        "two_degrees_of_freedom",
        second_pair("springs_parabola", 2200.0, 170.0),
        (*TURNS, "mesh_force"),
        (Mistake("the bearings are left out: rotations alone, the shafts do not move", torsional=True),),
    ),
    Wrong(
        "shafts_move_with_gears",
        second_pair("fzg_coulomb", 3400.0, 210.0),
        ("dte", "x_p", "x_g", "y_p", "y_g"),
        (
            Mistake(
                "masses of the shafts are in the gears: 2.5 times the mass, with the right inertia",
                model=s.moved_masses(2.5),
            ),
        ),
    ),
    Wrong(
        "aluminium_gears",
        second_pair("rack_xu", 3700.0, 200.0),
        ("theta_p", "theta_g", "dte", "bearing_force_x_g"),
        (Mistake("both gears have the density of aluminium, 2700 kg/m^3", drawing=s.density(2700.0)),),
    ),
    Wrong(
        "flywheel_moment",
        second_pair("art_torsional", 2600.0, 200.0),
        ("theta_p", "theta_g", "dte", "mesh_force"),
        (Mistake("G D^2 is used for the inertia: 4 times too large", model=m.inertia(4.0, 4.0)),),
        torsional=True,
    ),
    Wrong(
        "masses_exchanged",
        second_pair("low_benedict", 1750.0, 560.0),
        ("dte", "x_p", "x_g", "theta_p"),
        (
            Mistake(
                "masses and inertias of pinion and gear are exchanged",
                model=s.exchanged_masses,
            ),
        ),
    ),
    Wrong(
        "foot_pounds",
        second_pair("larger_coulomb", 2300.0, 52.0),
        ("dte", "x_p", "y_p", "bearing_force_x_p"),
        (
            Mistake(
                "the torque in foot-pounds is used as N m: loads 26 % too small",
                drawing=m.scaled_torque(1.0 / 1.3558),
            ),
        ),
    ),
    Wrong(
        "gears_without_backlash",
        second_pair("nasa_torsional", 6500.0, 75.0),
        ("dte", "theta_p", "theta_g", "mesh_force"),
        (Mistake("the teeth pull where they should lose contact", unilateral=False),),
        unilateral=True,
        torsional=True,
    ),
    Wrong(
        "slip_of_the_motor",
        second_pair("springs_parabola", 3480.0, 190.0),
        ("x_p", "x_g", "dte", "bearing_force_y_p"),
        (
            Mistake(
                "the model ran at a speed 12 % lower than the file has",
                drawing=m.scaled_speed(0.88),
            ),
        ),
    ),
    Wrong(
        "no_friction",
        second_pair("art_parabola", 4300.0, 160.0),
        (*FORCES, "dte"),
        (Mistake("friction is left out", model=s.without_friction),),
    ),
    Wrong(
        "friction_twice",
        second_pair("elements_smooth", 1450.0, 420.0),
        ("dte", "y_p", "y_g", "bearing_force_y_p"),
        (Mistake("the coefficient of friction is twice too large", model=m.scaled_friction(2.0)),),
    ),
    Wrong(
        "book_value_of_friction",
        second_pair("rack_xu", 1550.0, 230.0),
        ("bearing_force_y_p", "bearing_force_y_g", "bearing_force_x_p", "friction_force"),
        (
            Mistake(
                "the coefficient of friction is 0.05 everywhere instead of Xu and Kahraman's law",
                model=s.coefficient_without_law(0.05),
            ),
        ),
    ),
    Wrong(
        "cold_oil",
        second_pair("hcr_rough", 4250.0, 120.0),
        ("y_p", "y_g", "bearing_force_y_p", "dte"),
        (
            Mistake(
                "the oil has its viscosity at 40 degrees Celsius: 40 instead of 14 mPa s",
                drawing=s.viscosity(0.040),
            ),
        ),
    ),
    Wrong(
        "moment_of_friction_on_gear",
        second_pair("nasa_smooth", 3300.0, 95.0),
        ("dte", "theta_p", "theta_g", "x_p", "y_p"),
        (Mistake("the moment of friction on the gear has the wrong sign", model=m.sign(moment_sign_g=-1.0)),),
    ),
    Wrong(
        "pitch_point_of_the_rack",
        second_pair("fzg_coulomb", 1650.0, 260.0),
        ("dte", "y_p", "bearing_force_y_p", "bearing_force_y_g"),
        (
            Mistake(
                "friction reverses at the pitch point of the rack's pressure angle, not the operating one",
                line=s.pitch_point_of_rack(20.0),
            ),
        ),
    ),
    Wrong(
        "old_standard_rack",
        second_pair("nasa_smooth", 1700.0, 120.0),
        ("dte", "x_p", "y_p", "x_g", "y_g"),
        (
            Mistake(
                "the pressure angle is 14.5 degrees instead of 20",
                drawing=m.other_pressure_angle(14.5),
            ),
        ),
    ),
    Wrong(
        "standard_centre_distance",
        second_pair("fzg_iso", 2700.0, 180.0),
        ("dte", "bearing_force_x_p", "bearing_force_y_p", "x_g"),
        (
            Mistake(
                "the centre distance is m (z1 + z2)/2 = 90 mm instead of 91.5 mm; the tips are right",
                drawing=s.centre_distance(0.090),
            ),
        ),
    ),
    Wrong(
        "shifts_of_other_sign",
        second_pair("larger_coulomb", 3650.0, 45.0),
        ("dte", "x_p", "x_g", "y_p"),
        (
            Mistake(
                "both profile shifts have the wrong sign; tips and centre distance follow from them",
                drawing=s.reversed_shifts,
            ),
        ),
    ),
    Wrong(
        "one_tooth_lost",
        second_pair("art_parabola", 3500.0, 240.0),
        ("dte", "x_p", "bearing_force_x_g", "theta_g"),
        (Mistake("the gear has 30 teeth instead of 31", drawing=s.teeth_of_gear(30)),),
    ),
    Wrong(
        "error_of_the_textbook",
        second_pair("thirds_coulomb", 2100.0, 900.0),
        ("dte", "x_p", "mesh_force"),
        (
            Mistake(
                "an error of 4 um times the cosine of the mesh frequency, which the file does not have",
                model=s.harmonic_error(4e-6),
            ),
        ),
    ),
    Wrong(
        "driven_minus_driving",
        second_pair("rack_xu", 2600.0, 260.0),
        ("dte", "x_p", "x_g", "y_p"),
        (
            Mistake(
                "the transmission error is written with the other sign, gear minus pinion",
                curves=m.scaled(-1.0, "dte"),
            ),
        ),
    ),
    Wrong(
        "columns_of_the_gear_exchanged",
        second_pair("springs_parabola", 4300.0, 160.0),
        ("x_p", "y_p", "x_g", "y_g", "dte"),
        (
            Mistake(
                "the columns of x and y of the gear are exchanged",
                curves=m.renamed({"x_g": "y_g", "y_g": "x_g"}),
            ),
        ),
    ),
    Wrong(
        "millimetres_of_the_pinion",
        second_pair("low_benedict", 700.0, 600.0),
        ("x_p", "y_p", "dte", "bearing_force_x_p"),
        (Mistake("x and y of the pinion are in millimetres", curves=m.scaled(1e3, "x_p", "y_p")),),
    ),
    Wrong(
        "horizontal_and_vertical",
        second_pair("kb_bearings", 1500.0, 180.0),
        (*FORCES, "dte"),
        (
            Mistake(
                "the bearing forces are horizontal and vertical, 20 degrees from the line of action",
                curves=s.turned_axes(20.0),
            ),
        ),
    ),
    Wrong(
        "equal_shares_of_load",
        second_pair("elements_smooth", 2250.0, 450.0),
        ("normal_load", "mesh_force", "dte"),
        (
            Mistake(
                "the load of a pair is the mesh force over the number of pairs in contact",
                curves=s.equal_shares,
            ),
        ),
    ),
    Wrong(
        "average_over_the_window",
        second_pair("thirds_coulomb", 1350.0, 1250.0),
        ("dte", "x_p", "bearing_force_x_p", "bearing_force_y_p"),
        (
            Mistake(
                "a moving average over 0.4 mesh cycles went over all curves",
                curves=s.each_channel(s.moving_average(0.4)),
            ),
        ),
    ),
    Wrong(
        "six_decimals",
        second_pair("nasa_smooth", 2700.0, 60.0),
        ("dte", "x_p", "x_g", "y_p"),
        (
            Mistake(
                "displacements are written in metres with 6 decimals: steps of 1 um",
                curves=s.each_channel(s.rounded(1e-6), "dte", "x_p", "x_g", "y_p"),
            ),
        ),
    ),
    Wrong(
        "forward_euler",
        changed_pair("kb_torsional", 1100.0, 120.0),
        ("dte", "theta_p", "mesh_force"),
        (
            Mistake(
                "the explicit Euler method takes some of the damping out of the motion",
                numerics=m.with_numerics(method="euler", samples=256, substeps=1, settle=80),
            ),
        ),
        torsional=True,
    ),
    Wrong(
        "few_harmonics",
        second_pair("kb_bearings", 950.0, 210.0),
        ("dte", "x_p", "x_g", "theta_g"),
        (
            Mistake(
                "harmonic balance with 3 orders of the mesh frequency",
                numerics=m.with_numerics(method="harmonic_balance", orders=3, samples=512),
            ),
        ),
        settings=Settings(method="rk4", samples=512, substeps=4, cycles=5, phase=0.3, origin=0.02),
    ),
]


def held_back(kind: str | None = None) -> list[Case]:
    """Return the cases "wrong" or "two" of the second set, or both."""
    every = [
        *(case_of(one, "wrong") for one in SECOND_WRONG),
        *(case_of(one, "two") for one in SECOND_TWO),
    ]
    cases = [case._replace(name=f"second_{case.name}") for case in every]
    return [case for case in cases if kind in (None, case.kind)]
