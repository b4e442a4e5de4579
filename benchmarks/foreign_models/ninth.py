"""The ninth set: 40 wrong models with one mistake each and 4 sound ones, drawn and written blind.

python -m benchmarks.foreign_models.ninth [agreement] [words]
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

import lumped
from benchmarks.foreign_models import ninth_mistakes as m
from benchmarks.foreign_models.cases import Case as Record
from benchmarks.foreign_models.differences import orders_of
from benchmarks.foreign_models.eighth_runs import effects
from benchmarks.foreign_models.ninth_pairs import PAIRS, TORSIONAL, UNILATERAL
from benchmarks.foreign_models.ninth_runs import Made
from benchmarks.foreign_models.recipe import Curves, Settings

#: Smallest effect of a wrong model, largest one of a sound model.
WRONG, SOUND = 0.06, 0.01

FORCES = ("bearing_force_x_p", "bearing_force_y_p", "bearing_force_x_g", "bearing_force_y_g")
PLACES = ("x_p", "y_p", "x_g", "y_g")
TURNS = ("theta_p", "theta_g")
SHORT = ("dte", "mesh_force", "x_p", "y_p")
PINION = ("dte", "mesh_force", "bearing_force_x_p", "bearing_force_y_p")
STANDS = ("dte", *FORCES)
MOVES = ("dte", *PLACES)
MESH = ("dte", "mesh_force")
SHAFTS = (*TURNS, *MESH)
LONG = (*TURNS, *MOVES, "mesh_force")

RK4 = Settings("rk4", 512, 4, cycles=5, phase=0.15)
FINE = Settings("rk4", 600, 8, cycles=6, phase=0.44)
ODD = Settings("rk4", 433.7, 6, cycles=8.3, phase=0.81)
HEUN = Settings("heun", 400, 12, cycles=7, phase=0.27)
NEWMARK = Settings("newmark", 500, 4, cycles=5, phase=0.66)
LATE = Settings("rk4", 384, 6, cycles=10, phase=0.08, origin=0.25)
NOISY = Settings("rk4", 512, 4, cycles=10, phase=0.5, noise=0.005, seed=9)
REST = Settings("rk4", 480, 5, cycles=6, settle=150)
LARGE_STEPS = Settings("backward_euler", 60, 1, cycles=8, settle=150)


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


def _wrong() -> tuple[tuple[str, str, Made], ...]:
    return (
        (
            "wider_width",
            "the face width of the wider gear is entered, not the common width",
            Made("servo", SHORT, RK4, drawing=m.wider_width),
        ),
        (
            "gear_shift_reversed",
            "the profile shift of the gear has the wrong sign, and the centre distance follows",
            Made("office_reducer", PINION, ODD, drawing=m.gear_shift_reversed),
        ),
        (
            "standard_tips",
            "the tip diameters are m (z + 2), though the gears have shifts",
            Made("hoist", SHORT, NEWMARK, drawing=m.standard_tips),
        ),
        (
            "torque_of_gear",
            "the torque of the gear is entered as that of the pinion",
            Made("servo", LONG, RK4, drawing=m.torque_of_gear),
        ),
        (
            "flywheel_effect",
            "the flywheel effect GD2 is entered as the moment of inertia of both gears: four times too large",
            Made("office_marine", SHAFTS, FINE, model=m.flywheel_effect),
        ),
        (
            "cold_oil",
            "the viscosity is that at 40 degrees, not that of the hot oil",
            Made("compressor", STANDS, RK4, drawing=m.cold_oil),
        ),
        (
            "rz_for_ra",
            "the roughness Rz is entered as Ra",
            Made("turbine", PINION, HEUN, drawing=m.rz_for_ra),
        ),
        (
            "dry_steel",
            "the coefficient of friction is that of dry steel, 0.15",
            Made("mixer", MOVES, LATE, drawing=m.dry_steel),
        ),
        (
            "one_bearing",
            "the stiffness of one bearing stands for that of the two of each shaft",
            Made("crusher", SHORT, RK4, drawing=m.one_bearing),
        ),
        (
            "bearing_slipped",
            "the stiffness of the gear's bearings is ten times too small",
            Made("fan", MOVES, NEWMARK, drawing=m.bearing_slipped),
        ),
        (
            "bearings_turned",
            "the bearing stiffness along and across the line of action are exchanged",
            Made("office_marine", (*MESH, *PLACES), HEUN, drawing=m.bearings_turned),
        ),
        (
            "relief_adds",
            "the tip relief has the wrong sign: it adds material",
            Made("office_reducer", ("dte", "mesh_force", "x_p"), RK4, model=m.relief_adds),
        ),
        (
            "standard_module",
            "the module is rounded to 3 mm; the gears have diametral pitch 8",
            Made("mixer", PINION, RK4, drawing=m.standard_module),
        ),
        (
            "single_for_mesh",
            "the single stiffness c' stands for the mean mesh stiffness",
            Made("hoist", ("dte", "mesh_force", *FORCES[:2]), ODD, drawing=m.single_for_mesh),
        ),
        (
            "without_correction",
            "the correction factor 0.8 of ISO 6336-1 is left out: the stiffness is 1.25 times too large",
            Made("office_axle", SHORT, FINE, drawing=m.without_correction),
        ),
        (
            "no_moments",
            "friction has no moments on the gears, only forces on the bearings",
            Made("crusher", (*SHAFTS, "y_p"), NEWMARK, model=m.no_moments),
        ),
        (
            "no_forces_across",
            "friction has moments, but no forces across the line of action",
            Made("indexer", STANDS, RK4, model=m.no_forces_across),
        ),
        (
            "first_pair_rubs",
            "in double contact only the first pair has friction, the pair that follows has none",
            Made("mixer", ("dte", "mesh_force", "y_p", "y_g"), FINE, model=m.first_pair_rubs),
        ),
        (
            "of_static_load",
            "friction comes from the static load, not from that of the moment",
            Made("office_axle", STANDS, RK4, model=m.of_static_load),
        ),
        (
            "mass_of_pinion",
            "the damping ratio is converted with the mass of the pinion, not the effective mass",
            Made("turbine", SHORT, ODD, model=m.mass_of_pinion),
        ),
        (
            "without_factor_2",
            "the factor 2 is missing in the damping c = 2 zeta sqrt(k m) of the mesh",
            Made("test_rig", SHAFTS, RK4, model=m.without_factor_2),
        ),
        (
            "rayleigh",
            "the mesh damping is proportional to stiffness and has the ratio at the mesh frequency only",
            Made("compressor", (*MESH, "x_p", "x_g"), LATE, model=m.rayleigh),
        ),
        (
            "rigid_bearings",
            "the bearings are rigid: the model is torsional",
            Made("hoist", SHAFTS, RK4, torsional=True),
        ),
        (
            "teeth_pull",
            "teeth pull: the loss of contact is left out",
            Made("rattler", PINION, FINE, unilateral=False),
        ),
        (
            "power_1_5",
            "the contact force goes with compression to the power 1.5, as in a multibody program",
            Made("fan", SHORT, RK4, model=m.power_1_5),
        ),
        (
            "approach_of_rotations",
            "the displacements of the bearings are left out of the approach of the flanks",
            Made(
                "indexer",
                ("dte", "mesh_force", "x_p", "x_g"),
                HEUN,
                model=m.approach_of_rotations,
                curves=m.only_rotations,
            ),
        ),
        (
            "one_tooth",
            "the stiffness of one tooth stands for that of the pair of teeth: twice too large",
            Made("turbine", MOVES, NEWMARK, model=m.one_tooth),
        ),
        (
            "backward_euler",
            "backward Euler with 60 steps in a mesh cycle damps the motion",
            Made("test_rig", SHAFTS, LARGE_STEPS),
        ),
        (
            "damped_newmark",
            "Newmark's method with gamma 0.9 and 64 steps in a mesh cycle damps the motion",
            Made("indexer", SHORT, Settings("rk4", 64, 16, cycles=8), road=m.damped_newmark),
        ),
        (
            "from_rest",
            "the record begins at rest and ends before the motion has settled",
            Made("turbine", SHORT, Settings("rk4", 512, 4, cycles=9), road=m.from_rest),
        ),
        (
            "thinned",
            "the output is thinned to 8 samples a cycle and filled by a spline: high orders fold back",
            Made("mixer", (*MESH, "x_p"), Settings("rk4", 512, 4, cycles=9, phase=0.3), curves=m.thinned),
        ),
        (
            "low_pass",
            "a low-pass filter of second order at twice the mesh frequency was on in the export",
            Made("fan", PINION, Settings("rk4", 512, 4, cycles=24, phase=0.7), curves=m.low_pass),
        ),
        (
            "in_degrees",
            "rotations are in degrees, not in radians",
            Made("servo", (*TURNS, "dte", "x_p"), NEWMARK, curves=m.in_degrees),
        ),
        (
            "in_micrometres",
            "lengths are in micrometres, not in metres",
            Made("office_reducer", (*MOVES, "mesh_force"), HEUN, curves=m.in_micrometres),
        ),
        (
            "on_housing",
            "bearing forces are those on the housing: all signs are reversed",
            Made("hoist", ("mesh_force", *STANDS), NOISY, curves=m.on_housing),
        ),
        (
            "of_centre_line",
            "displacements and bearing forces are along and across the pitch circles' tangent: turned by the "
            "pressure angle",
            Made("compressor", ("dte", *PLACES[:2], *FORCES[:2]), RK4, curves=m.of_centre_line),
        ),
        (
            "gears_exchanged",
            "the columns of pinion and gear are exchanged",
            Made("mixer", (*MOVES, *FORCES[1:4:2]), REST, curves=m.gears_exchanged),
        ),
        (
            "without_means",
            "the mean is taken out of all curves",
            Made("fan", (*SHORT, "x_g"), ODD, curves=m.without_means),
        ),
        (
            "load_of_one_pair",
            "the mesh force is the load of one tooth pair, not the sum",
            Made("crusher", SHORT, LATE, curves=m.load_of_one_pair),
        ),
        (
            "circular_pitch",
            "neighbouring tooth pairs are a circular pitch apart on the line of action, not a base pitch",
            Made("compressor", SHORT, FINE, line=m.circular_pitch_line, model=m.circular_pitch_model),
        ),
    )


def _sound() -> tuple[tuple[str, str, Made], ...]:
    return (
        ("sound_hoist", "sound", Made("hoist", PINION, Settings("dop853", 2000, 1, cycles=4, rtol=1e-8))),
        ("sound_fan", "sound", Made("fan", LONG, Settings("newmark", 2000, 2, cycles=4, phase=0.4))),
        (
            "sound_office_marine",
            "sound",
            Made("office_marine", SHORT, replace(HEUN, samples=1200, substeps=5)),
        ),
        ("sound_rattler", "sound", Made("rattler", PINION, replace(REST, samples=1000, settle=400))),
    )


NINTH_WRONG = tuple(
    Case(f"ninth_{number:02d}_{name}", truth, made, sound=False)
    for number, (name, truth, made) in enumerate(_wrong(), 1)
)
NINTH_SOUND = tuple(Case(f"ninth_{name}", truth, made, sound=True) for name, truth, made in _sound())


def judging(kind: str | None = None) -> list[Record]:
    """Return the cases of the ninth set, of a kind ("sound" or "wrong") or all."""
    wrong = [Record(one.name, "wrong", (one.truth,), one.pair, one.curves) for one in NINTH_WRONG]
    sound = [Record(one.name, "sound", (), one.pair, one.curves) for one in NINTH_SOUND]
    return [record for record in (*sound, *wrong) if kind in (None, record.kind)]


def agreement() -> None:
    """Print how far the author's sound motion of each pair is from ``lumped.steady_state`` [%]."""
    print("| pair | teeth | largest of orders 1 to 40 | largest of means |")
    print("|---|---|---|---|")
    for name, pair in PAIRS.items():
        contact = "unilateral" if name in UNILATERAL else "linear"
        channels = (*TURNS, "dte") if name in TORSIONAL else (*MOVES, *TURNS)
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
    for case in (*NINTH_WRONG, *NINTH_SOUND):
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
