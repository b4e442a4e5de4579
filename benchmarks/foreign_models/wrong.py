"""Records with one mistake, as students, consultants and programs make them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from benchmarks.foreign_models import mistakes as m
from benchmarks.foreign_models.drawing import Drawing
from benchmarks.foreign_models.laws import Law, sampled
from benchmarks.foreign_models.mistakes import Mistake, Wrong
from benchmarks.foreign_models.model import Model
from benchmarks.foreign_models.pairs import PAIRS
from benchmarks.foreign_models.recipe import Curves, Recipe, Settings
from benchmarks.foreign_models.sound import changed_pair

FORCES = ("bearing_force_x_p", "bearing_force_y_p", "bearing_force_x_g", "bearing_force_y_g")
FULL = ("dte", "x_p", "y_p", *FORCES)
LOADS = ("dte", "x_p", "x_g", "mesh_force")
USUAL = ("dte", "bearing_force_x_p", "bearing_force_y_p")
PLACES = ("x_p", "y_p", "x_g", "y_g", "dte")
TURNS = ("theta_p", "theta_g", "dte")


def mean_mesh_stiffness_for_each(model: Model) -> Law:
    """c_gamma of ISO 6336-1 is given to every tooth pair."""
    law = model.stiffness
    return lambda xi: law(xi) * (0.75 * model.line.contact_ratio + 0.25)


def total_for_each(model: Model) -> Law:
    """The stiffness of the whole mesh at the phase of a pair is given to this pair."""
    line, law = model.line, model.stiffness
    phase = (np.arange(2048) + 0.5) / 2048
    total = np.zeros_like(phase)
    for index in range(math.floor(line.contact_ratio) + 1):
        xi = line.start + (phase + index) * line.base_pitch
        total += np.where(xi <= line.end, law(xi), 0.0)
    return lambda xi: np.interp((xi - line.start) / line.base_pitch % 1.0, phase, total, period=1.0)


def relief_of_tips(amount: float, share: float) -> Callable[[Model], Model]:
    """Both tips are relieved by an amount [m] over a share of the path of contact."""

    def change(model: Model) -> Model:
        line = model.line
        length = share * (line.end - line.start)
        places = np.array([line.start, line.start + length, line.end - length, line.end])
        return model.but(error=sampled(places, np.array([amount, 0.0, 0.0, amount])))

    return change


def hertzian(model: Model) -> Model:
    """Tooth springs follow the power 3/2, with the right stiffness at the mean load."""
    line = model.line
    middle = np.array([0.5 * (line.start + line.end)])
    static = model.torque / line.base_radius_p / float(model.stiffness(middle)[0])
    return m.other(hardening=0.5, reference_compression=static)(model)


def exchanged_gears(drawing: Drawing) -> Drawing:
    return replace(drawing, pinion=drawing.gear, gear=drawing.pinion)


def exchanged_shifts(drawing: Drawing) -> Drawing:
    """The profile shift of the pinion on the gear and the other way round, tips with them."""
    pinion, gear = drawing.pinion, drawing.gear
    step = drawing.module * (gear.shift - pinion.shift)
    return replace(
        drawing,
        pinion=replace(pinion, shift=gear.shift, tip_radius=pinion.tip_radius + step),
        gear=replace(gear, shift=pinion.shift, tip_radius=gear.tip_radius - step),
    )


def friction_of_one_pair(model: Model, law: Law) -> Law:
    """Only the pair that leads has friction."""
    line = model.line
    return lambda xi: np.where(xi + line.base_pitch > line.end, law(xi), 0.0)


def static_curve(curves: Curves, model: Model) -> Curves:
    """Load over stiffness at every position, without masses."""
    line = model.line
    phase = curves["time"] / model.period
    total = np.zeros_like(phase)
    for index in range(math.floor(line.contact_ratio) + 1):
        xi = line.start + (phase % 1.0 + index) * line.base_pitch
        total += np.where(xi <= line.end, model.stiffness(np.minimum(xi, line.end)), 0.0)
    return curves | {"dte": model.torque / line.base_radius_p / total}


def same_peak_to_peak(curves: Curves, model: Model) -> Curves:
    """Motion at another speed, on this time axis, scaled to the peak to peak of the right motion."""
    pair = dict(model.drawing.parameters)
    right = Recipe(pair, Settings(samples=512, cycles=1))()["dte"]
    swing = curves["dte"] - curves["dte"].mean()
    factor = np.ptp(right) / np.ptp(swing)
    slower = curves["time"] * SPEED_OF_OTHER_MOTION
    return curves | {"time": slower, "dte": right.mean() + factor * swing}


SPEED_OF_OTHER_MOTION = 0.55


def rotation_alone(curves: Curves, model: Model) -> Curves:
    return curves | {"dte": curves["dte"] - curves["x_p"] + curves["x_g"]}


def peak_of(model: Model) -> float:
    """Stiffness in the middle of the path of contact."""
    return float(model.stiffness(np.array([0.5 * (model.line.start + model.line.end)]))[0])


def old_rack(drawing: Drawing) -> Drawing:
    """A rack of 14.5 degrees; the gears keep their reference circles and tips."""
    return m.other_pressure_angle(14.5)(drawing)


WRONG: list[Wrong] = [
    Wrong(
        "iso_stiffness_without_factor",
        PAIRS["fzg_xk"],
        USUAL,
        (
            Mistake(
                "the factor 0.8 of ISO 6336-1 is forgotten: stiffness 25 % too large",
                model=m.scaled_stiffness(1.25),
            ),
        ),
    ),
    Wrong(
        "constant_mesh_stiffness",
        PAIRS["nasa"],
        FULL,
        (
            Mistake(
                "the stiffness of the mesh does not vary: its mean is used",
                model=m.whole_mesh(m.mean_of_cycle),
            ),
        ),
    ),
    Wrong(
        "total_stiffness_for_each_pair",
        PAIRS["springs_46"],
        PLACES,
        (
            Mistake(
                "the exported stiffness of the whole mesh is given to each tooth pair",
                model=m.other_stiffness(total_for_each),
            ),
        ),
    ),
    Wrong(
        "one_tooth_instead_of_two_in_series",
        PAIRS["torsional_drive"],
        ("dte",),
        (
            Mistake(
                "the stiffness of one tooth is used for a pair of teeth in series: twice too large",
                model=m.scaled_stiffness(2.0),
            ),
        ),
        torsional=True,
    ),
    Wrong(
        "one_harmonic_of_stiffness",
        changed_pair("larger_drives", 3400.0, 55.0),
        ("dte", "theta_p", "bearing_force_x_g"),
        (
            Mistake(
                "of the varying stiffness only the mean and the first harmonic are used",
                model=m.whole_mesh(m.first_harmonic),
            ),
        ),
    ),
    Wrong(
        "steel_for_cast_iron",
        changed_pair("rack_25", 5670.0, 240.0),
        ("bearing_force_x_p", "bearing_force_x_g", "dte"),
        (
            Mistake(
                "the gear of cast iron has the Young's modulus of steel",
                drawing=lambda d: replace(d, gear=replace(d.gear, modulus=206e9)),
            ),
        ),
    ),
    Wrong(
        "teeth_are_hertzian_springs",
        PAIRS["thirds"],
        ("dte", "x_p", "mesh_force"),
        (Mistake("the tooth springs follow the power 3/2 of the deflection", model=hertzian),),
    ),
    Wrong(
        "relief_not_in_the_file",
        changed_pair("nasa_xk", 4840.0, 79.1),
        ("dte", "bearing_force_x_p", "bearing_force_y_g"),
        (
            Mistake(
                "both tips are relieved by 8 um, which the file does not have",
                model=relief_of_tips(8e-6, 0.25),
            ),
        ),
    ),
    Wrong(
        "contact_ratio_of_standard_addendum",
        changed_pair("hcr", 4800.0, 120.0),
        PLACES,
        (Mistake("the tips have an addendum of one module instead of 1.35", drawing=m.standard_tips),),
    ),
    Wrong(
        "profile_shifts_ignored",
        changed_pair("low_contact", 1080.0, 620.0),
        FULL,
        (
            Mistake(
                "profile shifts and the centre distance that follows from them are ignored",
                drawing=m.without_shifts,
            ),
        ),
    ),
    Wrong(
        "profile_shifts_exchanged",
        changed_pair("rack_25", 3150.0, 240.0),
        ("y_p", "y_g", "bearing_force_y_p", "dte"),
        (Mistake("profile shifts of pinion and gear are exchanged", drawing=exchanged_shifts),),
    ),
    Wrong(
        "circular_pitch_for_base_pitch",
        changed_pair("torsional_drive", 5940.0, 240.0),
        TURNS,
        (
            Mistake(
                "pairs follow each other by the pitch of the reference circle instead of the base pitch",
                line=lambda line: replace(line, base_pitch=line.base_pitch / math.cos(math.radians(25.0))),
                model=lambda model: model.but(period_factor=math.cos(math.radians(25.0))),
            ),
        ),
        torsional=True,
    ),
    Wrong(
        "module_3_for_diametral_pitch_8",
        changed_pair("nasa", 7312.0, 56.5),
        FULL,
        (
            Mistake(
                "the module is 3 mm instead of 3.175 mm (diametral pitch 8)", drawing=m.other_module(3e-3)
            ),
        ),
    ),
    Wrong(
        "smaller_gear_drives",
        PAIRS["larger_drives"],
        PLACES,
        (Mistake("the gear with 22 teeth drives the one with 43", drawing=exchanged_gears),),
    ),
    Wrong(
        "speed_of_the_gear",
        PAIRS["fzg_xk"],
        ("dte", "x_p", "bearing_force_y_p"),
        (Mistake("the speed of the pinion is taken as the speed of the gear", drawing=m.scaled_speed(1.5)),),
    ),
    Wrong(
        "torque_on_the_gear",
        changed_pair("springs_46", 3900.0, 210.0),
        (*FORCES, "dte"),
        (
            Mistake(
                "the pinion's torque acts on the gear: loads 25 % too small",
                drawing=m.scaled_torque(46 / 61),
            ),
        ),
    ),
    Wrong(
        "force_on_the_pitch_circle",
        changed_pair("art_energy", 2170.0, 250.0),
        ("mesh_force", "dte", "bearing_force_x_g"),
        (
            Mistake(
                "the mesh force is torque over the radius of the pitch circle: loads 9 % too small",
                drawing=m.scaled_torque(math.cos(math.radians(25.0))),
            ),
        ),
    ),
    Wrong(
        "inertia_reduced_twice",
        changed_pair("elements", 3740.0, 480.0),
        ("theta_p", "theta_g", "dte", "x_p"),
        (
            Mistake(
                "the inertia of the gear is divided by the square of the ratio",
                model=m.inertia(1.0, (20 / 30) ** 2),
            ),
        ),
    ),
    Wrong(
        "percent_as_a_number",
        PAIRS["rack_25"],
        LOADS,
        (Mistake("the damping of the mesh is 10 times too small", drawing=m.mesh_damping(0.1)),),
    ),
    Wrong(
        "two_forgotten_in_the_damper",
        changed_pair("larger_drives", 4800.0, 55.0),
        ("dte", "bearing_force_x_p"),
        (
            Mistake(
                "the mesh damper is zeta sqrt(k m), half of what it should be", drawing=m.mesh_damping(0.5)
            ),
        ),
    ),
    Wrong(
        "bearing_directions_exchanged",
        changed_pair("rack_25", 3780.0, 240.0),
        (*FORCES, "x_g", "y_g"),
        (
            Mistake(
                "bearing stiffnesses along and off the line of action are exchanged, dampers too",
                model=m.exchanged_bearings(m.ALONG_AND_ACROSS),
            ),
        ),
    ),
    Wrong(
        "bearings_in_series",
        PAIRS["art_energy"],
        ("dte", "x_p", "y_p", "x_g"),
        (
            Mistake(
                "the two bearings of a shaft are in series, not in parallel: a quarter of the stiffness",
                model=m.bearing_stiffness(0.25, "xp", "yp", "xg", "yg"),
            ),
        ),
    ),
    Wrong(
        "friction_reversed",
        changed_pair("nasa", 4144.0, 56.5),
        FULL,
        (
            Mistake(
                "friction has the wrong sign everywhere, before and after the pitch point",
                model=m.scaled_friction(-1.0),
            ),
        ),
    ),
    Wrong(
        "friction_keeps_its_sign",
        changed_pair("art_energy", 3720.0, 250.0),
        ("bearing_force_y_p", "bearing_force_y_g", "bearing_force_x_p", "dte"),
        (
            Mistake(
                "friction does not reverse at the pitch point",
                model=m.other_friction(lambda model, law: lambda xi: np.abs(law(xi))),
            ),
        ),
    ),
    Wrong(
        "friction_of_the_leading_pair",
        changed_pair("rack_25", 2520.0, 240.0),
        ("dte", "y_p", "y_g", "friction_force"),
        (
            Mistake(
                "in double contact only the leading pair has friction",
                model=m.other_friction(friction_of_one_pair),
            ),
        ),
    ),
    Wrong(
        "moment_of_friction_on_pinion_reversed",
        changed_pair("art_energy", 4650.0, 250.0),
        FULL,
        (
            Mistake(
                "the moment of friction on the pinion has the wrong sign", model=m.sign(moment_sign_p=-1.0)
            ),
        ),
    ),
    Wrong(
        "xu_kahraman_in_millimetres",
        changed_pair("fzg_xk", 3255.0, 135.0),
        ("dte", "bearing_force_y_p", "y_g"),
        (
            Mistake(
                "the radius in Xu-Kahraman's law is in millimetres: friction 15 times too small",
                model=m.scaled_friction(1000.0**-0.390958),
            ),
        ),
    ),
    Wrong(
        "force_on_gear_off_line_reversed",
        changed_pair("springs_46", 5720.0, 210.0),
        ("y_p", "y_g", "x_p", "x_g"),
        (
            Mistake(
                "the friction force on the gear has the sign of that on the pinion",
                model=m.sign(force_sign_yg=-1.0),
            ),
        ),
    ),
    Wrong(
        "teeth_that_pull",
        changed_pair("kb_lost", 5900.0, 150.0),
        ("dte", "x_p", "mesh_force"),
        (Mistake("the teeth pull where they should lose contact", unilateral=False),),
        unilateral=True,
    ),
    Wrong(
        "right_peak_to_peak_wrong_motion",
        changed_pair("nasa", 4875.0, 56.5),
        ("dte",),
        (
            Mistake(
                "the record is a motion at another speed, scaled to the right peak to peak",
                drawing=m.scaled_speed(SPEED_OF_OTHER_MOTION),
                curves=same_peak_to_peak,
            ),
        ),
    ),
    Wrong(
        "backward_euler_by_large_steps",
        changed_pair("larger_drives", 2000.0, 55.0),
        ("dte", "theta_g", "x_p"),
        (
            Mistake(
                "backward Euler by 256 steps a cycle: numerical damping of the natural frequencies",
                numerics=m.with_numerics(method="backward_euler", substeps=1, samples=256),
            ),
        ),
    ),
    Wrong(
        "start_not_faded",
        changed_pair("larger_drives", 4800.0, 55.0),
        ("dte", "x_p", "x_g", "bearing_force_y_p"),
        (
            Mistake(
                "the record begins 2 cycles after a start from rest",
                numerics=m.with_numerics(settle=2, cycles=5),
            ),
        ),
    ),
    Wrong(
        "static_instead_of_dynamic",
        changed_pair("nasa_xk", 3960.0, 79.1),
        ("dte",),
        (Mistake("the curve is the static transmission error", curves=static_curve),),
    ),
    Wrong(
        "dte_without_bearings",
        changed_pair("low_contact", 900.0, 620.0),
        ("dte", "x_p", "x_g", "y_p"),
        (
            Mistake(
                "the transmission error is written without the displacements of the bearings",
                curves=rotation_alone,
            ),
        ),
    ),
    Wrong(
        "sampling_rate_misstated",
        PAIRS["fzg_bk"],
        ("dte", "bearing_force_x_p", "bearing_force_y_p"),
        (
            Mistake(
                "the sampling rate is stated as 44.1 instead of 48 kHz: time 8.8 % too long",
                curves=m.stretched_time(48 / 44.1),
            ),
        ),
    ),
    Wrong(
        "filtered_at_the_mesh_frequency",
        changed_pair("hcr", 3840.0, 120.0),
        ("x_p", "y_p", "dte"),
        (
            Mistake(
                "the curves went through a low-pass filter with its corner at twice the mesh frequency",
                curves=m.low_pass(2.0),
            ),
        ),
    ),
    Wrong(
        "motor_without_slip",
        PAIRS["torsional_drive"],
        TURNS,
        (
            Mistake(
                "the pinion turns at a constant speed: its inertia does not vibrate",
                model=m.other(drive_stiffness=3e7),
            ),
        ),
        torsional=True,
    ),
    Wrong(
        "sharpness_per_metre",
        changed_pair("hcr", 2240.0, 120.0),
        ("bearing_force_y_p", "bearing_force_y_g", "x_p", "dte"),
        (
            Mistake(
                "the sharpness of smoothed Coulomb friction is 25 per metre instead of per millimetre",
                drawing=m.friction_settings(sharpness=0.025),
            ),
        ),
    ),
    Wrong(
        "forces_on_the_housing",
        changed_pair("elements", 2550.0, 480.0),
        (*FORCES, "x_p"),
        (
            Mistake(
                "the bearing forces are written as they act on the housing, not on the gears",
                curves=m.scaled(-1.0, *FORCES),
            ),
        ),
    ),
    Wrong(
        "bearings_do_not_close_the_mesh",
        changed_pair("larger_drives", 7200.0, 55.0),
        ("dte", "x_p", "theta_p", "bearing_force_x_g"),
        (
            Mistake(
                "the tooth load follows the rotations alone, without the displacements of the gears",
                model=m.other(x_in_approach=0.0),
            ),
        ),
    ),
]
