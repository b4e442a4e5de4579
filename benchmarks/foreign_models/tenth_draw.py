"""Draw of the tenth set: 80 mistakes with a guess of how frequent each is, of which 40 are drawn by weight.

``python -m benchmarks.foreign_models.tenth_draw`` prints the draw. Weights: 1 rare, 3 common, 9 very common.
A third of the list is drawn at a time, so that each kind of mistake keeps its share.
"""

from __future__ import annotations

import numpy as np

SEED = 10

INPUTS: tuple[tuple[int, str], ...] = (
    (3, "stiffness of one bearing for the support, though the shaft has two"),
    (3, "mass and inertia of the discs from the tip diameter"),
    (3, "inertia of the disc with the diameter in place of the radius"),
    (3, "inertias of pinion and gear exchanged"),
    (3, "module 3 mm where the drawing says diametral pitch 8"),
    (9, "pressure angle 20 degrees though the pair has another"),
    (9, "standard centre distance and pressure angle though the sum of shifts is not zero"),
    (3, "shift of one gear with the wrong sign"),
    (3, "shift in millimetres entered as a coefficient"),
    (9, "tip radii of the standard addendum, the shift forgotten"),
    (9, "output torque on the gear entered as torque of the pinion"),
    (1, "torque in lbf ft entered as N m"),
    (9, "speed of the gear entered as speed of the pinion"),
    (3, "revolutions per minute entered as radians per second"),
    (3, "width of the wider pinion used as common face width"),
    (3, "plane-strain modulus E/(1 - nu^2) in place of E"),
    (9, "solid discs though the wheels have bores"),
    (3, "inertia of motor or brake added to the wheel without a shaft between"),
    (3, "addendum 1.25 modules, exchanged with the dedendum"),
    (1, "path of contact made symmetric about the pitch point"),
    (9, "pitch radii in place of base radii in the equations of motion"),
    (9, "circular pitch pi m in place of the base pitch"),
    (3, "damping ratio of bearings entered ten times too large, per cent mistaken"),
    (3, "roughness as sum of the two Ra in place of their composite"),
    (9, "viscosity at 40 degrees in place of that at running temperature"),
    (3, "bearing stiffness along and off the line of action exchanged"),
    (9, "mean stiffness of the mesh c_gamma used as stiffness of one tooth pair"),
)

PHYSICS: tuple[tuple[int, str], ...] = (
    (9, "constant mean stiffness in place of the varying one"),
    (9, "rectangular wave in place of the tooth's stiffness curve"),
    (3, "Hertzian compliance left out of the tooth pair"),
    (9, "compliance of foundation and body left out of the tooth pair"),
    (3, "equal halves of the load on two pairs whatever their stiffness"),
    (9, "friction by the static load in place of the dynamic one"),
    (9, "friction does not change sign at the pitch point"),
    (3, "friction acts the wrong way in approach and recess"),
    (9, "friction moments left out of the torsional equations"),
    (3, "friction arms constant, the pitch point's"),
    (3, "arm of friction on the gear measured from the pinion's tangent point"),
    (9, "constant coefficient of friction, its mean, in place of the law"),
    (9, "sum of velocities in place of the mean entraining velocity in the friction law"),
    (3, "slide-to-roll ratio half as large"),
    (3, "equivalent radius in millimetres in the friction law"),
    (3, "mesh damping constant, that of one pair whatever the number of pairs"),
    (3, "mesh damping with the sum of both masses in place of the effective mass"),
    (9, "factor 2 forgotten in the mesh damping 2 zeta sqrt(k m)"),
    (3, "mesh damping left out"),
    (9, "teeth that pull, though contact is lost"),
    (9, "rigid bearings, a torsional model, though bearings are soft"),
    (3, "bearing displacements left out of the approach of the flanks"),
    (3, "bearing displacements with the wrong sign in the approach of the flanks"),
    (3, "profile relief with the wrong sign"),
    (3, "relief of pinion and gear both counted on each flank, twice the amount"),
    (9, "stiffness as a Fourier series of few terms"),
    (3, "second tooth pair one circular pitch behind in place of one base pitch"),
)

EXPORT: tuple[tuple[int, str], ...] = (
    (9, "explicit Euler with too long a step"),
    (9, "stiffness table of few points, interpolated"),
    (9, "record begun before the transient is over"),
    (3, "implicit integrator with much numerical damping and a long step"),
    (9, "transmission error in radians of the gear"),
    (3, "transmission error with pitch radii"),
    (9, "transmission error of opposite sign"),
    (9, "transmission error without its mean"),
    (9, "transmission error of the rotations alone, bearing displacements left out"),
    (9, "displacements in micrometres in columns named in metres"),
    (3, "rotations in degrees"),
    (9, "bearing force on the housing in place of that on the shaft"),
    (9, "bearing force of the springs alone, without dampers"),
    (3, "columns along and off the line of action exchanged"),
    (3, "mesh force of one tooth pair in place of the sum"),
    (3, "time in milliseconds"),
    (3, "pinion angle in the column of time"),
    (3, "moving average over a part of the mesh cycle on all curves"),
    (9, "angle of the gear positive in the sense of the pinion"),
    (1, "one column lags behind the others by some samples"),
    (3, "mesh frequency from the speed of the gear and the teeth of the pinion"),
    (3, "sign of sliding smoothed too widely about the pitch point"),
    (3, "rotations with the rigid rotation in them"),
    (3, "columns of pinion and gear exchanged"),
    (3, "displacements in the axes of the housing, not turned by the pressure angle"),
    (1, "state at the start of the step used for stiffness and damping forces (one step late)"),
)

PARTS = ((INPUTS, 13), (PHYSICS, 14), (EXPORT, 13))


def drawn() -> list[str]:
    """Return the 40 mistakes of the draw, in the order of the list."""
    random = np.random.default_rng(SEED)
    result: list[str] = []
    for part, count in PARTS:
        weights = np.array([weight for weight, _ in part], dtype=float)
        chosen = random.choice(len(part), count, replace=False, p=weights / weights.sum())
        result += [part[index][1] for index in sorted(chosen)]
    return result


if __name__ == "__main__":
    for number, text in enumerate(drawn(), 1):
        print(f"{number}. {text}")
