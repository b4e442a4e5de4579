"""What the reference cases are: equations, pairs, motions, channels, and the words that explain them.

The parameter file of a pair lies in ``data``; it is read, never written, by ``make``. All other files of
``data`` are made from this list.

Source: docs/reference_cases.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

#: Channels of a case with one degree of freedom.
ONE_DEGREE = ("dte", "dte_dot", "mesh_force", "mesh_stiffness")
#: Channels of a gear pair.
SIX_DEGREES = (
    "dte", "theta_p", "x_p", "y_p", "x_g", "y_g", "mesh_force", "friction", "bearing_force_x_p",
)  # fmt: skip
#: Channels of a gear pair with prescribed contact, whose stiffness does not depend on the motion.
PRESCRIBED = (*SIX_DEGREES, "mesh_stiffness")
#: Samples of a mesh cycle, and of a mesh cycle of teeth that differ.
SAMPLES = 4096
SAMPLES_OWN_TEETH = 256


@dataclass(frozen=True)
class Definition:
    """Definition of a reference case.

    Attributes
    ----------
    name : name of the case
    description : one sentence: what is in it
    fault : one sentence: a frequent fault of models that the case shows
    source : where the equations or the gears come from
    contact : form of contact of the lumped motion; None for one degree of freedom
    equation : table of the equation with one degree of freedom, see ``equation_of``; None for a pair
    channels : names of quantities
    samples_per_cycle : samples of a mesh cycle
    steps_per_sample : factor by which the lumped model has more samples, which shorten its steps
    """

    name: str
    description: str
    fault: str
    source: str
    contact: Literal["linear", "unilateral"] | None = None
    equation: Mapping[str, Any] | None = None
    channels: tuple[str, ...] = SIX_DEGREES
    samples_per_cycle: int = SAMPLES
    steps_per_sample: int = 1


def _period(mass: float, mean_stiffness: float, ratio: float) -> float:
    """Mesh cycle [s] whose mesh frequency is this share of the natural frequency of the mean mesh."""
    return float(f"{2.0 * np.pi / (ratio * np.sqrt(mean_stiffness / mass)):.6g}")


def _damping(mass: float, mean_stiffness: float, damping_ratio: float) -> float:
    """Damping constant [N s/m] of this damping ratio with the mean mesh."""
    return float(f"{2.0 * damping_ratio * np.sqrt(mass * mean_stiffness):.6g}")


#: The equation of all cases with one degree of freedom.
_MOTION = (
    "SI units; m delta'' + c delta' + k(t) delta = F, m = mass, c = damping, F = force, T = period; "
    "dte = delta, mesh_force = (stiffness of the tooth pairs without friction) delta + c delta'"
)


def _rectangular() -> dict[str, Any]:
    """Meissner's mesh: two tooth pairs at first, then one."""
    mass, pair_stiffness, contact_ratio = 0.42, 3.1e8, 1.57
    mean = pair_stiffness * contact_ratio
    return {
        "form": "rectangular",
        "statement": f"{_MOTION}; k = 2 pair_stiffness for 0 <= t < (contact_ratio - 1) T, then "
        "pair_stiffness",
        "mass": mass,
        "damping": _damping(mass, mean, 0.06),
        "force": 2400.0,
        "period": _period(mass, mean, 0.44),
        "pair_stiffness": pair_stiffness,
        "contact_ratio": contact_ratio,
    }


def _cosine() -> dict[str, Any]:
    """Mathieu's mesh: stiffest at t = 0."""
    mass, mean = 0.27, 4.3e8
    return {
        "form": "cosine",
        "statement": f"{_MOTION}; k = mean_stiffness (1 + depth cos(2 pi t/T))",
        "mass": mass,
        "damping": _damping(mass, mean, 0.04),
        "force": 1700.0,
        "period": _period(mass, mean, 0.58),
        "mean_stiffness": mean,
        "depth": 0.28,
    }


def _sliding() -> dict[str, Any]:
    """Standard gears 19/53, module 3 mm, 22.5 degrees, full addendum, with friction coefficient 0.1."""
    module, pressure_angle = 3.0e-3, np.deg2rad(22.5)
    teeth = np.array([19, 53])
    base = 0.5 * module * teeth * np.cos(pressure_angle)
    tips = 0.5 * module * teeth + module
    tangents = base.sum() * np.tan(pressure_angle)
    reach = np.sqrt(tips**2 - base**2)
    base_pitch = np.pi * module * np.cos(pressure_angle)
    inertia = np.array([3.1e-4, 8.9e-3])
    mass = float(1.0 / (base**2 / inertia).sum())
    pair_stiffness = 2.7e8
    mean = pair_stiffness * float(reach.sum() - tangents) / float(base_pitch)
    return {
        "form": "sliding friction",
        "statement": f"{_MOTION}; k = SUM k_i (1 + s_i mu a(X_i)) over the tooth pairs in contact, k_i = "
        "pair_stiffness; X_i = path_start + base_pitch t/T, and one base_pitch more for the pair ahead, up "
        "to path_end; s_i = -1 before pitch_point, 1 beyond; "
        "a = m (r_bp X/J_p + r_bg (tangent_points - X)/J_g), 1/m = r_bp^2/J_p + r_bg^2/J_g; "
        "friction = SUM s_i mu k_i delta",
        "damping": _damping(mass, mean, 0.06),
        "force": 1100.0,
        "period": _period(mass, mean, 0.37),
        "pair_stiffness": pair_stiffness,
        "friction_coefficient": 0.1,
        "base_radius_pinion": float(base[0]),
        "base_radius_gear": float(base[1]),
        "inertia_pinion": float(inertia[0]),
        "inertia_gear": float(inertia[1]),
        "path_start": float(tangents - reach[1]),
        "path_end": float(reach[0]),
        "pitch_point": float(base[0] * np.tan(pressure_angle)),
        "tangent_points": float(tangents),
        "base_pitch": float(base_pitch),
    }


_PAPER = (
    "Abbas Al-Zubaidi, Journal of Engineering (Baghdad) 14(4) (2008); gears of Rebbechi, Oswald and Townsend"
)
_EXAMPLE = "gears of this project, which nobody made"

DEFINITIONS = (
    Definition(
        "meissner",
        "One degree of freedom with a rectangular mesh stiffness: two tooth pairs, then one.",
        "A time step that crosses a jump of the stiffness makes an error of first order.",
        "E. Meissner, Schweizerische Bauzeitung 72 (1918) 95-98",
        equation=_rectangular(),
        channels=ONE_DEGREE,
    ),
    Definition(
        "mathieu",
        "One degree of freedom with a mesh stiffness that is a cosine.",
        "The phase of the stiffness is wrong: it is largest at t = 0.",
        "E. Mathieu, J. Math. Pures Appl. 13 (1868); DLMF 28.29",
        equation=_cosine(),
        channels=ONE_DEGREE,
    ),
    Definition(
        "sliding_friction",
        "One degree of freedom, 19/53 teeth, constant stiffness of a tooth pair and friction coefficient.",
        "The friction force has the wrong sign, or the arms of friction stand still.",
        "M. Vaishya and R. Singh, J. Sound Vib. 243 (2001) 525-545, for any ratio of teeth",
        equation=_sliding(),
        channels=("dte", "dte_dot", "mesh_force", "friction", "mesh_stiffness"),
    ),
    Definition(
        "paper_28_28_law_1",
        "28/28 of the paper, prescribed contact, friction law I: Coulomb with a jump at the pitch point.",
        "The friction force does not change its sign at the pitch point.",
        _PAPER,
        "linear",
        channels=PRESCRIBED,
    ),
    Definition(
        "paper_28_28_law_2",
        "28/28 of the paper, prescribed contact, friction law II: Benedict and Kelley.",
        "A load, a velocity or the viscosity of the law is in the wrong unit.",
        _PAPER,
        "linear",
        channels=PRESCRIBED,
    ),
    Definition(
        "paper_28_28_law_3",
        "28/28 of the paper, prescribed contact, friction law III: Xu and Kahraman.",
        "The pressure of the law is in Pa instead of GPa, or the slide to roll ratio loses its sign.",
        _PAPER,
        "linear",
        channels=PRESCRIBED,
    ),
    Definition(
        "tip_relief_33_35",
        "33/35 with 40 um of tip relief under 1500 N m; teeth only push.",
        "The stiffness is that of teeth without relief, or relief is added to the error twice.",
        _EXAMPLE,
        "unilateral",
    ),
    Definition(
        "contact_lost_43_22",
        "43 teeth drive 22, lightly damped near a resonance: all teeth are apart for a part of the cycle.",
        "Teeth pull: the mesh force becomes negative.",
        _EXAMPLE,
        "unilateral",
    ),
    Definition(
        "contact_lost_50_50",
        "50/50 of a known test rig, stiff bearings: contact is lost at half of the resonance.",
        "The model starts on another branch, or its damper acts while the teeth are apart.",
        "gears of A. Kahraman and G. W. Blankenship, J. Appl. Mech. 64 (1997) 217-226",
        "unilateral",
    ),
    Definition(
        "high_contact_ratio_29_47",
        "29/47 with a contact ratio of 2.17: two or three tooth pairs.",
        "The model allows two tooth pairs only.",
        _EXAMPLE,
        "unilateral",
    ),
    Definition(
        "profile_shift_15_52",
        "15/52 with profile shifts +0.75 and +0.58: contact ratio 1.10, large operating pressure angle.",
        "The pressure angle of the rack replaces the operating pressure angle.",
        _EXAMPLE,
        "unilateral",
    ),
    Definition(
        "own_teeth_20_30",
        "20/30 whose teeth all differ, over the hunting period of 60 mesh cycles.",
        "Shaft orders are lost: deviations are ignored, or those of one gear are used for both.",
        _EXAMPLE,
        "unilateral",
        # The free rotation of the train is no channel: it fades over many periods.
        channels=tuple(name for name in SIX_DEGREES if name != "theta_p"),
        samples_per_cycle=SAMPLES_OWN_TEETH,
        steps_per_sample=8,
    ),
    Definition(
        "shafts_46_61",
        "46/61 with a contact ratio of 2.28, on elastic shafts in four bearings between motor and load.",
        "The mass of the shaft is missing, or the shaft is a spring without bending.",
        _EXAMPLE,
        "unilateral",
    ),
)
