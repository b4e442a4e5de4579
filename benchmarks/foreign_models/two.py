"""Records with two mistakes that have nothing to do with each other; each alone moves the motion by 5 %."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from benchmarks.foreign_models import mistakes as m
from benchmarks.foreign_models.drawing import Drawing
from benchmarks.foreign_models.laws import Law
from benchmarks.foreign_models.mistakes import Mistake, Wrong
from benchmarks.foreign_models.model import Model
from benchmarks.foreign_models.sound import changed_pair
from benchmarks.foreign_models.wrong import (
    FORCES,
    FULL,
    PLACES,
    USUAL,
    friction_of_one_pair,
    hertzian,
    mean_mesh_stiffness_for_each,
    relief_of_tips,
    rotation_alone,
)


def short_tips(drawing: Drawing) -> Drawing:
    """Tips shortened by a fifth of the module."""
    step = 0.2 * drawing.module
    pinion, gear = drawing.pinion, drawing.gear
    return replace(
        drawing,
        pinion=replace(pinion, tip_radius=pinion.tip_radius - step),
        gear=replace(gear, tip_radius=gear.tip_radius - step),
    )


def reversed_in_the_middle(model: Model, law: Law) -> Law:
    """The curve of the coefficient of friction, moved so that its sign changes in the middle of the path."""
    line = model.line
    distance = line.pitch_point - 0.5 * (line.start + line.end)
    return lambda xi: law(xi + distance)


def natural_logarithm(model: Model, law: Law) -> Law:
    """Benedict and Kelley's law with ln in the place of log10, bounded as before."""
    top = model.drawing.friction.get("maximum", 0.2)
    return lambda xi: np.clip(math.log(10.0) * law(xi), -top, top)


TWO: list[Wrong] = [
    Wrong(
        "soft_teeth_and_forces_on_the_housing",
        changed_pair("nasa", 5850.0, 56.5),
        (*USUAL, "bearing_force_x_g", "y_p"),
        (
            Mistake("the stiffness of the tooth pairs is 20 % too small", model=m.scaled_stiffness(0.8)),
            Mistake("the bearing forces are those on the housing", curves=m.scaled(-1.0, *FORCES)),
        ),
    ),
    Wrong(
        "heavy_gears_and_friction_in_millimetres",
        changed_pair("fzg_xk", 3906.0, 135.0),
        FULL,
        (
            Mistake("inertias are m r^2 instead of m r^2/2", model=m.inertia(2.0, 2.0)),
            Mistake(
                "the radius in Xu-Kahraman's law is in millimetres: friction 15 times too small",
                model=m.scaled_friction(1000.0**-0.390958),
            ),
        ),
    ),
    Wrong(
        "natural_logarithm_and_torque_of_the_gear",
        changed_pair("fzg_bk", 1620.0, 302.0),
        ("dte", "y_p", "y_g", "x_p"),
        (
            Mistake(
                "Benedict and Kelley's law has ln instead of log10",
                model=m.other_friction(natural_logarithm),
            ),
            Mistake("the torque of the pinion acts on the gear", drawing=m.scaled_torque(16 / 24)),
        ),
    ),
    Wrong(
        "few_points_and_soft_bearing",
        changed_pair("hcr", 5760.0, 120.0),
        ("dte", "x_p", "x_g", "bearing_force_x_p"),
        (
            Mistake(
                "the stiffness has 6 points a mesh cycle and straight lines between them",
                model=m.whole_mesh(m.coarse_samples(6)),
            ),
            Mistake(
                "the pinion's bearing along the line of action has half its stiffness",
                model=m.bearing_stiffness(0.5, "xp"),
            ),
        ),
    ),
    Wrong(
        "friction_reversed_and_little_damping",
        changed_pair("art_energy", 3100.0, 250.0),
        FULL,
        (
            Mistake("friction has the wrong sign everywhere", model=m.scaled_friction(-1.0)),
            Mistake("the damping of the mesh is 10 times too small", drawing=m.mesh_damping(0.1)),
        ),
    ),
    Wrong(
        "no_shifts_and_rotation_alone",
        changed_pair("low_contact", 1980.0, 620.0),
        (*PLACES, "bearing_force_y_p"),
        (
            Mistake("profile shifts and the centre distance from them are ignored", drawing=m.without_shifts),
            Mistake("the transmission error is written without the bearings", curves=rotation_alone),
        ),
    ),
    Wrong(
        "bearings_of_the_other_gear_and_stiff_teeth",
        changed_pair("larger_drives", 3400.0, 55.0),
        (*FORCES, "dte", "x_p"),
        (
            Mistake(
                "bearings of pinion and gear are exchanged", model=m.exchanged_bearings(m.PINION_AND_GEAR)
            ),
            Mistake("the stiffness of the tooth pairs is 30 % too large", model=m.scaled_stiffness(1.3)),
        ),
    ),
    Wrong(
        "bearing_directions_and_friction_of_one_pair",
        changed_pair("rack_25", 4620.0, 240.0),
        (*FORCES, "dte"),
        (
            Mistake(
                "bearings along and off the line of action are exchanged",
                model=m.exchanged_bearings(m.ALONG_AND_ACROSS),
            ),
            Mistake(
                "in double contact only the leading pair has friction",
                model=m.other_friction(friction_of_one_pair),
            ),
        ),
    ),
    Wrong(
        "torque_of_the_gear_and_inertia_reduced_twice",
        changed_pair("elements", 5610.0, 480.0),
        ("theta_p", "theta_g", "dte", "x_g", "mesh_force"),
        (
            Mistake("the torque of the pinion acts on the gear", drawing=m.scaled_torque(20 / 30)),
            Mistake(
                "the inertia of the gear is divided by the square of the ratio",
                model=m.inertia(1.0, (20 / 30) ** 2),
            ),
        ),
    ),
    Wrong(
        "hertzian_springs_and_bearings_in_series",
        changed_pair("thirds", 5400.0, 1500.0),
        ("dte", *FORCES),
        (
            Mistake("the tooth springs follow the power 3/2 of the deflection", model=hertzian),
            Mistake(
                "the two bearings of a shaft are put in series: a quarter of the stiffness",
                model=m.bearing_stiffness(0.25, "xp", "yp", "xg", "yg"),
            ),
        ),
    ),
    Wrong(
        "third_law_off_line_and_soft_teeth",
        changed_pair("springs_46", 7020.0, 210.0),
        PLACES,
        (
            Mistake(
                "the friction force on the gear has the sign of that on the pinion",
                model=m.sign(force_sign_yg=-1.0),
            ),
            Mistake("the stiffness of the tooth pairs is 30 % too small", model=m.scaled_stiffness(0.7)),
        ),
    ),
    Wrong(
        "little_damping_and_heavy_pinion",
        changed_pair("torsional_drive", 7260.0, 240.0),
        ("dte", "theta_p", "theta_g"),
        (
            Mistake("the damping of the mesh is 5 times too small", drawing=m.mesh_damping(0.2)),
            Mistake("the inertia of the pinion is twice too large", model=m.inertia(2.0, 1.0)),
        ),
        torsional=True,
    ),
    Wrong(
        "one_harmonic_and_much_damping",
        changed_pair("kb_torsional", 725.0, 150.0),
        ("dte", "mesh_force"),
        (
            Mistake(
                "of the varying stiffness only the mean and the first harmonic are used",
                model=m.whole_mesh(m.first_harmonic),
            ),
            Mistake("the damping of the mesh is 3 times too large", drawing=m.mesh_damping(3.0)),
        ),
        torsional=True,
    ),
    Wrong(
        "micrometres_and_half_the_damper",
        changed_pair("nasa_resonance", 6500.0, 56.5),
        ("x_p", "x_g", "dte", "bearing_force_x_p"),
        (
            Mistake("the displacements of the gears are in micrometres", curves=m.scaled(1e6, "x_p", "x_g")),
            Mistake(
                "the mesh damper is zeta sqrt(k m), half of what it should be", drawing=m.mesh_damping(0.5)
            ),
        ),
    ),
    Wrong(
        "tip_circle_discs_and_soft_bearings",
        changed_pair("kb_lost", 7480.0, 150.0),
        ("dte", "x_p", "x_g"),
        (
            Mistake(
                "inertias are those of discs of the tip diameter: 17 % too large", model=m.inertia(1.17, 1.17)
            ),
            Mistake(
                "the bearing stiffness along the line of action is half of what it should be",
                model=m.bearing_stiffness(0.5, "xp", "xg"),
            ),
        ),
    ),
    Wrong(
        "short_tips_and_friction_of_one_sign",
        changed_pair("nasa_xk", 5940.0, 79.1),
        (*FORCES, "dte"),
        (
            Mistake("both tips are 0.2 modules too short", drawing=short_tips),
            Mistake(
                "friction does not reverse at the pitch point",
                model=m.other_friction(lambda model, law: lambda xi: np.abs(law(xi))),
            ),
        ),
    ),
    Wrong(
        "stiffness_of_the_mesh_for_each_pair_and_pinion_bearing",
        changed_pair("fzg_xk", 2604.0, 135.0),
        (*FORCES, "dte"),
        (
            Mistake(
                "the mean stiffness of the whole mesh, c_gamma, is given to each tooth pair",
                model=m.other_stiffness(mean_mesh_stiffness_for_each),
            ),
            Mistake(
                "the pinion's bearing off the line of action is 4 times too soft",
                model=m.bearing_stiffness(0.25, "yp"),
            ),
        ),
    ),
    Wrong(
        "relief_and_no_bearings_in_the_mesh",
        changed_pair("art_energy", 6820.0, 250.0),
        ("dte", "x_p", "theta_g", "bearing_force_x_g"),
        (
            Mistake(
                "both tips are relieved by 10 um, which the file does not have",
                model=relief_of_tips(10e-6, 0.3),
            ),
            Mistake(
                "the tooth load follows the rotations alone, without the displacements of the gears",
                model=m.other(x_in_approach=0.0),
            ),
        ),
    ),
    Wrong(
        "sharpness_per_metre_and_filter",
        changed_pair("hcr", 2720.0, 120.0),
        ("dte", "bearing_force_y_p", "bearing_force_y_g", "x_p"),
        (
            Mistake(
                "the sharpness of smoothed Coulomb friction is per metre instead of per millimetre",
                drawing=m.friction_settings(sharpness=0.025),
            ),
            Mistake(
                "the curves went through a low-pass filter at twice the mesh frequency",
                curves=m.low_pass(2.0),
            ),
        ),
    ),
    Wrong(
        "pitch_point_in_the_middle_and_undamped_bearings",
        changed_pair("rack_25", 6930.0, 240.0),
        (*FORCES, "y_p", "dte"),
        (
            Mistake(
                "friction reverses in the middle of the path of contact, not at the pitch point",
                model=m.other_friction(reversed_in_the_middle),
            ),
            Mistake("the bearings have no damping", model=m.bearing_damping(0.0)),
        ),
    ),
]
