"""The seventh set: forty wrong models and four sound ones of ``seventh_truths.md``.

python -m benchmarks.foreign_models.seventh [words]   effect of each mistake on what is handed in

Exit code 1 where a mistake moves nothing by more than 6 %, or a sound record is off by more than 1 %.
"""

from __future__ import annotations

import re
import sys
import warnings
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from benchmarks.foreign_models import seventh_mistakes as wrong
from benchmarks.foreign_models import seventh_pairs as pairs
from benchmarks.foreign_models.cases import Case as Record
from benchmarks.foreign_models.recipe import Settings
from benchmarks.foreign_models.seventh_runs import (
    Case,
    by_steps,
    by_total_rotations,
    misfit,
    without_the_loss,
)

#: Least effect of a mistake on one channel, and largest of a sound record on any, as shares.
LEAST, SOUND = 0.06, 0.01
TRUTHS = Path(__file__).with_name("seventh_truths.md")

X = ("x_p", "x_g")
Y = ("y_p", "y_g")
FORCES = tuple(f"bearing_force_{along}_{end}" for end in "pg" for along in "xy")


def truths(heading: str) -> dict[int, str]:
    """Sentence of each number, under the headings with this word or, with "", under all but "Sound"."""
    result: dict[int, str] = {}
    for block in TRUTHS.read_text(encoding="utf-8").split("\n## ")[1:]:
        if block.startswith(heading or ("Inputs", "Physics", "Numerics")):
            lines = re.findall(r"^(\d+)\. \(\w+\) (.+)$", block, re.MULTILINE)
            result |= {int(number): text for number, text in lines}
    return result


_WRONG, _SOUND = truths(""), truths("Sound")


def case(number: int, name: str, pair: Mapping[str, Any], settings: Settings, **mistake: Any) -> Case:
    """Wrong model of this number in the list."""
    return Case(number, f"{number:02}_{name}", _WRONG[number], pair, settings, **mistake)


def sound(number: int, name: str, pair: Mapping[str, Any], settings: Settings, **others: Any) -> Case:
    """Sound model of this number in the list of sound ones."""
    return Case(number, f"sound_{number}_{name}", _SOUND[number], pair, settings, sound=True, **others)


def wrote(*channels: str, samples: float = 256, cycles: float = 6, **others: Any) -> Settings:
    """Settings with steps of a thousandth of a cycle or finer, which is what most users take."""
    return Settings(channels=channels, samples=samples, substeps=8, cycles=cycles, **others)


INPUTS = (
    case(
        1,
        "torque",
        pairs.REDUCER,
        wrote("dte", "mesh_force", *FORCES, origin=0.12, phase=0.3),
        drawing=wrong.torque_on_the_output,
    ),
    case(
        2,
        "speed",
        pairs.STEP_UP,
        wrote("dte", "x_p", "x_g", "mesh_force"),
        drawing=wrong.speed_of_the_small_wheel,
    ),
    case(
        3,
        "angle",
        pairs.RACING,
        wrote("dte", "mesh_force", *X, *Y, phase=0.7, samples=400),
        drawing=wrong.default_angle,
    ),
    case(
        4,
        "shifts",
        pairs.PUMP,
        wrote("dte", "mesh_force", *X, *Y, origin=1.0, samples=300),
        drawing=wrong.standard_gears,
    ),
    case(5, "tips", pairs.SHIFTED, wrote("dte", "mesh_force", *FORCES, phase=0.55), drawing=wrong.full_tips),
    case(
        6,
        "width",
        pairs.MACHINE_TOOL,
        wrote("dte", "mesh_force", *X, "bearing_force_x_p"),
        drawing=wrong.width_of_the_pinion,
    ),
    case(
        7,
        "ring",
        pairs.STUDENT,
        wrote("dte", "theta_p", "theta_g", *X, "mesh_force", samples=200, origin=0.05),
        model=wrong.rings,
    ),
    case(
        8,
        "rotor",
        pairs.SOFT_MOUNTS,
        wrote("theta_p", "theta_g", "dte", "mesh_force", *FORCES[:2], phase=0.15),
        model=wrong.with_rotor(3.5e-3),
    ),
    case(
        9,
        "one_bearing",
        pairs.SOFT_MOUNTS,
        wrote("dte", *X, *Y, samples=180.5, cycles=8),
        drawing=wrong.bearings_times(0.5),
    ),
    case(
        10,
        "axes",
        pairs.LONG_TEETH,
        wrote("dte", *X, *Y, "mesh_force", phase=0.4),
        drawing=wrong.axes_mixed_up,
    ),
    case(
        11,
        "newtons_per_mm",
        pairs.SHIFTED,
        wrote("dte", "mesh_force", *X, *FORCES[:2], origin=0.3),
        drawing=wrong.bearings_times(1e3),
    ),
    case(
        12,
        "oil",
        pairs.REDUCER,
        wrote("dte", *Y, "bearing_force_y_p", "bearing_force_y_g", phase=0.9),
        drawing=wrong.viscosity(190.0),
    ),
    case(
        13,
        "roughness",
        pairs.LONG_TEETH,
        wrote("dte", "mesh_force", *Y, samples=320),
        drawing=wrong.sum_of_roughnesses,
    ),
    case(
        14,
        "steel",
        pairs.PLASTIC,
        wrote("dte", "mesh_force", "theta_p", "theta_g", origin=0.2),
        drawing=wrong.both_of_steel,
    ),
)

PHYSICS = (
    case(
        15,
        "constant",
        pairs.STUDENT,
        wrote("dte", "mesh_force", *X, *Y),
        table=wrong.mean_stiffness,
    ),
    case(
        16,
        "c_gamma",
        pairs.REDUCER,
        wrote("dte", "mesh_force", *X, phase=0.25, samples=220.0),
        model=wrong.whole_mesh_on_each_pair,
    ),
    case(
        17,
        "no_reversal",
        pairs.STUDENT,
        wrote("dte", "mesh_force", *X, *Y, origin=0.4, phase=0.65),
        model=wrong.recess_all_the_time,
    ),
    case(
        18,
        "moments",
        pairs.PLASTIC,
        wrote("dte", "mesh_force", *X, *Y, samples=300),
        model=wrong.without_moments,
    ),
    case(
        19,
        "driving_friction",
        pairs.PUMP,
        wrote("dte", "mesh_force", *FORCES, phase=0.5),
        model=wrong.driving_friction,
    ),
    case(
        20,
        "mass",
        pairs.RACING,
        wrote("dte", "mesh_force", *X, samples=360),
        model=wrong.with_mass_in_damping(wrong.masses_in_series),
    ),
    case(
        21,
        "factor_2",
        pairs.PARTING,
        wrote("dte", "mesh_force", *X, origin=0.08),
        model=wrong.with_mass_in_damping(wrong.mass_on_the_line, 0.5),
    ),
    case(
        22,
        "pulling",
        pairs.PARTING,
        wrote("dte", "mesh_force", "theta_p", "theta_g", phase=0.35),
        model=wrong.pulling,
    ),
    case(
        23,
        "rotations",
        pairs.SHIFTED,
        wrote("dte", "theta_p", "theta_g", "mesh_force", *X),
        model=wrong.without_bearing_motion,
        written=wrong.rotations_alone,
    ),
    case(
        24,
        "relief",
        pairs.RELIEVED,
        wrote("dte", "mesh_force", *X, *Y, phase=0.2),
        relief=False,
    ),
    case(
        25,
        "impact",
        pairs.MACHINE_TOOL,
        wrote("dte", "mesh_force", *X, phase=0.1, samples=350),
        model=wrong.impact(1.5),
    ),
    case(
        26,
        "imposed",
        pairs.STEP_UP,
        wrote("dte", "mesh_force", "theta_g", *X, *Y, origin=0.5),
        model=wrong.imposed_speed,
    ),
    case(
        27,
        "square_wave",
        pairs.RIG,
        wrote("dte", "theta_p", "theta_g", "mesh_force", phase=0.8),
        line=wrong.half_and_half,
    ),
)

NUMERICS = (
    case(
        28,
        "unsettled",
        pairs.RIG,
        wrote("dte", "theta_p", "theta_g", "mesh_force", cycles=8),
        motion=by_steps(2, from_rest=True),
    ),
    case(
        29,
        "explicit",
        pairs.STUDENT,
        replace(wrote("dte", "mesh_force", *X, samples=400), method="euler", substeps=1),
        motion=by_steps(300),
    ),
    case(
        30,
        "implicit",
        pairs.RACING,
        replace(wrote("dte", "mesh_force", *X, *Y, samples=40), method="backward_euler", substeps=1),
        motion=by_steps(120),
    ),
    case(
        31,
        "tolerances",
        pairs.SOFT_MOUNTS,
        wrote("dte", "theta_p", "theta_g", *X, "mesh_force", cycles=12),
        motion=by_total_rotations(60, 1e-3, 1e-6),
    ),
    case(
        32,
        "harmonics",
        pairs.RIG,
        wrote("dte", "theta_p", "theta_g", "mesh_force", phase=0.45),
        table=wrong.three_harmonics,
    ),
    case(
        33,
        "micrometres",
        pairs.REDUCER,
        wrote("dte", "mesh_force", *X, origin=0.6),
        written=wrong.times("dte", 1e6),
    ),
    case(
        34,
        "sign",
        pairs.MACHINE_TOOL,
        wrote("dte", "mesh_force", *X, *Y, phase=0.6),
        written=wrong.times("dte", -1.0),
    ),
    case(
        35,
        "reference_radii",
        pairs.RACING,
        wrote("dte", "mesh_force", *X, phase=0.05, samples=384),
        written=wrong.with_reference_radii,
    ),
    case(
        36,
        "centre_line",
        pairs.STEP_UP,
        wrote("dte", "mesh_force", *FORCES, phase=0.33),
        written=wrong.tangential_and_radial,
    ),
    case(
        37,
        "one_pair",
        pairs.LONG_TEETH,
        wrote("dte", "mesh_force", *X, samples=300, origin=0.02),
        written=wrong.of_one_pair,
    ),
    case(
        38,
        "six_decimals",
        pairs.PUMP,
        wrote("dte", *X, *Y, "mesh_force", samples=100),
        written=wrong.six_decimals,
    ),
    case(
        39,
        "brake",
        pairs.PLASTIC,
        wrote("theta_p", "theta_g", "dte", "mesh_force", cycles=12),
        motion=without_the_loss,
    ),
    case(
        40,
        "on_the_bearing",
        pairs.RELIEVED,
        wrote("dte", *FORCES, "mesh_force", origin=0.01),
        written=wrong.on_the_bearing,
    ),
)

SEVENTH_WRONG = (*INPUTS, *PHYSICS, *NUMERICS)

SEVENTH_SOUND = (
    sound(
        1,
        "adaptive",
        pairs.STUDENT,
        replace(wrote("dte", "mesh_force", *X, *Y, phase=0.4), method="rk45", rtol=1e-7),
    ),
    sound(
        2,
        "exponentials",
        pairs.LONG_TEETH,
        replace(wrote("dte", "mesh_force", *X, *Y, samples=1024, origin=0.3), method="exponentials"),
    ),
    sound(
        3,
        "newmark",
        pairs.RELIEVED,
        replace(wrote("dte", "mesh_force", *FORCES, samples=512, phase=0.7), method="newmark", substeps=2),
    ),
    sound(
        4,
        "heun",
        pairs.PARTING,
        replace(wrote("dte", "mesh_force", *X, samples=512), method="heun", substeps=2),
        motion=by_steps(400),
    ),
)

CASES = (*SEVENTH_WRONG, *SEVENTH_SOUND)


def judging(kind: str | None = None) -> list[Record]:
    """Return the cases of the seventh set, of a kind ("sound" or "wrong") or all."""
    wrong = [
        Record(f"seventh {one.name}", "wrong", (one.truth,), one.pair, one.curves) for one in SEVENTH_WRONG
    ]
    sound = [Record(f"seventh {one.name}", "sound", (), one.pair, one.curves) for one in SEVENTH_SOUND]
    return [record for record in (*sound, *wrong) if kind in (None, record.kind)]


def main(words: list[str]) -> int:
    """Print the table of the cases with one of these words in their names; return the exit code."""
    warnings.simplefilter("ignore")
    print("| case | pair | channels | largest effect on | wave % | mean % | moved by more than 6 % |")
    print("|---|---|---|---|---|---|---|")
    bad = []
    for one in CASES:
        if words and not any(word in one.name for word in words):
            continue
        effects = misfit(one)
        name, largest = max(effects.items(), key=lambda item: item[1].size)
        moved = sum(effect.size > LEAST for effect in effects.values())
        numbers = (f"{100.0 * share:.3g}" for share in (largest.wave, largest.mean))
        cells = (one.name, one.pair["name"], str(len(effects)), name, *numbers, str(moved))
        print("| " + " | ".join(cells) + " |", flush=True)
        if (largest.size > SOUND) if one.sound else (largest.size < LEAST):
            bad.append(one.name)
    if bad:
        print("Not as it should be: " + ", ".join(bad))
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
