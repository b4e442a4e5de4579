"""Draw of the eleventh set: 80 mistakes with their frequency in practice; 40 of them by weight, seed 11.

A weight of 9 is very common, 3 common, 1 rare; no rare one came to mind. 13 are drawn of inputs and geometry,
14 of physics, 13 of numerics and export.
``python -m benchmarks.foreign_models.eleventh_draw`` prints the draw.
"""

from __future__ import annotations

import numpy as np

SEED = 11
COUNTS = {"inputs": 13, "physics": 14, "export": 13}

#: Group, weight, mistake, what an answer must say to count as found.
POOL: tuple[tuple[str, int, str, str], ...] = (
    (
        "inputs",
        9,
        "pitch radii are the arms of the normal load, in the moments and in the approach of the flanks",
        "base radii (arms of the normal load) too large, pitch or reference radius in their place",
    ),
    (
        "inputs",
        9,
        "the torque of the gear shaft is applied to the pinion",
        "torque too large by z2/z1, or the torque of the other shaft",
    ),
    (
        "inputs",
        3,
        "the speed of the gear shaft is taken as that of the pinion",
        "speed or mesh frequency wrong by the ratio of the teeth",
    ),
    (
        "inputs",
        3,
        "inertia of a disc with the tip diameter",
        "inertia (or mass and inertia) too large, tip diameter",
    ),
    (
        "inputs",
        3,
        "polar inertia m r^2 in place of m r^2/2",
        "inertia doubled",
    ),
    (
        "inputs",
        3,
        "CAD moment about a diameter entered as the polar one",
        "inertia halved",
    ),
    (
        "inputs",
        9,
        "inertias of pinion and gear are exchanged",
        "inertia of pinion and gear exchanged, or both inertias named as wrong",
    ),
    (
        "inputs",
        3,
        "profile shifts are left out, centre distance and tips follow from zero shift",
        "profile shift missing, or centre distance and tips of gears without shift",
    ),
    (
        "inputs",
        3,
        "reference centre distance in place of the working one, tips as on the drawing",
        "centre distance, working pressure angle or length of the path of contact wrong",
    ),
    (
        "inputs",
        3,
        "rack of 20 degrees where the drawing has another angle",
        "pressure angle",
    ),
    (
        "inputs",
        3,
        "profile shift of the gear with the wrong sign, tips and centre distance follow",
        "profile shift of the gear, or its sign; centre distance too small because of it",
    ),
    (
        "inputs",
        3,
        "face width of the wider gear in the stiffness of the mesh",
        "face width, or mesh stiffness too large by the ratio of the widths",
    ),
    (
        "inputs",
        3,
        "plane strain counted twice: stiffness divided by 1 - nu^2",
        "mesh stiffness 10 % too large",
    ),
    (
        "inputs",
        3,
        "theoretical stiffness c'th without the factor 0.8 of ISO 6336",
        "mesh stiffness too large by 1.25",
    ),
    (
        "inputs",
        9,
        "mesh stiffness c_gamma entered as the stiffness of one pair",
        "mesh stiffness too large by 0.75 eps + 0.25",
    ),
    (
        "inputs",
        3,
        "profile shifts of pinion and gear are exchanged",
        "profile shifts exchanged, or tips of both gears",
    ),
    (
        "inputs",
        3,
        "contact ratio of a rule of thumb: the path of contact ends too late",
        "contact ratio too large, or end of contact or tip diameter of the pinion",
    ),
    (
        "inputs",
        3,
        "module rounded to a whole number",
        "module",
    ),
    (
        "inputs",
        3,
        "stiffness of one bearing where a shaft has two",
        "bearing stiffness halved, all bearings",
    ),
    (
        "inputs",
        3,
        "bearing stiffness a thousand times too large by its unit",
        "bearing stiffness too large, or supports nearly rigid",
    ),
    (
        "inputs",
        3,
        "Rz entered where the friction law wants Ra",
        "roughness too large, or friction coefficient too large by the law",
    ),
    (
        "inputs",
        3,
        "viscosity at 40 degrees in place of that at the temperature of the oil",
        "viscosity too large, or the friction coefficient that follows",
    ),
    (
        "inputs",
        9,
        "tip relief of the drawing is left out",
        "tip relief missing",
    ),
    (
        "inputs",
        3,
        "tip relief counted on both flanks of the meshing: amount doubled",
        "amount of tip relief too large by 2",
    ),
    (
        "inputs",
        3,
        "length of the relief measured along the tooth height taken as along the path of contact",
        "length or start of the relief",
    ),
    (
        "inputs",
        3,
        "inertia of the motor added to the pinion",
        "inertia of the pinion too large",
    ),
    (
        "inputs",
        3,
        "diameters in place of radii in the disc formula of mass and inertia",
        "mass and inertia too large, 4 and 16 times",
    ),
    (
        "physics",
        9,
        "constant mean mesh stiffness",
        "mesh stiffness does not vary, or mean stiffness used",
    ),
    (
        "physics",
        9,
        "mesh stiffness is a sine wave between the values of one and two pairs",
        "stiffness varies as a sine, or shape of the stiffness (first order only)",
    ),
    (
        "physics",
        9,
        "equal sharing: in double contact each pair has half of the mesh force",
        "load sharing equal, or not by the stiffness of the pairs",
    ),
    (
        "physics",
        3,
        "one pair at a time: no double contact",
        "load sharing or double contact missing, contact ratio 1",
    ),
    (
        "physics",
        9,
        "friction does not change its sign at the pitch point",
        "friction does not reverse at the pitch point",
    ),
    (
        "physics",
        9,
        "no friction",
        "friction missing",
    ),
    (
        "physics",
        3,
        "friction acts off the line of action, its moments are left out",
        "moments of friction missing in the rotation",
    ),
    (
        "physics",
        3,
        "friction acts by its moments, its force on the bearings is left out",
        "friction force missing in the y equations",
    ),
    (
        "physics",
        3,
        "moment of friction on the gear with the wrong sign",
        "sign of the friction moment on the gear",
    ),
    (
        "physics",
        3,
        "arms of friction constant, those of the pitch point",
        "friction arm constant or not that of the contact point",
    ),
    (
        "physics",
        3,
        "friction of each pair by the full static load, without sharing",
        "friction by the static load, not by the share of the pair",
    ),
    (
        "physics",
        9,
        "damping by the mass of both gears in sum in place of the effective mass",
        "mesh damping too large",
    ),
    (
        "physics",
        9,
        "c = zeta sqrt(k m): the factor 2 of the mesh damping is left out",
        "mesh damping too small by one half",
    ),
    (
        "physics",
        3,
        "no mesh damping",
        "mesh damping missing or far too small",
    ),
    (
        "physics",
        3,
        "damping ratio 5 entered for 0.05 in percent and divided by ten only: ten times the damping",
        "mesh damping ten times too large",
    ),
    (
        "physics",
        9,
        "torsional model: bearings are rigid",
        "supports rigid, or displacements of the gears missing",
    ),
    (
        "physics",
        3,
        "no damping of the bearings",
        "bearing damping missing",
    ),
    (
        "physics",
        9,
        "teeth pull: contact loss is not modelled",
        "contact loss missing, or teeth that pull",
    ),
    (
        "physics",
        3,
        "teeth that have lost contact are still damped",
        "damping force acts without contact, or contact cut by the elastic part only",
    ),
    (
        "physics",
        3,
        "zero of the approach in the middle of the backlash: half of it is in the transmission error",
        "constant offset of the transmission error, or backlash in it",
    ),
    (
        "physics",
        3,
        "tooth contact of a multibody program: force with the exponent 1.5 of the approach",
        "contact stiffness nonlinear, exponent, or stiffness that depends on load",
    ),
    (
        "physics",
        3,
        "displacement along the line of action enters the approach with the wrong sign",
        "sign of x in the approach of the flanks",
    ),
    (
        "physics",
        3,
        "bearing stiffness along and off the line of action exchanged",
        "x and y stiffness exchanged, or both named as wrong",
    ),
    (
        "physics",
        3,
        "mean coefficient of friction in place of the law along the path",
        "friction coefficient constant (Coulomb) in place of the law",
    ),
    (
        "physics",
        9,
        "velocity threshold of a multibody program: friction rises over a wide zone about the pitch point",
        "reversal of friction smoothed, or width/sharpness of the smoothing",
    ),
    (
        "physics",
        3,
        "the static transmission error is added as an excitation to the varying stiffness",
        "excitation counted twice, or an additional transmission error/deviation of the flanks",
    ),
    (
        "physics",
        3,
        "stiffness of one tooth in place of the two teeth in series",
        "mesh stiffness doubled",
    ),
    (
        "export",
        9,
        "explicit Euler with a coarse step",
        "integration: step too large or method, or damping too small by it",
    ),
    (
        "export",
        9,
        "implicit method with a coarse step: numerical damping",
        "integration: step too large or numerical damping, or mesh damping too large",
    ),
    (
        "export",
        3,
        "stiffness table with few points of a cycle, straight lines between them",
        "stiffness sampled too coarsely, or its jumps smoothed",
    ),
    (
        "export",
        9,
        "mesh frequency from the teeth of the gear with the speed of the pinion",
        "mesh frequency or speed wrong by the ratio of the teeth",
    ),
    (
        "export",
        9,
        "transmission error computed with pitch radii from right angles",
        "transmission error with the pitch radii, or its rotational part scaled by 1/cos alpha",
    ),
    (
        "export",
        9,
        "transmission error without the displacements of the bearings",
        "transmission error from rotations only, displacements missing in it",
    ),
    (
        "export",
        9,
        "transmission error is gear minus pinion",
        "sign of the transmission error",
    ),
    (
        "export",
        9,
        "transmission error in micrometres in a column of metres",
        "unit of the transmission error",
    ),
    (
        "export",
        9,
        "bearing forces on the housing in place of those on the gear",
        "sign of the bearing forces",
    ),
    (
        "export",
        3,
        "bearing force of the spring only",
        "damper missing in the bearing force",
    ),
    (
        "export",
        9,
        "forces and displacements in the axes of the drawing: x along the centre line",
        "axes turned by the pressure angle, or x and y mixed",
    ),
    (
        "export",
        9,
        "one sense of rotation for both gears: angle of the gear negative",
        "sign of the gear angle",
    ),
    (
        "export",
        9,
        "curves exported after a low-pass filter",
        "low-pass filter, high orders missing",
    ),
    (
        "export",
        3,
        "every n-th sample kept without a filter: aliasing",
        "sampling too coarse or aliasing",
    ),
    (
        "export",
        9,
        "means subtracted from all curves",
        "means missing",
    ),
    (
        "export",
        3,
        "the load of the most loaded pair exported as mesh force",
        "mesh force is that of one pair only",
    ),
    (
        "export",
        9,
        "angles in degrees",
        "unit of the angles",
    ),
    (
        "export",
        3,
        "time column by a rounded step",
        "time scale or speed or mesh frequency by this factor",
    ),
    (
        "export",
        3,
        "columns of pinion and gear exchanged",
        "channels of pinion and gear exchanged",
    ),
    (
        "export",
        3,
        "one channel delayed against the others by its filter",
        "one channel is delayed (named channel or time shift between channels)",
    ),
    (
        "export",
        9,
        "tangential force at the pitch circle exported as mesh force",
        "mesh force too small by cos alpha",
    ),
    (
        "export",
        9,
        "mesh force exported without its damping part",
        "damping part missing in the mesh force",
    ),
    (
        "export",
        3,
        "angle of the gear referred to the pinion: multiplied by z2/z1",
        "gear angle too large by z2/z1",
    ),
    (
        "export",
        3,
        "mesh force divided by the face width in mm",
        "mesh force scaled by the face width, or unit N/mm",
    ),
    (
        "export",
        3,
        "displacement of the gear positive away from the pinion's push",
        "sign of the displacement of the gear",
    ),
    (
        "export",
        3,
        "forces in kN",
        "unit of the forces",
    ),
)


def draw() -> list[int]:
    """Return the numbers (from 1) of the drawn mistakes, in the order of the pool."""
    random = np.random.default_rng(SEED)
    chosen: list[int] = []
    for group, count in COUNTS.items():
        places = np.array([number for number, row in enumerate(POOL) if row[0] == group])
        weights = np.array([POOL[number][1] for number in places], float)
        picked = random.choice(places, count, replace=False, p=weights / weights.sum())
        chosen += [int(number) + 1 for number in np.sort(picked)]
    return chosen


if __name__ == "__main__":
    for place, number in enumerate(draw(), start=1):
        print(place, number, *POOL[number - 1], sep=" | ")
